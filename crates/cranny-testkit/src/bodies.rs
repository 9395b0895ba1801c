//! Solids whose corners are small whole numbers, most of them with concavities, and turns that keep
//! them so.

use std::collections::HashMap;

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::Mesh;

fn mesh_of(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(vertices, faces).unwrap_or_else(|error| panic!("no mesh: {error}"))
}

/// A box from `low` to `high`: 12 triangles.
///
/// # Panics
///
/// Like all of these, where it is given coordinates that no mesh may have.
#[must_use]
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let vertices = (0..8)
        .map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
        .collect();
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh_of(vertices, faces)
}

/// The same faces, each seen from its other side.
#[must_use]
pub fn inverted(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    mesh_of(mesh.vertices().to_vec(), faces)
}

/// The union of unit cells, two triangles a side: every plane of it is subdivided, and cells that
/// only share an edge make edges with four faces.
#[must_use]
pub fn cells(cells: &[[i32; 3]]) -> Mesh {
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
    mesh_of(vertices, faces)
}

/// A prism over a counter-clockwise polygon that `triangles` tile, from z = 0 to `height`.
#[must_use]
pub fn prism(outline: &[[f64; 2]], triangles: &[[u32; 3]], height: f64) -> Mesh {
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
    mesh_of(vertices, faces)
}

/// An L without a vertex where its inner faces' planes leave the other arm.
#[must_use]
pub fn angle() -> Mesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], 1.0)
}

/// A U that opens upwards (y): arms and floor one thick, three wide, two high.
#[must_use]
pub fn channel() -> Mesh {
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
#[must_use]
pub fn rake() -> Mesh {
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

/// Half the cube of side 2 cut off along the corners next to the origin.
#[must_use]
pub fn tetrahedron() -> Mesh {
    let vertices = vec![DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y, 2.0 * DVec3::Z];
    mesh_of(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

/// The octahedron with corners at distance 1 on the axes.
#[must_use]
pub fn octahedron() -> Mesh {
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
    mesh_of(vec![x, -x, y, -y, z, -z], faces)
}

/// A box with a groove of triangular section along z: its reflex edge is the groove's bottom.
#[must_use]
pub fn grooved() -> Mesh {
    let outline =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [3.0, 2.0], [2.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 4], [1, 2, 3], [1, 3, 4], [0, 4, 5], [0, 5, 6]], 2.0)
}

/// All cells of a box of whole size.
#[must_use]
pub fn block(size: [i32; 3]) -> Vec<[i32; 3]> {
    let [x, y, z] = size;
    (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k]))).collect()
}

/// A box of unit cells without some of them.
#[must_use]
pub fn block_without(size: [i32; 3], holes: &[[i32; 3]]) -> Mesh {
    cells(&block(size).into_iter().filter(|c| !holes.contains(c)).collect::<Vec<_>>())
}

/// The 24 rotations that take the axes to the axes.
#[must_use]
pub fn quarter_turns() -> Vec<DQuat> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let across = |x: DVec3| axes.into_iter().filter(move |y| y.dot(x) == 0.0);
    axes.into_iter()
        .flat_map(|x| across(x).map(move |y| DMat3::from_cols(x, y, x.cross(y))))
        .map(|m| DQuat::from_mat3(&m).normalize())
        .collect()
}
