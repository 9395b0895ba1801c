//! Robots in scenes: links become bodies, joints become joints.
//!
//! A body needs collision geometry. A link without any is carried by the nearest ancestor with
//! geometry, as long as fixed joints lead there: its joints are then anchored to that body. Links
//! held together by fixed joints, and links that a joint joins, are excluded from meeting.

use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::MassProperties;
use cranny_world::description::{
    BodyDescription, BodyKind, JointDescription, JointKind, JointPositions, Material, Mimic,
};

use super::assemble::{Assembly, is_mesh};
use super::problem::{SceneError, SceneProblem};
use super::syntax::{RobotFile, effects};
use crate::robot::{Robot, read_robot};

/// What carries a link: a body and where the link is in it.
#[derive(Clone, Copy)]
struct Carrier {
    body: usize,
    body_from_link: Pose,
}

pub(super) fn place(assembly: &mut Assembly<'_>, file: &RobotFile) -> Result<(), SceneError> {
    let path = assembly.source.resolve(&file.path);
    let place = assembly.source.find("path", &file.path);
    if is_mesh(&path) {
        let what =
            format!("robots are URDF files, but {:?} is a mesh. Name it in `bodies`", file.path);
        return Err(assembly.source.error(place, SceneProblem::Contradiction(what)));
    }
    let robot = read_robot(&path)
        .map_err(|error| assembly.source.error(place.clone(), SceneProblem::Robot(error)))?;
    let name = file.name.clone().unwrap_or_else(|| robot.name.clone());
    let place = match &file.name {
        Some(name) => assembly.source.find("name", name),
        None => place,
    };
    let refuse = |problem: String| {
        let what = format!("robot {name:?}: {problem}");
        assembly.source.error(place.clone(), SceneProblem::Contradiction(what))
    };
    let positions = numbers(&file.positions);
    let targets = numbers(&file.targets);
    check_limits(&robot, "position", &positions).map_err(refuse)?;
    check_limits(&robot, "target", &targets).map_err(refuse)?;
    let position_error = |source| {
        let problem = SceneProblem::Position { robot: name.clone(), source };
        assembly.source.error(place.clone(), problem)
    };
    let root_from_links = robot.forward_kinematics(&positions).map_err(position_error)?;
    robot.all_positions(&targets).map_err(position_error)?;

    let world_from_root = Pose::from(file.pose);
    let first = assembly.description.bodies.len();
    let mut placing = Placing {
        robot: &robot,
        file,
        name: &name,
        first,
        bodies: Vec::new(),
        joints: Vec::new(),
        carriers: vec![None; robot.links.len()],
        rigid: Vec::new(),
        notes: Vec::new(),
    };
    let world_from_links: Vec<Pose> =
        root_from_links.iter().map(|pose| world_from_root.compose(pose)).collect();
    placing.build(&world_from_links, &positions, &targets).map_err(refuse)?;
    let Placing { bodies, joints, rigid, notes, .. } = placing;
    let excluded = excluded(first, &rigid, &joints);
    assembly.description.bodies.extend(bodies);
    assembly.description.joints.extend(joints);
    assembly.description.excluded_pairs.extend(excluded);
    let heard = robot.notes.iter().cloned().chain(notes);
    assembly.notes.extend(heard.map(|note| format!("{}: {note}", path.display())));
    robot.files.into_iter().for_each(|file| assembly.add_file(file));
    Ok(())
}

fn numbers(values: &std::collections::BTreeMap<String, super::values::Finite>) -> JointPositions {
    values.iter().map(|(name, value)| (name.clone(), value.0)).collect()
}

fn check_limits(robot: &Robot, what: &str, positions: &JointPositions) -> Result<(), String> {
    for (name, &value) in positions {
        let limits = robot.joint(name).and_then(|joint| robot.joints[joint].limits());
        if let Some([low, high]) = limits.filter(|[low, high]| !(low..=high).contains(&&value)) {
            return Err(format!(
                "the {what} {value} of joint {name:?} is outside its limits, {low} to {high}"
            ));
        }
    }
    Ok(())
}

struct Placing<'a> {
    robot: &'a Robot,
    file: &'a RobotFile,
    name: &'a str,
    /// Index of the robot's first body in the scene.
    first: usize,
    bodies: Vec<BodyDescription>,
    joints: Vec<JointDescription>,
    /// By link.
    carriers: Vec<Option<Carrier>>,
    /// By body of the robot: the first body that fixed joints hold it to.
    rigid: Vec<usize>,
    notes: Vec<String>,
}

