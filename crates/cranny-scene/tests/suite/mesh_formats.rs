//! Every format says the same tetrahedron; every broken file is refused with its place.

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Flatness, Mesh, Model};
use cranny_scene::mesh_file::{
    DecodeError, MeshFile, MeshFileError, MeshFormat, Place, Problem, UpAxis, decode_mesh,
    encode_obj, read_mesh, read_mesh_with,
};
use cranny_shapes::Torus;

/// Not representable in `f32`: shows that text is read at full precision.
const H: f64 = 0.1;

fn tetrahedron() -> Mesh {
    let vertices = vec![
        DVec3::ZERO,
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.0, 1.0, 0.0),
        DVec3::new(0.0, 0.0, H),
    ];
    Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

/// Corner positions, face by face: what must agree however vertices are numbered.
fn triangles(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.faces().iter().map(|f| f.map(|i| mesh.vertices()[i as usize])).collect()
}

fn rounded(mesh: &Mesh) -> Mesh {
    let vertices = mesh.vertices().iter().map(|p| p.as_vec3().as_dvec3()).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

fn as_obj(m: &Mesh) -> Vec<u8> {
    encode_obj(m).into_bytes()
}

fn as_off(m: &Mesh) -> Vec<u8> {
    let mut s = format!("OFF # a comment\n{} {} 0\n", m.vertices().len(), m.faces().len());
    m.vertices().iter().for_each(|p| s += &format!("{} {} {}\n", p.x, p.y, p.z));
    m.faces().iter().for_each(|f| s += &format!("3 {} {} {} 255 0 0\n", f[0], f[1], f[2]));
    s.into_bytes()
}

fn ply_header(m: &Mesh, format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made here\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        m.vertices().len(),
        m.faces().len()
    )
}

fn as_ply_ascii(m: &Mesh) -> Vec<u8> {
    let mut s = ply_header(m, "ascii");
    m.vertices().iter().for_each(|p| s += &format!("{} {} {} 7\n", p.x, p.y, p.z));
    m.faces().iter().for_each(|f| s += &format!("3 {} {} {}\n", f[0], f[1], f[2]));
    s.into_bytes()
}

fn as_ply_binary(m: &Mesh, big: bool) -> Vec<u8> {
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut b = ply_header(m, name).into_bytes();
    let four = |x: [u8; 4]| if big { x } else { [x[3], x[2], x[1], x[0]] };
    for p in m.vertices() {
        p.to_array().iter().for_each(|&x| b.extend(four((x as f32).to_be_bytes())));
        b.push(7);
    }
    for f in m.faces() {
        b.push(3);
        f.iter().for_each(|&i| b.extend(four(i.to_be_bytes())));
    }
    b
}

fn as_stl_ascii(m: &Mesh) -> Vec<u8> {
    let mut s = String::from("solid one\n");
    for (k, t) in triangles(m).iter().enumerate() {
        if k == 2 {
            s += "endsolid one\nsolid two\n";
        }
        s += "facet normal 0 0 0\nouter loop\n";
        t.iter().for_each(|p| s += &format!("vertex {} {} {}\n", p.x, p.y, p.z));
        s += "endloop\nendfacet\n";
    }
    (s + "endsolid two\n").into_bytes()
}

fn as_stl_binary(m: &Mesh, header: &[u8]) -> Vec<u8> {
    let mut b = header.to_vec();
    b.resize(80, b' ');
    b.extend((m.faces().len() as u32).to_le_bytes());
    for t in triangles(m) {
        b.extend([0; 12]);
        t.iter()
            .for_each(|p| p.to_array().iter().for_each(|&x| b.extend((x as f32).to_le_bytes())));
        b.extend([0; 2]);
    }
    b
}

