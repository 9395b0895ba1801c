//! Meshes, hulls, trees and the prepared `Model` of Cranny.

mod ids;
mod mesh;

pub use ids::{ComponentId, EdgeId, FaceId, HalfEdgeId, VertexId};
pub use mesh::{Mesh, MeshError};
