//! Do the interiors meet, and is one body wholly inside the other? Exact.
//!
//! Where the surfaces share no point, each component lies wholly inside or wholly outside the other
//! solid, and one vertex of it decides. Where they cross, closed solids share interior points.
//! Where they only touch, what the other body has in common with a face cuts it into *cells*: open
//! pieces all of whose points (but for isolated ones) are inside the other solid, or outside, or
//! flush with a face of it that looks the *same* or the *opposite* way. Then
//!
//! - the interiors meet if and only if some cell lies inside the other solid or flush the same way;
//! - A lies in B if and only if no cell of A lies outside B or flush the opposite way, and no cell
//!   of B lies inside A.
//!
//! No cell is constructed. A face with a single cell is judged by a point of it that is not on the
//! other surface: a corner, or a mean of the corners, which is not rounded. Otherwise every cell
//! borders, within the face, on edges of the other body that lie in the face's plane (no face
//! crosses it, so what reaches it from one side ends there), and the [wedge](crate::wedge) of such
//! an edge decides.

use cranny_exact::{DVec2, DVec3, Meeting, Sign, WeightedPoint, orient2d, orient3d};
use cranny_geometry::{DisjointSets, FaceId};

use crate::answer::{Containment, Surface};
use crate::inside::{Location, locate};
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};
use crate::projection::Projection;
use crate::surface::FacePair;
use crate::tally::Tally;
use crate::wedge::Wedge;

/// Whether the solids share interior points, and which lies inside which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solidity {
    /// The solids share interior points.
    pub solid: bool,
    /// One wholly inside the other, the first body being A.
    pub contained: Option<Containment>,
}

impl Solidity {
    /// Decides for surfaces that share no point, exactly: one vertex of each component is
    /// [located](crate::Counters::inside_tests) against the other solid.
    #[must_use]
    pub fn of_disjoint_surfaces(pair: &Pair, counters: &mut impl Tally) -> Self {
        let parts = Side::BOTH.map(|side| whole_components(pair, side, counters));
        verdict(pair, parts, Flush::default())
    }
}

/// Decides; `touching` are the pairs of faces that touch.
pub(crate) fn solidity(
    pair: &Pair,
    surface: Surface,
    touching: &[FacePair],
    counters: &mut impl Tally,
) -> Solidity {
    match surface {
        Meeting::Cross => Solidity { solid: true, contained: None },
        Meeting::None => Solidity::of_disjoint_surfaces(pair, counters),
        Meeting::Touch => {
            let mut parts = Side::BOTH.map(|side| sampled(pair, side, touching, counters));
            for side in Side::BOTH {
                judge_by_edges(pair, side, touching, &mut parts[side.index()]);
            }
            verdict(pair, parts, flush(pair, touching))
        }
    }
}

/// Where the parts of a surface lie with respect to the other solid.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    inside: bool,
    outside: bool,
}

impl Parts {
    fn add(&mut self, location: Location) {
        self.inside |= location == Location::Inside;
        self.outside |= location == Location::Outside;
    }
}

fn verdict(pair: &Pair, [first, second]: [Parts; 2], flush: Flush) -> Solidity {
    let within = |inner: Parts, outer: Parts, outer_side: Side| {
        (inner.inside || flush.same)
            && !(inner.outside || flush.opposite || outer.inside)
            && pair.model(outer_side).is_closed()
    };
    let contained = match (within(first, second, Side::Second), within(second, first, Side::First))
    {
        (true, false) => Some(Containment::AInB),
        (false, true) => Some(Containment::BInA),
        // Each in the other: they coincide, and neither is the inner one.
        _ => None,
    };
    Solidity { solid: first.inside || second.inside || flush.same, contained }
}

fn whole_components(pair: &Pair, side: Side, counters: &mut impl Tally) -> Parts {
    let mut parts = Parts::default();
    if !pair.topology(side.other()).components().iter().any(|c| c.closed) {
        parts.add(Location::Outside);
        return parts;
    }
    for component in pair.topology(side).components() {
        let p = pair.position(side, pair.corner(side, component.first_face, 0));
        parts.add(locate(pair, side.other(), &WeightedPoint::at(p), counters));
    }
    parts
}

