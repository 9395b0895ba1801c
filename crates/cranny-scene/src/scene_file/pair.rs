//! What a scene wants of single pairs.

use std::collections::{BTreeMap, BTreeSet};

use cranny_world::description::PairDescription;

use super::assemble::Assembly;
use super::problem::{SceneError, SceneProblem};
use super::syntax::{AccuracyFile, PairFile, effects};

/// The smaller number of two bodies first.
type Bodies = (usize, usize);

/// What the pairs so far say that another one may not contradict.
#[derive(Default)]
pub(super) struct NamedPairs {
    /// Bodies that are kept from meeting, and the pair that says so.
    apart: BTreeMap<Bodies, Named>,
    /// Bodies that a pair names by their own names, not by those of groups, with its level.
    accuracies: BTreeMap<Bodies, (Named, AccuracyFile)>,
}

/// A pair by its two names.
type Named = [String; 2];

impl Assembly<'_> {
    /// The bodies of a name: the one of that name, else those of the group.
    fn bodies_of(&self, field: &str, name: &str) -> Result<Vec<usize>, SceneError> {
        match (self.index_of(field, name), self.groups.get(name)) {
            (Ok(body), _) => Ok(vec![body]),
            (Err(_), Some(Ok(bodies))) => Ok(bodies.clone()),
            (Err(_), Some(Err(why))) => {
                let place = self.source.find(field, name);
                Err(self.source.error(place, SceneProblem::Contradiction(why.clone())))
            }
            (Err(unknown), None) => Err(unknown),
        }
    }

    /// The bodies of a pair, in the order of its names, each two once.
    fn bodies_of_pair(&self, pair: &PairFile) -> Result<Vec<(usize, usize)>, SceneError> {
        let [of_a, of_b] = [self.bodies_of("a", &pair.a)?, self.bodies_of("b", &pair.b)?];
        let mut known = BTreeSet::new();
        let pairs = of_a.iter().flat_map(|&a| of_b.iter().map(move |&b| (a, b)));
        let pairs: Vec<_> = pairs.filter(|&(a, b)| a != b && known.insert(sorted(a, b))).collect();
        if pairs.is_empty() {
            let what = match of_a.len().max(of_b.len()) {
                1 => format!("a pair names {:?} twice: a body does not meet itself", pair.a),
                _ => format!("the groups {:?} and {:?} have no two bodies", pair.a, pair.b),
            };
            return Err(self.refused_pair(pair, what));
        }
        Ok(pairs)
    }

    fn refused_pair(&self, pair: &PairFile, what: String) -> SceneError {
        let place = self.source.find("b", &pair.b);
        self.source.error(place, SceneProblem::Contradiction(what))
    }

    /// Adds a pair that may not meet.
    pub(super) fn keep_apart(&mut self, pair: &PairFile) -> Result<(), SceneError> {
        let bodies = self.bodies_of_pair(pair)?;
        if !pair.effects.is_empty() || pair.accuracy.is_some() {
            let has = if pair.effects.is_empty() { "an accuracy" } else { "effects" };
            let what = format!(
                "the pair {:?} and {:?} has {has}, but `collide: false` keeps it from meeting. Keep one of the two",
                pair.a, pair.b
            );
            return Err(self.refused_pair(pair, what));
        }
        for (a, b) in bodies {
            self.pairs.apart.entry(sorted(a, b)).or_insert_with(|| named(pair));
            self.description.excluded_pairs.push(sorted(a, b));
        }
        Ok(())
    }

    /// Adds what is wanted of a pair; all that are kept from meeting are known.
    pub(super) fn pair(&mut self, pair: &PairFile) -> Result<(), SceneError> {
        let bodies = self.bodies_of_pair(pair)?;
        if let [(a, b)] = bodies[..] {
            self.check_single(pair, sorted(a, b))?;
        }
        // The members of a group that never meet have no effects.
        for (a, b) in bodies {
            if !self.pairs.apart.contains_key(&sorted(a, b)) {
                self.add_pair(a, b, pair);
            }
        }
        Ok(())
    }

    /// Fails if another pair says the contrary of the same two bodies.
    fn check_single(&mut self, pair: &PairFile, bodies: Bodies) -> Result<(), SceneError> {
        let names = format!("the pair {:?} and {:?}", pair.a, pair.b);
        if let Some([a, b]) = self.pairs.apart.get(&bodies) {
            let what = format!(
                "{names} may meet, but the pair {a:?} and {b:?} with `collide: false` keeps them apart. Take one of the two out"
            );
            return Err(self.refused_pair(pair, what));
        }
        let Some(accuracy) = pair.accuracy else { return Ok(()) };
        let first = self.pairs.accuracies.entry(bodies).or_insert((named(pair), accuracy));
        if first.1 != accuracy {
            let ([a, b], other) = first;
            let what = format!(
                "{names} has the accuracy {accuracy:?}, but the pair {a:?} and {b:?} has {other:?}. Take one of the two out"
            );
            return Err(self.refused_pair(pair, what));
        }
        Ok(())
    }

    fn add_pair(&mut self, a: usize, b: usize, pair: &PairFile) {
        let name = |body: usize| self.description.bodies[body].name.clone();
        let described = PairDescription {
            a: name(a),
            b: name(b),
            effects: effects(&pair.effects),
            accuracy: pair.accuracy.map(AccuracyFile::level),
        };
        self.description.pairs.push(described);
    }
}

fn sorted(a: usize, b: usize) -> Bodies {
    (a.min(b), a.max(b))
}

fn named(pair: &PairFile) -> Named {
    [pair.a.clone(), pair.b.clone()]
}
