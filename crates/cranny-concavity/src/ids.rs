//! Typed indices. Each counts from 0 within the concavities of one model.

use cranny_geometry::typed_index;

typed_index! {
    /// A layer of an envelope, counted through all envelopes of a model.
    LayerId
}
typed_index! {
    /// A facet of an envelope, counted through all envelopes of a model.
    EnvelopeFacetId
}
typed_index! {
    /// A set of faces on the hull that hang together.
    ConvexSetId
}
typed_index! {
    /// A concavity, an opening or a void.
    ConcavityId
}
typed_index! {
    /// A triangle of the cap surface: of the hull, where no face of the mesh covers it.
    CapId
}
typed_index! {
    /// A lid: cap triangles of one concavity that hang together.
    LidId
}
