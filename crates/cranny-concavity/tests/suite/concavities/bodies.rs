//! Bodies that the generators do not have.

use std::collections::BTreeMap;

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_testkit::Rng;

/// The boundary of a set of unit cells, each of its squares cut in two.
pub(crate) fn of_cells(extent: [i32; 3], is_solid: impl Fn([i32; 3]) -> bool) -> Mesh {
    let solid = |c: [i32; 3]| (0..3).all(|i| (0..extent[i]).contains(&c[i])) && is_solid(c);
    let mut ids = BTreeMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for x in 0..extent[0] {
        for y in 0..extent[1] {
            for z in 0..extent[2] {
                for (axis, step) in [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)] {
                    let mut beside = [x, y, z];
                    beside[axis] += step;
                    if !solid([x, y, z]) || solid(beside) {
                        continue;
                    }
                    let mut corner = |du: i32, dv: i32| {
                        let mut p = [x, y, z];
                        p[axis] += (step + 1) / 2;
                        p[(axis + 1) % 3] += du;
                        p[(axis + 2) % 3] += dv;
                        *ids.entry(p).or_insert_with(|| {
                            vertices.push(DVec3::from_array(p.map(f64::from)));
                            vertices.len() as u32 - 1
                        })
                    };
                    let mut quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    if step < 0 {
                        quad.reverse();
                    }
                    let [a, b, c, d] = quad;
                    faces.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    Mesh::new(vertices, faces).unwrap()
}

/// A cuboid of unit cells, from which columns along z are missing.
pub(crate) fn gridded_cuboid(extent: [i32; 3], is_hole: impl Fn(i32, i32) -> bool) -> Mesh {
    of_cells(extent, |[x, y, _]| !is_hole(x, y))
}

/// A random heap of cells: voids, tunnels, edges of four faces and touching corners occur.
pub(crate) fn random_blocks(rng: &mut Rng) -> Mesh {
    let extent = [1 + rng.below(4), 1 + rng.below(4), 1 + rng.below(5)].map(|n| n as i32);
    let full = 1 + rng.below(9);
    let [x, y, z] = extent;
    let cells: Vec<bool> = (0..x * y * z).map(|_| rng.below(10) < full).collect();
    let at = |[i, j, k]: [i32; 3]| ((i * y + j) * z + k) as usize;
    let first = rng.below(cells.len());
    of_cells(extent, |c| cells[at(c)] || at(c) == first)
}

/// A prism along z from 0 to 1 over a polygon, counter-clockwise, all of which `center` sees.
fn star_shaped_prism(center: [f64; 2], outline: &[[f64; 2]]) -> Mesh {
    let n = outline.len() as u32;
    let layer = |z: f64| outline.iter().chain([&center]).map(move |&[x, y]| DVec3::new(x, y, z));
    let vertices = layer(0.0).chain(layer(1.0)).collect();
    let (middle, up) = (n, n + 1);
    let mut faces = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        faces.extend([[i, j, up + j], [i, up + j, up + i]]);
        faces.extend([[middle, j, i], [up + middle, up + i, up + j]]);
    }
    Mesh::new(vertices, faces).unwrap()
}

/// A block with a groove of V section across its top: every corner lies on the hull.
pub(crate) fn grooved_block() -> Mesh {
    let outline =
        [[2.0, 0.0], [2.0, 3.0], [1.0, 3.0], [0.0, 1.0], [-1.0, 3.0], [-2.0, 3.0], [-2.0, 0.0]];
    star_shaped_prism([0.0, 0.5], &outline)
}

/// A block with two grooves, between which a knife's edge reaches up into the plane of its top.
pub(crate) fn knife_block() -> Mesh {
    let right = [[3.0, 0.0], [3.0, 2.0], [2.5, 2.0], [1.0, 1.25]];
    let left = right.map(|[x, y]| [-x, y]).into_iter().rev();
    let outline: Vec<_> = right.into_iter().chain([[0.0, 2.0]]).chain(left).collect();
    star_shaped_prism([0.0, 0.5], &outline)
}

/// A prism over a star: its points are edges of the hull.
pub(crate) fn star_prism(points: u32) -> Mesh {
    let outline: Vec<[f64; 2]> = (0..2 * points)
        .map(|k| {
            let radius = if k % 2 == 0 { 2.0 } else { 0.75 };
            let (sin, cos) = (std::f64::consts::PI * f64::from(k) / f64::from(points)).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect();
    star_shaped_prism([0.0, 0.0], &outline)
}

/// A bottle with shoulder, neck and lip, by a lathe of `n` segments.
pub(crate) fn bottle(n: u32) -> Mesh {
    let profile = [
        [1.0, 0.0],
        [1.0, 2.0],
        [0.4, 2.5],
        [0.4, 3.2],
        [0.5, 3.2],
        [0.5, 3.4],
        [0.3, 3.4],
        [0.3, 2.4],
        [0.9, 1.8],
        [0.9, 0.1],
    ];
    let mut vertices = vec![DVec3::ZERO];
    for [radius, z] in profile {
        vertices.extend((0..n).map(|k| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
            DVec3::new(radius * cos, radius * sin, z)
        }));
    }
    let bottom = vertices.len() as u32;
    vertices.push(0.1 * DVec3::Z);
    let mut faces = Vec::new();
    let rings = profile.len() as u32;
    for k in 0..n {
        let at = |ring: u32, step: u32| 1 + ring * n + (k + step) % n;
        faces.extend([[0, at(0, 1), at(0, 0)], [bottom, at(rings - 1, 0), at(rings - 1, 1)]]);
        for ring in 0..rings - 1 {
            let [a, b, c, d] = [at(ring, 0), at(ring, 1), at(ring + 1, 1), at(ring + 1, 0)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(vertices, faces).unwrap()
}

/// Twelve five-sided spikes on a dodecahedron; their tips are the corners of an icosahedron.
pub(crate) fn small_stellated_dodecahedron() -> Mesh {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut tips = Vec::new();
    for (y, z) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        let p = DVec3::new(0.0, y, z);
        tips.extend([p, DVec3::new(p.z, p.x, p.y), DVec3::new(p.y, p.z, p.x)]);
    }
    let mut vertices = tips.clone();
    let mut core = BTreeMap::new();
    let mut faces = Vec::new();
    // Tips two units apart are neighbours; three of them have a corner of the core between them.
    let next = |i: usize, j: usize| tips[i].distance(tips[j]) < 2.1 && i != j;
    for t in 0..12 {
        let mut around = vec![(0..12).find(|&i| next(t, i)).unwrap()];
        while around.len() < 5 {
            let last = around[around.len() - 1];
            let turns_left = |i: usize| tips[t].dot(tips[last].cross(tips[i])) > 0.0;
            around.push((0..12).find(|&i| next(t, i) && next(last, i) && turns_left(i)).unwrap());
        }
        let mut corner = |i: usize, j: usize| {
            let mut key = [t, i, j];
            key.sort_unstable();
            *core.entry(key).or_insert_with(|| {
                vertices.push((tips[key[0]] + tips[key[1]] + tips[key[2]]) / golden.powi(3));
                vertices.len() as u32 - 1
            })
        };
        let ring: Vec<u32> = (0..5).map(|k| corner(around[k], around[(k + 1) % 5])).collect();
        faces.extend((0..5).map(|k| [t as u32, ring[k], ring[(k + 1) % 5]]));
    }
    Mesh::new(vertices, faces).unwrap()
}

/// The same surface, turned around.
pub(crate) fn inside_out(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

/// The same mesh with vertices and faces in another order, faces starting at other corners; and for
/// each new face the old one.
pub(crate) fn renumbered(mesh: &Mesh, rng: &mut Rng) -> (Mesh, Vec<usize>) {
    let mut shuffled = |count: usize| {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, rng.below(i + 1));
        }
        order
    };
    let (vertex_order, face_order) =
        (shuffled(mesh.vertices().len()), shuffled(mesh.faces().len()));
    let mut new_id = vec![0; vertex_order.len()];
    for (new, &old) in vertex_order.iter().enumerate() {
        new_id[old] = new as u32;
    }
    let vertices = vertex_order.iter().map(|&old| mesh.vertices()[old]).collect();
    let face = |(i, &old): (usize, &usize)| {
        let mut corners = mesh.faces()[old].map(|v| new_id[v as usize]);
        corners.rotate_left(i % 3);
        corners
    };
    let faces = face_order.iter().enumerate().map(face).collect();
    (Mesh::new(vertices, faces).unwrap(), face_order)
}
