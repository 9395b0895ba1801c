//! Contact regions of surfaces that intersect: normal, depth, area, points and curves.

use std::collections::HashMap;

use cranny_exact::DVec3;
use cranny_geometry::{DisjointSets, FaceId};

use crate::answer::{Contact, Counters, Curve, Region, RegionId};
use crate::intersection::{Chains, Intersection, intersect};
use crate::overlap::{Overlap, settle};
use crate::pair::{Pair, PosedVertices, Side};
use crate::pieces::{RegionPieces, cut};
use crate::reduce::reduce;
use crate::special_position::in_general_position;
use crate::surface::FacePair;
use crate::touch::touch_regions;

/// Regions of all pairs that meet, in world coordinates and the caller's order, and by how much
/// their depths may be off.
pub(crate) fn meeting_regions(
    pair: &Pair,
    posed: &mut PosedVertices,
    pairs: &[FacePair],
    solid: bool,
    counters: &mut Counters,
) -> (Vec<Region>, f64) {
    let rounding = pair.length_error();
    if pairs.is_empty() {
        return (Vec::new(), rounding);
    }
    if !solid {
        return (outer_touch(pair, pairs), rounding);
    }
    let here = intersect(pair, pairs);
    if !is_closed(pair) {
        return (open_regions(pair, &here, pairs), rounding);
    }
    let depth = |found: &Found| found.depth.unwrap_or(0.0);
    let (mut found, error) =
        in_general_position(pair, posed, &here, counters, closed_regions, depth);
    if found.is_empty() {
        // Flush from inside, say: nothing beside it overlaps. The surfaces touch, and that is all.
        return (outer_touch(pair, pairs), rounding);
    }
    if !here.generic {
        for Found { points, depth, .. } in &mut found {
            settle(pair, points);
            *depth = depth.map(|_| -points[0].separation);
        }
    }
    (found.into_iter().map(|found| found.finish(pair)).collect(), error)
}

/// The contacts of [`meeting_regions`] of two solids that overlap, alone: in world coordinates and
/// the caller's order.
pub(crate) fn overlap_contacts(
    pair: &Pair,
    posed: &mut PosedVertices,
    pairs: &[FacePair],
    counters: &mut Counters,
) -> Vec<Contact> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let here = intersect(pair, pairs);
    if !is_closed(pair) {
        let regions = open_regions(pair, &here, pairs).into_iter();
        return regions.flat_map(|region| region.points).collect();
    }
    let of_regions = |pair: &Pair, intersection: &Intersection| {
        let overlap = |c: &RegionPieces| Overlap::of(pair, intersection, c).contacts;
        cut(pair, intersection).iter().map(overlap).collect()
    };
    let depth = |contacts: &Vec<Contact>| -contacts[0].separation;
    let (mut found, _) = in_general_position(pair, posed, &here, counters, of_regions, depth);
    if found.is_empty() {
        found = touch_regions(pair, pairs).into_iter().map(|t| reduce(t.contacts)).collect();
    } else if !here.generic {
        found.iter_mut().for_each(|contacts| settle(pair, contacts));
    }
    found.into_iter().flatten().map(|contact| pair.world_contact(contact)).collect()
}

pub(crate) fn is_closed(pair: &Pair) -> bool {
    Side::BOTH.iter().all(|&s| pair.model(s).is_closed())
}

fn outer_touch(pair: &Pair, pairs: &[FacePair]) -> Vec<Region> {
    let closed = is_closed(pair);
    let regions = touch_regions(pair, pairs).into_iter().map(|t| {
        let found = Found {
            normal: t.normal,
            depth: closed.then_some(0.0),
            area: closed.then_some(t.area),
            points: reduce(t.contacts),
            curves: Vec::new(),
            faces: t.faces,
        };
        found.finish(pair)
    });
    regions.collect()
}

/// A region in the pair's frame and order, but for its curves.
struct Found {
    normal: DVec3,
    depth: Option<f64>,
    area: Option<f64>,
    /// The deepest first.
    points: Vec<Contact>,
    /// In world coordinates.
    curves: Vec<Curve>,
    faces: Vec<[FaceId; 2]>,
}

impl Found {
    /// Into world coordinates and the caller's order.
    fn finish(self, pair: &Pair) -> Region {
        let Self { normal, depth, area, points, curves, faces } = self;
        let points: Vec<Contact> = points.into_iter().map(|c| pair.world_contact(c)).collect();
        let triangle_pairs = faces.len() as u32;
        Region {
            id: RegionId::default(),
            from: Vec::new(),
            faces: pair.ordered_faces(faces),
            deepest: points[0],
            normal: pair.world_normal(normal),
            depth,
            area,
            points,
            curves,
            triangle_pairs,
        }
    }
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
    let Overlap { outline, normal, contacts } = Overlap::of(pair, intersection, cut);
    let faces = cut.segments.iter().map(|&s| intersection.segments[s].faces).collect();
    Found {
        normal,
        depth: Some(-contacts[0].separation),
        area: Some(outline.area_along(normal)),
        points: contacts,
        curves: curves(pair, intersection, chains, &cut.segments),
        faces,
    }
}

/// Where a surface is open: connected curves, without depth or area.
fn open_regions(pair: &Pair, intersection: &Intersection, pairs: &[FacePair]) -> Vec<Region> {
    let mut sets = DisjointSets::new(intersection.nodes.len());
    for s in &intersection.segments {
        sets.union(s.nodes[0], s.nodes[1]);
    }
    let mut order: Vec<Vec<usize>> = Vec::new();
    let mut region_of_root = HashMap::new();
    for (index, s) in intersection.segments.iter().enumerate() {
        let region = *region_of_root.entry(sets.find(s.nodes[0])).or_insert(order.len());
        if region == order.len() {
            order.push(Vec::new());
        }
        order[region].push(index);
    }
    if order.is_empty() {
        return outer_touch(pair, pairs);
    }
    let mut chains = Chains::of(intersection);
    order
        .into_iter()
        .map(|segments| {
            // No inside, no depth: the normal is the balance of the faces that meet.
            let sum: DVec3 = segments
                .iter()
                .map(|&s| {
                    let [f, g] = intersection.segments[s].faces;
                    pair.area_vector(Side::First, f) - pair.area_vector(Side::Second, g)
                })
                .sum();
            let normal = sum.try_normalize().unwrap_or(DVec3::Z);
            let points = segments
                .iter()
                .map(|&s| {
                    let node = &intersection.nodes[intersection.segments[s].nodes[0]];
                    Contact {
                        id: node.features,
                        point_a: node.point,
                        point_b: node.point,
                        normal,
                        separation: 0.0,
                    }
                })
                .collect();
            let curves = curves(pair, intersection, &mut chains, &segments);
            let faces = segments.iter().map(|&s| intersection.segments[s].faces).collect();
            let points = reduce(points);
            Found { normal, depth: None, area: None, points, curves, faces }.finish(pair)
        })
        .collect()
}
