//! What a simulation reports of its last step: pairs, energy, times.

use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_narrow_phase::{Answer, Fields};
use rapier3d::geometry::{ContactData, ContactManifold, ContactPair, NEW_CONTACT_BIT};
use rapier3d::math::{Pose as RapierPose, Vector};
use rapier3d::parry::query::TrackedContact;
use rapier3d::prelude::{ImpulseJoint, RigidBodyHandle};

use super::{BodyIndex, Simulation};
use crate::carried::PairCounts;
use crate::convert::wide;
use crate::joint::elastic_energy;

/// A point of a manifold, with what the solver did there.
type TrackedPoint = TrackedContact<ContactData>;

/// What the detector said of a pair in rapier's last step.
#[derive(Clone, Debug)]
pub struct PairContacts {
    /// Lower body.
    pub a: BodyIndex,
    /// Higher body.
    pub b: BodyIndex,
    /// In world coordinates.
    pub answer: Arc<Answer>,
    /// Of a and b, from which the answer was computed: those at the beginning of the step, or of
    /// its last part.
    pub poses: [Pose; 2],
    /// Where the second shape was in the frame of the first: what the query was given, to the bit.
    pub first_from_second: Pose,
    /// Whether the first shape is that of `a`.
    pub first_is_a: bool,
    /// Computed in the last step; otherwise rapier recycled older contacts.
    pub fresh: bool,
}

impl PairContacts {
    /// The same with the bodies exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        let Self { a, b, poses: [of_a, of_b], first_is_a, .. } = self;
        let answer = Arc::new(Arc::unwrap_or_clone(self.answer).swapped());
        Self { a: b, b: a, answer, poses: [of_b, of_a], first_is_a: !first_is_a, ..self }
    }
}

/// A point at which two bodies press on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedPoint {
    /// Half-way between the surfaces, in the world.
    pub point: DVec3,
    /// Unit, from the lower body to the higher.
    pub normal: DVec3,
    /// Along the normal: < 0 where the bodies overlap.
    pub separation: f64,
    /// What it gave each body along the normal: mass x length / second, >= 0.
    pub impulse: f64,
}

/// Mechanical energy of all dynamic bodies, and of the springs between bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion.
    pub kinetic: f64,
    /// Of height, −mass · gravity · centre of mass, and in springs.
    pub potential: f64,
}

impl Energy {
    /// Sum of both.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Milliseconds of the last step, by rapier's own counters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timings {
    /// Broad phase.
    pub broad: f64,
    /// Narrow phase, contact detection included.
    pub narrow: f64,
    /// What [`Simulation::read_by`] cost besides: fields that the solver's answers do not hold.
    pub reading: f64,
    /// Constraints solver.
    pub solver: f64,
    /// The whole step.
    pub step: f64,
}

impl Timings {
    pub(super) fn plus(self, other: &Self) -> Self {
        Self {
            broad: self.broad + other.broad,
            narrow: self.narrow + other.narrow,
            reading: self.reading + other.reading,
            solver: self.solver + other.solver,
            step: self.step + other.step,
        }
    }
}

impl Simulation {
    /// Energy of all dynamic bodies and springs, summed in f64 from rapier's state.
    #[must_use]
    pub fn energy(&self) -> Energy {
        let mut energy = Energy::default();
        for index in self.indices() {
            let body = self.body(index);
            if body.is_dynamic() {
                energy.kinetic += f64::from(body.kinetic_energy());
                let center = wide(body.center_of_mass());
                energy.potential -= f64::from(body.mass()) * self.options.gravity.dot(center);
            }
        }
        energy.potential += self.joints.iter().map(|(_, joint)| self.in_spring(joint)).sum::<f64>();
        energy
    }

    fn in_spring(&self, joint: &ImpulseJoint) -> f64 {
        let end = |body: RigidBodyHandle, frame: &RapierPose| {
            let body = self.bodies.get(body)?;
            Some(wide(body.position().transform_point(frame.translation)))
        };
        let ends = end(joint.body1(), &joint.data.local_frame1)
            .zip(end(joint.body2(), &joint.data.local_frame2));
        ends.map_or(0.0, |(a, b)| elastic_energy(&joint.data, a.distance(b)))
    }

    /// Says which fields somebody reads, from now on, of a pair of bodies in
    /// [`contact_pairs`](Self::contact_pairs). Where the solver's answer does not
    /// [hold](Fields::held_by) them, a second query is made in the step, at the poses that the
    /// solver's contacts come from. How bodies move does not depend on it.
    pub fn read_by(&self, fields: impl Fn(BodyIndex, BodyIndex) -> Fields + Send + Sync + 'static) {
        self.log.read_by(move |first, second| fields(BodyIndex(first), BodyIndex(second)));
    }

