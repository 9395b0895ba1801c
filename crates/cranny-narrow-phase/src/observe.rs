//! What a search looks at, and what a pair's memory holds, shown for drawing: nothing of it is kept
//! for that. Pictures of heat draw the former; nothing draws the latter yet.

use cranny_concavity::ConcavityId;
use cranny_concavity::pockets::MetParts;
use cranny_geometry::FaceId;

use crate::answer::Feature;
use crate::evaluate::QueryError;
use crate::memory::PairMemory;
use crate::pair::Pair;
use crate::query::Placed;

/// Boxes below a node of one body's [search tree](cranny_geometry::Model::clusters) that are
/// compared with one box of the other's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ComparedBoxes {
    /// Whose node it is: 0 for A, 1 for B.
    pub body: usize,
    /// Its number.
    pub node: u32,
    /// Those of its lanes that are compared, a bit each.
    pub lanes: u32,
    /// The other body's box: a node, and which of its lanes. `None` is the whole body.
    pub other: Option<[u32; 2]>,
}

/// Sees what the search of a query compares, in order, as
/// [`query_observed`](crate::query_observed) comes to it. Every method does nothing unless it is
/// written anew.
pub trait SearchObserver {
    /// Boxes of both bodies, of the trees of clusters. (Boxes that are compared with a point, or
    /// with the place where hulls are nearest, are counted and not shown.)
    fn boxes(&mut self, _boxes: ComparedBoxes) {}

    /// Clusters of A and of B, by their number in the [tree](cranny_geometry::Model::clusters) of
    /// the model. Their faces or features are compared next, eight side by side, unless a plane
    /// parts the clusters. Called [`cluster_tests`](crate::Counters::cluster_tests) times.
    fn clusters(&mut self, _clusters: [u32; 2]) {}

    /// Faces of A and of B that are classified exactly or measured. Together with
    /// [`features`](Self::features) called [`triangle_tests`](crate::Counters::triangle_tests)
    /// times.
    fn faces(&mut self, _faces: [FaceId; 2]) {}

    /// Features of A and of B of which the contact is computed.
    fn features(&mut self, _features: [Feature; 2]) {}
}

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
