//! The faces of a pocket in groups of a few that lie together and face the same way: crumbs.
//!
//! Layers are made of crumbs, not of faces: there are a third as many, and what is summed once over the
//! faces of a crumb need not be looked at again in every layer. Crumbs are the leaves of a k-d tree
//! over six keys, the place and the normal, rounded to 16 bits: sharp edges are cut by normal, what is left
//! by place, at the middle of the widest range. How layers divide crumbs is judged with more care
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

/// A face of the pocket.
#[derive(Clone, Copy)]
struct Face {
    /// Its middle in the opening's frame.
    place: DVec3,
    /// Means over its corners of the products of coordinates: xx, yy, zz, and xy, yz, zx.
    products: [DVec3; 2],
    /// Unit normal in this frame; zero for a face without area.
    normal: DVec3,
    area: f64,
    id: FaceId,
}

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
    pub(super) crumb: u32,
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

/// The crumbs of a pocket.
#[derive(Default)]
pub(super) struct Crumbs {
    pub(super) items: Vec<Item>,
    crumbs: Vec<Crumb>,
    faces: Vec<FaceId>,
    /// Each once in a crumb.
    corners: Vec<DVec3>,
    scratch: Scratch,
}

/// Memory that is used again from pocket to pocket.
#[derive(Default)]
struct Scratch {
    faces: Vec<Face>,
    points: Vec<Point>,
    aside: Vec<Point>,
    vertices: Vec<VertexId>,
}

impl Crumbs {
    /// Takes the place of earlier ones: crumbs of at most `most` of these faces.
    pub(super) fn fill(&mut self, mesh: &Mesh, faces: &[FaceId], opening: &Opening, most: usize) {
        self.items.clear();
        self.crumbs.clear();
        self.faces.clear();
        self.corners.clear();
        self.scratch.faces.clear();
        self.scratch.faces.extend(faces.iter().map(|&face| Face::of(mesh, face, opening)));
        let mut points = std::mem::take(&mut self.scratch.points);
        points.clear();
        points.resize(faces.len(), Point([0; 8]));
        for (point, name) in points.iter_mut().zip(0..) {
            point.set_name(name);
        }
        if !points.is_empty() {
            let rounding = Rounding::of(&points, &self.scratch.faces);
            rounding.apply(&mut points, &self.scratch.faces);
            self.divide(mesh, opening, &mut points, rounding.scale, most);
        }
        self.scratch.points = points;
    }

    pub(super) fn crumb(&self, item: &Item) -> &Crumb {
        &self.crumbs[item.crumb as usize]
    }

    pub(super) fn corners(&self, crumb: &Crumb) -> &[DVec3] {
        let [start, end] = crumb.corners;
        &self.corners[start as usize..end as usize]
    }

    /// All corners, some of them several times.
    pub(super) fn all_corners(&self) -> impl Iterator<Item = DVec3> {
        self.corners.iter().copied()
    }

    /// All faces in the order of the items.
    pub(super) fn ordered_faces(&self) -> impl Iterator<Item = FaceId> {
        self.items.iter().flat_map(|item| {
            let [start, end] = self.crumb(item).faces;
            self.faces[start as usize..end as usize].iter().copied()
        })
    }

    /// Divides faces until they are few enough for a crumb.
    fn divide(
        &mut self,
        mesh: &Mesh,
        opening: &Opening,
        points: &mut [Point],
        mut scale: f64,
        most: usize,
    ) {
        if points.len() <= most {
            return self.add(mesh, opening, points);
        }
        let mut ranges = Ranges::of(points);
        let mut place = ranges.widest(PLACE);
        if ranges.width(place) < LEAST_SPREAD {
            let rounding = Rounding::of(points, &self.scratch.faces);
            if rounding.scale > FINER * scale {
                rounding.apply(points, &self.scratch.faces);
                scale = rounding.scale;
                ranges = Ranges::of(points);
                place = ranges.widest(PLACE);
            }
        }
        let facing = ranges.widest(FACING);
        let is_bent = f64::from(ranges.width(facing)) > BENT * STEPS;
        let key = if is_bent { facing } else { place };
        let middle = ranges.middle(key);
        let mut left = partition(points, &mut self.scratch.aside, |p| p.0[key] <= middle);
        if left.min(points.len() - left) < points.len() / LEAST_SHARE || left == points.len() {
            left = points.len() / 2;
            points.select_nth_unstable_by_key(left, |p| (p.0[key], p.name()));
        }
        let (left, right) = points.split_at_mut(left);
        self.divide(mesh, opening, left, scale, most);
        self.divide(mesh, opening, right, scale, most);
    }

