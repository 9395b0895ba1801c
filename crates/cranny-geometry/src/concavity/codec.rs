//! Concavities as bytes: the faces and caps of each, and what was measured. Whose each face and cap is,
//! follows from that.

use cranny_exact::DVec3;
use cranny_exact::domain::MAX_COORDINATE;

use super::{Border, Concavities, ConcavityKind, LidRecord, MIXED, Measures, Record, SOLID, Skin};
use crate::boundary::Loops;
use crate::caps::CapSurface;
use crate::codec::{
    Coded, Flaw, Reader, Writer, check, check_below, coded, owners_of_rows, plain_struct,
};
use crate::features::{Features, NONE};
use crate::hull::{ConvexHull, FacetId};
use crate::ids::{CapId, ConcavityId, FaceId};
use crate::mesh::Mesh;

coded!(ConcavityKind {
    Self::Pocket => 0 => Self::Pocket,
    Self::Passage => 1 => Self::Passage,
    Self::Void => 2 => Self::Void,
    Self::Island => 3 => Self::Island,
    Self::Opening => 4 => Self::Opening,
    Self::Overlay => 5 => Self::Overlay,
});
coded!(Border {
    Self::Convex => 0 => Self::Convex,
    Self::Ridge => 1 => Self::Ridge,
    Self::Open => 2 => Self::Open,
});
plain_struct!(Skin { volume: f64, area: f64, caps: u32 });
plain_struct!(Measures { cap_area: f64, face_area: f64, pocket_volume: f64, opening: DVec3 });

/// What is written of a concavity.
#[derive(Clone, Copy)]
struct Head {
    kind: u8,
    parent: u32,
    first_face: u32,
    first_loop: u32,
    measures: Measures,
}
plain_struct!(Head { kind: u8, parent: u32, first_face: u32, first_loop: u32, measures: Measures });

/// What is written of a lid.
#[derive(Clone, Copy)]
struct LidHead {
    concavity: ConcavityId,
    first_cap: u32,
    first_outline: u32,
    area: f64,
    opening: DVec3,
}
plain_struct!(LidHead {
    concavity: ConcavityId,
    first_cap: u32,
    first_outline: u32,
    area: f64,
    opening: DVec3,
});

/// No area vector of a lid is longer: 2^31 triangles of the largest box. Envelopes are made from these when they
/// are asked for, and products of larger ones would overflow.
const LARGEST_OPENING: f64 = MAX_COORDINATE * MAX_COORDINATE * (1u64 << 35) as f64;

impl Record {
    fn head(&self) -> Head {
        let &Self { kind, parent, first_face, first_cap: _, first_lid: _, first_loop, measures } =
            self;
        Head { kind: kind.code(), parent, first_face, first_loop, measures }
    }
}

impl LidRecord {
    fn head(&self) -> LidHead {
        let &Self { concavity, first_cap, first_outline, area, opening } = self;
        LidHead { concavity, first_cap, first_outline, area, opening }
    }
}

impl Concavities {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self {
            records,
            faces,
            concavity_of_face: _,
            caps,
            cap_order,
            concavity_of_cap: _,
            lid_of_cap: _,
            lids,
            loops,
            borders,
            outlines,
            outline_facets,
            cover,
            skin,
        } = self;
        out.items(records.len(), records.iter().map(Record::head));
        out.items(lids.len(), lids.iter().map(LidRecord::head));
        out.list(faces);
        caps.encode(out);
        out.list(cap_order);
        loops.encode(out);
        out.codes(borders);
        outlines.encode(out);
        out.list(outline_facets);
        out.list(cover);
        out.one(*skin);
    }

    /// Reads the concavities of a mesh.
    pub(crate) fn decode(
        input: &mut Reader,
        mesh: &Mesh,
        hull: &ConvexHull,
        features: &Features,
    ) -> Result<Self, Flaw> {
        let (vertices, facets) = (mesh.vertices().len(), hull.facet_count());
        let (heads, lid_heads): (Vec<Head>, Vec<LidHead>) = (input.list()?, input.list()?);
        let faces: Vec<u32> = input.list()?;
        let caps = CapSurface::decode(input, vertices, facets)?;
        let cap_order: Vec<u32> = input.list()?;
        let loops = Loops::decode(input, vertices)?;
        let borders: Vec<Border> = input.codes()?;
        let outlines = Loops::decode(input, vertices)?;
        let (outline_facets, cover): (Vec<FacetId>, Vec<u32>) = (input.list()?, input.list()?);
        let skin: Skin = input.one()?;

        let starts = starts_of(heads.iter().map(|head| head.first_face), &faces);
        let concavity_of_face = owners_of_rows(&starts, heads.len(), &faces, mesh.faces().len())?;
        let is_one = |(facet, owner): (&u32, &u32)| (*facet == NONE) != (*owner == NONE);
        let facets_of_faces = features.facets_of_faces().iter();
        check(
            facets_of_faces.zip(&concavity_of_face).fold(true, |all, own| all & is_one(own)),
            "a face is neither convex nor of a concavity, or both",
        )?;
        let starts = starts_of(lid_heads.iter().map(|lid| lid.first_cap), &cap_order);
        let lid_of_cap =
            owners_of_rows(&starts, lid_heads.len(), &cap_order, caps.triangles.len())?;
        check(borders.len() == loops.vertices.len(), "a border for each edge is needed")?;
        check(outline_facets.len() == outlines.len(), "a facet for each outline is needed")?;
        check_below(outline_facets.iter().map(|f| f.0), facets, "an outline's facet is not there")?;
        check(cover.len() == facets, "what covers each facet is needed")?;
        let covering = cover.iter().copied().filter(|&c| c != SOLID && c != MIXED);
        check_below(covering, heads.len(), "a facet is covered by what is not there")?;

        let mut records = records_of(&heads, loops.len())?;
        let lids = lids_of(&lid_heads, records.len(), outlines.len())?;
        for (i, record) in records.iter_mut().enumerate() {
            let lid = lids.partition_point(|l| l.concavity.index() < i);
            record.first_lid = lid as u32;
            record.first_cap = lids.get(lid).map_or(cap_order.len() as u32, |l| l.first_cap);
        }
        let concavity_of_cap = lid_of_cap
            .iter()
            .map(|&lid| lids.get(lid as usize).map_or(NONE, |lid| lid.concavity.0))
            .collect();
        let skin_caps = lid_of_cap.iter().filter(|&&lid| lid == NONE).count();
        check(skin.caps as usize == skin_caps, "caps of skin are miscounted")?;
        check(skin.volume.is_finite() && skin.area.is_finite(), "the skin has no size")?;
        Ok(Self {
            records,
            faces: faces.into_iter().map(FaceId).collect(),
            concavity_of_face,
            caps,
            cap_order: cap_order.into_iter().map(CapId).collect(),
            concavity_of_cap,
            lid_of_cap,
            lids,
            loops,
            borders,
            outlines,
            outline_facets,
            cover,
            skin,
        })
    }
}

