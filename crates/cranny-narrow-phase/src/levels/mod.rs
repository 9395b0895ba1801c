//! Estimates: what is certain of a pair when only so much may be spent on it.
//!
//! # The story
//!
//! [`estimate`] takes an [`Effort`]: a level ([`Accuracy`]), which says what may be read of the bodies, and a
//! budget (`effort`), which says how long. Boxes, trees to a depth and the whole are one method, `refinement`:
//! a cut through the pairs of nodes, opened nearest first, on which `scope` sets the level's limits; `findings`
//! keeps what faces told. Hulls and caps ask the walk first (`hull_gap`), and caps go on with the nodes that
//! hold faces on the hull (a `node_set`). What was certain in the last frame stays so but for motion
//! (`carried`), so what a level or a budget left open is narrowed by and by. `places` tells where contact may
//! be.
//!
//! # Promises
//!
//! No level and no budget excludes what [`query`] finds: [`Verdict::Excluded`] and
//! [`Verdict::Certain`] agree with it, the interval holds its distance, the places hold its contacts
//! across gaps, and where surfaces meet; not the points of a contact that is deeper than the margin.
//! An effort without limits *is* [`query`], which pays nothing for any of this.
//!
//! An [`Answer`](crate::Answer) stays what it was, exact in every field: whoever reads one need not ask how it came
//! about. What is not certain is an [`Estimate`], and says so by type.

mod carried;
mod effort;
mod estimate;
mod findings;
mod ground;
mod hull_gap;
mod places;
mod refinement;
mod scope;

use cranny_exact::{Aabb, Interval, Meeting, Pose};
use cranny_geometry::Model;

pub(crate) use carried::Carried;
pub use effort::{Accuracy, Budget, Clock, Effort};
pub use estimate::{Estimate, Place, Verdict};
pub(crate) use ground::Ground;

use crate::answer::Surface;
use crate::containment::{Solidity, solidity};
use crate::evaluate::{QueryError, accepted, check_numbers, query};
use crate::memory::PairMemory;
use crate::pair::{Pair, Side};
use crate::query::{Demand, Placed, Query};
use effort::Meter;
use findings::Findings;
use places::places;
use scope::Scope;

/// Estimates what is asked about two placed models, by no more effort than allowed.
///
/// What is told is certain. Memory makes it tell more: it holds the bounds of the last estimate and what
/// was opened for them (40 bytes each, 5 MiB at most). Exchanging A and B exchanges what is told.
///
/// The demand says what the effort is for: `Intersects`, to close the verdict; `Distance`, to narrow the
/// interval, down to what is no longer below the asked bound; `Contacts` and `Regions`, to find all places within the margin.
///
/// Cost: the budget. Not counted are the first preparations for `Hulls` and `Caps` (linear in the
/// hull, and in the faces), the steps of a walk once it has begun (mostly one), and listing places.
///
/// # Errors
///
/// As [`query`].
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Mesh, Model};
/// use cranny_narrow_phase::{
///     Accuracy, Demand, Effort, PairMemory, Placed, Query, Verdict, estimate,
/// };
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let a = Placed { model: &model, pose: Pose::IDENTITY };
/// let b = Placed { model: &model, pose: Pose::at(DVec3::new(0.75, 0.75, 0.0)) };
/// let (question, mut memory) = (Query::of(Demand::Distance { below: None }), PairMemory::default());
/// // The boxes overlap, so they cannot tell; the hulls can.
/// let boxes = estimate(a, b, &question, &Effort::of(Accuracy::Boxes), &mut memory)?;
/// assert_eq!(boxes.verdict, Verdict::Open);
/// let hulls = estimate(a, b, &question, &Effort::of(Accuracy::Hulls), &mut memory)?;
/// assert_eq!(hulls.verdict, Verdict::Excluded);
/// // Whatever is told holds the distance, and memory narrows it.
/// let exact = estimate(a, b, &question, &Effort::tests(100), &mut memory)?;
/// assert!((exact.separation.lo - 0.5f64.sqrt() / 2.0).abs() < 1e-12);
/// assert!(boxes.separation.lo <= exact.separation.lo && exact.separation.hi <= boxes.separation.hi);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate(
    a: Placed,
    b: Placed,
    question: &Query,
    effort: &Effort,
    memory: &mut PairMemory,
) -> Result<Estimate, QueryError> {
    if effort.is_all() {
        return query(a, b, question, memory).map(Estimate::of_answer);
    }
    let [a, b] = accepted(a, b)?;
    check_numbers(&question.demand)?;
    if question.demand == Demand::None {
        return Ok(Estimate::blank());
    }
    let pair = Pair::new(a, b, &mut memory.posed);
    let mut estimator = Estimator {
        ground: Ground::of(&pair),
        findings: Findings::new(&pair, question.demand),
        carried: Carried::at(&mut memory.levels, &pair),
        meter: Meter::of(effort.budget),
        hulls_apart: false,
        complete: true,
    };
    estimator.recall();
    estimator.spend(&pair, question.demand, effort.accuracy);
    Ok(estimator.sum_up(&pair, question.demand))
}

