//! Concavities after facets of the hull, caps, or faces on it have changed here and there.
//!
//! Whatever shares a vertex with a cap that is new or gone, with a face that came onto the hull or
//! left it, or has moved, is *disturbed*, and so are the concavities that it belongs to. What hangs
//! together depends on what meets at edges; so the other concavities are what they were, and these
//! are divided anew by themselves. Then all are put in order, and the rows of the others copied.
//!
//! No source: this crate's own, for the reason above; that nothing else hangs together with a part
//! that is divided anew is checked, and if something does everything is. Cost: O(m log m) in the
//! faces and caps of disturbed concavities, a glance at all caps, faces and facets, and copying.
//! Everything where voids or islands may lie in others, for these are nested anew.

use std::collections::{BTreeMap, BTreeSet};

use super::build::{BLANK, CANCELLED, first_of_caps};
use super::input::{Input, twice_area_vector};
use super::region::{Group, Part};
use super::{Concavity, ConcavitySet, LidRecord, MIXED, Record, SOLID, SurfaceSums};
use crate::caps::CapSurface;
use crate::features::{Features, NONE};
use crate::ids::{CapId, ConcavityId};
use cranny_exact::DVec3;
use cranny_geometry::hull::FacetId;
use cranny_geometry::rows::replaced;
use cranny_geometry::triangulate::outlines;
use cranny_geometry::{FaceId, HalfEdgeId, Model, VertexId, each_once};

/// What has changed.
pub(crate) struct Disturbance<'a> {
    /// Facets on which faces or caps may be others, by their numbers now; new ones among them.
    pub(crate) stale: BTreeSet<u32>,
    /// Facets that are new or have another number.
    pub(crate) fresh: &'a [u32],
    /// Facets before whose number means nothing, or another facet.
    pub(crate) gone: &'a [u32],
    /// Faces that came onto the hull or left it.
    pub(crate) turned: &'a [FaceId],
    /// Vertices that have moved.
    pub(crate) vertices: &'a [VertexId],
    /// Whether there were isolated vertices.
    pub(crate) had_tips: bool,
}

/// A concavity in the new order.
enum KeptOrMade {
    /// As it was.
    Kept(usize),
    Made(usize),
}

impl ConcavitySet {
    /// The concavities of other caps, and how many faces and caps were looked at for which hang
    /// together; `None` where all have to be found anew.
    pub(crate) fn followed(
        &self,
        model: &Model,
        features: &Features,
        caps: &mut CapSurface,
        changed: &Disturbance<'_>,
        sums: &mut SurfaceSums,
    ) -> Option<(Self, usize)> {
        let hull = model.hull();
        let is_local = self.caps.is_sound()
            && caps.is_sound()
            && features.isolated_vertices().is_empty()
            && !changed.had_tips
            && 2 * changed.fresh.len() <= hull.facet_count();
        if !is_local {
            return None;
        }
        let input = Input::of(model, features);
        let others = self.facets_with_other_caps(caps, changed);
        let disturbed = self.disturbed(&input, caps, changed, &others);
        let ids = self.numbers_of_caps(hull.facet_count(), caps, &others);
        let part = self.part_of(&input, caps, &disturbed, changed, &others, &ids);
        let grouped = part.faces.len() + part.caps.len();
        let groups = part.groups(&input, caps)?;
        let mut all = self.put_in_order(&input, std::mem::take(caps), &disturbed, groups, &ids);
        input.cover_again(&mut all, self, &disturbed, changed, hull.facet_count());
        let owned = all.cap_order.len() as u32;
        all.skin = sums.skin(&input, &all.records, all.caps.triangles.len() as u32 - owned);
        input.name(&mut all);
        input.nest(&mut all);
        Some((all, grouped))
    }

    /// Facets, before or now, whose caps are others.
    fn facets_with_other_caps(
        &self,
        caps: &CapSurface,
        changed: &Disturbance<'_>,
    ) -> BTreeSet<u32> {
        let mut others: BTreeSet<u32> = changed.fresh.iter().chain(changed.gone).copied().collect();
        let differs = |f: &&u32| row_of(&self.caps, **f) != row_of(caps, **f);
        others.extend(changed.stale.iter().filter(differs));
        others
    }

