//! The query dispatcher: Cranny's answers where our shape takes part, parry's elsewhere.
//!
//! | partner of a [`MeshShape`] | contacts from |
//! |---|---|
//! | `MeshShape`, cuboid, convex polyhedron, triangle mesh, height field | the exact pair query |
//! | ball, capsule | nearest features of the mesh |
//! | half-space | lowest vertices of the mesh |
//! | all others | parry, with the mesh of the same triangles: hollow |
//!
//! Intersection tests, distances, closest points and single contacts between polyhedra are exact too.
//! Of other partners parry tells how far the surfaces are; that one lies wholly inside our solid is
//! seen here (a compound: when any part does).
//! Shape casts (continuous collision detection) use the parry mesh of the same triangles.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use cranny_exact::Pose as ExactPose;
use cranny_geometry::Model;
use cranny_narrow_phase::{Contact, Demand, PairMemory};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{NonlinearRigidMotion, NormalConstraints, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact as ParryContact, ContactManifold, ContactManifoldsWorkspace,
    DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit,
    ShapeDistance, ShapeIntersection, TypedWorkspaceData, Unsupported, WorkspaceData,
};
use rapier3d::parry::shape::{PackedFeatureId, Shape, TypedShape};

use crate::ask::ask;
use crate::convert::{narrow, pose_from_rapier, wide};
use crate::deep::{thickness, way_out};
use crate::log::AnswerLog;
use crate::manifolds::{Manifold, packed, packed_patch, rebuild};
use crate::partners::{
    ball_contacts, capsule_contacts, half_space_contacts, holds, is_polyhedral, polyhedron,
};
use crate::shape::MeshShape;

/// How far, as a multiple of the prediction distance, a contact may have moved and still be the
/// same: beyond, its impulse belongs to another place.
const SAME_PLACE: f64 = 1.0;

/// Meshes of fewer faces are asked for the regions of their contact, the others patch by patch. Larger:
/// time is lost on what patches tell as well; smaller: a hook of 20 faces slips off an edge, since
/// its patches are whole sides.
const FINE: usize = 64;

fn is_fine(model: &Model) -> bool {
    model.mesh().faces().len() >= FINE
}

/// Puts the detector into rapier: `NarrowPhase::with_query_dispatcher(Dispatcher::default())`.
#[derive(Clone, Debug, Default)]
pub struct Dispatcher {
    log: Option<AnswerLog>,
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
        Self { log: Some(log) }
    }
}

/// What a pair keeps between steps, inside rapier's own workspace of the pair.
struct PairWorkspace {
    memory: Mutex<PairMemory>,
    /// Models of partners that are polyhedra; `None` for our own shapes.
    partners: [Option<Model>; 2],
    /// Of the thinner one, as [`thickness`] tells it.
    thickness: f64,
}

impl WorkspaceData for PairWorkspace {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(Self {
            memory: Mutex::new(self.memory.lock().unwrap_or_else(PoisonError::into_inner).clone()),
            partners: self.partners.clone(),
            thickness: self.thickness,
        })
    }
}

fn ours(shape: &dyn Shape) -> Option<&MeshShape> {
    let any: &dyn Any = shape;
    any.downcast_ref()
}

/// The shape that parry's own dispatcher understands in place of ours.
fn for_parry(shape: &dyn Shape) -> &dyn Shape {
    ours(shape).map_or(shape, |s| s.mesh() as &dyn Shape)
}

/// The models of two shapes that are polyhedra, one of them ours.
fn models(g1: &dyn Shape, g2: &dyn Shape) -> Option<[Model; 2]> {
    if ours(g1).is_none() && ours(g2).is_none() {
        return None;
    }
    let model = |g: &dyn Shape| ours(g).map(|s| s.model().clone()).or_else(|| polyhedron(g));
    Some([model(g1)?, model(g2)?])
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
    if let Some(compound) = partner.as_compound() {
        let mut parts = compound.shapes().iter();
        return parts
            .any(|(pose, part)| holds_partner(model, &(*model_from_partner * *pose), &**part));
    }
    if partner.as_support_map().is_none() {
        return false; // a half-space or a surface: nothing encloses it
    }
    let middle = partner.compute_local_aabb().center();
    let point = partner.project_local_point(middle, true).point;
    holds(model, pose_from_rapier(model_from_partner).world_from_body().apply(wide(point)))
}

