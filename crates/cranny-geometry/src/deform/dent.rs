//! A dent: where the vertices around a blow go, so that the body loses a given volume.
//!
//! All vertices move along one direction, the blow's, by a profile that falls from 1 at its axis to
//! 0, without an edge, at the dent's rim. A face then sweeps a prism between parallel edges, whose
//! volume is its projected area times the mean of what its corners move by: the volume of the dent
//! is linear in its depth, and the depth for a volume is one division. What the mesh loses is that
//! volume to rounding, however coarse the mesh is.

use std::collections::BTreeSet;

use cranny_exact::DVec3;

use crate::ids::{FaceId, VertexId};
use crate::model::Model;

/// A blow that a surface yields to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// Where, in the body's frame, on its surface or near it.
    pub at: DVec3,
    /// Unit, into the body.
    pub inward: DVec3,
    /// How far from the blow's axis the surface yields, > 0.
    pub radius: f64,
    /// The volume that is displaced, >= 0.
    pub volume: f64,
    /// The greatest depth, >= 0: where the body is thin, not all of the volume is.
    pub most_depth: f64,
}

/// What [`Model::deform`] takes for a blow.
#[derive(Clone, Debug, PartialEq)]
pub struct Dent {
    /// Where vertices go, by vertex.
    pub moves: Vec<(VertexId, DVec3)>,
    /// Of the dent's middle, along the blow.
    pub depth: f64,
    /// The volume between the surface before and after.
    pub volume: f64,
}

impl Dent {
    /// The dent that a blow makes in a model.
    ///
    /// What yields is the part of the surface that hangs together with the place of the blow, looks
    /// towards it, and is no farther than the radius from the blow's axis and from its place along
    /// it. `None` where that holds no vertex that can move: the mesh is too coarse for the radius,
    /// or the blow meets nothing.
    ///
    /// ```
    /// use cranny_geometry::{BuildOptions, Blow, Dent, DVec3, Model};
    /// use cranny_shapes::{Torus};
    ///
    /// let (mut ring, _) = Model::build(Torus::default().build()?, &BuildOptions::default())?;
    /// let before = ring.mass_properties().expect("a solid").volume;
    /// let top = ring.mesh().vertices().iter().copied().max_by(|p, q| p.z.total_cmp(&q.z));
    /// let blow = Blow {
    ///     at: top.expect("a mesh has vertices"),
    ///     inward: DVec3::NEG_Z,
    ///     radius: 0.4,
    ///     volume: 0.002,
    ///     most_depth: 0.1,
    /// };
    /// let dent = Dent::of(&ring, &blow).expect("vertices are near");
    /// ring.deform(&dent.moves)?;
    /// let lost = before - ring.mass_properties().expect("a solid").volume;
    /// assert!((lost - 0.002).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(model: &Model, blow: &Blow) -> Option<Self> {
        let weighted = yielding(model, blow);
        let volume_per_depth = swept(model, &weighted, blow.inward);
        if !(volume_per_depth > 0.0 && blow.volume >= 0.0) {
            return None;
        }
        let depth = (blow.volume / volume_per_depth).min(blow.most_depth);
        let moves = weighted.iter().map(|&(vertex, weight)| {
            (vertex, model.mesh().position(vertex) + depth * weight * blow.inward)
        });
        Some(Self { moves: moves.collect(), depth, volume: depth * volume_per_depth })
    }
}

/// Vertices that yield, ascending, each with the share of the depth by which it moves.
fn yielding(model: &Model, blow: &Blow) -> Vec<(VertexId, f64)> {
    let looks_at_it = |&face: &FaceId| model.mesh().area_vector(face).dot(blow.inward) < 0.0;
    let weight = |vertex: VertexId| weight_at(blow, model.mesh().position(vertex));
    let faces_at = |vertex: VertexId| model.topology().faces_at(vertex).iter().copied();
    let all = model.mesh().vertex_ids();
    let near = all.filter(|&v| weight(v) > 0.0 && faces_at(v).any(|f| looks_at_it(&f)));
    let distance = |v: &VertexId| model.mesh().position(*v).distance_squared(blow.at);
    let Some(first) = near.min_by(|v, w| distance(v).total_cmp(&distance(w))) else {
        return Vec::new();
    };
    let mut found = BTreeSet::from([first]);
    let mut next = vec![first];
    while let Some(vertex) = next.pop() {
        for face in faces_at(vertex).filter(looks_at_it) {
            for corner in model.mesh().corners(face) {
                if weight(corner) > 0.0 && found.insert(corner) {
                    next.push(corner);
                }
            }
        }
    }
    found.into_iter().map(|vertex| (vertex, weight(vertex))).collect()
}

/// (1 − (ρ/r)²)² within the radius, 0 beyond it: no edge at the rim.
fn weight_at(blow: &Blow, place: DVec3) -> f64 {
    let from = place - blow.at;
    let along = from.dot(blow.inward);
    let across = (from - along * blow.inward).length_squared() / (blow.radius * blow.radius);
    if along.abs() > blow.radius || across >= 1.0 { 0.0 } else { (1.0 - across) * (1.0 - across) }
}

/// The volume that all faces sweep, for a unit of depth.
fn swept(model: &Model, weighted: &[(VertexId, f64)], inward: DVec3) -> f64 {
    let share = |vertex: VertexId| {
        let at = weighted.binary_search_by_key(&vertex, |(vertex, _)| *vertex);
        at.map_or(0.0, |at| weighted[at].1)
    };
    let around = weighted.iter().flat_map(|(vertex, _)| model.topology().faces_at(*vertex));
    let faces: BTreeSet<FaceId> = around.copied().collect();
    let volumes = faces.into_iter().map(|face| {
        let shares: f64 = model.mesh().corners(face).map(share).iter().sum();
        -model.mesh().area_vector(face).dot(inward) * shares / 3.0
    });
    volumes.sum()
}
