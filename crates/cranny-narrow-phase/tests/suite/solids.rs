//! Solids with exact dyadic coordinates, and poses that keep them exact.

use std::collections::HashMap;

use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{Cup, Shape};

pub(crate) fn model(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

pub(crate) fn shape(shape: impl Into<Shape>) -> Model {
    model(shape.into().build().unwrap())
}

pub(crate) fn at(model: &Model, x: f64, y: f64, z: f64) -> Placed<'_> {
    Placed { model, pose: Pose::at(DVec3::new(x, y, z)) }
}

/// Asks cold.
pub(crate) fn ask(a: Placed, b: Placed, demand: Demand) -> Answer {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

/// A box from `low` to `high`: 12 triangles.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let vertices = (0..8)
        .map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
        .collect();
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(vertices, faces).unwrap()
}

pub(crate) fn inverted(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

/// The union of unit cells, two triangles a side: every plane of it is subdivided, and cells that
/// only share an edge make edges with four faces.
pub(crate) fn cells(cells: &[[i32; 3]]) -> Mesh {
    let mut ids: HashMap<[i32; 3], u32> = HashMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for &cell in cells {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut neighbour = cell;
                neighbour[axis] += 2 * side - 1;
                if cells.contains(&neighbour) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                    let mut corner = cell;
                    corner[axis] += side;
                    corner[u] += du;
                    corner[v] += dv;
                    *ids.entry(corner).or_insert_with(|| {
                        vertices.push(DVec3::from_array(corner.map(f64::from)));
                        vertices.len() as u32 - 1
                    })
                });
                if side == 0 {
                    quad.reverse();
                }
                let [a, b, c, d] = quad;
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new(vertices, faces).unwrap()
}

/// A prism over a counter-clockwise polygon that `triangles` tile, from z = 0 to `height`.
pub(crate) fn prism(outline: &[[f64; 2]], triangles: &[[u32; 3]], height: f64) -> Mesh {
    let n = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |&[x, y]| DVec3::new(x, y, z));
    let vertices = level(0.0).chain(level(height)).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for &[a, b, c] in triangles {
        faces.extend([[a, c, b], [n + a, n + b, n + c]]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        faces.extend([[i, j, n + j], [i, n + j, n + i]]);
    }
    Mesh::new(vertices, faces).unwrap()
}

/// An L without a vertex where its inner faces' planes leave the other arm.
pub(crate) fn angle() -> Mesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], 1.0)
}

/// A U that opens upwards (y): arms and floor one thick, three wide, two high.
pub(crate) fn channel() -> Mesh {
    let outline = [
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 2.0],
        [2.0, 2.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 5], [0, 5, 7], [5, 6, 7]];
    prism(&outline, &triangles, 2.0)
}

/// Three prongs on a bar, from coarse triangles.
pub(crate) fn rake() -> Mesh {
    let outline = [
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 3.0],
        [4.0, 3.0],
        [4.0, 1.0],
        [3.0, 1.0],
        [3.0, 3.0],
        [2.0, 3.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [0.0, 3.0],
    ];
    let triangles = [
        [1, 2, 4],
        [2, 3, 4],
        [1, 4, 5],
        [5, 6, 7],
        [5, 7, 8],
        [0, 1, 5],
        [0, 5, 8],
        [0, 8, 9],
        [0, 9, 11],
        [9, 10, 11],
    ];
    prism(&outline, &triangles, 1.0)
}

pub(crate) fn tetrahedron() -> Mesh {
    let vertices = vec![DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y, 2.0 * DVec3::Z];
    Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

pub(crate) fn octahedron() -> Mesh {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    let faces = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    Mesh::new(vec![x, -x, y, -y, z, -z], faces).unwrap()
}

/// A box with a groove of triangular section along z: its reflex edge is the groove's bottom.
pub(crate) fn grooved() -> Mesh {
    let outline =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [3.0, 2.0], [2.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 4], [1, 2, 3], [1, 3, 4], [0, 4, 5], [0, 5, 6]], 2.0)
}

fn block(size: [i32; 3]) -> Vec<[i32; 3]> {
    let [x, y, z] = size;
    (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k]))).collect()
}

fn block_without(size: [i32; 3], holes: &[[i32; 3]]) -> Mesh {
    cells(&block(size).into_iter().filter(|c| !holes.contains(c)).collect::<Vec<_>>())
}

/// Everything that the verdicts are tried on.
pub(crate) fn dyadic_solids() -> Vec<(&'static str, Model)> {
    let void = inverted(&cuboid([1.0; 3], [2.0; 3]));
    let cup = Cup { radius: 2.0, height: 2.0, wall: 0.5, floor: 0.5, segments: 4 };
    let meshes = [
        ("unit", cuboid([0.0; 3], [1.0; 3])),
        ("bar", cuboid([0.0; 3], [3.0, 1.0, 1.0])),
        ("large", cuboid([0.0; 3], [4.0; 3])),
        ("slab", cuboid([0.0; 3], [4.0, 4.0, 1.0])),
        ("cells", cells(&block([2, 2, 2]))),
        ("angle", angle()),
        ("angle of cells", cells(&[[0, 0, 0], [1, 0, 0], [0, 1, 0]])),
        ("channel", channel()),
        ("rake", rake()),
        ("grooved", grooved()),
        ("ring", block_without([3, 3, 1], &[[1, 1, 0]])),
        ("pot", block_without([3, 3, 2], &[[1, 1, 1]])),
        ("joined at an edge", cells(&[[0, 0, 0], [1, 1, 0]])),
        ("hollow", cuboid([0.0; 3], [3.0; 3]).joined(&void)),
        ("two", cuboid([0.0; 3], [1.0; 3]).joined(&cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]))),
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("cup", cup.build().unwrap()),
    ];
    let solids: Vec<_> = meshes.into_iter().map(|(name, mesh)| (name, model(mesh))).collect();
    for (name, solid) in &solids {
        assert!(solid.is_closed(), "{name}");
        let dyadic = |p: &DVec3| (64.0 * *p) == (64.0 * *p).round();
        assert!(solid.mesh().vertices().iter().all(dyadic), "{name}");
    }
    solids
}

/// The 24 rotations that take the axes to the axes.
pub(crate) fn quarter_turns() -> Vec<DQuat> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let across = |x: DVec3| axes.into_iter().filter(move |y| y.dot(x) == 0.0);
    axes.into_iter()
        .flat_map(|x| across(x).map(move |y| DMat3::from_cols(x, y, x.cross(y))))
        .map(|m| DQuat::from_mat3(&m).normalize())
        .collect()
}
