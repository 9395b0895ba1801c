//! Clusters: neighbouring faces of nearly one normal, paired again and again.
//!
//! In each round groups that share an edge are paired, those first whose common box is flattest and
//! smallest for what it holds, each group once; so single faces become twos, fours and eights. In
//! the end the faces of small groups are shared out among neighbours that have room: groups of five
//! would stay as they are, since two of them are too many. No source: this crate's own; a tree is
//! right whatever is paired. Cost: O(n log n) for each of a few rounds.

use std::collections::BTreeMap;

use cranny_exact::DVec3;

use super::Surface;
use super::lanes::LANES;
use super::oriented::{PointPair, Spread, frame_along, half_area_along};
use crate::ids::{EdgeId, FaceId, HalfEdgeId};

/// Cosine of the angle between a face's normal and that of its group at most: 18 degrees. Smaller
/// angles: curved surfaces fall into single faces; larger: groups are thicker, and more pairs of
/// them come near.
const LEAST_COSINE: f64 = 0.95;

/// The common box of two groups has at most so many times the area of both. Larger: groups of a
/// thread mix what lies apart; smaller: fewer are joined, and there are more nodes.
const MOST_GROWTH: f64 = 2.5;

/// Rounds at most: three make eight of one, the others join what was left over.
const ROUNDS: usize = 6;

/// Groups of at most so many faces are shared out. Fewer: groups that are too large for each other
/// stay half full; more: what is nearly full is taken apart for little.
const MOST_SHARED: usize = 6;

/// Costs that differ below this bit of single precision (3 parts in 100,000) are the same: of a
/// regular mesh most joins cost the same, and rounding of its coordinates shall not choose.
/// Smaller: it does; larger: a worse join comes first.
const RANK_BITS: u32 = 8;

/// Faces that become a cluster; none in a group that was joined to another.
#[derive(Clone, Default)]
struct Group {
    faces: Vec<FaceId>,
    /// Their corners, each once.
    points: Vec<PointPair>,
    /// Of the corners of each face.
    spread: Spread,
    /// The sum of the faces' normals.
    normal: DVec3,
    /// Half the surface of its box.
    area: f64,
}

impl Group {
    fn of_face(surface: &Surface, face: FaceId) -> Self {
        let triangle = surface.triangle(face);
        let [a, b, c] = triangle;
        let points = vec![PointPair::of([a, b]), PointPair::of([c, c])];
        let (spread, normal) = (Spread::of(triangle.into_iter()), surface.normal(face));
        let area = half_area_along(points.iter(), &frame_along(&spread, normal));
        Self { faces: vec![face], points, spread, normal, area }
    }

    /// Half the surface of the box over two groups, given the direction of both.
    fn area_with(&self, other: &Self, normal: DVec3) -> f64 {
        let frame = frame_along(&self.spread.with(&other.spread), normal);
        half_area_along(self.points.iter().chain(&other.points), &frame)
    }

    /// Takes in the faces of another group, given the area of both.
    fn join(&mut self, surface: &Surface, other: &Self, area: f64) {
        self.area = area;
        self.spread = self.spread.with(&other.spread);
        self.normal += other.normal;
        self.faces.extend(&other.faces);
        self.points.clear();
        self.points.extend(surface.points_at(&surface.vertices_of(&self.faces)));
    }
}

/// How good it is to join two groups.
#[derive(Clone, Copy)]
struct Join {
    /// Ascending with the cost.
    rank: u32,
    /// Half the surface of the box over both.
    area: f64,
}

impl Join {
    /// Of two groups; `None` where they are to stay apart.
    fn of(surface: &Surface, [a, b]: [&Group; 2]) -> Option<Self> {
        if a.faces.len() + b.faces.len() > LANES {
            return None;
        }
        let normal = (a.normal + b.normal).normalize_or_zero();
        let looks_that_way = |&face: &FaceId| {
            let own = surface.normal(face);
            own == DVec3::ZERO || own.dot(normal) >= LEAST_COSINE
        };
        if !a.faces.iter().chain(&b.faces).all(looks_that_way) {
            return None;
        }
        let (area, alone) = (a.area_with(b, normal), a.area + b.area);
        if alone == 0.0 {
            // Needles whose boxes have no area go with any neighbour, after all others.
            return Some(Self { rank: u32::MAX, area });
        }
        let growth = area / alone;
        let cost = (growth * area.sqrt().sqrt()) as f32;
        let rank = (cost.to_bits() + (1 << (RANK_BITS - 1))) >> RANK_BITS;
        (growth <= MOST_GROWTH).then_some(Self { rank, area })
    }
}

