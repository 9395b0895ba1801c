//! A look at XML before it is parsed: parsers recurse, and text that nests deeply enough would
//! exhaust the stack.

/// The byte at which elements nest deeper than `limit`, if they do. Knows comments, CDATA,
/// instructions and quoted attributes; text that is not well-formed is left for the parser to
/// refuse.
pub(crate) fn nested_beyond(text: &str, limit: usize) -> Option<usize> {
    let mut depth = 0usize;
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|offset| at + offset) {
        let rest = &text[open..];
        let after =
            |end: &str| rest.find(end).map_or(text.len(), |offset| open + offset + end.len());
        if rest.starts_with("<!--") {
            at = after("-->");
        } else if rest.starts_with("<![CDATA[") {
            at = after("]]>");
        } else if rest.starts_with("<?") {
            at = after("?>");
        } else {
            let (length, empty) = tag(rest);
            at = open + length;
            if rest.starts_with("</") {
                depth = depth.saturating_sub(1);
            } else if !empty && !rest.starts_with("<!") {
                depth += 1;
                if depth > limit {
                    return Some(open);
                }
            }
        }
    }
    None
}

/// Length of a tag, and whether it closes itself.
fn tag(rest: &str) -> (usize, bool) {
    let mut quote = None;
    let mut before = ' ';
    for (at, c) in rest.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '>') => return (at + 1, before == '/'),
            _ => {}
        }
        before = c;
    }
    (rest.len(), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_open_elements_count() {
        let flat =
            r#"<?xml <a> ?><a x="<b>" y='/>'><!-- <c><d> --><e/><![CDATA[<f><g>]]></a><a></a>"#;
        assert_eq!(nested_beyond(flat, 1), None);
        assert_eq!(nested_beyond("<a>ü<b/><c><d>", 2), Some(12));
        assert_eq!(nested_beyond(&"<a>".repeat(100), 99), Some(297));
        for unfinished in ["<", "<a", "<a x=\"", "<!--", "<?", "a"] {
            assert_eq!(nested_beyond(unfinished, 3), None);
        }
    }
}
