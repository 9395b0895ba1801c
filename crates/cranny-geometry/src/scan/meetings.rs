//! Faces of one mesh that meet where they should not: self-intersection, overlap in a plane, touch.
//!
//! The face tree is paired with itself; what the boxes leave is judged by signs ([`judge`]). Two
//! things keep the pairs few. Parts of the surface that are seen from one side without overlap meet
//! nowhere and are not searched ([`views`](super::views)); and where very many faces share a
//! vertex, they are paired by the directions in which they lie from it, not by their boxes, which
//! all hold it ([`crowds`](super::crowds)).
//!
//! Sources: the descent is that of `pairs`; Volino and Magnenat-Thalmann (1994, "Efficient
//! self-collision detection on smoothly discretized surface animations using geometrical shape
//! regularity") leave out parts that are seen from one side, by cones of normals and their
//! outlines. Cost: O(n log n) as a rule for sound meshes; each pair that boxes leave elsewhere is
//! judged, up to [`TESTS_AT_LEAST`] and [`TESTS_A_FACE`] more for each face.

use std::ops::ControlFlow;

use cranny_exact::Aabb;

use super::crowds::Crowds;
use super::judge::judge;
use super::pairs::overlapping_pairs;
use super::stars::Stars;
use super::turns::Turn;
use super::views::Views;
use crate::each_once::each_once;
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::report::{Finding, FindingKind, MeetingScan};
use crate::topology::Topology;
use crate::tree::FaceTree;

/// Pairs judged for each face before the search gives up, and for the mesh at large. Sound meshes
/// need a few a face. Smaller, and the search ends at meshes of a few thousand faces that all come
/// near each other; larger, and a mesh whose faces all meet each other takes more than seconds.
const TESTS_A_FACE: usize = 64;
const TESTS_AT_LEAST: usize = 1 << 23;

/// Judges all pairs of faces but those that `left_out` names (faces without area, all but one of
/// those in one place), given the turns of all. A mere touch that `explained` knows the reason of
/// is not reported. Faces around a vertex whose star is spread out need no judgement.
pub(super) fn meetings(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    stars: &mut Stars,
    turns: &[Turn],
    left_out: &[bool],
    explained: impl Fn(FaceId, FaceId) -> bool,
) -> (Vec<Finding>, MeetingScan) {
    let limit = TESTS_AT_LEAST + TESTS_A_FACE * mesh.faces().len();
    let (mut found, mut tests) = (Vec::new(), 0);
    let crowds = Crowds::of(mesh, topology, tree, stars);
    let mut look_at = |f: FaceId, g: FaceId, in_crowd: bool| {
        if tests == limit {
            return ControlFlow::Break(());
        }
        tests += 1;
        if left_out[f.index()] || left_out[g.index()] {
            return ControlFlow::Continue(());
        }
        let pair = [f.min(g), f.max(g)];
        let settled = |v: VertexId| !in_crowd && (stars.is_spread(v) || crowds.holds(v));
        if let Some(kind) = judge(mesh, pair, settled)
            && !(kind == FindingKind::SelfTouch && explained(f, g))
        {
            found.push((kind, pair));
        }
        ControlFlow::Continue(())
    };
    let mut views = Views::of(mesh, topology, tree, turns);
    let opens = |i, j| if i == j { !views.is_clear(i) } else { !crowds.settle(i, j) };
    let ended = match crowds.pairs(|f, g| look_at(f, g, true)) {
        ControlFlow::Continue(()) => overlapping_pairs(tree, opens, |f, g| look_at(f, g, false)),
        stopped => stopped,
    };
    let scan = match ended {
        ControlFlow::Continue(()) => MeetingScan::Complete,
        ControlFlow::Break(()) => MeetingScan::Stopped { tests },
    };
    (findings(mesh, found), scan)
}

