//! How deep two bodies of a scene overlap, by the exact query: no figure of a solver's takes part.

use cranny_exact::Pose;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_world::description::SceneDescription;

/// A scene's bodies, prepared.
pub(crate) struct Judge(Vec<Model>);

impl Judge {
    pub(crate) fn of(scene: &SceneDescription) -> Self {
        let built = |mesh: &Mesh| Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0;
        Self(scene.bodies.iter().map(|body| built(&body.collision)).collect())
    }

    /// The deepest overlap of two bodies at these poses; infinite where one is wholly inside the
    /// other.
    pub(crate) fn overlap(&self, poses: &[Pose], a: usize, b: usize) -> f64 {
        let placed = |k: usize| Placed { model: &self.0[k], pose: poses[k] };
        let ask = Query::of(Demand::Regions { margin: 0.0 });
        let answer = query(placed(a), placed(b), &ask, &mut PairMemory::default()).unwrap();
        if answer.solid && answer.contained.is_some() {
            return f64::INFINITY;
        }
        let depth = |region: &cranny_narrow_phase::Region| region.depth.expect("closed bodies");
        answer.regions.iter().map(depth).fold(0.0, f64::max)
    }
}
