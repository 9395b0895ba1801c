//! Generators of closed, oriented solids.
