//! Which colliders hold our shapes, and how those that were read get theirs back.

use std::fmt;

use cranny_geometry::{Model, ModelTag};
use cranny_narrow_phase::Normals;
use rapier3d::geometry::ColliderHandle;
use rapier3d::parry::shape::{Compound, Shape, SharedShape};
use rapier3d::prelude::{
    BroadPhaseBvh, ColliderSet, CollisionPipeline, IslandManager, NarrowPhase, RigidBodySet,
};
use serde::{Deserialize, Serialize};

use super::RestoreError;
use super::stand_in::{Writing, is_stand_in};
use crate::pair::ours;
use crate::shape::MeshShape;

/// Where a shape of ours is: in a collider, or in a part of a collider's compound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// The collider.
    pub collider: ColliderHandle,
    /// The compound's part, counted from 0.
    pub part: Option<u32>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (index, generation) = self.collider.into_raw_parts();
        match self.part {
            Some(part) => write!(f, "part {part} of collider {index} (generation {generation})"),
            None => write!(f, "collider {index} (generation {generation})"),
        }
    }
}

/// What distinguishes one prepared model from another: a hash of all that was prepared, so that the
/// same mesh prepared otherwise is another model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelPrint {
    hash: [u8; 32],
    vertices: u32,
    faces: u32,
}

impl ModelPrint {
    /// Of a model. Cost: as of [`Model::encode`].
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self {
            hash: *blake3::hash(&model.encode()).as_bytes(),
            vertices: model.mesh().vertices().len() as u32,
            faces: model.mesh().faces().len() as u32,
        }
    }
}

impl fmt::Display for ModelPrint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { hash, vertices, faces } = self;
        write!(f, "{vertices} vertices and {faces} faces, ")?;
        hash[..6].iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// A shape of ours as it is written.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Attached {
    place: Place,
    tag: u32,
    model: ModelPrint,
    /// Of smooth normals.
    crease_angle: Option<f64>,
    walkable: bool,
}

/// Normals as they are written.
pub(super) fn crease_angle_of(normals: Normals) -> Option<f64> {
    match normals {
        Normals::Flat => None,
        Normals::Smooth { crease_angle } => Some(crease_angle),
    }
}

/// Normals as they were written.
pub(super) fn normals_of(crease_angle: Option<f64>) -> Normals {
    crease_angle.map_or(Normals::Flat, |crease_angle| Normals::Smooth { crease_angle })
}

/// Prints of models, each made once.
#[derive(Default)]
struct Prints(Vec<(ModelTag, ModelPrint)>);

impl Prints {
    fn of(&mut self, model: &Model) -> ModelPrint {
        if let Some((_, print)) = self.0.iter().find(|(tag, _)| tag.is_of(model)) {
            return *print;
        }
        let print = ModelPrint::of(model);
        self.0.push((ModelTag::of(model), print));
        print
    }
}

/// All shapes of ours in a set, with a stand-in each for as long as these are kept.
pub(super) fn attached(colliders: &ColliderSet) -> (Vec<Attached>, Vec<Writing<'_>>) {
    let (mut prints, mut found, mut writing) = (Prints::default(), Vec::new(), Vec::new());
    for (collider, holder) in colliders.iter() {
        for (part, shape) in parts(holder.shape()) {
            let Some(shape) = ours(shape) else { continue };
            writing.push(Writing::new(shape));
            let (place, model) = (Place { collider, part }, prints.of(shape.model()));
            let crease_angle = shape.smooth_normals().map(|normals| normals.crease_angle());
            let (tag, walkable) = (shape.tag(), shape.is_walkable());
            found.push(Attached { place, tag, model, crease_angle, walkable });
        }
    }
    (found, writing)
}

/// A shape, or the parts of a compound. parry has no compounds of compounds.
fn parts(shape: &dyn Shape) -> Vec<(Option<u32>, &dyn Shape)> {
    match shape.as_compound() {
        Some(compound) => {
            let parts = compound.shapes().iter().enumerate();
            parts.map(|(index, (_, part))| (Some(index as u32), &**part)).collect()
        }
        None => vec![(None, shape)],
    }
}

/// Puts shapes back where they were, each of the model that it was of, and changes nothing else: no
/// collider counts as modified, since a modified one wakes what it touches.
///
/// No collider may be modified at the beginning.
pub(super) fn attach(
    colliders: &mut ColliderSet,
    attached: &[Attached],
    models: &[Model],
) -> Result<(), RestoreError> {
    let prints: Vec<ModelPrint> = models.iter().map(ModelPrint::of).collect();
    let shape_of = |Attached { place, tag, model, crease_angle, walkable }: &Attached| {
        let found = prints.iter().position(|print| print == model);
        let index = found.ok_or_else(|| RestoreError::Model {
            place: *place,
            model: *model,
            given: prints.clone(),
        })?;
        MeshShape::new(&models[index], *tag)
            .and_then(|shape| shape.with_normals(normals_of(*crease_angle)))
            // parry refuses such parts of compounds, so none was written.
            .map(|shape| if *walkable && place.part.is_none() { shape.walkable() } else { shape })
            .map(SharedShape::new)
            .map_err(|source| RestoreError::Shape { place: *place, source })
    };
    for of_collider in attached.chunk_by(|a, b| a.place.collider == b.place.collider) {
        let handle = of_collider[0].place.collider;
        let holder = colliders.get(handle);
        let holder = holder.ok_or(RestoreError::Place { place: of_collider[0].place })?;
        let whole = match holder.shape().as_compound() {
            None => {
                let [only @ Attached { place: Place { part: None, .. }, .. }] = of_collider else {
                    return Err(RestoreError::Place { place: of_collider[0].place });
                };
                if !is_stand_in(holder.shape()) {
                    return Err(RestoreError::Place { place: only.place });
                }
                shape_of(only)?
            }
            Some(compound) => {
                let mut shapes = compound.shapes().to_vec();
                for one in of_collider {
                    let part = one.place.part.and_then(|part| shapes.get_mut(part as usize));
                    let part = part.filter(|(_, shape)| is_stand_in(&**shape));
                    let (_, shape) = part.ok_or(RestoreError::Place { place: one.place })?;
                    *shape = shape_of(one)?;
                }
                SharedShape::new(Compound::new(shapes))
            }
        };
        exchange(colliders, handle, whole);
    }
    // Whoever edited the list may have left one out.
    let left = colliders.iter().find_map(|(collider, holder)| {
        let mut parts = parts(holder.shape()).into_iter();
        parts.find_map(|(part, shape)| is_stand_in(shape).then_some(Place { collider, part }))
    });
    left.map_or(Ok(()), |place| Err(RestoreError::Unattached { place }))
}

