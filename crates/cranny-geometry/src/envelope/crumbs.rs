//! The faces of a pocket in groups of a few that lie together and face the same way: crumbs.
//!
//! Layers are made of crumbs, not of faces: there are a third as many, and what is summed once over the
//! faces of a crumb need not be looked at again in every layer. Crumbs are the leaves of a k-d tree
//! over six keys, the place and the normal, rounded to 16 bits: sharp edges are cut by normal, what is left
//! by place, at the middle of the widest range. That is done in the body's frame; what is summed over a crumb is
//! turned into the opening's. How layers divide crumbs is judged with more care
//! (`cluster`).
//!
//! Cost: O(n log n), of which a level takes a few nanoseconds a face.

use cranny_exact::{Aabb, DVec3};

use super::moments::Opening;
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::tree::partition;

/// Normals that spread wider than this along a direction are divided before places are: that is what lies
/// on both sides of an edge of 45 degrees. Smaller, and crumbs of bent walls get long; larger, and leaves lie
/// across edges, where no plane is near to all of their faces.
const BENT: f64 = 0.75;

/// Steps of the rounded keys over the widest range of places, and over half the range of normals.
const STEPS: f64 = 16_383.0;

/// Places that spread over fewer steps are rounded anew. Smaller, and rounding decides how they are divided;
/// larger, and time is spent on rounding.
const LEAST_SPREAD: i16 = 32;

/// How much finer new steps must be. Smaller, and coincident faces are rounded at every level.
const FINER: f64 = 4.0;

/// No part may be smaller than one of so many; else it is halved by number. Larger: long tails of the tree;
/// smaller: gaps between groups of faces are missed.
const LEAST_SHARE: usize = 8;

/// A crumb, as layers divide it.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// What it may be divided by: the mean of its faces' middles in the opening's frame, with the pocket's
    /// size as unit, and its mean unit normal (zero where areas cancel).
    pub(super) keys: [f64; 6],
    /// Sums over its faces of the means over their corners of the products of coordinates: xx, yy, zz, xy,
    /// yz, zx.
    pub(super) products: [f64; 6],
    /// Length of the sum of area vectors.
    pub(super) area: f64,
    /// Number of faces.
    pub(super) count: u32,
}

/// What a crumb holds.
pub(super) struct Crumb {
    /// Range of [`Crumbs::faces`].
    faces: [u32; 2],
    /// Range of [`Crumbs::corners`].
    corners: [u32; 2],
    pub(super) bounds: Aabb,
    /// The largest inner product of a corner with the opening's axis, as computed.
    pub(super) reach: f64,
}

/// The crumbs of a pocket, in memory that is used again from pocket to pocket.
#[derive(Default)]
pub(super) struct Crumbs {
    /// What layers divide them by.
    pub(super) items: Vec<Item>,
    /// What they hold.
    crumbs: Vec<Crumb>,
    faces: Vec<FaceId>,
    /// Each once in a crumb.
    corners: Vec<VertexId>,
    points: Vec<Point>,
    aside: Vec<Point>,
}

/// What crumbs are made of.
struct Source<'a> {
    mesh: &'a Mesh,
    faces: &'a [FaceId],
    opening: &'a Opening,
    /// Faces of a crumb, at most.
    most: usize,
}

impl Crumbs {
    /// Takes the place of earlier ones: crumbs of at most `most` of these faces, which lie in a box.
    pub(super) fn fill(
        &mut self,
        mesh: &Mesh,
        faces: &[FaceId],
        bounds: &Aabb,
        opening: &Opening,
        most: usize,
    ) {
        self.items.clear();
        self.crumbs.clear();
        self.faces.clear();
        self.corners.clear();
        // Crumbs are half full as a rule.
        let crumbs = 2 * faces.len().div_ceil(most);
        self.items.reserve(crumbs);
        self.crumbs.reserve(crumbs);
        self.faces.reserve(faces.len());
        let source = Source { mesh, faces, opening, most };
        let rounding = Rounding::of(bounds.min, bounds.max);
        let mut points = std::mem::take(&mut self.points);
        points.clear();
        points.extend((0..faces.len()).map(|name| source.point(name, &rounding)));
        if !points.is_empty() {
            self.divide(&source, &mut points, rounding.scale);
        }
        self.points = points;
    }

