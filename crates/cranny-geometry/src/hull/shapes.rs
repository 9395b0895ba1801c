//! The triangles of a hull one by one: areas, which are needles, and which of their edges bend
//! clearly.
//!
//! Cost: O(n), a look at each triangle and each edge. No source: areas are lengths of cross
//! products, and an edge bends clearly where neither of its triangles is a needle, whose normal is
//! made of rounding, and each has the other's apex deeper below its plane than the tolerance.

use cranny_exact::DVec3;

use super::quickhull::HullSurface;
use crate::each_once::each_once;

/// What merging reads of each triangle.
pub(super) struct Shapes {
    /// The triangles that were looked at, ascending, where these are not all; an entry that says
    /// nothing comes first.
    some: Option<Vec<u32>>,
    /// Twice the area vector.
    area_vectors: Vec<DVec3>,
    /// Twice the area.
    areas: Vec<f64>,
    /// Whether the least height is at most the tolerance.
    needles: Vec<bool>,
    /// A bit for each edge that bends clearly.
    bends: Vec<u8>,
}

impl Shapes {
    /// Looks at each triangle and each edge once.
    pub(super) fn new(positions: &[DVec3], surface: &HullSurface, tolerance: f64) -> Self {
        let count = surface.triangles.len();
        let mut shapes = Self {
            some: None,
            area_vectors: Vec::with_capacity(count),
            areas: Vec::with_capacity(count),
            needles: Vec::with_capacity(count),
            bends: vec![0; count],
        };
        for corners in &surface.triangles {
            let Shape { area_vector, area, is_needle } = Shape::of(positions, *corners, tolerance);
            shapes.area_vectors.push(area_vector);
            shapes.areas.push(area);
            shapes.needles.push(is_needle);
        }
        let (twins, _) = surface.twins.as_chunks::<3>();
        for (t, twins) in (0..).zip(twins) {
            for (corner, &twin) in (0..).zip(twins) {
                if 3 * t + corner < twin {
                    shapes.bend(positions, surface, tolerance, [t, corner], [twin / 3, twin % 3]);
                }
            }
        }
        shapes
    }

    /// Looks at some triangles, and at those beside them as far as these need it.
    pub(super) fn of_some(
        positions: &[DVec3],
        surface: &HullSurface,
        tolerance: f64,
        triangles: &[u32],
    ) -> Self {
        let beside = |t: u32| (3 * t..3 * t + 3).map(|h| surface.twins[h as usize] / 3);
        let some = each_once(triangles.iter().flat_map(|&t| beside(t).chain([t])));
        let mut shapes = Self {
            area_vectors: vec![DVec3::ZERO],
            areas: vec![0.0],
            needles: vec![false],
            bends: vec![0; some.len() + 1],
            some: None,
        };
        for &t in &some {
            let shape = Shape::of(positions, surface.triangles[t as usize], tolerance);
            shapes.area_vectors.push(shape.area_vector);
            shapes.areas.push(shape.area);
            shapes.needles.push(shape.is_needle);
        }
        shapes.some = Some(some);
        for &t in triangles {
            for corner in 0..3 {
                let twin = surface.twins[3 * t as usize + corner as usize];
                shapes.bend(positions, surface, tolerance, [t, corner], [twin / 3, twin % 3]);
            }
        }
        shapes
    }

    /// Where a triangle stands.
    #[inline]
    fn place(&self, t: u32) -> usize {
        match &self.some {
            None => t as usize,
            Some(some) => some.binary_search(&t).map_or(0, |i| i + 1),
        }
    }

    /// Marks an edge in both its triangles if it bends clearly. Each triangle comes with the corner
    /// that the edge leaves.
    #[inline]
    fn bend(
        &mut self,
        positions: &[DVec3],
        surface: &HullSurface,
        tolerance: f64,
        one: [u32; 2],
        other: [u32; 2],
    ) {
        let places = [one, other].map(|[t, _]| self.place(t));
        let shapes = places.map(|place| (self.area_vectors[place], self.areas[place]));
        let are_wide = !self.needles[places[0]] && !self.needles[places[1]];
        if are_wide && are_apart(positions, surface, tolerance, [one, other], shapes) {
            self.bends[places[0]] |= 1 << one[1];
            self.bends[places[1]] |= 1 << other[1];
        }
    }

