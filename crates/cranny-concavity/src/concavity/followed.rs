//! Concavities that follow deformations of their model.
//!
//! Faces are classified again that have moved or lay on facets that are gone, or may lie on new
//! ones; caps are made again on the facets of these and beside them; trees and envelopes of
//! untouched concavities are kept, and the other envelopes are built when they are read.
//! If all that moved lies beneath caps, concavities are only measured.
//!
//! No source: that everything follows local changes and equals what is made anew is this crate's
//! own. Cost: with [`FollowedConcavities::follow`].

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;

use cranny_exact::DVec3;

use super::{Concavities, Concavity, ConcavitySet, Disturbance, Stage, SurfaceSums};
use crate::caps::CapSurface;
use crate::features::{Assignment, Judged, NONE, RidgeOnFacet};
use crate::ids::ConcavityId;
use cranny_geometry::hull::lowest_first;
use cranny_geometry::{
    ChangeSet, FaceId, GrownAreas, Model, MovedFace, NodeChanges, Trail, VertexId, each_once,
};

/// The [`Concavities`] of a model that is deformed.
///
/// # What equals making them anew
///
/// Compared with [`Concavities::of`] the moved model, as long as no two vertices coincide:
///
/// - vertices, edges and faces are classified the same, and each face lies on the same facet;
/// - convex sets, concavities, their faces and boundary loops are the same and have the same ids.
///   Lids have the same boundary; lids and cap triangles may be numbered otherwise;
/// - all sizes agree to rounding;
/// - trees hold the same faces in exact boxes, but may divide them otherwise; envelopes are those
///   that are made from these trees.
///
/// ```
/// use cranny_concavity::FollowedConcavities;
/// use cranny_geometry::{BuildOptions, Model, VertexId};
/// use cranny_shapes::Cup;
///
/// let (mut cup, _) = Model::build(Cup::default().build()?, &BuildOptions::default())?;
/// let mut followed = FollowedConcavities::of(&cup);
/// let well = followed.concavities(&cup).iter().next().ok_or("a cup has a well")?;
/// // A vertex of the well goes a little inward.
/// let vertex: VertexId = cup.mesh().corners(well.faces[0])[0];
/// let well = well.id();
/// let place = cup.mesh().position(vertex);
/// let moved = cup.deform(&[(vertex, place + 0.001 * (cup.bounds().center() - place))])?;
/// let change = followed.follow(&cup, &moved);
/// assert_eq!(change.reshaped, [well]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FollowedConcavities {
    concavities: Concavities,
    /// For each concavity the envelope that it has among those there are, if any; none where all
    /// are as they should be.
    kept: Option<Vec<Option<usize>>>,
    /// The digest of the model that they are of.
    of: [u8; 32],
    // What following needs beside.
    assignment: Assignment,
    ridges: Vec<RidgeOnFacet>,
    trees: GrownAreas,
    sums: SurfaceSums,
}

/// What has become of concavities after a deformation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConcavityChange {
    /// Faces that came onto the hull or left it; ascending.
    pub reclassified: Vec<FaceId>,
    /// For each concavity before, by its id, the id of the one that has the same faces, or where it
    /// has none the same caps; `None` where there is no such.
    pub concavities: Vec<Option<ConcavityId>>,
    /// Concavities, by their ids afterwards, that have another shape than before: faces or caps of
    /// them have moved, or are others. Ascending.
    pub reshaped: Vec<ConcavityId>,
    /// Nodes of the arena of [`Concavities::trees`].
    pub trees: NodeChanges,
    /// What was done.
    pub work: ConcavityWork,
}

/// How much geometry was looked at to follow a deformation: figures that do not depend on the
/// machine.
///
/// Passes that only number things (a few nanoseconds a face) are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConcavityWork {
    /// Whether everything was made anew: then the figures below are of all there is.
    pub is_anew: bool,
    /// Faces judged: on the hull or not.
    pub faces: usize,
    /// Facets of the hull whose caps were looked at.
    pub facets: usize,
    /// Faces off the hull and caps that were grouped anew by what they hang together with.
    pub grouped: usize,
    /// Nodes of trees whose boxes were computed.
    pub nodes: usize,
    /// Faces of concavities whose envelopes the next call of [`FollowedConcavities::concavities`]
    /// builds.
    pub enveloped: usize,
}

