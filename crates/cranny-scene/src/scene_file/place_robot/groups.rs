//! Which links of a robot are bodies: those that fixed joints hold together are a group.

use cranny_world::description::JointKind;

use crate::robot::Robot;

/// Links that fixed joints hold together.
pub(super) struct Groups {
    /// By link.
    pub(super) group_of: Vec<usize>,
    /// By group: its first link, reached from the root.
    pub(super) top: Vec<usize>,
    /// By group: the first link with collision geometry, else the top.
    pub(super) carrier: Vec<usize>,
    /// By group: whether it is a body.
    pub(super) present: Vec<bool>,
    /// By link: the joint above it.
    pub(super) above: Vec<Option<usize>>,
}

impl Groups {
    pub(super) fn of(robot: &Robot) -> Self {
        let mut above = vec![None; robot.links.len()];
        let mut group_of = vec![0; robot.links.len()];
        let mut top = vec![robot.root];
        let mut order = vec![robot.root];
        for &index in robot.joints_from_root() {
            let joint = &robot.joints[index];
            above[joint.child] = Some(index);
            order.push(joint.child);
            group_of[joint.child] = if joint.kind == JointKind::Fixed {
                group_of[joint.parent]
            } else {
                top.push(joint.child);
                top.len() - 1
            };
        }
        let mut carrier = vec![None; top.len()];
        let mut present = vec![false; top.len()];
        for &link in &order {
            let (group, known) = (group_of[link], &robot.links[link]);
            if known.collision.is_some() {
                carrier[group].get_or_insert(link);
            }
            present[group] |= known.collision.is_some() || known.mass.is_some();
        }
        // What moves something is there, and so is what it hangs on.
        for &index in robot.joints_from_root().iter().rev() {
            let joint = &robot.joints[index];
            let (parent, child) = (group_of[joint.parent], group_of[joint.child]);
            if joint.kind != JointKind::Floating {
                present[parent] |= parent != child && present[child];
            }
        }
        let carrier = carrier.iter().zip(&top).map(|(found, &top)| found.unwrap_or(top)).collect();
        Self { group_of, top, carrier, present, above }
    }

    /// Whether a link is a body of its own.
    pub(super) fn has_body(&self, robot: &Robot, link: usize) -> bool {
        let group = self.group_of[link];
        self.present[group]
            && (self.carrier[group] == link || robot.links[link].collision.is_some())
    }
}
