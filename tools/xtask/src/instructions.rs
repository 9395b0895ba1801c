//! Counts the instructions of fixed pieces of work, and compares them with what they were.
//!
//! The work is `cranny-bench count`; valgrind's callgrind counts what happens in one function of
//! it. The file stands for the development profile, in which the crates that compute are optimised:
//! it is what tests have built already. It counts assertions too, and says nothing of other
//! profiles but that less became more.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::{fs, thread};

/// Where the figures are kept, relative to the workspace.
const FILE: &str = "tools/instructions.txt";

/// What may be more without a report: a hash map's order, another layout of the code.
const TOLERANCE: f64 = 0.03;

const HEADING: &str = "\
# Instructions of fixed pieces of work in the development profile, by valgrind's callgrind.
# Checked by `cargo run -p xtask -- instructions`; written by the same with `--update`, which a change that
# makes them more has to justify.
";

/// What of a processor glibc does not use while instructions are counted. It copies memory and
/// computes sines with what it finds, and the same copy takes ten times the instructions on one
/// machine than on another: a verdict of 3,400 instructions differed by 3.6 %. Names that glibc
/// does not know it passes over.
const TUNABLES: &str = "glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-AVX512VL,-AVX_Fast_Unaligned_Load,-ERMS,-FSRM,\
                        -FMA,-FMA4,-SSSE3,-Prefer_ERMS,-Prefer_FSRM";

/// Whatever is counted by name.
type Figures = BTreeMap<String, u64>;

/// What came out of a comparison, a line each.
#[derive(Debug, Default, PartialEq, Eq)]
struct Verdict {
    wrong: Vec<String>,
    notes: Vec<String>,
}

/// Counts; writes the figures down where `update`, else compares. Prints what is to be known;
/// `Ok(false)` where something takes more than it did.
///
/// # Errors
///
/// No valgrind; work that does not build or fails; a file that cannot be read or written.
pub(crate) fn run(root: &Path, update: bool) -> Result<bool, String> {
    let file = root.join(FILE);
    let bench = built(root)?;
    let now = counted(&bench)?;
    if update {
        fs::write(&file, written(&now)).map_err(|e| format!("{}: {e}", file.display()))?;
        println!("instructions: {} figures written to {FILE}", now.len());
        return Ok(true);
    }
    let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let verdict = compared(&read(&text)?, &now);
    verdict.notes.iter().chain(&verdict.wrong).for_each(|line| println!("{line}"));
    println!("instructions: {} pieces of work, {} take more", now.len(), verdict.wrong.len());
    Ok(verdict.wrong.is_empty())
}

/// Those of `tools/test`: with others nearly every crate would be compiled again.
const FEATURES: &str = "cranny/scene,cranny/rapier,cranny/ecs,cranny/record,cranny/render";

/// The function that does the work.
const COUNTED: &str = "cranny_bench::count::counted*";

/// What sets it up as well: callgrind ignores a second option for the same pattern with `*`.
const SET_UP_AND_COUNTED: &str = "cranny_bench::count::set_up_and_counted*";

const BENCH: &str = "cranny-bench";

/// A test, which cargo builds beside the program: without one, cargo leaves out the features that
/// development dependencies turn on, and rapier, bevy and what is above them are compiled again.
const TEST: &str = "triangles";

/// The program that does the work, built as `tools/test` builds its tests: with their features,
/// without line tables, and not incrementally. Incremental compilation divides crates into other
/// parts, and the same work takes up to a fifth more.
fn built(root: &Path) -> Result<PathBuf, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(root)
        .envs([("CARGO_INCREMENTAL", "0"), ("CARGO_PROFILE_DEV_DEBUG", "0")])
        .args(["build", "--workspace", "--exclude", "cranny-rerun", "--features", FEATURES])
        .args(["--bin", BENCH, "--test", TEST, "--message-format", "json"])
        .output()
        .map_err(|e| format!("cannot run cargo build: {e}"))?;
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr);
        return Err(format!("cargo build failed: {}", why.trim()));
    }
    String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["target"]["name"] == BENCH)
        .find_map(|message| Some(PathBuf::from(message.get("executable")?.as_str()?)))
        .ok_or_else(|| format!("cargo build names no {BENCH}"))
}

/// All pieces of work: two processes at a time, each with those that share bodies.
fn counted(bench: &Path) -> Result<Figures, String> {
    let list = output(Command::new(bench).arg("count"))?.0;
    let waiting = Mutex::new(list.split("\n\n").map(lines));
    let figures = Mutex::new(Ok(Figures::new()));
    let lock = "nothing panics while it holds the lock";
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some(names) = waiting.lock().expect(lock).next() else { return };
                    let counts = instructions(bench, &names);
                    let mut figures = figures.lock().expect(lock);
                    match (&mut *figures, counts) {
                        (Ok(figures), Ok(counts)) => figures.extend(names.into_iter().zip(counts)),
                        (Ok(_), Err(error)) => *figures = Err(error),
                        (Err(_), _) => {}
                    }
                }
            });
        }
    });
    figures.into_inner().expect(lock)
}

