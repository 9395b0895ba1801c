//! What a pair keeps from one estimate to the next: a value that the caller owns.

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::operations::Pair;
use cranny_narrow_phase::{PairMemory, Placed, QueryError};

use crate::effort::Accuracy;
use crate::observe::{EstimateObserver, show};
use crate::warm_start::WarmStart;

/// Memory of one pair: that of [queries](PairMemory), which exact estimates are, and the bounds and
/// opened nodes of the last estimate at a level or within a budget.
///
/// What is kept was certain, and stays so: motion widens the bounds. An estimate with memory is
/// therefore tighter than one without, and never contradicts it. Models are recognised, not kept
/// alive; memory of other models is dropped.
#[derive(Clone, Debug, Default)]
pub struct EstimateMemory {
    queries: PairMemory,
    warm_start: Option<Box<WarmStart>>,
}

impl EstimateMemory {
    /// Makes what estimates at a level read besides the models, so that the first of them need not:
    /// the features of the hulls for [`Accuracy::Hulls`], and which nodes hold faces on them for
    /// [`Accuracy::Caps`]. Clones share it.
    ///
    /// Cost: linear in the hulls and the faces; nothing for other levels.
    pub fn prepare(&mut self, a: &Model, b: &Model, accuracy: Accuracy) {
        let placed = |model| Placed { model, pose: Pose::IDENTITY };
        // The identity is accepted.
        if let Ok(pair) = Pair::new(placed(a), placed(b)) {
            self.warm_start(&pair).prepare(&pair, accuracy);
        }
    }

    /// The memory of exact queries about the pair.
    pub fn queries(&mut self) -> &mut PairMemory {
        &mut self.queries
    }

    /// Shows an observer what the last estimate of these bodies at these poses has left: the cut
    /// where it used one, and where its walk ended. Of other poses or other models it shows
    /// nothing.
    ///
    /// Cost: linear in what is shown.
    ///
    /// # Errors
    ///
    /// [`QueryError::Pose`].
    ///
    /// ```
    /// use cranny_estimate::{Effort, EstimateMemory, EstimateObserver, KeptNodes, estimate};
    /// use cranny_exact::{DVec3, Pose};
    /// use cranny_geometry::{BuildOptions, Mesh, Model};
    /// use cranny_narrow_phase::{Demand, Placed, Query};
    ///
    /// /// Boxes that a drawing would show.
    /// #[derive(Default)]
    /// struct Boxes(Vec<KeptNodes>);
    ///
    /// impl EstimateObserver for Boxes {
    ///     fn cut(&mut self, kept: KeptNodes) {
    ///         self.0.push(kept);
    ///     }
    /// }
    ///
    /// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
    /// let a = Placed { model: &model, pose: Pose::IDENTITY };
    /// let b = Placed { model: &model, pose: Pose::at(DVec3::new(3.0, 0.0, 0.0)) };
    /// let question = Query::of(Demand::Distance { below: None });
    /// let mut memory = EstimateMemory::default();
    /// let found = estimate(a, b, &question, &Effort::tests(20), &mut memory)?;
    /// let mut boxes = Boxes::default();
    /// memory.observe(a, b, &mut boxes)?;
    /// let least = boxes.0.iter().map(|kept| kept.separation).fold(f64::INFINITY, f64::min);
    /// assert_eq!(least, found.separation.lo);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe(
        &self,
        a: Placed,
        b: Placed,
        observer: &mut impl EstimateObserver,
    ) -> Result<(), QueryError> {
        let pair = Pair::new(a, b)?;
        if let Some(warm) = self.warm_start.as_ref().filter(|warm| warm.is_at(&pair)) {
            show(warm, &pair, observer);
        }
        Ok(())
    }

    /// Heap bytes held, without the concavities that [`queries`](Self::queries) may share.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.queries.bytes() + self.warm_start.as_ref().map_or(0, |warm| warm.bytes())
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// What is known of this pair at its pose.
    pub(crate) fn warm_start(&mut self, pair: &Pair) -> &mut WarmStart {
        WarmStart::at(&mut self.warm_start, pair)
    }
}
