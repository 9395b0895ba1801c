//! Shapes at poses without a history: which pairs of them meet, and which is nearest.
//!
//! A [`World`](crate::World) follows bodies from step to step and makes events. A caller with a
//! list of configurations instead, as a planner has of a robot, uses this: no ids, no events, the
//! pairs once for all.

use cranny_exact::{Aabb, Pose, PoseError};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query};
use cranny_primitives::{BodyShape, PlacedShape, ShapeQueryError, query_shapes};
use thiserror::Error;

use crate::bounds::world_box;

/// Shapes, and the pairs of them that are looked at.
///
/// Answers depend on the poses alone. What is remembered of the configuration before saves time
/// where the next one is near it.
#[derive(Clone, Debug)]
pub struct Arrangement {
    shapes: Vec<Option<BodyShape>>,
    pairs: Vec<WatchedPair>,
    /// The pair that was nearest last.
    nearest: Option<usize>,
    /// Room for poses and boxes, by shape.
    placed: (Vec<Pose>, Vec<Aabb>),
}

#[derive(Clone, Debug)]
struct WatchedPair {
    at: (usize, usize),
    shapes: [BodyShape; 2],
    memory: PairMemory,
}

/// What is wanted of an [`Arrangement`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Which pairs meet.
    Meeting,
    /// That, and the least distance.
    Nearest,
}

/// Shapes at one list of poses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arranged {
    /// Pairs that touch or overlap; one may lie inside the other. In the order given.
    pub meeting: Vec<(usize, usize)>,
    /// The nearest pair, where it is [wanted](Wanted::Nearest) and there is any; of pairs that are
    /// equally near the first.
    pub nearest: Option<NearestPair>,
}

/// The two shapes that are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPair {
    /// Which they are.
    pub pair: (usize, usize),
    /// How far their surfaces are apart; 0 where they meet, or one lies inside the other.
    pub distance: f64,
}

/// A list of poses that cannot be looked at.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ArrangementError {
    /// Not one pose a shape.
    #[error("{poses} poses for {shapes} shapes: give one for each")]
    Poses {
        /// Number of shapes.
        shapes: usize,
        /// Number of poses given.
        poses: usize,
    },
    /// A pose that is none.
    #[error("shape {shape}: {source}")]
    Pose {
        /// Index of the shape.
        shape: usize,
        /// What is wrong with it.
        source: PoseError,
    },
    /// A pair that the narrow phase refuses.
    #[error("shapes {a} and {b}: {source}")]
    Query {
        /// Index of the one.
        a: usize,
        /// Index of the other.
        b: usize,
        /// Why.
        source: ShapeQueryError,
    },
}

impl Arrangement {
    /// Shapes by index, `None` for places without geometry, and the pairs that are looked at. Pairs
    /// with a place without geometry are left out.
    #[must_use]
    pub fn new<S: Into<BodyShape>>(
        shapes: Vec<Option<S>>,
        pairs: impl IntoIterator<Item = (usize, usize)>,
    ) -> Self {
        let shapes: Vec<Option<BodyShape>> =
            shapes.into_iter().map(|shape| shape.map(Into::into)).collect();
        let shape = |i: usize| shapes.get(i).cloned().flatten();
        let watched = |at: (usize, usize)| {
            let shapes = [shape(at.0)?, shape(at.1)?];
            Some(WatchedPair { at, shapes, memory: PairMemory::default() })
        };
        let pairs = pairs.into_iter().filter_map(watched).collect();
        Self { shapes, pairs, nearest: None, placed: Default::default() }
    }

    /// The pairs that are looked at.
    #[must_use]
    pub fn pairs(&self) -> impl ExactSizeIterator<Item = (usize, usize)> {
        self.pairs.iter().map(|pair| pair.at)
    }

    /// Looks at the shapes at these poses, world_from_shape, one for each; those of places without
    /// geometry are not read.
    ///
    /// # Errors
    ///
    /// [`ArrangementError`].
    pub fn at(&mut self, poses: &[Pose], wanted: Wanted) -> Result<Arranged, ArrangementError> {
        if poses.len() != self.shapes.len() {
            let (shapes, poses) = (self.shapes.len(), poses.len());
            return Err(ArrangementError::Poses { shapes, poses });
        }
        let mut placed = std::mem::take(&mut self.placed);
        let found = self.place(poses, &mut placed).and_then(|()| self.look(&placed, wanted));
        self.placed = placed;
        found
    }