/// Positions then indices (u16), 4-aligned.
fn gltf_buffer(m: &Mesh) -> Vec<u8> {
    let mut b = Vec::new();
    m.vertices()
        .iter()
        .for_each(|p| p.to_array().iter().for_each(|&x| b.extend((x as f32).to_le_bytes())));
    m.faces().iter().flatten().for_each(|&i| b.extend((i as u16).to_le_bytes()));
    b.resize(b.len().next_multiple_of(4), 0);
    b
}

fn gltf_json(m: &Mesh, uri: &str, node: &str, mode: u32) -> String {
    let (v, f, size) = (m.vertices().len(), m.faces().len(), gltf_buffer(m).len());
    let positions = 12 * v;
    let indices = 6 * f;
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"children":[1]{node}}},{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{v},"type":"VEC3"}},{{"bufferView":1,"componentType":5123,"count":{},"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":{positions}}},{{"buffer":0,"byteOffset":{positions},"byteLength":{indices}}}],
"buffers":[{{{uri}"byteLength":{size}}}]}}"#,
        3 * f
    )
}

fn as_glb(m: &Mesh, node: &str) -> Vec<u8> {
    let mut json = gltf_json(m, "", node, 4).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let bin = gltf_buffer(m);
    let mut b = b"glTF".to_vec();
    b.extend(2u32.to_le_bytes());
    b.extend(((12 + 8 + json.len() + 8 + bin.len()) as u32).to_le_bytes());
    b.extend((json.len() as u32).to_le_bytes());
    b.extend(b"JSON");
    b.extend(json);
    b.extend((bin.len() as u32).to_le_bytes());
    b.extend(b"BIN\0");
    b.extend(bin);
    b
}

fn as_dae(m: &Mesh, asset: &str, node: &str) -> Vec<u8> {
    let v: Vec<String> = m.vertices().iter().map(|p| format!("{} {} {}", p.x, p.y, p.z)).collect();
    let p: Vec<String> = m.faces().iter().flatten().map(|i| format!("{i} 0")).collect();
    format!(
        r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="{}">{}</float_array><technique_common><accessor source="#a" count="{}" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{}"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/><p>{}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node>{node}<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##,
        3 * v.len(), v.join(" "), v.len(), m.faces().len(), p.join(" ")
    )
    .into_bytes()
}

const Z_UP: &str = "<unit meter=\"1\"/><up_axis>Z_UP</up_axis>";

/// Every format, its bytes, and whether it holds `f32`.
fn all_formats(m: &Mesh) -> Vec<(&'static str, MeshFormat, Vec<u8>, bool)> {
    vec![
        ("obj", MeshFormat::Obj, as_obj(m), false),
        ("off", MeshFormat::Off, as_off(m), false),
        ("ply", MeshFormat::Ply, as_ply_ascii(m), false),
        ("ply", MeshFormat::Ply, as_ply_binary(m, false), true),
        ("ply", MeshFormat::Ply, as_ply_binary(m, true), true),
        ("stl", MeshFormat::Stl, as_stl_ascii(m), false),
        ("stl", MeshFormat::Stl, as_stl_binary(m, b"made here"), true),
        ("stl", MeshFormat::Stl, as_stl_binary(m, b"solid but binary"), true),
        ("glb", MeshFormat::Gltf, as_glb(m, ""), true),
        ("dae", MeshFormat::Collada, as_dae(m, Z_UP, ""), false),
    ]
}

#[test]
fn every_format_reads_the_same_tetrahedron() {
    let folder = tempfile::tempdir().unwrap();
    let wanted = tetrahedron();
    for (k, (extension, format, bytes, single)) in all_formats(&wanted).into_iter().enumerate() {
        let path = folder.path().join(format!("t{k}.{}", extension.to_uppercase()));
        std::fs::write(&path, &bytes).unwrap();
        let read = read_mesh(&path).unwrap();
        assert_eq!(read.format, format);
        let expected = if single { rounded(&wanted) } else { wanted.clone() };
        assert_eq!(triangles(&read.mesh), triangles(&expected), "{extension} {k}");
        assert_eq!(read.mesh.vertices().len(), 4, "{extension} {k}");
    }
}

