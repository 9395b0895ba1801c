//! Lines of code: what has to be read, without tests, comments and blank lines.

use crate::report::Violation;
use crate::sources::SourceFile;

/// Crates that stay within so many lines. A way to an answer that is added there takes the place of
/// another one.
const BOUNDS: [(&str, usize); 1] = [("cranny-narrow-phase", 9_000)];

/// Lines of code in a crate's files.
pub(crate) fn lines(files: &[SourceFile]) -> usize {
    files.iter().map(|file| lines_of(&file.stripped.text)).sum()
}

fn lines_of(text: &str) -> usize {
    text.lines().filter(|line| !line.trim().is_empty()).count()
}

/// Returns a violation where a crate has more lines than its bound.
pub(crate) fn check(name: &str, folder: &str, lines: usize) -> Option<Violation> {
    let (_, most) = BOUNDS.iter().find(|(bounded, _)| *bounded == name)?;
    (lines > *most).then(|| Violation {
        place: folder.to_owned(),
        rule: "sizes",
        found: format!("{lines} lines of code, at most {most}"),
        reason: "two ways to one answer are a debt: take out what the new one replaces",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strip::strip;

    #[test]
    fn comments_tests_and_blank_lines_do_not_count() {
        let source = "//! Words.\n\nfn f() {\n    /* more\n    words */\n    g(); // a word\n}\n\n\
                      #[cfg(test)]\nmod tests {\n    fn t() {}\n}\n";
        assert_eq!(lines_of(&strip(source).text), 3);
    }

    #[test]
    fn a_crate_beyond_its_bound_is_named() {
        let (name, most) = BOUNDS[0];
        assert_eq!(check(name, "crates/it", most), None);
        let found = check(name, "crates/it", most + 1).expect("a violation").found;
        assert_eq!(found, "9001 lines of code, at most 9000");
        assert_eq!(check("cranny-ecs", "crates/it", 1_000_000), None);
    }
}