    /// What the detector said of each pair that rapier queried in the last step, or whose older
    /// contacts it kept (bodies asleep, contacts recycled), by ascending bodies. Empty for
    /// detectors other than ours.
    #[must_use]
    pub fn contact_pairs(&self) -> Vec<PairContacts> {
        let step = self.log.step();
        let mut pairs: Vec<PairContacts> = self
            .narrow_phase
            .contact_pairs()
            .filter_map(|pair| {
                let (first, second) = self.tags(pair)?;
                let logged = self.log.get(first, second)?;
                let fresh = logged.step == step;
                if !fresh && pair.manifolds().is_empty() {
                    return None; // rapier dropped the pair without a query
                }
                let before = self.poses_before[first as usize];
                let world = before.world_from_body();
                let answer = logged.answer.as_ref().clone().moved(&world);
                let other = before.compose(&logged.first_from_second);
                let (a, b) = (BodyIndex(first), BodyIndex(second));
                let (answer, poses) = (Arc::new(answer), [before, other]);
                let first_from_second = logged.first_from_second;
                let first_is_a = true;
                let pair =
                    PairContacts { a, b, answer, poses, first_from_second, first_is_a, fresh };
                Some(if a < b { pair } else { pair.swapped() })
            })
            .collect();
        pairs.sort_by_key(|p| (p.a, p.b));
        pairs
    }

    /// How deep pairs of bodies can have overlapped at the poses at the beginning of the last step,
    /// the lower number first; below 0 where a gap was left. It follows from the pair's latest
    /// answer and how far the bodies have moved since, and is tight where they have moved little.
    /// Pairs of which the detector knows nothing are left out, and so are all of a step of several
    /// [parts](Self::parts), whose answers are of other poses. In no order.
    pub fn depth_bounds(&self) -> impl Iterator<Item = ((BodyIndex, BodyIndex), f64)> {
        let whole = self.parts() == 1;
        let pairs = self.narrow_phase.contact_pairs().filter(move |_| whole);
        pairs.filter_map(|pair| {
            let (first, second) = self.tags(pair)?;
            let [before, of_second] = [first, second].map(|tag| self.poses_before[tag as usize]);
            let models = [self.model_of(BodyIndex(first))?, self.model_of(BodyIndex(second))?];
            let logged = self.log.get(first, second)?;
            let bound = logged.depth_at_most(models, &before.inverse().compose(&of_second))?;
            Some(((BodyIndex(first.min(second)), BodyIndex(first.max(second))), bound))
        })
    }

    /// What the contacts of two bodies gave each of them along their normals in the last step,
    /// summed as numbers: mass x length / second, >= 0. 0 for bodies between which nothing was
    /// solved; of bodies asleep that of the last step of rapier's in which they were awake. With
    /// any detector.
    #[must_use]
    pub fn contact_impulse(&self, a: BodyIndex, b: BodyIndex) -> f64 {
        let [first, second] = [a, b].map(|body| self.tagged[body.0 as usize].collider);
        let pair = self.narrow_phase.contact_pair(first, second);
        pair.map_or(0.0, impulse_of) + self.earlier_impulse((a.0.min(b.0), a.0.max(b.0)))
    }

    /// [`contact_impulse`](Self::contact_impulse) of all pairs in which it is above 0, the lower
    /// number first; in no order.
    pub fn contact_impulses(&self) -> impl Iterator<Item = ((BodyIndex, BodyIndex), f64)> {
        self.narrow_phase.contact_pairs().filter_map(|pair| {
            let (a, b) = self.tags(pair)?;
            let (a, b) = (a.min(b), a.max(b));
            let impulse = impulse_of(pair) + self.earlier_impulse((a, b));
            (impulse > 0.0).then_some(((BodyIndex(a), BodyIndex(b)), impulse))
        })
    }

    /// The points that rapier's solver had of two bodies in the last step, with their impulses in
    /// it; in the world, where the bodies were at its beginning. Of a step of several
    /// [parts](Self::parts), those of each part that pressed, and all of the last one. With any
    /// detector, whoever else [reads](Self::read_by).
    #[must_use]
    pub fn solved_points(&self, a: BodyIndex, b: BodyIndex) -> Vec<SolvedPoint> {
        let [first, second] = [a, b].map(|body| self.tagged[body.0 as usize].collider);
        let earlier = self.earlier_points.get(&(a.0.min(b.0), a.0.max(b.0)));
        let mut points = earlier.cloned().unwrap_or_default();
        if let Some(pair) = self.narrow_phase.contact_pair(first, second) {
            points.extend(self.points_of(pair));
        }
        points
    }

