//! What can make a contact while bodies move little: kept for each pair of patches until motion may have used it up.
//!
//! A search of two patches finds, besides their contacts, all pairs of features that are near enough to make the
//! nearest contact, or any within the margin, once the patches have come nearer by some *slack*. As long as
//! they cannot have (`front::motion`), only those pairs are looked at, and the faces that were within the slack:
//! what was left out is farther away than what is found. Where that cannot be said, the patches are searched again.

use cranny_exact::RigidMap;
use cranny_geometry::PatchId;

use super::gather::{Asked, Gathering, Near};
use super::quest::Wanted;
use super::search::Search;
use crate::answer::{Contact, Counters};
use crate::front::motion::{Ball, Motion};
use crate::pair::{Pair, Side};
use crate::patience::Patience;
use crate::surface::FacePair;

/// For how many queries like the last one the slack is to last: at least so many, and up to [`SPREAD`] more, another
/// number for each pair of patches, so that not all are searched in one query. More: more pairs of features
/// to look at in each query; fewer: more searches.
const FEWEST: f64 = 6.0;
const SPREAD: u32 = 5;

/// The least slack, as a share of the margin: bodies at rest hardly move, and then a little more.
const LEAST: f64 = 0.125;

/// The most slack, as a share of the length of the smaller faces. Larger: so many features are near that a search leaves
/// out more of them than slack saves; smaller: what moves at a common pace is searched each time.
const MOST: f64 = 0.25;

/// A slack that lasts for fewer queries than this costs more than it saves.
const WORTH: f64 = 2.0;

/// Two patches that may be within the margin.
#[derive(Clone, Debug)]
struct Place {
    patches: [PatchId; 2],
    near: Option<Near>,
    /// Whether too much was near the last time that it was gathered, and so is not now.
    crowd: Patience,
}

/// All pairs of patches that may be within a margin while the bodies move little.
#[derive(Clone, Debug)]
struct Vicinity {
    since: RigidMap,
    slack: f64,
    /// No others were within this.
    reach: f64,
    /// By ascending names.
    places: Vec<Place>,
}

impl Vicinity {
    /// Whether no other patches can be within a margin now; given balls around the whole bodies.
    fn holds(&self, pair: &Pair, margin: f64, whole: &[Ball; 2]) -> bool {
        let moved = Step::since(&self.since, pair).of(whole);
        moved <= self.slack && margin + moved + 2.0 * pair.culling_error() <= self.reach
    }
}

/// What is kept of all pairs of patches that are near.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    vicinity: Option<Vicinity>,
    /// Where the second body was, seen from the first, when something was found.
    poses: Vec<RigidMap>,
    /// Where it was in the last query.
    last: Option<RigidMap>,
}

impl Candidates {
    pub(super) fn bytes(&self) -> usize {
        let of =
            |place: &Place| size_of::<Place>() + place.near.as_ref().map_or(0, |near| near.bytes());
        let places = self.vicinity.as_ref().map_or(&[][..], |vicinity| &vicinity.places);
        places.iter().map(of).sum::<usize>() + self.poses.capacity() * size_of::<RigidMap>()
    }

    /// Tells the contacts of each pair of patches within the margin, by ascending names; those that are not known
    /// `searched` tells, given how far apart at most they are. Faces that meet go to `meeting`.
    pub(super) fn each(
        &mut self,
        search: &mut Search,
        (margin, meets): (f64, bool),
        wanted: impl Fn([PatchId; 2]) -> Wanted,
        meeting: &mut Vec<FacePair>,
        counters: &mut Counters,
        mut searched: impl FnMut(
            &mut Search,
            [PatchId; 2],
            Asked,
            &mut Vec<FacePair>,
            &mut Counters,
        ) -> Vec<Contact>,
        mut told: impl FnMut([PatchId; 2], Vec<Contact>),
    ) {
        let pair = search.pair();
        let step = self.last.replace(pair.first_from_second).map(|pose| Step::since(&pose, pair));
        let mut vicinity = self.vicinity(search, margin, step.as_ref(), counters);
        let steps: Vec<Step> = self.poses.iter().map(|pose| Step::since(pose, pair)).collect();
        let mut is_new = false;
        for place in &mut vicinity.places {
            let patches = place.patches;
            let asked = Asked { wanted: wanted(patches), margin, meeting: meets };
            let balls = balls(pair, patches);
            if let Some(near) = &place.near {
                let moved = steps[near.since as usize].of(&balls);
                if let Some(found) = near.found(search.ground(), asked, moved, meeting, counters) {
                    told(patches, found);
                    continue;
                }
            }
            place.near = None;
            if !search.may_be_within(patches, margin, counters) {
                continue;
            }
            let step = step.as_ref().map(|step| step.of(&balls));
            let slack = step.and_then(|step| slack(pair, patches, step, margin));
            let Some(slack) = slack.filter(|_| place.crowd.is_over()) else {
                told(patches, searched(search, patches, asked, meeting, counters));
                continue;
            };
            let mut gathering = Gathering::new(asked, slack);
            search.look(patches, &mut gathering, counters);
            let (near, found) = gathering.end(steps.len() as u32, pair, meeting, counters);
            match near {
                Some(_) => place.crowd.succeeded(),
                None => place.crowd.failed(),
            }
            is_new |= near.is_some();
            place.near = near;
            told(patches, found);
        }
        if is_new {
            self.poses.push(pair.first_from_second);
        }
        self.forget_poses(&mut vicinity.places);
        self.vicinity = Some(vicinity);
    }