    /// For each concavity whether anything near it has changed.
    fn disturbed(
        &self,
        input: &Input<'_>,
        caps: &CapSurface,
        changed: &Disturbance<'_>,
        others: &BTreeSet<u32>,
    ) -> Vec<bool> {
        let mut near: Vec<u32> = changed.vertices.iter().map(|v| v.0).collect();
        near.extend(changed.turned.iter().flat_map(|&f| input.mesh.corners(f)).map(|v| v.0));
        for &facet in others {
            near.extend(row_of(&self.caps, facet).iter().flatten());
            near.extend(row_of(caps, facet).iter().flatten());
        }
        let mut is_near = vec![false; input.mesh.vertices().len()];
        near.iter().for_each(|&v| is_near[v as usize] = true);
        let mut disturbed = vec![false; self.records.len()];
        let faces = near.iter().flat_map(|&v| input.topology.faces_at(VertexId(v)));
        let of_faces = faces.map(|f| self.concavity_of_face[f.index()]);
        let corners = self.caps.triangles.iter().zip(&self.concavity_of_cap);
        let of_caps =
            corners.filter(|(c, _)| c.iter().any(|&v| is_near[v as usize])).map(|(_, &own)| own);
        for concavity in of_faces.chain(of_caps).filter(|&c| c != NONE) {
            disturbed[concavity as usize] = true;
        }
        disturbed
    }

    /// What number each cap has now, by its number before; [`NONE`] where it is gone.
    fn numbers_of_caps(
        &self,
        facets: usize,
        caps: &CapSurface,
        others: &BTreeSet<u32>,
    ) -> Vec<u32> {
        let before: Vec<u32> = (0..self.caps.triangles.len() as u32).collect();
        let row = |&f: &u32| (f, vec![NONE; row_of(caps, f).len()]);
        let changed: BTreeMap<u32, Vec<u32>> = others.iter().map(row).collect();
        let (_, before) = replaced(&self.caps.facet_starts, &before, facets, &changed, |cap| cap);
        let mut now = vec![NONE; self.caps.triangles.len()];
        for (new, old) in (0..).zip(before).filter(|&(_, old)| old != NONE) {
            now[old as usize] = new;
        }
        now
    }

    /// What has to be divided anew.
    fn part_of(
        &self,
        input: &Input<'_>,
        caps: &CapSurface,
        disturbed: &[bool],
        changed: &Disturbance<'_>,
        others: &BTreeSet<u32>,
        ids: &[u32],
    ) -> Part {
        let again = || self.iter().filter(|c| disturbed[c.id().index()]);
        let is_off = |f: &FaceId| !input.features.is_convex(*f);
        let mut faces: Vec<FaceId> = again().flat_map(|c| c.faces).copied().collect();
        faces.extend(changed.turned);
        faces.retain(is_off);
        let skin = (0..).zip(&self.concavity_of_cap).filter(|(_, c)| **c == NONE).map(|(i, _)| i);
        let kept =
            again().flat_map(|c| c.caps).map(|c| c.index()).chain(skin).map(|i: usize| ids[i]);
        let rows = others.iter().filter(|f| **f as usize + 1 < caps.facet_starts.len());
        let new = rows.flat_map(|&f| caps.of_facet(FacetId(f)));
        let caps = each_once(kept.filter(|&id| id != NONE).chain(new));
        Part { faces: each_once(faces), caps }
    }

