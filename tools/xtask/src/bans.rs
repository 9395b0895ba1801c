//! What the crates that compute must not name.

use crate::report::Violation;
use crate::tokens::{PathAt, Token, paths};

/// A ban and its reason.
struct Ban {
    rule: &'static str,
    reason: &'static str,
    applies: fn(&PathAt) -> bool,
}

const BANS: &[Ban] = &[
    Ban {
        rule: "no-files",
        reason: "the crates that compute do no input or output: take bytes in and hand bytes out; files are \
                 opened by cranny-scene, cranny-record and the command",
        applies: |path| {
            starts(path, &["std", "fs"])
                || starts(path, &["std", "net"])
                || ["stdin", "stdout", "stderr"].contains(&last(path))
                    && (path.followed_by == "(" || path.segments.len() > 1)
                || ["include", "include_str", "include_bytes"].contains(&last(path))
                    && path.followed_by == "!"
                || path.is_member
                    && path.followed_by == "("
                    && ["exists", "is_file", "is_dir", "metadata", "canonicalize", "read_dir"]
                        .contains(&last(path))
        },
    },
    Ban {
        rule: "no-process",
        reason: "the crates that compute depend on their arguments alone: settings are passed in",
        applies: |path| {
            starts(path, &["std", "process"])
                || starts(path, &["std", "env"])
                || starts(path, &["std", "thread"])
        },
    },
    Ban {
        rule: "no-alias-of-std",
        reason: "the other rules know std by its name: call it by that",
        applies: |path| {
            let is_std = path.segments == ["std"] || path.segments == ["std", "self"];
            is_std && path.followed_by == "as"
                || path.segments == ["crate"] && path.followed_by == "std"
        },
    },
    Ban {
        rule: "no-clock",
        reason: "answers must not depend on time: a time budget takes a clock that is passed in",
        applies: |path| {
            path.segments.iter().any(|word| word == "Instant" || word == "SystemTime")
                || starts(path, &["std", "time", "*"])
        },
    },
    Ban {
        rule: "no-gpu",
        reason: "only cranny-render touches a GPU: the others must run, and agree, on every machine",
        applies: |path| !path.is_member && path.segments[0] == "wgpu",
    },
    Ban {
        rule: "no-printing",
        reason: "a library returns what it has to say: as a value, a report, or an error",
        applies: |path| {
            path.followed_by == "!"
                && ["println", "eprintln", "print", "eprint", "dbg"].contains(&last(path))
        },
    },
    Ban {
        rule: "no-globals",
        reason: "state lives with its owner, so that two worlds in one process cannot meet: make it a field, \
                 or an argument",
        applies: |path| {
            path.segments.iter().any(|word| word == "LazyLock")
                || last(path) == "thread_local" && path.followed_by == "!"
                || path.segments == ["static"] && !path.followed_by.is_empty()
        },
    },
    Ban {
        rule: "no-late-values",
        reason: "what is made at first use makes somebody pay who did not ask, and is a global in a static: \
                 make it where its owner is made, or pass it in",
        applies: |path| path.segments.iter().any(|word| word == "OnceLock"),
    },
    Ban {
        rule: "f64-only",
        reason: "coordinates are f64 (glam's D-types) from file to answer: one f32 on the way would make \
                 'exact' untrue",
        applies: |path| path.segments.iter().any(|word| is_f32(word)),
    },
    Ban {
        rule: "no-transcendentals",
        reason: "sines, logarithms and the like differ between machines, and rapier's enhanced-determinism \
                 swaps them for the whole workspace: poses come as unit quaternions, and +, -, *, / and sqrt are \
                 the same everywhere",
        applies: |path| {
            let is_function =
                path.segments.len() > 1 || (path.is_member && path.followed_by == "(");
            is_function && TRANSCENDENTAL.contains(&last(path))
        },
    },
];

const F32_TYPES: &[&str] = &[
    "Vec2", "Vec3", "Vec3A", "Vec4", "Quat", "Mat2", "Mat3", "Mat3A", "Mat4", "Affine2", "Affine3A",
];

const TRANSCENDENTAL: &[&str] = &[
    "sin",
    "cos",
    "tan",
    "sin_cos",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "exp",
    "exp2",
    "exp_m1",
    "ln",
    "ln_1p",
    "log",
    "log2",
    "log10",
    "powf",
    "cbrt",
    "hypot",
    "from_axis_angle",
    "to_axis_angle",
    "from_scaled_axis",
    "to_scaled_axis",
    "from_rotation_x",
    "from_rotation_y",
    "from_rotation_z",
    "from_euler",
    "to_euler",
    "from_angle",
    "to_angle",
    "angle_between",
    "angle_to",
    "rotate_towards",
    "rotate_axis",
    "rotate_x",
    "rotate_y",
    "rotate_z",
    "slerp",
];

fn starts(path: &PathAt, with: &[&str]) -> bool {
    !path.is_member
        && path.segments.iter().map(String::as_str).take(with.len()).eq(with.iter().copied())
}

fn last(path: &PathAt) -> &str {
    path.segments.last().map_or("", String::as_str)
}

fn is_f32(word: &str) -> bool {
    word == "f32" || F32_TYPES.contains(&word)
}

/// What a folder or file may do though it is banned. Parry's tree and ours have boxes of single
/// precision, which are rounded outward there and decide nothing. A model that was loaded makes
/// some of its parts late: a field of its owner, which no static can be.
const EXEMPT: &[(&str, &str)] = &[
    ("crates/cranny-broad-phase/src/box_tree/", "f64-only"),
    ("crates/cranny-geometry/src/clusters/", "f64-only"),
    ("crates/cranny-narrow-phase/src/search/", "f64-only"),
    ("crates/cranny-narrow-phase/src/footprints.rs", "f64-only"),
    ("crates/cranny-geometry/src/on_demand.rs", "no-late-values"),
];