fn findings(mesh: &Mesh, found: Vec<(FindingKind, [FaceId; 2])>) -> Vec<Finding> {
    let finding = |(kind, pair): (FindingKind, [FaceId; 2])| {
        let [a, b] = pair.map(|f| Aabb::of_points(mesh.triangle(f)));
        let common = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
        let ids = pair.map(|f| f.0).to_vec();
        Finding::one(kind, ids, common.center(), common.diagonal())
    };
    // Two crowds may have two faces in common.
    each_once(found).into_iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    fn pairs_of(mesh: &Mesh, leaf_size: usize) -> Vec<[u32; 2]> {
        let topology = Topology::of(mesh);
        let tree = FaceTree::of(mesh, leaf_size);
        let left_out = vec![false; mesh.faces().len()];
        let mut stars = Stars::of(mesh, &topology);
        let turns: Vec<Turn> =
            (0..mesh.faces().len() as u32).map(|f| Turn::of(&mesh.triangle(FaceId(f)))).collect();
        let (found, scan) =
            meetings(mesh, &topology, &tree, &mut stars, &turns, &left_out, |_, _| false);
        assert_eq!(scan, MeetingScan::Complete);
        let mut pairs: Vec<_> = found.iter().map(|f| [f.ids[0], f.ids[1]]).collect();
        pairs.sort_unstable();
        pairs
    }

    fn judged_one_by_one(mesh: &Mesh) -> Vec<[u32; 2]> {
        let count = mesh.faces().len() as u32;
        let pairs = (0..count).flat_map(|f| (f + 1..count).map(move |g| [f, g]));
        pairs.filter(|pair| judge(mesh, pair.map(FaceId), |_| false).is_some()).collect()
    }

    #[test]
    fn every_pair_is_judged_once_at_any_leaf_size() {
        // A stack of parallel blades through one floor.
        let mut vertices = vec![DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y];
        let mut faces = vec![[0, 1, 2]];
        for i in 0..20 {
            let x = 0.1 + 0.1 * f64::from(i);
            let n = vertices.len() as u32;
            vertices.extend([
                DVec3::new(x, 0.5, -1.0),
                DVec3::new(x, 1.5, -1.0),
                DVec3::new(x, 1.0, 1.0),
            ]);
            faces.push([n, n + 1, n + 2]);
        }
        let mesh = Mesh::new(vertices, faces).unwrap();
        for leaf_size in [1, 3, 100] {
            assert_eq!(pairs_of(&mesh, leaf_size), (1..21).map(|i| [0, i]).collect::<Vec<_>>());
        }
    }

    /// A sheet of n by n squares, its corners lifted.
    fn sheet(n: u32, lift: impl Fn(u32, u32) -> DVec3) -> Mesh {
        let vertices = (0..=n).flat_map(|y| (0..=n).map(move |x| (x, y)));
        let vertices =
            vertices.map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0) + lift(x, y));
        let cells = (0..n).flat_map(|y| (0..n).map(move |x| x + y * (n + 1)));
        let faces = cells.flat_map(|i| [[i, i + 1, i + n + 2], [i, i + n + 2, i + n + 1]]);
        Mesh::new(vertices.collect(), faces.collect()).unwrap()
    }

    #[test]
    fn a_cone_of_many_faces_is_searched_to_the_end() {
        let count = 10_000;
        let half = (0..count / 2).map(|i| {
            let t = 4.0 * f64::from(i) / f64::from(count) - 1.0;
            DVec3::new(1.0 - t * t, 2.0 * t, 0.0) / (1.0 + t * t)
        });
        let ring: Vec<DVec3> = half.clone().chain(half.map(|p| -p)).collect();
        let next = |i: u32| 2 + (i + 1) % count;
        let faces: Vec<_> =
            (0..count).flat_map(|i| [[0, 2 + i, next(i)], [1, next(i), 2 + i]]).collect();
        // Upright, and with a tip so far out that its star is not spread out along any axis.
        for tip in [DVec3::Z, DVec3::new(3.0, 2.0, 0.5)] {
            let tips = vec![tip, DVec3::new(0.1, 0.0, -0.1)];
            let mesh = Mesh::new([tips, ring.clone()].concat(), faces.clone()).unwrap();
            assert_eq!(pairs_of(&mesh, 1), Vec::<[u32; 2]>::new());
        }
    }

    #[test]
    fn sheets_that_roll_up_or_fold_meet_as_when_judged_one_by_one() {
        let hash = |x: u32, y: u32| f64::from((x * 7919 + y * 104_729) % 97) / 97.0;
        let wavy = sheet(12, |x, y| hash(x, y) * DVec3::Z);
        assert_eq!(pairs_of(&wavy, 1), Vec::<[u32; 2]>::new());
        let crumpled = sheet(12, |x, y| DVec3::new(2.0 * hash(x, y), 2.0 * hash(y, x + 5), 0.5));
        // Back over itself, and through.
        let folded = sheet(12, |x, _| {
            let k = f64::from(x.saturating_sub(6));
            DVec3::new(-1.5 * k, 0.0, 0.1 * k * (3.0 - k))
        });
        // Up a screw: seen along its axis the turns lie on each other; the last ones dip through.
        let screw = sheet(24, |x, y| {
            let at = f64::from(x) / 2.0;
            let turned = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][(x % 4) as usize];
            let r = 3.0 + f64::from(y);
            let p = DVec3::new(r * turned[0], r * turned[1], if x < 20 { at } else { 22.0 - at });
            p - DVec3::new(f64::from(x), f64::from(y), 0.0)
        });
        for mesh in [crumpled, folded, screw] {
            let expected = judged_one_by_one(&mesh);
            assert!(!expected.is_empty());
            assert_eq!(pairs_of(&mesh, 1), expected);
        }
    }
}
