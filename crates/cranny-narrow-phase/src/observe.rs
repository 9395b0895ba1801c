//! What a search looks at, shown for drawing, as pictures of heat do: nothing is kept for that.

use cranny_geometry::FaceId;

use crate::answer::Feature;

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
