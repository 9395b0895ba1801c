//! The contacts of a pair of shapes in which ours takes part, and what is kept of the pair between
//! steps.
//!
//! Compounds are taken apart: each part meets each part near it as a pair of its own, with memory
//! of its own.

use std::any::Any;
use std::collections::BTreeMap;
use std::mem;
use std::sync::{Mutex, PoisonError};

use cranny_exact::Pose as ExactPose;
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Answer, Approach, Contact, Demand, PairMemory, Placed, Query, drift, overlaps_by_regions,
    reduce_level_contacts, smooth_normal,
};
use cranny_primitives::{
    contacts,
    deep::{deep, lasts, way_out},
    rounded,
};
use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::BoundingVolume;
#[cfg(feature = "snapshot")]
use rapier3d::parry::query::details::VoxelsShapeContactManifoldsWorkspace;
use rapier3d::parry::query::{
    DefaultQueryDispatcher, PersistentQueryDispatcher, TypedWorkspaceData, WorkspaceData,
};
use rapier3d::parry::shape::{PackedFeatureId, Shape};

use crate::ask::{ask, logged};
use crate::carried::{CarriedList, Search};
use crate::compounds::{has_parts, parts};
use crate::convert::{pose_to_rapier, wide};
use crate::manifolds::{Manifold, SolverContact, packed, packed_patch};
use crate::partners::{Core, primitive};
use crate::shape::MeshShape;

/// Our shape, where it is one.
pub(crate) fn ours(shape: &dyn Shape) -> Option<&MeshShape> {
    let any: &dyn Any = shape;
    any.downcast_ref()
}

/// The shape that parry's own dispatcher understands in place of ours.
pub(crate) fn for_parry(shape: &dyn Shape) -> &dyn Shape {
    ours(shape).map_or(shape, |s| s.mesh() as &dyn Shape)
}

/// What a pair keeps between steps, inside rapier's own workspace of the pair.
pub(crate) struct PairWorkspace {
    memory: Mutex<PairMemory>,
    /// What the pair's last search found, if its contacts may be carried on.
    carried: Option<CarriedList>,
    /// What is queried of each side: a model, where both have one.
    cores: Option<[Core; 2]>,
    /// Whether deep overlaps are reported as a solver is led out of them, not as they are.
    leads_out: bool,
    /// Of pairs of a compound's parts, by the parts' numbers; of those alone that are near.
    parts: BTreeMap<(usize, usize), Self>,
    /// Of the parts that were ever near, by side and number: what takes long to make is made once.
    part_cores: BTreeMap<(usize, usize), Option<Core>>,
    /// Empty, always.
    #[cfg(feature = "snapshot")]
    stand_in: VoxelsShapeContactManifoldsWorkspace<2>,
}

impl Clone for PairWorkspace {
    fn clone(&self) -> Self {
        Self {
            memory: Mutex::new(self.memory.lock().unwrap_or_else(PoisonError::into_inner).clone()),
            carried: self.carried.clone(),
            cores: self.cores.clone(),
            leads_out: self.leads_out,
            parts: self.parts.clone(),
            part_cores: self.part_cores.clone(),
            #[cfg(feature = "snapshot")]
            stand_in: VoxelsShapeContactManifoldsWorkspace::new(),
        }
    }
}

impl WorkspaceData for PairWorkspace {
    /// A snapshot holds an empty one in its place: what a pair keeps saves time and changes no
    /// answer.
    #[cfg(feature = "snapshot")]
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::VoxelsShapeContactManifoldsWorkspace(&self.stand_in)
    }

    #[cfg(not(feature = "snapshot"))]
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(self.clone())
    }
}

/// An answer and its query.
pub(crate) type Answered = (Answer, Query);

/// How far a pair's contacts count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// None counts that is farther.
    pub(crate) within: f64,
    /// Those that are farther than the first need not be found, unless this closes them.
    pub(crate) approaching: Option<(f64, Approach)>,
}

impl Reach {
    /// All contacts within a length.
    pub(crate) fn all(within: f64) -> Self {
        Self { within, approaching: None }
    }
}

/// What a pair's contacts are.
pub(crate) struct Found {
    /// Within reach, in the first shape's frame, from first to second.
    pub(crate) contacts: Vec<SolverContact>,
    /// The whole answer and its query, where the pair was queried as two models.
    pub(crate) answer: Option<Answered>,
    /// What a list of them that is carried on is made of, where there is one.
    searched: Option<Searched>,
}