/// Every ban that a file breaks, in order of lines.
pub(crate) fn check(file: &str, tokens: &[Token]) -> Vec<Violation> {
    let is_exempt = |ban: &&Ban| {
        EXEMPT.iter().any(|(folder, rule)| file.starts_with(folder) && ban.rule == *rule)
    };
    let bans: Vec<&Ban> = BANS.iter().filter(|ban| !is_exempt(ban)).collect();
    let mut violations = Vec::new();
    for path in paths(tokens) {
        for ban in bans.iter().filter(|ban| (ban.applies)(&path)) {
            violations.push(Violation {
                place: format!("{file}:{}", path.line),
                rule: ban.rule,
                found: format!("`{}`", path.segments.join("::")),
                reason: ban.reason,
            });
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{strip, tokens};

    fn rules(source: &str) -> Vec<&'static str> {
        let found = check("x.rs", &tokens::of(&strip::strip(source).text));
        found.into_iter().map(|violation| violation.rule).collect()
    }

    #[test]
    fn one_folder_may_be_exempt_from_one_ban() {
        let tokens = tokens::of(&strip::strip("fn f(x: f32) { std::process::exit(1) }").text);
        let rules = |file: &str| -> Vec<_> {
            check(file, &tokens).into_iter().map(|violation| violation.rule).collect()
        };
        assert_eq!(rules("crates/cranny-broad-phase/src/box_tree/fat.rs"), ["no-process"]);
        assert_eq!(rules("crates/cranny-broad-phase/src/lib.rs"), ["f64-only", "no-process"]);
    }

    #[test]
    fn one_file_may_make_values_late_but_no_statics() {
        let source = "use std::sync::OnceLock; static N: OnceLock<u32> = OnceLock::new();";
        let tokens = tokens::of(&strip::strip(source).text);
        let has = |file: &str, rule| check(file, &tokens).iter().any(|found| found.rule == rule);
        let file = "crates/cranny-geometry/src/on_demand.rs";
        assert!(has(file, "no-globals") && !has(file, "no-late-values"));
        for other in ["crates/cranny-geometry/src/model.rs", "crates/cranny-world/src/lib.rs"] {
            assert!(has(other, "no-globals") && has(other, "no-late-values"));
        }
    }

    #[test]
    fn each_ban_bites() {
        for (source, rule) in [
            ("use std::fs;", "no-files"),
            ("use std::{io, fs::File};", "no-files"),
            ("let a = std::net::TcpStream::connect(b);", "no-files"),
            ("std::io::stdout()", "no-files"),
            ("std::process::exit(1)", "no-process"),
            ("std::env::var(x)", "no-process"),
            ("use std::time::{Duration, Instant};", "no-clock"),
            ("use std::time; fn f() { time::SystemTime::now() }", "no-clock"),
            ("use wgpu::Device;", "no-gpu"),
            ("println!(x)", "no-printing"),
            ("std::eprintln!(x)", "no-printing"),
            ("static mut N: u32 = 0;", "no-globals"),
            ("static N: AtomicU64 = AtomicU64::new(0);", "no-globals"),
            ("use std::io::{self}; fn f() { io::stdout() }", "no-files"),
            ("let t = include_str!(\"a\");", "no-files"),
            ("if path.exists() {}", "no-files"),
            ("std::thread::spawn(f)", "no-process"),
            ("use std as s;", "no-alias-of-std"),
            ("extern crate std as t;", "no-alias-of-std"),
            ("let y = (x as f32) as f64;", "f64-only"),
            ("static N: OnceLock<u32> = OnceLock::new();", "no-globals"),
            ("static N: LazyLock<u32> = LazyLock::new(f);", "no-globals"),
            ("struct S(std::sync::OnceLock<u32>);", "no-late-values"),
            ("thread_local! { }", "no-globals"),
            ("fn f(v: glam::Vec3) {}", "f64-only"),
            ("use glam::{DVec3, Quat};", "f64-only"),
            ("let q = Quat::IDENTITY;", "f64-only"),
            ("x.sin()", "no-transcendentals"),
            ("x.map(f64::acos)", "no-transcendentals"),
            ("DQuat::from_rotation_x(a)", "no-transcendentals"),
            ("x\n    .powf(2.0)", "no-transcendentals"),
        ] {
            assert!(rules(source).contains(&rule), "{source}: {:?}", rules(source));
        }
    }

    #[test]
    fn what_only_looks_alike_passes() {
        for source in [
            "use std::time::Duration;",
            "use glam::{DVec3, DQuat, DMat3};",
            "let s: &'static str = \"std::fs println! x.sin()\"; // std::env",
            "/// Never call `std::fs`.\nfn f() {}",
            "#[cfg(test)]\nmod tests { use std::fs; fn f() { println!(x); 1.0.sin() } }",
            "let exp = a.exp; x.sqrt() + x.mul_add(y, z)",
            "const TABLE: [u8; 2] = [0, 1]; use std::fmt; self.process.env",
            "fn f(s: &'static str) -> Box<dyn Fn() + 'static> {}",
            "enum Op { Print } fn print() {}",
        ] {
            assert_eq!(rules(source), [""; 0], "{source}");
        }
    }

    #[test]
    fn the_message_names_the_place_the_rule_and_the_reason() {
        let found = check("a/b.rs", &tokens::of("\n\nuse std::fs::File;"));
        let text = found[0].to_string();
        assert!(
            text.starts_with("a/b.rs:3: [no-files] `std::fs::File`\n    the crates that"),
            "{text}"
        );
    }
}