    /// Fills in the poses as they are taken, and the boxes of the shapes there.
    fn place(
        &self,
        given: &[Pose],
        (poses, boxes): &mut (Vec<Pose>, Vec<Aabb>),
    ) -> Result<(), ArrangementError> {
        poses.clear();
        boxes.clear();
        for (index, (shape, given)) in self.shapes.iter().zip(given).enumerate() {
            let Some(shape) = shape else {
                poses.push(Pose::IDENTITY);
                boxes.push(Aabb::EMPTY);
                continue;
            };
            let pose = given
                .accepted()
                .map_err(|source| ArrangementError::Pose { shape: index, source })?;
            poses.push(pose);
            boxes.push(world_box(shape, &pose, 0.0));
        }
        Ok(())
    }

    fn look(
        &mut self,
        (poses, boxes): &(Vec<Pose>, Vec<Aabb>),
        wanted: Wanted,
    ) -> Result<Arranged, ArrangementError> {
        let mut meeting = Vec::new();
        for pair in &mut self.pairs {
            let (a, b) = pair.at;
            let near = boxes[a].overlaps(&boxes[b]);
            if near && pair.ask(poses, Demand::Intersects)?.touches() {
                meeting.push((a, b));
            }
        }
        let nearest = match (wanted, meeting.first()) {
            (Wanted::Meeting, _) => None,
            (Wanted::Nearest, Some(&pair)) => Some(NearestPair { pair, distance: 0.0 }),
            (Wanted::Nearest, None) => self.nearest_apart(poses, boxes)?,
        };
        Ok(Arranged { meeting, nearest })
    }

    /// The nearest pair of shapes that do not meet: by ascending distance of their boxes, until
    /// none can be nearer.
    fn nearest_apart(
        &mut self,
        poses: &[Pose],
        boxes: &[Aabb],
    ) -> Result<Option<NearestPair>, ArrangementError> {
        let bound = |(a, b): (usize, usize)| boxes[a].distance_squared_lower(&boxes[b]).sqrt();
        let mut order: Vec<(f64, usize)> =
            self.pairs().map(bound).enumerate().map(|(k, bound)| (bound, k)).collect();
        order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        // What was nearest last says how far to look, and nothing else.
        let mut reach = match self.nearest {
            Some(k) => self.pairs[k].distance(poses, None)?.unwrap_or(f64::INFINITY),
            None => f64::INFINITY,
        };
        let mut best: Option<(f64, usize)> = None;
        for (bound, k) in order {
            if bound > reach {
                break;
            }
            let below = reach.is_finite().then(|| reach.next_up());
            let Some(distance) = self.pairs[k].distance(poses, below)? else { continue };
            if best.is_none_or(|(least, at)| distance < least || distance == least && k < at) {
                best = Some((distance, k));
                reach = distance;
            }
        }
        self.nearest = best.map(|(_, k)| k);
        Ok(best.map(|(distance, k)| NearestPair { pair: self.pairs[k].at, distance }))
    }
}

impl WatchedPair {
    /// The distance of the surfaces, where it is less than a length.
    fn distance(
        &mut self,
        poses: &[Pose],
        below: Option<f64>,
    ) -> Result<Option<f64>, ArrangementError> {
        let answer = self.ask(poses, Demand::Distance { below })?;
        Ok(answer.distance.filter(|distance| distance.is_finite()))
    }

    fn ask(&mut self, poses: &[Pose], demand: Demand) -> Result<Answer, ArrangementError> {
        let Self { at: (a, b), shapes: [of_a, of_b], memory } = self;
        let placed =
            [(of_a, *a), (of_b, *b)].map(|(shape, i)| PlacedShape { shape, pose: poses[i] });
        query_shapes(placed[0], placed[1], &Query::of(demand), memory)
            .map_err(|source| ArrangementError::Query { a: *a, b: *b, source })
    }
}