/// The faces of each cluster, 1 to [`LANES`].
pub(super) fn groups(surface: &Surface) -> Vec<Vec<FaceId>> {
    let count = surface.mesh.faces().len() as u32;
    let mut groups: Vec<Group> = (0..count).map(|f| Group::of_face(surface, FaceId(f))).collect();
    let mut group_of: Vec<u32> = (0..count).collect();
    for _ in 0..ROUNDS {
        let mut offers: Vec<([u32; 2], Join)> = neighbours(surface, &group_of)
            .into_iter()
            .filter_map(|pair| {
                let join = Join::of(surface, pair.map(|g| &groups[g as usize]))?;
                Some((pair, join))
            })
            .collect();
        offers.sort_unstable_by_key(|(pair, join)| (join.rank, *pair));
        let mut is_taken = vec![false; groups.len()];
        let mut joined = false;
        for ([i, j], Join { area, .. }) in offers {
            let (to, from) = (i as usize, j as usize);
            if is_taken[to] || is_taken[from] {
                continue;
            }
            (is_taken[to], is_taken[from], joined) = (true, true, true);
            let moved = std::mem::take(&mut groups[from]);
            for face in &moved.faces {
                group_of[face.index()] = i;
            }
            groups[to].join(surface, &moved, area);
        }
        if !joined {
            break;
        }
    }
    share_out(surface, &mut groups, &mut group_of);
    groups.into_iter().map(|group| group.faces).filter(|faces| !faces.is_empty()).collect()
}

/// Groups that share an edge, each pair once, ascending.
fn neighbours(surface: &Surface, group_of: &[u32]) -> Vec<[u32; 2]> {
    // A pair as one number.
    let mut pairs = Vec::new();
    for edge in 0..surface.topology.edges().len() as u32 {
        let around = surface.topology.half_edges(EdgeId(edge));
        for two in around.windows(2) {
            let [i, j] = [two[0], two[1]].map(|h| group_of[h.face().index()]);
            if i != j {
                pairs.push(u64::from(i.min(j)) << 32 | u64::from(i.max(j)));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs.into_iter().map(|pair| [(pair >> 32) as u32, pair as u32]).collect()
}

/// Shares out the faces of small groups, the smallest first, where their neighbours can take all.
fn share_out(surface: &Surface, groups: &mut [Group], group_of: &mut [u32]) {
    let is_small = |group: &Group| (1..=MOST_SHARED).contains(&group.faces.len());
    let mut small: Vec<(usize, u32)> = groups
        .iter()
        .zip(0..)
        .filter(|(g, _)| is_small(g))
        .map(|(g, i)| (g.faces.len(), i))
        .collect();
    small.sort_unstable();
    for (_, i) in small {
        // It may have grown since.
        if !is_small(&groups[i as usize]) {
            continue;
        }
        let Some(larger) = neighbours_with_all(surface, groups, group_of, i) else { continue };
        groups[i as usize] = Group::default();
        for (to, group) in larger {
            for face in &group.faces {
                group_of[face.index()] = to;
            }
            groups[to as usize] = group;
        }
    }
}

/// What the neighbours of a group become that take its faces; `None` where one is left over.
fn neighbours_with_all(
    surface: &Surface,
    groups: &[Group],
    group_of: &[u32],
    small: u32,
) -> Option<BTreeMap<u32, Group>> {
    let mut larger: BTreeMap<u32, Group> = BTreeMap::new();
    let mut taken: BTreeMap<FaceId, u32> = BTreeMap::new();
    let mut left = groups[small as usize].faces.clone();
    while !left.is_empty() {
        let before = left.len();
        left.retain(|&face| {
            let single = Group::of_face(surface, face);
            let beside = |corner: usize| {
                let next = surface.topology.twin(HalfEdgeId::of(face, corner))?.face();
                let to = *taken.get(&next).unwrap_or(&group_of[next.index()]);
                let into = larger.get(&to).unwrap_or(&groups[to as usize]);
                Some((to, Join::of(surface, [into, &single])?)).filter(|_| to != small)
            };
            let best = (0..3).filter_map(beside).min_by_key(|(to, join)| (join.rank, *to));
            if let Some((to, join)) = best {
                let into = larger.entry(to).or_insert_with(|| groups[to as usize].clone());
                into.join(surface, &single, join.area);
                taken.insert(face, to);
            }
            best.is_none()
        });
        if left.len() == before {
            return None;
        }
    }
    Some(larger)
}

/// The mean of the faces' normals, unit, or zero.
pub(super) fn mean(surface: &Surface, faces: &[FaceId]) -> DVec3 {
    faces.iter().map(|&face| surface.normal(face)).sum::<DVec3>().normalize_or_zero()
}
