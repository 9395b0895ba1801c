//! Pairs of meshes in slow motion, for pieces of work that are counted and for methods side by
//! side.
//!
//! A frame is a pose of the second body. Figures beside peers are
//! [`entangled`](crate::entangled)'s.

pub(crate) mod methods;
mod scenes;
pub(crate) mod sorting;

use cranny_exact::Pose;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::Demand;

/// The bodies of the scene of that name, and the second's poses.
pub(crate) fn models(name: &str) -> Option<([Model; 2], Vec<Pose>)> {
    let (meshes, poses) = scenes::scene(name)?;
    Some((prepared(&meshes)?, poses))
}

/// `None` where a mesh has no model.
fn prepared(meshes: &[Mesh; 2]) -> Option<[Model; 2]> {
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let [a, b] = meshes.each_ref().map(|mesh| Model::build(mesh.clone(), &options).ok());
    Some([a?.0, b?.0])
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
