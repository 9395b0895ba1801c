//! In each crate a type name means one thing: whoever searches for a name finds one definition.

use crate::report::Violation;
use crate::tokens::{Kind, Token};
use std::collections::BTreeMap;

/// The definitions of types of one crate.
pub(crate) struct TypeNames {
    places: BTreeMap<String, Vec<String>>,
}

impl TypeNames {
    pub(crate) fn new() -> Self {
        Self { places: BTreeMap::new() }
    }

    /// Adds the definitions of a file.
    pub(crate) fn add(&mut self, file: &str, tokens: &[Token]) {
        for (line, name) in definitions(tokens) {
            self.places.entry(name.to_owned()).or_default().push(format!("{file}:{line}"));
        }
    }

    /// Returns a violation for each definition of a name but its first.
    pub(crate) fn check(&self) -> Vec<Violation> {
        let mut violations = Vec::new();
        for (name, places) in &self.places {
            for place in &places[1..] {
                violations.push(Violation {
                    place: place.clone(),
                    rule: "type-names",
                    found: format!("`{name}` is a type at {} as well", places[0]),
                    reason: "a type name means one thing in a crate: say in the name what this one is",
                });
            }
        }
        violations
    }
}

/// Every struct, enum, union, trait and type alias, with its line. Associated types are none: they
/// stand within braces.
fn definitions(tokens: &[Token]) -> Vec<(usize, &str)> {
    let mut depth = 0;
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let defines = match token.text.as_str() {
            "{" | "(" | "[" => {
                depth += 1;
                false
            }
            "}" | ")" | "]" => {
                depth -= 1;
                false
            }
            "struct" | "enum" | "trait" => true,
            "type" => depth == 0,
            // A word like any other elsewhere.
            "union" => at == 0 || matches!(tokens[at - 1].text.as_str(), "pub" | ")" | "]" | "}"),
            _ => false,
        };
        if let Some(name) = tokens.get(at + 1).filter(|next| defines && next.kind == Kind::Word) {
            found.push((name.line, name.text.as_str()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{strip, tokens};

    fn of(source: &str) -> Vec<Token> {
        tokens::of(&strip::strip(source).text)
    }

    fn names(source: &str) -> Vec<String> {
        definitions(&of(source)).into_iter().map(|(_, name)| name.to_owned()).collect()
    }

    #[test]
    fn types_of_every_kind_are_found() {
        let source = "pub struct A(u32); enum B {}\npub(crate) trait C { type X; }\ntype D = A; \
                      #[repr(C)] union E { a: u8 } impl C for A { type X = u8; } fn f() { struct F; }";
        assert_eq!(names(source), ["A", "B", "C", "D", "E", "F"]);
    }

    #[test]
    fn tests_comments_and_words_define_nothing() {
        for source in [
            "#[cfg(test)] mod tests { struct A; }",
            "// struct A;\nlet x = \"struct A\";",
            "fn f() { a.union(b) }",
            "macro_rules! m { ($name:ident) => { struct $name; } }",
        ] {
            assert_eq!(names(source), [""; 0], "{source}");
        }
    }

    #[test]
    fn the_second_definition_in_a_crate_is_reported_with_the_place_of_the_first() {
        let mut found = TypeNames::new();
        found.add("a.rs", &of("struct One;\n\nstruct Two;"));
        assert_eq!(found.check(), []);
        found.add("b.rs", &of("\nenum Two {}"));
        let violations = found.check();
        assert_eq!(violations.len(), 1);
        assert_eq!(violations[0].place, "b.rs:2");
        assert_eq!(violations[0].found, "`Two` is a type at a.rs:3 as well");
    }
}
