//! What can make a contact while bodies move little: kept for each pair of patches until motion may have used it up.
//!
//! A search of two patches finds, besides their contacts, all pairs of features that are near enough to make the
//! nearest contact, or any within the margin, once the patches have come nearer by some *slack*. As long as
//! they cannot have (`motion`), only those pairs are looked at, and the faces that were within the slack:
//! what was left out is farther away than what is found. Where that cannot be said, the patches are searched again.

use cranny_exact::RigidMap;
use cranny_geometry::PatchId;

use super::cut::Cut;
use super::feature_pair::across_gap;
use super::gather::{Asked, Gathering, Near};
use super::quest::{Found, Looking, Wanted};
use super::search::Search;
use crate::answer::{Contact, Counters, Feature};
use crate::motion::{Ball, Motion};
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

/// How far patches may come nearer, in radii of theirs, before a cut of them is made anew. Smaller: small patches are searched from
/// the top; larger: what motion adds up to is rounded by more than each step's own allowance, some hundred half ulps.
const FARTHEST: f64 = 64.0;

/// Two patches that may be within the margin.
#[derive(Clone, Debug)]
struct Place {
    patches: [PatchId; 2],
    near: Option<Near>,
    /// Whether too much was near the last time that it was gathered, and so is not now.
    crowd: Patience,
    /// Whose contact was nearest in the last query.
    nearest: Option<(Feature, Feature)>,
    /// Where the last search ended.
    cut: Cut,
}

impl Place {
    fn new(patches: [PatchId; 2]) -> Self {
        let crowd = Patience::default();
        Self { patches, near: None, crowd, nearest: None, cut: Cut::default() }
    }