    /// Numbers all concavities, lids and caps, given which of those before are divided anew, into
    /// what.
    fn put_in_order(
        &self,
        input: &Input<'_>,
        caps: CapSurface,
        disturbed: &[bool],
        groups: Vec<Group>,
        ids: &[u32],
    ) -> Self {
        // As they are numbered when they are built.
        type Key = (u32, Option<[u32; 3]>);
        let key = |faces: &[FaceId], own: &mut dyn Iterator<Item = usize>| -> Key {
            faces.first().map_or_else(|| (NONE, first_of_caps(&caps, own)), |f| (f.0, None))
        };
        let kept = self.iter().filter(|c| !disturbed[c.id().index()]).map(|c| {
            let mut own = c.caps.iter().map(|cap| ids[cap.index()] as usize);
            (key(c.faces, &mut own), KeptOrMade::Kept(c.id().index()))
        });
        let made = groups.iter().enumerate().map(|(i, group)| {
            let mut own = group.lids.iter().flatten().map(|cap| cap.index());
            (key(&group.faces, &mut own), KeptOrMade::Made(i))
        });
        let mut order: Vec<(Key, KeptOrMade)> = kept.chain(made).collect();
        order.sort_unstable_by_key(|&(key, _)| key);
        let mut all = ConcavitySet::blank(self.concavity_of_face.clone(), caps);
        // Faces of disturbed concavities belong to none until they are assigned.
        for c in self.iter().filter(|c| disturbed[c.id().index()]) {
            c.faces.iter().for_each(|f| all.concavity_of_face[f.index()] = NONE);
        }
        let mut rims = Vec::new();
        for (id, (_, origin)) in order.iter().enumerate() {
            match origin {
                KeptOrMade::Kept(before) => {
                    let faces = self.get(ConcavityId(*before as u32)).faces;
                    if *before != id {
                        faces.iter().for_each(|f| all.concavity_of_face[f.index()] = id as u32);
                    }
                }
                KeptOrMade::Made(group) => groups[*group]
                    .faces
                    .iter()
                    .for_each(|f| all.concavity_of_face[f.index()] = id as u32),
            }
        }
        let made_faces = groups.iter().flat_map(|group| &group.faces);
        let sides = made_faces.flat_map(|&f| (0..3).map(move |c| HalfEdgeId::of(f, c)));
        for edge in each_once(sides.map(|h| input.topology.edge_of(h))) {
            input.rims_at(edge, &all.concavity_of_face, &mut rims);
        }
        rims.sort_unstable();
        for (id, (_, origin)) in (0..).map(ConcavityId).zip(&order) {
            let record = Record {
                first_face: all.faces.len() as u32,
                first_cap: all.cap_order.len() as u32,
                first_lid: all.lids.len() as u32,
                first_loop: all.loops.len() as u32,
                ..BLANK
            };
            all.records.push(record);
            match origin {
                KeptOrMade::Kept(before) => {
                    all.append(&self.get(ConcavityId(*before as u32)), id, ids);
                }
                KeptOrMade::Made(group) => {
                    let first = rims.partition_point(|&(c, _)| c < id.0);
                    let last = rims.partition_point(|&(c, _)| c <= id.0);
                    let rim = rims[first..last].iter().map(|&(_, ends)| ends).collect();
                    input.append(&mut all, id, &groups[*group], rim);
                }
            }
        }
        all
    }

    /// Appends a concavity that is as it was, but for the numbers of caps.
    fn append(&mut self, before: &Concavity<'_>, id: ConcavityId, ids: &[u32]) {
        let Concavity { all, id: old, faces, .. } = *before;
        let Some(record) = self.records.last_mut() else { return };
        record.measures = before.measures;
        self.faces.extend_from_slice(faces);
        let loops = all.records[old.index()].first_loop
            ..all.record_end(old, |r| r.first_loop, all.loops.len());
        let borders = self.loops.append(&all.loops, loops);
        self.borders.extend_from_slice(&all.borders[borders]);
        for lid in before.lids() {
            let at = lid.id.index();
            let outlines = all.lids[at].first_outline;
            let next = all.lids.get(at + 1).map_or(all.outlines.len() as u32, |l| l.first_outline);
            self.begin_lid(id, lid.area, lid.opening);
            for cap in lid.caps {
                self.add_cap(id, ids[cap.index()]);
            }
            self.outlines.append(&all.outlines, outlines..next);
            let facets = &all.outline_facets[outlines as usize..next as usize];
            self.outline_facets.extend_from_slice(facets);
        }
    }

