//! Eight of a kind side by side, as the narrow phase compares them.

use crate::ids::{EdgeId, FaceId, PatchId, VertexId};
use cranny_exact::DVec3;

/// How many stand side by side.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Lanes(pub [f32; LANES]);

/// Eight vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes3 {
    /// Their first coordinates.
    pub x: Lanes,
    /// Their second coordinates.
    pub y: Lanes,
    /// Their third coordinates.
    pub z: Lanes,
}

impl Lanes {
    /// The same number eight times.
    #[must_use]
    pub const fn all(x: f32) -> Self {
        Self([x; LANES])
    }

    /// Rounded to nearest; `rest` fills what is left.
    pub(super) fn of(numbers: impl Iterator<Item = f64>, rest: f32) -> Self {
        let mut lanes = [rest; LANES];
        for (lane, x) in lanes.iter_mut().zip(numbers) {
            *lane = x as f32;
        }
        Self(lanes)
    }
}

impl Lanes3 {
    /// Rounded to nearest; what is left is zero.
    pub(super) fn of(vectors: impl Iterator<Item = DVec3>) -> Self {
        let mut lanes = Self { x: Lanes::all(0.0), y: Lanes::all(0.0), z: Lanes::all(0.0) };
        for (lane, v) in vectors.enumerate() {
            lanes.set(lane, v.to_array().map(|x| x as f32));
        }
        lanes
    }

    /// One of the vectors.
    #[must_use]
    #[inline]
    pub fn get(&self, lane: usize) -> [f32; 3] {
        [self.x.0[lane], self.y.0[lane], self.z.0[lane]]
    }

    /// Sets one of the vectors.
    #[inline]
    pub fn set(&mut self, lane: usize, [x, y, z]: [f32; 3]) {
        (self.x.0[lane], self.y.0[lane], self.z.0[lane]) = (x, y, z);
    }
}

/// Faces of a cluster.
#[derive(Clone, Debug)]
pub struct FaceLanes {
    /// Their names; beyond [`count`](Self::count) the first again.
    pub ids: [FaceId; LANES],
    /// The patches that they count to.
    pub patches: [PatchId; LANES],
    /// How many there are, at least 1.
    pub count: u32,
    /// For each side a bit for each face at which a vertex can touch that side or an end of it:
    /// what counts to the face.
    pub rims: [u32; 3],
    /// Unit, or zero without area.
    pub normal: Lanes3,
    /// How far their corners reach along the normal.
    pub top: Lanes,
    /// And least.
    pub bottom: Lanes,
    /// Across each side, outward: unit, or zero.
    pub sides: [Lanes3; 3],
    /// How far the corners reach along these.
    pub ends: [Lanes; 3],
    /// Their corners.
    pub corners: [Lanes3; 3],
}

impl FaceLanes {
    /// The bits of the lanes that hold a face.
    #[must_use]
    #[inline]
    pub fn mask(&self) -> u32 {
        (1 << self.count) - 1
    }
}

/// Vertices that are looked at from a cluster.
#[derive(Clone, Debug)]
pub struct CornerLanes {
    /// Their names; beyond [`count`](Self::count) the first again.
    pub ids: [VertexId; LANES],
    /// The patches that they count to.
    pub patches: [PatchId; LANES],
    /// How many there are, at least 1.
    pub count: u32,
    /// A bit for each vertex that all edges at it fall away from along some direction: it can touch
    /// a rim.
    pub tips: u32,
    /// Where they are.
    pub points: Lanes3,
}

/// Edges that are looked at from a cluster.
#[derive(Clone, Debug)]
pub struct RidgeLanes {
    /// Their names; beyond [`count`](Self::count) the first again.
    pub ids: [EdgeId; LANES],
    /// The patches that they count to.
    pub patches: [PatchId; LANES],
    /// How many there are, at least 1.
    pub count: u32,
    /// Their lesser vertices.
    pub starts: Lanes3,
    /// From there to the greater ones.
    pub spans: Lanes3,
    /// Squares of their lengths.
    pub squares: Lanes,
    /// Unit along the spans. Zero, as the next two, where the faces say nothing.
    pub along: Lanes3,
    /// For one face, from the edge into it, crossed with `along`: unit, against the face's normal
    /// or along it.
    pub left: Lanes3,
    /// The same for the other face.
    pub right: Lanes3,
    /// How far an error of a point turns these, per length; infinite where they say nothing.
    pub blur: Lanes,
}
