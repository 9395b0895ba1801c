//! Walls that have dug into each other: how deep, where no vertex and no edge says it.
//!
//! Of fine meshes, the vertices inside and the edges that cross say how deep solids overlap. Where
//! the rim of a wall stands across the edge of another one, as an X, no vertex lies inside, and the
//! edges overlap by more than the walls are thick. Two bodies of a pile went through each other
//! there. So a region that sharp edges pierce is measured, and where it is far deeper than its
//! contacts say, it has contacts along its own direction.
//!
//! A region most of whose sides graze each other is left out, and one that parts by as little as
//! its contacts say in some other direction: what overlaps there by a hair reaches as far as the
//! sides do. So is what reaches over a gap, as from one turn of a thread to another. Nothing has
//! dug in so deep.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId};

use crate::answer::{Contact, Feature};
use crate::depth::{MeasuredRegion, Way, range};
use crate::intersection::{Intersection, intersect};
use crate::outline::Outline;
use crate::pair::{Pair, Side};
use crate::pieces::{Cuts, Inside, RegionPieces};
use crate::reduce::reduce;
use crate::surface::FacePair;
use crate::way_out::{mostly_grazes, parts_within};

/// How many times deeper than its contacts a region is that gets others. Smaller: contacts with
/// normals of their own place are joined by some of a mean normal; larger: walls dig in so much.
const FAR_DEEPER: f64 = 3.0;

/// What is less deep than this part of the smaller body's radius has not dug in. Smaller: flanks
/// of a nut of few facets get contacts with mean normals, which brake it (10.3 turns in place of
/// 10.9); larger: walls dig in so much.
const DUG: f64 = 0.01;

/// Contacts of regions that are far deeper than the contacts that are known of them, in the pair's
/// frame. Empty in special positions: faces that are flush have dug in nowhere. `inside` are the
/// [`vertices_within`](super::within::vertices_within) of each body.
pub(super) fn contacts_of_walls(
    pair: &Pair,
    meeting: &[FacePair],
    known: &[Contact],
    inside: &[Inside; 2],
) -> Vec<Contact> {
    let mut found = Vec::new();
    if !pair.is_closed() || !meeting.iter().any(|faces| is_pierced_sharply(pair, faces)) {
        return found;
    }
    let intersection = intersect(pair, meeting);
    if !intersection.generic {
        return found;
    }
    let [first, second] = Side::BOTH.map(|side| pair.model(side).radius());
    let least = DUG * first.min(second);
    // The direction of a region that may have dug in, and how deep what has not is at most.
    let may_have_dug_in = |pieces: &RegionPieces| {
        let normal = Outline::of(&intersection, &pieces.segments).normal()?;
        if !has_sharp_node(pair, &intersection, pieces) {
            return None;
        }
        let of_region = known.iter().filter(|contact| is_of(contact, pieces));
        let depth = of_region.map(|contact| -contact.separation).fold(0.0, f64::max);
        let shallow = least.max(FAR_DEEPER * depth);
        (width(pair, &intersection, pieces, normal) > shallow).then_some((normal, shallow))
    };
    let cuts = Cuts::of(pair, &intersection);
    let mut regions = cuts.regions(inside);
    // Mostly none has, and curves and vertices alone say so.
    if regions.iter().all(|pieces| may_have_dug_in(pieces).is_none()) {
        return found;
    }
    cuts.complete(&mut regions);
    for pieces in &regions {
        let Some((normal, shallow)) = may_have_dug_in(pieces) else { continue };
        let region = MeasuredRegion::of(pair, &intersection, pieces);
        let own = region.measure(Way::along(normal), false).0;
        if -own.separation <= shallow
            || region.reaches_over_a_gap(&own)
            || mostly_grazes(&region, &own)
            || parts_within(&region, &own, shallow)
        {
            continue;
        }
        let mut all = region.measure(Way::along(normal), true).1;
        all.retain(|contact| contact.id != own.id);
        all.push(own);
        found.extend(reduce(all));
    }
    found
}

/// Whether an edge that names an end of what two faces share is sharp.
fn is_pierced_sharply(pair: &Pair, faces: &FacePair) -> bool {
    let of = [faces.first, faces.second];
    faces.crossing.is_some_and(|crossing| {
        crossing.ends.iter().any(|end| {
            let owner = usize::from(end.owner);
            is_sharp(pair, Side::BOTH[owner], of[owner], usize::from(end.edge))
        })
    })
}

fn has_sharp_node(pair: &Pair, intersection: &Intersection, pieces: &RegionPieces) -> bool {
    let mut nodes = pieces.segments.iter().map(|&s| intersection.segments[s].nodes[0]);
    let is_sharp = |side: Side, edge: EdgeId| {
        let along = pair.topology(side).half_edges(edge).first();
        along.is_some_and(|h| is_sharp(pair, side, h.face(), h.corner()))
    };
    nodes.any(|node| match intersection.nodes[node].features {
        (Feature::Edge(e), _) => is_sharp(Side::First, e),
        (_, Feature::Edge(e)) => is_sharp(Side::Second, e),
        _ => false,
    })
}

fn is_sharp(pair: &Pair, side: Side, face: FaceId, edge: usize) -> bool {
    pair.model(side).clusters().owned(face).sharp >> edge & 1 != 0
}

/// How wide a region is along a direction: no depth along it is larger.
fn width(pair: &Pair, intersection: &Intersection, pieces: &RegionPieces, normal: DVec3) -> f64 {
    let on_curves = pieces.segments.iter().map(|&s| intersection.segments[s].nodes[0]);
    let on_curves = on_curves.map(|node| intersection.nodes[node].point);
    let inside = Side::BOTH.into_iter().flat_map(|side| {
        let vertices = pieces.pieces[side.index()].vertices.iter();
        vertices.map(move |&v| pair.position(side, v))
    });
    let (low, high) = range(on_curves.chain(inside).map(|p| p.dot(normal)));
    high - low
}

/// Whether a contact is of a vertex or an edge of the pieces.
fn is_of(contact: &Contact, pieces: &RegionPieces) -> bool {
    let holds = |side: Side, feature: Feature| {
        let piece = &pieces.pieces[side.index()];
        match feature {
            Feature::Vertex(v) => piece.vertices.contains(&v),
            Feature::Edge(e) => piece.edges.iter().any(|&(own, _)| own == e),
            Feature::Face(_) => false,
        }
    };
    holds(Side::First, contact.id.0) || holds(Side::Second, contact.id.1)
}