    /// Appends the outlines of the last lid's caps, those of each facet by themselves.
    pub(super) fn trace_outlines(&mut self, caps: &[CapId]) {
        let facet = |cap: &CapId| self.caps.facet_of(*cap);
        for piece in caps.chunk_by(|a, b| facet(a) == facet(b)) {
            let triangles: Vec<[u32; 3]> =
                piece.iter().map(|cap| self.caps.triangles[cap.index()]).collect();
            for outline in outlines(&triangles) {
                self.outlines.push(&outline);
            }
            self.outline_facets.resize(self.outlines.len(), self.caps.facet_of(piece[0]));
        }
    }

    fn begin_lid(&mut self, concavity: ConcavityId, area: f64, opening: DVec3) {
        let first_cap = self.cap_order.len() as u32;
        let first_outline = self.outlines.len() as u32;
        self.lids.push(LidRecord { concavity, first_cap, first_outline, area, opening });
    }

    /// Adds a cap to the last lid.
    fn add_cap(&mut self, concavity: ConcavityId, cap: u32) {
        self.cap_order.push(CapId(cap));
        self.concavity_of_cap[cap as usize] = concavity.0;
        self.lid_of_cap[cap as usize] = self.lids.len() as u32 - 1;
    }
}

impl Input<'_> {
    /// Appends a concavity, whose boundary consists of the edges of `rim`.
    fn append(
        &self,
        all: &mut ConcavitySet,
        id: ConcavityId,
        group: &Group,
        mut rim: Vec<[u32; 2]>,
    ) {
        let mut measures = self.measures_of(&group.faces);
        all.faces.extend_from_slice(&group.faces);
        let first = all.loops.len();
        all.loops.split(&mut rim);
        self.find_borders(all, first);
        for caps in &group.lids {
            let (mut area, mut opening) = (0.0, DVec3::ZERO);
            for cap in caps {
                let corners = self.cap_triangle(&all.caps, cap.index());
                let vector = 0.5 * twice_area_vector(corners);
                area += vector.length();
                opening += vector;
                measures.cap_area += vector.length();
                measures.opening += vector;
                measures.pocket_volume += self.volume_below(corners);
            }
            if opening.length() <= CANCELLED * area {
                opening = DVec3::ZERO;
            }
            all.begin_lid(id, area, opening);
            caps.iter().for_each(|cap| all.add_cap(id, cap.0));
            all.trace_outlines(caps);
        }
        if let Some(record) = all.records.last_mut() {
            record.measures = measures;
        }
    }

    /// Updates what covers each facet: where nothing has changed, the same as before, renumbered.
    fn cover_again(
        &self,
        all: &mut ConcavitySet,
        before: &ConcavitySet,
        disturbed: &[bool],
        changed: &Disturbance<'_>,
        facets: usize,
    ) {
        // Caps of a concavity that was divided anew name another one, it may be.
        let mut stale: BTreeSet<u32> = changed.stale.iter().chain(changed.fresh).copied().collect();
        let mut numbers = vec![NONE; before.records.len()];
        for concavity in all.iter() {
            let first = concavity.faces.first();
            match first.and_then(|f| before.of_face(*f)).filter(|own| !disturbed[own.index()]) {
                Some(own) => numbers[own.index()] = concavity.id().0,
                None => stale.extend(concavity.caps.iter().map(|&cap| all.caps.facet_of(cap).0)),
            }
        }
        let bears_faces = self.facets_with_faces();
        all.cover.clone_from(&before.cover);
        all.cover.resize(facets, SOLID);
        for cover in all.cover.iter_mut().filter(|c| **c != SOLID && **c != MIXED) {
            *cover = numbers[*cover as usize];
        }
        for &facet in &stale {
            all.cover[facet as usize] = self.cover(all, FacetId(facet), &bears_faces);
        }
    }
}

/// The caps of a facet; none where there is no such facet.
fn row_of(caps: &CapSurface, facet: u32) -> &[[u32; 3]] {
    if facet as usize + 1 >= caps.facet_starts.len() {
        return &[];
    }
    let row = caps.of_facet(FacetId(facet));
    &caps.triangles[row.start as usize..row.end as usize]
}
