//! The query dispatcher: Cranny's answers where our shape takes part, parry's elsewhere.
//!
//! | partner of a [`MeshShape`](crate::MeshShape) | contacts from |
//! |---|---|
//! | `MeshShape`, cuboid, convex polyhedron, triangle, triangle mesh, height field, voxels | the exact pair query |
//! | cuboid, convex polyhedron and triangle with a border radius | the same about what they are rounded from |
//! | ball, capsule | nearest features of the mesh |
//! | half-space | lowest vertices of the mesh |
//! | compound, also one that holds a `MeshShape` | each of its parts, as above |
//! | segment, cylinder, cone, the latter two with a border radius or without | where the signed distance from them is locally least on the mesh |
//! | all others: shapes of an app's own | parry, with the mesh of the same triangles: hollow |
//!
//! Intersection tests, distances, closest points, single contacts and casts are in `questions`, and
//! `compounds` takes compounds apart for them. Between polyhedra they are exact too; distances of
//! primitives and of what has a border are right to rounding. Of half-spaces and shapes of an app's
//! own parry measures how far the surfaces are; that one lies wholly inside our solid is seen here.
//! Shape casts between polyhedra, linear and nonlinear, are certified: nothing is passed through,
//! and a body that begins inside a solid meets it at once. Straight ones of round shapes are right
//! to rounding (`round_casts`), but for those that keep a distance and slide on. All others find
//! out whether they begin together, and use the parry mesh of the same triangles from there.

use std::time::{Duration, Instant};

use cranny_exact::Pose as ExactPose;
use cranny_geometry::Model;
use cranny_narrow_phase::{Approach, Demand, Query};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::details::NormalConstraints;
use rapier3d::parry::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    Unsupported,
};
use rapier3d::parry::shape::Shape;

use crate::ahead::{Motions, PairAhead};
use crate::ask::ask;
use crate::carried::{CARRIED_WITHIN, Search, Searches};
use crate::compounds::involves_ours;
use crate::convert::pose_from_rapier;
use crate::log::AnswerLog;
use crate::manifolds::{Manifold, SolverContact, rebuild};
use crate::pair::{Answered, PairWorkspace, Reach, for_parry, ours};
use crate::shape::MeshShape;

/// How far, as a multiple of the prediction distance or of what its pair moves in a step, a contact
/// may have moved and still be the same: beyond, its impulse belongs to another place.
const SAME_PLACE: f64 = 1.0;

/// Puts the detector into rapier: `NarrowPhase::with_query_dispatcher(Dispatcher::default())`.
#[derive(Clone, Debug, Default)]
pub struct Dispatcher {
    log: Option<AnswerLog>,
    motions: Motions,
    /// What was searched last, of pairs that `motions` knows.
    searches: Option<Searches>,
    /// Whether contacts are carried on.
    carries: bool,
}

/// A dispatcher without an answer log to share.
#[must_use]
pub fn dispatcher() -> Dispatcher {
    Dispatcher::default()
}

impl Dispatcher {
    /// A dispatcher that logs what it answers and how long it took.
    #[must_use]
    pub fn with_log(log: AnswerLog) -> Self {
        Self { log: Some(log), ..Self::default() }
    }

    /// The same, looking no farther ahead than bodies come nearer.
    pub(crate) fn looking_ahead(self, motions: Motions) -> Self {
        Self { motions, ..self }
    }

    /// The same, counting searches, and carrying contacts on where `carries` says so.
    pub(crate) fn carrying(self, searches: Searches, carries: bool) -> Self {
        Self { searches: Some(searches), carries, ..self }
    }
}

