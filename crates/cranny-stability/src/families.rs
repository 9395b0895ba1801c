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

/// Every family, in the order in which they are told.
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
const PAIR_FAILS: &str = "a wrong verdict (none, touch, cross; interiors meet; one in the other) under any demand; a \
distance outside its certified interval; an answer that memory or exchanging A and B changes";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, Settings};
    use std::time::Instant;

    fn run(family: &Family) -> Outcome {
        family.run(&Settings { seed: 3, variants: 1 }, None)
    }

    #[test]
    fn dbg_all() {
        for family in &FAMILIES {
            let start = Instant::now();
            let outcome = run(family);
            println!(
                "{} {} cases {} failed {:?} {:?} worst {:?} claim {:?}",
                family.name, outcome.cases.len(), outcome.failed(), start.elapsed(), outcome.counts,
                outcome.worst().map(|(c, f)| (c.name.clone(), f)), outcome.worst_of_claim()
            );
            for c in outcome.cases.iter().filter(|c| !c.faults.is_empty()).take(6) {
                println!("    {c:?}");
            }
        }
    }
}
