//! Cells of tables that programs read.

/// A text that may hold commas, quotes and ends of lines, in quotes.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\"").replace(['\n', '\r'], " "))
}

/// As it is, or nothing.
pub(crate) fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// A line of names, then the rows.
pub(crate) fn table(columns: &str, rows: impl Iterator<Item = String>) -> String {
    std::iter::once(columns.to_owned()).chain(rows).map(|row| row + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_survive_commas_and_quotes() {
        assert_eq!(quoted("a \"b\", c\nd"), "\"a \"\"b\"\", c d\"");
    }
}
