//! From which face a vertex or an edge is looked at, so that each is looked at once for each face of the other
//! patch: the first face of the lowest patch at it. A matter of the model alone, so it is kept.

use std::cell::Cell;

use cranny_geometry::{FaceId, HalfEdgeId, Mesh};

use super::facing::WEDGE_SLACK;
use crate::pair::{Pair, Side};

/// Set where a face was asked about.
const KNOWN: u16 = 1 << 15;

/// Sine of the angle by which an edge must be bent inwards to make no contacts for certain: what leads out of the
/// solid there runs into one of its faces. Smaller than [`WEDGE_SLACK`], and contacts that it lets pass are lost; larger, and
/// edges of finely divided hollows are looked at in vain.
const REFLEX: f64 = 1e3 * WEDGE_SLACK;

/// What the faces of one body own, found when it is first asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Ownership {
    /// A face each: its corners in the lowest three bits, its sides in the next three, its ridges in the three after.
    faces: Vec<Cell<u16>>,
}

/// What is looked at from a face: corners, and sides from a corner to the next, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owned {
    pub(super) corners: u8,
    pub(super) sides: u8,
    /// Those of the sides that may cross an edge: neither lines drawn on a plane nor bent inwards.
    pub(super) ridges: u8,
}

impl Ownership {
    /// Makes room for the faces of a body.
    pub(super) fn reserve(&mut self, pair: &Pair, side: Side) {
        let count = pair.mesh(side).faces().len();
        if self.faces.len() != count {
            self.faces = vec![Cell::new(0); count];
        }
    }

    /// What a face of the body owns, for which room was made.
    #[inline]
    pub(super) fn of(&self, pair: &Pair, side: Side, face: FaceId) -> Owned {
        let slot = &self.faces[face.index()];
        if slot.get() & KNOWN == 0 {
            let Owned { corners, sides, ridges } = Owned::find(pair, side, face);
            let [corners, sides, ridges] = [corners, sides, ridges].map(u16::from);
            slot.set(KNOWN | corners | sides << 3 | ridges << 6);
        }
        let bits = |from: u32| (slot.get() >> from & 0b111) as u8;
        Owned { corners: bits(0), sides: bits(3), ridges: bits(6) }
    }

    pub(super) fn bytes(&self) -> usize {
        self.faces.capacity() * size_of::<Cell<u16>>()
    }
}

impl Owned {
    pub(super) const NOTHING: Self = Self { corners: 0, sides: 0, ridges: 0 };

    fn find(pair: &Pair, side: Side, face: FaceId) -> Self {
        let (patches, topology) = (pair.model(side).patches(), pair.topology(side));
        let key = |f: FaceId| (patches.patch_of_face(f), f);
        let own = key(face);
        let mut owned = Self::NOTHING;
        for i in 0..3 {
            let around = topology.faces_at(pair.corner(side, face, i));
            owned.corners |= u8::from(around.iter().all(|&f| key(f) >= own)) << i;
            let along = topology.half_edges(pair.edge(side, face, i));
            let is_owned = along.iter().all(|h| key(h.face()) >= own);
            owned.sides |= u8::from(is_owned) << i;
            owned.ridges |= u8::from(is_owned && may_be_ridge(pair.mesh(side), along)) << i;
        }
        owned
    }
}

/// Whether the edge of these half-edges may cross another body's and make a contact.
pub(super) fn may_be_ridge(mesh: &Mesh, around: &[HalfEdgeId]) -> bool {
    let [h, g] = around else { return true };
    // Of faces that contradict each other, the normals say nothing of which way the edge is bent.
    let start = |h: &HalfEdgeId| mesh.faces()[h.face().index()][h.corner()];
    if start(h) == start(g) {
        return true;
    }
    let [n, m] = [h, g].map(|h| mesh.area_vector(h.face()).normalize_or_zero());
    let ends = mesh.triangle(h.face());
    let along = (ends[(h.corner() + 1) % 3] - ends[h.corner()]).normalize_or_zero();
    let bend = n.cross(m);
    // Half the slack: in the pair's frame, rounding has the angle a little larger or smaller.
    let is_flat = n.dot(m) > 0.0 && bend.length() < 0.5 * WEDGE_SLACK;
    !is_flat && bend.dot(along) >= -REFLEX
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::PosedVertices;
    use crate::query::Placed;
    use cranny_exact::{DVec3, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::{Cuboid, Cup, LPrism, Shape};

    fn ridges(model: &Model) -> u32 {
        let at = |x| Placed { model, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
        let mut posed = PosedVertices::default();
        let pair = Pair::new(at(0.0), at(9.0), &mut posed);
        let mut ownership = Ownership::default();
        ownership.reserve(&pair, Side::First);
        let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
        faces.map(|f| ownership.of(&pair, Side::First, f).ridges.count_ones()).sum()
    }

    /// Of an L there are 18 edges between its 8 sides, one of them bent inwards; its faces' other edges are drawn on planes.
    #[test]
    fn ridges_are_sharp_and_bent_outwards() {
        let mesh = Shape::from(LPrism::default()).build().unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        assert_eq!(ridges(&model), 17);
        assert!(model.topology().edges().len() > 18);
    }

    #[test]
    fn edges_of_faces_that_contradict_each_other_are_ridges() {
        let cube = Shape::from(Cuboid::default()).build().unwrap();
        // Whichever of two faces comes first.
        for turned in 0..cube.faces().len() {
            let mut faces = cube.faces().to_vec();
            faces[turned].swap(0, 1);
            let mesh = Mesh::new(cube.vertices().to_vec(), faces).unwrap();
            let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
            // The cube's own, and the diagonal beside the face that was turned.
            assert_eq!(ridges(&model), 13, "face {turned} turned");
        }
    }

    #[test]
    fn every_vertex_and_every_edge_has_one_owner() {
        let mesh = Shape::from(Cup { segments: 9, ..Cup::default() }).build().unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let at = |x| Placed { model: &model, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
        let mut posed = PosedVertices::default();
        let pair = Pair::new(at(0.0), at(3.0), &mut posed);
        let (side, mut ownership) = (Side::Second, Ownership::default());
        ownership.reserve(&pair, side);
        let mut owners =
            [vec![0; model.mesh().vertices().len()], vec![0; model.topology().edges().len()]];
        for face in (0..model.mesh().faces().len() as u32).map(FaceId) {
            let owned = ownership.of(&pair, side, face);
            assert_eq!(owned, ownership.of(&pair, side, face));
            for i in 0..3 {
                owners[0][pair.corner(side, face, i).index()] += owned.corners >> i & 1;
                owners[1][pair.edge(side, face, i).index()] += owned.sides >> i & 1;
            }
        }
        assert!(owners.iter().flatten().all(|&n| n == 1));
        assert_eq!(ownership.bytes(), 2 * model.mesh().faces().len());
    }
}
