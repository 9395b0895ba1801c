//! Exact, incremental collision detection for bodies that are not convex.
pub use cranny_exact as exact;
pub use cranny_geometry as geometry;
