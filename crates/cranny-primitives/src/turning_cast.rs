//! When a primitive and a model that travel and turn first meet.
//!
//! A face and a primitive are convex, so a plane across the way between their nearest points parts
//! them. Until their distance is spent by what moves them along its normal, they do not meet: by
//! steps of that length each face is followed on its own (conservative advancement). What slides
//! along a face, or turns about its normal, comes no nearer to it and takes one step.

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::{FaceId, Model};
use cranny_impact::Motion;

use crate::cast::each_face_on_the_way;
use crate::revolved::{LeastOnTriangle, Revolved};
use crate::sweep::Swept;

/// Steps beside one face. More: what turns closely above it takes long; fewer: it is left open.
const MOST_STEPS: usize = 1_000;

/// By what boxes are grown, as a share of the lengths involved. Smaller, and rounding of poses lets
/// a face be missed; larger, and more faces are looked at.
const BOX_ROUNDING: f64 = 1e-12;

/// A solid of revolution and a model on their ways.
pub(crate) struct TurningCast<'a> {
    pub(crate) model: &'a Model,
    pub(crate) of_model: Motion,
    /// In its body's frame.
    pub(crate) solid: &'a Revolved,
    pub(crate) own: Motion,
    /// How far a point of the solid is from the pivot of its motion, at most.
    pub(crate) reach: f64,
    /// How near surfaces are that count as meeting.
    pub(crate) tolerance: f64,
}

/// What comes of a face.
#[derive(Clone, Copy)]
struct Met {
    time: f64,
    /// `None` where it is unknown whether they meet.
    at: Option<Contact>,
}

#[derive(Clone, Copy)]
struct Contact {
    /// World coordinates.
    on_solid: DVec3,
    /// Unit, from the model to the solid.
    normal: DVec3,
}

impl TurningCast<'_> {
    /// Of two of which neither begins within the other; the model is the first.
    pub(crate) fn first(&self) -> Swept {
        let mut first: Option<Met> = None;
        each_face_on_the_way(
            self.model,
            1.0,
            |node| self.entry(node),
            |face| {
                let until = first.map_or(1.0, |met| met.time);
                first = self.meets(face, until).or(first);
                first.map_or(1.0, |met| met.time)
            },
        );
        match first {
            None => Swept::Free,
            Some(Met { time, at: Some(Contact { on_solid, normal }) }) => {
                Swept::Hit { time, point: on_solid, normal }
            }
            Some(Met { time, at: None }) => Swept::Open { free_before: time },
        }
    }

    /// When the solid, on its way, first reaches a node, at the earliest.
    fn entry(&self, node: u32) -> Option<f64> {
        let bounds = self.model.tree().node(node).bounds;
        let farthest = self.reach_of([bounds.center()]) + bounds.half_extents().length();
        let turned = self.of_model.turn.length() * farthest;
        let around = self.of_model.start.world_from_body().bounds(&bounds);
        let from = self.own.start.world_from_body().apply(self.own.pivot);
        let travel = self.own.travel - self.of_model.travel;
        let size = from.abs().max(around.min.abs()).max(around.max.abs()).max_element();
        let rounding = BOX_ROUNDING * (size + travel.length() + self.reach);
        around.grown(self.reach + turned + rounding).entered_at(from, from + travel)
    }

    /// How far points of the model's frame are from the pivot of its motion, at most.
    fn reach_of<const N: usize>(&self, points: [DVec3; N]) -> f64 {
        points.map(|point| point.distance(self.of_model.pivot)).into_iter().fold(0.0, f64::max)
    }

    /// When the solid meets a face, or that is unknown from, before a time.
    fn meets(&self, face: FaceId, until: f64) -> Option<Met> {
        let corners = self.model.mesh().triangle(face);
        let reach = self.reach_of(corners);
        let travel = self.own.travel - self.of_model.travel;
        let (mut time, mut tolerance) = (0.0, self.tolerance);
        for _ in 0..MOST_STEPS {
            let [of_model, own] = [&self.of_model, &self.own].map(|motion| motion.pose_at(time));
            let solid_from_model = own.inverse().compose(&of_model).world_from_body();
            let world_from_solid = own.world_from_body();
            let placed = corners.map(|corner| solid_from_model.apply(corner));
            let least = self.solid.least_on_triangle(&placed);
            let left = least.signed - self.solid.radius();
            let outward = self.solid.outward_at(&least);
            if time == 0.0 {
                // What is nearer than that already is not met by it.
                tolerance = tolerance.min(0.5 * left);
            }
            let normal = world_from_solid.apply_vector(outward);
            let turning = self.turning(normal, &world_from_solid)
                + turning_along(&self.of_model, normal) * reach;
            let closing = normal.dot(travel) + turning;
            if left <= tolerance {
                let at = self.contact(&least, outward, &world_from_solid);
                return Some(Met { time, at: Some(at) });
            }
            if closing <= 0.0 {
                return None;
            }
            time += (left - 0.5 * tolerance) / closing;
            if time >= until {
                return None;
            }
        }
        Some(Met { time, at: None })
    }

    /// How far a point of the solid moves along a direction by turning, at most. What turns about
    /// the solid's own axis is where it was.
    fn turning(&self, along: DVec3, world_from_solid: &RigidMap) -> f64 {
        let axis = world_from_solid.apply_vector(self.solid.axis());
        let from_axis = (self.own.pivot - self.solid.middle()).cross(self.solid.axis()).length();
        let beside = self.own.turn.cross(axis).length() * self.reach;
        let idle = self.own.turn.length() * from_axis;
        (turning_along(&self.own, along) * self.reach).min(beside + idle)
    }

    fn contact(
        &self,
        least: &LeastOnTriangle,
        outward: DVec3,
        world_from_solid: &RigidMap,
    ) -> Contact {
        let on_solid = least.on_core + outward * self.solid.radius();
        Contact {
            on_solid: world_from_solid.apply(on_solid),
            normal: -world_from_solid.apply_vector(outward),
        }
    }
}

/// How far a point moves along a direction by turning, at most, at distance 1 from the pivot: what
/// turns about the direction keeps its place along it.
pub(crate) fn turning_along(motion: &Motion, direction: DVec3) -> f64 {
    motion.turn.cross(direction).length()
}