/// Two copies of a body, of which one node is turned: coordinates no longer show how finely they
/// were stored.
#[test]
fn nodes_that_turn_a_mesh_say_that_it_had_single_precision() {
    let body = Torus::default().build().unwrap();
    let read = |node: &str| decode_mesh(&as_glb(&body, node), MeshFormat::Gltf).unwrap();
    let (still, turned) = (read(""), read(r#","rotation":[0.6,0,0,0.8]"#));
    assert_eq!((still.flatness, turned.flatness), (Flatness::Auto, Flatness::Single));
    let weld = |MeshFile { mesh, flatness, .. }: MeshFile| {
        let options = BuildOptions { flatness, ..BuildOptions::default() };
        Model::build(mesh, &options).unwrap().1.weld_distance
    };
    let (still, turned) = (weld(still), weld(turned));
    assert!(turned > 0.5 * still && turned < 2.0 * still, "{turned:e} where it was {still:e}");
}

#[test]
fn no_prefix_of_any_file_panics_or_reads_as_the_whole() {
    for (_, format, bytes, _) in all_formats(&tetrahedron()) {
        let whole = decode_mesh(&bytes, format).unwrap().mesh;
        for length in 0..bytes.len() {
            if let Ok(MeshFile { mesh, .. }) = decode_mesh(&bytes[..length], format) {
                // Text formats may end anywhere after a face, or lose digits of the last number.
                assert!(mesh.faces().len() <= whole.faces().len(), "{format:?} {length}");
                assert_ne!(format, MeshFormat::Gltf);
                assert_ne!(format, MeshFormat::Collada);
            }
        }
    }
}

#[test]
fn no_flipped_byte_panics() {
    for (_, format, bytes, _) in all_formats(&tetrahedron()) {
        for at in 0..bytes.len() {
            for change in [0x01, 0x08, 0x80, 0xff] {
                let mut broken = bytes.clone();
                broken[at] ^= change;
                if let Err(error) = decode_mesh(&broken, format) {
                    assert!(error.to_string().len() > 20);
                }
            }
        }
    }
}

fn refused(bytes: &[u8], format: MeshFormat) -> DecodeError {
    decode_mesh(bytes, format).unwrap_err()
}

#[test]
fn missing_and_unknown_files_are_named() {
    let missing = read_mesh(std::path::Path::new("no/such/mesh.obj")).unwrap_err();
    assert!(matches!(missing, MeshFileError::Unreadable { .. }));
    assert!(missing.to_string().contains("mesh.obj"));
    for name in ["mesh.xyz", "mesh"] {
        let unknown = read_mesh(std::path::Path::new(name)).unwrap_err();
        assert!(matches!(unknown, MeshFileError::UnknownExtension { .. }));
        assert!(unknown.to_string().contains(".ply"));
    }
}

#[test]
fn empty_files_and_files_without_faces_are_refused() {
    for (_, format) in MeshFormat::EXTENSIONS {
        assert_eq!(refused(b"", format).problem, Problem::Empty);
        assert_eq!(refused(b" \n\n", format).problem, Problem::Empty);
    }
    let no_faces = |bytes: &[u8], format| {
        assert!(matches!(refused(bytes, format).problem, Problem::NoFaces { .. }), "{format:?}");
    };
    no_faces(b"v 0 0 0\n", MeshFormat::Obj);
    no_faces(b"OFF 1 0 0\n0 0 0\n", MeshFormat::Off);
    no_faces(b"solid nothing\nendsolid nothing\n", MeshFormat::Stl);
    no_faces(&[0; 84], MeshFormat::Stl);
    no_faces(
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
        MeshFormat::Ply,
    );
    no_faces(br#"{"asset":{"version":"2.0"}}"#, MeshFormat::Gltf);
    no_faces(b"<COLLADA/>", MeshFormat::Collada);
}

#[test]
fn garbage_is_refused_by_every_format() {
    let mut state = 1u32;
    let noise: Vec<u8> = (0..500)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    for (_, format) in MeshFormat::EXTENSIONS {
        refused(&noise, format);
        refused(b"lorem ipsum dolor sit amet\n", format);
    }
    assert!(refused(b"lorem ipsum\n", MeshFormat::Obj).to_string().contains("line 1 begins with"));
}

#[test]
fn truncated_binary_stl_says_how_much_is_missing() {
    let bytes = as_stl_binary(&tetrahedron(), b"x");
    let error = refused(&bytes[..bytes.len() - 7], MeshFormat::Stl);
    assert!(matches!(error.problem, Problem::Truncated { needed: 284, found: 277, .. }));
    assert!(error.to_string().contains("a binary file of 4 faces, as its bytes 80 to 83 say"));
    assert!(error.to_string().contains("284 bytes, but only 277"));
    let mut longer = bytes;
    longer.extend([0; 3]);
    let read = decode_mesh(&longer, MeshFormat::Stl).unwrap();
    assert!(read.notes[0].contains("3 bytes after the last face"));
}

#[test]
fn bad_coordinates_are_named_with_their_line() {
    let cases: [(&[u8], MeshFormat, usize, &str); 6] = [
        (b"v 0 0 0\nv 1 nan 0\n", MeshFormat::Obj, 2, "coordinate y is NaN"),
        (b"v 0 0 0\n\nv 1e40 0 0\n", MeshFormat::Obj, 3, "1e40"),
        (b"v 0 zero 0\n", MeshFormat::Obj, 1, "\"zero\" is not a number where coordinate y"),
        (b"OFF\n1 1 0\n0 0 inf\n", MeshFormat::Off, 3, "coordinate z is inf"),
        (b"OFF\n1 1 0\n0 0\n", MeshFormat::Off, 3, "the end of the line"),
        (b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 NaN\n", MeshFormat::Stl, 4, "NaN"),
    ];
    for (bytes, format, line, says) in cases {
        let error = refused(bytes, format);
        assert_eq!(error.place, Place::Line(line), "{error}");
        assert!(error.to_string().contains(says), "{error}");
    }
    let mut stl = as_stl_binary(&tetrahedron(), b"x");
    stl[84 + 50 + 12 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = refused(&stl, MeshFormat::Stl);
    assert_eq!(
        error.place,
        Place::Element("face 1, corner 0 (both numbered from 0), byte 146".to_owned())
    );
}

#[test]
fn bad_indices_are_named_with_their_line() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (face, index) in
        [("f 1 2 4", 4), ("f 0 1 2", 0), ("f -4 1 2", -4), ("f 1 2 99999999999", 99_999_999_999)]
    {
        let error = refused(format!("{v}{face}\n").as_bytes(), MeshFormat::Obj);
        assert_eq!(error.place, Place::Line(4));
        assert_eq!(error.problem, Problem::Index { index, vertices: 3, first: 1 }, "{face}");
    }
    let off = refused(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", MeshFormat::Off);
    assert_eq!(
        (off.place, off.problem),
        (Place::Line(5), Problem::Index { index: 3, vertices: 3, first: 0 })
    );
    assert!(matches!(
        refused(format!("{v}f 1 2\n").as_bytes(), MeshFormat::Obj).problem,
        Problem::Malformed { .. }
    ));
    let mut mesh_json = gltf_json(&tetrahedron(), "", "", 4);
    mesh_json = mesh_json.replace("\"count\":4", "\"count\":3");
    let error = refused(&glb_of(&mesh_json, &gltf_buffer(&tetrahedron())), MeshFormat::Gltf);
    assert!(matches!(error.problem, Problem::Index { index: 3, vertices: 3, .. }), "{error}");
}

fn glb_of(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut b = b"glTF".to_vec();
    b.extend(2u32.to_le_bytes());
    b.extend(((28 + json.len() + bin.len()) as u32).to_le_bytes());
    b.extend((json.len() as u32).to_le_bytes());
    b.extend(b"JSON");
    b.extend(json.as_bytes());
    b.extend((bin.len() as u32).to_le_bytes());
    b.extend(b"BIN\0");
    b.extend(bin);
    b
}

#[test]
fn obj_knows_its_dialects() {
    let text = "# c\no x\nv 0 0 0 1 0 0\nv 1 0 0\\\n\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf -4/1/1 -3//1 -2 -1 # quad\nl 1 2\n";
    let read = decode_mesh(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(read.mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(read.notes.len(), 2, "{:?}", read.notes);
    assert_eq!(read.notes[0], "line 10, beginning with \"l\", was skipped");
    assert!(read.notes[1].starts_with("1 polygon with more than three corners was split"));
}

#[test]
fn gltf_node_transforms_are_applied_in_double_precision() {
    let node = r#","translation":[0.1,0,0],"scale":[-2,1,1]"#;
    let read = decode_mesh(&as_glb(&tetrahedron(), node), MeshFormat::Gltf).unwrap();
    assert_eq!(read.mesh.vertices()[0], DVec3::new(0.1, 0.0, 0.0));
    assert_eq!(read.mesh.vertices()[1], DVec3::new(-1.9, 0.0, 0.0));
    // Mirrored: faces are turned.
    assert_eq!(read.mesh.faces()[0], [0, 1, 2]);
    let matrix = r#","matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]"#;
    let turned = decode_mesh(&as_glb(&tetrahedron(), matrix), MeshFormat::Gltf).unwrap();
    assert_eq!(turned.mesh.vertices()[1], DVec3::new(5.0, 7.0, 7.0));
}

#[test]
fn gltf_buffers_may_be_embedded_or_beside() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = tetrahedron();
    let path = folder.path().join("t.gltf");
    std::fs::write(&path, gltf_json(&mesh, r#""uri":"my%20data.bin","#, "", 4)).unwrap();
    let error = read_mesh(&path).unwrap_err().to_string();
    assert!(error.contains("my data.bin"), "{error}");
    std::fs::write(folder.path().join("my data.bin"), gltf_buffer(&mesh)).unwrap();
    assert_eq!(read_mesh(&path).unwrap().mesh, rounded(&mesh));
    let lone = decode_mesh(&std::fs::read(&path).unwrap(), MeshFormat::Gltf).unwrap_err();
    assert!(matches!(lone.problem, Problem::Buffer { .. }));
}

#[test]
fn gltf_strips_fans_cycles_and_extensions() {
    let mesh = tetrahedron();
    let strip = gltf_json(&mesh, "", "", 5);
    let faces = decode_mesh(&glb_of(&strip, &gltf_buffer(&mesh)), MeshFormat::Gltf).unwrap().mesh;
    // Corners 0 2 1 0 1 3 …
    assert_eq!(faces.faces()[..2], [[0, 2, 1], [2, 0, 1]]);
    assert_eq!(faces.faces().len(), 10);
    let fan = gltf_json(&mesh, "", "", 6);
    let faces = decode_mesh(&glb_of(&fan, &gltf_buffer(&mesh)), MeshFormat::Gltf).unwrap().mesh;
    assert_eq!(faces.faces()[0], [2, 1, 0]);
    let cycle =
        gltf_json(&mesh, "", "", 4).replace("{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}");
    let error = refused(&glb_of(&cycle, &gltf_buffer(&mesh)), MeshFormat::Gltf);
    assert!(error.to_string().contains("reached twice"), "{error}");
    let draco = gltf_json(&mesh, "", "", 4).replace(
        "\"scene\":0",
        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0",
    );
    assert!(refused(draco.as_bytes(), MeshFormat::Gltf).to_string().contains("draco"));
    let huge = gltf_json(&mesh, "", "", 4).replace("\"count\":4", "\"count\":18446744073709551615");
    let error = refused(&glb_of(&huge, &gltf_buffer(&mesh)), MeshFormat::Gltf);
    assert!(matches!(error.problem, Problem::Truncated { .. }), "{error}");
}

#[test]
fn collada_applies_unit_axis_and_nodes() {
    let mesh = tetrahedron();
    let node = "<translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>";
    let asset = "<unit meter=\"0.01\"/><up_axis>Y_UP</up_axis>";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.dae");
    std::fs::write(&path, as_dae(&mesh, asset, node)).unwrap();
    // Vertex 1 = (1, 0, 0) → scaled (2, 0, 0) → turned (0, 2, 0) → moved (10, 2, 0) cm; y up → z
    // up.
    let read = read_mesh(&path).unwrap();
    assert!((read.mesh.vertices()[1] - DVec3::new(0.1, 0.0, 0.02)).length() < 1e-15);
    assert_eq!(read.notes.len(), 2, "{:?}", read.notes);
    let filed = read_mesh_with(&path, UpAxis::AsFiled).unwrap();
    assert!((filed.mesh.vertices()[1] - DVec3::new(0.1, 0.02, 0.0)).length() < 1e-15);
    let mirrored = as_dae(&mesh, Z_UP, "<scale>1 1 -1</scale>");
    assert_eq!(decode_mesh(&mirrored, MeshFormat::Collada).unwrap().mesh.faces()[0], [0, 1, 2]);
    let cycle = String::from_utf8(as_dae(&mesh, Z_UP, "<instance_node url=\"#n\"/>"))
        .unwrap()
        .replace("<node>", "<node id=\"n\">");
    assert!(refused(cycle.as_bytes(), MeshFormat::Collada).to_string().contains("nested deeper"));
    // Eighty nodes, each of which shows the next twice: 2^80 visits.
    let doubling: String = (0..80)
        .map(|k| {
            let next = format!("<instance_node url=\"#n{}\"/>", k + 1);
            format!("<node id=\"n{k}\">{next}{next}</node>")
        })
        .collect();
    let text = String::from_utf8(as_dae(&mesh, Z_UP, "")).unwrap().replace(
        "<library_visual_scenes>",
        &format!(
            "<library_nodes>{doubling}<node id=\"n80\"/></library_nodes><library_visual_scenes>"
        ),
    );
    let text = text.replace("<node><instance", "<node><instance_node url=\"#n0\"/><instance");
    assert!(refused(text.as_bytes(), MeshFormat::Collada).to_string().contains("more than 65536"));
    let deep = format!("<COLLADA>{}", "<node>".repeat(100_000));
    assert!(refused(deep.as_bytes(), MeshFormat::Collada).to_string().contains("nested deeper"));
    let error = refused(b"<COLLADA>\n<asset>\n<oops>\n</asset></COLLADA>", MeshFormat::Collada);
    assert_eq!(error.place, Place::Line(4), "{error}");
}

#[test]
fn ply_skips_what_it_need_not_know() {
    let text = "ply\nformat ascii 1.0\nelement junk 2\nproperty list uchar float a\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\nend_header\n2 0.5 0.5\n0\n0 0 0\n1 0 0 1 1 0\n0 1 0.1\n9 4 0 1 2 3\n";
    let read = decode_mesh(text.as_bytes(), MeshFormat::Ply).unwrap();
    assert_eq!(read.mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(read.mesh.vertices()[3], DVec3::new(0.0, 1.0, 0.1));
    let error = refused(text.replace("4 0 1 2 3", "4 0 1 2 4").as_bytes(), MeshFormat::Ply);
    assert_eq!(
        (error.place, error.problem),
        (Place::Line(18), Problem::Index { index: 4, vertices: 4, first: 0 })
    );
}