impl Placing<'_> {
    fn build(
        &mut self,
        world_from_links: &[Pose],
        positions: &JointPositions,
        targets: &JointPositions,
    ) -> Result<(), String> {
        let root = self.robot.root;
        self.add_body(root, world_from_links[root], None);
        for &index in self.robot.joints_from_root() {
            let joint = &self.robot.joints[index];
            let parent = self.carriers[joint.parent];
            let fixed = joint.kind == JointKind::Fixed;
            let has_body = self.robot.links[joint.child].collision.is_some();
            match (parent, has_body) {
                (Some(carrier), true) => {
                    let group = fixed.then(|| self.rigid[carrier.body - self.first]);
                    self.add_body(joint.child, world_from_links[joint.child], group);
                    self.add_joint(index, carrier, positions, targets);
                }
                (Some(carrier), false) if fixed => {
                    let parent_from_child = joint.parent_from_joint;
                    let body_from_link = carrier.body_from_link.compose(&parent_from_child);
                    self.carriers[joint.child] = Some(Carrier { body_from_link, ..carrier });
                }
                // Nothing of the robot is left behind: what is fixed to a root without geometry
                // becomes the base.
                (None, true) if fixed && self.bodies.is_empty() => {
                    self.add_body(joint.child, world_from_links[joint.child], None);
                }
                (None, true) if fixed && self.file.fixed_base => {
                    self.add_body(joint.child, world_from_links[joint.child], Some(0));
                }
                (None, false) if fixed => {}
                (_, false) if self.carries_nothing(joint.child) => self.notes.push(format!(
                    "joint {:?} was left out: nothing beyond it has collision geometry",
                    joint.name
                )),
                _ => {
                    let link = if has_body { joint.parent } else { joint.child };
                    return Err(format!(
                        "link {:?} has no collision geometry, but joint {:?} moves between it and links that have some. Give it a collision element",
                        self.robot.links[link].name, joint.name
                    ));
                }
            }
        }
        if self.bodies.is_empty() {
            return Err("none of its links has collision geometry. Nothing can meet it".to_owned());
        }
        Ok(())
    }

    /// `group` is the rigid group that a fixed joint puts it in.
    fn add_body(&mut self, link: usize, pose: Pose, group: Option<usize>) {
        let described = &self.robot.links[link];
        let Some(collision) = &described.collision else { return };
        let index = self.bodies.len();
        let group = group.unwrap_or(index);
        let in_base = group == 0 && self.file.fixed_base;
        let mut material = Material::from(self.file.material);
        if let Some(mass) = described.mass {
            let volume = MassProperties::of(collision).volume.abs();
            let density = mass / volume;
            if density.is_normal() {
                material.density = density;
            } else {
                self.notes.push(format!(
                    "link {:?} has a mass but no volume: the robot's density is used",
                    described.name
                ));
            }
        }
        self.rigid.push(group);
        self.carriers[link] =
            Some(Carrier { body: self.first + index, body_from_link: Pose::IDENTITY });
        self.bodies.push(BodyDescription {
            name: format!("{}/{}", self.name, described.name),
            collision: Arc::clone(collision),
            visual: described.visual.clone(),
            kind: if in_base { BodyKind::Fixed } else { BodyKind::Dynamic },
            pose,
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            material,
            normals: self.file.normals.into(),
            layers: self.file.layers.clone(),
            effects: effects(&self.file.effects),
        });
    }

    /// Joins the body added last to what carries its parent.
    fn add_joint(
        &mut self,
        index: usize,
        parent: Carrier,
        positions: &JointPositions,
        targets: &JointPositions,
    ) {
        let joint = &self.robot.joints[index];
        let in_scene = |name: &str| format!("{}/{name}", self.name);
        let free = joint.kind != JointKind::Fixed && joint.mimic.is_none();
        let start = positions.get(&joint.name).copied().unwrap_or(0.0);
        let held = (free && self.file.hold).then_some(start);
        self.joints.push(JointDescription {
            name: in_scene(&joint.name),
            parent: parent.body,
            child: self.first + self.bodies.len() - 1,
            parent_anchor: parent.body_from_link.compose(&joint.parent_from_joint),
            child_anchor: Pose::IDENTITY,
            kind: joint.kind,
            mimic: joint
                .mimic
                .as_ref()
                .map(|mimic| Mimic { joint: in_scene(&mimic.joint), ..mimic.clone() }),
            target: targets.get(&joint.name).copied().or(held),
        });
    }

    fn carries_nothing(&self, link: usize) -> bool {
        let mut children = self.robot.joints.iter().filter(|joint| joint.parent == link);
        self.robot.links[link].collision.is_none()
            && children.all(|joint| self.carries_nothing(joint.child))
    }
}

/// Pairs of scene bodies that never meet: of one rigid group, or joined by a joint.
fn excluded(first: usize, rigid: &[usize], joints: &[JointDescription]) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> =
        joints.iter().map(|j| (j.parent.min(j.child), j.parent.max(j.child))).collect();
    for (i, group) in rigid.iter().enumerate() {
        let same = (0..i).filter(|&j| rigid[j] == *group);
        pairs.extend(same.map(|j| (first + j, first + i)));
    }
    pairs
}
