//! Blanks out of a source text what is not code of the product: comments, the contents of strings
//! and characters, and items under `#[cfg(test)]` or `#[cfg(doctest)]`. Line numbers stay.

/// A source text of which only product code is left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stripped {
    /// The text, blanked; as many lines as before.
    pub(crate) text: String,
    /// Names of modules declared as `#[cfg(test)] mod name;`.
    pub(crate) test_modules: Vec<String>,
}

pub(crate) fn strip(source: &str) -> Stripped {
    let mut text = blank_comments_and_strings(source);
    let test_modules = blank_test_items(&mut text);
    Stripped { text: text.into_iter().collect(), test_modules }
}

/// Walks over the text; what is passed while `keep` is false becomes blank.
struct Blanker {
    rest: std::collections::VecDeque<char>,
    out: Vec<char>,
}

impl Blanker {
    fn peek(&self, ahead: usize) -> char {
        self.rest.get(ahead).copied().unwrap_or('\0')
    }

    fn starts_with(&self, text: &str) -> bool {
        text.chars().enumerate().all(|(ahead, c)| self.peek(ahead) == c)
    }

    fn pass(&mut self, count: usize, keep: bool) {
        for c in self.rest.drain(..count.min(self.rest.len())) {
            self.out.push(if keep || c == '\n' { c } else { ' ' });
        }
    }

    /// Whether the last character kept could belong to an identifier.
    fn in_identifier(&self) -> bool {
        self.out.last().is_some_and(|c| c.is_alphanumeric() || *c == '_')
    }

    fn block_comment(&mut self) {
        let mut depth = 0;
        loop {
            if self.starts_with("/*") {
                depth += 1;
                self.pass(2, false);
            } else if self.starts_with("*/") {
                depth -= 1;
                self.pass(2, false);
            } else {
                self.pass(1, false);
            }
            if depth == 0 || self.rest.is_empty() {
                return;
            }
        }
    }

    fn string(&mut self, quote: char) {
        self.pass(1, true);
        while !self.rest.is_empty() && self.peek(0) != quote {
            self.pass(if self.peek(0) == '\\' { 2 } else { 1 }, false);
        }
        self.pass(1, true);
    }

    /// Number of `#` of a raw string that starts here at its `r`.
    fn raw_string_hashes(&self) -> Option<usize> {
        let hashes = self.rest.iter().skip(1).take_while(|c| **c == '#').count();
        (self.peek(0) == 'r' && self.peek(1 + hashes) == '"').then_some(hashes)
    }

    fn raw_string(&mut self, hashes: usize) {
        self.pass(hashes + 2, false);
        let end = format!("\"{}", "#".repeat(hashes));
        while !self.rest.is_empty() && !self.starts_with(&end) {
            self.pass(1, false);
        }
        self.pass(end.len(), false);
    }

    /// Whether the `'` here opens a character rather than a lifetime.
    fn is_character(&self) -> bool {
        self.peek(1) == '\\' || self.peek(2) == '\''
    }
}

fn blank_comments_and_strings(source: &str) -> Vec<char> {
    let mut b = Blanker { rest: source.chars().collect(), out: Vec::with_capacity(source.len()) };
    while !b.rest.is_empty() {
        if b.starts_with("//") {
            while !b.rest.is_empty() && b.peek(0) != '\n' {
                b.pass(1, false);
            }
        } else if b.starts_with("/*") {
            b.block_comment();
        } else if b.peek(0) == '"' {
            b.string('"');
        } else if b.peek(0) == '\'' && b.is_character() {
            b.string('\'');
        } else if let (false, Some(hashes)) = (b.in_identifier(), b.raw_string_hashes()) {
            b.raw_string(hashes);
        } else if b.starts_with("br") && !b.in_identifier() {
            b.pass(1, true);
            // The `r` is not the middle of an identifier when a raw string follows.
            if let Some(hashes) = b.raw_string_hashes() {
                b.raw_string(hashes);
            }
        } else {
            b.pass(1, true);
        }
    }
    b.out
}