/// Points of the faces: one for those that hang together untouched, or a few, some for each that
/// touches.
fn sampled(pair: &Pair, side: Side, touching: &[FacePair], counters: &mut impl Tally) -> Parts {
    let mut numbers = Numbering::for_keys(touching.len());
    // Each that touches, with how many it does, in a point each if it has a single cell; `None`
    // where it overlaps a face of the other solid in one plane: it is flush, or has several cells.
    let mut touched: Vec<(FaceId, Option<u32>)> = Vec::new();
    for t in touching {
        let own = t.face(side);
        let (number, is_new) = numbers.number(key(own));
        if is_new {
            touched.push((own, Some(0)));
        }
        let closed = pair.topology(side.other()).in_closed_component(t.face(side.other()));
        let is_single = |_: &u32| !(closed && view_of_overlap(pair, t).is_some());
        let count = &mut touched[number as usize].1;
        *count = count.filter(is_single).map(|count| count + 1);
    }
    // What is untouched shares no point with the other surface: its first corner is not on it.
    let free = untouched(pair, side, &touched, &numbers).into_iter().map(|face| (face, Some(0)));
    let mut parts = Parts::default();
    for (face, count) in free.chain(touched.iter().copied()) {
        let at = |p| locate(pair, side.other(), &p, counters);
        let points = count.map(|count| samples(pair.triangle(side, face), count));
        let off = points.and_then(|points| points.map(at).find(|&l| l != Location::On));
        parts.add(off.unwrap_or(Location::On));
    }
    parts
}

/// A face, or a few, of all faces that hang together over sides and that touch nothing. Faces are
/// looked at about those that touch: what is not beside these is a whole component.
fn untouched(
    pair: &Pair,
    side: Side,
    touched: &[(FaceId, Option<u32>)],
    numbers: &Numbering,
) -> Vec<FaceId> {
    let (mesh, topology) = (pair.mesh(side), pair.topology(side));
    let mut is_whole = vec![true; topology.components().len()];
    let (mut around, mut ring) = (Numbering::default(), Vec::new());
    for &(face, _) in touched {
        is_whole[topology.component_of(face).index()] = false;
        for &f in mesh.corners(face).iter().flat_map(|&v| topology.faces_at(v)) {
            if numbers.get(key(f)).is_none() && around.number(key(f)).1 {
                ring.push(f);
            }
        }
    }
    let mut sets = DisjointSets::new(ring.len());
    for (n, &face) in ring.iter().enumerate() {
        for h in (0..3).flat_map(|i| topology.half_edges(pair.edge(side, face, i))) {
            if let Some(other) = around.get(key(h.face())) {
                sets.union(n, other as usize);
            }
        }
    }
    let beside = (0..ring.len()).filter(|&n| sets.find(n) == n).map(|n| ring[n]);
    let whole = topology.components().iter().zip(is_whole).filter(|(_, is_whole)| *is_whole);
    beside.chain(whole.map(|(component, _)| component.first_face)).collect()
}

fn key(face: FaceId) -> u64 {
    u64::from(face.0)
}

/// Points of a face of which `touches` isolated ones may be taken: its corners, then distinct
/// points of its inside, on the line between the middles of two sides.
fn samples(corners: [DVec3; 3], touches: u32) -> impl Iterator<Item = WeightedPoint> {
    let steps = touches + 2;
    let inner = (1..steps).map(move |k| WeightedPoint::new(corners, [k, steps, steps - k]));
    corners.map(WeightedPoint::at).into_iter().chain(inner)
}

/// Whether faces of closed components overlap in one plane.
#[derive(Clone, Copy, Debug, Default)]
struct Flush {
    /// Two that look the same way do.
    same: bool,
    /// Two that look at each other do.
    opposite: bool,
}