impl FollowedConcavities {
    /// Makes them for a model.
    ///
    /// Cost: as [`Concavities::of`].
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self::with_leaf_size(model, Concavities::DEFAULT_LEAF_SIZE)
    }

    /// [`of`](Self::of) with leaves of the trees of at most so many faces.
    #[must_use]
    pub fn with_leaf_size(model: &Model, leaf_size: NonZeroUsize) -> Self {
        let nobody = &mut |_: Stage| {};
        let (concavities, assignment, ridges) =
            Concavities::with_assignment(model, leaf_size, nobody);
        let trees = GrownAreas::of(concavities.trees.arena().nodes());
        let (of, sums) = (model.digest(), SurfaceSums::default());
        Self { concavities, kept: None, of, assignment, ridges, trees, sums }
    }

    /// The concavities of the model, which is the one that was followed last.
    ///
    /// Cost: that of the envelopes of concavities that deformations have touched since the last
    /// call, and of copying the others.
    pub fn concavities(&mut self, model: &Model) -> &Concavities {
        let Self { concavities, kept, .. } = self;
        if let Some(kept) = kept.take() {
            let Concavities { set, trees, envelopes, .. } = concavities;
            let openings = set.openings();
            let pockets = set.pockets(&openings);
            *envelopes = envelopes.updated(model.mesh(), pockets, trees, |i| kept[i]);
        }
        concavities
    }

    /// Follows a deformation of the model: `change` is what [`Model::deform`] returned, `model`
    /// what it left.
    ///
    /// Where `change` is of another model than the one followed so far, or says that the model was
    /// made anew, all is made anew ([`ConcavityWork::is_anew`]).
    ///
    /// # Cost
    ///
    /// What [`ConcavityWork`] counts: the moved faces, the facets and concavities that these belong
    /// to, and what these border on. Beside that
    ///
    /// - each lid is glanced at, and a concavity with a moved face is measured as a whole;
    /// - where the hull changes, only concavities that share a vertex with something that has
    ///   changed are divided anew; but there is a look at which facet each face is on and at which
    ///   corners each cap has, and copying of rows;
    /// - where a face comes onto the hull or leaves it, a pass over all faces counts convex sets.
    ///
    /// Where the box of the hull changes, everything is classified. Where caps are shared, count
    /// negative or hang on isolated vertices, concavities are found anew, all of them.
    pub fn follow(&mut self, model: &Model, change: &ChangeSet) -> ConcavityChange {
        let old = self.concavities.set.len() as u32;
        if change.is_empty() && self.of == model.digest() {
            let concavities = (0..old).map(|c| Some(ConcavityId(c))).collect();
            return ConcavityChange { concavities, ..ConcavityChange::default() };
        }
        let Some(trail) = change.trail.as_ref().filter(|trail| trail.from == self.of) else {
            return self.make_anew(model, change);
        };
        self.of = model.digest();
        let mut step = FollowedDeformation {
            model,
            moved: change,
            trail,
            all: self,
            change: ConcavityChange::default(),
        };
        step.run();
        step.change
    }

    fn make_anew(&mut self, model: &Model, moved: &ChangeSet) -> ConcavityChange {
        let new = Self::with_leaf_size(model, self.concavities.leaf_size);
        let Concavities { features, set, trees, .. } = &new.concavities;
        let before = &self.concavities.features;
        let turned = |f: &FaceId| before.is_convex(*f) != features.is_convex(*f);
        let faces = model.mesh().faces().len();
        let held = set.iter().map(|c| c.faces.len()).sum::<usize>();
        let mut change = ConcavityChange {
            reclassified: model.mesh().face_ids().filter(turned).collect(),
            trees: NodeChanges::anew(),
            work: ConcavityWork {
                is_anew: true,
                faces,
                facets: model.hull().facet_count(),
                grouped: set.cap_count() + held,
                nodes: trees.arena().nodes().len(),
                enveloped: held,
            },
            ..ConcavityChange::default()
        };
        note_concavities(&mut change, moved, &self.concavities.set, set);
        *self = new;
        change
    }
}

