//! Whether two solids penetrate, or one holds the other, in exact rationals.
//!
//! Let A and B be closed, oriented, embedded meshes and also the closed solids that they bound. Two
//! surfaces may touch everywhere and cross nowhere, and yet the solids may be apart (two boxes that
//! share a face), penetrate (coincident boxes), or pass through each other exactly along edges. The
//! triangle pairs do not decide it. This does:
//!
//! 1. Cut each face of A along everything that it shares with faces of B: segments, and the rims of
//!    co-planar overlaps. Within a *cell*, the open 2-D pieces that remain, all points (but for
//!    isolated ones, where a corner of B stands on it) are alike: strictly inside B, strictly
//!    outside, or on faces of B that face the *same* or the *opposite* way. One rational sample
//!    each decides. Likewise for the faces of B.
//! 2. The open insides meet if and only if a cell of A lies inside B, or a cell of B inside A, or a
//!    cell of A lies on B facing the same way. *If*: next to each point of a cell lies A's inside,
//!    and there B's inside is on both sides, or on the same side. *Only if*: the intersection of
//!    the insides is open and bounded, so its boundary has 2-D pieces; each lies in a cell of A or
//!    of B, and has the intersection on one side, so it is one of the three.
//! 3. A lies in B if and only if no cell of A lies outside B or on it facing the opposite way, and
//!    no cell of B lies inside A. Then B's surface, which is 2-D at every point, does not enter A's
//!    inside, so each component of it is wholly in B or wholly out; out, a cell at its boundary
//!    would lie outside or face the opposite way.
//!
//! Faces that share nothing with the other surface need no cutting, and those that hang together
//! over common corners all lie on one side: one sample serves them all.

use std::collections::HashMap;

use cranny_exact::{DVec3, Meeting, Pose};
use cranny_geometry::Mesh;

use crate::convex::{HalfSpace, Polygon, Region, clipped};
use crate::locate::{Location, PosedMesh};
use crate::rational::{Q, Q3};
use crate::surface::overlapping_pairs;
use crate::triangle::contact;

/// One solid wholly inside the other; they may touch from inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contained {
    /// A lies in B.
    AInB,
    /// B lies in A.
    BInA,
    /// Each lies in the other: they are the same solid.
    Coincident,
}

/// What the rational oracle says of two posed meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OracleVerdict {
    /// The strongest meeting of any two faces.
    pub surface: Meeting,
    /// Whether the open insides meet. Where one mesh is not closed: whether its surface crosses the
    /// other's or enters its inside. Where neither is: whether the surfaces cross.
    pub solid: bool,
    /// Whether one lies in the other, touching allowed. The outer one must be closed; the inner one
    /// may be an open surface. `None` where surfaces cross.
    pub contained: Option<Contained>,
}

/// Judges two meshes at their poses, on the world vertices rounded to `f64`.
///
/// Meshes that are closed must be oriented outward and embedded.
#[must_use]
pub fn rational_verdict(
    mesh_a: &Mesh,
    pose_a: &Pose,
    mesh_b: &Mesh,
    pose_b: &Pose,
) -> OracleVerdict {
    let (a, b) = (PosedMesh::new(mesh_a, pose_a), PosedMesh::new(mesh_b, pose_b));
    let mut surface = Meeting::None;
    let mut shared_by_a = Shared::new();
    let mut shared_by_b = Shared::new();
    for (i, j) in overlapping_pairs(a.triangles(), b.triangles()) {
        let (meeting, polygon) = contact(&a.regions()[i], &b.regions()[j]);
        if meeting == Meeting::Cross {
            return OracleVerdict { surface: meeting, solid: true, contained: None };
        }
        if meeting == Meeting::Touch {
            surface = Meeting::Touch;
            shared_by_a.entry(i).or_default().push(polygon.clone());
            shared_by_b.entry(j).or_default().push(polygon);
        }
    }
    let (of_a, of_b) = (Sides::of(&a, &b, &shared_by_a), Sides::of(&b, &a, &shared_by_b));
    let a_in_b = b.is_closed() && of_a.all_within() && !(a.is_closed() && of_a.excludes(&of_b));
    let b_in_a = a.is_closed() && of_b.all_within() && !(b.is_closed() && of_b.excludes(&of_a));
    OracleVerdict {
        surface,
        solid: of_a.inside || of_b.inside || (of_a.same && a.is_closed() && b.is_closed()),
        contained: match (a_in_b, b_in_a) {
            (true, true) => Some(Contained::Coincident),
            (true, false) => Some(Contained::AInB),
            (false, true) => Some(Contained::BInA),
            (false, false) => None,
        },
    }
}

/// What each face shares with faces of the other mesh.
type Shared = HashMap<usize, Vec<Polygon>>;