fn flush(pair: &Pair, touching: &[FacePair]) -> Flush {
    let mut flush = Flush::default();
    for t in touching {
        let closed = |&side: &Side| pair.topology(side).in_closed_component(t.face(side));
        if Side::BOTH.iter().all(closed)
            && let Some(view) = view_of_overlap(pair, t)
        {
            let [first, second] =
                Side::BOTH.map(|side| view.turn(&pair.triangle(side, t.face(side))));
            flush.same |= first == second;
            flush.opposite |= first != second;
        }
    }
    flush
}

/// The plane in which two faces overlap with more than their rims, if they do.
fn view_of_overlap(pair: &Pair, t: &FacePair) -> Option<Projection> {
    let (a, b) = (pair.triangle(Side::First, t.first), pair.triangle(Side::Second, t.second));
    let view = Projection::of(&a)?;
    let in_plane = b.iter().all(|&p| orient3d(a[0], a[1], a[2], p).is_zero());
    (in_plane && overlap_in_plane(&a, &b, view)).then_some(view)
}

/// Which cells of `side`'s faces lie where, by the edges of the other body that run through the
/// inside of a face in its plane: on each hand of such an edge lies a cell, along it to a corner.
fn judge_by_edges(pair: &Pair, side: Side, touching: &[FacePair], parts: &mut Parts) {
    let others = side.other();
    for t in touching {
        let (own, other) = (t.face(side), t.face(others));
        if !pair.topology(others).in_closed_component(other) {
            continue;
        }
        let f = pair.triangle(side, own);
        let Some(view) = Projection::of(&f) else { continue };
        let corners = pair.triangle(others, other);
        for i in 0..3 {
            let ends = [corners[i], corners[(i + 1) % 3]];
            if ends.iter().all(|&p| orient3d(f[0], f[1], f[2], p).is_zero())
                && runs_through(&ends, &f, view)
            {
                let wedge = Wedge::of(pair, others, pair.edge(others, other, i));
                for corner in f {
                    parts.add(wedge.locate(corner, view));
                }
            }
        }
    }
}

/// Whether a segment in a triangle's plane shares a point with the triangle's inside: no line
/// through a side of either separates them (separating axes of convex sets in the plane).
fn runs_through(segment: &[DVec3; 2], triangle: &[DVec3; 3], view: Projection) -> bool {
    let s = segment.map(|p| view.apply(p));
    let t = view.counter_clockwise(triangle);
    let sides = t.map(|p| orient2d(s[0], s[1], p));
    let beside =
        sides.iter().all(|&x| x != Sign::Positive) || sides.iter().all(|&x| x != Sign::Negative);
    !beyond_a_side(&t, &s) && !beside
}

/// Whether the insides of two triangles in one plane overlap.
fn overlap_in_plane(a: &[DVec3; 3], b: &[DVec3; 3], view: Projection) -> bool {
    let (a, b) = (view.counter_clockwise(a), view.counter_clockwise(b));
    !beyond_a_side(&a, &b) && !beyond_a_side(&b, &a)
}

