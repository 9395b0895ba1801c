//! Prepared models of links.

use std::sync::Arc;

use cranny_geometry::{BuildError, BuildOptions, Mesh, Model};
use cranny_primitives::BodyShape;
use cranny_world::Arrangement;
use thiserror::Error;

use super::Robot;

/// No model can be made of a link's collision geometry.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("the collision geometry of link {link:?} cannot be prepared: {source}")]
pub struct LinkModelError {
    /// The link.
    pub link: String,
    /// Why.
    pub source: BuildError,
}

/// Models of meshes; links of one mesh share its model.
#[derive(Debug, Default)]
pub(crate) struct LinkModels(Vec<(Arc<Mesh>, Model)>);

impl LinkModels {
    /// The prepared model of a link's mesh.
    pub(crate) fn of(&mut self, mesh: &Arc<Mesh>, link: &str) -> Result<Model, LinkModelError> {
        if let Some((_, model)) = self.0.iter().find(|(known, _)| Arc::ptr_eq(known, mesh)) {
            return Ok(model.clone());
        }
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        let (model, _) = Model::build(Mesh::clone(mesh), &options)
            .map_err(|source| LinkModelError { link: link.to_owned(), source })?;
        self.0.push((Arc::clone(mesh), model.clone()));
        Ok(model)
    }
}

impl Robot {
    /// The links with their collision geometry, and the [pairs](Self::checked_pairs) of them that
    /// are checked. Poses are those of [`forward_kinematics`](Self::forward_kinematics).
    ///
    /// # Errors
    ///
    /// [`LinkModelError`].
    pub fn self_collisions(&self, disabled: &[[String; 2]]) -> Result<Arrangement, LinkModelError> {
        Ok(Arrangement::new(self.link_shapes()?, self.checked_pairs(disabled)))
    }

    /// What collides of every link, prepared, in the order of [`links`](Self::links).
    ///
    /// # Errors
    ///
    /// [`LinkModelError`].
    pub fn link_shapes(&self) -> Result<Vec<Option<BodyShape>>, LinkModelError> {
        let mut models = LinkModels::default();
        let of_links = self.links.iter().map(|link| match link.primitive {
            Some(primitive) => Ok(Some(BodyShape::from(primitive))),
            None => {
                let model = |mesh| models.of(mesh, &link.name).map(BodyShape::from);
                link.collision.as_ref().map(model).transpose()
            }
        });
        of_links.collect()
    }

    /// All pairs of links but [adjacent](Self::adjacent_links) ones and those whose names are
    /// `disabled`, in either order. The smaller index comes first.
    #[must_use]
    pub fn checked_pairs(&self, disabled: &[[String; 2]]) -> Vec<(usize, usize)> {
        let mut left_out = self.adjacent_links();
        let links = disabled.iter().filter_map(|[a, b]| Some((self.link(a)?, self.link(b)?)));
        left_out.extend(links.map(|(a, b)| (a.min(b), a.max(b))));
        let pairs = (0..self.links.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        pairs.filter(|pair| !left_out.contains(pair)).collect()
    }
}
