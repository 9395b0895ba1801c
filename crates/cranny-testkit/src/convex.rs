//! Convex sets as intersections of half-spaces, and convex polygons that are cut by them.

use std::cmp::Ordering;

use crate::rational::{Q, Q3};

/// The points `x` with `normal · x >= offset`.
#[derive(Clone, Debug)]
pub(crate) struct HalfSpace {
    normal: Q3,
    offset: Q,
}

impl HalfSpace {
    /// Bounded by the plane through `point`; `normal` points inward. A zero normal bounds nothing.
    pub(crate) fn at(point: &Q3, normal: Q3) -> Self {
        Self { offset: normal.dot(point), normal }
    }

    pub(crate) fn opposite(&self) -> Self {
        Self { normal: &self.normal * &Q::NEG_ONE, offset: -&self.offset }
    }

    /// `Greater` inside, `Equal` on the bounding plane, `Less` outside.
    pub(crate) fn side(&self, p: &Q3) -> Ordering {
        self.height(p).cmp(&Q::ZERO)
    }

    fn height(&self, p: &Q3) -> Q {
        self.normal.dot(p) - &self.offset
    }
}

/// A convex polygon given by its corners in order; two corners are a segment, one is a point, none
/// is the empty set.
pub(crate) type Polygon = Vec<Q3>;

/// The part of a polygon inside a half-space (Sutherland and Hodgman 1974).
pub(crate) fn clipped(polygon: &[Q3], by: &HalfSpace) -> Polygon {
    let heights: Vec<Q> = polygon.iter().map(|p| by.height(p)).collect();
    let mut kept = Polygon::new();
    for (i, (p, h)) in polygon.iter().zip(&heights).enumerate() {
        let j = (i + 1) % polygon.len();
        let (q, k) = (&polygon[j], &heights[j]);
        if h >= &Q::ZERO {
            kept.push(p.clone());
        }
        if (h > &Q::ZERO && k < &Q::ZERO) || (h < &Q::ZERO && k > &Q::ZERO) {
            kept.push(p.towards(q, &(h / (h - k))));
        }
    }
    kept.dedup();
    while kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

/// A closed triangle as an intersection of half-spaces; degenerate ones are segments or points.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) corners: [Q3; 3],
    /// `(b − a) × (c − a)`; zero where the triangle has no area.
    pub(crate) normal: Q3,
    /// Planes that hold it, each as two half-spaces.
    flat: Vec<HalfSpace>,
    /// Half-spaces beyond which it does not reach.
    rims: Vec<HalfSpace>,
}

impl Region {
    pub(crate) fn of(corners: &[Q3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a));
        let (planes, rims) = if normal.is_zero() {
            segment_bounds(corners)
        } else {
            let rim = |p: &Q3, q: &Q3| HalfSpace::at(p, normal.cross(&(q - p)));
            (vec![HalfSpace::at(a, normal.clone())], vec![rim(a, b), rim(b, c), rim(c, a)])
        };
        let flat = planes.into_iter().flat_map(|plane| [plane.opposite(), plane]).collect();
        Self { corners: corners.clone(), normal, flat, rims }
    }

    pub(crate) fn has_area(&self) -> bool {
        !self.normal.is_zero()
    }

    pub(crate) fn contains(&self, p: &Q3) -> bool {
        self.flat.iter().chain(&self.rims).all(|h| h.side(p) != Ordering::Less)
    }

    /// Whether a point of its plane lies strictly inside; never where it has no area.
    pub(crate) fn contains_inside(&self, p: &Q3) -> bool {
        self.has_area() && self.rims.iter().all(|h| h.side(p) == Ordering::Greater)
    }

    /// The part of a polygon that lies in this triangle.
    pub(crate) fn clip(&self, polygon: &[Q3]) -> Polygon {
        let halves = self.flat.iter().chain(&self.rims);
        halves.fold(polygon.to_vec(), |rest, half| clipped(&rest, half))
    }
}

/// The planes and rims of the segment that collinear corners span. Its normals are the products of
/// its direction with the axes; a point is held by the three coordinate planes through it.
fn segment_bounds([a, b, c]: &[Q3; 3]) -> (Vec<HalfSpace>, Vec<HalfSpace>) {
    let length_squared = |p: &Q3, q: &Q3| (q - p).dot(&(q - p));
    let longest = [(a, b), (b, c), (c, a)].into_iter().max_by_key(|(p, q)| length_squared(p, q));
    let (p, q) = longest.unwrap_or((a, b));
    let direction = q - p;
    let axes = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z].map(Q3::exactly);
    if direction.is_zero() {
        return (axes.into_iter().map(|axis| HalfSpace::at(p, axis)).collect(), Vec::new());
    }
    let planes = axes.iter().map(|axis| HalfSpace::at(p, direction.cross(axis))).collect();
    let rims =
        vec![HalfSpace::at(p, direction.clone()), HalfSpace::at(q, &direction * &Q::NEG_ONE)];
    (planes, rims)
}
