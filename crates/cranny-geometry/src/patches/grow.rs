//! Which faces make a patch: growth from seeds, then leftovers merged.
//!
//! Growth is breadth-first over edges from the lowest face that has no patch yet, as long as the
//! narrowest cone of normals and the box of the patch stay within their limits; the cone's axis
//! drifts with the patch, so that a patch begun at a rim reaches as far as one begun in the middle
//! (Garland, Willmott and Heckbert 2001 and Cohen-Steiner et al. 2004 fit planes in this spirit; we
//! want bounds kept, not an error minimised, and one pass). Growth leaves slivers where fronts met;
//! each then joins the neighbour with which it shares most border, if the limits allow.
//!
//! Cost: O(n) for growth, O(p log p) for each round of merging p patches, until none joins. Only
//! the order of faces, ratios of lengths and angles decide: scaling by a power of two changes
//! nothing.

use std::collections::BTreeSet;

use cranny_exact::{Aabb, DVec3};

use super::Patch;
use super::cone::{NormalCone, Normals, unit_normal};
use crate::ids::{FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::topology::{DisjointSets, Topology};
use crate::tree::Mates;

/// Cosine of the largest half-angle of a patch: 25 degrees. Smaller angles: more patches (a thread
/// has about 2π / (2 · angle) of them a turn on each flank); larger: one nearest point must stand
/// for surfaces that a body touches on both sides at once.
pub(super) const LEAST_COSINE: f64 = 0.906;

/// Axes of two cones that make more than twice that angle lie in no such cone; this is the cosine,
/// rounded down. Larger: patches that may be joined are not; smaller: cones are joined in vain.
const LEAST_COSINE_OF_AXES: f64 = 0.64;

/// What rounding adds to cosines when cones are joined over and over, with much room. Smaller, and
/// patches that may be joined are not; larger, and cones are joined in vain.
const ROOM: f64 = 1.0 / (1u64 << 30) as f64;

/// Largest diagonal of a patch's box, as a part of the body's: a flat side is divided too, so that
/// a patch stands for a place. Smaller: more patches; larger: one point for a whole side.
const LARGEST_EXTENT: f64 = 0.25;

/// How much longer than its largest face a patch may be, squared, where that face exceeds the limit
/// above: large faces are joined, not left alone, as long as the patch is no longer than the
/// diagonal of a square on the face. 1: every second face of a tall cup's wall stays alone.
const BEYOND_LARGEST_FACE: f64 = 2.0;

/// What a patch may grow to.
pub(super) struct Limits {
    diagonal_squared: f64,
}

/// What a patch has used up of its limits.
#[derive(Clone, Copy)]
pub(super) struct Growing {
    /// `None` while the patch holds nothing but needles.
    pub(super) cone: Option<NormalCone>,
    bounds: Aabb,
    /// Square of the diagonal of its largest face's box.
    face_squared: f64,
    faces: u32,
}

impl Growing {
    /// A patch that has stopped growing.
    pub(super) fn finished(mesh: &Mesh, patch: &Patch, faces: &[FaceId]) -> Self {
        let has_normal = (patch.needles as usize) < faces.len();
        let squares = faces.iter().map(|&f| diagonal_squared(&Aabb::of_points(mesh.triangle(f))));
        Self {
            cone: has_normal.then_some(patch.cone),
            bounds: patch.bounds,
            face_squared: squares.fold(0.0, f64::max),
            faces: faces.len() as u32,
        }
    }

    /// Whether its box keeps the limit.
    pub(super) fn fits(&self, limits: &Limits) -> bool {
        diagonal_squared(&self.bounds) <= limits.diagonal_squared(self.face_squared)
    }

    /// A patch of one face, given its unit normal and its box; needles have no normal.
    fn alone(normal: Option<DVec3>, &bounds: &Aabb) -> Self {
        let cone = normal.map(NormalCone::of_direction);
        Self { cone, bounds, face_squared: diagonal_squared(&bounds), faces: 1 }
    }

    /// Takes in one face whose normal the cone holds, given its box, if the limits allow.
    fn take_in(&mut self, face: &Aabb, limits: &Limits) -> bool {
        let bounds = self.bounds.union(face);
        let face_squared = self.face_squared.max(diagonal_squared(face));
        let fits = diagonal_squared(&bounds) <= limits.diagonal_squared(face_squared);
        if fits {
            (self.bounds, self.face_squared) = (bounds, face_squared);
            self.faces += 1;
        }
        fits
    }
}

fn diagonal_squared(b: &Aabb) -> f64 {
    (b.max - b.min).length_squared()
}

impl Limits {
    /// For a body in this box.
    pub(super) fn of(body: &Aabb) -> Self {
        let body = diagonal_squared(body);
        Self { diagonal_squared: LARGEST_EXTENT * LARGEST_EXTENT * body }
    }

    /// The largest square of a diagonal for a patch whose largest face has this one.
    pub(super) fn diagonal_squared(&self, face_squared: f64) -> f64 {
        self.diagonal_squared.max(BEYOND_LARGEST_FACE * face_squared)
    }

    /// Whether a patch in this box is small enough whatever its faces.
    pub(super) fn allow(&self, bounds: &Aabb) -> bool {
        diagonal_squared(bounds) <= self.diagonal_squared
    }

    /// Both together, if the limits allow.
    pub(super) fn joined(&self, a: &Growing, b: &Growing) -> Option<Growing> {
        let bounds = a.bounds.union(&b.bounds);
        let face_squared = a.face_squared.max(b.face_squared);
        if diagonal_squared(&bounds) > self.diagonal_squared(face_squared) {
            return None;
        }
        let cone = match (a.cone, b.cone) {
            (Some(a), Some(b)) if b.cosine >= 1.0 && a.axis.dot(b.axis) >= a.cosine => Some(a),
            (Some(a), Some(b)) if a.axis.dot(b.axis) < LEAST_COSINE_OF_AXES => None,
            (Some(a), Some(b)) => Some(a.union(&b)).filter(|c| c.cosine >= LEAST_COSINE),
            (one, other) => one.or(other),
        };
        let possible = cone.is_some() || (a.cone.is_none() && b.cone.is_none());
        let faces = a.faces + b.faces;
        possible.then_some(Growing { cone, bounds, face_squared, faces })
    }
}

/// A patch number for each face, counted in the order of the patches' lowest faces, and what each
/// patch has grown to.
pub(super) struct Partition {
    pub(super) patch_of: Vec<u32>,
    pub(super) patches: Vec<Growing>,
}

/// Calls `visit` with the other faces along an edge of a face, for each of its three edges.
pub(super) fn for_each_neighbor(
    topology: &Topology,
    face: FaceId,
    mut visit: impl FnMut(usize, FaceId),
) {
    for corner in 0..3 {
        let half_edge = HalfEdgeId::of(face, corner);
        if let Some(twin) = topology.twin(half_edge) {
            visit(corner, twin.face());
            continue;
        }
        for other in topology.half_edges(topology.edge_of(half_edge)) {
            if other.face() != face {
                visit(corner, other.face());
            }
        }
    }
}

/// Divides all faces of a mesh.
pub(super) fn partition_by(
    mesh: &Mesh,
    topology: &Topology,
    normals: &Normals,
    mates: &Mates,
) -> Partition {
    let limits = Limits::of(&mesh.bounds());
    let (patch_of, patches) = grown(topology, &limits, normals, mates);
    Partition { patch_of, patches }.merged(mesh, topology, &limits)
}

impl Partition {
    /// Joins what fits together, and numbers patches in the order of their lowest faces.
    pub(super) fn merged(mut self, mesh: &Mesh, topology: &Topology, limits: &Limits) -> Self {
        let borders = borders(mesh, topology, &self);
        let sets = merged(limits, borders, &mut self.patches);
        let mut number = vec![NONE; self.patches.len()];
        let mut joined = Vec::new();
        for patch in &mut self.patch_of {
            let set = sets[*patch as usize] as usize;
            if number[set] == NONE {
                number[set] = joined.len() as u32;
                joined.push(self.patches[set]);
            }
            *patch = number[set];
        }
        Self { patch_of: self.patch_of, patches: joined }
    }
}

/// Faces that have no patch yet.
trait Free {
    fn has(&self, face: FaceId) -> bool;
    fn take(&mut self, face: FaceId);
}

/// Patch numbers of all faces, and the number that those taken get.
struct PatchNumbers {
    patch_of: Vec<u32>,
    number: u32,
}

impl Free for PatchNumbers {
    fn has(&self, face: FaceId) -> bool {
        self.patch_of[face.index()] == NONE
    }

    fn take(&mut self, face: FaceId) {
        self.patch_of[face.index()] = self.number;
    }
}

impl Free for BTreeSet<FaceId> {
    fn has(&self, face: FaceId) -> bool {
        self.contains(&face)
    }

    fn take(&mut self, face: FaceId) {
        self.remove(&face);
    }
}

/// No patch.
const NONE: u32 = u32::MAX;

fn grown(
    topology: &Topology,
    limits: &Limits,
    normals: &Normals,
    mates: &Mates,
) -> (Vec<u32>, Vec<Growing>) {
    let count = normals.len();
    let face = |f: FaceId| (normals.get(f).map(|normal| normal.unit()), *mates.bounds(f));
    let mut numbering = PatchNumbers { patch_of: vec![NONE; count], number: 0 };
    let (mut patches, mut faces) = (Vec::new(), Vec::new());
    for seed in (0..count as u32).map(FaceId) {
        if numbering.has(seed) {
            patches.push(grow_from(seed, topology, limits, face, &mut numbering, &mut faces));
            numbering.number += 1;
        }
    }
    (numbering.patch_of, patches)
}

/// Patches grown from some faces alone: more than one where they no longer make a patch.
pub(super) fn divided(
    mesh: &Mesh,
    topology: &Topology,
    limits: &Limits,
    faces: &[FaceId],
) -> Vec<(Growing, Vec<FaceId>)> {
    let mut left: BTreeSet<FaceId> = faces.iter().copied().collect();
    let face = |f| (unit_normal(mesh, f), Aabb::of_points(mesh.triangle(f)));
    let mut patches = Vec::new();
    while let Some(&seed) = left.first() {
        let mut faces = Vec::new();
        let patch = grow_from(seed, topology, limits, face, &mut left, &mut faces);
        patches.push((patch, faces));
    }
    patches
}

/// Grows one patch, breadth-first. `face` returns the unit normal, but for needles, and the box of
/// a face; `taken` becomes the faces of the patch.
fn grow_from(
    seed: FaceId,
    topology: &Topology,
    limits: &Limits,
    face: impl Fn(FaceId) -> (Option<DVec3>, Aabb),
    free: &mut impl Free,
    taken: &mut Vec<FaceId>,
) -> Growing {
    let (normal, bounds) = face(seed);
    let mut patch = Growing::alone(normal, &bounds);
    let mut least_between = least_cosine_between(patch.cone);
    taken.clear();
    taken.push(seed);
    free.take(seed);
    let mut looked_at = 0;
    while let Some(&at) = taken.get(looked_at) {
        looked_at += 1;
        for_each_neighbor(topology, at, |_, next| {
            if !free.has(next) {
                return;
            }
            let (normal, bounds) = face(next);
            if let (Some(cone), Some(normal)) = (&patch.cone, normal) {
                // In either case what `joined` would find in the end.
                let between = cone.axis.dot(normal);
                if between < least_between {
                    return;
                }
                if between >= cone.cosine {
                    if patch.take_in(&bounds, limits) {
                        free.take(next);
                        taken.push(next);
                    }
                    return;
                }
            }
            let alone = Growing::alone(normal, &bounds);
            if let Some(larger) = limits.joined(&patch, &alone) {
                if larger.cone != patch.cone {
                    least_between = least_cosine_between(larger.cone);
                }
                patch = larger;
                free.take(next);
                taken.push(next);
            }
        });
    }
    patch
}

/// The axis of a cone and a direction that make an angle of less than this cosine certainly lie in
/// no cone as wide as patches may be: that would be narrower than half of what lies between them
/// and on the far side of the axis.
fn least_cosine_between(cone: Option<NormalCone>) -> f64 {
    let Some(cone) = cone else { return -1.0 };
    // Cosine and sine of the widest cone's angle from side to side.
    let whole = 2.0 * LEAST_COSINE * LEAST_COSINE - 1.0;
    let across = 2.0 * LEAST_COSINE * (1.0 - LEAST_COSINE * LEAST_COSINE).sqrt();
    whole * cone.cosine + across * cone.sine() - ROOM
}

/// Joins small patches to neighbours, smallest first, until no limit allows any more; returns the
/// set of each patch and leaves the joined patch at the set's number.
fn merged(limits: &Limits, mut borders: Vec<Border>, patches: &mut [Growing]) -> Vec<u32> {
    let mut sets = DisjointSets::new(patches.len());
    let mut order: Vec<u32> = (0..patches.len() as u32).collect();
    let mut near: Vec<Border> = Vec::new();
    loop {
        order.sort_unstable_by_key(|&p| (patches[p as usize].faces, p));
        let mut any = false;
        for &small in &order {
            let own = sets.find(small as usize);
            if own != small as usize {
                continue; // joined by a neighbour in this round
            }
            let first = borders.partition_point(|b| b.own < small);
            near.clear();
            near.extend(borders[first..].iter().take_while(|b| b.own == small));
            near.sort_unstable_by(|a, b| b.length.total_cmp(&a.length).then(a.other.cmp(&b.other)));
            let fitting = near.iter().find_map(|border| {
                let set = sets.find(border.other as usize);
                let joined = limits.joined(&patches[set], &patches[own]);
                joined.filter(|_| set != own).map(|joined| (set, joined))
            });
            if let Some((set, joined)) = fitting {
                sets.union(set, own);
                patches[set.min(own)] = joined;
                any = true;
            }
        }
        if !any {
            return (0..patches.len()).map(|p| sets.find(p) as u32).collect();
        }
        order.retain(|&p| sets.find(p as usize) == p as usize);
        for border in &mut borders {
            border.own = sets.find(border.own as usize) as u32;
            border.other = sets.find(border.other as usize) as u32;
        }
        collect(&mut borders, patches.len());
    }
}

/// How much border a patch has with a neighbour.
#[derive(Clone, Copy)]
struct Border {
    own: u32,
    other: u32,
    length: f64,
}

/// Sorts borders by their patches, of which there are `patches`, and makes one of those between the
/// same two.
fn collect(borders: &mut Vec<Border>, patches: usize) {
    borders.retain(|b| b.own != b.other);
    // Dealt out by the other patch, then by the own one. Both keep the order of equal ones: lengths
    // are summed in the order of faces.
    let by_other = dealt(borders, patches, |b| b.other);
    *borders = dealt(&by_other, patches, |b| b.own);
    borders.dedup_by(|next, kept| {
        let same = (next.own, next.other) == (kept.own, kept.other);
        if same {
            kept.length += next.length;
        }
        same
    });
}

/// Borders by a number below `count`, in their order where it is the same.
fn dealt(borders: &[Border], count: usize, number: impl Fn(&Border) -> u32) -> Vec<Border> {
    let mut places = vec![0u32; count];
    borders.iter().for_each(|b| places[number(b) as usize] += 1);
    let mut before = 0;
    for place in &mut places {
        before += std::mem::replace(place, before);
    }
    let mut rows = borders.to_vec();
    for border in borders {
        let place = &mut places[number(border) as usize];
        rows[*place as usize] = *border;
        *place += 1;
    }
    rows
}

/// All borders, from both sides.
fn borders(mesh: &Mesh, topology: &Topology, partition: &Partition) -> Vec<Border> {
    let Partition { patch_of, patches } = partition;
    let mut borders = Vec::new();
    let mut add = |face: FaceId, corner: usize, next: FaceId| {
        let [own, other] = [face, next].map(|f| patch_of[f.index()]);
        // Of both sides one speaks for both.
        if other != own && face < next {
            let t = mesh.triangle(face);
            let length = (t[(corner + 1) % 3] - t[corner]).length();
            borders.push(Border { own, other, length });
            borders.push(Border { own: other, other: own, length });
        }
    };
    match topology.pairs() {
        Some(pairs) => for_each_side_on_a_border(pairs, patch_of, |side| {
            if let Some(twin) = topology.twin(side) {
                add(side.face(), side.corner(), twin.face());
            }
        }),
        None => (0..patch_of.len() as u32).map(FaceId).for_each(|face| {
            for_each_neighbor(topology, face, |corner, next| add(face, corner, next));
        }),
    }
    collect(&mut borders, patches.len());
    borders
}

/// Calls `visit` with the lesser of the two half-edges of each edge between two patches, in
/// ascending order. Most edges lie within a patch, and a pass over edges finds that quicker than
/// one over faces.
fn for_each_side_on_a_border(
    pairs: &[[HalfEdgeId; 2]],
    patch_of: &[u32],
    mut visit: impl FnMut(HalfEdgeId),
) {
    // Pairs stand in the order of their vertices, so half-edges are marked first: a bit each.
    let mut marks = vec![0u64; (3 * patch_of.len()).div_ceil(64)];
    for pair in pairs {
        let [own, other] = pair.map(|h| patch_of[h.face().index()]);
        // The lesser half-edge comes first in a pair.
        let side = pair[0].index();
        marks[side / 64] |= u64::from(own != other) << (side % 64);
    }
    for (first, mut left) in (0..).step_by(64).zip(marks) {
        while left != 0 {
            visit(HalfEdgeId(first + left.trailing_zeros()));
            left &= left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn partition(mesh: &Mesh, topology: &Topology) -> Partition {
        partition_by(mesh, topology, &Normals::of(mesh), &Mates::of(mesh, topology))
    }

    #[test]
    fn no_two_neighbours_could_be_one_patch() {
        // Rough ground: a grid of heights that look random.
        let height = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 28) * 0.06;
        let side = 40;
        let vertex = |i: u32| DVec3::new(f64::from(i % side), f64::from(i / side), height(i));
        let square = |i: u32| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]];
        let corners = (0..side * (side - 1)).filter(|i| i % side < side - 1);
        let vertices = (0..side * side).map(vertex).collect();
        let mesh = Mesh::new(vertices, corners.flat_map(square).collect()).unwrap();
        let topology = Topology::of(&mesh);
        let partition = partition(&mesh, &topology);
        let patches = &partition.patches;
        assert!(patches.len() > 20 && patches.len() < mesh.faces().len() / 4);
        let limits = Limits::of(&mesh.bounds());
        for border in borders(&mesh, &topology, &partition) {
            let [a, b] = [border.own, border.other].map(|p| patches[p as usize]);
            assert!(limits.joined(&a, &b).is_none(), "{} and {}", border.own, border.other);
        }
    }
}