/// Where rows begin, and the last one ends.
fn starts_of(firsts: impl Iterator<Item = u32>, members: &[u32]) -> Vec<u32> {
    firsts.chain([members.len() as u32]).collect()
}

fn records_of(heads: &[Head], loops: usize) -> Result<Vec<Record>, Flaw> {
    check(heads.is_sorted_by_key(|h| h.first_loop), "loops are not in order")?;
    check(heads.first().map_or(loops, |h| h.first_loop as usize) == 0, "a loop is of nobody")?;
    check(heads.last().is_none_or(|h| h.first_loop as usize <= loops), "a loop is not there")?;
    let record = |&Head { kind, parent, first_face, first_loop, measures }: &Head| {
        let kind = ConcavityKind::of_code(kind).ok_or("a concavity is of no known kind")?;
        let Measures { cap_area, face_area, pocket_volume, opening } = measures;
        let is_measured = [cap_area, face_area, pocket_volume].iter().all(|x| x.is_finite())
            && opening.is_finite();
        check(is_measured, "a concavity has no size")?;
        Ok(Record { kind, parent, first_face, first_cap: 0, first_lid: 0, first_loop, measures })
    };
    let records = heads.iter().map(record).collect::<Result<Vec<_>, Flaw>>()?;
    check_parents(&records)?;
    Ok(records)
}

/// Nobody is among his own ancestors: each walk ends, at someone without a parent or on the path of an
/// earlier walk. O(n).
fn check_parents(records: &[Record]) -> Result<(), Flaw> {
    const UNSEEN: u32 = u32::MAX;
    let mut walk_of = vec![UNSEEN; records.len()];
    for walk in 0..records.len() as u32 {
        let mut at = walk;
        while at != NONE {
            let seen = walk_of.get_mut(at as usize).ok_or("a parent is not there")?;
            if *seen != UNSEEN {
                check(*seen != walk, "a concavity is its own ancestor")?;
                break;
            }
            *seen = walk;
            at = records[at as usize].parent;
        }
    }
    Ok(())
}

fn lids_of(heads: &[LidHead], records: usize, outlines: usize) -> Result<Vec<LidRecord>, Flaw> {
    check_below(heads.iter().map(|l| l.concavity.0), records, "a lid's concavity is not there")?;
    check(heads.is_sorted_by_key(|l| l.concavity), "lids are not in order")?;
    check(heads.is_sorted_by_key(|l| l.first_outline), "outlines are not in order")?;
    let first = heads.first().map_or(outlines, |l| l.first_outline as usize);
    check(first == 0, "an outline is of no lid")?;
    check(heads.last().is_none_or(|l| l.first_outline as usize <= outlines), "lids lack outlines")?;
    let is_measured = |l: &LidHead| {
        l.area.is_finite() && l.opening.to_array().iter().all(|x| x.abs() <= LARGEST_OPENING)
    };
    check(heads.iter().all(is_measured), "a lid has no size")?;
    let lid = |&LidHead { concavity, first_cap, first_outline, area, opening }: &LidHead| {
        LidRecord { concavity, first_cap, first_outline, area, opening }
    };
    Ok(heads.iter().map(lid).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nested(parents: &[u32]) -> bool {
        let record = |&parent: &u32| Record {
            kind: ConcavityKind::Void,
            parent,
            first_face: 0,
            first_cap: 0,
            first_lid: 0,
            first_loop: 0,
            measures: Measures::default(),
        };
        check_parents(&parents.iter().map(record).collect::<Vec<_>>()).is_ok()
    }

    #[test]
    fn ancestors_end() {
        assert!(
            nested(&[]) && nested(&[NONE]) && nested(&[1, 2, NONE, 2]) && nested(&[NONE, 0, 1])
        );
        assert!(!nested(&[0]) && !nested(&[1, 0]) && !nested(&[NONE, 2, 3, 1]));
        assert!(!nested(&[7]));
    }
}
