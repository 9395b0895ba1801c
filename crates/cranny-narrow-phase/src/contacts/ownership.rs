//! From which face a vertex or an edge is looked at, so that each is looked at once for each face of the other
//! patch: the first face of the lowest patch at it. A matter of the model alone, so it is kept.

use std::cell::Cell;

use cranny_geometry::FaceId;

use crate::pair::{Pair, Side};

/// Set where a face was asked about.
const KNOWN: u8 = 1 << 7;

/// What the faces of one body own, found when it is first asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Ownership {
    /// A face each: its corners in the lowest three bits, its sides in the next three.
    faces: Vec<Cell<u8>>,
}

/// What is looked at from a face: corners, and sides from a corner to the next, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owned {
    pub(super) corners: u8,
    pub(super) sides: u8,
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
            let Owned { corners, sides } = Owned::find(pair, side, face);
            slot.set(KNOWN | corners | sides << 3);
        }
        Owned { corners: slot.get() & 0b111, sides: slot.get() >> 3 & 0b111 }
    }

    pub(super) fn bytes(&self) -> usize {
        self.faces.capacity()
    }
}

impl Owned {
    fn find(pair: &Pair, side: Side, face: FaceId) -> Self {
        let (patches, topology) = (pair.model(side).patches(), pair.topology(side));
        let key = |f: FaceId| (patches.patch_of_face(f), f);
        let own = key(face);
        let mut owned = Self { corners: 0, sides: 0 };
        for i in 0..3 {
            let around = topology.faces_at(pair.corner(side, face, i));
            owned.corners |= u8::from(around.iter().all(|&f| key(f) >= own)) << i;
            let along = topology.half_edges(pair.edge(side, face, i));
            owned.sides |= u8::from(along.iter().all(|h| key(h.face()) >= own)) << i;
        }
        owned
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::PosedVertices;
    use crate::query::Placed;
    use cranny_exact::{DVec3, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cup, Shape};

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
        assert_eq!(ownership.bytes(), model.mesh().faces().len());
    }
}
