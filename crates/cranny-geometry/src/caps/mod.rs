//! Caps: the lids that close a concavity on the hull.

pub(crate) mod triangulate;
