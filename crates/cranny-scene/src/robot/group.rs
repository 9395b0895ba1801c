//! Groups of an SRDF file: which links and joints of a robot they name.
//!
//! Members mean what they mean in MoveIt: a joint stands for its child link, a link for itself and
//! the joint above it, a chain for all joints between two links, a subgroup for its members.

use std::collections::BTreeSet;

use super::{Robot, Semantics};

/// A group as its file has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SemanticGroup {
    /// Where it begins, from 1.
    pub line: u32,
    /// In file order.
    pub members: Vec<Member>,
}

/// A member of a group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// What it names.
    pub kind: MemberKind,
    /// Where it begins, from 1.
    pub line: u32,
}

/// What a member of a group names.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MemberKind {
    /// A link.
    Link(String),
    /// A joint.
    Joint(String),
    /// Another group.
    Group(String),
    /// All joints between two links, down from one or over the link that both hang from. The upper
    /// link is no part of the group.
    Chain {
        /// One end.
        base: String,
        /// The other.
        tip: String,
    },
}

/// What a group of an SRDF file is on a robot: indices, in ascending order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotGroup {
    /// Joints of the group, fixed ones among them.
    pub joints: BTreeSet<usize>,
    /// Links that it names and children of its joints.
    pub links: BTreeSet<usize>,
}

impl SemanticGroup {
    /// An empty group that begins on a line.
    pub(super) fn at(line: u32) -> Self {
        Self { line, members: Vec::new() }
    }
}

impl Semantics {
    /// Returns what a group is on a robot.
    ///
    /// # Errors
    ///
    /// One sentence: no group of that name, or a member that the robot or the file lacks, with its
    /// line; a group within itself.
    pub fn group_of(&self, robot: &Robot, name: &str) -> Result<RobotGroup, String> {
        let mut group = RobotGroup::default();
        self.gather(robot, name, &mut Vec::new(), &mut group)?;
        Ok(group)
    }

    fn gather<'a>(
        &'a self,
        robot: &Robot,
        name: &'a str,
        open: &mut Vec<&'a str>,
        into: &mut RobotGroup,
    ) -> Result<(), String> {
        let found = self.groups.get(name).ok_or_else(|| {
            let known = these("groups", self.groups.keys().map(String::as_str));
            format!("it has no group {name:?}. {known}")
        })?;
        open.push(name);
        for Member { kind, line } in &found.members {
            let refused = |what: String| format!("line {line}: the group {name:?} {what}");
            match kind {
                MemberKind::Group(inner) if open.contains(&inner.as_str()) => {
                    let circle = [&open[..], &[inner]].concat().join(", ");
                    return Err(refused(format!("holds itself ({circle}). Take one of them out")));
                }
                MemberKind::Group(inner) if !self.groups.contains_key(inner) => {
                    let known = these("groups", self.groups.keys().map(String::as_str));
                    return Err(refused(format!(
                        "names the group {inner:?}, which is not there. {known}"
                    )));
                }
                MemberKind::Group(inner) => self.gather(robot, inner, open, into)?,
                MemberKind::Joint(joint) if self.virtual_joints.contains_key(joint) => {
                    // It ties the robot to the world and moves no link against another.
                    into.links
                        .insert(link_of(robot, &self.virtual_joints[joint]).map_err(refused)?);
                }
                other => into.add(robot, other).map_err(refused)?,
            }
        }
        open.pop();
        Ok(())
    }
}

impl RobotGroup {
    fn add(&mut self, robot: &Robot, member: &MemberKind) -> Result<(), String> {
        match member {
            MemberKind::Link(name) => {
                let link = link_of(robot, name)?;
                self.links.insert(link);
                self.joints.extend(robot.joint_above(link));
            }
            MemberKind::Joint(name) => {
                let joint = robot.joint(name).ok_or_else(|| {
                    let known =
                        these("joints", robot.joints.iter().map(|joint| joint.name.as_str()));
                    format!("names the joint {name:?}, which the robot lacks. {known}")
                })?;
                self.add_joint(robot, joint);
            }
            MemberKind::Chain { base, tip } => {
                let ends = [link_of(robot, base)?, link_of(robot, tip)?];
                let [of_base, of_tip] = ends.map(|end| joints_to_root(robot, end));
                // What both ends hang from is not between them.
                for &joint in of_base.symmetric_difference(&of_tip) {
                    self.add_joint(robot, joint);
                }
            }
            MemberKind::Group(_) => {}
        }
        Ok(())
    }

    fn add_joint(&mut self, robot: &Robot, joint: usize) {
        self.joints.insert(joint);
        self.links.insert(robot.joints[joint].child);
    }

    /// The links of the group, and all links that its movable joints move: those that hang from
    /// them, and those of joints that follow.
    #[must_use]
    pub fn moved_links(&self, robot: &Robot) -> BTreeSet<usize> {
        let mut moved = vec![false; robot.links.len()];
        for &index in robot.joints_from_root() {
            let joint = &robot.joints[index];
            let leader = joint.mimic.as_ref().and_then(|mimic| robot.joint(&mimic.joint));
            let of_group = |joint: &usize| self.joints.contains(joint);
            let moves = of_group(&index) && !robot.joints[index].is_fixed()
                || leader.as_ref().is_some_and(of_group);
            moved[joint.child] = moves || moved[joint.parent];
        }
        let moved = (0..moved.len()).filter(|&link| moved[link]);
        moved.chain(self.links.iter().copied()).collect()
    }
}