    /// The pairs of patches that may be within the margin.
    fn vicinity(
        &mut self,
        search: &Search,
        margin: f64,
        step: Option<&Step>,
        counters: &mut Counters,
    ) -> Vicinity {
        let pair = search.pair();
        let whole = Side::BOTH.map(|side| Ball::around(&pair.model(side).bounds()));
        let mut before = match self.vicinity.take() {
            Some(vicinity) if vicinity.holds(pair, margin, &whole) => return vicinity,
            known => known.map_or_else(Vec::new, |vicinity| vicinity.places),
        }
        .into_iter()
        .peekable();
        let lasting = |step: &Step| lasting(step.of(&whole), FEWEST, margin, patch_size(pair));
        let slack = step.and_then(lasting).unwrap_or(0.0);
        let reach = margin + slack;
        let mut names = search.near_patches(reach, counters);
        names.sort_unstable();
        let place = |patches| {
            while before.next_if(|place| place.patches < patches).is_some() {}
            let known = before.next_if(|place| place.patches == patches);
            known.unwrap_or(Place { patches, near: None, crowd: Patience::default() })
        };
        let places = names.into_iter().map(place).collect();
        Vicinity { since: pair.first_from_second, slack, reach, places }
    }

    /// Numbers poses anew now and then, since nothing may be left of some.
    fn forget_poses(&mut self, places: &mut [Place]) {
        if self.poses.len() <= 2 * (FEWEST as usize + SPREAD as usize) {
            return;
        }
        let old = std::mem::take(&mut self.poses);
        let mut names = vec![None; old.len()];
        for near in places.iter_mut().filter_map(|place| place.near.as_mut()) {
            near.since = *names[near.since as usize].get_or_insert_with(|| {
                self.poses.push(old[near.since as usize]);
                self.poses.len() as u32 - 1
            });
        }
    }
}

/// How bodies moved since some pose; not at all where there is no motion.
struct Step(Option<Motion>);

impl Step {
    fn since(pose: &RigidMap, pair: &Pair) -> Self {
        Self(Motion::since(pose, pair))
    }

    /// By how much what lies within two balls may have come nearer.
    fn of(&self, balls: &[Ball; 2]) -> f64 {
        self.0.as_ref().map_or(0.0, |motion| motion.step(balls))
    }
}

fn balls(pair: &Pair, patches: [PatchId; 2]) -> [Ball; 2] {
    Side::BOTH.map(|side| {
        let patch = pair.model(side).patches().patch(patches[side.index()]);
        Ball { center: patch.center, radius: patch.radius }
    })
}

/// A length of the smaller patches of two bodies.
fn patch_size(pair: &Pair) -> f64 {
    let of = |side| {
        let patches = pair.model(side).patches().patches();
        (patches.iter().map(|patch| patch.area).sum::<f64>() / patches.len() as f64).sqrt()
    };
    of(Side::First).min(of(Side::Second))
}

/// By how much two patches may come nearer before they are searched again, given by how much they may have since the
/// last query; `None` where that would not last.
fn slack(pair: &Pair, patches: [PatchId; 2], step: f64, margin: f64) -> Option<f64> {
    let [a, b] = patches.map(|patch| patch.0);
    let queries = FEWEST + f64::from(a.wrapping_mul(3).wrapping_add(b) % SPREAD);
    let length = Side::BOTH.map(|side| {
        let (all, patch) = (pair.model(side).patches(), patches[side.index()]);
        (2.0 * all.patch(patch).area / all.faces(patch).len() as f64).sqrt()
    });
    lasting(step, queries, margin, length[0].min(length[1])).filter(|&slack| slack > 0.0)
}

/// What lasts for so many queries like the last, by which things may have come nearer by `step`, among faces or patches of some
/// length; `None` where that is not worth it.
fn lasting(step: f64, queries: f64, margin: f64, length: f64) -> Option<f64> {
    let slack = (queries * step).max(LEAST * margin).min(MOST * length);
    (slack >= WORTH * step).then_some(slack)
}