    /// What the crumb of an item holds.
    pub(super) fn crumb(&self, item: u32) -> &Crumb {
        &self.crumbs[item as usize]
    }

    pub(super) fn corners(&self, crumb: &Crumb) -> &[VertexId] {
        let [start, end] = crumb.corners;
        &self.corners[start as usize..end as usize]
    }

    /// All corners, some of them several times.
    pub(super) fn all_corners(&self) -> &[VertexId] {
        &self.corners
    }

    /// All faces in the order of some items.
    pub(super) fn ordered_faces(&self, order: &[u32]) -> impl Iterator<Item = FaceId> {
        order.iter().flat_map(|&item| {
            let [start, end] = self.crumb(item).faces;
            self.faces[start as usize..end as usize].iter().copied()
        })
    }

    /// Divides faces until they are few enough for a crumb.
    fn divide(&mut self, source: &Source, points: &mut [Point], mut scale: f64) {
        if points.len() <= source.most {
            return self.add(source, points);
        }
        let mut ranges = Ranges::of(points);
        let mut place = ranges.widest(PLACE);
        if ranges.width(place) < LEAST_SPREAD {
            let rounding = source.rounding(points);
            if rounding.scale > FINER * scale {
                points.iter_mut().for_each(|p| *p = source.point(p.name(), &rounding));
                scale = rounding.scale;
                ranges = Ranges::of(points);
                place = ranges.widest(PLACE);
            }
        }
        let facing = ranges.widest(FACING);
        let is_bent = f64::from(ranges.width(facing)) > BENT * STEPS;
        let key = if is_bent { facing } else { place };
        let middle = ranges.middle(key);
        let mut left = partition(points, &mut self.aside, |p| p.0[key] <= middle);
        if left.min(points.len() - left) < points.len() / LEAST_SHARE || left == points.len() {
            left = points.len() / 2;
            points.select_nth_unstable_by_key(left, |p| (p.0[key], p.name()));
        }
        let (left, right) = points.split_at_mut(left);
        self.divide(source, left, scale);
        self.divide(source, right, scale);
    }

    /// Makes a crumb.
    fn add(&mut self, source: &Source, points: &[Point]) {
        let Source { mesh, opening, .. } = source;
        let starts = [self.faces.len(), self.corners.len()];
        let (mut bounds, mut reach) = (Aabb::EMPTY, f64::NEG_INFINITY);
        let (mut place, mut area) = (DVec3::ZERO, DVec3::ZERO);
        let [mut squares, mut mixed] = [DVec3::ZERO; 2];
        for point in points {
            let face = source.faces[point.name()];
            self.faces.push(face);
            let triangle = mesh.triangle(face);
            area += area_vector(&triangle);
            for (vertex, p) in mesh.corners(face).into_iter().zip(triangle) {
                let q = opening.beside_origin(p);
                place += q;
                squares += q * q;
                mixed += q * DVec3::new(q.y, q.z, q.x);
                if !self.corners[starts[1]..].contains(&vertex) {
                    self.corners.push(vertex);
                    bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
                    reach = larger(reach, opening.axis.dot(p));
                }
            }
        }
        let ends = [self.faces.len(), self.corners.len()];
        let [faces, corners] = [0, 1].map(|k| [starts[k] as u32, ends[k] as u32]);
        self.crumbs.push(Crumb { faces, corners, bounds, reach });
        let length = area.length();
        let normal = if length > 0.0 { opening.turned(area) / length } else { DVec3::ZERO };
        let [x, y, z] = (opening.turned(place) / (3 * points.len()) as f64).to_array();
        let [a, b, c] = normal.to_array();
        // No zero has a sign, so that all orders agree.
        let keys = [x, y, z, a, b, c].map(|key| key + 0.0);
        let products = opening.turned_products(squares / 3.0, mixed / 3.0);
        self.items.push(Item { keys, products, area: length, count: points.len() as u32 });
    }
}

impl Source<'_> {
    /// A face by its number among all, rounded.
    fn point(&self, name: usize, rounding: &Rounding) -> Point {
        let triangle = self.mesh.triangle(self.faces[name]);
        let place = rounding.scale * (middle(&triangle) - rounding.low);
        let area = area_vector(&triangle);
        let length = area.length();
        let facing = area * if length > 0.0 { STEPS / length } else { 0.0 };
        let [x, y, z] = place.to_array().map(|x| x as i16);
        let [a, b, c] = facing.to_array().map(|x| x as i16);
        Point([x, y, z, name as i16, a, b, c, (name >> 16) as i16])
    }

    /// The finest rounding that holds some faces.
    fn rounding(&self, points: &[Point]) -> Rounding {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            let place = middle(&self.mesh.triangle(self.faces[point.name()]));
            (low, high) = (low.min(place), high.max(place));
        }
        Rounding::of(low, high)
    }
}

