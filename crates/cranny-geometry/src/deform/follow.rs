//! A deformation under way: stage after stage follows the moved vertices.
//!
//! Sources stand in the module, costs with [`Model::deform`](crate::Model::deform).

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::Aabb;
use cranny_exact::DVec3;

use super::renew::Renewal;
use super::totals::Totals;
use super::{ChangeSet, Work, Workshop};
use crate::caps::CapSurface;
use crate::concavity::{Concavities, Concavity, Disturbance};
use crate::features::{Judged, NONE};
use crate::hull::{ConvexHull, FacetChange, Followed, HullKind, Location, lowest_first};
use crate::ids::{ConcavityId, FaceId, VertexId};
use crate::late::Late;
use crate::model::{FormerEnvelopes, Parts, openings};
use crate::patches::Patches;
use crate::tree::{FaceForest, FaceTree, GrownAreas, MovedFace, NodeChanges};

/// Where the hull changes and one face in so many has moved, or more, everything is built anew: to follow what moved
/// costs more. Smaller, and it costs more than building; larger, and what would be cheaper is built.
const WIDE: usize = 12;

pub(super) struct Deformation<'a> {
    parts: &'a mut Parts,
    workshop: &'a mut Workshop,
    moved: Vec<MovedFace>,
    /// Taken out of the parts, as the following, and put back in the end.
    tree: FaceTree,
    patches: Patches,
    concavity_trees: FaceForest,
    envelopes: Option<FormerEnvelopes>,
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
        let (concavity_trees, envelopes) = parts.take_late();
        let (tree, patches) = parts.take_surface();
        for &(vertex, place) in moves {
            parts.mesh.set_position(vertex, place);
        }
        let vertices = moves.iter().map(|m| m.0).collect();
        Self {
            parts,
            workshop,
            moved,
            tree,
            patches,
            concavity_trees,
            envelopes,
            change: ChangeSet { vertices, faces, ..ChangeSet::default() },
        }
    }

    /// What has changed, and whether what the workshop holds has followed.
    pub(super) fn run(mut self) -> (ChangeSet, bool) {
        self.workshop.sums.touch_faces(&self.change.faces);
        let keeps_hull = self.keeps_hull();
        if !keeps_hull && WIDE * self.change.faces.len() > self.parts.mesh.faces().len() {
            return (self.build_anew(), false);
        }
        self.fit_tree();
        self.follow_with_patches();
        if keeps_hull {
            self.classify_moved();
        } else {
            self.follow_hull();
        }
        let Self { parts, workshop, change, .. } = &mut self;
        change.work.summed = workshop.totals.follow(parts, &change.vertices, &change.faces);
        let nodes = [&self.change.tree, &self.change.concavity_trees, &self.change.patch_trees];
        self.change.work.nodes = nodes.iter().map(|n| n.count()).sum();
        self.parts.concavity_trees = Late::made(self.concavity_trees);
        self.parts.put_surface(self.tree, self.patches);
        match self.envelopes {
            Some(FormerEnvelopes { envelopes, kept })
                if kept.iter().enumerate().all(|(i, old)| *old == Some(i))
                    && kept.len() == envelopes.len() =>
            {
                self.parts.envelopes = Late::made(envelopes);
            }
            stale => self.parts.former_envelopes = stale,
        }
        self.parts.is_as_made = false;
        (self.change, true)
    }

    /// Makes everything from the moved mesh.
    fn build_anew(self) -> ChangeSet {
        let Self { parts, mut change, tree, patches, .. } = self;
        parts.put_surface(tree, patches);
        let renewal = Renewal::of_moved(parts);
        Totals::of(parts).follow(parts, &[], &[]);
        parts.is_as_made = false;
        let Parts { mesh, hull, concavities, .. } = &*parts;
        let (tree, patches) = (parts.tree(), parts.patches());
        let (faces, trees) = (mesh.faces().len(), parts.concavity_trees().arena());
        change.work = Work {
            is_anew: true,
            faces,
            facets: hull.facet_count(),
            grouped: concavities.cap_count()
                + concavities.iter().map(|c| c.faces.len()).sum::<usize>(),
            located: change.work.located,
            hull_triangles: hull.triangle_count(),
            nodes: tree.nodes().len() + trees.nodes().len() + patches.trees().arena().nodes().len(),
            enveloped: concavities.iter().map(|c| c.faces.len()).sum(),
            patched: faces,
            summed: faces + mesh.vertices().len(),
        };
        renewal.tell(&mut change, parts);
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
            *changes = NodeChanges { renumbered: true, ..NodeChanges::default() };
        }
    }

    fn follow_with_patches(&mut self) {
        let Parts { mesh, topology, .. } = &*self.parts;
        let Workshop { patch_trees, patch_top, .. } = &mut *self.workshop;
        let body = self.tree.node(0).bounds;
        let update =
            self.patches.update(mesh, topology, &body, &self.moved, patch_trees, patch_top);
        self.change.work.patched = update.faces;
        self.change.patches = update.map;
        self.change.patch_trees = update.nodes;
    }

    /// Whether the hull is that of the moved mesh too; the lowest of the vertices in one place stands
    /// for all.
    fn keeps_hull(&mut self) -> bool {
        let Parts { mesh, hull, .. } = &*self.parts;
        let is_extreme = |v: &VertexId| hull.vertex_of_source(*v).is_some();
        let Some(&first) = self.change.vertices.first() else { return true };
        if hull.kind() != HullKind::Volume || self.change.vertices.iter().any(is_extreme) {
            return false;
        }
        // Moved vertices lie side by side, as a rule: each walk begins where the last one ended.
        let mut at = self.triangle_above(first);
        let mut passed = 0;
        let keeps = self.change.vertices.iter().all(|&v| {
            let place = mesh.position(v);
            let walked =
                self.workshop.inside.and_then(|inside| hull.locate_from(inside, place, at));
            let Some(found) = walked else {
                passed += hull.triangle_count();
                return match hull.locate(place) {
                    Location::Inside => true,
                    Location::On => !hull.positions().contains(&place),
                    Location::Outside => false,
                };
            };
            at = found.triangle;
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

    /// A triangle of the hull near a vertex: of the lid above it, if there is one; anywhere else, any.
    fn triangle_above(&self, v: VertexId) -> u32 {
        let Parts { topology, hull, concavities, .. } = &*self.parts;
        let beneath = topology.faces_at(v).iter().find_map(|&f| concavities.of_face(f));
        let cap = beneath.and_then(|id| concavities.get(id).caps.first());
        cap.map_or(0, |&cap| hull.facet(concavities.cap(cap).facet).triangles[0])
    }

    /// The hull is as it was: faces that have moved may come onto it, or leave it.
    fn classify_moved(&mut self) {
        let Parts { mesh, topology, hull, features, .. } = &*self.parts;
        let ChangeSet { vertices, faces, .. } = &self.change;
        let assignment = &mut self.workshop.assignment;
        let judged = assignment.update(mesh, topology, hull, features, vertices, faces);
        self.close_pockets(&judged, FacetChange::default());
    }

    /// The hull is another one, here and there.
    fn follow_hull(&mut self) {
        let Parts { mesh, topology, hull, features, flatness, .. } = &mut *self.parts;
        let tree = &self.tree;
        let vertices = &self.change.vertices;
        let near = |bounds: &Aabb| {
            let mut faces = Vec::new();
            tree.visit(|b| b.overlaps(bounds), |f| faces.push(f));
            let corners = faces.iter().flat_map(|&f| mesh.corners(f));
            let inside = corners.filter(|&v| bounds.contains_point(mesh.position(v)));
            (inside.collect::<Vec<VertexId>>(), faces)
        };
        let inside = self.workshop.inside;
        let old = std::mem::replace(hull, ConvexHull::of_points(&[]));
        let Followed { hull: new, facets, triangles, measured, inside } =
            old.followed(mesh.vertices(), vertices, inside, *flatness, |bounds| near(bounds).0);
        *hull = new;
        self.workshop.inside = inside;
        self.change.hull = true;
        self.change.work.hull_triangles = measured;
        let Workshop { assignment, ridges, sums, .. } = &mut *self.workshop;
        sums.touch_hull(&triangles, hull.triangle_count());
        let judged =
            assignment.follow(mesh, topology, features, hull, &facets, vertices, ridges, near);
        self.close_pockets(&judged, facets);
    }

    /// Features, caps and concavities, after faces were judged and facets of the hull have changed.
    fn close_pockets(&mut self, judged: &Judged, facets: FacetChange) {
        let Parts { mesh, topology, hull, features, concavities, .. } = &mut *self.parts;
        let Workshop { assignment, ridges, .. } = &mut *self.workshop;
        let isolated = features.isolated_vertices().to_vec();
        let mut stale = features.update(mesh, topology, assignment, judged, ridges);
        stale.extend(&facets.fresh);
        stale.extend(judged.reassigned.iter().flat_map(|change| [change.before, change.after]));
        stale.extend(self.change.faces.iter().map(|f| assignment.facet_of_face[f.index()]));
        stale.retain(|&facet| facet != NONE);
        self.change.work.faces = judged.faces.len();
        let turned = judged.reassigned.iter().filter(|change| change.changes_class);
        self.change.reclassified = turned.map(|change| change.face).collect();

        if !self.change.hull && stale.is_empty() && isolated == features.isolated_vertices() {
            self.remeasure_concavities();
            return;
        }
        let caps = concavities.cap_surface();
        let (caps, stale, looked_at) =
            caps.updated(mesh, topology, hull, assignment, ridges, &stale);
        self.change.work.facets = looked_at;
        self.renumber_concavities(caps, stale, &facets, !isolated.is_empty());
    }

    /// Faces beneath caps have moved, and nothing else that concavities consist of.
    fn remeasure_concavities(&mut self) {
        let Parts { mesh, topology, hull, features, concavities, .. } = &mut *self.parts;
        let of_faces = self.change.faces.iter().filter_map(|&f| concavities.of_face(f));
        let mut reshaped: Vec<ConcavityId> = of_faces.collect();
        reshaped.sort_unstable();
        reshaped.dedup();
        concavities.remeasure(mesh, topology, hull, features, &reshaped);
        self.change.concavities = concavities.iter().map(|c| Some(c.id())).collect();
        self.change.reshaped = reshaped;
        let same: Vec<Option<usize>> = (0..concavities.len()).map(Some).collect();
        let openings = openings(concavities);
        self.follow_with_trees(&same);
        self.follow_with_envelopes(&same, &openings);
    }

    /// Faces or caps are others.
    fn renumber_concavities(
        &mut self,
        mut caps: CapSurface,
        stale: BTreeSet<u32>,
        facets: &FacetChange,
        had_tips: bool,
    ) {
        let Parts { mesh, topology, hull, features, concavities, .. } = &mut *self.parts;
        let changed = Disturbance {
            stale,
            fresh: &facets.fresh,
            gone: &facets.gone,
            turned: &self.change.reclassified,
            vertices: &self.change.vertices,
            had_tips,
        };
        let sums = &mut self.workshop.sums;
        let followed =
            concavities.followed(mesh, topology, hull, features, &mut caps, &changed, sums);
        let (new, grouped) = followed.unwrap_or_else(|| {
            let all = Concavities::of(mesh, topology, hull, features, caps);
            let grouped = all.cap_count() + all.iter().map(|c| c.faces.len()).sum::<usize>();
            (all, grouped)
        });
        self.change.work.grouped = grouped;
        let old = std::mem::replace(concavities, new);
        self.parts.hull_covers = Late::default();
        let concavities = &self.parts.concavities;
        let same = tell_concavities(&mut self.change, &old, concavities);
        let same: Vec<Option<usize>> = same.iter().map(|s| s.map(ConcavityId::index)).collect();
        let openings = openings(&old);
        self.follow_with_trees(&same);
        self.follow_with_envelopes(&same, &openings);
    }

    /// `same`: for each concavity the one before that has the same faces.
    fn follow_with_trees(&mut self, same: &[Option<usize>]) {
        let Parts { mesh, concavities, concavity_leaf_size, .. } = &*self.parts;
        let (trees, leaf_size) = (&mut self.concavity_trees, *concavity_leaf_size);
        let grown = &mut self.workshop.concavity_trees;
        let changes = &mut self.change.concavity_trees;
        let groups = || concavities.iter().map(|c| c.faces);
        let in_place =
            same.len() == trees.len() && same.iter().enumerate().all(|(i, s)| *s == Some(i));
        if !in_place {
            let new = trees.updated(mesh, groups(), leaf_size, |i| same[i]);
            *grown = grown.carried(trees, &new, |i| same[i]);
            *trees = new;
        }
        let mut bad = Vec::new();
        for &id in &self.change.reshaped {
            let within = |m: &&MovedFace| concavities.of_face(m.face) == Some(id);
            let moved: Vec<MovedFace> = self.moved.iter().filter(within).copied().collect();
            let i = id.index();
            let is_well = same[i].is_none()
                || moved.is_empty()
                || trees.refit(i, mesh, &moved, leaf_size, grown, changes);
            if !is_well {
                bad.push(i);
            }
        }
        changes.settle();
        if !bad.is_empty() {
            let kept = |i: usize| (!bad.contains(&i)).then_some(i);
            let new = trees.updated(mesh, groups(), leaf_size, kept);
            *grown = grown.carried(trees, &new, kept);
            *trees = new;
        }
        if !in_place || !bad.is_empty() {
            *changes = NodeChanges { renumbered: true, ..NodeChanges::default() };
        }
    }

    /// Tells which envelopes stay; the others are built when somebody asks for them next. `before`: how the
    /// lids of each concavity before opened.
    fn follow_with_envelopes(&mut self, same: &[Option<usize>], before: &[Vec<DVec3>]) {
        let concavities = &self.parts.concavities;
        let openings = openings(concavities);
        let mut moved = vec![false; concavities.len()];
        for concavity in self.change.faces.iter().filter_map(|&f| concavities.of_face(f)) {
            moved[concavity.index()] = true;
        }
        let kept = |i: usize| same[i].filter(|&old| !moved[i] && before[old] == openings[i]);
        let stale = concavities.iter().filter(|c| kept(c.id().index()).is_none());
        self.change.work.enveloped = stale.map(|c| c.faces.len()).sum();
        if let Some(former) = &mut self.envelopes {
            let older = &former.kept;
            let all = (0..concavities.len()).map(|i| kept(i).and_then(|old| older[old]));
            former.kept = all.collect();
        }
    }
}

/// Tells what has become of concavities, once the moved vertices and their faces are told. Returns for each
/// of the new ones the old one that has the same faces; of those without faces, the same caps.
pub(super) fn tell_concavities(
    change: &mut ChangeSet,
    old: &Concavities,
    new: &Concavities,
) -> Vec<Option<ConcavityId>> {
    let faceless = |all: &Concavities| -> BTreeMap<Vec<[u32; 3]>, ConcavityId> {
        let caps = |c: &Concavity<'_>| {
            let mut caps: Vec<[u32; 3]> = c
                .caps
                .iter()
                .map(|&cap| lowest_first(all.corners_of_cap(cap).map(|v| v.0)))
                .collect();
            caps.sort_unstable();
            caps
        };
        all.iter().filter(|c| c.faces.is_empty()).map(|c| (caps(&c), c.id())).collect()
    };
    let mut same: Vec<Option<ConcavityId>> = vec![None; new.len()];
    for concavity in new.iter() {
        let faces = concavity.faces;
        let before = faces.first().and_then(|&first| old.of_face(first));
        same[concavity.id().index()] = before.filter(|&before| old.get(before).faces == faces);
    }
    let before = faceless(old);
    for (caps, id) in faceless(new) {
        same[id.index()] = before.get(&caps).copied();
    }
    let mut map = vec![None; old.len()];
    let mut reshaped: Vec<ConcavityId> =
        change.faces.iter().filter_map(|&f| new.of_face(f)).collect();
    for (id, before) in (0..).map(ConcavityId).zip(&same) {
        if let Some(before) = before {
            map[before.index()] = Some(id);
        }
        if !before.is_some_and(|before| has_same_caps(&change.vertices, [old, new], [before, id])) {
            reshaped.push(id);
        }
    }
    reshaped.sort_unstable();
    reshaped.dedup();
    (change.concavities, change.reshaped) = (map, reshaped);
    same
}

/// Whether a concavity has the caps that it had, in the same place.
fn has_same_caps(
    moved: &[VertexId],
    [old, new]: [&Concavities; 2],
    [before, id]: [ConcavityId; 2],
) -> bool {
    let (a, b) = (old.get(before).caps, new.get(id).caps);
    a.len() == b.len()
        && a.iter().zip(b).all(|(&a, &b)| {
            let corners = old.corners_of_cap(a);
            corners == new.corners_of_cap(b)
                && corners.iter().all(|v| moved.binary_search(v).is_err())
        })
}
