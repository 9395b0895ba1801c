//! The one entry: from a question and an effort to what is certain.

use cranny_exact::{Aabb, Interval, Meeting};
use cranny_narrow_phase::operations::{Pair, Side, Solidity};
use cranny_narrow_phase::{Demand, Placed, Query, QueryError, Surface, query};

use crate::effort::{Accuracy, Effort, Meter};
use crate::estimate::{Estimate, Verdict};
use crate::findings::Findings;
use crate::memory::EstimateMemory;
use crate::places::places;
use crate::scope::Scope;
use crate::trees::PairTrees;
use crate::warm_start::{WarmStart, hull_faces};

/// Estimates the answer to a question about two placed models, within an effort.
///
/// All that an estimate says is certain. Memory makes it tighter: it holds the bounds of the last
/// estimate and the pairs of nodes that were opened for them (40 bytes each, some 5 MiB
/// at most while the pair moves).
/// Exchanging A and B exchanges the estimate.
///
/// The demand says what the effort is spent on: `Intersects`, on the verdict; `Distance`, on
/// narrowing the interval, as far as it lies below the bound of the demand; `Contacts` and
/// `Regions`, on all places within the margin.
///
/// Cost: the budget. Not counted are the first preparations for `Hulls` and `Caps` (linear in the
/// hull, and in the faces), the steps of a walk once it has begun (mostly one), and listing places.
///
/// # Errors
///
/// As [`query`]: [`QueryError`] for a pose or a length that is not accepted.
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Mesh, Model};
/// use cranny_estimate::{Accuracy, Effort, EstimateMemory, Verdict, estimate};
/// use cranny_narrow_phase::{Demand, Placed, Query};
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let a = Placed { model: &model, pose: Pose::IDENTITY };
/// let b = Placed { model: &model, pose: Pose::at(DVec3::new(0.75, 0.75, 0.0)) };
/// let question = Query::of(Demand::Distance { below: None });
/// let mut memory = EstimateMemory::default();
/// // The boxes overlap and decide nothing; the hulls are apart.
/// let boxes = estimate(a, b, &question, &Effort::of(Accuracy::Boxes), &mut memory)?;
/// assert_eq!(boxes.verdict, Verdict::Open);
/// let hulls = estimate(a, b, &question, &Effort::of(Accuracy::Hulls), &mut memory)?;
/// assert_eq!(hulls.verdict, Verdict::Excluded);
/// // Every interval holds the distance, and memory narrows it.
/// let exact = estimate(a, b, &question, &Effort::tests(100), &mut memory)?;
/// assert!((exact.separation.lo - 0.5f64.sqrt() / 2.0).abs() < 1e-12);
/// assert!(boxes.separation.lo <= exact.separation.lo);
/// assert!(exact.separation.hi <= boxes.separation.hi);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate(
    a: Placed,
    b: Placed,
    question: &Query,
    effort: &Effort,
    memory: &mut EstimateMemory,
) -> Result<Estimate, QueryError> {
    if effort.is_all() {
        return query(a, b, question, memory.queries()).map(Estimate::of_answer);
    }
    let pair = Pair::new(a, b)?;
    question.demand.check()?;
    if question.demand == Demand::None {
        return Ok(Estimate::blank());
    }
    let mut estimator = Estimator {
        trees: PairTrees::of(&pair),
        findings: Findings::new(&pair, question.demand),
        warm: memory.warm_start(&pair),
        meter: Meter::of(effort.budget),
        hull_steps: 0,
        hulls_apart: false,
        complete: true,
    };
    estimator.recall();
    estimator.spend(&pair, question.demand, effort.accuracy);
    Ok(estimator.sum_up(&pair, question.demand))
}

struct Estimator<'p, 'm> {
    trees: PairTrees<'m>,
    findings: Findings<'p, 'm>,
    warm: &'p mut WarmStart,
    meter: Meter<'p>,
    hull_steps: u64,
    hulls_apart: bool,
    /// Every pair of faces that can change the result was tested or excluded.
    complete: bool,
}