fn middle(&[a, b, c]: &[DVec3; 3]) -> DVec3 {
    (a + b + c) / 3.0
}

fn area_vector(&[a, b, c]: &[DVec3; 3]) -> DVec3 {
    0.5 * (b - a).cross(c - a)
}

/// The larger of two numbers. Unlike `f64::max` one instruction: neither is NaN.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A face on its way into a crumb: its place, rounded; half of its name; its normal, rounded; the other half.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Point([i16; 8]);

/// Where the place begins, and where the normal.
const PLACE: usize = 0;
const FACING: usize = 4;

impl Point {
    fn name(&self) -> usize {
        usize::from(self.0[3] as u16) | usize::from(self.0[7] as u16) << 16
    }
}

/// How places become steps.
struct Rounding {
    low: DVec3,
    /// Steps a unit; 0 where all are in one place.
    scale: f64,
}

impl Rounding {
    /// Of places between two corners of a box.
    fn of(low: DVec3, high: DVec3) -> Self {
        let scale = STEPS / (high - low).max_element();
        Self { low, scale: if scale.is_finite() { scale } else { 0.0 } }
    }
}

/// Least and greatest keys of some points.
struct Ranges {
    low: [i16; 8],
    high: [i16; 8],
}

impl Ranges {
    fn of(points: &[Point]) -> Self {
        let mut ranges = Self { low: [i16::MAX; 8], high: [i16::MIN; 8] };
        for point in points {
            for k in 0..8 {
                ranges.low[k] = ranges.low[k].min(point.0[k]);
                ranges.high[k] = ranges.high[k].max(point.0[k]);
            }
        }
        ranges
    }

    /// At most twice the steps, which 16 bits hold.
    fn width(&self, key: usize) -> i16 {
        self.high[key] - self.low[key]
    }

    fn middle(&self, key: usize) -> i16 {
        self.low[key] + self.width(key) / 2
    }

    /// The key with the widest range of three.
    fn widest(&self, first: usize) -> usize {
        let wider = |best, key| if self.width(key) > self.width(best) { key } else { best };
        (first + 1..first + 3).fold(first, wider)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crumbs_do_not_lie_across_a_sharp_edge() {
        // A strip of eight squares in the plane z = 0 that goes on with eight in the plane x = 8.
        let place = |i: u32| [i.min(8), i.max(8) - 8].map(f64::from);
        let point = |i: u32, y: f64| DVec3::new(place(i)[0], y, place(i)[1]);
        let vertices = (0..=16).flat_map(|i| [point(i, 0.0), point(i, 1.0)]).collect();
        let square = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
        let mesh = Mesh::new(vertices, (0..16).flat_map(square).collect()).unwrap();
        let faces: Vec<FaceId> = (0..32).map(FaceId).collect();
        let opening = Opening::of(&[DVec3::Z], &mesh.bounds());
        let mut crumbs = Crumbs::default();
        crumbs.fill(&mesh, &faces, &mesh.bounds(), &opening, 4);
        assert_eq!(crumbs.items.len(), 8);
        let (along, across) = (opening.turned(DVec3::Z), opening.turned(-DVec3::X));
        for (name, item) in (0..).zip(&crumbs.items) {
            // Four triangles of two squares, which have six corners.
            assert_eq!((item.count, item.area), (4, 2.0));
            assert_eq!(crumbs.corners(crumbs.crumb(name)).len(), 6);
            let normal = DVec3::from_slice(&item.keys[3..]);
            assert!(normal == along || normal == across, "{normal}");
        }
        let mut ordered: Vec<FaceId> = crumbs.ordered_faces(&[0, 1, 2, 3, 4, 5, 6, 7]).collect();
        ordered.sort_unstable();
        assert_eq!(ordered, faces);
        let highest = (0..8).map(|item| crumbs.crumb(item).reach).fold(0.0, f64::max);
        assert_eq!(highest, 8.0);
    }
}
