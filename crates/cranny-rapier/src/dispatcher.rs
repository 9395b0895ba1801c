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
//! Intersection tests, distances, closest points and single contacts between polyhedra are exact too, and to rounding
//! those of what is round or has a border. Of half-spaces and shapes of an app's own parry tells how far the surfaces are; that
//! one lies wholly inside our solid is seen here. Of compounds each part is asked about.
//! Shape casts between polyhedra, linear and nonlinear, are certified: nothing is passed through, and a body inside a
//! solid is told so. Those of other partners, and those that are to stop at a distance, use the parry mesh of the same
//! triangles.

use std::time::{Duration, Instant};

use cranny_exact::{Pose as ExactPose, RigidMap};
use cranny_geometry::Model;
use cranny_narrow_phase::{Approach, Demand, PairMemory, Query};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{
    self, NonlinearRigidMotion, NormalConstraints, ShapeCastOptions,
};
use rapier3d::parry::query::{
    ClosestPoints, Contact as ParryContact, ContactManifold, ContactManifoldsWorkspace,
    DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit,
    ShapeDistance, ShapeIntersection, Unsupported,
};
use rapier3d::parry::shape::{Compound, Shape};

use crate::ahead::{Motions, PairAhead};
use crate::apart::{Apart, apart};
use crate::ask::ask;
use crate::carried::{CARRIED_WITHIN, Searches};
use crate::casts::{AtOnce, Cast};
use crate::convert::{narrow, pose_from_rapier, wide};
use crate::log::AnswerLog;
use crate::manifolds::{Manifold, SolverContact, rebuild};
use crate::pair::{Answered, PairWorkspace, Reach, for_parry, involves_ours, ours};
use crate::partners::{holds, polyhedron, revolved, rounded_polyhedron};
use crate::shape::MeshShape;

/// How far, as a multiple of the prediction distance or of what its pair moves in a step, a contact may have moved
/// and still be the same: beyond, its impulse belongs to another place.
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
    /// A dispatcher that tells a log what it answers and how long it took.
    #[must_use]
    pub fn with_log(log: AnswerLog) -> Self {
        Self { log: Some(log), ..Self::default() }
    }

    /// The same, looking no farther ahead than bodies come nearer.
    pub(crate) fn looking_ahead(self, motions: Motions) -> Self {
        Self { motions, ..self }
    }

    /// The same, counting searches, and carrying contacts on if asked.
    pub(crate) fn carrying(self, searches: Searches, carries: bool) -> Self {
        Self { searches: Some(searches), carries, ..self }
    }
}

/// The models of two shapes that are polyhedra, one of them ours.
fn models(g1: &dyn Shape, g2: &dyn Shape) -> Option<[Model; 2]> {
    if ours(g1).is_none() && ours(g2).is_none() {
        return None;
    }
    let model = |g: &dyn Shape| ours(g).map(|s| s.model().clone()).or_else(|| polyhedron(g));
    Some([model(g1)?, model(g2)?])
}

/// Whether a pair, of which one shape is ours, is one that [`apart`] answers about: but where the pose is none.
fn is_known(g1: &dyn Shape, g2: &dyn Shape) -> bool {
    let known = |g: &dyn Shape| {
        ours(g).is_some()
            || revolved(g, &RigidMap::IDENTITY).is_some()
            || rounded_polyhedron(g).is_some()
    };
    (ours(g1).is_some() || ours(g2).is_some()) && known(g1) && known(g2)
}

