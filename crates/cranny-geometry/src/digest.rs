//! The name of a mesh's geometry: a hash of its coordinates and faces, and how it follows vertices
//! that move.
//!
//! BLAKE3 (O'Connor, Aumasson, Neves and Wilcox-O'Hearn 2020, section 2) hashes blocks into the
//! leaves of a binary tree whose shape depends on the length alone. So it is enough to keep the
//! values of blocks: where a few have changed these are hashed again, and the tree above is put
//! together, to the same digest.
//!
//! Cost: the bytes of the mesh; afterwards those of the blocks that have changed, and 32 bytes a
//! block.

use std::ops::Range;

use blake3::Hasher;
use blake3::hazmat::{
    ChainingValue, HasherExt, Mode, merge_subtrees_non_root, merge_subtrees_root,
};

use crate::ids::VertexId;
use crate::mesh::Mesh;

/// Bytes that are hashed together: a power of two, and at least the 1024 of one leaf of BLAKE3's
/// tree. Fewer, and hashing is several times slower; more, and memory is filled that nobody uses
/// again, and more is hashed for each vertex that moves.
const BLOCK: usize = 1 << 15;

/// In front of the vertices: how many there are.
const HEAD: usize = size_of::<u64>();

const VERTEX: usize = 3 * size_of::<f64>();

const FACE: usize = 3 * size_of::<u32>();

/// The digest of a mesh: equal meshes have equal ones on every machine.
pub(crate) fn digest(mesh: &Mesh) -> [u8; 32] {
    let mut hasher = Hasher::new();
    let mut bytes = Vec::with_capacity(BLOCK + 2 * VERTEX);
    for block in blocks(mesh) {
        hasher.update(bytes_of(mesh, block, &mut bytes));
    }
    *hasher.finalize().as_bytes()
}

/// What blocks hash to, for a mesh whose vertices move.
#[derive(Clone, Debug)]
pub(crate) struct BlockHashes(Vec<ChainingValue>);

impl BlockHashes {
    /// Hashes everything.
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let mut bytes = Vec::new();
        Self(blocks(mesh).map(|block| value(mesh, block, &mut bytes)).collect())
    }

    /// Hashes again where some vertices stand, which ascend.
    pub(crate) fn update(&mut self, mesh: &Mesh, moved: &[VertexId]) {
        let mut bytes = Vec::new();
        // A vertex may lie in two blocks.
        let touched = moved.iter().flat_map(|v| {
            let first = HEAD + VERTEX * v.index();
            [first / BLOCK, (first + VERTEX - 1) / BLOCK]
        });
        let mut next = 0;
        for block in touched {
            if block >= next {
                self.0[block] = value(mesh, range(mesh, block), &mut bytes);
                next = block + 1;
            }
        }
    }

    /// The [`digest`].
    pub(crate) fn digest(&self, mesh: &Mesh) -> [u8; 32] {
        match self.0.split_at(left_half(self.0.len())) {
            // One block is no subtree: it is the whole.
            (_, []) | ([], _) => digest(mesh),
            (left, right) => {
                *merge_subtrees_root(&merged(left), &merged(right), Mode::Hash).as_bytes()
            }
        }
    }
}

/// How many of some blocks, two or more, are beneath the left child of their root: the largest
/// power of two that is less than all.
fn left_half(blocks: usize) -> usize {
    blocks.next_power_of_two() / 2
}

/// The value of the subtree over some blocks.
fn merged(values: &[ChainingValue]) -> ChainingValue {
    match values {
        [] => ChainingValue::default(),
        [one] => *one,
        all => {
            let (left, right) = all.split_at(left_half(all.len()));
            merge_subtrees_non_root(&merged(left), &merged(right), Mode::Hash)
        }
    }
}

fn value(mesh: &Mesh, block: Range<usize>, bytes: &mut Vec<u8>) -> ChainingValue {
    let mut hasher = Hasher::new();
    hasher.set_input_offset(block.start as u64);
    hasher.update(bytes_of(mesh, block, bytes));
    hasher.finalize_non_root()
}

/// Number of bytes that are hashed of a mesh.
fn length(mesh: &Mesh) -> usize {
    HEAD + VERTEX * mesh.vertices().len() + FACE * mesh.faces().len()
}

fn range(mesh: &Mesh, block: usize) -> Range<usize> {
    BLOCK * block..(BLOCK * (block + 1)).min(length(mesh))
}