/// Whether no point lies inside of some side of a triangle that turns left.
fn beyond_a_side(t: &[DVec2; 3], points: &[DVec2]) -> bool {
    (0..3).any(|i| points.iter().all(|&p| orient2d(t[i], t[(i + 1) % 3], p) != Sign::Positive))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use crate::surface::strongest;
    use cranny_exact::{DQuat, DVec3, Pose};
    use cranny_geometry::{BuildOptions, EdgeId, Mesh, Model};
    use cranny_shapes::{Comb, Cuboid, Cup, Shape, Torus};
    use cranny_testkit::Rng;

    fn model(mesh: Mesh) -> Model {
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    /// Cubes in a row, each a component of its own.
    fn row_of_cubes() -> Mesh {
        let cube = Shape::from(Cuboid { size: [0.25; 3] }).build().unwrap();
        let count = cube.vertices().len() as u32;
        let at = |i: u32| DVec3::new(0.5 * f64::from(i) - 0.75, 0.0, 0.0);
        let vertices = |i| cube.vertices().iter().map(move |p| *p + at(i));
        let faces = |i| cube.faces().iter().map(move |f| f.map(|v| v + i * count));
        Mesh::new((0..4).flat_map(vertices).collect(), (0..4).flat_map(faces).collect()).unwrap()
    }

    /// The sets of faces that hang together untouched among all faces of a mesh, a face of each.
    fn untouched_of_all(pair: &Pair, side: Side, is_touched: &[bool]) -> Vec<FaceId> {
        let topology = pair.topology(side);
        let mut sets = DisjointSets::new(is_touched.len());
        for edge in (0..topology.edges().len() as u32).map(EdgeId) {
            for w in topology.half_edges(edge).windows(2) {
                let [f, g] = [w[0], w[1]].map(|h| h.face().index());
                if !is_touched[f] && !is_touched[g] {
                    sets.union(f, g);
                }
            }
        }
        let firsts = (0..is_touched.len()).filter(|&f| !is_touched[f] && sets.find(f) == f);
        firsts.map(|f| FaceId(f as u32)).collect()
    }

    /// Faces about those that touch lie where all faces of the mesh do.
    #[test]
    fn what_is_untouched_is_found_about_what_touches() {
        let shapes: [Shape; 4] = [
            Cuboid::default().into(),
            Cup { segments: 8, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            Torus { major_segments: 24, minor_segments: 16, ..Torus::default() }.into(),
        ];
        let mut bodies: Vec<Model> = shapes.map(|shape| model(shape.build().unwrap())).into();
        bodies.push(model(row_of_cubes()));
        let mut rng = Rng::new(31);
        let (mut touching, mut both, mut parted, mut wholes) = (0, 0, 0, 0);
        for round in 0..3000 {
            let [a, b] = [&bodies[rng.below(5)], &bodies[rng.below(5)]];
            let mut step = || 0.125 * rng.below(17) as f64 - 1.0;
            let translation = DVec3::new(step(), step(), step());
            let rotation = [DQuat::IDENTITY, DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0)][round % 2];
            let pair = Pair::of_accepted(
                Placed { model: a, pose: Pose::IDENTITY },
                Placed { model: b, pose: Pose { rotation, translation } },
            );
            let counters = &mut Counters::default();
            let meeting = meeting_pairs(&pair, counters);
            if strongest(&meeting) != Meeting::Touch {
                continue;
            }
            touching += 1;
            for side in Side::BOTH {
                let mut is_touched = vec![false; pair.mesh(side).faces().len()];
                meeting.iter().for_each(|t| is_touched[t.face(side).index()] = true);
                let mut numbers = Numbering::default();
                let mut touched = Vec::new();
                for t in &meeting {
                    if numbers.number(key(t.face(side))).1 {
                        touched.push((t.face(side), None));
                    }
                }
                let mut lie = |faces: &[FaceId]| {
                    let mut parts = Parts::default();
                    for &face in faces {
                        let p = WeightedPoint::at(pair.triangle(side, face)[0]);
                        parts.add(locate(&pair, side.other(), &p, counters));
                    }
                    (parts.inside, parts.outside)
                };
                let found = untouched(&pair, side, &touched, &numbers);
                let all = untouched_of_all(&pair, side, &is_touched);
                assert!(found.iter().all(|f| !is_touched[f.index()]), "round {round}");
                assert_eq!(lie(&found), lie(&all), "round {round}");
                both += usize::from(lie(&found) == (true, true));
                parted += usize::from(all.len() > 1);
                wholes += usize::from(all.len() > 1 && pair.topology(side).components().len() > 1);
            }
        }
        let seen = [touching, both, parted, wholes];
        assert!(seen.iter().zip([100, 3, 30, 20]).all(|(seen, least)| *seen > least), "{seen:?}");
    }
}
