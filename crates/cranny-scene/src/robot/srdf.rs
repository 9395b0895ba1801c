//! Which pairs of links an SRDF file says never to check.

use roxmltree::Document;

use crate::byte_order_mark::without_mark;
use crate::xml::nested_beyond;

/// SRDF nests five elements.
const MAX_DEPTH: usize = 64;

/// Pairs of names of `disable_collisions`, in file order.
///
/// # Errors
///
/// One sentence: no well-formed XML, or an element without its two links, with its line.
pub fn disabled_pairs(text: &str) -> Result<Vec<[String; 2]>, String> {
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
    let disabled = root.children().filter(|node| node.has_tag_name("disable_collisions"));
    disabled
        .map(|node| {
            let link = |name| {
                node.attribute(name).map(str::to_owned).ok_or_else(|| {
                    let line = document.text_pos_at(node.range().start).row;
                    format!("line {line}: an element 'disable_collisions' has no {name:?}")
                })
            };
            Ok([link("link1")?, link("link2")?])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_read_and_half_of_one_is_refused() {
        let text = "<robot name='r'>\n<group name='g'/>\n<disable_collisions link1='a' link2='b' reason='Never'/></robot>";
        assert_eq!(disabled_pairs(text).unwrap(), [["a".to_owned(), "b".to_owned()]]);
        let half = text.replace(" link2='b'", "");
        assert!(disabled_pairs(&half).unwrap_err().contains("line 3"));
        assert!(disabled_pairs("<a/>").is_err() && disabled_pairs("<robot").is_err());
    }
}