/// One deformation that is followed.
struct FollowedDeformation<'a> {
    model: &'a Model,
    moved: &'a ChangeSet,
    trail: &'a Trail,
    all: &'a mut FollowedConcavities,
    change: ConcavityChange,
}

impl FollowedDeformation<'_> {
    fn run(&mut self) {
        self.all.sums.touch_faces(&self.moved.faces);
        let judged = match self.moved.hull {
            false => self.judge_moved(),
            true => self.judge_on_hull(),
        };
        self.close_pockets(&judged);
        self.change.work.nodes = self.change.trees.count();
    }

    /// The hull is as it was: faces that have moved may come onto it, or leave it.
    fn judge_moved(&mut self) -> Judged {
        let ChangeSet { vertices, faces, .. } = self.moved;
        let FollowedConcavities { concavities, assignment, .. } = &mut *self.all;
        assignment.update(self.model, &concavities.features, vertices, faces)
    }

    /// The hull is another one, here and there.
    fn judge_on_hull(&mut self) -> Judged {
        let (model, Trail { facets, triangles, .. }) = (self.model, self.trail);
        let FollowedConcavities { concavities, assignment, ridges, sums, .. } = &mut *self.all;
        sums.touch_hull(triangles, model.hull().triangle_count());
        let vertices = &self.moved.vertices;
        assignment.follow(model, &concavities.features, facets, vertices, ridges)
    }

    /// Features, caps and concavities, after faces were judged and facets of the hull have changed.
    fn close_pockets(&mut self, judged: &Judged) {
        let (model, facets) = (self.model, &self.trail.facets);
        let FollowedConcavities { concavities, assignment, ridges, .. } = &mut *self.all;
        let Concavities { features, set, .. } = concavities;
        let isolated = features.isolated_vertices().to_vec();
        let mut stale = features.update(model, assignment, judged, ridges);
        stale.extend(&facets.fresh);
        stale.extend(judged.reassigned.iter().flat_map(|change| [change.before, change.after]));
        stale.extend(self.moved.faces.iter().map(|f| assignment.facet_of_face[f.index()]));
        stale.retain(|&facet| facet != NONE);
        self.change.work.faces = judged.faces.len();
        let turned = judged.reassigned.iter().filter(|change| change.changes_class);
        self.change.reclassified = turned.map(|change| change.face).collect();

        if !self.moved.hull && stale.is_empty() && isolated == features.isolated_vertices() {
            self.remeasure();
            return;
        }
        let (caps, stale, looked_at) = set.caps.updated(model, assignment, ridges, &stale);
        self.change.work.facets = looked_at;
        self.renumber(caps, stale, !isolated.is_empty());
    }

    /// Faces beneath caps have moved, and nothing else that concavities consist of.
    fn remeasure(&mut self) {
        let (model, faces) = (self.model, &self.moved.faces);
        let Concavities { features, set, .. } = &mut self.all.concavities;
        let openings = set.openings();
        let reshaped = each_once(faces.iter().filter_map(|&f| set.of_face(f)));
        set.remeasure(model, features, &reshaped);
        self.change.concavities = set.iter().map(|c| Some(c.id())).collect();
        self.change.reshaped = reshaped;
        let same: Vec<Option<usize>> = (0..set.len()).map(Some).collect();
        self.follow_with_trees(&same);
        self.follow_with_envelopes(&same, &openings);
    }

    /// Faces or caps are others.
    fn renumber(&mut self, mut caps: CapSurface, stale: BTreeSet<u32>, had_tips: bool) {
        let (model, facets) = (self.model, &self.trail.facets);
        let changed = Disturbance {
            stale,
            fresh: &facets.fresh,
            gone: &facets.gone,
            turned: &self.change.reclassified,
            vertices: &self.moved.vertices,
            had_tips,
        };
        let FollowedConcavities { concavities, sums, .. } = &mut *self.all;
        let Concavities { features, set, .. } = concavities;
        let followed = set.followed(model, features, &mut caps, &changed, sums);
        let (new, grouped) = followed.unwrap_or_else(|| {
            let all = ConcavitySet::of(model, features, caps);
            let grouped = all.cap_count() + all.iter().map(|c| c.faces.len()).sum::<usize>();
            (all, grouped)
        });
        self.change.work.grouped = grouped;
        let old = std::mem::replace(set, new);
        let same = note_concavities(&mut self.change, self.moved, &old, set);
        let same: Vec<Option<usize>> = same.iter().map(|s| s.map(ConcavityId::index)).collect();
        self.follow_with_trees(&same);
        self.follow_with_envelopes(&same, &old.openings());
    }

    /// `same`: for each concavity the one before that has the same faces.
    fn follow_with_trees(&mut self, same: &[Option<usize>]) {
        let mesh = self.model.mesh();
        let FollowedConcavities { concavities, trees: grown, .. } = &mut *self.all;
        let Concavities { set, trees, leaf_size, .. } = concavities;
        let leaf_size = leaf_size.get();
        let changes = &mut self.change.trees;
        let groups = || set.iter().map(|c| c.faces);
        let in_place =
            same.len() == trees.len() && same.iter().enumerate().all(|(i, s)| *s == Some(i));
        if !in_place {
            let new = trees.updated(mesh, groups(), leaf_size, |i| same[i]);
            *grown = grown.carried(trees, &new, |i| same[i]);
            *trees = new;
        }
        let mut bad = Vec::new();
        for &id in &self.change.reshaped {
            let within = |m: &&MovedFace| set.of_face(m.face) == Some(id);
            let moved: Vec<MovedFace> = self.trail.moved.iter().filter(within).copied().collect();
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
            *changes = NodeChanges::anew();
        }
    }

    /// Which envelopes stay; the others are built when they are read. `before`: how
    /// the lids of each concavity before opened.
    fn follow_with_envelopes(&mut self, same: &[Option<usize>], before: &[Vec<DVec3>]) {
        let FollowedConcavities { concavities, kept, .. } = &mut *self.all;
        let set = &concavities.set;
        let openings = set.openings();
        let mut moved = vec![false; set.len()];
        for concavity in self.moved.faces.iter().filter_map(|&f| set.of_face(f)) {
            moved[concavity.index()] = true;
        }
        let stays = |i: usize| same[i].filter(|&old| !moved[i] && before[old] == openings[i]);
        let stale = set.iter().filter(|c| stays(c.id().index()).is_none());
        self.change.work.enveloped = stale.map(|c| c.faces.len()).sum();
        let all = (0..set.len()).map(|i| {
            let old = stays(i)?;
            kept.as_ref().map_or(Some(old), |older| older[old])
        });
        let all: Vec<Option<usize>> = all.collect();
        let are_same = all.len() == concavities.envelopes.len()
            && all.iter().enumerate().all(|(i, old)| *old == Some(i));
        *kept = (!are_same).then_some(all);
    }
}

/// Notes what has become of concavities. Returns for each of the new ones the old one that has the
/// same faces; of those without faces, the same caps.
fn note_concavities(
    change: &mut ConcavityChange,
    moved: &ChangeSet,
    old: &ConcavitySet,
    new: &ConcavitySet,
) -> Vec<Option<ConcavityId>> {
    let faceless = |all: &ConcavitySet| -> BTreeMap<Vec<[u32; 3]>, ConcavityId> {
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
        moved.faces.iter().filter_map(|&f| new.of_face(f)).collect();
    for (id, before) in (0..).map(ConcavityId).zip(&same) {
        if let Some(before) = before {
            map[before.index()] = Some(id);
        }
        if !before.is_some_and(|before| has_same_caps(&moved.vertices, [old, new], [before, id])) {
            reshaped.push(id);
        }
    }
    (change.concavities, change.reshaped) = (map, each_once(reshaped));
    same
}

/// Whether a concavity has the caps that it had, in the same place.
fn has_same_caps(
    moved: &[VertexId],
    [old, new]: [&ConcavitySet; 2],
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
