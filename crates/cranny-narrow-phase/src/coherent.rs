//! What a pair remembers of its last query, and how the next one uses it.
//!
//! The faces that crossed last are looked at first where a verdict is enough; the distance of those
//! that were nearest last bounds the next one; a cut of the trees is followed. And while surfaces
//! part, on a way on which the cut proves that they do not meet, what lies inside what stays.

use cranny_exact::{DVec3, Meeting, RigidMap, judge_triangles};
use cranny_geometry::FaceId;

use crate::answer::Surface;
use crate::backoff::Backoff;
use crate::closest::{Closest, NearestFaces};
use crate::containment::{Solidity, solidity};
use crate::foremost::Foremost;
use crate::motion::{Ball, RelativeMotion};
use crate::pair::{Pair, PairTag, Side};
use crate::search::{
    Ground, KeptCut, Lists, Meets, Reach, meeting_faces, near_clusters, near_in, nearest_faces,
    nearest_in,
};
use crate::surface::FacePair;
use crate::tally::Tally;

/// Crossing faces that are kept at most. More: more to look at before giving up; fewer: a search
/// whenever the last of them have parted.
const KEPT_CROSSINGS: usize = 8;

/// A cut for verdicts reaches so many steps of the motion, and one for distances so many beyond the
/// distance. Fewer: which solid lies inside which is decided anew, and small distances outgrow it;
/// more: more clusters are listed.
const STEPS: f64 = 2.0;

/// And looks so many steps farther. Fewer: what is just beyond its reach is tested in every query;
/// more: more clusters are listed.
const SPARE_STEPS: f64 = 2.0;

/// And no farther than this part of the smaller body: after a jump, the next step is none.
const MOST_AHEAD: f64 = 1.0 / 64.0;

/// A cut for distances reaches so many times the distance at least. Less: it is outgrown sooner;
/// more: more clusters are listed.
const GROWTH: f64 = 1.05;

/// After a step of more than this part of the smaller body, no cut is built for a verdict, none is
/// followed or built for distances, and a crossing is looked for before distances are measured: the
/// faces that were nearest before are anywhere now, and a cut that reaches so far lists most
/// clusters. Smaller: fast motion is not followed; larger: random poses take ten times as long with
/// memory as without (`random_poses_are_measured_without_a_cut`).
const JUMP: f64 = 0.25;

/// A cut for contacts or distances is built anew, or given up, where it reaches more than so many
/// times what it would be built for. Less: where margins change from query to query it does not
/// last; more: more clusters are listed than are near.
const WIDEST: f64 = 6.0;

/// A cut for contacts that was outgrown by what is wanted reaches so many times that. Less: margins
/// that vary outgrow it again; more: more clusters are listed.
const OUTGROWN: f64 = 2.0;

/// What is kept of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coherent {
    tag: PairTag,
    crossing: Vec<[FaceId; 2]>,
    /// Whether to look at them: in vain, where motion is so fast that none crosses for a second
    /// time.
    following: Backoff,
    /// The last crossing was searched for: motion is too fast to follow it from face to face.
    searched: bool,
    nearest: Option<[FaceId; 2]>,
    /// Surfaces have met since these were found.
    met: bool,
    /// The nearest points at this query's pose, where they gave the verdict.
    measured: Option<Option<Closest>>,
    foremost: Foremost,
    cut: KeptCut,
    /// What lies inside what, of surfaces that were apart at the last pose.
    apart: Option<Solidity>,
    /// They have not met since the pose that the cut was at before.
    stayed_apart: bool,
    /// `apart` is of this query's pose.
    is_judged: bool,
}

impl Coherent {
    /// Begins a query; forgets what was known of other models.
    pub(crate) fn begin(&mut self, pair: &Pair) {
        if !self.tag.is_of(pair) {
            *self = Self { tag: PairTag::of(pair), ..Self::default() };
        }
        self.cut.begin();
        self.is_judged = false;
        self.stayed_apart = false;
        self.measured = None;
    }

    /// Whether faces are known that crossed in the last query: looking at them comes first then.
    pub(crate) fn has_crossed(&self) -> bool {
        !self.crossing.is_empty()
    }

    /// Ends a query.
    pub(crate) fn end(&mut self, pair: &Pair) {
        self.cut.end(pair);
        // The cut may have been followed for a distance alone: the next step counts from here.
        if !self.is_judged {
            self.apart = None;
        }
    }

    /// Lets go of what is of use only while surfaces are near each other.
    pub(crate) fn let_go(&mut self) {
        if self.cut.bytes() > 0 {
            self.cut = KeptCut::default();
        }
    }

