//! A robot at many configurations, as every contestant sees it.

use std::io;
use std::path::Path;

use cranny_exact::{Aabb, DQuat, DVec3, Pose};
use cranny_primitives::{BodyShape, Primitive};
use cranny_scene::Robot;
use cranny_scene::robot::{RobotJoint, read_robot, read_semantics};
use cranny_world::description::JointPositions;
use cranny_world::{Arrangement, Random, world_box};
use serde_json::{Value, json};

/// Seed of all configurations.
const SEED: u64 = 2026;

/// Half the range of a joint without limits, radians.
const HALF_TURN: f64 = std::f64::consts::PI;

/// Configurations from one random configuration to the next, in motion. Fewer: what is remembered
/// helps less than it does a planner, which checks edges at about 0.02 rad. More: less is seen of
/// the robot.
const STEPS: usize = 50;

/// How configurations follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Course {
    /// Each is random.
    Random,
    /// From one random configuration to the next in [`STEPS`] steps.
    Motion,
}

impl Course {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Motion => "motion",
        }
    }
}

/// A robot with the pairs of its links that are checked.
pub(super) struct RobotCell {
    pub(super) robot: Robot,
    pub(super) shapes: Vec<Option<BodyShape>>,
    pub(super) pairs: Vec<(usize, usize)>,
}

impl RobotCell {
    /// Reads a URDF file, and an SRDF file whose pairs are left out.
    ///
    /// # Errors
    ///
    /// What the readers refuse.
    pub(super) fn read(urdf: &Path, srdf: Option<&Path>) -> io::Result<Self> {
        let mut robot = read_robot(urdf).map_err(io::Error::other)?;
        robot.collide_as_drawn();
        let disabled = match srdf {
            Some(path) => {
                read_semantics(&std::fs::read_to_string(path)?).map_err(io::Error::other)?
            }
            None => Default::default(),
        };
        let shapes = robot.link_shapes().map_err(io::Error::other)?;
        shapes.iter().flatten().filter_map(BodyShape::model).for_each(|model| {
            model.clusters();
        });
        let links = Arrangement::new(shapes.clone(), robot.checked_pairs(&disabled.disabled_pairs));
        let pairs = links.pairs().collect();
        Ok(Self { robot, shapes, pairs })
    }

    pub(super) fn links(&self) -> Arrangement {
        Arrangement::new(self.shapes.clone(), self.pairs.iter().copied())
    }

    /// Returns the poses of all links at reproducible configurations.
    ///
    /// # Errors
    ///
    /// Positions that the robot does not take.
    pub(super) fn poses(&self, course: Course, count: usize) -> io::Result<Vec<Vec<Pose>>> {
        let mut random = Random::new(SEED);
        let mut ends = [self.configuration(&mut random), self.configuration(&mut random)];
        let poses = (0..count).map(|k| {
            let positions = match course {
                Course::Random => self.configuration(&mut random),
                Course::Motion => {
                    let step = k % STEPS;
                    if step == 0 && k > 0 {
                        ends = [ends[1].clone(), self.configuration(&mut random)];
                    }
                    between(&ends, step as f64 / STEPS as f64)
                }
            };
            self.robot.forward_kinematics(&positions).map_err(io::Error::other)
        });
        poses.collect()
    }

    fn configuration(&self, random: &mut Random) -> JointPositions {
        let is_free = |joint: &&RobotJoint| joint.has_position() && joint.mimic.is_none();
        let joints = self.robot.joints.iter().filter(is_free);
        let position = |joint: &RobotJoint| {
            let [low, high] = joint.limits().unwrap_or([-HALF_TURN, HALF_TURN]);
            let share = 0.5 + 0.5 * random.signed();
            (joint.name.clone(), low + share * (high - low))
        };
        joints.map(position).collect()
    }
}

fn between([from, to]: &[JointPositions; 2], share: f64) -> JointPositions {
    from.iter().map(|(name, q)| (name.clone(), q + share * (to[name] - q))).collect()
}

/// A cell at the configurations of a course.
pub(super) struct RobotStage<'a> {
    pub(super) cell: &'a RobotCell,
    pub(super) poses: Vec<Vec<Pose>>,
}

impl RobotStage<'_> {
    /// The first line for the peers.
    pub(super) fn given(&self) -> Value {
        let links: Vec<Value> = self.cell.shapes.iter().map(link).collect();
        let frames: Vec<Value> = self.poses.iter().map(|poses| self.frame(poses)).collect();
        json!({ "links": links, "frames": frames })
    }

    fn frame(&self, poses: &[Pose]) -> Value {
        let placed = self.cell.shapes.iter().zip(poses);
        let boxes: Vec<Aabb> = placed
            .map(|(shape, pose)| shape.as_ref().map_or(Aabb::EMPTY, |s| world_box(s, pose, 0.0)))
            .collect();
        let pairs = || self.cell.pairs.iter().copied();
        let near: Vec<_> = pairs().filter(|&(a, b)| boxes[a].overlaps(&boxes[b])).collect();
        let bound =
            |(a, b): (usize, usize)| (a, b, boxes[a].distance_squared_lower(&boxes[b]).sqrt());
        let mut order: Vec<_> = pairs().map(bound).collect();
        order.sort_by(|x, y| x.2.total_cmp(&y.2));
        let poses: Vec<_> = poses.iter().map(Pose::to_row_major).collect();
        json!({ "poses": poses, "near": near, "order": order })
    }
}

fn link(shape: &Option<BodyShape>) -> Value {
    let round = |kind: &str, center: DVec3, axis: DVec3, radius: f64, length: f64| {
        let rotation = DQuat::from_rotation_arc(DVec3::Z, axis.normalize_or(DVec3::Z));
        let pose = Pose { rotation, translation: center }.to_row_major();
        json!({ "kind": kind, "radius": radius, "length": length, "pose": pose })
    };
    match shape {
        None => Value::Null,
        Some(BodyShape::Primitive(Primitive::Ball(ball))) => {
            round("ball", ball.center, DVec3::Z, ball.radius, 0.0)
        }
        Some(BodyShape::Primitive(Primitive::Capsule(capsule))) => {
            let [from, to] = capsule.ends;
            let length = (to - from).length();
            round("capsule", 0.5 * (from + to), to - from, capsule.radius, length)
        }
        Some(BodyShape::Primitive(Primitive::Cylinder(cylinder))) => {
            let length = 2.0 * cylinder.half_height;
            round("cylinder", cylinder.center, cylinder.axis, cylinder.radius, length)
        }
        // URDF has no other primitives.
        Some(BodyShape::Primitive(_)) => Value::Null,
        Some(BodyShape::Model(model)) => {
            let mesh = model.mesh();
            let vertices: Vec<_> = mesh.vertices().iter().map(|p| p.to_array()).collect();
            json!({ "vertices": vertices, "faces": mesh.faces() })
        }
    }
}
