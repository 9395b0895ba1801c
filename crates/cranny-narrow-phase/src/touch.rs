//! Regions of bodies that touch without sharing interior points.

use std::collections::HashMap;

use cranny_exact::{DVec3, orient3d};
use cranny_geometry::{DisjointSets, FaceId, VertexId};

use crate::answer::{Contact, Feature};
use crate::intersection::{Intersection, intersect};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;

/// A connected region of touching faces, in the pair's frame.
pub(crate) struct TouchRegion {
    pub(crate) normal: DVec3,
    pub(crate) area: f64,
    pub(crate) contacts: Vec<Contact>,
    /// Those that touch.
    pub(crate) faces: Vec<[FaceId; 2]>,
}

/// Groups touching pairs into regions: pairs whose faces share a vertex on both bodies are
/// neighbours.
pub(crate) fn touch_regions(pair: &Pair, touching: &[FacePair]) -> Vec<TouchRegion> {
    let mut sets = DisjointSets::new(touching.len());
    let mut seen: HashMap<(VertexId, VertexId), usize> = HashMap::new();
    for (i, t) in touching.iter().enumerate() {
        for v in pair.mesh(Side::First).corners(t.first) {
            for w in pair.mesh(Side::Second).corners(t.second) {
                sets.union(*seen.entry((v, w)).or_insert(i), i);
            }
        }
    }
    let of_group =
        |group: Vec<usize>| -> Vec<FacePair> { group.into_iter().map(|i| touching[i]).collect() };
    sets.groups().into_iter().map(|group| region(pair, &of_group(group))).collect()
}

fn region(pair: &Pair, pairs: &[FacePair]) -> TouchRegion {
    let intersection = intersect(pair, pairs);
    let mut area_vector = DVec3::ZERO;
    let mut contacts = Vec::new();
    for t in pairs {
        let a = pair.triangle(Side::First, t.first);
        let b = pair.triangle(Side::Second, t.second);
        if b.iter().all(|&p| orient3d(a[0], a[1], a[2], p).is_zero()) {
            let normal = pair.normal(Side::First, t.first);
            let polygon = overlap(&a, &b, normal);
            area_vector += normal * polygon_area(&polygon, normal);
            let id = (Feature::Face(t.first), Feature::Face(t.second));
            contacts.extend(polygon.into_iter().map(|p| Contact::touching(id, p, normal)));
        }
    }
    let area = area_vector.length();
    let normal = if area > 0.0 { area_vector / area } else { point_normal(pair, &intersection) };
    if contacts.is_empty() {
        contacts = intersection
            .nodes
            .iter()
            .map(|n| Contact::touching(n.features, n.point, normal))
            .collect();
    }
    if contacts.is_empty() {
        // Degenerate faces that touch in one line or point.
        let t = pairs[0];
        let nearest = cranny_geometry::triangle_distance::triangle_distance(
            &pair.triangle(Side::First, t.first),
            &pair.triangle(Side::Second, t.second),
        );
        let id = (Feature::Face(t.first), Feature::Face(t.second));
        contacts.push(Contact::touching(id, nearest.points[0], normal));
    }
    let faces = pairs.iter().map(|p| [p.first, p.second]).collect();
    TouchRegion { normal, area, contacts, faces }
}

/// The normal where bodies touch in points or lines: the face's where one is part of it, else of
/// two crossed edges their common perpendicular, else between the two bodies' mean normals there.
fn point_normal(pair: &Pair, intersection: &Intersection) -> DVec3 {
    let by_face = intersection.nodes.iter().find_map(|n| match n.features {
        (_, Feature::Face(f)) => Some(-pair.normal(Side::Second, f)),
        (Feature::Face(f), _) => Some(pair.normal(Side::First, f)),
        _ => None,
    });
    if let Some(normal) = by_face {
        return normal;
    }
    let towards = |n: &crate::intersection::Node| {
        mean_normal(pair, Side::First, n.features.0) - mean_normal(pair, Side::Second, n.features.1)
    };
    let crossed = intersection.nodes.iter().find_map(|n| {
        let (Feature::Edge(e), Feature::Edge(g)) = n.features else { return None };
        let along = |[p, q]: [DVec3; 2]| q - p;
        let cross = along(pair.segment(Side::First, e))
            .cross(along(pair.segment(Side::Second, g)))
            .try_normalize()?;
        Some(if cross.dot(towards(n)) < 0.0 { -cross } else { cross })
    });
    let mean = || {
        let sum: DVec3 = intersection.nodes.iter().map(towards).sum();
        let centers = pair.bounds(Side::Second).center() - pair.bounds(Side::First).center();
        sum.try_normalize().or_else(|| centers.try_normalize()).unwrap_or(DVec3::Z)
    };
    crossed.unwrap_or_else(mean)
}

/// Sum of the unit normals of the faces at a feature.
pub(crate) fn mean_normal(pair: &Pair, side: Side, feature: Feature) -> DVec3 {
    let topology = pair.topology(side);
    match feature {
        Feature::Vertex(v) => topology.faces_at(v).iter().map(|&f| pair.normal(side, f)).sum(),
        Feature::Edge(e) => {
            topology.half_edges(e).iter().map(|h| pair.normal(side, h.face())).sum()
        }
        Feature::Face(f) => pair.normal(side, f),
    }
}

/// The overlap of two triangles in one plane: `b` cut by the sides of `a` (Sutherland and Hodgman
/// 1974).
fn overlap(a: &[DVec3; 3], b: &[DVec3; 3], normal: DVec3) -> Vec<DVec3> {
    let mut polygon = b.to_vec();
    for i in 0..3 {
        let (start, along) = (a[i], a[(i + 1) % 3] - a[i]);
        let height = |p: DVec3| normal.dot(along.cross(p - start));
        let mut cut = Vec::with_capacity(polygon.len() + 1);
        for (k, &p) in polygon.iter().enumerate() {
            let q = polygon[(k + 1) % polygon.len()];
            let (hp, hq) = (height(p), height(q));
            if hp >= 0.0 {
                cut.push(p);
            }
            if (hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0) {
                cut.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
        polygon = cut;
    }
    polygon
}

fn polygon_area(polygon: &[DVec3], normal: DVec3) -> f64 {
    let mut twice = 0.0;
    for k in 2..polygon.len() {
        twice += normal.dot((polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]));
    }
    0.5 * twice.abs()
}
