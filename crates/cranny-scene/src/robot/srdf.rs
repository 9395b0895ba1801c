//! What an SRDF file says of a robot: pairs of links never to check, and named states.

use std::collections::BTreeMap;

use cranny_world::description::JointPositions;
use roxmltree::{Document, Node};

use crate::byte_order_mark::without_mark;
use crate::xml::nested_beyond;

/// SRDF nests five elements.
const MAX_DEPTH: usize = 64;

/// What is read of an SRDF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Semantics {
    /// Pairs of names of `disable_collisions`, in file order.
    pub disabled_pairs: Vec<[String; 2]>,
    /// Positions of joints by the name of a `group_state`; those of several groups are put
    /// together.
    pub states: BTreeMap<String, JointPositions>,
}

/// Reads the text of an SRDF file.
///
/// # Errors
///
/// One sentence: no well-formed XML, or an element without what it must have, with its line.
pub fn read_semantics(text: &str) -> Result<Semantics, String> {
    let text = without_mark(text);
    if nested_beyond(text, MAX_DEPTH).is_some() {
        return Err(format!("elements are nested deeper than {MAX_DEPTH}: this is no SRDF"));
    }
    let document =
        Document::parse(text).map_err(|error| format!("not well-formed XML ({error})"))?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(format!("found the element {:?}, expected 'robot'", root.tag_name().name()));
    }
    let mut semantics = Semantics::default();
    for node in root.children() {
        match node.tag_name().name() {
            "disable_collisions" => {
                let pair = [attribute(node, "link1")?, attribute(node, "link2")?];
                semantics.disabled_pairs.push(pair.map(str::to_owned));
            }
            "group_state" => {
                let state = semantics.states.entry(attribute(node, "name")?.to_owned());
                let state = state.or_default();
                for joint in node.children().filter(|node| node.has_tag_name("joint")) {
                    state.insert(attribute(joint, "name")?.to_owned(), position(joint)?);
                }
            }
            _ => {}
        }
    }
    Ok(semantics)
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    node.attribute(name).ok_or_else(|| {
        let element = node.tag_name().name();
        format!("line {}: an element '{element}' has no {name:?}", line(node))
    })
}

fn position(joint: Node<'_, '_>) -> Result<f64, String> {
    let value = attribute(joint, "value")?;
    let number = value.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        format!("line {}: the value {value:?} of a joint is no finite number", line(joint))
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
            ("'0.5'", "'0 0'", "line 2: the value \"0 0\""),
            ("name='b' ", "", "line 3: an element 'joint' has no \"name\""),
            ("name='away' ", "", "line 4: an element 'group_state' has no \"name\""),
        ] {
            let error = read_semantics(&text.replace(from, to)).unwrap_err();
            assert!(error.contains(says), "{error}");
        }
    }
}