/// Whether a shape that is no polyhedron lies inside the other one, ours, given that the surfaces
/// do not meet.
fn encloses(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> bool {
    match (ours(g1), ours(g2)) {
        (Some(shape), None) => holds_partner(shape.model(), pos12, g2),
        (None, Some(shape)) => holds_partner(shape.model(), &pos12.inverse(), g1),
        _ => false,
    }
}

/// One point of a connected shape decides for all of it.
fn holds_partner(model: &Model, model_from_partner: &Pose, partner: &dyn Shape) -> bool {
    if partner.as_support_map().is_none() {
        return false; // a half-space or a surface: nothing encloses it
    }
    let middle = partner.compute_local_aabb().center();
    let point = partner.project_local_point(middle, true).point;
    holds(model, pose_from_rapier(model_from_partner).world_from_body().apply(wide(point)))
}

/// A pair of which one side is a compound and ours takes part: parry goes through the parts and asks us about
/// each.
enum Composite<'a> {
    First(&'a Compound),
    Second(&'a Compound),
}

impl<'a> Composite<'a> {
    fn of(g1: &'a dyn Shape, g2: &'a dyn Shape) -> Option<Self> {
        let first = g1.as_compound().map(Self::First);
        let found = first.or_else(|| g2.as_compound().map(Self::Second))?;
        (involves_ours(g1) || involves_ours(g2)).then_some(found)
    }
}

impl Dispatcher {
    /// Where bodies meet that a cast finds together at its beginning.
    fn touching(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        cast: &Cast,
    ) -> Option<ParryContact> {
        self.contact(pos12, g1, g2, cast.tolerance() as Real).ok().flatten()
    }

    /// Fills the manifolds of a pair in which ours takes part, and returns the time that the log's reader
    /// cost besides; `None` where parry must fill them.
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
        let approaching = ahead.as_ref().and_then(PairAhead::approaching);
        let asked = Asked { pose, shapes: [g1, g2], reach: reach.into(), approaching };
        let carried = ahead.and_then(|ahead| self.carried(&asked, &ahead, &mut pair));
        let (mut contacts, answer) = match carried {
            Some(contacts) => (contacts, None),
            None => self.searched(&asked, &mut pair)?,
        };
        if let Some(ahead) = &ahead {
            contacts.retain(|contact| ahead.may_close(contact));
        }
        let drift = ahead.as_ref().map_or(prediction, PairAhead::drift);
        rebuild(&contacts, &pose, SAME_PLACE * f64::from(drift), manifolds);
        let read = self.told_to_reader(&asked, answer, &mut pair);
        *workspace = Some(ContactManifoldsWorkspace::from(*pair));
        Some(read)
    }

    /// The contacts of the pair's last search at its present pose, where they may be carried on.
    fn carried(
        &self,
        asked: &Asked,
        ahead: &PairAhead,
        pair: &mut PairWorkspace,
    ) -> Option<Vec<SolverContact>> {
        let searches = self.searches.as_ref().filter(|_| self.carries)?;
        let tags = asked.tags()?;
        let search = searches.of_step_before(tags).filter(|search| asked.reach <= search.reach)?;
        let within = CARRIED_WITHIN * f64::from(ahead.base());
        let mut contacts = pair.carried(&search, &asked.pose, within)?;
        contacts.retain(|contact| contact.separation <= asked.reach);
        searches.carry(tags);
        Some(contacts)
    }

    /// The contacts of the pair at its present pose, searched; `None` where parry must tell them.
    fn searched(
        &self,
        asked: &Asked,
        pair: &mut PairWorkspace,
    ) -> Option<(Vec<SolverContact>, Option<Answered>)> {
        let Asked { pose, shapes: [g1, g2], reach, approaching } = *asked;
        let found = pair.found(&pose, g1, g2, Reach { within: reach, approaching })?;
        if let Some((searches, tags)) = self.searches.as_ref().zip(asked.tags()) {
            let search = (pose, reach);
            let kept = self.carries && approaching.is_none() && pair.keep(&found, search);
            searches.note(tags, kept.then_some(search));
        }
        Some((found.contacts, found.answer))
    }

    /// Logs an answer at the present pose that holds what the log's reader reads, and returns the time of
    /// asking for it. A solver's answer is logged whoever reads; none is made for nobody.
    fn told_to_reader(
        &self,
        asked: &Asked,
        answer: Option<Answered>,
        pair: &mut PairWorkspace,
    ) -> Duration {
        let (Some(log), Some(tags), Some(models)) = (&self.log, asked.tags(), asked.models())
        else {
            return Duration::ZERO;
        };
        let fields = log.fields(tags.0, tags.1);
        let have = answer.as_ref().map_or(Demand::None, |(_, question)| question.demand);
        let (begin, question) = (Instant::now(), Query::of(fields.demand()));
        let (told, read) = if fields.told_by(have) {
            (answer, Duration::ZERO)
        } else {
            let told = ask(models, asked.pose, &question, pair.memory());
            (told.map(|answer| (answer, question)), begin.elapsed())
        };
        if let Some(told) = told {
            log.put(tags, told, asked.pose);
        }
        read
    }
}

/// A question of rapier's about a pair.
struct Asked<'a> {
    /// Of the second shape in the first one's frame.
    pose: ExactPose,
    shapes: [&'a dyn Shape; 2],
    reach: f64,
    /// Contacts beyond the first need not be found unless this closes them.
    approaching: Option<(f64, Approach)>,
}

impl<'a> Asked<'a> {
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

impl QueryDispatcher for Dispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                return Ok(details::intersection_test_composite_shape_shape(self, pos12, c1, g2));
            }
            Some(Composite::Second(c2)) => {
                return Ok(details::intersection_test_shape_composite_shape(self, pos12, g1, c2));
            }
            None => {}
        }
        let models = models(g1, g2);
        if models.is_none()
            && let Some(told) = apart(&pose_from_rapier(pos12), g1, g2, 0.0)
        {
            return Ok(ShapeIntersection::new(matches!(told, Apart::Meeting)));
        }
        let parry = DefaultQueryDispatcher.intersection_test(pos12, for_parry(g1), for_parry(g2));
        let Some([m1, m2]) = models else {
            let parry = parry?;
            let intersecting = parry.intersecting || encloses(pos12, g1, g2);
            return Ok(ShapeIntersection { intersecting, ..parry });
        };
        let pose = pose_from_rapier(pos12);
        let answer =
            ask([&m1, &m2], pose, &Query::of(Demand::Intersects), &mut PairMemory::default())
                .ok_or(Unsupported)?;
        let intersecting = answer.solid || answer.surface.meets();
        // parry knows which of a composite's parts it is; the verdict is ours.
        Ok(ShapeIntersection {
            intersecting,
            ..parry.unwrap_or_else(|_| ShapeIntersection::new(intersecting))
        })
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                return Ok(details::distance_composite_shape_shape(self, pos12, c1, g2));
            }
            Some(Composite::Second(c2)) => {
                return Ok(details::distance_shape_composite_shape(self, pos12, g1, c2));
            }
            None => {}
        }
        let distance = match apart(&pose_from_rapier(pos12), g1, g2, f64::INFINITY) {
            Some(Apart::By(distance, _)) => distance as Real,
            Some(_) => 0.0,
            None if is_known(g1, g2) => return Err(Unsupported),
            None => {
                let told = DefaultQueryDispatcher.distance(pos12, for_parry(g1), for_parry(g2))?;
                let distance = if encloses(pos12, g1, g2) { 0.0 } else { told.distance };
                return Ok(ShapeDistance { distance, ..told });
            }
        };
        Ok(ShapeDistance { distance, subshape1: 0, subshape2: 0 })
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<ParryContact>, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                let told = details::contact_composite_shape_shape(self, pos12, c1, g2, prediction);
                return Ok(told);
            }
            Some(Composite::Second(c2)) => {
                let told = details::contact_shape_composite_shape(self, pos12, g1, c2, prediction);
                return Ok(told);
            }
            None => {}
        }
        let (pose, reach) = (pose_from_rapier(pos12), f64::from(prediction));
        let Some(found) =
            PairWorkspace::for_question(g1, g2).found(&pose, g1, g2, Reach::all(reach))
        else {
            return DefaultQueryDispatcher.contact(pos12, for_parry(g1), for_parry(g2), prediction);
        };
        let inverse = pose.world_from_body().inverse();
        let deepest = found.contacts.iter().min_by(|x, y| x.separation.total_cmp(&y.separation));
        Ok(deepest.map(|c| ParryContact {
            point1: narrow(c.on_first),
            point2: narrow(inverse.apply(c.on_second)),
            normal1: narrow(c.normal),
            normal2: narrow(inverse.apply_vector(-c.normal)),
            dist: c.separation as Real,
            subshape1: 0,
            subshape2: 0,
        }))
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                let told =
                    details::closest_points_composite_shape_shape(self, pos12, c1, g2, max_dist);
                return Ok(told);
            }
            Some(Composite::Second(c2)) => {
                let told =
                    details::closest_points_shape_composite_shape(self, pos12, g1, c2, max_dist);
                return Ok(told);
            }
            None => {}
        }
        let pose = pose_from_rapier(pos12);
        match apart(&pose, g1, g2, max_dist.into()) {
            Some(Apart::Meeting) => Ok(ClosestPoints::Intersecting),
            Some(Apart::Farther) => Ok(ClosestPoints::Disjoint),
            Some(Apart::By(_, [a, b])) => {
                let b = pose.world_from_body().inverse().apply(b);
                Ok(ClosestPoints::WithinMargin(narrow(a), narrow(b)))
            }
            None if is_known(g1, g2) => Err(Unsupported),
            None if encloses(pos12, g1, g2) => Ok(ClosestPoints::Intersecting),
            None => {
                let (g1, g2) = (for_parry(g1), for_parry(g2));
                DefaultQueryDispatcher.closest_points(pos12, g1, g2, max_dist)
            }
        }
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                let cast = details::cast_shapes_composite_shape_shape;
                return Ok(cast(self, pos12, local_vel12, c1, g2, options));
            }
            Some(Composite::Second(c2)) => {
                let cast = details::cast_shapes_shape_composite_shape;
                return Ok(cast(self, pos12, local_vel12, g1, c2, options));
            }
            None => {}
        }
        if let Some([m1, m2]) = models(g1, g2).filter(|_| options.target_distance <= 0.0) {
            let seconds = options.max_time_of_impact;
            let cast = Cast::straight([&m1, &m2], pos12, local_vel12, seconds);
            if let Some(told) = cast.meet(|| AtOnce {
                always: options.stop_at_penetration,
                contact: self.touching(pos12, g1, g2, &cast),
            }) {
                return Ok(told);
            }
        }
        let (g1, g2) = (for_parry(g1), for_parry(g2));
        DefaultQueryDispatcher.cast_shapes(pos12, local_vel12, g1, g2, options)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        match Composite::of(g1, g2) {
            Some(Composite::First(c1)) => {
                return Ok(details::cast_shapes_nonlinear_composite_shape_shape(
                    self,
                    motion1,
                    c1,
                    motion2,
                    g2,
                    start_time,
                    end_time,
                    stop_at_penetration,
                ));
            }
            Some(Composite::Second(c2)) => {
                return Ok(details::cast_shapes_nonlinear_shape_composite_shape(
                    self,
                    motion1,
                    g1,
                    motion2,
                    c2,
                    start_time,
                    end_time,
                    stop_at_penetration,
                ));
            }
            None => {}
        }
        if let Some([m1, m2]) = models(g1, g2) {
            let cast = Cast::turning([&m1, &m2], [motion1, motion2], start_time, end_time);
            if let Some(told) = cast.meet(|| {
                let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(start_time));
                let pos12 = pose1.inv_mul(&pose2);
                let contact = self.touching(&pos12, g1, g2, &cast);
                AtOnce { always: stop_at_penetration, contact }
            }) {
                return Ok(told);
            }
        }
        DefaultQueryDispatcher.cast_shapes_nonlinear(
            motion1,
            for_parry(g1),
            motion2,
            for_parry(g2),
            start_time,
            end_time,
            stop_at_penetration,
        )
    }
}
