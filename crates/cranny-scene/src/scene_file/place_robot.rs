//! Robots in scenes: links become bodies, joints become joints.
//!
//! Links that fixed joints hold together are a *group*. A link with collision geometry is a body of
//! its own; one without adds its mass and its drawing to the group's *carrier*, the first link of
//! the group with geometry. A group without any is a body that meets nothing, if it has mass or if
//! joints beyond it move something. Joints are placed in the bodies that carry their links.

mod groups;
mod masses;
mod paths;
mod self_collisions;
mod semantics;

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_world::description::{
    BodyDescription, BodyKind, JointDescription, JointKind, JointPositions, Material, Mimic, Motor,
    Normals, StatedMass,
};

use self::groups::Groups;
use self::masses::{FRAME_SIZE, box_of, cube_of, inertia_box, moved, summed};
use self::paths::{MotorPaths, paths_of};
use super::assemble::{Assembly, is_mesh};
use super::motor_path::Drive;
use super::problem::{SceneError, SceneProblem};
use super::syntax::{RobotFile, effects};
use crate::robot::{LinkModels, Robot, read_robot};

/// Mass of a frame that moves and has neither mass nor geometry, kilograms. Smaller: what hangs on
/// it has no weight beside the last digits in single precision; larger: an arm feels it.
const FRAME_MASS: f64 = 1e-3;

/// Thickness of a flat shape whose box stands for its mass, as a share of the box's longest edge.
/// Smaller: it has hardly an inertia about its longest axis, and spins at a touch; larger: boxes of
/// thin plates that have a thickness get another.
const THINNEST: f64 = 1e-3;

/// Names that a warning lists.
const NAMED: usize = 8;

/// What carries a link: a body and where the link is in it.
#[derive(Clone, Copy)]
struct Carrier {
    body: usize,
    body_from_link: Pose,
}