impl Dispatcher {
    /// Contacts of our shape with a shape that is no polyhedron, in our shape's frame; `None` where
    /// parry must answer.
    fn primitive_contacts(
        shape: &MeshShape,
        partner: &dyn Shape,
        shape_from_partner: &ExactPose,
        reach: f64,
    ) -> Option<Vec<Contact>> {
        let map = shape_from_partner.world_from_body();
        let model = shape.model();
        match partner.as_typed_shape() {
            TypedShape::Ball(ball) => {
                Some(ball_contacts(model, map.translation, ball.radius.into(), reach))
            }
            TypedShape::Capsule(capsule) => {
                let axis = [capsule.segment.a, capsule.segment.b].map(|p| map.apply(wide(p)));
                Some(capsule_contacts(model, axis, capsule.radius.into(), reach))
            }
            TypedShape::HalfSpace(half_space) => {
                let normal = map.apply_vector(wide(half_space.normal)).normalize_or_zero();
                Some(half_space_contacts(model, normal, normal.dot(map.translation), reach))
            }
            _ => None,
        }
    }

    /// Contacts of a pair of which one shape is ours and the other no polyhedron, in the first
    /// shape's frame; `None` where parry must answer.
    fn partner_contacts(
        pose: &ExactPose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        reach: f64,
    ) -> Option<Vec<Contact>> {
        if let Some(shape) = ours(g1) {
            return Self::primitive_contacts(shape, g2, pose, reach);
        }
        let forth = pose.world_from_body();
        let back = ExactPose {
            rotation: pose.rotation.conjugate(),
            translation: forth.inverse().translation,
        };
        let contacts = Self::primitive_contacts(ours(g2)?, g1, &back, reach)?;
        Some(contacts.into_iter().map(|c| c.moved(&forth).swapped()).collect())
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
        let reach = f64::from(prediction);
        let Some(mut pair) = PairWorkspace::of(workspace, g1, g2) else {
            let contacts = Self::partner_contacts(&pose, g1, g2, reach)?;
            *workspace = Some(ContactManifoldsWorkspace::from(PairWorkspace::blank()));
            let features = |contact: &Contact| (packed(contact.id.0), packed(contact.id.1));
            rebuild(&contacts, features, &pose, SAME_PLACE * reach, manifolds);
            return Some(Duration::ZERO);
        };
        let memory = pair.memory.get_mut().unwrap_or_else(PoisonError::into_inner);
        let model = |g, partner: &Option<Model>| {
            ours(g).map(|s| s.model().clone()).or_else(|| partner.clone())
        };
        let models = [model(g1, &pair.partners[0])?, model(g2, &pair.partners[1])?];
        let demand = solver_demand(&models, reach);
        let mut read = Duration::ZERO;
        match ask(models.each_ref(), pose, demand, memory) {
            Some(answer) => {
                let ids = |contact: &Contact| ids_of(contact, &models, demand);
                let led = way_out(&models, pair.thickness, &pose, &answer, reach, memory);
                let contacts = led.as_ref().unwrap_or(&answer.contacts);
                rebuild(contacts, ids, &pose, SAME_PLACE * reach, manifolds);
                if let (Some(log), Some(s1), Some(s2)) = (&self.log, ours(g1), ours(g2)) {
                    let wanted = log.demand(s1.tag(), s2.tag());
                    let told = if demand.covers(wanted) {
                        Some(answer)
                    } else {
                        let begin = Instant::now();
                        let told = ask(models.each_ref(), pose, wanted, memory);
                        read = begin.elapsed();
                        told
                    };
                    if let Some(told) = told {
                        log.put((s1.tag(), s2.tag()), Arc::new(told), pose);
                    }
                }
            }
            None => manifolds.clear(),
        }
        *workspace = Some(ContactManifoldsWorkspace::from(*pair));
        Some(read)
    }
}

/// What the solver needs of a pair of polyhedra.
fn solver_demand(models: &[Model; 2], margin: f64) -> Demand {
    if models.iter().all(is_fine) {
        Demand::Contacts { margin }
    } else {
        Demand::Regions { margin }
    }
}

/// By what a contact is known from step to step.
fn ids_of(
    contact: &Contact,
    [m1, m2]: &[Model; 2],
    demand: Demand,
) -> (PackedFeatureId, PackedFeatureId) {
    match demand {
        Demand::Contacts { .. } => {
            let (a, b) = contact.patches(m1, m2);
            (packed_patch(a), packed_patch(b))
        }
        _ => (packed(contact.id.0), packed(contact.id.1)),
    }
}

