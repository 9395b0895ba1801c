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
use super::oriented::{FILE_NOISE, PointPair, Spread, frame_along, half_area_along};
use crate::each_once::each_once;
use crate::ids::{FaceId, HalfEdgeId};

/// Cosine of the angle between a face's normal and that of its group at most: 14 degrees. Smaller
/// angles: curved surfaces fall into single faces; larger: groups are thicker, and more pairs of
/// them come near.
const LEAST_COSINE: f64 = 0.97;

/// The common box of two groups has at most so many times the area of both. Larger: groups of a
/// thread mix what lies apart; smaller: fewer are joined, and there are more nodes.
const MOST_GROWTH: f64 = 2.5;

/// Rounds at most: three make eight of one, the others join what was left over.
const ROUNDS: usize = 6;

/// Groups of at most so many faces are shared out. Fewer: groups that are too large for each other
/// stay half full; more: what is nearly full is taken apart for little.
const MOST_SHARED: usize = 6;

/// Faces that become a cluster. Empty once joined to another group.
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

/// What it costs to join two groups.
#[derive(Clone, Copy)]
struct Join {
    cost: f64,
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
            // Two needles whose boxes have no area are joined after all others.
            return Some(Self { cost: f64::INFINITY, area });
        }
        let growth = area / alone;
        let cost = growth * area.sqrt().sqrt();
        (growth <= MOST_GROWTH).then_some(Self { cost, area })
    }

    /// What costs more than this costs more by more than rounding.
    fn same_cost(&self) -> f64 {
        self.cost * (1.0 + FILE_NOISE)
    }
}

/// Two groups that may be joined.
struct Offer {
    pair: [u32; 2],
    join: Join,
    /// Offers of one cost have the same.
    class: u32,
}

/// All pairs of neighbours that may be joined, the cheapest first; of those that cost the same, the
/// lower pair.
fn offers(surface: &Surface, groups: &[Group], group_of: &[u32]) -> Vec<Offer> {
    let offer = |pair: [u32; 2]| {
        let join = Join::of(surface, pair.map(|g| &groups[g as usize]))?;
        Some(Offer { pair, join, class: 0 })
    };
    let mut offers: Vec<Offer> =
        neighbours(surface, group_of).into_iter().filter_map(offer).collect();
    offers.sort_unstable_by(|x, y| x.join.cost.total_cmp(&y.join.cost));
    // A class begins where one ends: bounds that are fixed would lie between what is alike.
    let (mut class, mut last) = (0, f64::NEG_INFINITY);
    for offer in &mut offers {
        if offer.join.cost > last {
            class += 1;
            last = offer.join.same_cost();
        }
        offer.class = class;
    }
    offers.sort_unstable_by_key(|offer| (offer.class, offer.pair));
    offers
}

/// The faces of each cluster, 1 to [`LANES`].
pub(super) fn groups(surface: &Surface) -> Vec<Vec<FaceId>> {
    let mut groups: Vec<Group> =
        surface.mesh.face_ids().map(|f| Group::of_face(surface, f)).collect();
    let mut group_of: Vec<u32> = (0..groups.len() as u32).collect();
    for _ in 0..ROUNDS {
        let mut is_taken = vec![false; groups.len()];
        let mut joined = false;
        for Offer { pair: [i, j], join, .. } in offers(surface, &groups, &group_of) {
            let (to, from) = (i as usize, j as usize);
            if is_taken[to] || is_taken[from] {
                continue;
            }
            (is_taken[to], is_taken[from], joined) = (true, true, true);
            let moved = std::mem::take(&mut groups[from]);
            note(&moved, i, &mut group_of);
            groups[to].join(surface, &moved, join.area);
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
    for edge in surface.topology.edge_ids() {
        let around = surface.topology.half_edges(edge);
        for two in around.windows(2) {
            let [i, j] = [two[0], two[1]].map(|h| group_of[h.face().index()]);
            if i != j {
                pairs.push(u64::from(i.min(j)) << 32 | u64::from(i.max(j)));
            }
        }
    }
    each_once(pairs).into_iter().map(|pair| [(pair >> 32) as u32, pair as u32]).collect()
}

/// Notes that a group's faces belong to `group`.
fn note(faces_of: &Group, group: u32, group_of: &mut [u32]) {
    for face in &faces_of.faces {
        group_of[face.index()] = group;
    }
}

/// Shares out the faces of small groups, by their size at first, where their neighbours can take
/// all.
fn share_out(surface: &Surface, groups: &mut [Group], group_of: &mut [u32]) {
    let is_small = |group: &Group| (1..=MOST_SHARED).contains(&group.faces.len());
    let mut small: Vec<(usize, u32)> = groups
        .iter()
        .zip(0..)
        .filter(|(group, _)| is_small(group))
        .map(|(group, i)| (group.faces.len(), i))
        .collect();
    small.sort_unstable();
    for (_, i) in small {
        // It may have grown since.
        if !is_small(&groups[i as usize]) {
            continue;
        }
        let Some(larger) = larger_by(surface, groups, group_of, i) else { continue };
        groups[i as usize] = Group::default();
        for (to, group) in larger {
            note(&group, to, group_of);
            groups[to as usize] = group;
        }
    }
}

/// Returns the neighbours of a group after they took all its faces, or `None` if a face fits
/// nowhere. Neighbours share a manifold edge: about one of many faces, all would be compared.
fn larger_by(
    surface: &Surface,
    groups: &[Group],
    group_of: &[u32],
    small: u32,
) -> Option<BTreeMap<u32, Group>> {
    let mut larger: BTreeMap<u32, Group> = BTreeMap::new();
    let mut left = groups[small as usize].faces.clone();
    while !left.is_empty() {
        let before = left.len();
        left.retain(|&face| {
            let single = Group::of_face(surface, face);
            let beside = |corner: usize| {
                let next = surface.topology.twin(HalfEdgeId::of(face, corner))?.face();
                let holds = |(_, group): &(&u32, &Group)| group.faces.contains(&next);
                let to = larger.iter().find(holds).map_or(group_of[next.index()], |(&to, _)| to);
                if to == small {
                    return None;
                }
                let into = larger.get(&to).unwrap_or(&groups[to as usize]);
                Some((to, Join::of(surface, [into, &single])?))
            };
            let mut offers: Vec<(u32, Join)> = (0..3).filter_map(beside).collect();
            let least =
                offers.iter().map(|(_, join)| join.same_cost()).fold(f64::INFINITY, f64::min);
            offers.retain(|(_, join)| join.cost <= least);
            let best = offers.into_iter().min_by_key(|(to, _)| *to);
            if let Some((to, join)) = best {
                let into = larger.entry(to).or_insert_with(|| groups[to as usize].clone());
                into.join(surface, &single, join.area);
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