    /// What the contacts of two bodies gave each in the parts of the last step but its last one.
    fn earlier_impulse(&self, pair: (u32, u32)) -> f64 {
        self.earlier_points.get(&pair).map_or(0.0, |points| points.iter().map(|p| p.impulse).sum())
    }

    /// The points of the last part.
    fn points_of(&self, pair: &ContactPair) -> Vec<SolvedPoint> {
        let Some((first, second)) = self.tags(pair) else { return Vec::new() };
        let poses = [first, second].map(|index| self.poses_before[index as usize]);
        let places = [pair.collider1, pair.collider2].map(|collider| {
            let place = self.colliders.get(collider).and_then(|c| c.position_wrt_parent());
            place.copied().unwrap_or(RapierPose::IDENTITY)
        });
        let turned = first > second;
        let points = solved(pair).map(|(manifold, point)| {
            let shapes = [manifold.subshape_pos1(), manifold.subshape_pos2()];
            let place = |k: usize, local: Vector| {
                let in_body = shapes[k].map_or(local, |shape| shape.transform_point(local));
                poses[k].world_from_body().apply(wide(places[k].transform_point(in_body)))
            };
            let [p, q] = [place(0, point.local_p1), place(1, point.local_p2)];
            let normal = wide(manifold.data.normal);
            SolvedPoint {
                point: 0.5 * (p + q),
                normal: if turned { -normal } else { normal },
                separation: (q - p).dot(normal),
                impulse: point.data.impulse.into(),
            }
        });
        points.collect()
    }

    /// Keeps what a part of the step did: the next one begins anew. What sleeps keeps what it had.
    pub(super) fn keep_points(&mut self) {
        let mut kept = std::mem::take(&mut self.earlier_points);
        for pair in self.narrow_phase.contact_pairs() {
            let awake = [pair.collider1, pair.collider2].into_iter().any(|collider| {
                let parent = self.colliders.get(collider).and_then(|c| c.parent());
                let body = parent.and_then(|parent| self.bodies.get(parent));
                body.is_some_and(|body| body.is_dynamic() && !body.is_sleeping())
            });
            if let Some((a, b)) = self.tags(pair).filter(|_| awake && impulse_of(pair) > 0.0) {
                kept.entry((a.min(b), a.max(b))).or_default().extend(self.points_of(pair));
            }
        }
        self.earlier_points = kept;
    }

    /// Points in the manifolds that rapier's solver saw in the last step.
    #[must_use]
    pub fn solver_contacts(&self) -> usize {
        self.narrow_phase
            .contact_pairs()
            .flat_map(|pair| pair.solver_manifolds())
            .map(|manifold| manifold.data.solver_contacts.len())
            .sum()
    }

    /// Pairs in rapier's contact graph.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.narrow_phase.contact_pairs().count()
    }

    /// How the contacts of the last step were found, with our detector; a pair counts once in each
    /// [part](Self::parts) of the step.
    #[must_use]
    pub fn pair_counts(&self) -> PairCounts {
        self.pair_counts
    }

    /// Seconds spent in contact detection, any detector, since this was last read.
    pub fn narrow_phase_seconds(&mut self) -> f64 {
        self.log.take_time().as_secs_f64()
    }

    /// Of the last step.
    #[must_use]
    pub fn timings_ms(&self) -> Timings {
        self.timings
    }

    /// Of rapier's last step.
    pub(super) fn timings_of_part(&self) -> Timings {
        let counters = &self.pipeline.counters;
        let reading = 1e3 * self.log.reading_time().as_secs_f64();
        Timings {
            broad: counters.cd.broad_phase_time.time_ms()
                + counters.cd.final_broad_phase_time.time_ms(),
            narrow: (counters.cd.narrow_phase_time.time_ms() - reading).max(0.0),
            reading,
            solver: counters.stages.solver_time.time_ms(),
            step: counters.step_time_ms(),
        }
    }
}

/// The impulses at the points that the solver had. A point that it did not have may still hold that
/// of a step before.
fn impulse_of(pair: &ContactPair) -> f64 {
    solved(pair).map(|(_, point)| f64::from(point.data.impulse)).sum()
}

/// The points that the solver had.
fn solved(pair: &ContactPair) -> impl Iterator<Item = (&ContactManifold, &TrackedPoint)> {
    pair.solver_manifolds().iter().flat_map(|manifold| {
        let contacts = manifold.data.solver_contacts.iter();
        contacts.filter_map(move |contact| {
            let id = contact.contact_id[0] & !NEW_CONTACT_BIT;
            Some((manifold, manifold.points.get(id as usize)?))
        })
    })
}
