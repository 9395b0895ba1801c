//! What a pair's memory holds, shown for drawing: nothing of it is kept for that.

use cranny_concavity::ConcavityId;
use cranny_concavity::pockets::MetParts;
use cranny_geometry::FaceId;

use crate::evaluate::QueryError;
use crate::memory::PairMemory;
use crate::pair::Pair;
use crate::query::Placed;

/// Sees what a memory holds, in no particular order. Every method does nothing unless it is written
/// anew.
pub trait PairObserver {
    /// Faces, of A and of B, that crossed when last looked at, and are looked at first for a
    /// verdict.
    fn crossing(&mut self, _faces: [FaceId; 2]) {}

    /// Faces, of A and of B, that were nearest when last measured, and are measured first for a
    /// distance.
    fn nearest(&mut self, _faces: [FaceId; 2]) {}

    /// Parts of A and of B that [`Method::Envelopes`](crate::Method::Envelopes) compared with each
    /// other.
    fn parts(&mut self, _met: MetParts) {}

    /// A concavity of A (`body` 0) or of B (1) whose faces are looked for since the last query by
    /// [`Method::Envelopes`](crate::Method::Envelopes), because the other's hull may reach them.
    fn opened(&mut self, _body: usize, _concavity: ConcavityId) {}

    /// One whose faces were looked for by the query before, and are no more.
    fn closed(&mut self, _body: usize, _concavity: ConcavityId) {}
}

impl PairMemory {
    /// Shows an observer what the last query of these bodies at these poses has left. Of other
    /// poses or other models it shows nothing.
    ///
    /// Cost: linear in what is shown.
    ///
    /// # Errors
    ///
    /// [`QueryError::Pose`].
    ///
    /// ```
    /// use cranny_exact::{DVec3, Pose};
    /// use cranny_geometry::{BuildOptions, FaceId, Mesh, Model};
    /// use cranny_narrow_phase::{Demand, PairMemory, PairObserver, Placed, Query, query};
    ///
    /// /// Faces that a drawing would show.
    /// #[derive(Default)]
    /// struct Nearest(Option<[FaceId; 2]>);
    ///
    /// impl PairObserver for Nearest {
    ///     fn nearest(&mut self, faces: [FaceId; 2]) {
    ///         self.0 = Some(faces);
    ///     }
    /// }
    ///
    /// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
    /// let a = Placed { model: &model, pose: Pose::IDENTITY };
    /// let b = Placed { model: &model, pose: Pose::at(DVec3::new(3.0, 0.0, 0.0)) };
    /// let mut memory = PairMemory::default();
    /// query(a, b, &Query::of(Demand::Distance { below: None }), &mut memory)?;
    /// let mut nearest = Nearest::default();
    /// memory.observe(a, b, &mut nearest)?;
    /// assert!(nearest.0.is_some());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe(
        &self,
        a: Placed,
        b: Placed,
        observer: &mut impl PairObserver,
    ) -> Result<(), QueryError> {
        let pair = Pair::new(a, b)?;
        for [first, second] in self.coherent.crossing_of(&pair) {
            observer.crossing(pair.ordered(*first, *second));
        }
        if let Some([first, second]) = self.coherent.nearest_of(&pair) {
            observer.nearest(pair.ordered(first, second));
        }
        self.pockets.show(&pair, observer);
        Ok(())
    }
}