impl Estimator<'_, '_> {
    /// Tests the faces that met last, or were nearest.
    fn recall(&mut self) {
        let Some([f, g]) = self.warm.faces else {
            self.meter.repeats(Findings::TESTS_A_PAIR); // This estimate finds some.
            return;
        };
        if self.meter.take_again(Findings::TESTS_A_PAIR) {
            self.findings.test(f, g);
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
                let faces = self.warm.hull_faces.get_or_insert_with(|| hull_faces(pair));
                Scope::HullFaces(faces.clone())
            }
        };
        let (trees, findings) = (&self.trees, &mut self.findings);
        // Without a test left, a cut that was outrun stays for an estimate that has some.
        let outrun = self.meter.affords(1) && std::mem::take(&mut self.warm.outrun);
        // Without a verdict a distance above 0 excludes nothing: one body may lie in the other.
        let reserved = match self.warm.apart {
            None => self.meter.reserve(1 + point_tests(pair)),
            Some(_) => 0,
        };
        let cut = &mut self.warm.refinement;
        self.complete &= cut.refine(trees, &scope, findings, &mut self.meter, outrun);
        self.meter.release(reserved);
        let least = cut.least(trees);
        self.warm.distance.lo = self.warm.distance.lo.max(least);
    }

    /// Walks from hull to hull; a walk is not interrupted once it has begun.
    fn walk(&mut self, pair: &Pair) {
        if self.findings.is_done() || !self.meter.take(1) {
            return;
        }
        self.hull_steps += 1;
        self.meter.repeats(1);
        let Some(gap) = self.warm.hulls.walk(pair) else { return };
        self.hull_steps += gap.steps;
        self.meter.charge(gap.steps);
        self.meter.repeats(gap.steps);
        self.hulls_apart = gap.apart;
        self.warm.distance.lo = self.warm.distance.lo.max(gap.lower);
        self.findings.offer_vertices(gap.vertices);
    }

    /// How the surfaces meet, if it is certain.
    fn surface(&self) -> Option<Surface> {
        match self.findings.surface {
            Meeting::Cross => Some(Meeting::Cross),
            Meeting::Touch => self.complete.then_some(Meeting::Touch),
            Meeting::None => {
                let apart = self.hulls_apart || self.complete || self.warm.distance.lo > 0.0;
                apart.then_some(Meeting::None)
            }
        }
    }

    /// The solidity of surfaces that do not meet; `None` if the budget does not suffice.
    fn solidity(&mut self, pair: &Pair) -> Option<Solidity> {
        let outside = Solidity { solid: false, contained: None };
        if self.hulls_apart {
            return Some(outside);
        }
        if self.warm.apart.is_some() {
            return self.warm.apart;
        }
        if !self.meter.take(1) {
            return None;
        }
        self.findings.counters.node_tests += 1;
        let [first, second] = self.trees.sides.map(|tree| &tree.node(0).bounds);
        if self.trees.boxes.apart(first, second, 0.0) {
            return Some(outside);
        }
        self.meter.repeats(1);
        let counters = &mut self.findings.counters;
        self.meter.take(point_tests(pair)).then(|| Solidity::of_disjoint_surfaces(pair, counters))
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
                places(pair, &self.trees, &self.warm.refinement, margin, distance.lo)
            }
            _ => Vec::new(),
        };
        let warm = self.warm;
        warm.distance = distance;
        warm.apart = solidity.filter(|_| surface == Some(Meeting::None));
        warm.faces = self.findings.faces().or(warm.faces);
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
            ended_by_budget: self.meter.refused,
            needed_to_go_on: self.meter.needed(),
            hull_steps: self.hull_steps,
        }
    }

    /// Holds the distance between the surfaces.
    fn distance(&self, meets: bool) -> Interval {
        if meets {
            return Interval::point(0.0);
        }
        let hi = self.warm.distance.hi.min(self.findings.upper());
        // Both bounds are certain; where they are equal, rounding may exchange them.
        Interval { lo: self.warm.distance.lo.clamp(0.0, hi), hi }
    }
}

/// The most tests of points that containment takes: one for each component.
fn point_tests(pair: &Pair) -> u64 {
    Side::BOTH.map(|side| pair.model(side).topology().components().len() as u64).iter().sum()
}

/// An upper bound of the distance between any two points of the bodies, from their boxes.
fn farthest(pair: &Pair) -> f64 {
    let [x, y] = Side::BOTH.map(|side| pair.bounds(side));
    (y.max - x.min).max(x.max - y.min).length().next_up() + pair.culling_error()
}

/// An upper bound of the depth of a region of contact: its pieces lie in both bodies' boxes.
fn deepest(pair: &Pair) -> f64 {
    let [x, y] = Side::BOTH.map(|side| pair.bounds(side));
    let common = Aabb { min: x.min.max(y.min), max: x.max.min(y.max) };
    common.diagonal().next_up() + pair.culling_error()
}
