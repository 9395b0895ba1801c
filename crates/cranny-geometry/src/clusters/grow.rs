//! Clusters: neighbouring faces of nearly one normal, paired again and again.
//!
//! In each round groups that share an edge are paired, those first whose common box is flattest and
//! smallest for what it holds, each group once; so single faces become twos, fours and eights. No
//! source: this crate's own; a tree is right whatever is paired. Cost: O(n log n) for each of a few
//! rounds.

use cranny_exact::DVec3;

use super::Surface;
use super::lanes::LANES;
use super::oriented::{frame_along, half_area};
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
    /// Half the surface of its box.
    area: f64,
}

/// The faces of each cluster, 1 to [`LANES`].
pub(super) fn groups(surface: &Surface) -> Vec<Vec<FaceId>> {
    let count = surface.mesh.faces().len() as u32;
    let mut points = Vec::new();
    let mut groups: Vec<Group> = (0..count)
        .map(|f| {
            let faces = vec![FaceId(f)];
            let area = box_area(surface, &faces, surface.normal(FaceId(f)), &mut points);
            Group { faces, area }
        })
        .collect();
    let mut group_of: Vec<u32> = (0..count).collect();
    for _ in 0..ROUNDS {
        let mut pairs = neighbours(surface, &group_of);
        pairs.retain(|&[i, j]| {
            groups[i as usize].faces.len() + groups[j as usize].faces.len() <= LANES
        });
        let mut offers: Vec<(f64, [u32; 2])> = pairs
            .into_iter()
            .filter_map(|pair| {
                let [i, j] = pair.map(|g| &groups[g as usize]);
                Some((cost(surface, [i, j], &mut points)?, pair))
            })
            .collect();
        offers.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut is_taken = vec![false; groups.len()];
        let mut joined = false;
        for (_, [i, j]) in offers {
            let (i, j) = (i as usize, j as usize);
            if is_taken[i] || is_taken[j] {
                continue;
            }
            (is_taken[i], is_taken[j], joined) = (true, true, true);
            let moved = std::mem::take(&mut groups[j].faces);
            for face in &moved {
                group_of[face.index()] = i as u32;
            }
            groups[i].faces.extend(moved);
            let normal = mean(surface, &groups[i].faces);
            groups[i].area = box_area(surface, &groups[i].faces, normal, &mut points);
        }
        if !joined {
            break;
        }
    }
    groups.into_iter().map(|group| group.faces).filter(|faces| !faces.is_empty()).collect()
}

/// Groups that share an edge, each pair once.
fn neighbours(surface: &Surface, group_of: &[u32]) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for edge in 0..surface.topology.edges().len() as u32 {
        let around = surface.topology.half_edges(crate::ids::EdgeId(edge));
        for two in around.windows(2) {
            let [i, j] = [two[0], two[1]].map(|h| group_of[h.face().index()]);
            if i != j {
                pairs.push([i.min(j), i.max(j)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Of joining two groups; `None` where they are to stay apart.
fn cost(surface: &Surface, [a, b]: [&Group; 2], points: &mut Vec<DVec3>) -> Option<f64> {
    let mut faces = [FaceId(0); LANES];
    let count = a.faces.len() + b.faces.len();
    for (slot, face) in faces.iter_mut().zip(a.faces.iter().chain(&b.faces)) {
        *slot = *face;
    }
    let faces = &faces[..count];
    let normal = mean(surface, faces);
    let looks_that_way = |&face: &FaceId| {
        let own = surface.normal(face);
        own == DVec3::ZERO || own.dot(normal) >= LEAST_COSINE
    };
    if !faces.iter().all(looks_that_way) {
        return None;
    }
    let area = box_area(surface, faces, normal, points);
    let growth = area / (a.area + b.area);
    // Of a needle's box the area may be nothing: it goes with any neighbour.
    (growth <= MOST_GROWTH || !growth.is_finite()).then(|| growth * area.sqrt().sqrt())
}

/// The mean of the faces' normals, unit, or zero.
pub(super) fn mean(surface: &Surface, faces: &[FaceId]) -> DVec3 {
    faces.iter().map(|&face| surface.normal(face)).sum::<DVec3>().normalize_or_zero()
}

fn box_area(surface: &Surface, faces: &[FaceId], normal: DVec3, points: &mut Vec<DVec3>) -> f64 {
    points.clear();
    points.extend(faces.iter().flat_map(|&face| surface.triangle(face)));
    half_area(points, &frame_along(points, normal))
}
