//! Which vertices about a crossing lie inside the other solid.
//!
//! Both ends of an edge that does not meet the other surface are on one side of it. So one vertex
//! is located for all that hang together by such edges: mostly one within and one without, whatever
//! the number of faces that cross.

use cranny_exact::{Meeting, WeightedPoint, classify_segment_triangle};
use cranny_geometry::{FaceId, VertexId};

use crate::inside::{Location, locate};
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};
use crate::pieces::{Inside, leaving};
use crate::surface::FacePair;
use crate::tally::Tally;

/// Lists the vertices of a body that lie inside the other one, which is closed: those of faces that
/// meet the other's, and what can be reached from these inside. `meeting` holds all pairs of faces
/// that meet.
///
/// Cost: a search along a ray for each set of vertices that hangs together; a test for each edge of
/// a face that meets and each face that it may; the vertices found.
pub(super) fn vertices_within(
    pair: &Pair,
    side: Side,
    meeting: &[FacePair],
    counters: &mut impl Tally,
) -> Inside {
    let mesh = pair.mesh(side);
    let own = |p: &FacePair| p.face(side);
    let key = |v: VertexId| u64::from(v.0);
    let mut faces: Vec<FaceId> = meeting.iter().map(own).collect();
    faces.sort_unstable();
    faces.dedup();
    let mut at_faces = Numbering::for_keys(faces.len());
    let mut start: Vec<VertexId> = faces.into_iter().flat_map(|f| mesh.corners(f)).collect();
    start.retain(|&v| at_faces.number(key(v)).1);
    let cut = edges_that_meet(pair, side, meeting);
    let mut known = Numbering::for_keys(start.len());
    let (mut found, mut set) = (Inside::new(), 0);
    let mut sure: Vec<VertexId> = Vec::new();
    for vertex in start {
        if !known.number(key(vertex)).1 {
            continue;
        }
        let p = WeightedPoint::at(pair.position(side, vertex));
        let is_inside = locate(pair, side.other(), &p, counters) == Location::Inside;
        sure.push(vertex);
        while let Some(v) = sure.pop() {
            if is_inside {
                found.push((v, set));
            }
            for &face in pair.topology(side).faces_at(v) {
                // That way round is enough: a face that does not meet the other surface leads to
                // all its corners, and those of one that does are in the list that begins it all.
                for (i, w) in leaving(mesh.corners(face), v) {
                    // Outside, no farther than the faces that meet.
                    let is_wanted = || is_inside || at_faces.get(key(w)).is_some();
                    let is_whole = || cut.get(u64::from(pair.edge(side, face, i).0)).is_none();
                    if known.get(key(w)).is_none() && is_wanted() && is_whole() {
                        known.number(key(w));
                        sure.push(w);
                    }
                }
            }
        }
        set += u32::from(is_inside);
    }
    found
}

