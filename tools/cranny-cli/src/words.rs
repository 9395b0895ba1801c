//! Numbers, points and plurals.

use std::fmt::Display;

/// Six significant digits, plain where that is short. What is less than any normal number is what
/// rounding outward leaves of 0.
pub(crate) fn number(value: f64) -> String {
    match value.abs() {
        _ if !value.is_normal() && value.is_finite() => "0".to_owned(),
        size if (1e-3..1e6).contains(&size) => {
            let whole = size.log10().floor() as i32;
            let digits = (5 - whole).max(0) as usize;
            let text = format!("{value:.digits$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        _ => {
            let text = format!("{value:.5e}");
            let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
            format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
        }
    }
}

/// Between brackets.
pub(crate) fn point(p: [f64; 3]) -> String {
    let [x, y, z] = p.map(number);
    format!("({x}, {y}, {z})")
}

/// One, or many with the plural.
pub(crate) fn counted<N: Copy + Display + PartialEq + From<u8>>(count: N, what: &str) -> String {
    match (what.strip_suffix("vertex"), what.strip_suffix("body")) {
        _ if count == N::from(1) => format!("1 {what}"),
        (Some(kind), _) => format!("{count} {kind}vertices"),
        (_, Some(kind)) => format!("{count} {kind}bodies"),
        _ => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_and_no_tail() {
        let cases = [
            (0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (1.0 / 3.0, "0.333333"),
            (123_456.7, "123457"),
            (100.0, "100"),
            (-0.0, "0"),
            (5e-323, "0"),
            (1e-7, "1e-7"),
            (-2.5e-12, "-2.5e-12"),
            (1e-7 / 3.0, "3.33333e-8"),
            (2e9, "2e9"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn things_are_counted_in_one_or_many() {
        assert_eq!(counted(1, "isolated vertex"), "1 isolated vertex");
        assert_eq!(counted(2, "isolated vertex"), "2 isolated vertices");
        assert_eq!(
            [counted(0, "lid"), counted(3_usize, "vertex"), counted(2_u64, "fixed body")],
            ["0 lids", "3 vertices", "2 fixed bodies"]
        );
    }
}
