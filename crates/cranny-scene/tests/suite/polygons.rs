//! Polygons of every format that has them: their own area, and a note on what is no flat, simple
//! polygon.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_scene::mesh_file::{MeshFile, MeshFormat, decode_mesh};

type Corners = Vec<[f64; 3]>;
type Faces = Vec<Vec<usize>>;

/// A prism over an L of area 3, with height 1: area 3 + 3 + 8.
fn l_prism(first: usize, inside_out: bool) -> (Corners, Faces) {
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let corners = [0.0, 1.0].iter().flat_map(|&z| l.map(|[x, y]| [x, y, z])).collect();
    let mut faces: Faces = vec![(0..6).rev().collect(), (6..12).collect()];
    faces.iter_mut().for_each(|face| face.rotate_left(first));
    faces.extend((0..6).map(|k| vec![k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6]));
    if inside_out {
        faces.iter_mut().for_each(|face| face.reverse());
    }
    (corners, faces)
}

fn lines<T: ToString>(rows: &[impl AsRef<[T]>], before: impl Fn(usize) -> String) -> String {
    rows.iter()
        .map(|row| {
            let words: Vec<String> = row.as_ref().iter().map(T::to_string).collect();
            format!("{}{}\n", before(words.len()), words.join(" "))
        })
        .collect()
}

fn obj((corners, faces): &(Corners, Faces)) -> String {
    let from_one: Faces = faces.iter().map(|f| f.iter().map(|k| k + 1).collect()).collect();
    lines(corners, |_| "v ".into()) + &lines(&from_one, |_| "f ".into())
}

fn off((corners, faces): &(Corners, Faces)) -> String {
    let head = format!("OFF\n{} {} 0\n", corners.len(), faces.len());
    head + &lines(corners, |_| String::new()) + &lines(faces, |n| format!("{n} "))
}

/// Faces before vertices, as the format allows.
fn ply((corners, faces): &(Corners, Faces)) -> String {
    let head = format!(
        "ply\nformat ascii 1.0\nelement face {}\nproperty list uchar int vertex_indices\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
        faces.len(),
        corners.len()
    );
    head + &lines(faces, |n| format!("{n} ")) + &lines(corners, |_| String::new())
}

fn dae((corners, faces): &(Corners, Faces)) -> String {
    let counts: Vec<String> = faces.iter().map(|f| f.len().to_string()).collect();
    format!(
        r##"<COLLADA><library_geometries><geometry id="g"><mesh><source id="p"><float_array>{}</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist><input semantic="VERTEX" source="#v" offset="0"/><vcount>{}</vcount><p>{}</p></polylist></mesh></geometry></library_geometries><asset><up_axis>Z_UP</up_axis></asset></COLLADA>"##,
        lines(corners, |_| String::new()),
        counts.join(" "),
        lines(faces, |_| String::new())
    )
}

fn read_all(body: &(Corners, Faces)) -> [MeshFile; 4] {
    [
        (obj(body), MeshFormat::Obj),
        (off(body), MeshFormat::Off),
        (ply(body), MeshFormat::Ply),
        (dae(body), MeshFormat::Collada),
    ]
    .map(|(text, format)| decode_mesh(text.as_bytes(), format).unwrap())
}

fn area_and_volume(mesh: &Mesh) -> [f64; 2] {
    mesh.faces().iter().fold([0.0; 2], |[area, volume], face| {
        let [a, b, c]: [DVec3; 3] = face.map(|k| mesh.vertices()[k as usize]);
        let normal = (b - a).cross(c - a);
        [area + normal.length() / 2.0, volume + a.dot(normal) / 6.0]
    })
}

#[test]
fn an_l_prism_has_its_area_whatever_its_faces_begin_with() {
    for first in 0..6 {
        for inside_out in [false, true] {
            for read in read_all(&l_prism(first, inside_out)) {
                let volume = if inside_out { -3.0 } else { 3.0 };
                let [area, found] = area_and_volume(&read.mesh);
                assert!((area - 14.0).abs() < 1e-12, "{:?} {area}", read.format);
                assert!((found - volume).abs() < 1e-12, "{:?} {found}", read.format);
                assert_eq!(read.mesh.faces().len(), 20);
                let split = "8 polygons with more than three corners were split into triangles";
                assert!(read.notes.iter().any(|note| note == split), "{:?}", read.notes);
                assert!(read.notes.iter().all(|note| !note.contains("of these")));
            }
        }
    }
}

#[test]
fn faces_keep_their_order_among_polygons() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 5\nf 1 2 3 4\nf 2 3 5\nf 3 4 5\n";
    let read = decode_mesh(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(read.mesh.faces(), [[0, 1, 4], [0, 1, 2], [0, 2, 3], [1, 2, 4], [2, 3, 4]]);
}

#[test]
fn a_bow_tie_and_a_bent_quad_are_told_with_the_place_of_the_first() {
    let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.5]];
    let flat = vec![[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 1.0]];
    let body = (
        [corners, flat].concat(),
        vec![vec![4, 5, 6, 7], vec![0, 1, 2, 3], vec![4, 5, 7, 6], vec![7, 6, 4, 5]],
    );
    let places = [
        ("line 11", "line 10"),
        ("line 13", "line 12"),
        ("line 12", "line 11"),
        (
            "geometry \"g\", polygon 2 (numbered from 0)",
            "geometry \"g\", polygon 1 (numbered from 0)",
        ),
    ];
    for (read, (crossed, bent)) in read_all(&body).into_iter().zip(places) {
        let notes = read.notes.join("\n");
        assert!(notes.contains("4 polygons with more than three corners were split"), "{notes}");
        let reported = format!(
            "2 polygons of these: sides cross, corners lie on sides, or there is no area (first: {crossed})"
        );
        assert!(notes.contains(&reported), "{notes}");
        let reported = "1 polygon of these: corners lie off their common plane, by up to ";
        assert!(notes.contains(reported) && notes.contains(&format!("(first: {bent})")), "{notes}");
    }
}

#[test]
fn rounding_bends_no_polygon() {
    // A quad in a plane of no simple slope, as six decimals hold it.
    let text = "v 0 0 0\nv 0.577351 0.333333 0.211325\nv 0.366026 1.211324 0.544658\nv -0.211325 0.877991 0.333333\nf 1 2 3 4\n";
    let read = decode_mesh(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(read.notes.len(), 1, "{:?}", read.notes);
    let bent = text.replace("0.333333\nf", "0.353333\nf");
    let read = decode_mesh(bent.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(read.notes.len(), 2, "{:?}", read.notes);
}
