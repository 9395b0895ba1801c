//! Joints in scenes: the bodies that they join, and whether their anchors fit together.

use cranny_exact::Pose;
use cranny_world::description::{BodyKind, JointDescription, JointKind, Motor, Resistance, Spring};

use super::assemble::Assembly;
use super::motor_path::{Drive, too_fast};
use super::problem::{SceneError, SceneProblem};
use super::syntax::{JointFile, JointKindFile};
use super::values::Finite;

/// By how much anchors that a joint holds in one place may be apart at the start, as a share of the
/// smaller body's diagonal, without a warning. Smaller: digits that were left out are warned of;
/// larger: a jerk in the first step comes without one.
const FITS: f64 = 1e-3;

impl Assembly<'_> {
    pub(super) fn joint(&mut self, joint: &JointFile) -> Result<(), SceneError> {
        let ends = [self.index_of("parent", &joint.parent)?, self.index_of("child", &joint.child)?];
        let [parent, child] = ends;
        let kind = joint_kind(joint, ends).map_err(|what| self.refused_joint(joint, what))?;
        let drive = Drive {
            motor: joint.motor.as_ref(),
            target: joint.target.map(|target| target.0),
            path: joint.path.as_ref(),
        };
        drive.check_position(kind.limits()).map_err(|what| self.refused_joint(joint, what))?;
        let path = drive.path(kind.limits()).map_err(|what| self.refused_joint(joint, what))?;
        let motor = drive.motor(Motor::default(), path.as_deref(), None);
        let whose = format!("joint {:?}", joint.name);
        let most = motor.and_then(|motor| motor.max_velocity);
        let lags = path.as_ref().and_then(|path| too_fast(path, most));
        self.warnings.extend(lags.map(|lags| format!("{whose}: {lags}")));
        let [parent_anchor, child_anchor] =
            [joint.parent_anchor, joint.child_anchor].map(|anchor| self.pose(&whose, anchor));
        let apart = self.apart_at_start(ends, [parent_anchor, child_anchor], &kind);
        self.warnings.extend(apart.map(|apart| format!("{whose}: {apart}")));
        let idle = self.idle_joint(ends, &kind);
        self.warnings.extend(idle.map(|idle| format!("{whose}: {idle}")));
        if !joint.collide {
            self.description.excluded_pairs.push((parent.min(child), parent.max(child)));
        }
        self.description.joints.push(JointDescription {
            name: joint.name.clone(),
            parent,
            child,
            parent_anchor,
            child_anchor,
            kind,
            mimic: None,
            motor,
            path,
            resistance: Resistance::default(),
            reduced: false,
            start: 0.0,
        });
        Ok(())
    }

    /// What is to be known of a joint that changes nothing, or that makes another one do so.
    fn idle_joint(&self, ends: [usize; 2], kind: &JointKind) -> Option<String> {
        let bodies = ends.map(|end| &self.description.bodies[end]);
        if bodies.iter().all(|body| body.kind == BodyKind::Fixed) {
            return Some(format!(
                "it joins two Fixed bodies, {:?} and {:?}: it changes nothing. Make one of them Dynamic, or take the joint out",
                bodies[0].name, bodies[1].name
            ));
        }
        let same = |other: &&JointDescription| {
            [[other.parent, other.child], [other.child, other.parent]].contains(&ends)
                && [&other.kind, kind].contains(&&JointKind::Fixed)
        };
        let other = self.description.joints.iter().find(same)?;
        Some(format!(
            "the joint {:?} joins the same two bodies, and one of the two is Fixed: nothing is left free. Take one of them out",
            other.name
        ))
    }

    fn refused_joint(&self, joint: &JointFile, what: String) -> SceneError {
        let what = format!("joint {:?}: {what}", joint.name);
        let place = self.source.find("name", &joint.name);
        self.source.error(place, SceneProblem::Contradiction(what))
    }

    /// What is to be known of anchors that are farther apart than the joint lets them be.
    fn apart_at_start(
        &self,
        ends: [usize; 2],
        anchors: [Pose; 2],
        kind: &JointKind,
    ) -> Option<String> {
        let bodies = ends.map(|end| &self.description.bodies[end]);
        let [a, b] = [0, 1].map(|i| bodies[i].pose.compose(&anchors[i]).translation);
        let (apart, sizes) = (a.distance(b), bodies.map(|b| b.collision.bounds().diagonal()));
        let most = match kind {
            JointKind::Rope { length } => *length,
            JointKind::Fixed | JointKind::Revolute { .. } | JointKind::Ball => 0.0,
            _ => return None,
        };
        let held = if most > 0.0 {
            format!("its length is {most}")
        } else {
            "it holds them in one place".to_owned()
        };
        (apart > most + FITS * sizes[0].min(sizes[1])).then(|| {
            format!("its anchors are {apart:.6} apart at the start, but {held}: the first steps pull them together with a jerk. Move a body or an anchor")
        })
    }
}

/// The motions that a joint leaves free.
///
/// # Errors
///
/// What contradicts itself, in words.
fn joint_kind(joint: &JointFile, [parent, child]: [usize; 2]) -> Result<JointKind, String> {
    if parent == child {
        return Err("it joins a body to itself".to_owned());
    }
    let kind = match joint.kind {
        JointKindFile::Fixed {} => JointKind::Fixed,
        JointKindFile::Revolute { axis, limits } => {
            JointKind::Revolute { axis: axis.0, limits: ordered(limits)? }
        }
        JointKindFile::Prismatic { axis, limits } => {
            JointKind::Prismatic { axis: axis.0, limits: ordered(limits)? }
        }
        JointKindFile::Ball {} => JointKind::Ball,
        JointKindFile::Rope { length } => JointKind::Rope { length: length.0 },
        JointKindFile::Spring { length, stiffness, damping } => JointKind::Spring(Spring {
            length: length.0,
            stiffness: stiffness.0,
            damping: damping.0,
        }),
    };
    let driven = joint.target.is_some() || joint.motor.is_some() || joint.path.is_some();
    if driven && !kind.has_position() {
        return Err(format!(
            "a {} joint has no position to drive. Leave `target`, `motor` and `path` out",
            kind.name()
        ));
    }
    Ok(kind)
}

fn ordered(limits: Option<[Finite; 2]>) -> Result<Option<[f64; 2]>, String> {
    let limits = limits.map(|limits| limits.map(|limit| limit.0));
    match limits {
        Some([low, high]) if low > high => {
            Err(format!("its lower limit, {low}, is above its upper one, {high}"))
        }
        _ => Ok(limits),
    }
}
