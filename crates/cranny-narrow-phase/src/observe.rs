//! What a pair's memory holds, shown for drawing: nothing of it is kept for that.

use cranny_concavity::ConcavityId;
use cranny_concavity::pockets::MetParts;
use cranny_geometry::FaceId;

use crate::evaluate::{QueryError, accepted};
use crate::levels::Ground;
use crate::memory::PairMemory;
use crate::pair::{Pair, PosedVertices};
use crate::query::Placed;
use cranny_concavity::walk::HullFeature;

/// A pair of nodes of the two bodies' trees that is not opened, and what is certain of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptNodes {
    /// A node of A's [`tree`](cranny_geometry::Model::tree), one of B's: indices for
    /// [`FaceTree::node`](cranny_geometry::FaceTree::node).
    pub nodes: [u32; 2],
    /// No face beneath the one is nearer to a face beneath the other than this, at the poses observed; 0 where they
    /// may meet.
    pub separation: f64,
}

/// Sees what a memory holds, in no particular order. Every method does nothing unless it is written anew.
pub trait PairObserver {
    /// How far [`estimate`](crate::estimate) has opened the trees. Each pair of faces lies beneath just one of these.
    fn cut(&mut self, _kept: KeptNodes) {}

    /// Faces, of A and of B, that crossed when last looked at, and are looked at first for a verdict.
    fn crossing(&mut self, _faces: [FaceId; 2]) {}

    /// Faces, of A and of B, that were nearest when last measured, and are measured first for a distance.
    fn nearest(&mut self, _faces: [FaceId; 2]) {}

    /// Parts of A and of B that [`Method::Envelopes`](crate::Method::Envelopes) asked against each other.
    fn parts(&mut self, _met: MetParts) {}

    /// A concavity of A (`body` 0) or of B (1) whose faces are looked for since the last query by
    /// [`Method::Envelopes`](crate::Method::Envelopes), because the other's hull may reach them.
    fn opened(&mut self, _body: usize, _concavity: ConcavityId) {}

    /// One whose faces were looked for by the query before, and are no more.
    fn closed(&mut self, _body: usize, _concavity: ConcavityId) {}

    /// Features of A's hull and of B's from which the next walk of an estimate starts.
    fn walk(&mut self, _features: [HullFeature; 2]) {}
}

impl PairMemory {
    /// Shows an observer what the last query or estimate of these bodies at these poses has left. A cut is
    /// shown where that used one; of what stems from other poses or other models, nothing is.
    ///
    /// Cost: linear in what is shown.
    ///
    /// # Errors
    ///
    /// [`QueryError::Pose`].
    ///
    /// ```
    /// use cranny_exact::{DVec3, Pose};
    /// use cranny_geometry::{BuildOptions, Mesh, Model};
    /// use cranny_narrow_phase::{
    ///     Demand, Effort, KeptNodes, PairMemory, PairObserver, Placed, Query, estimate,
    /// };
    ///
    /// /// Boxes that a drawing would show.
    /// #[derive(Default)]
    /// struct Boxes(Vec<KeptNodes>);
    ///
    /// impl PairObserver for Boxes {
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
    /// let (question, mut memory) = (Query::of(Demand::Distance { below: None }), PairMemory::default());
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
        observer: &mut impl PairObserver,
    ) -> Result<(), QueryError> {
        let [a, b] = accepted(a, b)?;
        let mut posed = PosedVertices::default();
        let pair = Pair::new(a, b, &mut posed);
        let kept = |nodes: [u32; 2], separation: f64| {
            let [first, second] = nodes;
            KeptNodes { nodes: pair.ordered(first, second), separation: separation.max(0.0) }
        };
        let ground = Ground::of(&pair);
        for [first, second] in self.coherent.crossing_of(&pair) {
            observer.crossing(pair.ordered(*first, *second));
        }
        if let Some([first, second]) = self.coherent.nearest_of(&pair) {
            observer.nearest(pair.ordered(first, second));
        }
        self.pockets.show(&pair, observer);
        let Some(carried) = self.levels.as_ref().filter(|levels| levels.is_at(&pair)) else {
            return Ok(());
        };
        for (nodes, separation) in carried.cut(&ground) {
            observer.cut(kept(nodes, separation));
        }
        if let Some([first, second]) = carried.walked() {
            observer.walk(pair.ordered(first, second));
        }
        Ok(())
    }
}
