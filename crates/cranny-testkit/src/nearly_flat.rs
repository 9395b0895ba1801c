//! Closed solids made of bytes, whose sides are flat but for about as much as rounding, and moves
//! of their vertices: for fuzzing, and for tests that draw the bytes from a seed.
//!
//! Every solid is embedded but for what rounding and the smallest steps do, and there by no more
//! than these.

use std::collections::BTreeMap;

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::{Flatness, Mesh, VertexId, hull};

/// Bytes, taken from the front; zeros when there are no more.
#[derive(Clone, Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// Whether none is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// The next four bytes as a number.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes([0; 4].map(|_: u8| self.byte()))
    }

    /// A number of flatnesses about 1, of either sign; mostly 0.
    fn few(&mut self) -> f64 {
        const FEW: [f64; 8] = [0.25, 0.5, 0.99, 1.0, 1.01, 1.5, 2.0, 4.0];
        let byte = self.byte();
        let sign = if byte & 8 == 0 { 1.0 } else { -1.0 };
        if byte & 0x30 == 0 { sign * FEW[usize::from(byte & 7)] } else { 0.0 }
    }
}

/// How the coordinates of a solid are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Written {
    Double,
    Single,
}

/// A closed solid: cells of a lattice with a few thin layers, or rings one upon the other; upright
/// or turned; its vertices off their places by about the flatness; in double or single precision.
#[must_use]
pub fn nearly_flat_solid(bytes: &mut Bytes<'_>) -> Mesh {
    let form = bytes.byte();
    let written = if form & 1 == 0 { Written::Double } else { Written::Single };
    // A flatness is relative to the largest coordinate, which is about the size of these solids.
    let unit = SIZE * if form & 1 == 0 { hull::FLATNESS } else { Flatness::SINGLE };
    let mut mesh = if form & 2 == 0 { cells(bytes, unit) } else { rings(bytes, unit) };
    if form & 4 != 0 {
        let turn = [0; 3].map(|_: u8| f64::from(bytes.byte()) / 256.0);
        let turn = DMat3::from_quat(DQuat::from_xyzw(turn[0], turn[1], turn[2], 0.3).normalize());
        mesh = moved(&mesh, |p| turn * p);
    }
    if written == Written::Single {
        mesh = moved(&mesh, |p| p.as_vec3().as_dvec3());
    }
    mesh
}

/// About the largest coordinate.
const SIZE: f64 = 4.0;

fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&p| to(p)).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).expect("the domain is far away")
}

/// Places along an axis: steps of 1, some as thin as a flatness.
fn levels(bytes: &mut Bytes<'_>, cells: usize, unit: f64) -> Vec<f64> {
    let mut at = 0.0;
    let mut levels = vec![0.0];
    for _ in 0..cells {
        let thin = bytes.few().abs();
        at += if thin > 0.0 { thin * unit } else { 1.0 };
        levels.push(at);
    }
    levels
}

/// The boundary of some cells of a lattice, each square cut along either diagonal.
fn cells(bytes: &mut Bytes<'_>, unit: f64) -> Mesh {
    let extent = [0; 3].map(|_: u8| 1 + usize::from(bytes.byte() % 4));
    let is_rough = bytes.byte() & 1 == 1;
    // Thin layers between rough sides would pass through each other.
    let levels = extent.map(|n| levels(bytes, n, if is_rough { SIZE / 4.0 } else { unit }));
    let count = extent.iter().product();
    let mut filled = vec![true; count];
    for eight in filled.chunks_mut(8) {
        let mask = bytes.byte();
        eight.iter_mut().enumerate().for_each(|(i, cell)| *cell = mask >> i & 1 == 0);
    }
    filled[0] |= filled.iter().all(|cell| !cell);
    let is_filled = |c: [i32; 3]| {
        let inside = (0..3).all(|i| (0..extent[i] as i32).contains(&c[i]));
        let at =
            |c: [i32; 3]| (c[0] as usize * extent[1] + c[1] as usize) * extent[2] + c[2] as usize;
        inside && filled[at(c)]
    };
    let mut ids = BTreeMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for i in 0..count {
        let cell = [i / (extent[1] * extent[2]), i / extent[2] % extent[1], i % extent[2]];
        let cell = cell.map(|x| x as i32);
        for (axis, step) in [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)] {
            let mut beside = cell;
            beside[axis] += step;
            if !is_filled(cell) || is_filled(beside) {
                continue;
            }
            let mut quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| {
                let mut p = cell.map(|x| x as usize);
                p[axis] += usize::from(step > 0);
                p[(axis + 1) % 3] += u;
                p[(axis + 2) % 3] += v;
                *ids.entry(p).or_insert_with(|| {
                    let place = DVec3::new(levels[0][p[0]], levels[1][p[1]], levels[2][p[2]]);
                    let mut off = || if is_rough { bytes.few() * unit } else { 0.0 };
                    vertices.push(place + DVec3::new(off(), off(), off()));
                    vertices.len() as u32 - 1
                })
            });
            if step < 0 {
                quad.reverse();
            }
            let [a, b, c, d] = quad;
            faces.extend(match bytes.byte() & 1 {
                0 => [[a, b, c], [a, c, d]],
                _ => [[a, b, d], [b, c, d]],
            });
        }
    }
    Mesh::new(vertices, faces).expect("indices of vertices")
}