/// Sets a collider's shape and takes the marks of that away again, which only a step of rapier's
/// can do: one in which this collider is the only one that changed, alone in a world.
fn exchange(colliders: &mut ColliderSet, handle: ColliderHandle, shape: SharedShape) {
    if let Some(collider) = colliders.get_mut(handle) {
        collider.set_shape(shape);
    }
    CollisionPipeline::new().step(
        0.0,
        &mut IslandManager::new(),
        &mut BroadPhaseBvh::new(),
        &mut NarrowPhase::new(),
        &mut RigidBodySet::new(),
        colliders,
        &(),
        &(),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::BuildOptions;
    use rapier3d::math::Pose;
    use rapier3d::prelude::ColliderBuilder;

    /// A set with a cube of ours in a compound, as it is read: with a stand-in.
    fn read_back() -> (ColliderSet, Vec<Attached>, Model) {
        let mesh = cranny_shapes::Cuboid::default().build().unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let mut colliders = ColliderSet::new();
        colliders.insert(ColliderBuilder::ball(1.0));
        let ours = MeshShape::new(&model, 7).unwrap().with_smooth_normals(0.3).unwrap();
        let ours = SharedShape::new(ours);
        let compound = SharedShape::compound(vec![(Pose::IDENTITY, ours)]);
        colliders.insert(ColliderBuilder::new(compound));
        colliders.take_modified();
        let (list, writing) = attached(&colliders);
        let bytes = postcard::to_stdvec(&colliders).unwrap();
        drop(writing);
        (postcard::from_bytes(&bytes).unwrap(), list, model)
    }

    #[test]
    fn shapes_come_back_and_no_collider_counts_as_modified() {
        let (mut colliders, list, model) = read_back();
        attach(&mut colliders, &list, &[model]).unwrap();
        assert!(colliders.take_modified().is_empty());
        let (_, holder) = colliders.iter().nth(1).unwrap();
        let (_, shape) = &holder.shape().as_compound().unwrap().shapes()[0];
        let shape = ours(&**shape).unwrap();
        assert_eq!(shape.tag(), 7);
        assert_eq!(shape.smooth_normals().map(|normals| normals.crease_angle()), Some(0.3));
    }

    #[test]
    fn ground_stays_ground_but_in_a_compound() {
        let mesh = cranny_shapes::Cuboid::default().build().unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let mut colliders = ColliderSet::new();
        let ground = MeshShape::new(&model, 7).unwrap().walkable();
        colliders.insert(ColliderBuilder::new(SharedShape::new(ground)));
        colliders.take_modified();
        let (list, writing) = attached(&colliders);
        let bytes = postcard::to_stdvec(&colliders).unwrap();
        drop(writing);
        let mut colliders: ColliderSet = postcard::from_bytes(&bytes).unwrap();
        attach(&mut colliders, &list, &[model]).unwrap();
        let (_, holder) = colliders.iter().next().unwrap();
        assert!(ours(holder.shape()).unwrap().is_walkable());
        // Nobody can have written such a part of a compound; whoever made one up gets no panic of
        // parry's.
        let (mut colliders, list, model) = read_back();
        attach(&mut colliders, &[Attached { walkable: true, ..list[0] }], &[model]).unwrap();
    }

    #[test]
    fn a_list_that_does_not_fit_is_refused() {
        let (mut colliders, list, model) = read_back();
        let models = [model];
        let left_out = attach(&mut colliders.clone(), &[], &models);
        assert!(
            matches!(left_out, Err(RestoreError::Unattached { place }) if place == list[0].place)
        );
        let elsewhere = |place: Place| [Attached { place, ..list[0] }];
        let place = list[0].place;
        let (ball, _) = colliders.iter().next().unwrap();
        for wrong in [
            Place { collider: ball, part: None },
            Place { part: None, ..place },
            Place { part: Some(1), ..place },
            Place { collider: ColliderSet::invalid_handle(), ..place },
        ] {
            let refused = attach(&mut colliders, &elsewhere(wrong), &models);
            assert!(matches!(refused, Err(RestoreError::Place { place }) if place == wrong));
        }
    }

    #[test]
    fn nobody_else_can_write_our_shape() {
        let (mut colliders, list, model) = read_back();
        attach(&mut colliders, &list, &[model]).unwrap();
        assert!(postcard::to_stdvec(&colliders).is_err());
        let (_, writing) = attached(&colliders);
        assert!(postcard::to_stdvec(&colliders).is_ok());
        let in_another_thread = || postcard::to_stdvec(&colliders).is_err();
        assert!(std::thread::scope(|scope| scope.spawn(in_another_thread).join().unwrap()));
        drop(writing);
        assert!(postcard::to_stdvec(&colliders).is_err());
    }
}