    /// Makes a crumb.
    fn add(&mut self, mesh: &Mesh, opening: &Opening, points: &[Point]) {
        let starts = [self.faces.len() as u32, self.corners.len() as u32];
        let (mut place, mut sum, mut products) = (DVec3::ZERO, DVec3::ZERO, [DVec3::ZERO; 2]);
        let vertices = &mut self.scratch.vertices;
        vertices.clear();
        for point in points {
            let face = &self.scratch.faces[point.name()];
            place += face.place;
            sum += face.area * face.normal;
            products[0] += face.products[0];
            products[1] += face.products[1];
            self.faces.push(face.id);
            for vertex in mesh.corners(face.id) {
                if !vertices.contains(&vertex) {
                    vertices.push(vertex);
                }
            }
        }
        let (mut bounds, mut reach) = (Aabb::EMPTY, f64::NEG_INFINITY);
        for &vertex in &*vertices {
            let p = mesh.position(vertex);
            bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
            reach = larger(reach, opening.axis.dot(p));
            self.corners.push(p);
        }
        let ends = [self.faces.len() as u32, self.corners.len() as u32];
        let [faces, corners] = [0, 1].map(|k| [starts[k], ends[k]]);
        let crumb = self.crumbs.len() as u32;
        self.crumbs.push(Crumb { faces, corners, bounds, reach });
        let area = sum.length();
        let [x, y, z] = (place / points.len() as f64).to_array();
        let [a, b, c] = if area > 0.0 { sum / area } else { DVec3::ZERO }.to_array();
        // No zero has a sign, so that all orders agree.
        let keys = [x, y, z, a, b, c].map(|key| key + 0.0);
        let [[xx, yy, zz], [xy, yz, zx]] = products.map(|p| p.to_array());
        let products = [xx, yy, zz, xy, yz, zx];
        self.items.push(Item { keys, products, area, count: points.len() as u32, crumb });
    }
}

impl Face {
    fn of(mesh: &Mesh, id: FaceId, opening: &Opening) -> Self {
        let area_vector = mesh.area_vector(id);
        let area = area_vector.length();
        let along = if area > 0.0 { 1.0 / area } else { 0.0 };
        let corners = mesh.triangle(id).map(|p| opening.place(p));
        let mean = |of: fn(DVec3) -> DVec3| corners.into_iter().map(of).sum::<DVec3>() / 3.0;
        let place = mean(|p| p);
        let products = [mean(|p| p * p), mean(|p| p * DVec3::new(p.y, p.z, p.x))];
        Self { place, products, normal: along * opening.turned(area_vector), area, id }
    }
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

    fn set_name(&mut self, name: u32) {
        (self.0[3], self.0[7]) = (name as i16, (name >> 16) as i16);
    }
}

/// How places become steps.
struct Rounding {
    low: DVec3,
    /// Steps a unit; 0 where all are in one place.
    scale: f64,
}

impl Rounding {
    /// The finest one that holds some faces.
    fn of(points: &[Point], faces: &[Face]) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            let place = faces[point.name()].place;
            (low, high) = (low.min(place), high.max(place));
        }
        let scale = STEPS / (high - low).max_element();
        Self { low, scale: if scale.is_finite() { scale } else { 0.0 } }
    }

    fn apply(&self, points: &mut [Point], faces: &[Face]) {
        for point in points {
            let Face { place, normal, .. } = &faces[point.name()];
            for axis in 0..3 {
                point.0[PLACE + axis] = (self.scale * (place[axis] - self.low[axis])) as i16;
                point.0[FACING + axis] = (STEPS * normal[axis]) as i16;
            }
        }
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
        crumbs.fill(&mesh, &faces, &opening, 4);
        assert_eq!(crumbs.items.len(), 8);
        let (along, across) = (opening.turned(DVec3::Z), opening.turned(-DVec3::X));
        for item in &crumbs.items {
            // Four triangles of two squares, which have six corners.
            assert_eq!((item.count, item.area), (4, 2.0));
            assert_eq!(crumbs.corners(crumbs.crumb(item)).len(), 6);
            let normal = DVec3::from_slice(&item.keys[3..]);
            assert!(normal == along || normal == across, "{normal}");
        }
        let mut ordered: Vec<FaceId> = crumbs.ordered_faces().collect();
        ordered.sort_unstable();
        assert_eq!(ordered, faces);
        let highest = crumbs.items.iter().map(|item| crumbs.crumb(item).reach).fold(0.0, f64::max);
        assert_eq!(highest, 8.0);
    }
}
