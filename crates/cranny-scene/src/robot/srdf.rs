//! What an SRDF file says of a robot: pairs of links never to check, groups, and named states.

use std::collections::{BTreeMap, BTreeSet};

use cranny_world::description::JointPositions;
use roxmltree::{Document, Node};

use super::Robot;
use super::group::{Member, MemberKind, SemanticGroup};
use crate::text_file::without_mark;
use crate::xml::nested_beyond;

/// SRDF nests five elements.
const MAX_DEPTH: usize = 64;

/// What is read of an SRDF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Semantics {
    /// The robot that it is of, by the name in its URDF file.
    pub robot: Option<String>,
    /// Pairs of names of `disable_collisions`, in file order.
    pub disabled_pairs: Vec<[String; 2]>,
    /// Groups by name; elements of one name are put together.
    pub groups: BTreeMap<String, SemanticGroup>,
    /// Links by the name of the `virtual_joint` that ties them to the world.
    pub virtual_joints: BTreeMap<String, String>,
    /// Positions of joints by the name of a `group_state`; those of several groups are put
    /// together.
    pub states: BTreeMap<String, JointPositions>,
    /// Joints with several values, as of a base that floats, by the name of a `group_state`. They
    /// have no one position and are left out of [`states`](Self::states).
    pub many_valued: BTreeMap<String, Vec<String>>,
}