fn blocks(mesh: &Mesh) -> impl Iterator<Item = Range<usize>> + '_ {
    (0..length(mesh).div_ceil(BLOCK)).map(|block| range(mesh, block))
}

/// The bytes of a range of what is hashed, which `bytes` is filled for.
fn bytes_of<'a>(mesh: &Mesh, range: Range<usize>, bytes: &'a mut Vec<u8>) -> &'a [u8] {
    bytes.clear();
    let faces_at = HEAD + VERTEX * mesh.vertices().len();
    let first_vertex = range.start.saturating_sub(HEAD) / VERTEX;
    let first_face = range.start.saturating_sub(faces_at) / FACE;
    let beyond = |at: usize, size: usize| range.end.saturating_sub(at).div_ceil(size);
    // Whole elements are written, of which the range may cut the first and the last.
    let mut from = HEAD + VERTEX * first_vertex;
    if range.start < HEAD {
        from = 0;
        bytes.extend((mesh.vertices().len() as u64).to_le_bytes());
    } else if range.start >= faces_at {
        from = faces_at + FACE * first_face;
    }
    let vertices = first_vertex..beyond(HEAD, VERTEX).min(mesh.vertices().len());
    let vertices = mesh.vertices().get(vertices).unwrap_or_default();
    for (own, p) in room::<VERTEX>(bytes, vertices.len()).iter_mut().zip(vertices) {
        let (numbers, _) = own.as_chunks_mut();
        for (number, x) in numbers.iter_mut().zip(p.to_array()) {
            // `+ 0.0`: −0 and 0 are the same place.
            *number = (x + 0.0).to_bits().to_le_bytes();
        }
    }
    let faces = first_face..beyond(faces_at, FACE).min(mesh.faces().len());
    let corners = mesh.faces().get(faces).unwrap_or_default().as_flattened();
    for (own, i) in room(bytes, corners.len()).iter_mut().zip(corners) {
        *own = i.to_le_bytes();
    }
    &bytes[range.start - from..range.end - from]
}

/// As many pieces more at the end of some bytes, to be written over. All at once: to check for room
/// before each takes longer than to write it.
fn room<const SIZE: usize>(bytes: &mut Vec<u8>, count: usize) -> &mut [[u8; SIZE]] {
    let from = bytes.len();
    bytes.resize(from + SIZE * count, 0);
    bytes[from..].as_chunks_mut().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    /// A strip of triangles.
    fn strip(vertices: u32, faces: u32) -> Mesh {
        let point = |i: u32| DVec3::new(f64::from(i), f64::from(i % 7), -0.0);
        let corners = |f: u32| [f % vertices, (f + 1) % vertices, (f + 2) % vertices];
        Mesh::new((0..vertices).map(point).collect(), (0..faces).map(corners).collect()).unwrap()
    }

    /// All at once, element by element.
    fn plainly(mesh: &Mesh) -> [u8; 32] {
        let mut bytes = (mesh.vertices().len() as u64).to_le_bytes().to_vec();
        let coordinates = mesh.vertices().iter().flat_map(|p| p.to_array());
        bytes.extend(coordinates.flat_map(|x| (x + 0.0).to_bits().to_le_bytes()));
        bytes.extend(mesh.faces().iter().flatten().flat_map(|i| i.to_le_bytes()));
        *blake3::hash(&bytes).as_bytes()
    }

    #[test]
    fn blocks_make_the_same_digest_before_and_after_vertices_have_moved() {
        // Less than a block, exactly one and two, and a little more; five, of which the last is the
        // shortest.
        let whole = |blocks: usize| ((blocks * BLOCK - HEAD - 4 * FACE) / VERTEX) as u32;
        for (vertices, faces) in
            [(3, 1), (whole(1), 4), (whole(1), 5), (whole(2), 4), (whole(2), 6), (whole(4), 90)]
        {
            let mut mesh = strip(vertices, faces);
            let mut hashes = BlockHashes::of(&mesh);
            for moved in [&[0][..], &[vertices - 1], &[0, vertices / 3, vertices / 2], &[1365]] {
                let moved: Vec<VertexId> = moved.iter().map(|&v| VertexId(v % vertices)).collect();
                for &v in &moved {
                    mesh.set_position(v, mesh.position(v) + DVec3::ONE);
                }
                hashes.update(&mesh, &moved);
                let expected = plainly(&mesh);
                let what = format!("{vertices} vertices, {faces} faces");
                assert_eq!((digest(&mesh), hashes.digest(&mesh)), (expected, expected), "{what}");
            }
        }
    }
}