pub(super) fn place(assembly: &mut Assembly<'_>, file: &RobotFile) -> Result<(), SceneError> {
    let source = assembly.source;
    let path = source.resolve(&file.path);
    let place = source.find("path", &file.path);
    if is_mesh(&path) {
        let what =
            format!("robots are URDF files, but {:?} is a mesh. Name it in `bodies`", file.path);
        return Err(source.error(place, SceneProblem::Contradiction(what)));
    }
    let mut robot = read_robot(&path)
        .map_err(|error| source.error(place.clone(), SceneProblem::Robot(error)))?;
    let mut warnings = robot.notes.clone();
    let name = file.name.clone().unwrap_or_else(|| robot.name.clone());
    let place = match &file.name {
        Some(name) => source.find("name", name),
        None => place,
    };
    if name.is_empty() {
        let problem = SceneProblem::Name { name, reason: "is empty" };
        return Err(source.error(place, problem));
    }
    if !assembly.robots.insert(name.clone()) {
        let what = format!(
            "two robots are called {name:?}: a robot without a `name` has that of its file. Give one another, as in (path: {:?}, name: \"second\")",
            file.path
        );
        return Err(source.error(place, SceneProblem::Contradiction(what)));
    }
    let refuse = |problem: String| {
        let what = format!("robot {name:?}: {problem}");
        source.error(place.clone(), SceneProblem::Contradiction(what))
    };
    let semantics = semantics::read(assembly, file, &robot, &mut warnings).map_err(refuse)?;
    let file = &semantics::with_motors_of_groups(file, &semantics, &robot).map_err(refuse)?;
    let paths = paths_of(file, &robot, &mut warnings).map_err(refuse)?;
    let mut positions =
        semantics::positions_of_state(&semantics, file, &robot, &mut warnings).map_err(refuse)?;
    positions.extend(paths.iter().map(|(joint, path)| (joint.clone(), path.position_at(0.0))));
    positions.extend(numbers(&file.positions));
    let targets = numbers(&file.targets);
    check_limits(&robot, "position", &positions).map_err(refuse)?;
    check_limits(&robot, "target", &targets).map_err(refuse)?;
    check_motors(&robot, file, &targets).map_err(refuse)?;
    let position_error = |wrong| {
        let problem = SceneProblem::Position { robot: name.clone(), source: wrong };
        source.error(place.clone(), problem)
    };
    robot.all_positions(&targets).map_err(position_error)?;
    let driven = file.motors.keys().chain(file.paths.keys());
    let driven = driven.map(|joint| (joint.clone(), 0.0)).collect();
    robot.all_positions(&driven).map_err(position_error)?;
    let moved = robot.clamp_to_limits(&mut positions);
    if !moved.is_empty() {
        warnings.push(format!(
            "0 is outside the limits of {}: they start at the nearer limit. `positions` says otherwise",
            listed(&moved)
        ));
    }
    let root_from_links = robot.forward_kinematics(&positions).map_err(position_error)?;
    let starts = robot.all_positions(&positions).map_err(position_error)?;
    if robot.collide_as_drawn() {
        warnings.push("no link has collision geometry: the visual meshes stand for it".to_owned());
    }
    let world_from_root = assembly.pose(&format!("robot {name:?}"), file.pose);
    let mut placing = Placing {
        robot: &robot,
        file,
        paths: &paths,
        name: &name,
        first: assembly.description.bodies.len(),
        groups: Groups::of(&robot),
        bodies: Vec::new(),
        weights: Vec::new(),
        joints: Vec::new(),
        carriers: vec![None; robot.links.len()],
        group_of_body: Vec::new(),
        link_of_body: Vec::new(),
        models: LinkModels::default(),
        warnings,
        unweighed: Vec::new(),
    };
    let world_from_links: Vec<Pose> =
        root_from_links.iter().map(|pose| world_from_root.compose(pose)).collect();
    placing.build(&world_from_links, &starts, &targets).map_err(refuse)?;
    let excluded = placing.excluded(&semantics.disabled_pairs).map_err(refuse)?;
    placing.warn_of_meetings(&world_from_root, &positions, &excluded).map_err(refuse)?;
    for (group, members) in placing.bodies_of_groups(&semantics) {
        assembly.groups.entry(format!("{name}/{group}")).or_insert(members);
    }
    let Placing { bodies, joints, warnings, .. } = placing;
    assembly.description.bodies.extend(bodies);
    assembly.description.joints.extend(joints);
    assembly.description.excluded_pairs.extend(excluded);
    assembly.warnings.extend(warnings.iter().map(|what| format!("{}: {what}", path.display())));
    robot.files.into_iter().for_each(|file| assembly.add_file(file));
    Ok(())
}

fn numbers(values: &BTreeMap<String, super::values::Finite>) -> JointPositions {
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

/// Fails if a motor leads its joint outside its limits, or elsewhere than the joint's target.
fn check_motors(robot: &Robot, file: &RobotFile, targets: &JointPositions) -> Result<(), String> {
    file.motors.keys().try_for_each(|name| {
        let limits = robot.joint(name).and_then(|joint| robot.joints[joint].limits());
        let drive = file.drive(name, targets.get(name).copied());
        drive.check_position(limits).map_err(|what| format!("joint {name:?}: {what}"))
    })
}

impl RobotFile {
    /// What is to lead a joint.
    fn drive(&self, joint: &str, target: Option<f64>) -> Drive<'_> {
        Drive { motor: self.motors.get(joint), target, path: self.paths.get(joint) }
    }
}

/// How many pairs meet, as the beginning of a sentence.
fn pairs_that_meet(count: usize) -> String {
    match count {
        1 => "1 pair of links meets".to_owned(),
        _ => format!("{count} pairs of links meet"),
    }
}

/// Names as a sentence has them.
fn listed(names: &[String]) -> String {
    let mut shown: Vec<String> = names.iter().take(NAMED).map(|name| format!("{name:?}")).collect();
    if names.len() > NAMED {
        shown.push(format!("{} more", names.len() - NAMED));
    }
    shown.join(", ")
}