/// Reads the text of an SRDF file.
///
/// # Errors
///
/// One sentence: no well-formed XML, a URDF, or an element without what it must have, with its
/// line.
pub fn read_semantics(text: &str) -> Result<Semantics, String> {
    let text = without_mark(text);
    if nested_beyond(text, MAX_DEPTH).is_some() {
        return Err(format!(
            "elements are nested deeper than {MAX_DEPTH}: this is no SRDF. Name another file"
        ));
    }
    let document = Document::parse(text).map_err(|error| {
        format!("not well-formed XML ({error}). Correct it, or export it again")
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(format!(
            "found the element {:?}, expected 'robot'. Name an SRDF file",
            root.tag_name().name()
        ));
    }
    let robot = root.attribute("name").map(str::to_owned);
    let mut semantics = Semantics { robot, ..Semantics::default() };
    for node in root.children() {
        match node.tag_name().name() {
            "disable_collisions" => {
                let pair = [attribute(node, "link1")?, attribute(node, "link2")?];
                semantics.disabled_pairs.push(pair.map(str::to_owned));
            }
            "group" => semantics.group(node)?,
            "virtual_joint" => {
                let [name, link] = [attribute(node, "name")?, attribute(node, "child_link")?];
                semantics.virtual_joints.insert(name.to_owned(), link.to_owned());
            }
            "group_state" => semantics.state(node)?,
            element @ ("link" | "joint") => {
                return Err(format!(
                    "line {}: an element '{element}' stands in 'robot', so it is a URDF and no SRDF. Name the SRDF file",
                    line(node)
                ));
            }
            _ => {}
        }
    }
    Ok(semantics)
}

impl Semantics {
    /// What it names that a robot does not have, and another name of the robot: a sentence each.
    ///
    /// # Errors
    ///
    /// One sentence: the file is of another robot. This one has nothing that it names; or their
    /// names differ, and it has less than half.
    pub fn misfits(&self, robot: &Robot) -> Result<Vec<String>, String> {
        let [links, joints] = self.named();
        let (all, robot_name) = (links.len() + joints.len(), &robot.name);
        let links: Vec<_> = links.into_iter().filter(|name| robot.link(name).is_none()).collect();
        let joints: Vec<_> =
            joints.into_iter().filter(|name| robot.joint(name).is_none()).collect();
        let unknown = links.len() + joints.len();
        let other_name = self.robot.as_ref().filter(|name| !name.eq_ignore_ascii_case(robot_name));
        if all > 0 && (unknown == all || other_name.is_some() && 2 * unknown > all) {
            let of = self.robot.as_ref().map_or(String::new(), |name| format!(" ({name:?})"));
            let first = links.iter().chain(&joints).next().copied().unwrap_or_default();
            return Err(format!(
                "it is of another robot{of}: of the {all} links and joints that it names, such as {first:?}, the robot {robot_name:?} lacks {unknown}. Name the SRDF file of this robot"
            ));
        }
        let mut misfits: Vec<String> = Vec::new();
        misfits.extend(other_name.map(|name| {
            format!("the SRDF is of the robot {name:?}, and the URDF of {robot_name:?}")
        }));
        for (what, lacking) in [("link", links), ("joint", joints)] {
            misfits.extend(lacking_sentence(what, &lacking));
        }
        Ok(misfits)
    }

    /// The links and the joints that it names. Joints with several values float, as virtual ones
    /// do, and may be in no URDF.
    fn named(&self) -> [BTreeSet<&str>; 2] {
        let mut links: BTreeSet<&str> =
            self.disabled_pairs.iter().flatten().map(String::as_str).collect();
        links.extend(self.virtual_joints.values().map(String::as_str));
        let mut joints: BTreeSet<&str> =
            self.states.values().flat_map(BTreeMap::keys).map(String::as_str).collect();
        for Member { kind, .. } in self.groups.values().flat_map(|group| &group.members) {
            match kind {
                MemberKind::Link(name) => _ = links.insert(name),
                MemberKind::Joint(name) => _ = joints.insert(name),
                MemberKind::Chain { base, tip } => links.extend([base.as_str(), tip]),
                MemberKind::Group(_) => {}
            }
        }
        let floating: BTreeSet<&String> = self.many_valued.values().flatten().collect();
        joints.retain(|&name| {
            let name = &name.to_owned();
            !self.virtual_joints.contains_key(name) && !floating.contains(name)
        });
        [links, joints]
    }

    fn group(&mut self, node: Node<'_, '_>) -> Result<(), String> {
        let group = self.groups.entry(attribute(node, "name")?.to_owned());
        let group = group.or_insert_with(|| SemanticGroup::at(line(node)));
        for child in node.children() {
            let kind = match child.tag_name().name() {
                "link" => MemberKind::Link(attribute(child, "name")?.to_owned()),
                "joint" => MemberKind::Joint(attribute(child, "name")?.to_owned()),
                "group" => MemberKind::Group(attribute(child, "name")?.to_owned()),
                "chain" => MemberKind::Chain {
                    base: attribute(child, "base_link")?.to_owned(),
                    tip: attribute(child, "tip_link")?.to_owned(),
                },
                _ => continue,
            };
            group.members.push(Member { kind, line: line(child) });
        }
        Ok(())
    }

    fn state(&mut self, node: Node<'_, '_>) -> Result<(), String> {
        let name = attribute(node, "name")?;
        let state = self.states.entry(name.to_owned()).or_default();
        for joint in node.children().filter(|node| node.has_tag_name("joint")) {
            let of_joint = attribute(joint, "name")?.to_owned();
            match values(joint)?.as_slice() {
                &[position] => {
                    state.insert(of_joint, position);
                }
                _ => self.many_valued.entry(name.to_owned()).or_default().push(of_joint),
            }
        }
        Ok(())
    }
}

/// That a robot lacks links or joints which are named.
fn lacking_sentence(what: &str, lacking: &[&str]) -> Option<String> {
    /// Enough to see what they are.
    const NAMED: usize = 4;
    let names: Vec<_> = lacking.iter().take(NAMED).map(|name| format!("{name:?}")).collect();
    let (names, more) = (names.join(", "), lacking.len().saturating_sub(NAMED));
    match lacking.len() {
        0 => None,
        1 => Some(format!("the SRDF names the {what} {names}, which the robot lacks")),
        _ if more == 0 => {
            Some(format!("the SRDF names the {what}s {names}, which the robot lacks"))
        }
        _ => Some(format!(
            "the SRDF names the {what}s {names} and {more} more, which the robot lacks"
        )),
    }
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    node.attribute(name).ok_or_else(|| {
        let element = node.tag_name().name();
        format!("line {}: an element '{element}' has no {name:?}. Add it", line(node))
    })
}

/// The values of a joint, at least one.
fn values(joint: Node<'_, '_>) -> Result<Vec<f64>, String> {
    let written = attribute(joint, "value")?;
    let finite = |word: &str| word.parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<f64>> = written.split_whitespace().map(finite).collect();
    numbers.filter(|numbers| !numbers.is_empty()).ok_or_else(|| {
        format!(
            "line {}: the value {written:?} of a joint is no finite number. Correct it",
            line(joint)
        )
    })
}

fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_read_and_half_of_one_is_refused() {
        let text = "<robot name='r'>\n<group name='g'/>\n<disable_collisions link1='a' link2='b' reason='Never'/></robot>";
        let pairs = read_semantics(text).unwrap().disabled_pairs;
        assert_eq!(pairs, [["a".to_owned(), "b".to_owned()]]);
        let half = text.replace(" link2='b'", "");
        assert!(read_semantics(&half).unwrap_err().contains("line 3"));
        assert!(read_semantics("<a/>").is_err() && read_semantics("<robot").is_err());
    }

    #[test]
    fn a_urdf_is_no_srdf() {
        let text = "<robot name='r'>\n<link name='a'/></robot>";
        let error = read_semantics(text).unwrap_err();
        assert!(error.contains("line 2: an element 'link'") && error.contains("URDF"), "{error}");
    }

    #[test]
    fn states_of_several_groups_are_put_together() {
        let text = "<robot name='r'>
            <group_state name='home' group='arm'><joint name='a' value='0.5'/></group_state>
            <group_state name='home' group='hand'><joint name='b' value=' -1e-2 '/></group_state>
            <group_state name='away' group='arm'/></robot>";
        let states = read_semantics(text).unwrap().states;
        let home = JointPositions::from([("a".to_owned(), 0.5), ("b".to_owned(), -0.01)]);
        assert_eq!((states.len(), &states["home"]), (2, &home));
        for (from, to, says) in [
            ("'0.5'", "'soon'", "line 2: the value \"soon\""),
            ("'0.5'", "'inf'", "line 2: the value \"inf\""),
            ("'0.5'", "''", "line 2: the value \"\""),
            ("'0.5'", "'0 x'", "line 2: the value \"0 x\""),
            ("name='b' ", "", "line 3: an element 'joint' has no \"name\""),
            ("name='away' ", "", "line 4: an element 'group_state' has no \"name\""),
        ] {
            let error = read_semantics(&text.replace(from, to)).unwrap_err();
            assert!(error.contains(says), "{error}");
        }
    }

    #[test]
    fn joints_with_several_values_are_left_out_of_a_state() {
        let text = "<robot name='r'><group_state name='home' group='all'>
            <joint name='base' value='0. 0. 0.3 0. 0. 0. 1.'/><joint name='a' value='0.5'/>
            </group_state></robot>";
        let semantics = read_semantics(text).unwrap();
        assert_eq!(semantics.states["home"], JointPositions::from([("a".to_owned(), 0.5)]));
        assert_eq!(semantics.many_valued["home"], ["base"]);
    }

    #[test]
    fn half_a_member_of_a_group_is_refused_with_its_line() {
        for (member, says) in [
            ("<link/>", "line 2: an element 'link' has no \"name\". Add it"),
            ("<chain base_link='a'/>", "line 2: an element 'chain' has no \"tip_link\". Add it"),
            ("<group/>", "line 2: an element 'group' has no \"name\". Add it"),
        ] {
            let text = format!("<robot name='r'><group name='g'>\n{member}</group></robot>");
            assert_eq!(read_semantics(&text).unwrap_err(), says);
        }
    }
}
