//! Pairs of meshes in slow motion, for pieces of work that are counted and for methods side by
//! side.
//!
//! A frame is a pose of the second body. Figures beside peers are
//! [`entangled`](crate::entangled)'s.

pub(crate) mod methods;
mod scenes;
pub(crate) mod sorting;

pub(crate) use scenes::scene;

use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::Demand;

/// The prepared mesh, which is not searched for faces that meet; `None` where it has no model.
pub(crate) fn model_of(mesh: &Mesh) -> Option<Model> {
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Model::build(mesh.clone(), &options).ok().map(|(model, _)| model)
}

/// `None` where a mesh has no model.
fn prepared([a, b]: &[Mesh; 2]) -> Option<[Model; 2]> {
    Some([model_of(a)?, model_of(b)?])
}

fn name_of(demand: Demand) -> &'static str {
    match demand {
        Demand::None => "nothing",
        Demand::Intersects => "intersects",
        Demand::Distance { .. } => "distance",
        Demand::Contacts { .. } => "contacts",
        Demand::Regions { .. } => "regions",
    }
}
