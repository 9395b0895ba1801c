//! Who answers the pairs of a step: the caller's thread, or several of a pool.
//!
//! A pair is a function of its two bodies, its query and its own memory; so it does not matter who
//! answers it, nor when. Answers come back in the order of the pairs.

use std::num::NonZeroUsize;

use cranny_narrow_phase::{Answer, Mismatch, Placed, Query, query_verified};
use cranny_primitives::{BodyShape, ShapeQueryError, query_shapes};

use crate::body::Body;
use crate::estimates::PairState;

/// One pair, on its way to an answer.
pub(crate) struct Job<'w> {
    pub(crate) bodies: [&'w Body; 2],
    pub(crate) query: Query,
    pub(crate) state: PairState,
    /// Whether it is answered without memory as well.
    pub(crate) verify: bool,
}

/// An answer, and where memory changed it.
pub(crate) type Verified = (Answer, Option<Box<Mismatch>>);

impl Job<'_> {
    /// The answer.
    pub(crate) fn answer(&mut self) -> Result<Verified, ShapeQueryError> {
        let memory = self.state.memory.queries();
        let [first, second] = self.bodies;
        // A pair with a primitive has no memory.
        if let (true, BodyShape::Model(a), BodyShape::Model(b)) =
            (self.verify, &first.shape, &second.shape)
        {
            let [a, b] =
                [(a, first.pose), (b, second.pose)].map(|(model, pose)| Placed { model, pose });
            return Ok(query_verified(a, b, &self.query, memory)?);
        }
        query_shapes(first.placed(), second.placed(), &self.query, memory)
            .map(|answer| (answer, None))
    }
}

/// The threads that answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Crew {
    #[cfg(feature = "parallel")]
    pool: Option<std::sync::Arc<rayon::ThreadPool>>,
}

impl Crew {
    /// A crew of so many threads; of one, the caller's own. Or why there is none.
    pub(crate) fn of(threads: NonZeroUsize) -> Result<Self, String> {
        if threads == NonZeroUsize::MIN {
            return Ok(Self::default());
        }
        Self::of_several(threads)
    }

    #[cfg(feature = "parallel")]
    fn of_several(threads: NonZeroUsize) -> Result<Self, String> {
        let name = |i| format!("pairs {i}");
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).thread_name(name);
        let pool = builder.build().map_err(|error| error.to_string())?;
        Ok(Self { pool: Some(pool.into()) })
    }

    #[cfg(not(feature = "parallel"))]
    fn of_several(_: NonZeroUsize) -> Result<Self, String> {
        Err("this program was built without the feature `parallel` of cranny-world".into())
    }

    /// Does something with each of many, and returns what came of it, in their order.
    pub(crate) fn each<J: Send, R: Send>(
        &self,
        jobs: &mut [J],
        work: impl Fn(&mut J) -> R + Sync + Send,
    ) -> Vec<R> {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            use rayon::prelude::*;
            // One by one: pairs differ in cost by orders of magnitude.
            return pool.install(|| jobs.par_iter_mut().with_max_len(1).map(work).collect());
        }
        jobs.iter_mut().map(work).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "parallel")]
    #[test]
    fn a_crew_has_as_many_threads_as_were_asked_for() {
        let threads = |count| {
            let crew = Crew::of(NonZeroUsize::new(count).unwrap()).unwrap();
            crew.pool.map(|pool| pool.current_num_threads())
        };
        assert_eq!([threads(1), threads(3)], [None, Some(3)]);
    }

    #[cfg(not(feature = "parallel"))]
    #[test]
    fn several_threads_need_the_feature() {
        assert!(Crew::of(NonZeroUsize::MIN).is_ok());
        assert!(Crew::of(NonZeroUsize::new(2).unwrap()).unwrap_err().contains("`parallel`"));
    }
}