    /// The verdict on the surfaces, and what the verdict on the solids needs of the touching pairs.
    /// `below`: the distance is wanted as well, if it is less than that.
    pub(crate) fn verdict(
        &mut self,
        pair: &Pair,
        below: Option<f64>,
        counters: &mut impl Tally,
    ) -> (Surface, Vec<FacePair>) {
        let crossed = !self.crossing.is_empty();
        if self.still_cross(pair, counters) {
            return (Meeting::Cross, Vec::new());
        }
        let (surface, touching) = self.meet(pair, (Meets::UpToCrossing, below), !crossed, counters);
        self.searched = crossed;
        self.remember_crossings(&touching);
        (surface, touching)
    }

    /// Faces that meet, all or up to the first that crosses. `builds`: a cut may be built for it.
    fn meet(
        &mut self,
        pair: &Pair,
        (meets, below): (Meets, Option<f64>),
        builds: bool,
        counters: &mut impl Tally,
    ) -> (Surface, Vec<FacePair>) {
        let ground = Ground::of(pair);
        let step = self.last_step(pair);
        // Far enough for the next step to be proved free of meetings.
        let (build, spare) = ahead(pair, step);
        let reach = Reach { least: 0.0, build, outgrown: build, spare, most: f64::INFINITY };
        let is_step = step <= JUMP * smaller_radius(pair);
        match self.cut.at(pair, &ground, (reach, builds && is_step), counters) {
            Some(cut) => {
                let (surface, found, stayed_apart) =
                    near_in(cut, pair, &ground, (None, meets, step), &mut Vec::new(), counters);
                self.stayed_apart = stayed_apart;
                (surface, found)
            }
            None => {
                // Without a distance to begin with, or after a jump, a crossing is come across
                // late; and where faces crossed before, they mostly do.
                let is_followed = is_step && self.nearest.is_some();
                if let Some(below) = below.filter(|_| builds && is_followed) {
                    let mut nearest = self.seeded(pair, below, counters);
                    if !nearest_faces(&ground, (&mut nearest, true), counters) {
                        self.measured = Some(nearest.found());
                        return (Meeting::None, Vec::new());
                    }
                }
                // What was apart a step ago mostly still is, and then everything is visited: an
                // order costs more than it finds sooner.
                meeting_faces(pair, &ground, (meets, is_step && self.apart.is_some()), counters)
            }
        }
    }

    /// The nearest faces, those of the last query among them.
    fn seeded<'p, 'm>(
        &self,
        pair: &'p Pair<'m>,
        below: f64,
        counters: &mut impl Tally,
    ) -> NearestFaces<'p, 'm> {
        let mut nearest = NearestFaces::less_than(pair, below);
        if let Some([f, g]) = self.nearest {
            nearest.offer(f, g, counters);
        }
        nearest
    }

    /// Finds all faces that meet, unless `meets` is none; adds pairs of clusters to a list.
    pub(crate) fn near(
        &mut self,
        pair: &Pair,
        ground: &Ground,
        (lists, listed): (Option<Lists>, &mut Vec<[u32; 2]>),
        meets: Meets,
        counters: &mut impl Tally,
    ) -> (Surface, Vec<FacePair>) {
        let reach = lists.map_or(0.0, |lists| lists.reach);
        let step = self.last_step(pair);
        let (ahead, spare) = ahead(pair, step);
        let build = (GROWTH * reach).max(ahead);
        let most = if reach > 0.0 { WIDEST * build } else { f64::INFINITY };
        let at = Reach { least: reach, build, outgrown: OUTGROWN * build, spare, most };
        match self.cut.at(pair, ground, (at, true), counters) {
            Some(cut) => {
                let (surface, found, stayed_apart) =
                    near_in(cut, pair, ground, (lists, meets, step), listed, counters);
                if meets == Meets::All {
                    self.stayed_apart = stayed_apart;
                }
                (surface, found)
            }
            None => near_clusters::<false>(pair, ground, (lists, meets), listed, counters),
        }
    }

    /// How far the pair has moved since the last query.
    fn last_step(&self, pair: &Pair) -> f64 {
        self.cut.last().map_or(0.0, |last| step_since(last, pair))
    }

    /// All pairs of faces that meet, by ascending ids.
    pub(crate) fn meetings(&mut self, pair: &Pair, counters: &mut impl Tally) -> Vec<FacePair> {
        let (_, found) = self.meet(pair, (Meets::All, None), true, counters);
        self.remember_crossings(&found);
        found
    }

    /// What the surfaces' meeting means for the solids.
    pub(crate) fn solidity(
        &mut self,
        pair: &Pair,
        surface: Surface,
        touching: &[FacePair],
        counters: &mut impl Tally,
    ) -> Solidity {
        self.is_judged = true;
        if surface != Meeting::None {
            (self.apart, self.met) = (None, true);
            return solidity(pair, surface, touching, counters);
        }
        let found = match self.apart.filter(|_| self.stayed_apart && self.cut.was_here()) {
            Some(known) => known,
            None => solidity(pair, surface, touching, counters),
        };
        self.apart = Some(found);
        found
    }