/// The edges of a body that meet the other surface, numbered.
fn edges_that_meet(pair: &Pair, side: Side, meeting: &[FacePair]) -> Numbering {
    let (mut tried, mut found) = (Numbering::default(), Numbering::for_keys(meeting.len()));
    for p in meeting {
        let [own, its] = match side {
            Side::First => [p.first, p.second],
            Side::Second => [p.second, p.first],
        };
        // Where faces cross in general position, the ends of what they share name the edges that
        // pierce.
        if let Some(crossing) = p.crossing {
            for end in crossing.ends.iter().filter(|end| usize::from(end.owner) == side.index()) {
                found.number(u64::from(pair.edge(side, own, usize::from(end.edge)).0));
            }
            continue;
        }
        let (corners, other) = (pair.triangle(side, own), pair.triangle(side.other(), its));
        for i in 0..3 {
            let edge = pair.edge(side, own, i);
            let both = u64::from(edge.0) << 32 | u64::from(its.0);
            if found.get(u64::from(edge.0)).is_some() || !tried.number(both).1 {
                continue;
            }
            let segment = [corners[i], corners[(i + 1) % 3]];
            if classify_segment_triangle(&segment, &other) != Meeting::None {
                found.number(u64::from(edge.0));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::intersection::{Chains, intersect};
    use crate::pieces::tests::{bodies, placed};
    use crate::pieces::{Cuts, Piece, RegionPieces, cut};
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use cranny_exact::{DQuat, DVec3, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::{Comb, Cuboid, Cup, Shape, Torus};
    use cranny_testkit::Rng;

    fn model(mesh: Mesh) -> Model {
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    /// Two cubes that overlap, as one mesh: within both, a vertex is inside twice.
    fn doubled() -> Model {
        let cube = Shape::from(Cuboid::default()).build().unwrap();
        let n = cube.vertices().len() as u32;
        let moved = cube.vertices().iter().map(|p| *p + DVec3::new(0.4, 0.3, 0.2));
        let vertices = cube.vertices().iter().copied().chain(moved).collect();
        let again = cube.faces().iter().map(|f| f.map(|v| v + n));
        model(Mesh::new(vertices, cube.faces().iter().copied().chain(again).collect()).unwrap())
    }

    /// Every vertex that is reached is located by itself.
    fn asked_one_by_one(pair: &Pair, side: Side, meeting: &[FacePair]) -> Vec<VertexId> {
        let mesh = pair.mesh(side);
        let own = |p: &FacePair| if side == Side::First { p.first } else { p.second };
        let mut front: Vec<VertexId> = meeting.iter().flat_map(|p| mesh.corners(own(p))).collect();
        let (mut seen, mut found) = (vec![false; mesh.vertices().len()], Vec::new());
        while let Some(v) = front.pop() {
            let p = WeightedPoint::at(pair.position(side, v));
            let is_new = !std::mem::replace(&mut seen[v.index()], true);
            if is_new
                && locate(pair, side.other(), &p, &mut Counters::default()) == Location::Inside
            {
                found.push(v);
                front.extend(pair.topology(side).faces_at(v).iter().flat_map(|&f| mesh.corners(f)));
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn what_hangs_together_is_on_one_side() {
        let shapes: [Shape; 4] = [
            Cuboid::default().into(),
            Cup { segments: 9, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            Torus { major_segments: 12, minor_segments: 7, ..Torus::default() }.into(),
        ];
        let mut bodies: Vec<Model> = shapes.map(|s| model(s.build().unwrap())).into();
        bodies.push(doubled());
        let mut rng = Rng::new(21);
        let (mut some, mut spared) = (0, 0);
        for round in 0..400 {
            // Every other one without a turn and at quarters: faces on faces, corners on faces and
            // on edges.
            let turned = round % 2 == 1;
            let [a, b] = [&bodies[rng.below(5)], &bodies[rng.below(5)]];
            let turn = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
            let rotation = if turned { turn } else { DQuat::IDENTITY };
            let mut step = || 0.25 * rng.below(9) as f64 - 1.0;
            let translation = DVec3::new(step(), step(), step());
            let pair = Pair::of_accepted(
                Placed { model: a, pose: Pose::IDENTITY },
                Placed { model: b, pose: Pose { rotation, translation } },
            );
            let meeting = meeting_pairs(&pair, &mut Counters::default());
            for side in Side::BOTH {
                let mut counters = Counters::default();
                let found = vertices_within(&pair, side, &meeting, &mut counters);
                let mut found: Vec<VertexId> = found.into_iter().map(|(v, _)| v).collect();
                found.sort_unstable();
                assert_eq!(found, asked_one_by_one(&pair, side, &meeting), "round {round}");
                some += u32::from(!found.is_empty());
                spared += u32::from(turned && counters.inside_tests < found.len() as u64);
            }
        }
        assert!(some > 150 && spared > 30, "{some} {spared}");
    }

    /// By what is located and by the curves alone, the same vertices are inside and make the same
    /// regions.
    #[test]
    fn vertices_within_make_the_regions_that_curves_cut_out() {
        let bodies = bodies();
        let mut rng = Rng::new(22);
        let (mut regions, mut of_many_curves, mut without_vertices) = (0, 0, 0);
        for round in 0..300 {
            let pair = placed([&bodies[rng.below(4)], &bodies[rng.below(4)]], &mut rng);
            let meeting = meeting_pairs(&pair, &mut Counters::default());
            let intersection = intersect(&pair, &meeting);
            assert!(intersection.generic, "round {round}");
            let within = |side| vertices_within(&pair, side, &meeting, &mut Counters::default());
            let cuts = Cuts::of(&pair, &intersection);
            let seen = |regions: Vec<RegionPieces>| -> Vec<_> {
                let sorted = |piece: &Piece| {
                    let mut vertices = piece.vertices.clone();
                    vertices.sort_unstable();
                    vertices
                };
                let of = |r: RegionPieces| (r.pieces.each_ref().map(sorted), r.segments);
                regions.into_iter().map(of).collect()
            };
            let found = seen(cuts.regions(&Side::BOTH.map(within)));
            assert_eq!(found, seen(cut(&pair, &intersection)), "round {round}");
            regions += found.len();
            let mut chains = Chains::of(&intersection);
            of_many_curves += found.iter().filter(|r| chains.follow(&r.1).len() > 1).count();
            without_vertices += found.iter().filter(|r| r.0.iter().all(Vec::is_empty)).count();
        }
        let seen = [regions, of_many_curves, without_vertices];
        assert!(seen.iter().zip([200, 30, 10]).all(|(seen, least)| *seen > least), "{seen:?}");
    }
}
