//! What a solver reads of a region of overlap: the direction along which it parts, and contacts of
//! which the deepest is as deep as the region.
//!
//! Along the region's direction every vertex inside has a depth, and so have edges that cross. Where
//! the region is curved, or its vertices are many and near the surface, each has its nearest way
//! out instead, with the normal of its own place.
//!
//! Sides that graze each other overlap by a hair, and reach along the direction as far as they are
//! high. Then the ways out alone count.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;
use cranny_geometry::triangle_distance::Prepared;

use crate::answer::{Contact, Feature};
use crate::contacts::nearer;
use crate::depth::{MeasuredRegion, deepest_along, depths_along};
use crate::intersection::Intersection;
use crate::outline::{Outline, on_curve, sides_meet};
use crate::pair::{Pair, Side};
use crate::pieces::RegionPieces;
use crate::reduce::reduce;
use crate::special_position::settled;

/// Vertices of a region whose ways out are measured at most; of more, as many are chosen by their
/// ids.
const MAX_SAMPLES: usize = 256;

/// So many vertices inside span a flat region. More: its contacts have one normal, though facets
/// have their own; fewer: what rests on edges loses their ends.
const SPANNING: usize = 8;

/// How many times deeper than its vertices' ways out a region may be whose contacts these are.
/// Smaller: facets get one normal; larger: what has dug in is led out sideways.
const NEARLY: f64 = 2.0;

/// How many times deeper it must be where sides graze each other. Smaller: walls that stand across
/// each other lose their depth; larger: what is pushed sideways is lifted as high as the side.
const FAR_DEEPER: f64 = 8.0;

/// In the pair's frame.
pub(crate) struct Overlap {
    pub(crate) outline: Outline,
    /// That of the region.
    pub(crate) normal: DVec3,
    /// The deepest first.
    pub(crate) contacts: Vec<Contact>,
}

impl Overlap {
    pub(crate) fn of(pair: &Pair, intersection: &Intersection, cut: &RegionPieces) -> Self {
        let region = MeasuredRegion::of(pair, intersection, cut);
        let outline = Outline::of(intersection, &cut.segments);
        let normal = outline.direction(pair, &region);
        let along = deepest_along(&region, normal, f64::INFINITY);
        let depth = along.map_or(0.0, |deepest| -deepest.separation);
        let ways = nearest_ways_out(pair, &region);
        let longest = ways.iter().map(|way| -way.separation).fold(0.0, f64::max);
        let is_flat = outline.is_flat() || outline.normal().is_none();
        let grazes =
            !ways.is_empty() && depth > FAR_DEEPER * longest && sides_meet(pair, &region, normal);
        let (deepest, mut contacts) = if grazes {
            (None, ways)
        } else if is_flat && (ways.len() < SPANNING || depth > NEARLY * longest) {
            (along, depths_along(&region, normal).all)
        } else {
            (along, ways)
        };
        let mut deepest = deepest
            .or_else(|| contacts.first().copied())
            .unwrap_or_else(|| on_curve(intersection, cut, normal));
        if !grazes {
            // On the way out of the whole piece a vertex has at most the depth to go; where its
            // nearest way is longer, the one past an edge was left out.
            contacts.retain(|c| c.separation >= deepest.separation - pair.length_error());
        }
        // Of corners that are equally deep but for rounding, the one that is reported is the
        // deepest.
        let key = |c: &Contact| (c.separation, c.id);
        for &contact in &contacts {
            if key(&contact) < key(&deepest) {
                deepest = contact;
            }
        }
        let mut contacts = reduce(contacts);
        contacts.retain(|c| c.id != deepest.id);
        contacts.insert(0, deepest);
        Self { outline, normal, contacts }
    }
}

/// Measures a region's contacts at the pair's own position, which were read beside it.
pub(crate) fn settle(pair: &Pair, contacts: &mut [Contact]) {
    contacts.iter_mut().for_each(|contact| *contact = settled(pair, *contact));
    let deepest = (0..contacts.len()).min_by(|&i, &j| nearer(&contacts[i], &contacts[j]));
    contacts.swap(0, deepest.unwrap_or(0));
}

/// For each vertex inside the other body the nearest point of the other's piece: the way out.
fn nearest_ways_out(pair: &Pair, region: &MeasuredRegion) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for side in Side::BOTH {
        let vertices = &region.cut.pieces[side.index()].vertices;
        let other = side.other().index();
        let faces = &region.cut.pieces[other].faces;
        let triangles = &region.triangles[other];
        let standing: Vec<(DVec3, f64, Prepared)> = triangles.iter().map(prepared).collect();
        // Neither the order of the pieces nor a vertex more chooses others.
        let stride = vertices.len().div_ceil(MAX_SAMPLES).next_power_of_two() as u32;
        // Neighbours have their ways out through neighbours: the last one bounds the next.
        let mut last = 0;
        for &v in vertices.iter().filter(|v| v.0.is_multiple_of(stride)) {
            let p = pair.position(side, v);
            let mut nearest: Option<(FaceId, DVec3)> = None;
            let (mut least, mut found) = (f64::INFINITY, last);
            let mut reach = f64::INFINITY;
            for i in std::iter::once(last).chain(0..faces.len()) {
                let Some((center, radius, triangle)) = standing.get(i) else { break };
                let touching = reach + radius;
                if (*center - p).length_squared() > touching * touching {
                    continue;
                }
                let Some(foot) = triangle.foot(p) else { continue };
                let squared = (foot - p).length_squared();
                let nearer = squared < least
                    || (squared <= least && nearest.is_none_or(|(face, _)| faces[i] < face));
                if nearer {
                    (nearest, least, found) = (Some((faces[i], foot)), squared, i);
                    reach = squared.sqrt() + pair.length_error();
                }
            }
            last = found;
            let Some((face, q)) = nearest else { continue };
            let outward = pair.normal(side.other(), face);
            let depth = (q - p).length();
            let (own, its) = (Feature::Vertex(v), Feature::Face(face));
            contacts.push(match side {
                Side::First => Contact {
                    id: (own, its),
                    point_a: p,
                    point_b: q,
                    normal: -outward,
                    separation: -depth,
                },
                Side::Second => Contact {
                    id: (its, own),
                    point_a: q,
                    point_b: p,
                    normal: outward,
                    separation: -depth,
                },
            });
        }
    }
    contacts
}

/// A triangle with the ball around it.
fn prepared(corners: &[DVec3; 3]) -> (DVec3, f64, Prepared) {
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    let squared = corners.map(|p| (p - center).length_squared());
    (center, squared[0].max(squared[1]).max(squared[2]).sqrt(), Prepared::of(corners))
}