    /// The contacts, by a search that a contact bounds whose features were nearest last; it begins where the last one ended
    /// if bodies `move`, so that there will be a next one.
    fn searched(
        &mut self,
        search: &mut Search,
        Asked { wanted, margin, meeting: meets }: Asked,
        moves: bool,
        meeting: &mut Vec<FacePair>,
        counters: &mut Counters,
    ) -> Vec<Contact> {
        let (pair, patches) = (search.pair(), self.patches);
        let mut look = |limit: f64| {
            let found = Some(Found::new(limit, wanted));
            let mut looking = Looking { found, meets, meeting: std::mem::take(meeting) };
            if moves {
                search.look_on(patches, &mut self.cut, &mut looking, counters);
            } else {
                search.look(patches, &mut looking, counters);
            }
            *meeting = looking.meeting;
            looking.found.map_or_else(Vec::new, |found| found.contacts)
        };
        let known = self.nearest.filter(|_| wanted == Wanted::Nearest);
        let bound = known.and_then(|id| across_gap(pair, id, margin));
        let found = bound.map_or_else(Vec::new, |contact| look(contact.separation.max(0.0)));
        // What memory names may be seen from no face of its patch, by rounding.
        if found.is_empty() { look(margin) } else { found }
    }
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
        let of = |place: &Place| {
            size_of::<Place>()
                + place.cut.bytes()
                + place.near.as_ref().map_or(0, |near| near.bytes())
        };
        let places = self.vicinity.as_ref().map_or(&[][..], |vicinity| &vicinity.places);
        places.iter().map(of).sum::<usize>() + self.poses.capacity() * size_of::<RigidMap>()
    }

    /// Tells the contacts of each pair of patches within the margin, by ascending names. Faces that meet go to `meeting`.
    pub(super) fn each(
        &mut self,
        search: &mut Search,
        (margin, meets): (f64, bool),
        wanted: impl Fn([PatchId; 2]) -> Wanted,
        meeting: &mut Vec<FacePair>,
        counters: &mut Counters,
        mut told: impl FnMut([PatchId; 2], Vec<Contact>),
    ) {
        let pair = search.pair();
        let step = self.last.replace(pair.first_from_second).map(|pose| Step::since(&pose, pair));
        let mut vicinity = self.vicinity(search, margin, step.as_ref(), counters);
        let steps: Vec<Step> = self.poses.iter().map(|pose| Step::since(pose, pair)).collect();
        let mut tell = |place: &mut Place, found: Vec<Contact>| {
            place.nearest = found.first().map(|contact| contact.id);
            told(place.patches, found);
        };
        let mut is_new = false;
        for place in &mut vicinity.places {
            let patches = place.patches;
            let asked = Asked { wanted: wanted(patches), margin, meeting: meets };
            let balls = balls(pair, patches);
            if let Some(near) = &place.near {
                let moved = steps[near.since as usize].of(&balls);
                if let Some(found) = near.found(search.ground(), asked, moved, meeting, counters) {
                    tell(place, found);
                    continue;
                }
            }
            place.near = None;
            let step = step.as_ref().map(|step| step.of(&balls));
            place.cut.moved(step.unwrap_or(0.0), FARTHEST * (balls[0].radius + balls[1].radius));
            if !search.may_be_within(patches, margin, counters) {
                continue;
            }
            let slack = step.and_then(|step| slack(pair, patches, step, margin));
            let Some(slack) = slack.filter(|_| place.crowd.is_over()) else {
                let found = place.searched(search, asked, step.is_some(), meeting, counters);
                tell(place, found);
                continue;
            };
            place.cut = Cut::default();
            let mut gathering = Gathering::new(asked, slack);
            search.look(patches, &mut gathering, counters);
            let (near, found) = gathering.end(steps.len() as u32, pair, meeting, counters);
            match near {
                Some(_) => place.crowd.succeeded(),
                None => place.crowd.failed(),
            }
            is_new |= near.is_some();
            place.near = near;
            tell(place, found);
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
            known.unwrap_or_else(|| Place::new(patches))
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

#[cfg(test)]
mod tests {
    use super::super::{ContactMemory, near_patches};
    use super::*;
    use crate::pair::PosedVertices;
    use crate::query::Placed;
    use cranny_exact::{DQuat, DVec3, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cup, IsoBolt, IsoNut, Shape, Torus};
    use cranny_testkit::Rng;

    fn model(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    /// Whatever way bodies go, by small steps and large ones, back and forth, with rests: what is told on from where searches ended
    /// is what is told without memory. Of a few thousand ends that were left alone or tried by one axis, some would not be apart.
    #[test]
    fn searches_that_go_on_tell_what_new_ones_do() {
        let ring = || Torus { major_segments: 24, minor_segments: 12, ..Torus::default() };
        let bolt = IsoBolt { segments: 24, ..IsoBolt::default() };
        let nut = IsoNut { segments: 24, ..IsoNut::default() };
        let cup = || Cup { segments: 24, ..Cup::default() };
        let along = |z: f64| DVec3::new(0.0, 0.0, z);
        // Two bodies, where the second is at first, the margin, and how far it goes and turns in a step at most.
        let scenes = [
            (model(bolt), model(nut), along(12.0), 0.2, 0.1, 0.05),
            (model(ring()), model(ring()), DVec3::new(1.8, 0.3, 0.2), 0.1, 0.1, 0.1),
            (
                model(cup()),
                model(Torus { major_radius: 0.2, minor_radius: 0.1, ..ring() }),
                along(0.5),
                0.1,
                0.1,
                0.2,
            ),
        ];
        let mut rng = Rng::new(17);
        for (number, (a, b, start, margin, shift, turn)) in scenes.iter().enumerate() {
            let mut memory = ContactMemory::default();
            let (mut at, mut rotation) = (*start, DQuat::IDENTITY);
            let (mut ends, mut told) = (0, 0);
            for frame in 0..40 {
                // From a thousandth of the largest step up to that; every fifth time nothing moves.
                let size = if frame % 5 == 4 { 0.0 } else { 0.1f64.powi(rng.below(4) as i32) };
                let mut some = |size: f64| size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
                at = *start + 0.9 * (at - *start) + some(size * shift);
                rotation = (DQuat::from_scaled_axis(some(size * turn)) * rotation).normalize();
                let place = |model, translation, rotation| Placed {
                    model,
                    pose: Pose { rotation, translation },
                };
                let (first, second) =
                    (place(a, DVec3::ZERO, DQuat::IDENTITY), place(b, at, rotation));
                let mut posed = PosedVertices::default();
                let pair = Pair::new(first, second, &mut posed);
                let counters = &mut Counters::default();
                let warm = near_patches(&pair, *margin, &mut memory, counters);
                let cold = near_patches(&pair, *margin, &mut ContactMemory::default(), counters);
                assert!(warm.meeting == cold.meeting, "scene {number}, frame {frame}");
                assert!(warm.contacts == cold.contacts, "scene {number}, frame {frame}");
                let places = &memory.candidates.vicinity.as_ref().unwrap().places;
                ends += places.iter().map(|place| place.cut.ends().len()).sum::<usize>();
                told += warm.contacts.len();
            }
            assert!(ends > 1_000 && told > 40, "scene {number}: {ends} ends, {told} contacts");
        }
    }
}
