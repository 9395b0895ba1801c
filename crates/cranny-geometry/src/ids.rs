//! Typed indices. Each counts from 0 within one mesh.

use crate::codec::plain_struct;

/// Declares an index of one kind of thing: a `u32` that counts from 0, with `index()` for arrays.
#[macro_export]
macro_rules! typed_index {
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

typed_index! {
    /// A vertex of a mesh.
    VertexId
}
typed_index! {
    /// A triangular face of a mesh.
    FaceId
}
typed_index! {
    /// A half-edge: `3 * face + corner`, running from that corner of the face to the next.
    HalfEdgeId
}
typed_index! {
    /// An undirected edge of a mesh.
    EdgeId
}
typed_index! {
    /// A component: faces that hang together over edges.
    ComponentId
}
typed_index! {
    /// A patch: connected faces of nearly one normal.
    PatchId
}

plain_struct!(VertexId(u32));
plain_struct!(FaceId(u32));
plain_struct!(HalfEdgeId(u32));
plain_struct!(EdgeId(u32));
plain_struct!(ComponentId(u32));
plain_struct!(PatchId(u32));