/// Blanks items under `#[cfg(test)]` and `#[cfg(all(test, ...))]`, and `doctest` likewise, and
/// names the modules among them that live in files of their own.
fn blank_test_items(text: &mut [char]) -> Vec<String> {
    let mut modules = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let Some(attribute_end) = test_attribute(text, at) else {
            at += 1;
            continue;
        };
        let end = item_end(text, attribute_end);
        let item: String = text[attribute_end..end].iter().collect();
        let words: Vec<&str> = item
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .filter(|w| !w.is_empty())
            .collect();
        if let (true, Some(mod_at)) =
            (item.ends_with(';'), words.iter().position(|word| *word == "mod"))
        {
            modules.extend(words.get(mod_at + 1).map(|name| (*name).to_owned()));
        }
        for c in &mut text[at..end] {
            if *c != '\n' {
                *c = ' ';
            }
        }
        at = end;
    }
    modules
}

/// The end of the attribute at `at`, if it is one that keeps its item for tests.
fn test_attribute(text: &[char], at: usize) -> Option<usize> {
    if text[at] != '#' || text.get(at + 1) != Some(&'[') {
        return None;
    }
    let end = group_end(text, at + 1);
    let inside: String = text[at..end].iter().filter(|c| !c.is_whitespace()).collect();
    let is_test = ["#[cfg(test)]", "#[cfg(doctest)]"].contains(&&*inside)
        || (inside.starts_with("#[cfg(all(")
            && inside.split(['(', ',', ')']).any(|w| ["test", "doctest"].contains(&w)));
    is_test.then_some(end)
}

/// The end of the item that starts at `at`: past its `;`, or past its braces.
fn item_end(text: &[char], mut at: usize) -> usize {
    while at < text.len() {
        match text[at] {
            ';' => return at + 1,
            '{' => return group_end(text, at),
            '(' | '[' => at = group_end(text, at),
            _ => at += 1,
        }
    }
    at
}

/// The end of the bracketed group that opens at `at`.
fn group_end(text: &[char], at: usize) -> usize {
    let mut depth = 0i32;
    for (offset, c) in text[at..].iter().enumerate() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + offset + 1;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(source: &str) -> Vec<String> {
        let stripped = strip(source);
        assert_eq!(stripped.text.lines().count(), source.lines().count(), "lines stay");
        stripped.text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn comments_go_nested_ones_too() {
        assert_eq!(words("a // std::fs\n/// doc std::fs\n/* x /* y */ z */ b"), ["a", "b"]);
    }

    #[test]
    fn strings_go_with_their_escapes_and_hashes() {
        assert_eq!(words(r##"f("a \" // b", c)"##).concat(), r#"f("",c)"#);
        assert_eq!(
            words("f(r#\"std::fs \" \"#, br\"1e-9\", b\"x\", r\"\")").concat(),
            "f(,b,b\"\",)"
        );
        assert_eq!(words("\"a\nstd::fs\" b"), ["\"", "\"", "b"]);
    }

    #[test]
    fn characters_go_and_lifetimes_stay() {
        assert_eq!(words("f::<'a>('\"', '\\'', b'/') // x").concat(), "f::<'a>('','',b'')");
        assert_eq!(words("&'static str"), ["&'static", "str"]);
    }

    #[test]
    fn identifiers_that_end_in_r_do_not_open_raw_strings() {
        assert_eq!(words("number#\"x\"; for_br\"y\" z").last().map(String::as_str), Some("z"));
        assert_eq!(words("r#type = 1"), ["r#type", "=", "1"]);
        assert_eq!(words("break bracket"), ["break", "bracket"]);
    }

    #[test]
    fn test_items_go_and_their_files_are_named() {
        let source = "a\n#[cfg(test)]\n#[allow(x)]\nmod tests {\n fn f() { '}' ; \"}\" }\n}\nb";
        assert_eq!(words(source), ["a", "b"]);
        assert_eq!(words("#[cfg(test)] use std::fs;\nb"), ["b"]);
        assert_eq!(words("#[cfg(all(test, unix))] fn f(a: [u8; 3]) { g() }\nb"), ["b"]);
        assert_eq!(words("#[cfg(doctest)] #[doc = include_str!(\"a\")] struct S;\nb"), ["b"]);
        assert_eq!(words("#[cfg(all(doctest, feature = \"x\"))] struct S;\nb"), ["b"]);
        assert_eq!(words("#[cfg(not(test))] fn f() {}").len(), 4);
        assert_eq!(strip("#[cfg(test)]\npub(crate) mod oracle;").test_modules, ["oracle"]);
        assert!(strip("#[cfg(test)] mod here { use std::fs; }").test_modules.is_empty());
    }
}
