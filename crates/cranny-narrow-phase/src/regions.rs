//! Contact regions of surfaces that intersect: normal, depth, area, points and curves.

use std::collections::HashMap;

use cranny_exact::DVec3;
use cranny_geometry::{DisjointSets, FaceId};

use crate::answer::{Contact, Counters, Curve, Feature, Region, RegionId};
use crate::depth::{MeasuredRegion, deepest_along, depths_along};
use crate::intersection::{Chains, Intersection, intersect};
use crate::pair::{Pair, PosedVertices, Side};
use crate::pieces::{RegionPieces, cut};
use crate::reduce::reduce;
use crate::search::meeting_pairs;
use crate::surface::FacePair;
use crate::touch::touch_regions;
use cranny_geometry::triangle_distance::Prepared;

/// How far the second body is moved or grown to read the regions of a special position (faces
/// flush, edges crossing edges), as a fraction of the pair's scale: 2^-30. Depth and area are then
/// off by as much. Smaller: rounding decides what is inside; larger: figures suffer.
const NUDGE: f64 = 9.313_225_746_154_785e-10;

/// Directions of the nudge: generic, so that no plane of a modelled part holds them.
const NUDGES: [DVec3; 3] = [
    DVec3::new(0.537, 0.681, 0.498),
    DVec3::new(-0.613, 0.441, -0.656),
    DVec3::new(0.701, -0.529, 0.478),
];

/// By how much a depth read beside a special position may be off, as a fraction of the pair's
/// scale. Vertices move by no more than two nudges; a face that leans from the normal by up to 60
/// degrees doubles that.
const BESIDE_ERROR: f64 = 4.0 * NUDGE;

/// A body that shrinks or grows also moves, by this share of it: enough to leave special positions,
/// too little to bring faces back to the side from which they parted.
const SHARE: f64 = 0.125;

/// Below this ratio of enclosed area to perimeter squared, curves enclose nothing (a peg through a
/// plate: the two rims cancel).
const ENCLOSES_NOTHING: f64 = 1e-6;

/// A region whose curves enclose at least this share of the area that they would if they were flat
/// has one normal; others are read direction by direction.
const FLAT: f64 = 0.9;

/// The cosine of how far from a direction a face may look that stops what comes along it: 60
/// degrees.
const LOOKS_ALONG: f64 = 0.5;

/// Vertices of a curved region that are measured at most; more are sampled evenly.
const MAX_SAMPLES: usize = 256;

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
    if here.generic {
        return (closed_regions(pair, &here), rounding);
    }
    let regions = regions_beside(pair, posed, counters);
    match regions {
        Some(regions) => (regions, rounding + BESIDE_ERROR * pair.scale()),
        // Flush from inside, say: nothing beside it overlaps. The surfaces touch, and that is all.
        None => (outer_touch(pair, pairs), rounding),
    }
}

fn is_closed(pair: &Pair) -> bool {
    Side::BOTH.iter().all(|&s| pair.model(s).is_closed())
}

/// The figures of a special position are those of a general one beside it.
///
/// Where faces are flush, the strip that they share belongs to one body's piece or the other's, as
/// the bodies are moved, and tilts the normal if it is the wrong one. So the second body is once
/// shrunk, once grown: this moves all its faces to their backs, or to their fronts, and a strip on
/// one side does not count against one on the other. The smaller depth wins. Bodies that coincide
/// part both ways; then a mere shift has to do.
fn regions_beside(
    pair: &Pair,
    posed: &mut PosedVertices,
    counters: &mut Counters,
) -> Option<Vec<Region>> {
    let step = NUDGE * pair.scale();
    let mut read = |offset: DVec3, bulge: f64| {
        let shifted = pair.shifted(offset, bulge, posed);
        let pairs = meeting_pairs(&shifted, counters);
        let beside = intersect(&shifted, &pairs);
        let cuts_out = beside.generic && !beside.segments.is_empty();
        cuts_out.then(|| closed_regions(&shifted, &beside))
    };
    let depth = |regions: &Vec<Region>| regions.iter().filter_map(|r| r.depth).fold(0.0, f64::max);
    for direction in NUDGES {
        let offset = direction * (step * SHARE);
        let sized = [-step, step].into_iter().filter_map(|bulge| read(offset, bulge));
        let least = sized.min_by(|x, y| depth(x).total_cmp(&depth(y)));
        if least.is_some() {
            return least;
        }
    }
    NUDGES.into_iter().find_map(|direction| read(direction * step, 0.0))
}

fn outer_touch(pair: &Pair, pairs: &[FacePair]) -> Vec<Region> {
    let closed = is_closed(pair);
    let regions = touch_regions(pair, pairs).into_iter().map(|t| {
        let (depth, area) = (closed.then_some(0.0), closed.then_some(t.area));
        finish(pair, t.normal, depth, area, reduce(t.contacts), Vec::new(), t.faces)
    });
    regions.collect()
}

