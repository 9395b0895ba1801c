//! Do the interiors meet, and is one body wholly inside the other? Exact.
//!
//! Where the surfaces share no point, each component lies wholly inside or wholly outside the other
//! solid, and one vertex of it tells. Where they cross, closed solids share interior points. Where
//! they only touch, four facts decide. Suppose that the open interiors meet although no two faces
//! cross. Then (argument in the comments below) one of these holds, and each of them suffices:
//!
//! 1. two faces overlap in one plane with the same outward side;
//! 2. along an edge that lies in the inside of a face of the other body, one of the edge's own faces
//!    dips behind that face;
//! 3. such an edge is reflex, its faces in front: its solid reaches behind the face;
//! 4. the whole inside of some face lies inside the other solid, and a point of it tells.

use cranny_exact::{DVec2, DVec3, Meeting, Sign, orient2d, orient3d};
use cranny_geometry::{DisjointSets, EdgeId, FaceId, HalfEdgeId};

use crate::answer::{Containment, Counters, Surface};
use crate::inside::{Location, locate};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;

/// Whether the solids share interior points, and which lies inside which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Solidity {
    pub(crate) solid: bool,
    /// Told as if the first body were A.
    pub(crate) contained: Option<Containment>,
}

/// Decides; `touching` are the pairs of faces that touch.
pub(crate) fn solidity(
    pair: &Pair,
    surface: Surface,
    touching: &[FacePair],
    counters: &mut Counters,
) -> Solidity {
    match surface {
        Meeting::Cross => Solidity { solid: true, contained: None },
        Meeting::None => {
            let parts = Side::BOTH.map(|side| whole_components(pair, side, counters));
            verdict(pair, parts)
        }
        Meeting::Touch => {
            let mut parts = Side::BOTH.map(|side| touched_parts(pair, side, touching, counters));
            let enters = |side| enters_through_an_edge(pair, side, touching);
            for side in Side::BOTH {
                parts[side.index()].inside |= enters(side);
            }
            let mut result = verdict(pair, parts);
            result.solid |= flush(pair, touching);
            result
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
        match location {
            Location::Inside => self.inside = true,
            Location::Outside => self.outside = true,
            Location::On => {}
        }
    }
}

fn verdict(pair: &Pair, [first, second]: [Parts; 2]) -> Solidity {
    let within = |inner: Parts, outer: Parts, outer_side: Side| {
        // A body is inside another solid when none of its surface is outside, some of it is inside,
        // and the other's surface (a void, say) does not enter it.
        inner.inside && !inner.outside && !outer.inside && pair.model(outer_side).is_closed()
    };
    let contained = if within(first, second, Side::Second) {
        Some(Containment::AInB)
    } else if within(second, first, Side::First) {
        Some(Containment::BInA)
    } else {
        None
    };
    Solidity { solid: first.inside || second.inside, contained }
}

fn whole_components(pair: &Pair, side: Side, counters: &mut Counters) -> Parts {
    let mut parts = Parts::default();
    for component in pair.topology(side).components() {
        let p = pair.position(side, pair.corner(side, component.first_face, 0));
        parts.add(locate(pair, side.other(), p, counters));
    }
    parts
}

/// Every face that touches is sampled by itself; the others are as one, as far as they hang together.
fn touched_parts(pair: &Pair, side: Side, touching: &[FacePair], counters: &mut Counters) -> Parts {
    let count = pair.mesh(side).faces().len();
    let mut touched = vec![false; count];
    for t in touching {
        touched[face_on(t, side).index()] = true;
    }
    let topology = pair.topology(side);
    let mut sets = DisjointSets::new(count);
    for e in 0..topology.edges().len() as u32 {
        let around = topology.half_edges(EdgeId(e));
        for w in around.windows(2) {
            let (f, g) = (w[0].face(), w[1].face());
            if !touched[f.index()] && !touched[g.index()] {
                sets.union(f.index(), g.index());
            }
        }
    }
    let mut parts = Parts::default();
    for (f, &touches) in touched.iter().enumerate() {
        if touches || sets.find(f) == f {
            // A point of the face's inside. Sums of halves and quarters are exact for dyadic
            // coordinates; others round by an ulp, in a face that is not pierced.
            let [a, b, c] = pair.triangle(side, FaceId(f as u32));
            let sample = if touches { 0.5 * a + 0.25 * b + 0.25 * c } else { a };
            parts.add(locate(pair, side.other(), sample, counters));
        }
    }
    parts
}

fn face_on(pair: &FacePair, side: Side) -> FaceId {
    match side {
        Side::First => pair.first,
        Side::Second => pair.second,
    }
}

/// Fact 1: faces of closed components that overlap in one plane and look the same way.
fn flush(pair: &Pair, touching: &[FacePair]) -> bool {
    touching.iter().any(|t| {
        let (a, b) = (pair.triangle(Side::First, t.first), pair.triangle(Side::Second, t.second));
        pair.topology(Side::First).in_closed_component(t.first)
            && pair.topology(Side::Second).in_closed_component(t.second)
            && b.iter().all(|&p| orient3d(a[0], a[1], a[2], p).is_zero())
            && pair.area_vector(Side::First, t.first).dot(pair.area_vector(Side::Second, t.second))
                > 0.0
            && overlap_in_plane(&a, &b)
    })
}

/// Facts 2 and 3: does an edge of `side` that runs through the inside of a face of the other body
/// lead this body's surface or solid behind that face?
///
/// Let P be a connected part of (a face f's inside) ∩ (this solid's inside) that is not all of f's
/// inside. Its border inside f consists of points of this body's surface. No face crosses f, so the
/// border is made of edges that lie in f's plane. Near such an edge this solid is a wedge, and the
/// wedge holds points behind f if and only if one of its two faces goes there, or both stay in front
/// and the wedge is reflex.
fn enters_through_an_edge(pair: &Pair, side: Side, touching: &[FacePair]) -> bool {
    let topology = pair.topology(side);
    touching.iter().any(|t| {
        let (own, other) = (face_on(t, side), face_on(t, side.other()));
        if !pair.topology(side.other()).in_closed_component(other) {
            return false;
        }
        let f = pair.triangle(side.other(), other);
        let behind = |p: DVec3| orient3d(f[0], f[1], f[2], p);
        (0..3).any(|i| {
            let h = HalfEdgeId::of(own, i);
            let corners = pair.triangle(side, own);
            let ends = [corners[i], corners[(i + 1) % 3]];
            if !ends.iter().all(|&p| behind(p).is_zero()) || !runs_through(&ends, &f) {
                return false;
            }
            let apex = |h: HalfEdgeId| {
                pair.position(side, pair.corner(side, h.face(), (h.corner() + 2) % 3))
            };
            let around = topology.half_edges(topology.edge_of(h));
            if around.iter().any(|&g| behind(apex(g)) == Sign::Negative) {
                return true;
            }
            topology.twin(h).is_some_and(|twin| {
                let reflex = orient3d(corners[0], corners[1], corners[2], apex(twin));
                topology.in_closed_component(own) && reflex == Sign::Positive
            })
        })
    })
}

/// Coordinates in a plane along whose normal's largest component one looks.
fn projector(triangle: &[DVec3; 3]) -> impl Fn(DVec3) -> DVec2 + use<> {
    let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    let axis = normal.abs().max_position();
    move |p: DVec3| match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

/// Whether a segment in a triangle's plane shares a point with the triangle's inside: no line through
/// a side of either separates them (separating axes of convex sets in the plane).
fn runs_through(segment: &[DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let project = projector(triangle);
    let s = segment.map(&project);
    let t = counter_clockwise(triangle.map(&project));
    let beyond_a_side =
        (0..3).any(|i| s.iter().all(|&p| orient2d(t[i], t[(i + 1) % 3], p) != Sign::Positive));
    let sides = t.map(|p| orient2d(s[0], s[1], p));
    let beside =
        sides.iter().all(|&x| x != Sign::Positive) || sides.iter().all(|&x| x != Sign::Negative);
    !beyond_a_side && !beside
}

/// Whether the insides of two triangles in one plane overlap.
fn overlap_in_plane(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let project = projector(a);
    let (a, b) = (counter_clockwise(a.map(&project)), counter_clockwise(b.map(&project)));
    let separates = |t: &[DVec2; 3], u: &[DVec2; 3]| {
        (0..3).any(|i| u.iter().all(|&p| orient2d(t[i], t[(i + 1) % 3], p) != Sign::Positive))
    };
    !separates(&a, &b) && !separates(&b, &a)
}

fn counter_clockwise([a, b, c]: [DVec2; 3]) -> [DVec2; 3] {
    if orient2d(a, b, c) == Sign::Negative { [a, c, b] } else { [a, b, c] }
}
