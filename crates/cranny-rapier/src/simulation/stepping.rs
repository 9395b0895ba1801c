//! One step: in how many parts it is made, how far ahead it looks, and what it leaves behind.

use std::collections::HashSet;

use rapier3d::math::Real;
use rapier3d::prelude::IntegrationParameters;

use super::hooks::{Decisions, StepHooks};
use super::{BodyIndex, Simulation, Timings};
use crate::ahead::World;
use crate::convert::narrow;
use crate::detector::Detector;

impl Simulation {
    /// Advances by one step, which may be made in parts
    /// ([`most_parts`](super::SimulationOptions::most_parts)).
    pub fn step(&mut self) {
        self.step_with(&());
    }

    /// The same, with somebody who decides about pairs meanwhile
    /// ([`set_hooked`](Self::set_hooked) says about what).
    pub fn step_with(&mut self, hooks: &impl StepHooks) {
        let whole = self.parameters;
        let (parts, looked) = self.parts_needed();
        self.parts = parts;
        // A second look at an only part sees nothing new, unless motors change motions in between,
        // or what is fast has grown the boxes by which its neighbours are found.
        let is_calm = |looked: &IntegrationParameters| {
            looked.normalized_prediction_distance == whole.normalized_prediction_distance
        };
        let mut looked =
            looked.filter(|looked| parts == 1 && is_calm(looked) && self.reduced.is_empty());
        self.timings = Timings::default();
        self.earlier_points.clear();
        self.held_back = 0;
        for part in 0..self.parts {
            if part > 0 {
                self.keep_points();
            }
            self.parameters.dt = whole.dt / self.parts as Real;
            let iterations = whole.num_solver_iterations.div_ceil(self.parts);
            self.parameters.num_solver_iterations = iterations;
            self.advance(looked.take(), hooks);
            self.hold_back(hooks);
            self.timings = self.timings.plus(&self.timings_of_part());
        }
        self.parameters.dt = whole.dt;
        self.parameters.num_solver_iterations = whole.num_solver_iterations;
        self.joined = false;
        self.pair_counts = self.searches.take_counts();
        self.forget_parted();
    }

    /// How many parts the next step is made in, and what it [looks ahead](Self::looking_ahead) by,
    /// if that was needed to know.
    fn parts_needed(&mut self) -> (usize, Option<IntegrationParameters>) {
        // Before the first step the broad phase knows nobody's neighbours.
        let most = self.most_parts();
        if most == 1 || !self.settled {
            return (1, None);
        }
        let parameters = self.looking_ahead();
        let world =
            World { bodies: &self.bodies, colliders: &self.colliders, tagged: &self.tagged };
        let parts = self.motions.parts(&world, &mut self.broad_phase, &parameters, most);
        (parts, Some(parameters))
    }

    /// A step of rapier's; `looked`: by what it looks ahead, where that is known.
    fn advance(&mut self, looked: Option<IntegrationParameters>, hooks: &impl StepHooks) {
        self.log.begin_step();
        self.searches.begin_step();
        let poses: Vec<_> = self.indices().map(|index| (index, self.pose(index))).collect();
        for (BodyIndex(index), pose) in poses {
            self.poses_before[index as usize] = pose;
        }
        self.drive_joints();
        let parameters = looked.unwrap_or_else(|| self.looking_ahead());
        self.looked_ahead = parameters.prediction_distance();
        self.pipeline.step(
            narrow(self.options.gravity),
            &parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &Decisions(hooks),
            &(),
        );
    }

    /// In how many parts the last step was made.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// In how many parts a step is made at most: more than one with our detector only.
    #[must_use]
    pub fn most_parts(&self) -> usize {
        match self.options.detector {
            Detector::Cranny => self.options.most_parts.max(1),
            _ => 1,
        }
    }

    /// rapier's parameters, with a prediction distance as long as the longest reach of our pairs:
    /// rapier queries no farther, and the solver sees no farther.
    fn looking_ahead(&mut self) -> IntegrationParameters {
        let mut parameters = self.parameters;
        if self.options.detector != Detector::Cranny {
            return parameters;
        }
        let world =
            World { bodies: &self.bodies, colliders: &self.colliders, tagged: &self.tagged };
        let broad_phase = &mut self.broad_phase;
        let gravity = narrow(self.options.gravity);
        let ahead = self.motions.look(&world, broad_phase, &parameters, gravity, self.settled);
        self.settled = true;
        if let Some(ahead) = ahead {
            parameters.normalized_prediction_distance = ahead / parameters.length_unit;
        }
        parameters
    }

    /// How far ahead bodies were looked at in the last step, at most: rapier's prediction distance,
    /// as long as nothing fast is near anything. With our detector each pair has a reach of its
    /// own, up to this.
    #[must_use]
    pub fn prediction_distance(&self) -> f64 {
        self.looked_ahead.into()
    }

    /// Drops answers and searches of pairs that rapier no longer considers, whenever they are the
    /// greater part. rapier's broad phase decides when boxes have parted; without rapier
    /// `cranny-broad-phase` does (its `pairs`), and `World::update_pairs` forgets.
    fn forget_parted(&self) {
        if self.log.len().max(self.searches.len()) <= 2 * self.pair_count() {
            return;
        }
        let present: HashSet<(u32, u32)> =
            self.narrow_phase.contact_pairs().filter_map(|pair| self.tags(pair)).collect();
        self.log.retain(|first, second| present.contains(&(first, second)));
        self.searches.retain(|first, second| present.contains(&(first, second)));
    }
}
