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

/// An index or none, in four bytes where `Option<u32>` takes eight. The index `u32::MAX` is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct OptionalIndex(u32);

impl OptionalIndex {
    /// No index.
    pub const NONE: Self = Self(u32::MAX);

    /// An index below `u32::MAX`.
    #[must_use]
    pub fn some(index: u32) -> Self {
        debug_assert_ne!(index, u32::MAX, "this index stands for none");
        Self(index)
    }

    /// The index, if there is one.
    #[must_use]
    #[inline]
    pub fn get(self) -> Option<u32> {
        self.is_some().then_some(self.0)
    }

    /// Whether there is an index.
    #[must_use]
    #[inline]
    pub fn is_some(self) -> bool {
        self != Self::NONE
    }

    /// Whether there is none.
    #[must_use]
    #[inline]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// Takes the index out: what is left is [`NONE`](Self::NONE).
    pub fn take(&mut self) -> Option<u32> {
        std::mem::replace(self, Self::NONE).get()
    }
}

plain_struct!(VertexId(u32));
plain_struct!(FaceId(u32));
plain_struct!(HalfEdgeId(u32));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_optional_index_is_an_index_or_none_in_four_bytes() {
        let mut index = OptionalIndex::some(3);
        assert_eq!((index.get(), index.is_some(), index.is_none()), (Some(3), true, false));
        assert_eq!((index.take(), index), (Some(3), OptionalIndex::NONE));
        assert_eq!((index.get(), index.is_some(), index.is_none()), (None, false, true));
        assert_eq!(size_of::<OptionalIndex>(), 4);
    }
}