impl PairWorkspace {
    fn blank() -> Self {
        Self { memory: Mutex::default(), partners: [None, None], thickness: f64::INFINITY }
    }

    /// Takes the pair's workspace, or makes one where both shapes are polyhedra and one is ours.
    fn of(
        workspace: &mut Option<ContactManifoldsWorkspace>,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Option<Box<Self>> {
        let is_polyhedron = |g: &dyn Shape| ours(g).is_some() || is_polyhedral(g);
        if !is_polyhedron(g1) || !is_polyhedron(g2) {
            return None;
        }
        if let Some(data) = workspace.take()
            && let Ok(own) = data.0.downcast::<Self>()
        {
            return Some(own);
        }
        let partner = |g: &dyn Shape| if ours(g).is_some() { None } else { polyhedron(g) };
        let partners = [partner(g1), partner(g2)];
        let model = |g, partner: &Option<Model>| {
            ours(g).map(|shape| shape.model().clone()).or_else(|| partner.clone())
        };
        let thickness = match (model(g1, &partners[0]), model(g2, &partners[1])) {
            (Some(m1), Some(m2)) => thickness([&m1, &m2]),
            _ => f64::INFINITY,
        };
        Some(Box::new(Self { memory: Mutex::default(), partners, thickness }))
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
        let involved = ours(g1).is_some() || ours(g2).is_some();
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
        let parry = DefaultQueryDispatcher.intersection_test(pos12, for_parry(g1), for_parry(g2));
        let Some([m1, m2]) = models(g1, g2) else {
            let parry = parry?;
            let intersecting = parry.intersecting || encloses(pos12, g1, g2);
            return Ok(ShapeIntersection { intersecting, ..parry });
        };
        let pose = pose_from_rapier(pos12);
        let answer = ask([&m1, &m2], pose, Demand::Intersects, &mut PairMemory::default())
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
        let Some([m1, m2]) = models(g1, g2) else {
            let apart = DefaultQueryDispatcher.distance(pos12, for_parry(g1), for_parry(g2))?;
            let distance = if encloses(pos12, g1, g2) { 0.0 } else { apart.distance };
            return Ok(ShapeDistance { distance, ..apart });
        };
        let demand = Demand::Distance { below: None };
        let answer = ask([&m1, &m2], pose_from_rapier(pos12), demand, &mut PairMemory::default())
            .ok_or(Unsupported)?;
        let distance = if answer.solid { 0.0 } else { answer.distance.unwrap_or(0.0) as Real };
        Ok(ShapeDistance { distance, subshape1: 0, subshape2: 0 })
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<ParryContact>, Unsupported> {
        let (pose, reach) = (pose_from_rapier(pos12), f64::from(prediction));
        let contacts = if let Some([m1, m2]) = models(g1, g2) {
            let demand = Demand::Contacts { margin: reach };
            ask([&m1, &m2], pose, demand, &mut PairMemory::default())
                .map(|answer| answer.contacts)
                .ok_or(Unsupported)?
        } else if let Some(contacts) = Self::partner_contacts(&pose, g1, g2, reach) {
            contacts
        } else {
            return DefaultQueryDispatcher.contact(pos12, for_parry(g1), for_parry(g2), prediction);
        };
        let inverse = pose.world_from_body().inverse();
        Ok(contacts.first().map(|c| ParryContact {
            point1: narrow(c.point_a),
            point2: narrow(inverse.apply(c.point_b)),
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
        let Some([m1, m2]) = models(g1, g2) else {
            if encloses(pos12, g1, g2) {
                return Ok(ClosestPoints::Intersecting);
            }
            return DefaultQueryDispatcher.closest_points(
                pos12,
                for_parry(g1),
                for_parry(g2),
                max_dist,
            );
        };
        let pose = pose_from_rapier(pos12);
        let demand = Demand::Distance { below: None };
        let answer =
            ask([&m1, &m2], pose, demand, &mut PairMemory::default()).ok_or(Unsupported)?;
        if answer.solid || answer.surface.meets() {
            return Ok(ClosestPoints::Intersecting);
        }
        let inverse = pose.world_from_body().inverse();
        Ok(match (answer.witnesses, answer.distance) {
            (Some([a, b]), Some(d)) if d <= f64::from(max_dist) => {
                ClosestPoints::WithinMargin(narrow(a.point), narrow(inverse.apply(b.point)))
            }
            _ => ClosestPoints::Disjoint,
        })
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
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
