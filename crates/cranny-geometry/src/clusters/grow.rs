//! Clusters: neighbouring faces of nearly one normal, paired again and again.
//!
//! In each round groups that share an edge are paired, those first whose common box is flattest and
//! smallest for what it holds, each group once; so single faces become twos, fours and eights. No
//! source: this crate's own; a tree is right whatever is paired. Cost: O(n log n) for each of a few
//! rounds.

use cranny_exact::DVec3;

use super::Surface;
use super::lanes::LANES;
use super::oriented::{Points2, Spread, frame_along, half_area};
use crate::ids::FaceId;

/// Cosine of the angle between a face's normal and that of its group at most: 14 degrees. Smaller
/// angles: curved surfaces fall into single faces; larger: groups are thicker, and more pairs of
/// them come near.
const LEAST_COSINE: f64 = 0.97;

/// The common box of two groups has at most so many times the area of both. Larger: groups of a
/// thread mix what lies apart; smaller: fewer are joined, and there are more nodes.
const MOST_GROWTH: f64 = 2.5;

/// Rounds at most: three make eight of one, the others join what was left over.
const ROUNDS: usize = 6;

struct Group {
    faces: Vec<FaceId>,
    /// Their corners, each once.
    points: Vec<Points2>,
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
        let points = vec![Points2::of([a, b]), Points2::of([c, c])];
        let (spread, normal) = (Spread::of(triangle.into_iter()), surface.normal(face));
        let area = half_area(points.iter(), &frame_along(&spread, normal));
        Self { faces: vec![face], points, spread, normal, area }
    }

    /// Half the surface of the box over two groups.
    fn area_with(&self, other: &Self) -> f64 {
        let normal = (self.normal + other.normal).normalize_or_zero();
        let frame = frame_along(&self.spread.with(&other.spread), normal);
        half_area(self.points.iter().chain(&other.points), &frame)
    }

    fn join(&mut self, surface: &Surface, other: Self) {
        self.area = self.area_with(&other);
        self.spread = self.spread.with(&other.spread);
        self.normal += other.normal;
        self.faces.extend(other.faces);
        self.points.clear();
        self.points.extend(surface.points_at(&surface.vertices_of(&self.faces)));
    }
}

/// The faces of each cluster, 1 to [`LANES`].
pub(super) fn groups(surface: &Surface) -> Vec<Vec<FaceId>> {
    let count = surface.mesh.faces().len() as u32;
    // `None` of those that have joined another.
    let mut groups: Vec<Option<Group>> =
        (0..count).map(|f| Some(Group::of_face(surface, FaceId(f)))).collect();
    let mut group_of: Vec<u32> = (0..count).collect();
    for _ in 0..ROUNDS {
        // In single precision: of costs that are equal but for rounding, the pair decides.
        let mut offers: Vec<(f32, [u32; 2])> = neighbours(surface, &group_of)
            .into_iter()
            .filter_map(|pair| {
                let [i, j] = pair.map(|g| groups[g as usize].as_ref());
                Some((cost(surface, [i?, j?])? as f32, pair))
            })
            .collect();
        offers.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut is_taken = vec![false; groups.len()];
        let mut joined = false;
        for (_, [i, j]) in offers {
            let (to, from) = (i as usize, j as usize);
            if is_taken[to] || is_taken[from] {
                continue;
            }
            (is_taken[to], is_taken[from], joined) = (true, true, true);
            let moved = groups[from].take();
            if let (Some(group), Some(moved)) = (&mut groups[to], moved) {
                for face in &moved.faces {
                    group_of[face.index()] = i;
                }
                group.join(surface, moved);
            }
        }
        if !joined {
            break;
        }
    }
    groups.into_iter().flatten().map(|group| group.faces).collect()
}

/// Groups that share an edge, each pair once, ascending.
fn neighbours(surface: &Surface, group_of: &[u32]) -> Vec<[u32; 2]> {
    // A pair as one number.
    let mut pairs = Vec::new();
    for edge in 0..surface.topology.edges().len() as u32 {
        let around = surface.topology.half_edges(crate::ids::EdgeId(edge));
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

/// Of joining two groups; `None` where they are to stay apart.
fn cost(surface: &Surface, [a, b]: [&Group; 2]) -> Option<f64> {
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
    let area = a.area_with(b);
    let growth = area / (a.area + b.area);
    // Of a needle's box the area may be nothing: it goes with any neighbour.
    (growth <= MOST_GROWTH || !growth.is_finite()).then(|| growth * area.sqrt().sqrt())
}

/// The mean of the faces' normals, unit, or zero.
pub(super) fn mean(surface: &Surface, faces: &[FaceId]) -> DVec3 {
    faces.iter().map(|&face| surface.normal(face)).sum::<DVec3>().normalize_or_zero()
}
