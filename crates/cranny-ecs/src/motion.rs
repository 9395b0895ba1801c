//! How far bodies went and how often they turned, for a run's summary.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_transform::components::Transform;
use cranny_exact::{Aabb, DVec3, Pose};
use cranny_world::BodyId;
use cranny_world::description::BodyKind;
use glam::DQuat;

use crate::body::{Bodies, Body, BodyRecord, pose_of, widened};
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::properties::AngularVelocity;

/// A screw motion that a pair of bodies is meant to make: a nut on a bolt.
///
/// Right-handed about +z of the bolt's frame; so both threads must have their axes along z.
#[derive(Clone, Debug, PartialEq)]
pub struct Helix {
    /// The body in whose frame the motion is given.
    pub bolt: String,
    /// The body that moves along it.
    pub nut: String,
    /// Advance a turn, units of length, > 0.
    pub pitch: f64,
}

/// Motion of a body since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Which.
    pub body: BodyId,
    /// Of the body's origin, world coordinates.
    pub displacement: DVec3,
    /// The axis of its spin at the start, and turns about it since then (a step turns by less than
    /// half a turn). `None` where it did not spin.
    pub spin: Option<(DVec3, f64)>,
}

/// Motion of a pair that is meant to follow a [`Helix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelixMotion {
    /// In whose frame it is given.
    pub bolt: BodyId,
    /// What moves.
    pub nut: BodyId,
    /// Of the helix.
    pub pitch: f64,
    /// Of the nut about the bolt's axis.
    pub turns: f64,
    /// Of the nut along the bolt's axis, units of length.
    pub advance: f64,
    /// The greatest |advance − pitch x turns| so far, units of length.
    pub deviation_max: f64,
}

/// Follows bodies that can move.
#[derive(Resource, Clone, Debug)]
pub struct MotionLog {
    tracks: BTreeMap<BodyId, Track>,
    helices: Vec<HelixTrack>,
    region: Aabb,
    left: BTreeMap<BodyId, u64>,
}

#[derive(Clone, Debug)]
struct Track {
    start: DVec3,
    now: Pose,
    axis: Option<DVec3>,
    angle: f64,
    /// Nothing but physics moves it.
    is_dynamic: bool,
}

#[derive(Clone, Debug)]
struct HelixTrack {
    motion: HelixMotion,
    start_height: f64,
    rotation: DQuat,
    angle: f64,
}

impl Track {
    fn new(now: Pose, angular: DVec3, kind: BodyKind) -> Self {
        let axis = angular.try_normalize();
        let is_dynamic = kind == BodyKind::Dynamic;
        Self { start: now.translation, now, axis, angle: 0.0, is_dynamic }
    }
}

impl MotionLog {
    /// Of each body that can move, by id.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyMotion> {
        self.tracks.iter().map(|(&body, track)| BodyMotion {
            body,
            displacement: track.now.translation - track.start,
            spin: track.axis.map(|axis| (axis, track.angle / TAU)),
        })
    }

    /// What all bodies fill where they are put, grown by its own diagonal: the world. What leaves
    /// it has fallen through something, or shot away.
    /// What is led beyond it by a path or a velocity of its own has not.
    #[must_use]
    pub fn region(&self) -> Aabb {
        self.region.grown(self.region.diagonal())
    }

    /// Of each pair on a helix, in the order in which they were given.
    pub fn helices(&self) -> impl ExactSizeIterator<Item = HelixMotion> {
        self.helices.iter().map(|helix| helix.motion)
    }

    /// Dynamic bodies that were outside the [region](Self::region), removed since or not, and how
    /// many steps were completed when they first were.
    pub fn left(&self) -> impl ExactSizeIterator<Item = (BodyId, u64)> {
        self.left.iter().map(|(&body, &step)| (body, step))
    }

    pub(crate) fn has_left(&self, body: BodyId) -> bool {
        self.left.contains_key(&body)
    }

    fn note(&mut self, poses: &BTreeMap<BodyId, Pose>, steps: u64) {
        let region = self.region();
        for (id, track) in &mut self.tracks {
            let Some(pose) = poses.get(id) else { continue };
            if track.is_dynamic && !region.contains_point(pose.translation) {
                self.left.entry(*id).or_insert(steps);
            }
            if let Some(axis) = track.axis {
                track.angle += twist(pose.rotation * track.now.rotation.conjugate(), axis);
            }
            track.now = *pose;
        }
        for helix in &mut self.helices {
            let ends = (poses.get(&helix.motion.bolt), poses.get(&helix.motion.nut));
            if let (Some(bolt), Some(nut)) = ends {
                helix.note(bolt, nut);
            }
        }
    }
}

impl HelixTrack {
    fn new(bolt: BodyId, nut: BodyId, pitch: f64, poses: [&Pose; 2]) -> Self {
        let (rotation, start_height) = relative(poses[0], poses[1]);
        let motion = HelixMotion { bolt, nut, pitch, turns: 0.0, advance: 0.0, deviation_max: 0.0 };
        Self { motion, start_height, rotation, angle: 0.0 }
    }

