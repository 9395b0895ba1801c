//! Typed indices. Each counts from 0 within one mesh.

use crate::codec::plain_struct;

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

        plain_struct!($name(u32));
    };
}

id! {
    /// A vertex of a mesh.
    VertexId
}
id! {
    /// A triangular face of a mesh.
    FaceId
}
id! {
    /// A half-edge: `3 * face + corner`, running from that corner of the face to the next.
    HalfEdgeId
}
id! {
    /// An undirected edge of a mesh.
    EdgeId
}
id! {
    /// A component: faces that hang together over edges.
    ComponentId
}
id! {
    /// A patch: connected faces of nearly one normal.
    PatchId
}
