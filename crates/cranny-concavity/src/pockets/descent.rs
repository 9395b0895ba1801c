//! Descent of the layers of an envelope against the boxes of the other body's part.
//!
//! A box of the other body is a [`Probe`] in the pocket's frame. Where it offends a facet, either
//! the box is opened or what lies beneath the facet, whichever is larger; until a few faces are
//! left on both sides. What is not offended is certainly not met (see [`Envelope::offended`]).
//! Source and cost: see the module.

use std::ops::ControlFlow;

use cranny_exact::{Aabb, DVec3, RigidMap};
use cranny_geometry::{Content, FaceId, FaceTree, Model};

use super::{PocketBody, PocketCounters, PosedModels};
use crate::envelope::Probe;
use crate::{ConcavityId, EnvelopeFacetId, Envelopes, LayerId, NodeSet};

/// A part of a body's surface: the faces of a concavity, or those of none, in a tree.
pub(super) struct SurfacePart<'a> {
    pub(super) concavity: Option<ConcavityId>,
    body: &'a PocketBody,
    tree: &'a FaceTree,
    root: u32,
    /// The nodes that hold faces of the part; all, if there is none.
    nodes: Option<&'a NodeSet>,
}

impl<'a> SurfacePart<'a> {
    /// The faces of a concavity, which has some.
    pub(super) fn pocket(body: &'a PocketBody, id: ConcavityId) -> Option<Self> {
        let trees = body.concavities().trees();
        let root = trees.root(id.index())?;
        Some(Self { concavity: Some(id), body, tree: trees.arena(), root, nodes: None })
    }

    /// The faces in no concavity, if there are any.
    pub(super) fn rest(model: &'a Model, body: &'a PocketBody) -> Option<Self> {
        let nodes = Some(body.rest());
        let rest = Self { concavity: None, body, tree: model.tree(), root: 0, nodes };
        body.rest().has(0).then_some(rest)
    }

    fn bounds(&self, node: u32) -> &'a Aabb {
        &self.tree.node(node).bounds
    }

    fn holds(&self, node: u32) -> bool {
        self.nodes.is_none_or(|nodes| nodes.has(node))
    }

    fn faces(&self, leaf: u32) -> impl Iterator<Item = FaceId> {
        let is_ours = |face: &FaceId| self.nodes.is_none() || self.body.is_on_hull(*face);
        self.tree.leaf_faces(leaf).iter().copied().filter(is_ours)
    }
}

/// Calls `visit` with pairs of a face of a pocket and one of the other body's part: all that meet
/// are among them. `host`: whose pocket it is.
pub(super) fn for_each_pair_in_pocket(
    pair: &PosedModels<'_>,
    host: usize,
    (envelopes, pocket): (&Envelopes, ConcavityId),
    guest: &SurfacePart<'_>,
    counters: &mut PocketCounters,
    mut visit: impl FnMut(FaceId, FaceId) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let envelope = envelopes.envelope(pocket.index());
    let host_from_guest = pair.map_to(host);
    let Some(first) = envelope.first_layer() else { return ControlFlow::Continue(()) };
    let mut stack = vec![(Beneath::Layer(first), guest.root)];
    let mut offended = Vec::new();
    while let Some((beneath, node)) = stack.pop() {
        let probe = posed_box(&host_from_guest, pair.error, guest.bounds(node));
        offended.clear();
        match beneath {
            Beneath::Layer(layer) => {
                counters.facets_compared += envelopes.layer(layer).len() as u64;
                envelope.offended(layer, &probe, |facet| offended.push(facet));
            }
            Beneath::Facet(facet) => {
                counters.facets_compared += 1;
                offended.extend(envelope.is_offended(facet, &probe).then_some(facet));
            }
        }
        for &facet in &offended {
            match next(envelopes, facet, guest, node) {
                Next::Node([left, right]) => {
                    let children = [right, left].into_iter().filter(|&child| guest.holds(child));
                    stack.extend(children.map(|child| (Beneath::Facet(facet), child)));
                }
                Next::Layer(layer) => stack.push((Beneath::Layer(layer), node)),
                Next::Faces => {
                    for &f in envelopes.faces_beneath(facet) {
                        guest.faces(node).try_for_each(|g| visit(f, g))?;
                    }
                }
            }
        }
    }
    ControlFlow::Continue(())
}

/// What a box is held against.
#[derive(Clone, Copy)]
enum Beneath {
    Layer(LayerId),
    Facet(EnvelopeFacetId),
}

/// What is opened where a box offends a facet.
enum Next {
    /// The box: its children.
    Node([u32; 2]),
    /// What lies beneath the facet.
    Layer(LayerId),
    /// Nothing is left to be opened.
    Faces,
}

fn next(envelopes: &Envelopes, facet: EnvelopeFacetId, guest: &SurfacePart, node: u32) -> Next {
    let size = |b: &Aabb| (b.max - b.min).length_squared();
    let is_larger = || size(guest.bounds(node)) >= size(&envelopes.facet(facet).bounds);
    match (guest.tree.content(node), envelopes.layer_beneath(facet)) {
        (Content::Leaf { .. }, None) => Next::Faces,
        (Content::Leaf { .. }, Some(layer)) => Next::Layer(layer),
        (Content::Inner { .. }, Some(layer)) if !is_larger() => Next::Layer(layer),
        (Content::Inner { left, right }, _) => Next::Node([left, right]),
    }
}

/// A box of the guest, seen in the host's frame.
fn posed_box(map: &RigidMap, error: f64, bounds: &Aabb) -> Probe<impl Fn(DVec3) -> f64> {
    let (center, half) = (map.apply(bounds.center()), bounds.half_extents());
    let least = move |direction: DVec3| {
        let along = (map.linear.transpose() * direction).abs();
        (direction.dot(center) - along.dot(half) - error).next_down()
    };
    Probe::new(least, 0.0)
}
