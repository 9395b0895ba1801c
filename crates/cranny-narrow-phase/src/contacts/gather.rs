//! What can make a contact of two patches once they have come nearer by a slack, and how it is found.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId, VertexId};

use super::facet::extent;
use super::gauss_map::Touch;
use super::quest::{Found, Ground, Quest, Tip, Wanted};
use crate::answer::{Contact, Counters};
use crate::pair::{Pair, Side};
use crate::surface::{FacePair, looked_at};
use crate::triangle_distance::{closest_on_segments, closest_on_triangle};

/// More features and faces than this take as long to look at as a search for the nearest. Larger: on a thread that is the more work the
/// slower it turns; smaller: of finely meshed bodies that hardly move little is kept.
const CROWD: usize = 20;

/// More than this are not kept where all contacts are wanted, which a search measures all the same. Larger: memory of wide
/// margins grows without a bound; smaller: coarse patches that rest on each other are searched each time.
const ALL: usize = 512;

/// What is wanted of two patches.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    pub(super) wanted: Wanted,
    pub(super) margin: f64,
    /// Whether faces that meet are to be told.
    pub(super) meeting: bool,
}

/// Two features that may make a contact.
#[derive(Clone, Copy, Debug)]
enum Features {
    /// A corner of a side before a face of the other, or beside it.
    Corner(Side, VertexId, FaceId),
    Edges([EdgeId; 2]),
}

/// What may come to matter of two patches.
#[derive(Clone, Debug)]
pub(super) struct Near {
    /// Number of the pose at which it was found.
    pub(super) since: u32,
    slack: f64,
    /// No other features were nearer than this.
    beyond: f64,
    /// Nearest first.
    features: Vec<Features>,
    /// All that were within the slack, in ascending order of a lower bound of their gap; `None` if not asked for.
    faces: Option<Vec<(f64, [FaceId; 2])>>,
}

impl Near {
    pub(super) fn bytes(&self) -> usize {
        self.features.capacity() * size_of::<Features>()
            + self.faces.as_ref().map_or(0, Vec::capacity) * size_of::<(f64, [FaceId; 2])>()
    }

    /// The contacts of two patches that have come nearer by at most `moved`; `None` where others may matter, too.
    pub(super) fn found(
        &self,
        ground: Ground,
        asked: Asked,
        moved: f64,
        meeting: &mut Vec<FacePair>,
        counters: &mut Counters,
    ) -> Option<Vec<Contact>> {
        let (pair, Asked { wanted, margin, .. }) = (ground.pair, asked);
        let beyond = self.beyond - moved - 2.0 * pair.culling_error();
        if moved > self.slack
            || (wanted == Wanted::All && margin > beyond)
            || (asked.meeting && self.faces.is_none())
        {
            return None;
        }
        let mut found = Found::new(margin, wanted);
        for features in &self.features {
            counters.triangle_tests += 1;
            match *features {
                Features::Corner(side, vertex, face) => {
                    let tip = Tip { side, vertex, at: pair.position(side, vertex) };
                    found.corner(ground, tip, (face, &pair.triangle(side.other(), face)));
                }
                Features::Edges([e, g]) => {
                    let segments = [pair.segment(Side::First, e), pair.segment(Side::Second, g)];
                    found.edges(pair, [e, g], segments, Touch::Perhaps);
                }
            }
        }
        if found.limit > beyond {
            return None;
        }
        self.meet(pair, moved, meeting, counters);
        Some(found.contacts)
    }

    /// Adds the faces that meet, after patches have come nearer by at most `moved`.
    fn meet(&self, pair: &Pair, moved: f64, meeting: &mut Vec<FacePair>, counters: &mut Counters) {
        let reach = moved + 2.0 * pair.culling_error();
        for &(gap, [f, g]) in self.faces.iter().flatten() {
            if gap > reach {
                break;
            }
            meeting.extend(looked_at(pair, f, g, counters));
        }
    }
}

/// A lower bound of the gap between two triangles, but for rounding: by the plane of either, the points of the other.
fn gap([a, b]: [&[DVec3; 3]; 2]) -> f64 {
    let over = |own: &[DVec3; 3], its: &[DVec3; 3]| {
        let normal = (own[1] - own[0]).cross(own[2] - own[0]).normalize_or_zero();
        let ([bottom, top], [low, high]) = (extent(own, normal), extent(its, normal));
        (low - top).max(bottom - high)
    };
    over(a, b).max(over(b, a)).max(0.0)
}

/// Contacts, and what may make one soon.
pub(super) struct Gathering {
    found: Found,
    asked: Asked,
    slack: f64,
    /// How far apart they are.
    features: Vec<(f64, Features)>,
    faces: Vec<(f64, [FaceId; 2])>,
    /// More is near than is worth keeping: only contacts are looked for from there on.
    is_crowded: bool,
}

impl Gathering {
    pub(super) fn new(asked: Asked, slack: f64) -> Self {
        Self {
            found: Found::new(asked.margin, asked.wanted),
            asked,
            slack,
            features: Vec::new(),
            faces: Vec::new(),
            is_crowded: false,
        }
    }

