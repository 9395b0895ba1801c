//! What an estimate has found so far, and what could still change it.

use cranny_exact::{DVec3, Meeting};
use cranny_geometry::{FaceId, VertexId};

use crate::answer::{Counters, Feature, Surface, Witness};
use crate::closest::NearestFaces;
use crate::evaluate::meeting_witnesses;
use crate::pair::{Pair, Side};
use crate::query::Demand;
use crate::surface::FacePair;

/// What was found about the two surfaces.
pub(super) struct Findings<'p, 'm> {
    pair: &'p Pair<'m>,
    demand: Demand,
    nearest: NearestFaces<'p, 'm>,
    /// The strongest meeting that was found.
    pub(super) surface: Surface,
    met: Option<FacePair>,
    /// Two vertices that lie near each other.
    vertices: Option<([VertexId; 2], f64)>,
    pub(super) counters: Counters,
}

impl<'p, 'm> Findings<'p, 'm> {
    pub(super) fn new(pair: &'p Pair<'m>, demand: Demand) -> Self {
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

    /// What is farther apart than this changes nothing.
    pub(super) fn limit(&self) -> f64 {
        match self.demand {
            Demand::None | Demand::Intersects => 0.0,
            Demand::Distance { below } => self.least().min(below.unwrap_or(f64::INFINITY)),
            Demand::Contacts { margin, .. } | Demand::Regions { margin } => margin,
        }
    }

    /// Whether nothing can change any more.
    pub(super) fn is_done(&self) -> bool {
        match self.demand {
            Demand::None | Demand::Intersects => self.surface == Meeting::Cross,
            Demand::Distance { .. } => self.surface.meets(),
            Demand::Contacts { .. } | Demand::Regions { .. } => false,
        }
    }

    /// Whether it helps to know faces that are near, be they the nearest or not.
    pub(super) fn wants_near_faces(&self) -> bool {
        !matches!(self.demand, Demand::Intersects) || self.knows_no_faces()
    }

    /// Whether no faces were measured yet.
    pub(super) fn knows_no_faces(&self) -> bool {
        self.least() == f64::INFINITY
    }

    /// Tests that [`look`](Self::look) makes at most.
    pub(super) const TESTS_A_LOOK: u64 = 2;

    /// Looks at two faces; returns a lower bound of their distance, 0 where they meet.
    pub(super) fn look(&mut self, first: FaceId, second: FaceId) -> f64 {
        let triangles =
            [self.pair.triangle(Side::First, first), self.pair.triangle(Side::Second, second)];
        // Beyond rounding along either normal is proof enough.
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

    /// Takes note of two vertices.
    pub(super) fn offer_vertices(&mut self, vertices: [VertexId; 2]) {
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
    pub(super) fn upper(&self) -> f64 {
        if self.surface.meets() {
            return 0.0;
        }
        let vertices = self.vertices.map_or(f64::INFINITY, |(_, distance)| distance);
        self.least().min(vertices) + self.pair.length_error()
    }

    /// Faces that meet, or the nearest ones: what the next frame looks at first.
    pub(super) fn faces(&self) -> Option<[FaceId; 2]> {
        let met = self.met.map(|met| [met.first, met.second]);
        met.or_else(|| self.nearest.faces())
    }

    /// Points that are as near as [`upper`](Self::upper) says, in the caller's order.
    pub(super) fn witnesses(&self) -> Option<[Witness; 2]> {
        let pair = self.pair;
        if let Some(met) = &self.met {
            return Some(meeting_witnesses(pair, met));
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

/// How far apart two triangles are along the normal of either; 0 or less if they overlap along both.
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