    /// The nearest points of surfaces that do not meet, if they are less than `below` apart.
    /// `parting`: along which the hulls are apart, of no length if that is not known.
    pub(crate) fn closest(
        &mut self,
        pair: &Pair,
        below: f64,
        parting: DVec3,
        counters: &mut impl Tally,
    ) -> Option<Closest> {
        let met = std::mem::take(&mut self.met);
        if let Some(found) = self.measured {
            self.nearest = found.map(|f| f.faces).or(self.nearest);
            return found;
        }
        let mut nearest = self.seeded(pair, below, counters);
        if !self.foremost.offer(pair, parting, &mut nearest, counters) {
            let ground = Ground::of(pair);
            let limit = nearest.limit();
            let step = self.last_step(pair);
            let (ahead, spare) = ahead(pair, step);
            let build = (GROWTH * limit).max(limit + ahead);
            let reach = Reach { least: limit, build, outgrown: build, spare, most: WIDEST * build };
            // Surfaces have met since: the nearest faces known are old, and may be far apart now. A
            // cut that reaches so far lists too much.
            let builds = !met;
            let cut = match limit < f64::INFINITY && step <= JUMP * smaller_radius(pair) {
                true => self.cut.at(pair, &ground, (reach, builds), counters),
                false => None,
            };
            match cut {
                Some(cut) => nearest_in(cut, &ground, &mut nearest, counters),
                None => _ = nearest_faces(&ground, (&mut nearest, false), counters),
            }
        }
        let found = nearest.found();
        self.nearest = found.map(|f| f.faces).or(self.nearest);
        found
    }

    /// Whether faces that crossed before still do, or some beside them: a curve in which surfaces
    /// cross leaves a face for one that shares a corner with it, mostly while the other face stays.
    fn still_cross(&mut self, pair: &Pair, counters: &mut impl Tally) -> bool {
        if self.crossing.is_empty() {
            return false;
        }
        if !self.following.is_due() {
            self.crossing.clear();
            return false;
        }
        let found = self.followed_crossing(pair, counters);
        match found {
            true => self.following.succeeded(),
            false => self.following.failed(),
        }
        found
    }

    fn followed_crossing(&mut self, pair: &Pair, counters: &mut impl Tally) -> bool {
        let mut crosses = |&[f, g]: &[FaceId; 2]| {
            counters.faces([f, g]);
            let (first, second) = (pair.triangle(Side::First, f), pair.triangle(Side::Second, g));
            let (meeting, by) = judge_triangles(&first, &second);
            counters.judged(by);
            meeting == Meeting::Cross
        };
        if let Some(i) = self.crossing.iter().position(&mut crosses) {
            self.crossing.drain(..i);
            self.searched = false;
            return true;
        }
        let beside = |side: Side, face: FaceId| {
            let corners = pair.mesh(side).corners(face);
            corners.into_iter().flat_map(move |v| pair.topology(side).faces_at(v).iter().copied())
        };
        let followed = self.crossing.first().filter(|_| !self.searched);
        let found = followed.and_then(|&[f, g]| {
            let mut neighbours = beside(Side::First, f)
                .map(|f| [f, g])
                .chain(beside(Side::Second, g).map(|g| [f, g]));
            neighbours.find(&mut crosses)
        });
        self.crossing.clear();
        self.crossing.extend(found);
        found.is_some()
    }

    /// Keeps some of the crossing pairs, evenly spread.
    fn remember_crossings(&mut self, pairs: &[FacePair]) {
        let crossing = || pairs.iter().filter(|p| p.meeting == Meeting::Cross);
        let stride = crossing().count().div_ceil(KEPT_CROSSINGS).max(1);
        self.crossing.clear();
        self.crossing.extend(crossing().step_by(stride).map(|p| [p.first, p.second]));
    }

    pub(crate) fn bytes(&self) -> usize {
        self.crossing.capacity() * size_of::<[FaceId; 2]>()
            + self.foremost.bytes()
            + self.cut.bytes()
    }

    /// How many blocks of a cut are kept.
    pub(crate) fn held(&self) -> u64 {
        self.cut.held()
    }
}

/// How far any point of the second body has moved at most, seen from the first: as a cut counts.
fn step_since(last: &RigidMap, pair: &Pair) -> f64 {
    let ball = Ball::around(&pair.model(Side::Second).bounds());
    RelativeMotion::since(last, pair).map_or(0.0, |motion| motion.step_of(Side::Second, &ball))
}

/// How far a cut is to reach for the next step to be proved free of meetings, and how much farther
/// it is to look where it tests again.
fn ahead(pair: &Pair, step: f64) -> (f64, f64) {
    let most = MOST_AHEAD * smaller_radius(pair);
    let reach = (STEPS * step).min(most);
    (reach, (SPARE_STEPS * step).min(most - reach))
}

fn smaller_radius(pair: &Pair) -> f64 {
    pair.model(Side::First).radius().min(pair.model(Side::Second).radius())
}
