//! What the tests of one estimate have found so far, and what could still change it.

use cranny_exact::{DVec3, Meeting};
use cranny_geometry::{FaceId, VertexId};
use cranny_narrow_phase::operations::{FacePair, NearestFaces, Pair, Side};
use cranny_narrow_phase::{Counters, Demand, Feature, Surface, Witness};

/// What was found about the two surfaces.
pub(crate) struct Findings<'p, 'm> {
    pair: &'p Pair<'m>,
    demand: Demand,
    nearest: NearestFaces<'p, 'm>,
    /// The strongest meeting that was found.
    pub(crate) surface: Surface,
    met: Option<FacePair>,
    /// Two vertices that lie near each other.
    vertices: Option<([VertexId; 2], f64)>,
    pub(crate) counters: Counters,
}

impl<'p, 'm> Findings<'p, 'm> {
    pub(crate) fn new(pair: &'p Pair<'m>, demand: Demand) -> Self {
        Self {
            pair,
            demand,
            nearest: NearestFaces::less_than(pair, f64::INFINITY),
            surface: Meeting::None,
            met: None,
            vertices: None,
            counters: Counters::default(),
        }
    }

    /// Faces that are farther apart than this cannot change the result.
    pub(crate) fn limit(&self) -> f64 {
        match self.demand {
            Demand::None | Demand::Intersects => 0.0,
            Demand::Distance { below } => self.least().min(below.unwrap_or(f64::INFINITY)),
            Demand::Contacts { margin, .. } | Demand::Regions { margin } => margin,
        }
    }

    /// Whether no further test can change the result.
    pub(crate) fn is_done(&self) -> bool {
        match self.demand {
            Demand::None | Demand::Intersects => self.surface == Meeting::Cross,
            Demand::Distance { .. } => self.surface.meets(),
            Demand::Contacts { .. } | Demand::Regions { .. } => false,
        }
    }

    /// Tests made so far.
    pub(crate) fn tests(&self) -> u64 {
        self.counters.node_tests + self.counters.triangle_tests
    }

    /// Whether faces that are near help, even if they are not the nearest.
    pub(crate) fn wants_near_faces(&self) -> bool {
        !matches!(self.demand, Demand::Intersects) || self.knows_no_faces()
    }

    /// Whether no faces were measured yet.
    pub(crate) fn knows_no_faces(&self) -> bool {
        self.least() == f64::INFINITY
    }

    /// The most tests that [`test`](Self::test) makes.
    pub(crate) const TESTS_A_PAIR: u64 = 2;

    /// Tests two faces; returns a lower bound of their distance, 0 where they meet.
    pub(crate) fn test(&mut self, first: FaceId, second: FaceId) -> f64 {
        let triangles =
            [self.pair.triangle(Side::First, first), self.pair.triangle(Side::Second, second)];
        // A gap along either normal that exceeds rounding proves that they are apart.
        self.counters.triangle_tests += 1;
        let gap = gap_along_normals(&triangles) - self.pair.length_error();
        self.counters.triangles_filtered += u64::from(gap > 0.0);
        if gap > self.least() {
            return gap;
        }
        if gap <= 0.0
            && let Some(found) =
                FacePair::of([first, second], [&triangles[0], &triangles[1]], &mut self.counters)
        {
            self.surface = self.surface.max(found.meeting);
            let stronger = self.met.is_none_or(|met| found.meeting > met.meeting);
            self.met = if stronger { Some(found) } else { self.met };
            return 0.0;
        }
        self.nearest.offer(first, second, &mut self.counters).max(gap).max(0.0)
    }

    /// Measures two vertices.
    pub(crate) fn offer_vertices(&mut self, vertices: [VertexId; 2]) {
        let [p, q] = self.positions(vertices);
        let distance = (q - p).length();
        if self.vertices.is_none_or(|(_, least)| distance < least) {
            self.vertices = Some((vertices, distance));
        }
    }

    fn positions(&self, [v, w]: [VertexId; 2]) -> [DVec3; 2] {
        [self.pair.position(Side::First, v), self.pair.position(Side::Second, w)]
    }

    /// The least distance between faces that were measured, rounded.
    fn least(&self) -> f64 {
        self.nearest.limit()
    }

    /// The surfaces are no farther apart than this.
    pub(crate) fn upper(&self) -> f64 {
        if self.surface.meets() {
            return 0.0;
        }
        let vertices = self.vertices.map_or(f64::INFINITY, |(_, distance)| distance);
        self.least().min(vertices) + self.pair.length_error()
    }

    /// Faces that meet, or the nearest ones: the next frame tests them first.
    pub(crate) fn faces(&self) -> Option<[FaceId; 2]> {
        let met = self.met.map(|met| [met.first, met.second]);
        met.or_else(|| self.nearest.faces())
    }

    /// Points that are as near as [`upper`](Self::upper) says, in the caller's order.
    pub(crate) fn witnesses(&self) -> Option<[Witness; 2]> {
        let pair = self.pair;
        if let Some(met) = &self.met {
            return Some(met.witnesses(pair));
        }
        let near = self.nearest.found();
        let ([p, q], [f, g]) = match (self.vertices, near) {
            (Some((v, distance)), near) if near.is_none_or(|near| distance < near.distance) => {
                (self.positions(v), v.map(Feature::Vertex))
            }
            (_, near) => near.map(|near| (near.points, near.features))?,
        };
        Some(pair.ordered(pair.world_witness(p, f), pair.world_witness(q, g)))
    }
}

/// The larger gap between two triangles along the normal of either; 0 or less if they overlap along
/// both.
fn gap_along_normals(triangles: &[[DVec3; 3]; 2]) -> f64 {
    let along = triangles.iter().map(|[a, b, c]| {
        let normal = (*b - *a).cross(*c - *a).normalize_or_zero();
        let [first, second] = triangles.map(|t| t.map(|p| normal.dot(p)));
        (least(second) - most(first)).max(least(first) - most(second))
    });
    along.fold(f64::NEG_INFINITY, f64::max)
}

fn least([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

fn most([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}