/// Into world coordinates and the caller's order.
fn finish(
    pair: &Pair,
    normal: DVec3,
    depth: Option<f64>,
    area: Option<f64>,
    points: Vec<Contact>,
    curves: Vec<Curve>,
    faces: Vec<[FaceId; 2]>,
) -> Region {
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

fn closed_regions(pair: &Pair, intersection: &Intersection) -> Vec<Region> {
    let mut chains = Chains::of(intersection);
    let region = |c: &RegionPieces| closed_region(pair, intersection, &mut chains, c);
    cut(pair, intersection).iter().map(region).collect()
}

fn closed_region(
    pair: &Pair,
    intersection: &Intersection,
    chains: &mut Chains,
    cut: &RegionPieces,
) -> Region {
    let region = MeasuredRegion::of(pair, intersection, cut);
    let shape = Shape::of(intersection, &cut.segments);
    let normal = match shape.normal() {
        Some(normal) => normal,
        None => least_deep_direction(pair, &region),
    };
    let (deepest, mut contacts) = if shape.is_flat() || shape.normal().is_none() {
        let measured = depths_along(&region, normal);
        (measured.deepest, measured.all)
    } else {
        (deepest_along(&region, normal, f64::INFINITY), nearest_ways_out(pair, &region))
    };
    let rim = |n: usize| Contact {
        id: intersection.nodes[n].features,
        point_a: intersection.nodes[n].point,
        point_b: intersection.nodes[n].point,
        normal,
        separation: 0.0,
    };
    let mut deepest =
        deepest.unwrap_or_else(|| rim(intersection.segments[cut.segments[0]].nodes[0]));
    // On the way out of the whole piece a vertex has at most the depth to go; where its nearest way
    // is longer, the one past an edge was left out.
    contacts.retain(|c| c.separation >= deepest.separation - pair.length_error());
    // Of corners that are equally deep but for rounding, the one that is reported is the deepest.
    let key = |c: &Contact| (c.separation, c.id);
    for &contact in &contacts {
        if key(&contact) < key(&deepest) {
            deepest = contact;
        }
    }
    let mut points = reduce(contacts);
    points.retain(|c| c.id != deepest.id);
    points.insert(0, deepest);
    finish(
        pair,
        normal,
        Some(-deepest.separation),
        Some(shape.area_vector.dot(normal).abs()),
        points,
        curves(pair, intersection, chains, &cut.segments),
        cut.segments.iter().map(|&s| intersection.segments[s].faces).collect(),
    )
}

/// What closed curves enclose.
struct Shape {
    area_vector: DVec3,
    /// Sum of the areas of the triangles from a middle point to the segments, whatever their side.
    fan_area: f64,
    perimeter: f64,
}

impl Shape {
    /// By Stokes, the area vector of the first body's piece is that of its border; the piece's
    /// outward normals point from the first body into the second.
    fn of(intersection: &Intersection, segments: &[usize]) -> Self {
        let ends = |&s: &usize| intersection.segments[s].nodes.map(|n| intersection.nodes[n].point);
        let middle = segments.iter().map(|s| ends(s)[0]).sum::<DVec3>() / segments.len() as f64;
        let mut shape = Self { area_vector: DVec3::ZERO, fan_area: 0.0, perimeter: 0.0 };
        for s in segments {
            let [p, q] = ends(s);
            let part = 0.5 * (p - middle).cross(q - middle);
            shape.area_vector += part;
            shape.fan_area += part.length();
            shape.perimeter += (q - p).length();
        }
        shape
    }

    fn normal(&self) -> Option<DVec3> {
        let area = self.area_vector.length();
        (area > ENCLOSES_NOTHING * self.perimeter * self.perimeter).then(|| self.area_vector / area)
    }

    fn is_flat(&self) -> bool {
        self.area_vector.length() >= FLAT * self.fan_area
    }
}

/// Where the curves name no direction: of the pieces' own face normals, and the line between the
/// bodies, the one along which the least translation parts them.
fn least_deep_direction(pair: &Pair, region: &MeasuredRegion) -> DVec3 {
    let centers = pair.bounds(Side::Second).center() - pair.bounds(Side::First).center();
    let mut candidates: Vec<DVec3> = vec![centers.try_normalize().unwrap_or(DVec3::Z)];
    for side in Side::BOTH {
        let sign = if side == Side::First { 1.0 } else { -1.0 };
        let mut faces = region.cut.pieces[side.index()].faces.clone();
        faces.sort_unstable();
        let stride = faces.len().div_ceil(MAX_SAMPLES / 4).max(1);
        for &f in faces.iter().step_by(stride) {
            let n = sign * pair.normal(side, f);
            if n != DVec3::ZERO && candidates.iter().all(|c| c.dot(n) < FLAT) {
                candidates.push(n);
            }
        }
    }
    // How deep a piece is along a direction that none of its faces looks along, rays do not tell.
    if candidates.iter().any(|&n| face_each_other(pair, region, n)) {
        candidates.retain(|&n| face_each_other(pair, region, n));
    }
    let mut best = (f64::INFINITY, candidates[0]);
    for n in candidates {
        if let Some(deepest) = deepest_along(region, n, best.0)
            && -deepest.separation < best.0
        {
            best = (-deepest.separation, n);
        }
    }
    best.1
}

/// Whether some face of the first body's piece looks along `n`, and some of the second's against
/// it, within 60 degrees.
fn face_each_other(pair: &Pair, region: &MeasuredRegion, n: DVec3) -> bool {
    Side::BOTH.iter().zip([1.0, -1.0]).all(|(&side, sign)| {
        let faces = &region.cut.pieces[side.index()].faces;
        faces.iter().any(|&f| sign * pair.normal(side, f).dot(n) >= LOOKS_ALONG)
    })
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
        let stride = vertices.len().div_ceil(MAX_SAMPLES).max(1);
        // Neighbours have their ways out through neighbours: the last one bounds the next.
        let mut last = 0;
        for &v in vertices.iter().step_by(stride) {
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
            finish(pair, normal, None, None, reduce(points), curves, faces)
        })
        .collect()
}