    /// Twice the area vector.
    pub(super) fn area_vector(&self, t: u32) -> DVec3 {
        self.area_vectors[self.place(t)]
    }

    /// Twice the area.
    pub(super) fn area(&self, t: u32) -> f64 {
        self.areas[self.place(t)]
    }

    /// Whether the least height of the triangle is at most the tolerance.
    pub(super) fn is_needle(&self, t: u32) -> bool {
        self.needles[self.place(t)]
    }

    /// Whether a half-edge of a triangle that was looked at bends clearly.
    #[inline]
    pub(super) fn bends(&self, h: u32) -> bool {
        self.bends[self.place(h / 3)] >> (h % 3) & 1 == 1
    }

    /// Whether all edges of the triangle bend clearly, so that it is a facet of its own. This
    /// spares most triangles of a smooth hull the growth.
    #[inline]
    pub(super) fn is_apart(&self, t: u32) -> bool {
        self.bends[self.place(t)] == 0b111
    }
}

/// Whether a half-edge bends clearly.
pub(super) fn bends_clearly(
    positions: &[DVec3],
    surface: &HullSurface,
    tolerance: f64,
    half_edge: u32,
) -> bool {
    let sides = [half_edge, surface.twins[half_edge as usize]].map(|h| [h / 3, h % 3]);
    let shapes = sides.map(|[t, _]| Shape::of(positions, surface.triangles[t as usize], tolerance));
    let are_wide = shapes.iter().all(|shape| !shape.is_needle);
    let shapes = shapes.map(|shape| (shape.area_vector, shape.area));
    are_wide && are_apart(positions, surface, tolerance, sides, shapes)
}

/// Whether each of two triangles at an edge has the other's apex deeper below its plane than the
/// tolerance; each with the corner that the edge leaves, its area vector and its area, twice.
#[inline]
fn are_apart(
    positions: &[DVec3],
    surface: &HullSurface,
    tolerance: f64,
    [one, other]: [[u32; 2]; 2],
    shapes: [(DVec3, f64); 2],
) -> bool {
    let corner = |t: u32, k: u32| positions[surface.triangles[t as usize][k as usize % 3] as usize];
    // Each from its own side, so that it is judged alike from whichever triangle the edge is looked
    // at.
    let is_deep = |(area_vector, area): (DVec3, f64), [t, k]: [u32; 2], [u, l]: [u32; 2]| {
        area_vector.dot(corner(t, k) - corner(u, l + 2)) > tolerance * area
    };
    is_deep(shapes[0], one, other) && is_deep(shapes[1], other, one)
}

/// One triangle.
struct Shape {
    area_vector: DVec3,
    area: f64,
    is_needle: bool,
}

impl Shape {
    #[inline]
    fn of(positions: &[DVec3], corners: [u32; 3], tolerance: f64) -> Self {
        let edges = edges(corners.map(|v| positions[v as usize]));
        let longest = longest(&edges);
        // The rounding of the two shorter edges tilts the normal of a sliver least.
        let area_vector = edges[(longest + 1) % 3].cross(edges[(longest + 2) % 3]);
        let area = area_vector.length();
        Self { area_vector, area, is_needle: area <= tolerance * edges[longest].length() }
    }
}

/// The longest edge of a triangle.
pub(super) fn longest_edge(triangle: [DVec3; 3]) -> DVec3 {
    let edges = edges(triangle);
    edges[longest(&edges)]
}

fn edges([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    [b - a, c - b, a - c]
}

/// Which edge is the longest.
fn longest(edges: &[DVec3; 3]) -> usize {
    DVec3::from_array(edges.map(DVec3::length_squared)).max_position()
}
