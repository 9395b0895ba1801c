//! Paths of a robot's joints, and which links meet on the way.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use cranny_exact::Pose;
use cranny_world::Wanted;
use cranny_world::description::{JointPositions, MotorPath};

use super::{NAMED, Placing, pairs_that_meet};
use crate::robot::Robot;
use crate::scene_file::motor_path::too_fast;
use crate::scene_file::syntax::RobotFile;

/// Instants of a robot's paths at which its links are looked at. Fewer: links that meet in between
/// are not reported; more: a scene with a robot of many meshes takes seconds to read.
const INSTANTS: u32 = 64;

/// By joint.
pub(super) type MotorPaths = BTreeMap<String, Arc<MotorPath>>;

/// The paths of a robot's joints, with warnings of those that are too fast.
///
/// # Errors
///
/// A path beside another position, or one that leaves its joint's limits.
pub(super) fn paths_of(
    file: &RobotFile,
    robot: &Robot,
    warnings: &mut Vec<String>,
) -> Result<MotorPaths, String> {
    let mut paths = MotorPaths::new();
    for name in file.paths.keys() {
        let joint = robot.joint(name).map(|joint| &robot.joints[joint]);
        let drive = file.drive(name, file.targets.get(name).map(|target| target.0));
        let path = drive.path(joint.and_then(|joint| joint.limits()));
        let Some(path) = path.map_err(|what| format!("joint {name:?}: {what}"))? else { continue };
        let of_motor = file.motors.get(name).and_then(|motor| motor.max_velocity);
        let most = of_motor.map(|most| most.0).or(joint.and_then(|joint| joint.max_velocity));
        warnings.extend(too_fast(&path, most).map(|what| format!("joint {name:?}: {what}")));
        paths.insert(name.clone(), path);
    }
    Ok(paths)
}

impl Placing<'_> {
    /// Warns of links that meet on the way along the paths and that the solver then drives apart.
    pub(super) fn warn_of_meetings(
        &mut self,
        world_from_root: &Pose,
        starts: &JointPositions,
        excluded: &[(usize, usize)],
    ) -> Result<(), String> {
        let longest = self.paths.values().map(|path| path.duration()).fold(0.0, f64::max);
        if longest == 0.0 {
            return Ok(());
        }
        let mut arrangement = self.arrangement(excluded);
        let (mut known, mut meetings) = (BTreeSet::new(), Vec::new());
        for instant in 0..=INSTANTS {
            let time = longest * f64::from(instant) / f64::from(INSTANTS);
            let poses = self.poses_at(time, world_from_root, starts)?;
            let arranged = arrangement.at(&poses, Wanted::Meeting);
            for pair in arranged.map_err(|error| error.to_string())?.meeting {
                if known.insert(pair) {
                    let [a, b] = [pair.0, pair.1].map(|body| self.link_name(body));
                    meetings.push(format!("{a} - {b} (first seen at {time:.3} s)"));
                }
            }
        }
        if !meetings.is_empty() {
            let listed = meetings[..meetings.len().min(NAMED)].join(", ");
            self.warnings.push(format!(
                "{} on the way along `paths`: {listed}. Lead the joints around, or exclude the pairs by `srdf` or `self_collisions`",
                pairs_that_meet(meetings.len())
            ));
        }
        Ok(())
    }

    /// Where the bodies are if all joints are where their paths are.
    fn poses_at(
        &self,
        time: f64,
        world_from_root: &Pose,
        starts: &JointPositions,
    ) -> Result<Vec<Pose>, String> {
        let mut positions = starts.clone();
        let led = self.paths.iter().map(|(joint, path)| (joint.clone(), path.position_at(time)));
        positions.extend(led);
        let links = self.robot.forward_kinematics(&positions).map_err(|why| why.to_string())?;
        Ok(self.link_of_body.iter().map(|&link| world_from_root.compose(&links[link])).collect())
    }
}
