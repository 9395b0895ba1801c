//! Regions of bodies that touch without sharing interior points.

use std::collections::HashMap;

use cranny_exact::{DVec3, orient3d};
use cranny_geometry::{DisjointSets, VertexId};

use crate::answer::{Contact, Feature, Region};
use crate::found::Found;
use crate::intersection::{Intersection, Node, intersect};
use crate::pair::{Pair, Side};
use crate::reduce::reduce;
use crate::surface::FacePair;

/// Groups touching pairs into regions, in world coordinates and the caller's order: pairs whose
/// faces share a vertex on both bodies are neighbours.
pub(crate) fn touch_regions(pair: &Pair, touching: &[FacePair]) -> Vec<Region> {
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
    sets.groups().into_iter().map(|group| region(pair, &of_group(group)).finish(pair)).collect()
}

/// A connected region of touching faces.
fn region(pair: &Pair, pairs: &[FacePair]) -> Found {
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
        let (point, features) = pairs[0].shared_point(pair);
        contacts.push(Contact::touching(features, point, normal));
    }
    let of_closed = |figure| pair.is_closed().then_some(figure);
    let (depth, area, points) = (of_closed(0.0), of_closed(area), reduce(contacts));
    let faces = pairs.iter().map(|p| [p.first, p.second]).collect();
    Found { normal, depth, area, points, curves: Vec::new(), faces }
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
    let towards = |n: &Node| {
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
fn mean_normal(pair: &Pair, side: Side, feature: Feature) -> DVec3 {
    feature.faces(pair.topology(side)).into_iter().map(|f| pair.normal(side, f)).sum()
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
    let from = |k: usize| polygon[k] - polygon[0];
    let twice: f64 = (2..polygon.len()).map(|k| normal.dot(from(k - 1).cross(from(k)))).sum();
    0.5 * twice.abs()
}