    /// What is near, unless that is too much, and the contacts; faces that meet go to `meeting`.
    pub(super) fn end(
        self,
        since: u32,
        pair: &Pair,
        meeting: &mut Vec<FacePair>,
        counters: &mut Counters,
    ) -> (Option<Near>, Vec<Contact>) {
        let beyond = self.limit();
        let Self { found, asked, slack, mut features, mut faces, is_crowded } = self;
        let reach = beyond + pair.culling_error();
        features.retain(|(apart, _)| *apart <= reach);
        features.sort_by(|x, y| x.0.total_cmp(&y.0));
        let features = features.into_iter().map(|(_, features)| features).collect();
        faces.sort_by(|x, y| x.0.total_cmp(&y.0));
        let faces = asked.meeting.then_some(faces);
        let near = Near { since, slack, beyond, features, faces };
        near.meet(pair, 0.0, meeting, counters);
        ((!is_crowded).then_some(near), found.contacts)
    }

    /// Notes how much is near.
    fn count(&mut self) {
        let all = self.features.len() + self.faces.len();
        self.is_crowded |= match self.asked.wanted {
            Wanted::Nearest => all > CROWD,
            Wanted::All => all > ALL,
        };
    }

    fn add(&mut self, apart: f64, features: Features, pair: &Pair) {
        if !self.is_crowded && apart <= self.limit() + pair.culling_error() {
            self.features.push((apart, features));
            self.count();
        }
    }
}

impl Quest for Gathering {
    /// What is nearest now has come nearer, or gone, by the slack; so may what is nearest then.
    fn limit(&self) -> f64 {
        match self.found.wanted {
            _ if self.is_crowded => self.found.limit,
            Wanted::All => self.asked.margin + self.slack,
            Wanted::Nearest => {
                (self.found.limit + 2.0 * self.slack).min(self.asked.margin + self.slack)
            }
        }
    }

    fn closeness(&self) -> Option<f64> {
        let slack = if self.is_crowded { 0.0 } else { self.slack };
        self.asked.meeting.then_some(slack)
    }

    fn is_for_now(&self) -> bool {
        self.is_crowded
    }

    fn wants_features(&self) -> bool {
        true
    }

    fn faces(&mut self, faces: [FaceId; 2], triangles: [&[DVec3; 3]; 2], _: &mut Counters) {
        self.faces.push((gap(triangles), faces));
        self.count();
    }

    fn corner(
        &mut self,
        ground: Ground,
        tip: Tip,
        (face, corners): (FaceId, &[DVec3; 3]),
        counters: &mut Counters,
    ) {
        counters.triangle_tests += 1;
        let apart = (tip.at - closest_on_triangle(tip.at, corners).0).length();
        self.add(apart, Features::Corner(tip.side, tip.vertex, face), ground.pair);
        self.found.corner(ground, tip, (face, corners));
    }

    fn edges(
        &mut self,
        ground: Ground,
        edges: [EdgeId; 2],
        segments: [[DVec3; 2]; 2],
        touch: Touch,
        counters: &mut Counters,
    ) {
        counters.triangle_tests += 1;
        let [p, q] = segments;
        let (s, t) = closest_on_segments(&p, &q);
        let [on_first, on_second] = [p[0] + (p[1] - p[0]) * s, q[0] + (q[1] - q[0]) * t];
        self.add((on_second - on_first).length(), Features::Edges(edges), ground.pair);
        self.found.edges(ground.pair, edges, segments, touch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::PosedVertices;
    use crate::query::Placed;
    use cranny_exact::Pose;
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cuboid, Shape};

    /// What was gathered answers as long as patches cannot have come nearer than it was gathered for.
    #[test]
    fn what_was_gathered_answers_within_its_slack_and_margin() {
        let mesh = Shape::from(Cuboid::default()).build().unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let at = |x| Placed { model: &model, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
        let mut posed = PosedVertices::default();
        let pair = Pair::new(at(0.0), at(9.0), &mut posed);
        let owned = Default::default();
        let answers = |near: &Near, asked: Asked, moved: f64| {
            let ground = Ground { pair: &pair, owned: &owned };
            let counters = &mut Counters::default();
            near.found(ground, asked, moved, &mut Vec::new(), counters).is_some()
        };
        let near = Near {
            since: 0,
            slack: 0.25,
            beyond: 1.0,
            features: Vec::new(),
            faces: Some(Vec::new()),
        };
        for wanted in [Wanted::Nearest, Wanted::All] {
            let asked = |margin| Asked { wanted, margin, meeting: true };
            assert!(answers(&near, asked(0.5), 0.25) && !answers(&near, asked(0.5), 0.26));
            assert!(answers(&near, asked(0.8), 0.19) && !answers(&near, asked(0.8), 0.21));
            // Of faces it says nothing where it was not asked.
            let features = Near { faces: None, ..near.clone() };
            assert!(!answers(&features, asked(0.5), 0.0));
            assert!(answers(&features, Asked { meeting: false, ..asked(0.5) }, 0.0));
        }
    }

    #[test]
    fn planes_bound_the_gap_between_triangles() {
        let floor = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let over = floor.map(|p| p + DVec3::new(5.0, 0.0, 0.25));
        assert_eq!(gap([&floor, &over]), 0.25);
        assert_eq!(gap([&over, &floor]), 0.25);
        // Beneath counts, too; beside says nothing, nor do needles.
        let under = floor.map(|p| p - DVec3::Z);
        assert_eq!(gap([&floor, &under]), 1.0);
        assert_eq!(gap([&floor, &floor.map(|p| p + 3.0 * DVec3::X)]), 0.0);
        assert_eq!(gap([&[DVec3::ZERO; 3], &[DVec3::Z; 3]]), 0.0);
    }
}