    fn note(&mut self, bolt: &Pose, nut: &Pose) {
        let (rotation, height) = relative(bolt, nut);
        self.angle += twist(rotation * self.rotation.conjugate(), DVec3::Z);
        self.rotation = rotation;
        let motion = &mut self.motion;
        motion.turns = self.angle / TAU;
        motion.advance = height - self.start_height;
        let deviation = (motion.advance - motion.pitch * motion.turns).abs();
        motion.deviation_max = motion.deviation_max.max(deviation);
    }
}

/// Rotation of the nut in the bolt's frame, and its height along the bolt's axis.
fn relative(bolt: &Pose, nut: &Pose) -> (DQuat, f64) {
    let bolt_from_world = bolt.world_from_body().inverse();
    (bolt.rotation.conjugate() * nut.rotation, bolt_from_world.apply(nut.translation).z)
}

/// The part of a rotation that is about `axis`, radians within half a turn.
fn twist(rotation: DQuat, axis: DVec3) -> f64 {
    let sine = DVec3::new(rotation.x, rotation.y, rotation.z).dot(axis);
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    2.0 * (sign * sine).atan2(sign * rotation.w)
}

/// Puts the [`MotionLog`] in. Pairs on a helix are bodies that are there by then.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionPlugin {
    pub(crate) helices: Vec<Helix>,
}

impl Plugin for MotionPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(begin_track).add_observer(end_track);
        let bodies = app.world().resource::<Bodies>();
        let pose = |id: BodyId| {
            let entity = bodies.get(id)?.entity;
            app.world().get::<Transform>(entity).map(pose_of)
        };
        let helices = self.helices.iter().filter_map(|helix| {
            let (bolt, nut) = (bodies.find(&helix.bolt)?, bodies.find(&helix.nut)?);
            let poses = [&pose(bolt)?, &pose(nut)?];
            Some(HelixTrack::new(bolt, nut, helix.pitch, poses))
        });
        let tracks = bodies.iter().filter(|(_, record)| record.kind != BodyKind::Fixed);
        let tracks = tracks.filter_map(|(id, record)| {
            let angular = app.world().get::<AngularVelocity>(record.entity)?;
            Some((id, Track::new(pose(id)?, widened(angular.0), record.kind)))
        });
        let boxes = bodies.iter().filter_map(|(id, record)| Some(filled(record, &pose(id)?)));
        let log = MotionLog {
            tracks: tracks.collect(),
            helices: helices.collect(),
            region: boxes.fold(Aabb::EMPTY, |all, one| all.union(&one)),
            left: BTreeMap::new(),
        };
        app.insert_resource(log);
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                follow_motion.in_set(StepSystems::Report).in_set(CoreSystems::Motion),
            );
        }
    }
}

/// Where a body is. A half-space is everywhere, so nothing leaves a scene that has one.
fn filled(record: &BodyRecord, pose: &Pose) -> Aabb {
    record.shape.bounds(&pose.world_from_body())
}

fn begin_track(
    inserted: On<Insert<Body>>,
    placed: Query<(&Body, &Transform, &AngularVelocity)>,
    bodies: Res<Bodies>,
    mut log: ResMut<MotionLog>,
) {
    let Ok((&Body { id }, transform, angular)) = placed.get(inserted.entity) else { return };
    let (Some(record), pose) = (bodies.get(id), pose_of(transform)) else { return };
    log.region = log.region.union(&filled(record, &pose));
    if record.kind != BodyKind::Fixed {
        log.tracks.entry(id).or_insert_with(|| Track::new(pose, widened(angular.0), record.kind));
    }
}

fn end_track(removed: On<Remove<Body>>, bodies: Query<&Body>, mut log: ResMut<MotionLog>) {
    if let Ok(&Body { id }) = bodies.get(removed.entity) {
        log.tracks.remove(&id);
    }
}

fn follow_motion(
    bodies: Query<(&Body, &Transform)>,
    time: Res<SimulatedTime>,
    mut log: ResMut<MotionLog>,
) {
    let poses = bodies.iter().map(|(body, transform)| (body.id, pose_of(transform))).collect();
    log.note(&poses, time.steps());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted_beyond_one_and_backwards() {
        for per_step in [0.4, -0.4] {
            let mut pose = Pose::IDENTITY;
            let bolt = Pose {
                rotation: DQuat::from_xyzw(0.5, -0.5, 0.5, 0.5),
                translation: DVec3::new(1.0, 2.0, 3.0),
            };
            let mut track = HelixTrack::new(BodyId(0), BodyId(1), 2.0, [&bolt, &bolt]);
            for i in 1..=1000 {
                let angle = per_step * f64::from(i) * TAU;
                pose = bolt.compose(&Pose {
                    rotation: DQuat::from_scaled_axis(angle * DVec3::Z),
                    translation: DVec3::Z * (2.0 * angle / TAU + 0.125),
                });
                track.note(&bolt, &pose);
            }
            assert!((track.motion.turns - 1000.0 * per_step).abs() < 1e-9);
            assert!((track.motion.deviation_max - 0.125).abs() < 1e-9);
            assert!(pose.translation.length() > 100.0);
        }
    }

    #[test]
    fn rotation_about_another_axis_is_no_turn() {
        let about_x = DQuat::from_scaled_axis(DVec3::X);
        assert!(twist(about_x, DVec3::Z).abs() < 1e-15);
        assert!((twist(-about_x, DVec3::X) - 1.0).abs() < 1e-12);
    }
}
