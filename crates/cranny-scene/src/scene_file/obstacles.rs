//! What stands where bodies are made by rule.

use std::collections::BTreeSet;

use cranny_broad_phase::BoxIndex;
use cranny_exact::{Aabb, Pose};
use cranny_primitives::BodyShape;
use cranny_world::description::BodyDescription;
use cranny_world::{Arrangement, Wanted, world_box};

use super::geometry::CollisionGeometry;
use crate::robot::LinkModels;

/// Bodies that may not be met.
pub(super) struct Obstacles {
    standing: Vec<Standing>,
    /// Of their boxes.
    index: BoxIndex,
    /// Names of those that were in the way.
    met: BTreeSet<String>,
}

/// A body at its place.
pub(super) struct Standing {
    pub(super) name: String,
    pub(super) shape: BodyShape,
    pub(super) pose: Pose,
}

impl Obstacles {
    pub(super) fn of(standing: Vec<Standing>) -> Self {
        let bounds = |standing: &Standing| world_box(&standing.shape, &standing.pose, 0.0);
        let index = BoxIndex::of(standing.iter().map(bounds));
        Self { standing, index, met: BTreeSet::new() }
    }

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
        let mut standing = Vec::new();
        for body in bodies {
            let bounds = body.collision.bounds();
            let is_near = body.primitive().is_some()
                || body.pose.world_from_body().bounds(&bounds).overlaps(around);
            let meets = !body.sensor && body.layers.iter().any(|layer| layers.contains(layer));
            if is_near && meets {
                let (mesh, shape) = (body.collision.clone(), body.shape.clone());
                let shape = prepared(&CollisionGeometry { mesh, shape }, &body.name, models)?;
                standing.push(Standing { name: body.name.clone(), shape, pose: body.pose });
            }
        }
        Ok(Self::of(standing))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.standing.is_empty()
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
        let met = self.first_met(shape, pose, self.standing.len())?;
        let name = met.map(|number| self.standing[number].name.as_str());
        self.met.extend(name.map(str::to_owned));
        Ok(name)
    }

    /// The first two that meet each other.
    ///
    /// # Errors
    ///
    /// As [`meeting`](Self::meeting).
    pub(super) fn meeting_each_other(&self) -> Result<Option<[&str; 2]>, String> {
        for (number, standing) in self.standing.iter().enumerate() {
            if let Some(other) = self.first_met(&standing.shape, &standing.pose, number)? {
                return Ok(Some([&self.standing[other].name, &standing.name]));
            }
        }
        Ok(None)
    }

    /// The number of the first one below `end` that a shape meets.
    fn first_met(
        &self,
        shape: &BodyShape,
        pose: &Pose,
        end: usize,
    ) -> Result<Option<usize>, String> {
        let bounds = world_box(shape, pose, 0.0);
        let near = self.index.reached(|held| held.overlaps(&bounds));
        let mut near: Vec<usize> = near.filter(|&number| number < end).collect();
        near.sort_unstable();
        for number in near {
            let Standing { shape: other, pose: at, .. } = &self.standing[number];
            let both = vec![Some(shape.clone()), Some(other.clone())];
            let arranged = Arrangement::new(both, [(0, 1)]).at(&[*pose, *at], Wanted::Meeting);
            if !arranged.map_err(|error| error.to_string())?.meeting.is_empty() {
                return Ok(Some(number));
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