struct Placing<'a> {
    robot: &'a Robot,
    file: &'a RobotFile,
    /// By joint.
    paths: &'a MotorPaths,
    name: &'a str,
    /// Index of the robot's first body in the scene.
    first: usize,
    groups: Groups,
    bodies: Vec<BodyDescription>,
    /// By body: masses that it is made of, in its frame.
    weights: Vec<Vec<StatedMass>>,
    joints: Vec<JointDescription>,
    /// By link.
    carriers: Vec<Option<Carrier>>,
    /// By body of the robot.
    group_of_body: Vec<usize>,
    link_of_body: Vec<usize>,
    models: LinkModels,
    warnings: Vec<String>,
    /// Dynamic links that weigh what their solid weighs, since the file states no mass.
    unweighed: Vec<String>,
}

impl Placing<'_> {
    fn build(
        &mut self,
        world_from_links: &[Pose],
        starts: &[f64],
        targets: &JointPositions,
    ) -> Result<(), String> {
        let root = self.robot.root;
        let links: Vec<usize> = std::iter::once(root)
            .chain(self.robot.joints_from_root().iter().map(|&i| self.robot.joints[i].child))
            .collect();
        // A carrier may lie below links that it carries: bodies come first.
        for &link in &links {
            if self.groups.has_body(self.robot, link) {
                self.add_body(link, world_from_links[link])?;
            }
        }
        if self.bodies.is_empty() {
            return Err("none of its links has geometry or mass. Nothing can meet it".to_owned());
        }
        for &link in &links {
            self.carry(link);
        }
        for &link in &links {
            self.weigh(link)?;
        }
        for &link in &links {
            self.join(link, starts, targets);
        }
        self.settle_masses()?;
        self.warn_of_ghosts();
        Ok(())
    }

    fn is_base(&self, group: usize) -> bool {
        group == self.groups.group_of[self.robot.root] && self.file.fixed_base
    }

    fn add_body(&mut self, link: usize, pose: Pose) -> Result<(), String> {
        let described = &self.robot.links[link];
        let group = self.groups.group_of[link];
        let (collision, layers) = match &described.collision {
            Some(mesh) => (Arc::clone(mesh), self.file.layers.clone()),
            // It meets nothing; what it looks like says how heavy it is.
            None => (Arc::new(inertia_box(described.inertial.as_ref())?), Vec::new()),
        };
        let shape = match described.primitive {
            Some(primitive) => primitive.into(),
            None => self.model(&collision, &described.name)?.into(),
        };
        self.carriers[link] =
            Some(Carrier { body: self.first + self.bodies.len(), body_from_link: Pose::IDENTITY });
        self.group_of_body.push(group);
        self.link_of_body.push(link);
        self.weights.push(Vec::new());
        self.bodies.push(BodyDescription {
            name: format!("{}/{}", self.name, described.name),
            collision,
            shape: Some(shape),
            visual: described.visual.clone(),
            color: described.color,
            kind: if self.is_base(group) { BodyKind::Fixed } else { BodyKind::Dynamic },
            pose,
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            path: None,
            tracker: None,
            material: Material::from(self.file.material),
            mass: None,
            // What is no mesh has no facets to smooth.
            normals: match described.primitive {
                Some(_) => Normals::Flat,
                None => self.file.normals.into(),
            },
            sensor: false,
            layers,
            effects: effects(&self.file.effects),
        });
        Ok(())
    }

    /// Says what carries a link that is no body of its own.
    fn carry(&mut self, link: usize) {
        let group = self.groups.group_of[link];
        if self.carriers[link].is_some() || !self.groups.present[group] {
            return;
        }
        let carrier = self.groups.carrier[group];
        let from_top = |of: usize| self.top_from_link(of);
        let parent = self.groups.above[link].map(|joint| &self.robot.joints[joint]);
        let over = parent
            .filter(|joint| joint.kind == JointKind::Fixed)
            .and_then(|joint| Some((self.carriers[joint.parent]?, joint.parent_from_joint)));
        self.carriers[link] = match over {
            Some((over, parent_from_link)) => {
                let body_from_link = over.body_from_link.compose(&parent_from_link);
                Some(Carrier { body_from_link, ..over })
            }
            // The carrier lies below.
            None => self.carriers[carrier].map(|body| Carrier {
                body_from_link: from_top(carrier).inverse().compose(&from_top(link)),
                ..body
            }),
        };
    }

    /// Where a link is in the first one of its group.
    fn top_from_link(&self, link: usize) -> Pose {
        let (mut at, mut pose) = (link, Pose::IDENTITY);
        while at != self.groups.top[self.groups.group_of[link]] {
            let Some(joint) = self.groups.above[at].map(|joint| &self.robot.joints[joint]) else {
                break;
            };
            pose = joint.parent_from_joint.compose(&pose);
            at = joint.parent;
        }
        pose
    }

    /// The prepared model of a mesh.
    fn model(&mut self, mesh: &Arc<Mesh>, link: &str) -> Result<Model, String> {
        self.models.of(mesh, link).map_err(|error| error.to_string())
    }

    /// Adds a link's mass, and what it looks like, to the body that carries it.
    fn weigh(&mut self, link: usize) -> Result<(), String> {
        let Some(Carrier { body, body_from_link }) = self.carriers[link] else { return Ok(()) };
        let body = body - self.first;
        let described = &self.robot.links[link];
        if let Some(stated) = self.stated(link)? {
            self.weights[body].push(moved(&stated, &body_from_link));
        }
        if self.link_of_body[body] != link
            && let Some(visual) = &described.visual
        {
            self.bodies[body].color = self.bodies[body].color.or(described.color);
            let carrier = self.link_of_body[body];
            let before = self.bodies[body].visual.take();
            let before = before.or_else(|| self.robot.links[carrier].collision.clone());
            let world = body_from_link.world_from_body();
            let vertices = visual.vertices().iter().map(|&p| world.apply(p)).collect();
            let placed = Mesh::new(vertices, visual.faces().to_vec())
                .map_err(|error| format!("the visual of link {:?}: {error}", described.name))?;
            self.bodies[body].visual = Some(Arc::new(match before {
                Some(before) => Mesh::clone(&before).joined(&placed),
                None => placed,
            }));
        }
        Ok(())
    }

    /// The mass of a link in its frame: as the file has it, or with the inertia of its shape; from
    /// its shape where the file has none.
    fn stated(&mut self, link: usize) -> Result<Option<StatedMass>, String> {
        let described = &self.robot.links[link];
        if described.inertial.is_some() {
            return Ok(described.inertial);
        }
        let name = &described.name;
        let Some(mesh) = &described.collision else {
            // A mass without inertia and shape: as a small cube.
            return Ok(described.mass.map(|mass| cube_of(mass, FRAME_SIZE, DVec3::ZERO)));
        };
        let model = self.model(&Arc::clone(mesh), name)?;
        let density = self.file.material.density();
        let solid = match described.primitive {
            Some(primitive) => primitive.mass_properties(),
            None => model.mass_properties().copied(),
        };
        let solid = solid.filter(|solid| solid.volume > 0.0);
        let by_volume = |volume: f64| described.mass.map_or(density, |mass| mass / volume);
        if let Some(solid) = solid {
            if described.mass.is_none() && self.moves(link) {
                self.unweighed.push(name.clone());
            }
            let density = by_volume(solid.volume);
            return Ok(Some(StatedMass {
                mass: density * solid.volume,
                center: solid.center,
                inertia: solid.inertia * density,
            }));
        }
        let bounds = model.bounds();
        let edges = bounds.max - bounds.min;
        let edges = edges.max(DVec3::splat(THINNEST * edges.max_element()));
        let density = by_volume(edges.x * edges.y * edges.z);
        let mass = density * edges.x * edges.y * edges.z;
        let what = match described.mass {
            Some(_) => "its inertia is",
            None => "its mass and inertia are",
        };
        self.warnings.push(format!(
            "link {name:?} states no usable inertia and its collision mesh is not closed: {what} that of its bounding box ({mass:.4} kg). Give it an element 'inertial'"
        ));
        Ok(Some(box_of(mass, edges, bounds.center())))
    }

    /// Joins the body of a link, if it has one, to what carries the link above.
    fn join(&mut self, link: usize, starts: &[f64], targets: &JointPositions) {
        let groups = &self.groups;
        if !groups.has_body(self.robot, link) {
            return;
        }
        let group = groups.group_of[link];
        // A carrier hangs on the joint above its group, the others on the link above them.
        let hung = if groups.carrier[group] == link { groups.top[group] } else { link };
        let Some(index) = groups.above[hung] else { return };
        let joint = &self.robot.joints[index];
        let (Some(parent), Some(carried)) = (self.carriers[joint.parent], self.carriers[hung])
        else {
            return;
        };
        let Some(own) = self.carriers[link] else { return };
        if joint.kind == JointKind::Floating || parent.body == own.body {
            return;
        }
        let in_scene = |name: &str| format!("{}/{name}", self.name);
        let child_anchor = if hung == link { Pose::IDENTITY } else { carried.body_from_link };
        let start = starts[index];
        self.joints.push(JointDescription {
            name: in_scene(&joint.name),
            parent: parent.body,
            child: own.body,
            parent_anchor: parent.body_from_link.compose(&joint.parent_from_joint),
            child_anchor,
            kind: joint.kind,
            mimic: joint
                .mimic
                .as_ref()
                .map(|mimic| Mimic { joint: in_scene(&mimic.joint), ..mimic.clone() }),
            motor: self.motor(index, start, targets),
            path: self.paths.get(&joint.name).cloned(),
            resistance: joint.resistance,
            reduced: true,
            start,
        });
    }

    /// What drives a joint: what the scene says, else what holds it.
    fn motor(&self, index: usize, start: f64, targets: &JointPositions) -> Option<Motor> {
        let joint = &self.robot.joints[index];
        if !joint.has_position() {
            return None;
        }
        if joint.mimic.is_some() {
            // It follows within its own effort.
            return joint
                .max_effort
                .map(|most| Motor { max_effort: Some(most), ..Motor::default() });
        }
        let limited = Motor {
            max_effort: joint.max_effort,
            max_velocity: joint.max_velocity,
            ..Motor::default()
        };
        let drive = self.file.drive(&joint.name, targets.get(&joint.name).copied());
        let path = self.paths.get(&joint.name).map(|path| &**path);
        drive.motor(limited, path, self.file.hold.then_some(start))
    }

    /// Whether the solver moves the body that carries a link.
    fn moves(&self, link: usize) -> bool {
        let body = self.carriers[link].map(|carrier| carrier.body - self.first);
        body.is_some_and(|body| self.bodies[body].kind == BodyKind::Dynamic)
    }

    /// Gives each body the mass of all that it is made of.
    fn settle_masses(&mut self) -> Result<(), String> {
        let mut weightless = Vec::new();
        for (body, weights) in self.bodies.iter_mut().zip(&self.weights) {
            let mass = summed(weights);
            if body.kind != BodyKind::Dynamic {
                continue;
            }
            if mass.is_none() {
                weightless.push(body.name.clone());
            }
            body.mass = Some(mass.unwrap_or_else(|| cube_of(FRAME_MASS, FRAME_SIZE, DVec3::ZERO)));
        }
        if !self.unweighed.is_empty() {
            self.warnings.push(format!(
                "links without a stated mass weigh what their collision geometry weighs at density {} (`material` of the robot says another; an element 'inertial' states the mass): {}",
                self.file.material.density(),
                listed(&self.unweighed)
            ));
        }
        if !weightless.is_empty() {
            self.warnings.push(format!(
                "{} move and have neither mass nor geometry: each weighs {FRAME_MASS} kg. Give them an element 'inertial'",
                listed(&weightless)
            ));
        }
        Ok(())
    }

    fn warn_of_ghosts(&mut self) {
        let ghosts: Vec<String> = self
            .link_of_body
            .iter()
            .map(|&link| &self.robot.links[link])
            .filter(|link| link.collision.is_none())
            .map(|link| link.name.clone())
            .collect();
        if !ghosts.is_empty() {
            self.warnings.push(format!(
                "links without collision geometry have mass and meet nothing: {}",
                listed(&ghosts)
            ));
        }
        let left_out: Vec<String> = self
            .robot
            .joints
            .iter()
            .filter(|joint| joint.kind != JointKind::Fixed && self.carriers[joint.child].is_none())
            .map(|joint| joint.name.clone())
            .collect();
        if !left_out.is_empty() {
            self.warnings.push(format!(
                "joints were left out, since nothing beyond them has mass or geometry: {}",
                listed(&left_out)
            ));
        }
    }
}