/// What a search of two models found that lasts.
enum Searched {
    /// Contacts of surfaces.
    Contacts(Vec<Contact>),
    /// The leads of a way out that nothing else touches, out of bodies of this lesser thickness.
    Leads(Vec<Contact>, f64),
}

impl Found {
    /// How far bodies may drift and still be led by what was found; `None` where it is no way out
    /// that lasts.
    pub(crate) fn lasts(&self) -> Option<f64> {
        match self.searched {
            Some(Searched::Leads(_, thickness)) => Some(lasts(thickness)),
            _ => None,
        }
    }

    fn of_contacts(contacts: Vec<Contact>) -> Self {
        let contacts = contacts.iter().map(|c| SolverContact::of(c, features_of(c)));
        Self::without_answer(contacts.collect())
    }

    fn without_answer(contacts: Vec<SolverContact>) -> Self {
        Self { contacts, answer: None, searched: None }
    }
}

/// What stands for a shape in a query; `None` where parry has to answer.
fn core(shape: &dyn Shape) -> Option<Core> {
    match ours(shape) {
        Some(shape) => Some(Core::of_ours(shape)),
        None => Core::of(shape),
    }
}

impl PairWorkspace {
    /// Of a pair that has not been queried yet, for a solver.
    pub(crate) fn for_solver(g1: &dyn Shape, g2: &dyn Shape) -> Self {
        Self::new(g1, g2, true)
    }

    /// Of a pair that is queried once, for somebody who wants to know how it is.
    pub(crate) fn for_question(g1: &dyn Shape, g2: &dyn Shape) -> Self {
        Self::new(g1, g2, false)
    }

    fn new(g1: &dyn Shape, g2: &dyn Shape, leads_out: bool) -> Self {
        let involved = ours(g1).is_some() || ours(g2).is_some();
        let cores = involved.then(|| Some([core(g1)?, core(g2)?])).flatten();
        Self::of_cores(cores, leads_out)
    }

    fn of_cores(cores: Option<[Core; 2]>, leads_out: bool) -> Self {
        Self {
            memory: Mutex::default(),
            carried: None,
            cores,
            leads_out,
            parts: BTreeMap::new(),
            part_cores: BTreeMap::new(),
            #[cfg(feature = "snapshot")]
            stand_in: VoxelsShapeContactManifoldsWorkspace::new(),
        }
    }

    /// Of two parts, whose cores are made when they first come near anything.
    fn of_part_cores(&mut self, [i, j]: [usize; 2], g1: &dyn Shape, g2: &dyn Shape) -> Self {
        let involved = ours(g1).is_some() || ours(g2).is_some();
        let mut kept = |side, index, shape: &dyn Shape| {
            self.part_cores.entry((side, index)).or_insert_with(|| core(shape)).clone()
        };
        let cores = involved.then(|| Some([kept(0, i, g1)?, kept(1, j, g2)?])).flatten();
        Self::of_cores(cores, self.leads_out)
    }