/// The directions of a ring's vertices: points around a square, several on each side.
const AROUND: [(i8, i8); 16] = [
    (2, -2),
    (2, -1),
    (2, 0),
    (2, 1),
    (2, 2),
    (1, 2),
    (0, 2),
    (-1, 2),
    (-2, 2),
    (-2, 1),
    (-2, 0),
    (-2, -1),
    (-2, -2),
    (-1, -2),
    (0, -2),
    (1, -2),
];

/// Rings that are seen whole from the axis, one upon the other, between two fans.
fn rings(bytes: &mut Bytes<'_>, unit: f64) -> Mesh {
    let count = 2 + usize::from(bytes.byte() % 4);
    let sides = AROUND.len();
    let mut vertices = Vec::new();
    let mut z = 0.0;
    for ring in 0..count {
        let thin = bytes.few().abs();
        let is_first = ring == 0;
        z += match (is_first, thin > 0.0) {
            (true, _) => 0.0,
            (_, true) => thin * unit,
            (_, false) => 1.0,
        };
        let wide = [1.0, 1.0, 0.5, 1.0 + unit * bytes.few()][usize::from(bytes.byte() % 4)];
        for (x, y) in AROUND {
            // One in eight far in: a ring need not be convex.
            let in_or_out = if bytes.byte() & 7 == 7 { 0.5 } else { 1.0 + unit * bytes.few() };
            let flat = wide * in_or_out * DVec3::new(f64::from(x), f64::from(y), 0.0);
            vertices.push(flat + z * DVec3::Z);
        }
    }
    let bottom = vertices.len() as u32;
    let depth = [0.0, unit * bytes.few().abs(), 0.25][usize::from(bytes.byte() % 3)];
    vertices.extend([DVec3::new(0.0, 0.0, -depth), DVec3::new(0.0, 0.0, z + depth)]);
    let mut faces = Vec::new();
    let at = |ring: usize, i: usize| (ring * sides + i % sides) as u32;
    for i in 0..sides {
        faces.push([bottom, at(0, i + 1), at(0, i)]);
        faces.push([bottom + 1, at(count - 1, i), at(count - 1, i + 1)]);
        for ring in 1..count {
            let [a, b, c, d] = [at(ring - 1, i), at(ring - 1, i + 1), at(ring, i + 1), at(ring, i)];
            faces.extend(match bytes.byte() & 1 {
                0 => [[a, b, c], [a, c, d]],
                _ => [[a, b, d], [b, c, d]],
            });
        }
    }
    Mesh::new(vertices, faces).expect("indices of vertices")
}

/// Moves of up to eight vertices: by about the flatness, by a part of the body, onto the line
/// between two others.
pub fn few_moves(mesh: &Mesh, bytes: &mut Bytes<'_>) -> Vec<(VertexId, DVec3)> {
    let count = mesh.vertices().len();
    let largest = mesh.vertices().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let mut moves = BTreeMap::new();
    for _ in 0..1 + bytes.byte() % 8 {
        let mut any = || VertexId((usize::from(bytes.byte()) % count) as u32);
        let (v, others) = (any(), [any(), any()]);
        let kind = bytes.byte();
        let along = DVec3::AXES[usize::from(kind >> 4 & 3) % 3];
        let home = mesh.position(v);
        let to = match kind & 3 {
            0 => home + bytes.few() * hull::FLATNESS * largest * along,
            1 => home + f64::from(bytes.byte() as i8) / 512.0 * largest * along,
            2 => 0.5 * (mesh.position(others[0]) + mesh.position(others[1])),
            _ => home.lerp(mesh.bounds().center(), f64::from(bytes.byte() as i8) / 256.0),
        };
        moves.insert(v, to);
    }
    moves.into_iter().collect()
}
