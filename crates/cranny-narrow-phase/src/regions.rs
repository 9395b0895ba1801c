//! Contact regions of surfaces that intersect: normal, depth, area, points and curves.

use cranny_exact::DVec3;
use cranny_geometry::DisjointSets;

use crate::answer::{Contact, Curve, Region};
use crate::contacts::nearer;
use crate::depth::MeasuredRegion;
use crate::found::Found;
use crate::intersection::{Chains, Intersection, Node, intersect};
use crate::pair::{Pair, Side};
use crate::pieces::{RegionPieces, cut};
use crate::reduce::reduce;
use crate::special_position::in_general_position;
use crate::surface::FacePair;
use crate::tally::Tally;
use crate::touch::touch_regions;
use crate::way_out::{Others, way_out};

/// Regions of all pairs that meet, in world coordinates and the caller's order, and by how much
/// their depths may be off.
pub(crate) fn meeting_regions(
    pair: &Pair,
    pairs: &[FacePair],
    solid: bool,
    counters: &mut impl Tally,
) -> (Vec<Region>, f64) {
    let rounding = pair.length_error();
    if pairs.is_empty() {
        return (Vec::new(), rounding);
    }
    if !solid {
        return (touch_regions(pair, pairs), rounding);
    }
    let here = intersect(pair, pairs);
    if !pair.is_closed() {
        return (open_regions(pair, &here, pairs), rounding);
    }
    let depth = |found: &Found| found.depth.unwrap_or(0.0);
    let (mut found, error) = in_general_position(pair, &here, counters, closed_regions, depth);
    if found.is_empty() {
        // Flush from inside, say: nothing beside it overlaps. The surfaces touch, and that is all.
        return (touch_regions(pair, pairs), rounding);
    }
    if !here.generic {
        found.iter_mut().for_each(|found| found.settle(pair));
    }
    (found.into_iter().map(|found| found.finish(pair)).collect(), error)
}

fn curves(
    pair: &Pair,
    intersection: &Intersection,
    chains: &mut Chains,
    segments: &[usize],
) -> Vec<Curve> {
    let curve = |(nodes, closed): (Vec<usize>, bool)| Curve {
        points: nodes.iter().map(|&n| pair.world_point(intersection.nodes[n].point)).collect(),
        closed,
    };
    chains.follow(segments).into_iter().map(curve).collect()
}

fn closed_regions(pair: &Pair, intersection: &Intersection) -> Vec<Found> {
    let mut chains = Chains::of(intersection);
    let region = |c: &RegionPieces| closed_region(pair, intersection, &mut chains, c);
    cut(pair, intersection).iter().map(region).collect()
}

fn closed_region(
    pair: &Pair,
    intersection: &Intersection,
    chains: &mut Chains,
    cut: &RegionPieces,
) -> Found {
    let region = MeasuredRegion::of(pair, intersection, cut);
    let outline = region.outline();
    let is_flat = outline.is_flat() || outline.normal().is_none();
    let others = if is_flat { Others::Along } else { Others::Nearest };
    let (deepest, mut contacts) = way_out(&region, others);
    let normal = deepest.normal;
    // On the way out of the whole piece a vertex has at most the depth to go; where its nearest way
    // is longer, the one past an edge was left out.
    contacts.retain(|c| c.separation >= deepest.separation - pair.length_error());
    // Of corners that are equally deep but for rounding, the one that is reported is the deepest.
    let deepest = contacts.iter().fold(deepest, |x, &y| std::cmp::min_by(x, y, nearer));
    let mut points = reduce(contacts);
    points.retain(|c| c.id != deepest.id);
    points.insert(0, deepest);
    let faces = cut.segments.iter().map(|&s| intersection.segments[s].faces).collect();
    Found {
        normal,
        depth: Some(-deepest.separation),
        area: Some(outline.area_along(normal)),
        points,
        curves: curves(pair, intersection, chains, &cut.segments),
        faces,
    }
}

/// Where a surface is open: connected curves, without depth or area.
fn open_regions(pair: &Pair, intersection: &Intersection, pairs: &[FacePair]) -> Vec<Region> {
    if intersection.segments.is_empty() {
        return touch_regions(pair, pairs);
    }
    // Of segments: a node where surfaces touch in a point has none.
    let mut sets = DisjointSets::new(intersection.segments.len());
    let mut segment_at = vec![None; intersection.nodes.len()];
    for (index, s) in intersection.segments.iter().enumerate() {
        for node in s.nodes {
            sets.union(*segment_at[node].get_or_insert(index), index);
        }
    }
    let mut chains = Chains::of(intersection);
    let region = |segments: Vec<usize>| {
        let faces = segments.iter().map(|&s| intersection.segments[s].faces);
        let nodes =
            segments.iter().map(|&s| &intersection.nodes[intersection.segments[s].nodes[0]]);
        let balance = faces
            .clone()
            .map(|[f, g]| pair.area_vector(Side::First, f) - pair.area_vector(Side::Second, g));
        // No inside, no depth: the normal is the balance of the faces that meet.
        let normal = balance.sum::<DVec3>().try_normalize().unwrap_or(DVec3::Z);
        let touching = |node: &Node| Contact::touching(node.features, node.point, normal);
        let points = reduce(nodes.map(touching).collect());
        let curves = curves(pair, intersection, &mut chains, &segments);
        Found { normal, depth: None, area: None, points, curves, faces: faces.collect() }
    };
    sets.groups().into_iter().map(region).map(|found| found.finish(pair)).collect()
}
