//! The dimensions that a hull may have.

/// The dimension of a hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum HullKind {
    /// No points were given.
    Empty,
    /// All points coincide: one vertex, no triangle, no facet.
    Point,
    /// All points lie on a line: two vertices, no triangle, no facet.
    Segment,
    /// All points lie in a plane. The hull is a two-sided plate: a fan of triangles in front, the
    /// same fan turned over behind, two facets with opposite outlines. Euler's formula holds.
    Polygon,
    /// The points span space: a closed surface with an interior.
    Volume,
}

impl HullKind {
    /// The kind that a saved hull names by this byte, its place in the list above.
    pub(super) fn of_code(code: u8) -> Option<Self> {
        let all = [Self::Empty, Self::Point, Self::Segment, Self::Polygon, Self::Volume];
        all.into_iter().find(|kind| *kind as u8 == code)
    }

    /// Whether a hull of this dimension can have as many vertices and triangles.
    pub(super) fn allows(self, vertices: usize, triangles: usize) -> bool {
        match self {
            Self::Empty => (vertices, triangles) == (0, 0),
            Self::Point => (vertices, triangles) == (1, 0),
            Self::Segment => (vertices, triangles) == (2, 0),
            Self::Polygon => vertices >= 3 && triangles + 4 == 2 * vertices,
            Self::Volume => vertices >= 4 && triangles + 4 == 2 * vertices,
        }
    }

    /// As written in reports: `"empty"`, `"point"`, `"segment"`, `"polygon"` or `"volume"`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::Point => "point",
            Self::Segment => "segment",
            Self::Polygon => "polygon",
            Self::Volume => "volume",
        }
    }
}
