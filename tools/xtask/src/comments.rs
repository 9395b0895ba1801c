//! Comments of source files keep within the columns of prose.

use crate::report::Violation;
use std::path::Path;

/// The most columns of a line of prose, in comments and in pages. Tables and code are as wide as
/// they are.
pub(crate) const COLUMNS: usize = 100;

/// Returns every comment that is too wide; `file` is a path relative to the workspace.
pub(crate) fn check(file: &Path, text: &str) -> Vec<Violation> {
    let shown = file.display().to_string();
    wide_comments(text)
        .map(|(line, columns)| Violation {
            place: format!("{shown}:{line}"),
            rule: "comment-columns",
            found: format!("{columns} columns"),
            reason: "break comments at 100 columns",
        })
        .collect()
}

/// Lines that are comments and too wide, with their columns; without tables, code of examples, and
/// what has no blank to be broken at.
fn wide_comments(text: &str) -> impl Iterator<Item = (usize, usize)> {
    let mut in_fence = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let comment = line.trim_start().strip_prefix("//")?.trim_start_matches(['/', '!']);
        let prose = comment.trim();
        if prose.starts_with("```") {
            in_fence = !in_fence;
        }
        let columns = line.chars().count();
        let is_prose = !in_fence && !prose.starts_with('|') && prose.contains(' ');
        (columns > COLUMNS && is_prose).then_some((index + 1, columns))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<usize> {
        wide_comments(text).map(|(line, _)| line).collect()
    }

    #[test]
    fn wide_comments_of_every_kind_are_found() {
        let wide = "word ".repeat(25);
        let text = format!("//! {wide}\nlet x = 1;\n    /// {wide}\n// {wide}\n// narrow\n");
        assert_eq!(lines(&text), [1, 3, 4]);
        assert_eq!(check(Path::new("src/a.rs"), &text)[1].place, "src/a.rs:3");
    }

    #[test]
    fn columns_are_characters() {
        assert_eq!(lines(&format!("// {} é", "é".repeat(95))), [0; 0]);
        assert_eq!(lines(&format!("// {} é", "é".repeat(96))), [1]);
    }

    #[test]
    fn tables_code_and_links_are_as_wide_as_they_are() {
        let wide = "word ".repeat(25);
        for text in [
            format!("/// | {wide} |"),
            format!("/// ```\n/// {wide}\n/// ```"),
            format!("/// {}", "x".repeat(120)),
            format!("let text = \"{wide}\";"),
        ] {
            assert_eq!(lines(&text), [0; 0], "{text}");
        }
    }
}