/// On which sides of the other mesh some cell of a mesh was found.
#[derive(Clone, Copy, Debug, Default)]
struct Sides {
    inside: bool,
    outside: bool,
    same: bool,
    opposite: bool,
}

impl Sides {
    fn of(mesh: &PosedMesh, other: &PosedMesh, shared: &Shared) -> Self {
        let mut found = Self::default();
        for group in groups_apart(mesh, shared) {
            found.add(&mesh.regions()[group], &[mesh.regions()[group].corners.to_vec()], other);
        }
        for (&face, polygons) in shared {
            let region = &mesh.regions()[face];
            if region.has_area() {
                found.add(region, &cells(region, polygons), other);
            }
        }
        found
    }

    fn add(&mut self, face: &Region, cells: &[Polygon], other: &PosedMesh) {
        for cell in cells {
            match side_of_cell(cell, face, other) {
                Side::Inside => self.inside = true,
                Side::Outside => self.outside = true,
                Side::Same => self.same = true,
                Side::Opposite => self.opposite = true,
            }
        }
    }

    fn all_within(&self) -> bool {
        !self.outside
    }

    /// Whether this closed mesh cannot lie in the other, all of whose outside it avoids.
    fn excludes(&self, others: &Self) -> bool {
        self.opposite || others.inside
    }
}

enum Side {
    Inside,
    Outside,
    Same,
    Opposite,
}

/// Decided by a point of the open cell; another one where a corner of the other mesh stands on it.
fn side_of_cell(cell: &[Q3], face: &Region, other: &PosedMesh) -> Side {
    let mut stride = 0u32;
    loop {
        let weight = |i: usize| Q::from(1 + stride * i as u32);
        let weighted: Vec<(Q, &Q3)> =
            cell.iter().enumerate().map(|(i, p)| (weight(i), p)).collect();
        let sample = Q3::mean(&weighted);
        match other.locate(&sample) {
            Location::Inside => return Side::Inside,
            Location::Outside => return Side::Outside,
            Location::On => {}
        }
        let coplanar =
            |region: &&Region| region.has_area() && region.normal.cross(&face.normal).is_zero();
        if let Some(region) = other.faces_at(&sample).find(coplanar) {
            let alike = region.normal.dot(&face.normal) > Q::ZERO;
            return if alike { Side::Same } else { Side::Opposite };
        }
        stride += 1;
    }
}

/// The pieces into which a face falls when it is cut along what it shares with other faces. A cut
/// goes on straight through the pieces that it enters, so that they stay convex.
fn cells(face: &Region, shared: &[Polygon]) -> Vec<Polygon> {
    let mut pieces = vec![face.corners.to_vec()];
    for polygon in shared.iter().filter(|polygon| polygon.len() >= 2) {
        let edges = if polygon.len() == 2 { 1 } else { polygon.len() };
        for i in 0..edges {
            let (p, q) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
            let left = HalfSpace::at(p, face.normal.cross(&(q - p)));
            pieces = pieces
                .into_iter()
                .flat_map(|piece| {
                    if enters(p, q, &piece, &face.normal) {
                        vec![clipped(&piece, &left), clipped(&piece, &left.opposite())]
                    } else {
                        vec![piece]
                    }
                })
                .collect();
        }
    }
    pieces
}

/// Whether a segment in the plane of a convex polygon runs through its inside.
fn enters(p: &Q3, q: &Q3, polygon: &[Q3], normal: &Q3) -> bool {
    let rims: Vec<HalfSpace> = (0..polygon.len())
        .map(|i| {
            let (u, v) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
            HalfSpace::at(u, normal.cross(&(v - u)))
        })
        .collect();
    let inner = rims.iter().fold(vec![p.clone(), q.clone()], |rest, rim| clipped(&rest, rim));
    if inner.len() < 2 {
        return false;
    }
    let middle = Q3::mean(&inner.iter().map(|p| (Q::ONE, p)).collect::<Vec<_>>());
    rims.iter().all(|rim| rim.side(&middle).is_gt())
}

