//! The debug switch: every query is answered a second time without memory, and the two are
//! compared.

use crate::answer::{Answer, Counters};
use crate::evaluate::{QueryError, query};
use crate::memory::PairMemory;
use crate::query::{Placed, Query};

/// Memory changed an answer: a fault of this crate. With models, poses and query it can be
/// reported, and looked into.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The answer with memory.
    pub warm: Answer,
    /// The answer without.
    pub cold: Answer,
}

impl Mismatch {
    /// Whether two answers to the same question differ, to the last bit and but for
    /// [counters](Answer::counters), which measure the work and not the result.
    #[must_use]
    pub fn between(warm: &Answer, cold: &Answer) -> Option<Self> {
        let mismatch = Self { warm: warm.clone(), cold: cold.clone() };
        (!mismatch.fields().is_empty()).then_some(mismatch)
    }

    /// The fields that differ, by their names in [`Answer`].
    #[must_use]
    pub fn fields(&self) -> Vec<&'static str> {
        let Answer {
            surface,
            solid,
            contained,
            distance,
            separation,
            witnesses,
            contacts,
            regions,
            penetrations,
            triangle_pairs,
            counters: Counters { .. },
        } = &self.warm;
        let cold = &self.cold;
        let differs = [
            ("surface", *surface != cold.surface),
            ("solid", *solid != cold.solid),
            ("contained", *contained != cold.contained),
            ("distance", *distance != cold.distance),
            ("separation", *separation != cold.separation),
            ("witnesses", *witnesses != cold.witnesses),
            ("contacts", *contacts != cold.contacts),
            ("regions", *regions != cold.regions),
            ("penetrations", *penetrations != cold.penetrations),
            ("triangle_pairs", *triangle_pairs != cold.triangle_pairs),
        ];
        differs.into_iter().filter(|(_, differs)| *differs).map(|(name, _)| name).collect()
    }
}

/// As [`query`], and then once more without memory: the first answer, whatever came of the
/// comparison, so that looking changes nothing; and the difference, if there is one.
///
/// Cost: a query and a cold one.
///
/// # Errors
///
/// As [`query`].
pub fn query_verified(
    a: Placed,
    b: Placed,
    question: &Query,
    memory: &mut PairMemory,
) -> Result<(Answer, Option<Box<Mismatch>>), QueryError> {
    let warm = query(a, b, question, memory)?;
    let cold = query(a, b, question, &mut PairMemory::default())?;
    let mismatch = Mismatch::between(&warm, &cold).map(Box::new);
    Ok((warm, mismatch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::Demand;
    use cranny_exact::{DVec3, Meeting, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};

    #[test]
    fn equal_answers_do_not_differ_and_others_say_where() {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mesh = Mesh::new(vertices, faces).unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let a = Placed { model: &model, pose: Pose::IDENTITY };
        let question = Query::of(Demand::Regions { margin: 0.1 });
        let mut memory = PairMemory::default();
        for x in [3.0, 2.9, 0.5, 0.25] {
            let b = Placed { model: &model, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
            let (answer, mismatch) = query_verified(a, b, &question, &mut memory).unwrap();
            assert_eq!(mismatch, None);
            let mut other = answer.clone();
            other.counters.node_tests += 1;
            assert_eq!(Mismatch::between(&answer, &other), None);
            other.surface = Meeting::Touch;
            other.distance = other.distance.map(f64::next_up);
            let found = Mismatch::between(&answer, &other).unwrap();
            assert_eq!(found.fields(), ["surface", "distance"]);
        }
        assert!(memory.bytes() > 0);
    }
}
