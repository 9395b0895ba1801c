//! Small numbers that decide something must have a name.

use crate::report::Violation;
use crate::tokens::{Kind, Token};

/// Floating-point literals below this are suspected to be tolerances. Smaller: an epsilon of a
/// hundred-thousandth goes unnoticed. Larger: ordinary conversions of units are reported.
const SUSPECT: f64 = 1e-4;

/// Every small literal outside the definition of a constant.
pub(crate) fn check(file: &str, tokens: &[Token]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut in_constant = None;
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate() {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            ";" if in_constant.is_some_and(|start| depth <= start) => in_constant = None,
            "const" | "static" if in_constant.is_none() && names_a_value(&tokens[at + 1..]) => {
                in_constant = Some(depth);
            }
            _ => {}
        }
        if in_constant.is_none() && is_suspect(token) {
            violations.push(Violation {
                place: format!("{file}:{}", token.line),
                rule: "named-tolerances",
                found: format!("`{}`", token.text),
                reason: "a small number without a name is a tolerance that nobody decided on: make it a const \
                         that says what fails when it is smaller and when it is larger, or use cranny_exact's",
            });
        }
    }
    violations
}

/// Whether `NAME: Type` follows, rather than `fn`, a block or a raw pointer's pointee.
fn names_a_value(next: &[Token]) -> bool {
    matches!(next, [name, colon, ..] if name.kind == Kind::Word && colon.text == ":")
}

fn is_suspect(token: &Token) -> bool {
    let text = token.text.replace('_', "");
    let digits = text.strip_suffix("f64").or(text.strip_suffix("f32")).unwrap_or(&text);
    let is_float = digits.contains(['.', 'e', 'E']) && !digits.starts_with("0x");
    token.kind == Kind::Number
        && is_float
        && digits.parse::<f64>().is_ok_and(|value| value > 0.0 && value < SUSPECT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{strip, tokens};

    fn lines(source: &str) -> Vec<String> {
        let found = check("x.rs", &tokens::of(&strip::strip(source).text));
        found.into_iter().map(|violation| violation.place).collect()
    }

    #[test]
    fn unnamed_small_numbers_are_found() {
        assert_eq!(lines("if d < 1e-9 {}"), ["x.rs:1"]);
        assert_eq!(lines("f(\n0.000_01,\n1E-12_f64)"), ["x.rs:2", "x.rs:3"]);
        assert_eq!(lines("const fn f() -> f64 { 1e-9 }"), ["x.rs:1"]);
        assert_eq!(lines("const N: f64 = 1e-9; if d < 2e-9 {}"), ["x.rs:1"]);
        assert_eq!(lines("const N: [f64; 2] = [1e-9, 0.0];\nlet x = 1e-9;"), ["x.rs:2"]);
    }

    #[test]
    fn names_zeros_and_ordinary_numbers_pass() {
        for source in [
            "const NAME: f64 = 1e-9;",
            "pub(crate) const A: &[f64] = &[1e-9, { 1e-8 }];",
            "static A: f64 = 1e-9;",
            "let x = 0.0 + 1e-4 + 1e9 + 0x1e-9 as f64;",
            "// 1e-9\n/// 1e-9\nlet x = \"1e-9\";",
            "#[cfg(test)] mod tests { fn f() { g(1e-9) } }",
        ] {
            assert_eq!(lines(source), [""; 0], "{source}");
        }
    }
}
