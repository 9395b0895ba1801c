//! Typed indices. Each counts from 0 within the concavities of one model.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// As an index into an array.
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id! {
    /// A layer of an envelope, counted through all envelopes of a model.
    LayerId
}
id! {
    /// A facet of an envelope, counted through all envelopes of a model.
    EnvelopeFacetId
}
id! {
    /// A set of faces on the hull that hang together.
    ConvexSetId
}
id! {
    /// A concavity, an opening or a void.
    ConcavityId
}
id! {
    /// A triangle of the cap surface: of the hull, where no face of the mesh covers it.
    CapId
}
id! {
    /// A lid: cap triangles of one concavity that hang together.
    LidId
}