fn joints_to_root(robot: &Robot, link: usize) -> BTreeSet<usize> {
    let above = |&joint: &usize| robot.joint_above(robot.joints[joint].parent);
    std::iter::successors(robot.joint_above(link), above).collect()
}

fn link_of(robot: &Robot, name: &str) -> Result<usize, String> {
    robot.link(name).ok_or_else(|| {
        let known = these("links", robot.links.iter().map(|link| link.name.as_str()));
        format!("names the link {name:?}, which the robot lacks. {known}")
    })
}

/// A sentence about the names that there are: enough to see a typing error.
pub(crate) fn these<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> String {
    const NAMED: usize = 12;
    let all: Vec<&str> = names.collect();
    match all.len() {
        0 => format!("It has no {what}"),
        n if n > NAMED => {
            format!("Its {what} are {} and {} more", all[..NAMED].join(", "), n - NAMED)
        }
        _ => format!("Its {what} are {}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read_robot, read_semantics};
    use super::*;

    /// base - (turn) - arm - (fixed) - hand - (slide) - left, right follows on the hand; eye fixed
    /// on the base.
    fn robot() -> Robot {
        let links = ["base", "arm", "hand", "left", "right", "eye"];
        let links: String = links.map(|name| format!("<link name='{name}'/>")).concat();
        let joint = |name: &str, kind: &str, parent: &str, child: &str, more: &str| {
            let limit = "<limit lower='0' upper='1' effort='1' velocity='1'/>";
            format!(
                "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{limit}{more}</joint>"
            )
        };
        let joints = [
            joint("turn", "revolute", "base", "arm", ""),
            joint("flange", "fixed", "arm", "hand", ""),
            joint("slide", "prismatic", "hand", "left", ""),
            joint("follow", "prismatic", "hand", "right", "<mimic joint='slide'/>"),
            joint("mast", "fixed", "base", "eye", ""),
        ]
        .concat();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.urdf");
        std::fs::write(&path, format!("<robot name='r'>{links}{joints}</robot>")).unwrap();
        read_robot(&path).unwrap()
    }

    fn group(members: &str) -> Result<[Vec<String>; 2], String> {
        let robot = robot();
        let text = format!(
            "<robot name='r'><group name='g'>\n{members}</group>\n<group name='hand'><joint name='slide'/></group>\n<virtual_joint name='world' type='fixed' parent_frame='w' child_link='base'/></robot>"
        );
        let group = read_semantics(&text)?.group_of(&robot, "g")?;
        let names = |links: BTreeSet<usize>| {
            links.into_iter().map(|link| robot.links[link].name.clone()).collect()
        };
        let moved = group.moved_links(&robot);
        Ok([names(group.links), names(moved)])
    }

    #[test]
    fn members_are_the_links_that_planners_take_them_for() {
        for (members, links, moved) in [
            ("<joint name='turn'/>", &["arm"][..], &["arm", "hand", "left", "right"][..]),
            ("<link name='hand'/>", &["hand"], &["hand"]),
            ("<group name='hand'/>", &["left"], &["left", "right"]),
            (
                "<chain base_link='base' tip_link='hand'/>",
                &["arm", "hand"],
                &["arm", "hand", "left", "right"],
            ),
            ("<chain base_link='hand' tip_link='arm'/>", &["hand"], &["hand"]),
            (
                "<chain base_link='eye' tip_link='left'/>",
                &["arm", "hand", "left", "eye"],
                &["arm", "hand", "left", "right", "eye"],
            ),
            ("<link name='base'/><link name='eye'/>", &["base", "eye"], &["base", "eye"]),
            ("<joint name='world'/>", &["base"], &["base"]),
            ("", &[], &[]),
        ] {
            assert_eq!(group(members).unwrap(), [links, moved], "{members}");
        }
    }

    #[test]
    fn what_is_not_there_is_refused_with_its_line() {
        for (members, says) in [
            (
                "<joint name='elbow'/>",
                "line 2: the group \"g\" names the joint \"elbow\", which the robot lacks. Its joints are turn, flange, slide, follow, mast",
            ),
            (
                "<link name='leg'/>",
                "line 2: the group \"g\" names the link \"leg\", which the robot lacks. Its links are base,",
            ),
            (
                "<group name='leg'/>",
                "line 2: the group \"g\" names the group \"leg\", which is not there. Its groups are g, hand",
            ),
            ("<group name='g'/>", "line 2: the group \"g\" holds itself (g, g)"),
        ] {
            let error = group(members).unwrap_err();
            assert!(error.contains(says), "{error}");
        }
        let semantics = read_semantics("<robot name='r'/>").unwrap();
        let none = semantics.group_of(&robot(), "arm").unwrap_err();
        assert_eq!(none, "it has no group \"arm\". It has no groups");
    }
}