/// One face with area of each set of faces that share nothing with the other mesh and hang together
/// over common corners.
fn groups_apart(mesh: &PosedMesh, shared: &Shared) -> Vec<usize> {
    let apart: Vec<usize> =
        (0..mesh.triangles().len()).filter(|i| !shared.contains_key(i)).collect();
    let key = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut faces_at: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for &face in &apart {
        for p in mesh.triangles()[face] {
            faces_at.entry(key(p)).or_default().push(face);
        }
    }
    let mut reached = vec![false; mesh.triangles().len()];
    let mut representatives = Vec::new();
    for &first in &apart {
        let mut queue = if reached[first] { Vec::new() } else { vec![first] };
        let mut representative = None;
        while let Some(face) = queue.pop() {
            if std::mem::replace(&mut reached[face], true) {
                continue;
            }
            if mesh.regions()[face].has_area() {
                representative = representative.or(Some(face));
            }
            for p in mesh.triangles()[face] {
                queue.extend(faces_at[&key(p)].iter().filter(|&&next| !reached[next]));
            }
        }
        representatives.extend(representative);
    }
    representatives
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::{cuboid, inverted};

    /// The verdict, after checking that swapping A and B swaps it.
    fn verdict(a: &Mesh, b: &Mesh) -> (Meeting, bool, Option<Contained>) {
        let here = Pose::IDENTITY;
        let found = rational_verdict(a, &here, b, &here);
        let swapped = rational_verdict(b, &here, a, &here);
        let mirrored = swapped.contained.map(|contained| match contained {
            Contained::AInB => Contained::BInA,
            Contained::BInA => Contained::AInB,
            Contained::Coincident => Contained::Coincident,
        });
        assert_eq!(found, OracleVerdict { contained: mirrored, ..swapped });
        (found.surface, found.solid, found.contained)
    }

    fn unit() -> Mesh {
        cuboid([0.0; 3], [1.0; 3])
    }

    #[test]
    fn boxes_that_share_a_face_an_edge_or_a_corner_do_not_penetrate() {
        for offset in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 0.25, 0.5]] {
            let b = cuboid(offset, offset.map(|x| x + 1.0));
            assert_eq!(verdict(&unit(), &b), (Meeting::Touch, false, None));
        }
        let apart = cuboid([1.5, 0.0, 0.0], [2.0, 1.0, 1.0]);
        assert_eq!(verdict(&unit(), &apart), (Meeting::None, false, None));
    }

    #[test]
    fn coincident_boxes_penetrate_though_their_surfaces_only_touch() {
        assert_eq!(verdict(&unit(), &unit()), (Meeting::Touch, true, Some(Contained::Coincident)));
    }

    #[test]
    fn boxes_nested_from_inside_are_contained() {
        let outer = cuboid([0.0; 3], [4.0; 3]);
        for low in [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 3.0]] {
            let inner = cuboid(low, low.map(|x| x + 1.0));
            assert_eq!(verdict(&inner, &outer), (Meeting::Touch, true, Some(Contained::AInB)));
        }
        let floating = cuboid([1.0; 3], [2.0; 3]);
        assert_eq!(verdict(&floating, &outer), (Meeting::None, true, Some(Contained::AInB)));
    }

    #[test]
    fn boxes_that_overlap_crosswise_or_flush_penetrate() {
        let crossing = cuboid([0.5, 0.25, 0.25], [1.5, 0.75, 0.75]);
        assert_eq!(verdict(&unit(), &crossing), (Meeting::Cross, true, None));
        // Flush on all sides but the ends: faces only touch in the flush planes, but ends cross.
        let flush = cuboid([0.5, 0.0, 0.0], [1.5, 1.0, 1.0]);
        let (surface, solid, contained) = verdict(&unit(), &flush);
        assert_eq!((surface, solid, contained), (Meeting::Touch, true, None));
    }

    #[test]
    fn a_solid_in_a_void_is_not_contained_and_filling_it_does_not_penetrate() {
        let shell = cuboid([0.0; 3], [4.0; 3]).joined(&inverted(&cuboid([1.0; 3], [3.0; 3])));
        let small = cuboid([1.5; 3], [2.5; 3]);
        assert_eq!(verdict(&small, &shell), (Meeting::None, false, None));
        let filling = cuboid([1.0; 3], [3.0; 3]);
        assert_eq!(verdict(&filling, &shell), (Meeting::Touch, false, None));
        let around = cuboid([-1.0; 3], [5.0; 3]);
        assert_eq!(verdict(&shell, &around), (Meeting::None, true, Some(Contained::AInB)));
        // The full cube holds the hollow one, though they share their outer surface.
        let full = cuboid([0.0; 3], [4.0; 3]);
        assert_eq!(verdict(&shell, &full), (Meeting::Touch, true, Some(Contained::AInB)));
    }

    #[test]
    fn open_surfaces_count_where_they_enter_a_solid() {
        let sheet = |z: f64, size: f64| {
            let corners = [[0.0, 0.0, z], [size, 0.0, z], [0.0, size, z]].map(DVec3::from_array);
            Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap()
        };
        let outer = cuboid([-1.0; 3], [4.0; 3]);
        assert!(verdict(&sheet(0.0, 1.0), &outer).1);
        assert_eq!(
            verdict(&sheet(4.0, 1.0), &outer),
            (Meeting::Touch, false, Some(Contained::AInB))
        );
        assert_eq!(verdict(&sheet(5.0, 1.0), &outer), (Meeting::None, false, None));
        assert_eq!(verdict(&sheet(0.0, 1.0), &sheet(0.0, 1.0)), (Meeting::Touch, false, None));
    }
}
