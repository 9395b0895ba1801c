//! What stands where bodies are made by rule.

use std::collections::BTreeSet;

use cranny_exact::{Aabb, Pose};
use cranny_primitives::BodyShape;
use cranny_world::description::BodyDescription;
use cranny_world::{Arrangement, Wanted, world_box};

use super::geometry::CollisionGeometry;
use crate::robot::LinkModels;

/// Bodies that may not be met.
pub(super) struct Obstacles {
    standing: Vec<Standing>,
    /// Names of those that were in the way.
    met: BTreeSet<String>,
}

struct Standing {
    name: String,
    shape: BodyShape,
    pose: Pose,
    bounds: Aabb,
}

impl Obstacles {
    /// Bodies with a part in a box that share a layer with what is to come; sensors are none.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be prepared, as a sentence.
    pub(super) fn within(
        around: &Aabb,
        layers: &[String],
        bodies: &[BodyDescription],
        models: &mut LinkModels,
    ) -> Result<Self, String> {
        let mut obstacles = Self { standing: Vec::new(), met: BTreeSet::new() };
        for body in bodies {
            let bounds = body.collision.bounds();
            let is_near = body.primitive().is_some()
                || body.pose.world_from_body().bounds(&bounds).overlaps(around);
            let meets = !body.sensor && body.layers.iter().any(|layer| layers.contains(layer));
            if is_near && meets {
                let (mesh, shape) = (body.collision.clone(), body.shape.clone());
                let shape = prepared(&CollisionGeometry { mesh, shape }, &body.name, models)?;
                obstacles.add(&body.name, &shape, &body.pose);
            }
        }
        Ok(obstacles)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.standing.is_empty()
    }

    pub(super) fn add(&mut self, name: &str, shape: &BodyShape, pose: &Pose) {
        let bounds = world_box(shape, pose, 0.0);
        let (name, shape) = (name.to_owned(), shape.clone());
        self.standing.push(Standing { name, shape, pose: *pose, bounds });
    }

    /// The first body that a shape meets there, exactly: touching counts.
    ///
    /// # Errors
    ///
    /// A pose or shape that cannot be judged, as a sentence.
    pub(super) fn meeting(
        &mut self,
        shape: &BodyShape,
        pose: &Pose,
    ) -> Result<Option<&str>, String> {
        let bounds = world_box(shape, pose, 0.0);
        for standing in self.standing.iter().filter(|standing| standing.bounds.overlaps(&bounds)) {
            let both = vec![Some(shape.clone()), Some(standing.shape.clone())];
            let arranged =
                Arrangement::new(both, [(0, 1)]).at(&[*pose, standing.pose], Wanted::Meeting);
            if !arranged.map_err(|error| error.to_string())?.meeting.is_empty() {
                self.met.insert(standing.name.clone());
                return Ok(Some(&standing.name));
            }
        }
        Ok(None)
    }

    /// What was in the way, as a sentence has it; `None` where nothing was.
    pub(super) fn listed(&self) -> Option<String> {
        /// Enough to see what it is.
        const NAMED: usize = 4;
        let names: Vec<_> = self.met.iter().take(NAMED).map(|name| format!("{name:?}")).collect();
        let more = self.met.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        (!names.is_empty()).then(|| names.join(", ") + &more)
    }
}

/// What collides of a body, prepared.
///
/// # Errors
///
/// A mesh that cannot be prepared, as a sentence.
pub(super) fn prepared(
    geometry: &CollisionGeometry,
    name: &str,
    models: &mut LinkModels,
) -> Result<BodyShape, String> {
    if let Some(shape) = &geometry.shape {
        return Ok(shape.clone());
    }
    let model = models.of(&geometry.mesh, name);
    let refused = |why| format!("the mesh of body {name:?} cannot be prepared: {why}");
    model.map(BodyShape::from).map_err(|error| refused(error.source))
}