fn lines(text: &str) -> Vec<String> {
    text.lines().map(str::to_owned).collect()
}

/// How many each piece of work takes, in the order of `names`.
fn instructions(bench: &Path, names: &[String]) -> Result<Vec<u64>, String> {
    let mut valgrind = Command::new("valgrind");
    valgrind
        .env("GLIBC_TUNABLES", TUNABLES)
        .args(["--tool=callgrind", "--combine-dumps=yes", "--callgrind-out-file=/dev/stdout"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(format!("--dump-after={SET_UP_AND_COUNTED}"))
        .arg(bench)
        .arg("count")
        .args(names);
    let (text, said) = output(&mut valgrind)?;
    let counts = collected(&text);
    match counts.len() == names.len() {
        true => Ok(counts),
        false => Err(format!(
            "valgrind counted {} of {} pieces of work, {names:?}; without any, {COUNTED} is no \
             function of the program. It says:\n{said}",
            counts.len(),
            names.len()
        )),
    }
}

/// Standard output and standard error of a command that succeeded.
fn output(command: &mut Command) -> Result<(String, String), String> {
    let output = command.output().map_err(|e| format!("cannot run {command:?}: {e}"))?;
    let [out, err] = [&output.stdout, &output.stderr].map(|t| String::from_utf8_lossy(t).into());
    match output.status.success() {
        true => Ok((out, err)),
        false => Err(format!("{command:?} failed: {err}")),
    }
}

/// The numbers behind `totals:`, of each part that callgrind writes. Parts without a count are left
/// out: that of the program's end, and all if the function is not found.
fn collected(found: &str) -> Vec<u64> {
    let totals = found.lines().filter_map(|line| line.strip_prefix("totals:"));
    totals.filter_map(|number| number.trim().parse().ok()).filter(|&count| count > 0).collect()
}

fn written(figures: &Figures) -> String {
    let mut text = HEADING.to_owned();
    for (name, count) in figures {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{count:>12}  {name}");
    }
    text
}

fn read(text: &str) -> Result<Figures, String> {
    let lines = text.lines().enumerate();
    let figures = lines.filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
    figures
        .map(|(i, line)| {
            let parsed = line.trim().split_once("  ").and_then(|(count, name)| {
                Some((name.trim().to_owned(), count.parse::<u64>().ok()?))
            });
            parsed.ok_or_else(|| {
                format!("{FILE}:{}: expected a count, two spaces and a name: {line:?}", i + 1)
            })
        })
        .collect()
}

fn compared(kept: &Figures, now: &Figures) -> Verdict {
    let mut verdict = Verdict::default();
    for (name, &count) in now {
        let Some(&before) = kept.get(name) else {
            verdict.wrong.push(format!("{name}: {count}, and no figure is kept: use --update"));
            continue;
        };
        let change = count as f64 / before as f64 - 1.0;
        let line = format!("{name}: {before} before, {count} now ({:+.1} %)", 100.0 * change);
        match change {
            c if c > TOLERANCE => verdict.wrong.push(line),
            c if c < -TOLERANCE => verdict.notes.push(format!("{line}: keep it with --update")),
            _ => {}
        }
    }
    for name in kept.keys().filter(|name| !now.contains_key(*name)) {
        verdict.wrong.push(format!("{name}: kept, and nobody does it any more: use --update"));
    }
    verdict
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(of: &[(&str, u64)]) -> Figures {
        of.iter().map(|&(name, count)| (name.to_owned(), count)).collect()
    }

    #[test]
    fn what_is_written_reads_back() {
        let some = figures(&[("walk near, cold", 12), ("load", 3_000_000_000)]);
        assert_eq!(read(&written(&some)), Ok(some));
        assert!(read("# a\n\n12 3").unwrap_err().starts_with("tools/instructions.txt:3: expected"));
        assert!(read("many  walk").is_err());
    }

    #[test]
    fn more_is_wrong_and_less_is_noted() {
        let kept = figures(&[("a", 1_000), ("b", 1_000), ("c", 1_000), ("gone", 1)]);
        let now = figures(&[("a", 1_029), ("b", 1_031), ("c", 900), ("new", 5)]);
        let Verdict { wrong, notes } = compared(&kept, &now);
        let begins = |lines: &[String]| -> Vec<String> {
            lines.iter().map(|line| line.split(':').next().unwrap_or("").to_owned()).collect()
        };
        assert_eq!(begins(&wrong), ["b", "new", "gone"]);
        assert_eq!(begins(&notes), ["c"]);
        assert!(wrong[0].contains("1031 now (+3.1 %)"), "{}", wrong[0]);
    }

    #[test]
    fn nothing_counted_is_no_count() {
        assert_eq!(
            collected("part: 1\ntotals: 813275\npart: 2\ntotals: 12\ntotals: 0\n"),
            [813_275, 12]
        );
        assert!(collected("totals: 0\nsummary: 7\n").is_empty());
    }
}
