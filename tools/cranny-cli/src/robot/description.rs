//! What a robot file holds.

use std::path::Path;

use cranny_primitives::Primitive;
use cranny_scene::Robot;
use cranny_scene::robot::{RobotJoint, RobotLink};
use cranny_world::Arrangement;
use cranny_world::description::JointKind;
use serde::Serialize;

use crate::words::counted;

/// A robot, as it was read.
#[derive(Debug, Serialize)]
pub(super) struct Description {
    version: u32,
    file: String,
    robot: String,
    root: String,
    links: Vec<LinkDescription>,
    joints: Vec<JointDescription>,
    /// Pairs of links that are checked against each other.
    checked_pairs: usize,
    mass: f64,
    /// What was mended, left out or replaced.
    pub(super) notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct LinkDescription {
    name: String,
    /// Of the mesh that collides.
    faces: Option<usize>,
    /// What collides in place of a mesh: "ball".
    primitive: Option<&'static str>,
    mass: Option<f64>,
    /// Whether the file states an inertia that a body can have.
    inertia: bool,
}

#[derive(Debug, Serialize)]
struct JointDescription {
    name: String,
    kind: &'static str,
    parent: String,
    child: String,
    axis: Option<[f64; 3]>,
    limits: Option<[f64; 2]>,
    max_effort: Option<f64>,
    max_velocity: Option<f64>,
    damping: f64,
    friction: f64,
    follows: Option<String>,
}

impl Description {
    pub(super) fn of(file: &Path, robot: &Robot, checked: &Arrangement) -> Self {
        let joint = |joint: &RobotJoint| JointDescription::of(robot, joint);
        Self {
            version: 1,
            file: file.display().to_string(),
            robot: robot.name.clone(),
            root: robot.links[robot.root].name.clone(),
            links: robot.links.iter().map(LinkDescription::of).collect(),
            joints: robot.joints.iter().map(joint).collect(),
            checked_pairs: checked.pairs().len(),
            mass: robot.links.iter().filter_map(|link| link.mass).fold(0.0, |sum, mass| sum + mass),
            notes: robot.notes.clone(),
        }
    }

    /// For people.
    pub(super) fn text(&self) -> String {
        let mut lines = vec![format!(
            "robot {}: {}, {}, {:.4} kg, root {}; {} checked",
            self.robot,
            counted(self.links.len(), "link"),
            counted(self.joints.len(), "joint"),
            self.mass,
            self.root,
            match self.checked_pairs {
                1 => "1 pair of links is".to_owned(),
                pairs => format!("{pairs} pairs of links are"),
            }
        )];
        let width = self.links.iter().map(|link| link.name.len()).max().unwrap_or(0).max(4);
        lines.push(format!("\n{:width$}  {:>8}  {:>10}  inertia", "link", "faces", "mass, kg"));
        lines.extend(self.links.iter().map(|link| link.text(width)));
        if !self.joints.is_empty() {
            lines.push(joints_text(&self.joints));
        }
        if !self.notes.is_empty() {
            lines.push("\nnotes".to_owned());
            lines.extend(self.notes.iter().map(|note| format!("- {note}")));
        }
        lines.join("\n")
    }
}

impl LinkDescription {
    fn of(link: &RobotLink) -> Self {
        let mesh = link.collision.as_ref().filter(|_| link.primitive.is_none());
        Self {
            name: link.name.clone(),
            faces: mesh.map(|mesh| mesh.faces().len()),
            primitive: link.primitive.as_ref().map(Primitive::name),
            mass: link.mass,
            inertia: link.inertial.is_some(),
        }
    }

    fn text(&self, width: usize) -> String {
        let faces = self.faces.map(|faces| faces.to_string());
        let faces = faces.unwrap_or_else(|| self.primitive.unwrap_or("-").to_owned());
        let mass = self.mass.map_or("-".to_owned(), |mass| format!("{mass:.4}"));
        let inertia = if self.inertia { "stated" } else { "-" };
        format!("{:width$}  {faces:>8}  {mass:>10}  {inertia}", self.name)
    }
}

impl JointDescription {
    fn of(robot: &Robot, joint: &RobotJoint) -> Self {
        let (kind, axis) = match joint.kind {
            JointKind::Fixed => ("fixed", None),
            JointKind::Revolute { axis, limits: Some(_) } => ("revolute", Some(axis)),
            JointKind::Revolute { axis, limits: None } => ("continuous", Some(axis)),
            JointKind::Prismatic { axis, .. } => ("prismatic", Some(axis)),
            JointKind::Planar { normal } => ("planar", Some(normal)),
            JointKind::Ball => ("ball", None),
            JointKind::Rope { .. } => ("rope", None),
            JointKind::Spring(_) => ("spring", None),
            JointKind::Floating => ("floating", None),
        };
        let follows = joint
            .mimic
            .as_ref()
            .map(|mimic| format!("{} x {} + {}", mimic.joint, mimic.multiplier, mimic.offset));
        Self {
            name: joint.name.clone(),
            kind,
            parent: robot.links[joint.parent].name.clone(),
            child: robot.links[joint.child].name.clone(),
            axis: axis.map(|axis| axis.to_array()),
            limits: joint.limits(),
            max_effort: joint.max_effort,
            max_velocity: joint.max_velocity,
            damping: joint.resistance.damping,
            friction: joint.resistance.friction,
            follows,
        }
    }

    /// What there is to say of it beyond its links.
    fn remarks(&self) -> String {
        let mut remarks = Vec::new();
        if let Some([low, high]) = self.limits {
            remarks.push(format!("{low:.4} to {high:.4}"));
        }
        if let Some(effort) = self.max_effort {
            remarks.push(format!("effort {effort}"));
        }
        if let Some(velocity) = self.max_velocity {
            remarks.push(format!("velocity {velocity}"));
        }
        if self.damping > 0.0 {
            remarks.push(format!("damping {}", self.damping));
        }
        if self.friction > 0.0 {
            remarks.push(format!("friction {}", self.friction));
        }
        if let Some(leader) = &self.follows {
            remarks.push(format!("follows {leader}"));
        }
        remarks.join(", ")
    }
}

fn joints_text(joints: &[JointDescription]) -> String {
    let width = joints.iter().map(|joint| joint.name.len()).max().unwrap_or(0).max(5);
    let ends = |joint: &JointDescription| format!("{} -> {}", joint.parent, joint.child);
    let ends_width = joints.iter().map(|joint| ends(joint).len()).max().unwrap_or(0).max(5);
    let mut lines = vec![format!("\n{:width$}  {:10}  links", "joint", "kind")];
    lines.extend(joints.iter().map(|joint| {
        let line = format!(
            "{:width$}  {:10}  {:ends_width$}  {}",
            joint.name,
            joint.kind,
            ends(joint),
            joint.remarks()
        );
        line.trim_end().to_owned()
    }));
    lines.join("\n")
}
