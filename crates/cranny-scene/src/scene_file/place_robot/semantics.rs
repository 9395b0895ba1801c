//! What a robot's SRDF file says to a scene: states, and groups in place of links and joints.

use std::collections::BTreeMap;

use cranny_world::description::JointPositions;

use super::{Placing, listed};
use crate::robot::{Robot, Semantics, read_semantics, these};
use crate::scene_file::assemble::{Assembly, GroupBodies};
use crate::scene_file::syntax::RobotFile;
use crate::text_file::{read_text, remedy};

/// Reads the SRDF file, if one is named.
pub(super) fn read(
    assembly: &mut Assembly<'_>,
    file: &RobotFile,
    robot: &Robot,
    warnings: &mut Vec<String>,
) -> Result<Semantics, String> {
    let Some(srdf) = &file.srdf else { return Ok(Semantics::default()) };
    let path = assembly.source.resolve(srdf);
    let text =
        read_text(&path).map_err(|error| format!("cannot be read ({error}). {}", remedy(&error)));
    let semantics = text.and_then(|text| read_semantics(&text));
    let fitted = semantics.and_then(|semantics| {
        warnings.extend(semantics.misfits(robot)?);
        Ok(semantics)
    });
    let semantics = fitted.map_err(|problem| format!("SRDF file {}: {problem}", path.display()))?;
    assembly.add_file(path);
    Ok(semantics)
}

/// Returns where the named state has joints, without those that follow others.
pub(super) fn positions_of_state(
    semantics: &Semantics,
    file: &RobotFile,
    robot: &Robot,
    warnings: &mut Vec<String>,
) -> Result<JointPositions, String> {
    let Some(name) = &file.state else { return Ok(JointPositions::new()) };
    let srdf = file.srdf.as_ref().ok_or_else(|| {
        format!("it starts in the state {name:?}, but names no `srdf`. Name the file that has it")
    })?;
    let state = semantics.states.get(name).ok_or_else(|| {
        let known = these("states", semantics.states.keys().map(String::as_str));
        format!("{srdf} has no state {name:?}. {known}")
    })?;
    if let Some(left_out) = semantics.many_valued.get(name) {
        warnings.push(format!(
            "the state {name:?} of {srdf} gives several values each to {}, which are left out. `pose` says where the robot stands",
            listed(left_out)
        ));
    }
    let follows = |joint: &str| robot.joint(joint).is_some_and(|j| robot.joints[j].mimic.is_some());
    let own = state.iter().filter(|(joint, _)| !follows(joint));
    Ok(own.map(|(joint, value)| (joint.clone(), *value)).collect())
}

/// Returns the robot with a motor for each joint of a group that `motors` names. A joint that has a
/// motor of its own keeps it; a group's name that is a joint's too is the joint.
///
/// # Errors
///
/// A group with a member that is not there; two groups with one joint.
pub(super) fn with_motors_of_groups(
    file: &RobotFile,
    semantics: &Semantics,
    robot: &Robot,
) -> Result<RobotFile, String> {
    let mut file = file.clone();
    let is_group = |name: &&String| {
        robot.joint(name).is_none() && semantics.groups.contains_key(name.as_str())
    };
    let groups: Vec<String> = file.motors.keys().filter(is_group).cloned().collect();
    let mut driven: BTreeMap<String, String> = BTreeMap::new();
    for name in groups {
        let Some(motor) = file.motors.remove(&name) else { continue };
        let srdf = file.srdf.as_deref().unwrap_or_default();
        let group = semantics
            .group_of(robot, &name)
            .map_err(|problem| format!("SRDF file {srdf}: {problem}"))?;
        let joints = group.joints.into_iter().map(|joint| &robot.joints[joint]);
        for joint in joints.filter(|joint| joint.has_position() && joint.mimic.is_none()) {
            if let Some(other) = driven.insert(joint.name.clone(), name.clone()) {
                return Err(format!(
                    "`motors` names the groups {other:?} and {name:?}, which both have the joint {:?}. Name one, or the joints",
                    joint.name
                ));
            }
        }
        let of_group = driven.iter().filter(|(_, group)| **group == name);
        for (joint, _) in of_group {
            file.motors.entry(joint.clone()).or_insert(motor);
        }
    }
    Ok(file)
}

impl Placing<'_> {
    /// Returns the bodies of the links of each group. A link without a body of its own counts as
    /// the body that carries it.
    pub(super) fn bodies_of_groups(
        &self,
        semantics: &Semantics,
    ) -> impl Iterator<Item = (String, GroupBodies)> {
        let srdf = self.file.srdf.clone().unwrap_or_default();
        semantics.groups.keys().map(move |name| {
            let group = semantics.group_of(self.robot, name);
            let bodies = group.map(|group| {
                let carried = group.links.iter().filter_map(|&link| self.carriers[link]);
                let mut bodies: Vec<usize> = carried.map(|carrier| carrier.body).collect();
                bodies.sort_unstable();
                bodies.dedup();
                bodies
            });
            (name.clone(), bodies.map_err(|problem| format!("SRDF file {srdf}: {problem}")))
        })
    }
}