    /// What the pair's queries keep.
    pub(crate) fn memory(&mut self) -> &mut PairMemory {
        self.memory.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// The contacts within a reach (> 0); `None` where parry must answer: ours takes no part in the
    /// pair, or what its partner is, is not known here.
    pub(crate) fn found(
        &mut self,
        pose: &ExactPose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        reach: Reach,
    ) -> Option<Found> {
        let Reach { within, .. } = reach;
        if has_parts(g1, g2) {
            return Some(Found::without_answer(self.of_parts(pose, g1, g2, within)));
        }
        match &self.cores {
            Some(cores) => {
                let cores = cores.clone();
                Some(self.of_models(pose, cores, reach))
            }
            None => partner_contacts(pose, g1, g2, within).map(Found::of_contacts),
        }
    }

    fn of_models(&mut self, pose: &ExactPose, cores: [Core; 2], reach: Reach) -> Found {
        let thickness = cores[0].thickness.min(cores[1].thickness);
        let models = cores.each_ref().map(Core::model);
        let question = match self.leads_out {
            true => led_from(deep(thickness), solver_question(&cores, reach)),
            false => Query::of(Demand::contacts(between_cores(&cores, reach.within))),
        };
        let Some(answer) = ask(models, *pose, &question, self.memory()) else {
            return Found::without_answer(Vec::new());
        };
        let led = match self.leads_out {
            true => logged(way_out(models, thickness, pose, &answer, self.memory())).flatten(),
            false => None,
        };
        // A solver's alone; and a way out is one for the whole body, and no surface's.
        let is_smooth = self.leads_out && led.is_none();
        let listed = match (&led, is_smooth) {
            (Some(way), _) => way.contacts(thickness),
            (None, true) => reduce_level_contacts(answer.contacts.clone()),
            (None, false) => answer.contacts.clone(),
        };
        let contacts = listed.iter().map(|contact| {
            solver_contact(contact, ids_of(contact, models), &cores, pose, is_smooth)
        });
        let contacts = contacts.collect();
        let searched = match led {
            Some(way) if way.beside.is_empty() => Some(Searched::Leads(way.leads, thickness)),
            Some(_) => None,
            None => is_smooth.then_some(Searched::Contacts(listed)),
        };
        Found { contacts, searched, answer: Some((answer, question)) }
    }

    /// Keeps what a search found, if it can be carried on.
    pub(crate) fn keep(&mut self, found: &Found, search: (ExactPose, f64)) -> bool {
        let searched = found.searched.as_ref();
        self.carried = searched.zip(self.cores.as_ref()).map(|(searched, cores)| {
            let models = cores.each_ref().map(Core::model);
            let (listed, led) = match searched {
                Searched::Contacts(contacts) => (contacts, None),
                Searched::Leads(leads, thickness) => (leads, Some(*thickness)),
            };
            let known_by = |contact| (contact, ids_of(contact, models));
            CarriedList::of(models, search, led, listed.iter().map(known_by))
        });
        self.carried.is_some()
    }

    /// By how much the pose differs from that of a search; `None` where it has no cores.
    pub(crate) fn drift_since(&self, search: &Search, pose: &ExactPose) -> Option<f64> {
        let models = self.cores.as_ref()?.each_ref().map(Core::model);
        Some(drift(models, &search.pose.world_from_body(), &pose.world_from_body()))
    }

    /// The contacts of a search at a pose that differs from its own by a drift of `within` at most;
    /// `None` where it differs by more, or a contact has left its features.
    pub(crate) fn carried(
        &mut self,
        search: &Search,
        pose: &ExactPose,
        within: f64,
    ) -> Option<Vec<SolverContact>> {
        if self.drift_since(search, pose)? > within {
            return None;
        }
        let map = pose.world_from_body();
        // After a snapshot only the search is known, and what it found follows from it.
        if !self.carried.as_ref().is_some_and(|list| list.is_of(search)) {
            let found = self.of_models(&search.pose, self.cores.clone()?, Reach::all(search.reach));
            self.keep(&found, (search.pose, search.reach));
        }
        let (cores, list) = (self.cores.as_ref()?, self.carried.as_ref()?);
        let contacts = list.refreshed(&map, within)?;
        let of = |(contact, ids): &(Contact, _)| {
            solver_contact(contact, *ids, cores, pose, !list.is_of_leads())
        };
        Some(contacts.iter().map(of).collect())
    }

    fn of_parts(
        &mut self,
        pose: &ExactPose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        reach: f64,
    ) -> Vec<SolverContact> {
        let mut known = mem::take(&mut self.parts);
        let mut contacts = Vec::new();
        let seconds = parts(g2);
        for (i, (pose1, part1)) in parts(g1).into_iter().enumerate() {
            let back = pose1.inverse();
            let home = pose1.world_from_body();
            let near = part1.compute_local_aabb().loosened(reach as Real);
            for (j, &(pose2, part2)) in seconds.iter().enumerate() {
                let between = back.compose(&pose.compose(&pose2));
                if !near.intersects(&part2.compute_aabb(&pose_to_rapier(&between))) {
                    continue;
                }
                let mut pair = match known.remove(&(i, j)) {
                    Some(pair) => pair,
                    None => self.of_part_cores([i, j], part1, part2),
                };
                let found = match pair.found(&between, part1, part2, Reach::all(reach)) {
                    Some(found) => found.contacts,
                    None => parry_contacts(&between, part1, part2, reach),
                };
                contacts.extend(found.into_iter().map(|contact| contact.moved(&home)));
                self.parts.insert((i, j), pair);
            }
        }
        contacts
    }
}

/// A contact of two cores as a solver gets it: of what they are rounded to, and by their smooth
/// normals if wanted.
fn solver_contact(
    contact: &Contact,
    ids: (PackedFeatureId, PackedFeatureId),
    cores: &[Core; 2],
    pose: &ExactPose,
    is_smooth: bool,
) -> SolverContact {
    let radii = cores.each_ref().map(|core| core.rounded.radius);
    let plain = SolverContact::of(&rounded(contact, radii), ids);
    let smooth = cores.each_ref().map(|core| core.smooth.as_deref());
    if !is_smooth || smooth.iter().all(Option::is_none) {
        return plain;
    }
    let bodies = [
        Placed { model: cores[0].model(), pose: ExactPose::IDENTITY },
        Placed { model: cores[1].model(), pose: *pose },
    ];
    SolverContact { normal: smooth_normal(contact, bodies, smooth), ..plain }
}

/// A length between rounded bodies as one between their cores.
fn between_cores(cores: &[Core; 2], length: f64) -> f64 {
    length + cores[0].rounded.radius + cores[1].rounded.radius
}

/// The same question, and how deep regions are from a depth on, if anything can be so deep.
fn led_from(depth: f64, question: Query) -> Query {
    if depth.is_finite() { question.penetrations_from(depth) } else { question }
}

/// What the solver needs of a pair of polyhedra.
fn solver_question(cores: &[Core; 2], reach: Reach) -> Query {
    let margin = between_cores(cores, reach.within);
    // What a rounded or a smooth body comes to is not what its core comes to.
    let is_plain = cores.iter().all(|core| core.rounded.radius == 0.0 && core.smooth.is_none());
    match reach.approaching.filter(|_| is_plain) {
        Some((certain, approach)) => Query::of(Demand::contacts(certain)).approaching(approach),
        None => Query::of(Demand::contacts(margin)),
    }
}

/// By what a contact is known from step to step: its patches; of small bodies, whose patches have
/// many contacts each, its features.
fn ids_of(contact: &Contact, models: [&Model; 2]) -> (PackedFeatureId, PackedFeatureId) {
    if overlaps_by_regions(models) {
        return features_of(contact);
    }
    let (a, b) = contact.patches(models[0], models[1]);
    (packed_patch(a), packed_patch(b))
}

fn features_of(contact: &Contact) -> (PackedFeatureId, PackedFeatureId) {
    (packed(contact.id.0), packed(contact.id.1))
}

/// Contacts of a pair of which one shape is ours and the other has no core, in the first shape's
/// frame; `None` where parry must answer.
fn partner_contacts(
    pose: &ExactPose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    reach: f64,
) -> Option<Vec<Contact>> {
    if let Some(shape) = ours(g1) {
        return primitive_contacts(shape, g2, pose, reach);
    }
    let contacts = primitive_contacts(ours(g2)?, g1, &pose.inverse(), reach)?;
    let forth = pose.world_from_body();
    Some(contacts.into_iter().map(|c| c.moved(&forth).swapped()).collect())
}

/// Contacts of our shape with a shape that has no core, in our shape's frame, none at an invalid
/// pose; `None` where parry must answer.
fn primitive_contacts(
    shape: &MeshShape,
    partner: &dyn Shape,
    shape_from_partner: &ExactPose,
    reach: f64,
) -> Option<Vec<Contact>> {
    let partner = primitive(partner)?.moved(&shape_from_partner.world_from_body());
    Some(contacts(shape.model(), &partner, reach).unwrap_or_else(|error| {
        tracing::error!("pair left out of this step: {error}");
        Vec::new()
    }))
}

/// What parry says of two parts, of which either may be the mesh of our triangles: in the first
/// part's frame.
fn parry_contacts(
    pose: &ExactPose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    reach: f64,
) -> Vec<SolverContact> {
    let pos12 = pose_to_rapier(pose);
    let (mut manifolds, reach): (Vec<Manifold>, _) = (Vec::new(), reach as Real);
    let (g1, g2) = (for_parry(g1), for_parry(g2));
    let filled =
        DefaultQueryDispatcher.contact_manifolds(&pos12, g1, g2, reach, &mut manifolds, &mut None);
    if filled.is_err() {
        // As rapier itself does with such a pair; no step can report an error.
        tracing::debug!(
            "parts that nobody knows contacts of: {:?}",
            (g1.shape_type(), g2.shape_type())
        );
    }
    manifolds.iter().flat_map(|manifold| parry_points(manifold, &pos12)).collect()
}

/// The points of a manifold in the frame of its first shape.
fn parry_points<'a>(
    manifold: &'a Manifold,
    pos12: &'a Pose,
) -> impl Iterator<Item = SolverContact> + 'a {
    let first = manifold.subshape_pos1().copied().unwrap_or(Pose::IDENTITY);
    let second = *pos12 * manifold.subshape_pos2().copied().unwrap_or(Pose::IDENTITY);
    let normal = wide(first.rotation * manifold.local_n1).normalize_or_zero();
    manifold.points.iter().map(move |point| SolverContact {
        ids: (point.fid1, point.fid2),
        on_first: wide(first * point.local_p1),
        on_second: wide(second * point.local_p2),
        normal,
        separation: point.dist.into(),
    })
}