impl Dispatcher {
    /// Fills the manifolds of a pair in which ours takes part, and returns the time that the log's
    /// reader cost besides; `None` where parry must fill them.
    fn fill(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<Manifold>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Option<Duration> {
        let pose = pose_from_rapier(pos12);
        let ahead =
            ours(g1).zip(ours(g2)).and_then(|(s1, s2)| self.motions.between(s1.tag(), s2.tag()));
        let reach = ahead.map_or(prediction, |ahead| ahead.reach().min(prediction));
        if ahead.is_some_and(|ahead| ahead.stay_apart()) {
            manifolds.clear();
            return Some(Duration::ZERO);
        }
        let mut pair = taken(workspace, g1, g2);
        let mut request =
            PairRequest { pose, shapes: [g1, g2], reach: reach.into(), approaching: None };
        request.approaching =
            ahead.as_ref().and_then(|ahead| self.approaching(&request, ahead, &pair));
        let carried = ahead.and_then(|ahead| self.carried(&request, &ahead, &mut pair));
        let (mut contacts, answer) = match carried {
            Some(contacts) => (contacts, None),
            None => self.searched(&request, &mut pair)?,
        };
        if let Some(ahead) = &ahead {
            contacts.retain(|contact| ahead.may_close(contact));
        }
        let drift = ahead.as_ref().map_or(prediction, PairAhead::drift);
        rebuild(&contacts, &pose, SAME_PLACE * f64::from(drift), manifolds);
        let read = self.log_for_reader(&request, answer, &mut pair);
        *workspace = Some(ContactManifoldsWorkspace(pair));
        Some(read)
    }

    /// How the pair approaches, where its contacts serve this step alone: it has moved since the
    /// step before by more than they are carried on over. What moves less is searched for later
    /// steps too.
    fn approaching(
        &self,
        request: &PairRequest,
        ahead: &PairAhead,
        pair: &PairWorkspace,
    ) -> Option<(f64, Approach)> {
        let before = self.searches.as_ref()?.of_step_before(request.tags()?)?;
        let has_moved = pair.drift_since(&before, &request.pose)? > carried_within(&before, ahead);
        has_moved.then(|| ahead.approaching()).flatten()
    }

    /// The contacts of the pair's last search at its present pose, where they may be carried on.
    fn carried(
        &self,
        request: &PairRequest,
        ahead: &PairAhead,
        pair: &mut PairWorkspace,
    ) -> Option<Vec<SolverContact>> {
        let searches = self.searches.as_ref().filter(|_| self.carries)?;
        let tags = request.tags()?;
        let search =
            searches.of_step_before(tags).filter(|search| request.reach <= search.reach)?;
        let within = carried_within(&search, ahead);
        let mut contacts = pair.carried(&search, &request.pose, within)?;
        contacts.retain(|contact| contact.separation <= request.reach);
        searches.carry(tags);
        Some(contacts)
    }

    /// The contacts of the pair at its present pose, searched; `None` where parry must find them.
    fn searched(
        &self,
        request: &PairRequest,
        pair: &mut PairWorkspace,
    ) -> Option<(Vec<SolverContact>, Option<Answered>)> {
        let PairRequest { pose, shapes: [g1, g2], reach, approaching } = *request;
        let found = pair.found(&pose, g1, g2, Reach { within: reach, approaching })?;
        if let Some((searches, tags)) = self.searches.as_ref().zip(request.tags()) {
            // Of what approached, all was searched that is as near as this.
            let reach = approaching.map_or(reach, |(certain, _)| certain);
            let kept = self.carries && (approaching.is_some() || pair.keep(&found, (pose, reach)));
            let lasts = found.lasts().filter(|_| approaching.is_none());
            searches.note(tags, kept.then_some((pose, reach, lasts)));
        }
        Some((found.contacts, found.answer))
    }

    /// Logs an answer at the present pose that holds what the log's reader reads, and returns the
    /// time of request for it. A solver's answer is logged whoever reads; none is made for nobody.
    fn log_for_reader(
        &self,
        request: &PairRequest,
        answer: Option<Answered>,
        pair: &mut PairWorkspace,
    ) -> Duration {
        let (Some(log), Some(tags), Some(models)) = (&self.log, request.tags(), request.models())
        else {
            return Duration::ZERO;
        };
        let fields = log.fields(tags.0, tags.1);
        let known = log.get(tags.0, tags.1).filter(|_| answer.is_none());
        let depth = known.and_then(|known| known.depth_at_most(models, &request.pose));
        let fields = depth.map_or(fields, |at_most| fields.knowing_depth(at_most));
        let have = answer.as_ref().map_or(Demand::None, |(_, question)| question.demand);
        let (begin, question) = (Instant::now(), Query::of(fields.demand()));
        let (logged, read) = if fields.held_by(have) {
            (answer, Duration::ZERO)
        } else {
            let logged = ask(models, request.pose, &question, pair.memory());
            (logged.map(|answer| (answer, question)), begin.elapsed())
        };
        if let Some(logged) = logged {
            log.put(tags, logged, request.pose);
        }
        read
    }
}

/// The drift within which the contacts of a search are carried on.
fn carried_within(search: &Search, ahead: &PairAhead) -> f64 {
    search.lasts.unwrap_or_default().max(CARRIED_WITHIN * f64::from(ahead.base()))
}

/// A request of rapier about a pair.
struct PairRequest<'a> {
    /// Of the second shape in the first one's frame.
    pose: ExactPose,
    shapes: [&'a dyn Shape; 2],
    reach: f64,
    /// Contacts beyond the first need not be found unless this closes them.
    approaching: Option<(f64, Approach)>,
}

impl<'a> PairRequest<'a> {
    /// Of two shapes of ours.
    fn ours(&self) -> Option<[&'a MeshShape; 2]> {
        let [g1, g2] = self.shapes;
        Some([ours(g1)?, ours(g2)?])
    }

    fn tags(&self) -> Option<(u32, u32)> {
        self.ours().map(|[s1, s2]| (s1.tag(), s2.tag()))
    }

    fn models(&self) -> Option<[&'a Model; 2]> {
        self.ours().map(|shapes| shapes.map(MeshShape::model))
    }
}

/// The pair's workspace, where there is one of ours already.
fn taken(
    workspace: &mut Option<ContactManifoldsWorkspace>,
    g1: &dyn Shape,
    g2: &dyn Shape,
) -> Box<PairWorkspace> {
    match workspace.take() {
        Some(data) => match data.0.downcast() {
            Ok(own) => own,
            Err(other) => {
                *workspace = Some(ContactManifoldsWorkspace(other));
                Box::new(PairWorkspace::for_solver(g1, g2))
            }
        },
        None => Box::new(PairWorkspace::for_solver(g1, g2)),
    }
}

impl PersistentQueryDispatcher<ContactManifoldData, ContactData> for Dispatcher {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<Manifold>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let begin = Instant::now();
        let involved = involves_ours(g1) || involves_ours(g2);
        let filled =
            involved.then(|| self.fill(pos12, g1, g2, prediction, manifolds, workspace)).flatten();
        let result = if filled.is_some() {
            Ok(())
        } else {
            DefaultQueryDispatcher.contact_manifolds(
                pos12,
                for_parry(g1),
                for_parry(g2),
                prediction,
                manifolds,
                workspace,
            )
        };
        if let Some(log) = &self.log {
            let read = filled.unwrap_or_default();
            log.add_time(begin.elapsed().saturating_sub(read), read);
        }
        result
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        normal_constraints1: Option<&dyn NormalConstraints>,
        normal_constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold<ContactManifoldData, ContactData>,
    ) -> Result<(), Unsupported> {
        DefaultQueryDispatcher.contact_manifold_convex_convex(
            pos12,
            g1,
            g2,
            normal_constraints1,
            normal_constraints2,
            prediction,
            manifold,
        )
    }
}
