//! Figures of pairs in special positions (faces flush, edges across edges, vertices in faces): they
//! are read at a position beside, which is none; contacts are measured again at their own.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId};

use crate::answer::{Contact, Feature};
use crate::intersection::{Intersection, intersect};
use crate::pair::{GrownVertices, Pair, Side};
use crate::search::meeting_pairs;
use crate::tally::Tally;

/// How far the second body is moved or grown to read the regions of a special position (faces
/// flush, edges crossing edges), as a fraction of the pair's scale: 2^-30. Depth and area are then
/// off by as much. Smaller: rounding decides what is inside; larger: figures suffer.
const NUDGE: f64 = 9.313_225_746_154_785e-10;

/// Directions of the nudge: generic, so that no plane of a modelled part holds them.
const NUDGES: [DVec3; 3] = [
    DVec3::new(0.537, 0.681, 0.498),
    DVec3::new(-0.613, 0.441, -0.656),
    DVec3::new(0.701, -0.529, 0.478),
];

/// By how much a depth read beside a special position may be off, as a fraction of the pair's
/// scale. Vertices move by no more than two nudges; a face that leans from the normal by up to 60
/// degrees doubles that.
const BESIDE_ERROR: f64 = 4.0 * NUDGE;

/// A body that shrinks or grows also moves, by this share of it: enough to leave special positions,
/// too little to bring faces back to the side from which they parted.
const SHARE: f64 = 0.125;

/// A plane that leans from the normal of a contact by a sine of less is not met along it: rounding
/// is multiplied by the inverse. Larger: contacts on steep faces stay off by a nudge.
const STEEPEST: f64 = 1e-3;

/// What `read` finds at a pair's own position, or beside it where that is a special one, and by how
/// much its depths may be off; `depth` is the depth of one of its results. Empty where nothing
/// beside it overlaps: faces flush from inside, say.
///
/// Where faces are flush, the strip that they share belongs to one body's piece or the other's, as
/// the bodies are moved, and tilts the normal if it is the wrong one. So the second body is once
/// shrunk, once grown: this moves all its faces to their backs, or to their fronts, and a strip on
/// one side does not count against one on the other. The smaller depth wins. Bodies that coincide
/// part both ways; then a mere shift has to do.
pub(crate) fn in_general_position<T>(
    pair: &Pair,
    here: &Intersection,
    counters: &mut impl Tally,
    read: impl Fn(&Pair, &Intersection) -> Vec<T>,
    depth: impl Fn(&T) -> f64,
) -> (Vec<T>, f64) {
    let rounding = pair.length_error();
    if here.generic {
        return (read(pair, here), rounding);
    }
    let scale = pair.scale();
    let step = NUDGE * scale;
    let mut beside = |offset: DVec3, bulge: f64| {
        let grown = GrownVertices::default();
        let shifted = pair.shifted(offset, bulge, &grown);
        let pairs = meeting_pairs(&shifted, counters);
        let there = intersect(&shifted, &pairs);
        let cuts_out = there.generic && !there.segments.is_empty();
        cuts_out.then(|| read(&shifted, &there))
    };
    let deepest = |found: &Vec<T>| found.iter().map(&depth).fold(0.0, f64::max);
    let found = NUDGES.into_iter().find_map(|direction| {
        let offset = direction * (step * SHARE);
        let sized = [-step, step].into_iter().filter_map(|bulge| beside(offset, bulge));
        sized.min_by(|x, y| deepest(x).total_cmp(&deepest(y)))
    });
    let found =
        found.or_else(|| NUDGES.into_iter().find_map(|direction| beside(direction * step, 0.0)));
    (found.unwrap_or_default(), rounding + BESIDE_ERROR * scale)
}

/// A contact that was read beside a special position, at the pair's own: of the same features,
/// along the same normal. One whose features meet, or do not face each other along the normal, or
/// do not overlap here, stays as it is.
pub(crate) fn settled(pair: &Pair, contact: Contact) -> Contact {
    let Contact { point_a, point_b, normal, separation, .. } = contact;
    let across = point_b - point_a - normal * separation;
    if separation == 0.0 || across.length() > pair.length_error() {
        return contact;
    }
    let line = Line { pair, normal };
    let [first, second] = Side::BOTH;
    let points = match contact.id {
        (Feature::Edge(e), Feature::Edge(g)) => line.crossing([e, g]),
        (Feature::Face(f), its) => {
            let q = line.on(second, its, point_b);
            q.and_then(|q| Some([line.meets(q, first, f)?, q]))
        }
        (own, Feature::Face(g)) => {
            let p = line.on(first, own, point_a);
            p.and_then(|p| Some([p, line.meets(p, second, g)?]))
        }
        _ => None,
    };
    let Some([point_a, point_b]) = points else { return contact };
    match normal.dot(point_b - point_a) {
        separation if separation <= pair.length_error() => {
            Contact { point_a, point_b, separation: separation.min(0.0), ..contact }
        }
        _ => contact,
    }
}

/// Lines along a contact's normal.
struct Line<'p, 'm> {
    pair: &'p Pair<'m>,
    normal: DVec3,
}

impl Line<'_, '_> {
    /// The point of a feature that was found as `p`, a nudge from here.
    fn on(&self, side: Side, feature: Feature, p: DVec3) -> Option<DVec3> {
        match feature {
            Feature::Vertex(v) => Some(self.pair.position(side, v)),
            Feature::Edge(e) => {
                let [from, to] = self.pair.segment(side, e);
                let along = to - from;
                Some(from + along * ((p - from).dot(along) / along.length_squared()))
            }
            Feature::Face(f) => self.meets(p, side, f),
        }
    }

    /// Where the line through a point meets the plane of a face.
    fn meets(&self, p: DVec3, side: Side, face: FaceId) -> Option<DVec3> {
        let outward = self.pair.normal(side, face);
        let lean = self.normal.dot(outward);
        let away = outward.dot(self.pair.triangle(side, face)[0] - p);
        (lean.abs() > STEEPEST).then(|| p + self.normal * (away / lean))
    }

    /// The points of two edges that lie on one line.
    fn crossing(&self, [e, g]: [EdgeId; 2]) -> Option<[DVec3; 2]> {
        let ends = |side: Side, edge: EdgeId| {
            let [from, to] = self.pair.segment(side, edge);
            (from, to - from)
        };
        let ((p, d), (q, f)) = (ends(Side::First, e), ends(Side::Second, g));
        let (apart, determinant) = (q - p, self.normal.dot(d.cross(f)));
        if determinant.abs() <= STEEPEST * d.length() * f.length() {
            return None;
        }
        let s = self.normal.dot(apart.cross(f)) / determinant;
        let t = self.normal.dot(apart.cross(d)) / determinant;
        Some([p + d * s, q + f * t])
    }
}