impl PairMemory {
    /// Makes what estimates at a level read besides the models, so that the first of them need not: the
    /// features of the hulls for `Hulls`, and which nodes hold faces on them for `Caps`. Clones share it.
    ///
    /// Cost: linear in the hulls and the faces; nothing for other levels.
    pub fn prepare(&mut self, a: &Model, b: &Model, accuracy: Accuracy) {
        let placed = |model| Placed { model, pose: Pose::IDENTITY };
        let pair = Pair::new(placed(a), placed(b), &mut self.posed);
        Carried::at(&mut self.levels, &pair).prepare(&pair, accuracy);
    }
}

struct Estimator<'p, 'm> {
    ground: Ground<'m>,
    findings: Findings<'p, 'm>,
    carried: &'p mut Carried,
    meter: Meter<'p>,
    hulls_apart: bool,
    /// All was looked at that can change anything.
    complete: bool,
}

impl Estimator<'_, '_> {
    /// Looks at the faces that met last, or were nearest.
    fn recall(&mut self) {
        let Some([f, g]) = self.carried.faces else { return };
        if self.meter.take(Findings::TESTS_A_LOOK) {
            self.findings.look(f, g);
        } else {
            self.complete = false;
        }
    }

    fn spend(&mut self, pair: &Pair, demand: Demand, accuracy: Accuracy) {
        let scope = match accuracy {
            Accuracy::Boxes => Scope::Depth(0),
            Accuracy::Tree(depth) => Scope::Depth(depth),
            Accuracy::Exact => Scope::Whole,
            Accuracy::Hulls => {
                self.walk(pair);
                self.complete = false;
                return;
            }
            Accuracy::Caps => {
                self.walk(pair);
                if self.hulls_apart && demand == Demand::Intersects {
                    self.complete = false;
                    return;
                }
                let convex =
                    self.carried.convex.get_or_insert_with(|| carried::on_hull(pair)).clone();
                Scope::Convex(convex)
            }
        };
        let (ground, findings) = (&self.ground, &mut self.findings);
        let shaken = self.carried.shaken;
        let cut = &mut self.carried.refinement;
        self.complete &= cut.refine(ground, &scope, findings, &mut self.meter, shaken);
        let least = cut.least(ground);
        self.carried.distance.lo = self.carried.distance.lo.max(least);
    }

    /// Hull against hull; the walk is not interrupted once it has begun.
    fn walk(&mut self, pair: &Pair) {
        if self.findings.is_done() || !self.meter.take(1) {
            return;
        }
        self.findings.counters.hull_steps += 1;
        let Some(gap) = self.carried.hulls.walk(pair) else { return };
        self.findings.counters.hull_steps += gap.steps;
        self.meter.charge(gap.steps);
        self.hulls_apart = gap.apart;
        self.carried.distance.lo = self.carried.distance.lo.max(gap.lower);
        self.findings.offer_vertices(gap.vertices);
    }

