//! A deformation under way: stage after stage follows the moved vertices.
//!
//! Sources stand in the module, costs with [`Model::deform`](crate::Model::deform).

use cranny_exact::Aabb;
use cranny_exact::DVec3;

use super::renew::Renewal;
use super::totals::Totals;
use super::{ChangeSet, Trail, Work, Workshop};
use crate::hull::{ConvexHull, FacetChange, Followed, HullKind, Location};
use crate::ids::{FaceId, VertexId};
use crate::model::Parts;
use crate::tree::{FaceTree, GrownAreas, MovedFace, NodeChanges};

/// Where the hull changes and one face in so many has moved, or more, everything is built anew: to
/// follow what moved costs more. Smaller, and it costs more than building; larger, and what would
/// be cheaper is built.
const WIDE: usize = 12;

pub(super) struct Deformation<'a> {
    parts: &'a mut Parts,
    workshop: &'a mut Workshop,
    moved: Vec<MovedFace>,
    /// Taken out of the parts, and put back in the end.
    tree: FaceTree,
    change: ChangeSet,
}

impl<'a> Deformation<'a> {
    /// Moves the vertices, whose faces are `faces`; both ascending.
    pub(super) fn begin(
        parts: &'a mut Parts,
        workshop: &'a mut Workshop,
        moves: &[(VertexId, DVec3)],
        faces: Vec<FaceId>,
    ) -> Self {
        let old =
            |&face: &FaceId| MovedFace { face, old: Aabb::of_points(parts.mesh.triangle(face)) };
        let moved = faces.iter().map(old).collect();
        let tree = parts.take_tree();
        for &(vertex, place) in moves {
            parts.mesh.set_position(vertex, place);
        }
        let vertices = moves.iter().map(|m| m.0).collect();
        Self {
            parts,
            workshop,
            moved,
            tree,
            change: ChangeSet { vertices, faces, ..ChangeSet::default() },
        }
    }

    /// What has changed, and whether what the workshop holds has followed. `from`: the digest of
    /// the model before.
    pub(super) fn run(mut self, from: [u8; 32]) -> (ChangeSet, bool) {
        let keeps_hull = self.keeps_hull();
        if !keeps_hull && WIDE * self.change.faces.len() > self.parts.mesh.faces().len() {
            return (self.build_anew(), false);
        }
        self.fit_tree();
        self.follow_with_patches();
        let (facets, triangles) = match keeps_hull {
            true => (FacetChange::default(), Vec::new()),
            false => self.follow_hull(),
        };
        let Self { parts, workshop, change, moved, .. } = &mut self;
        change.work.summed = workshop.totals.follow(parts, &change.vertices, &change.faces);
        change.work.nodes = change.tree.count();
        let moved = std::mem::take(moved);
        change.trail = Some(Trail { from, moved, facets, triangles });
        self.parts.put_tree(self.tree);
        (self.change, true)
    }

    /// Makes everything from the moved mesh.
    fn build_anew(self) -> ChangeSet {
        let Self { parts, mut change, tree, .. } = self;
        parts.put_tree(tree);
        let renewal = Renewal::of_moved(parts);
        Totals::of(parts).follow(parts, &[], &[]);
        let Parts { mesh, hull, .. } = &*parts;
        let faces = mesh.faces().len();
        change.work = Work {
            is_anew: true,
            located: change.work.located,
            hull_triangles: hull.triangle_count(),
            nodes: parts.tree().nodes().len(),
            patched: faces,
            summed: faces + mesh.vertices().len(),
        };
        renewal.report(&mut change, parts);
        change
    }

    fn fit_tree(&mut self) {
        let Parts { mesh, leaf_size, .. } = &*self.parts;
        let tree = &mut self.tree;
        let (grown, changes) = (&mut self.workshop.tree, &mut self.change.tree);
        if tree.refit(0, mesh, &self.moved, *leaf_size, grown, changes) {
            changes.settle();
        } else {
            *tree = FaceTree::of(mesh, *leaf_size);
            *grown = GrownAreas::of(tree.nodes());
            *changes = NodeChanges::anew();
        }
    }

    fn follow_with_patches(&mut self) {
        let Parts { mesh, topology, patches, .. } = &mut *self.parts;
        let body = self.tree.node(0).bounds;
        let update = patches.update(mesh, topology, &body, &self.change.faces);
        self.change.work.patched = update.faces;
        self.change.patches = update.map;
    }

    /// Whether the hull is that of the moved mesh too; the lowest of the vertices in one place
    /// stands for all.
    fn keeps_hull(&mut self) -> bool {
        let Parts { mesh, hull, .. } = &*self.parts;
        let is_extreme = |v: &VertexId| hull.vertex_of_source(*v).is_some();
        if hull.kind() != HullKind::Volume || self.change.vertices.iter().any(is_extreme) {
            return false;
        }
        let Some(&first) = self.change.vertices.first() else { return true };
        let Workshop { above, inside, .. } = &mut *self.workshop;
        // Moved vertices lie side by side, as a rule: each walk begins where the last one ended.
        // After the hull has changed, a triangle of that number may be any, or none.
        let mut at = above[first.index()].min(hull.triangle_count() as u32 - 1);
        let mut passed = 0;
        let keeps = self.change.vertices.iter().all(|&v| {
            let place = mesh.position(v);
            let walked = inside.and_then(|inside| hull.locate_from(inside, place, at));
            let Some(found) = walked else {
                passed += hull.triangle_count();
                return match hull.locate(place) {
                    Location::Inside => true,
                    Location::On => !hull.positions().contains(&place),
                    Location::Outside => false,
                };
            };
            at = found.triangle;
            above[v.index()] = at;
            passed += found.passed;
            match found.location {
                Location::Inside => true,
                // No vertex of the hull lies in a triangle but its own.
                Location::On => {
                    hull.triangle(at as usize).into_iter().all(|c| hull.position(c) != place)
                }
                Location::Outside => false,
            }
        });
        self.change.work.located = passed;
        keeps
    }

    /// The hull is another one, here and there: which facets and triangles are others.
    fn follow_hull(&mut self) -> (FacetChange, Vec<u32>) {
        let Parts { mesh, hull, flatness, .. } = &mut *self.parts;
        let tree = &self.tree;
        let near = |bounds: &Aabb| tree.vertices_within(mesh, bounds).0;
        let (vertices, inside) = (&self.change.vertices, self.workshop.inside);
        let old = std::mem::replace(hull, ConvexHull::of_points(&[]));
        let Followed { hull: new, facets, triangles, measured, inside } =
            old.followed(mesh.vertices(), vertices, inside, *flatness, near);
        *hull = new;
        self.workshop.inside = inside;
        self.change.hull = true;
        self.change.work.hull_triangles = measured;
        (facets, triangles)
    }
}
