//! The table of families.

mod contacts;
mod crossings;
mod hulls;
mod memory;
mod needles;
mod order;
mod parallel;
mod sizes;
mod slots;
mod walk;

use crate::family::Family;

/// Every family, in the order in which they are listed.
pub const FAMILIES: [Family; 10] = [
    contacts::FAMILY,
    crossings::FAMILY,
    slots::FAMILY,
    needles::FAMILY,
    sizes::FAMILY,
    parallel::FAMILY,
    hulls::FAMILY,
    walk::FAMILY,
    memory::FAMILY,
    order::FAMILY,
];

/// What a pair's figure is.
const DISTANCE_ERROR: &str = "error of the distance, in sizes of the larger body";

/// What fails a pair.
const PAIR_FAILS: &str = "a wrong verdict (none, touch, cross; interiors meet; one in the other) under any demand; no \
distance where one is demanded; a distance or a depth outside its certified interval, or off by more than this allows; \
an interval of more than four length errors (for a depth, of more than 2^-26 sizes); an answer that memory or exchanging A and B changes";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, Settings};

    fn run(family: &Family, seed: u64) -> Outcome {
        family.run(&Settings { seed, variants: 1 }, None)
    }

    #[test]
    fn no_case_of_any_family_fails() {
        let mut report = String::new();
        for family in &FAMILIES {
            let outcome = run(family, 1);
            if outcome.cases.len() < 20 {
                report += &format!("{}: {} cases\n", family.name, outcome.cases.len());
            }
            for case in outcome.cases.iter().filter(|case| !case.faults.is_empty()) {
                report += &format!("{}: {}: {}\n", family.name, case.name, case.faults.join("; "));
            }
        }
        assert_eq!(report, "");
    }

    #[test]
    fn contacts_are_apart_touch_and_overlap_whatever_the_seed() {
        for seed in 2..5 {
            let outcome = run(&contacts::FAMILY, seed);
            // 11 sizes of gaps, each lifted, touching, sunk in, and twice sunk in with known depth.
            let of = |what| outcome.counts.get(what).copied().unwrap_or(0);
            assert!(of("touching") >= 11 && of("crossing") >= 22, "{:?}", outcome.counts);
            assert_eq!(outcome.cases.len(), 55);
            assert_eq!(outcome.failed(), 0);
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_cases_and_names_differ() {
        for family in [contacts::FAMILY, needles::FAMILY] {
            let answers = |seed| -> Vec<String> {
                let cases = run(&family, seed).cases;
                cases.into_iter().map(|case| case.name + &case.truth + &case.answer).collect()
            };
            assert_eq!(answers(7), answers(7));
            assert_ne!(answers(7), answers(8));
        }
        let names: std::collections::BTreeSet<_> = FAMILIES.iter().map(|f| f.name).collect();
        assert_eq!(names.len(), FAMILIES.len());
    }
}