    /// How the surfaces meet, if that is certain.
    fn surface(&self) -> Option<Surface> {
        match self.findings.surface {
            Meeting::Cross => Some(Meeting::Cross),
            Meeting::Touch => self.complete.then_some(Meeting::Touch),
            Meeting::None => {
                let apart = self.hulls_apart || self.complete || self.carried.distance.lo > 0.0;
                apart.then_some(Meeting::None)
            }
        }
    }

    /// What lies inside what, of surfaces that do not meet; `None` where the budget does not suffice.
    fn solidity(&mut self, pair: &Pair) -> Option<Solidity> {
        let outside = Solidity { solid: false, contained: None };
        if self.hulls_apart {
            return Some(outside);
        }
        if self.carried.apart.is_some() {
            return self.carried.apart;
        }
        if !self.meter.take(1) {
            return None;
        }
        self.findings.counters.node_tests += 1;
        let [first, second] = self.ground.trees.map(|tree| &tree.node(0).bounds);
        if self.ground.boxes.apart(first, second, 0.0) {
            return Some(outside);
        }
        let points = Side::BOTH.map(|side| pair.topology(side).components().len());
        let tests = points.iter().sum::<usize>() as u64;
        let counters = &mut self.findings.counters;
        self.meter.take(tests).then(|| solidity(pair, Meeting::None, &[], counters))
    }

    fn sum_up(mut self, pair: &Pair, demand: Demand) -> Estimate {
        let surface = self.surface();
        let solidity = match surface {
            Some(Meeting::None) => self.solidity(pair),
            Some(Meeting::Cross) => Some(Solidity { solid: true, contained: None }),
            Some(Meeting::Touch) | None => None,
        };
        let meets = self.findings.surface.meets();
        let verdict = match solidity {
            _ if meets => Verdict::Certain,
            Some(Solidity { solid: true, .. }) => Verdict::Certain,
            Some(Solidity { solid: false, .. }) => Verdict::Excluded,
            None => Verdict::Open,
        };
        let distance = self.distance(meets);
        let margin = demand.margin();
        let deepest = match surface {
            Some(Meeting::None) => 0.0,
            _ => margin.map_or(0.0, |_| deepest(pair)),
        };
        let places = match margin {
            Some(margin) if distance.lo <= margin => {
                places(pair, &self.ground, &self.carried.refinement, margin, distance.lo)
            }
            _ => Vec::new(),
        };
        let carried = self.carried;
        carried.distance = distance;
        carried.apart = solidity.filter(|_| surface == Some(Meeting::None));
        carried.faces = self.findings.faces().or(carried.faces);
        Estimate {
            verdict,
            surface,
            solid: solidity.map(|s| s.solid),
            contained: solidity.and_then(|s| s.contained).map(|c| pair.ordered_containment(c)),
            separation: Interval { lo: distance.lo - deepest, hi: distance.hi.min(farthest(pair)) },
            witnesses: self.findings.witnesses(),
            places,
            answer: None,
            counters: self.findings.counters,
        }
    }

    /// Holds the distance between the surfaces.
    fn distance(&self, meets: bool) -> Interval {
        if meets {
            return Interval::point(0.0);
        }
        let hi = self.carried.distance.hi.min(self.findings.upper());
        // Both are certain; rounding may make them pass each other where they meet.
        Interval { lo: self.carried.distance.lo.clamp(0.0, hi), hi }
    }
}

/// No two points of the bodies are farther apart: they lie in both bodies' boxes.
fn farthest(pair: &Pair) -> f64 {
    let [x, y] = Side::BOTH.map(|side| pair.bounds(side));
    (y.max - x.min).max(x.max - y.min).length().next_up() + pair.culling_error()
}

/// No region of contact is deeper: its pieces lie in both bodies' boxes.
fn deepest(pair: &Pair) -> f64 {
    let [x, y] = Side::BOTH.map(|side| pair.bounds(side));
    let common = Aabb { min: x.min.max(y.min), max: x.max.min(y.max) };
    common.diagonal().next_up() + pair.culling_error()
}
