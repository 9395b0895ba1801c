//! The triangles of a hull one by one: areas, which are needles, and which of their edges bend clearly.

use cranny_exact::DVec3;

use super::quickhull::{Surface, previous};

/// What merging asks of each triangle.
pub(super) struct Shapes {
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
    pub(super) fn new(positions: &[DVec3], surface: &Surface, tolerance: f64) -> Self {
        let count = surface.triangles.len();
        let mut shapes = Self {
            area_vectors: Vec::with_capacity(count),
            areas: Vec::with_capacity(count),
            needles: Vec::with_capacity(count),
            bends: vec![0; count],
        };
        for corners in &surface.triangles {
            let edges = edges(corners.map(|v| positions[v as usize]));
            let longest = longest(&edges);
            // The rounding of the two shorter edges tilts the normal of a sliver least.
            let area_vector = edges[(longest + 1) % 3].cross(edges[(longest + 2) % 3]);
            let area = area_vector.length();
            shapes.area_vectors.push(area_vector);
            shapes.areas.push(area);
            shapes.needles.push(area <= tolerance * edges[longest].length());
        }
        for (t, corners) in surface.triangles.iter().enumerate() {
            for (i, &from) in corners.iter().enumerate() {
                let h = 3 * t as u32 + i as u32;
                let twin = surface.twins[h as usize];
                if h < twin {
                    let from = positions[from as usize];
                    let apex = positions[surface.origin(previous(h)) as usize];
                    let other = positions[surface.origin(previous(twin)) as usize];
                    let is_deep = |t: u32, below: DVec3| {
                        let t = t as usize;
                        shapes.area_vectors[t].dot(below) > tolerance * shapes.areas[t]
                    };
                    if is_deep(t as u32, from - other) && is_deep(twin / 3, from - apex) {
                        shapes.bends[t] |= 1 << i;
                        shapes.bends[twin as usize / 3] |= 1 << (twin % 3);
                    }
                }
            }
        }
        shapes
    }

    /// Twice the area vector.
    pub(super) fn area_vector(&self, t: u32) -> DVec3 {
        self.area_vectors[t as usize]
    }

    /// Twice the area.
    pub(super) fn area(&self, t: u32) -> f64 {
        self.areas[t as usize]
    }

    /// Whether the least height of the triangle is at most the tolerance.
    pub(super) fn is_needle(&self, t: u32) -> bool {
        self.needles[t as usize]
    }

    /// Whether the triangle bends away from its neighbours so clearly, seen from either side of each
    /// edge, and is itself so far from a needle, as they are, that it is a facet of its own. This
    /// spares most triangles of a smooth hull the growth.
    pub(super) fn is_apart(&self, surface: &Surface, t: u32) -> bool {
        self.bends[t as usize] == 0b111
            && !self.is_needle(t)
            && (3 * t..3 * t + 3).all(|h| !self.is_needle(surface.twins[h as usize] / 3))
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
    let [a, b, c] = edges.map(DVec3::length_squared);
    if a >= b.max(c) {
        0
    } else if b >= c {
        1
    } else {
        2
    }
}
