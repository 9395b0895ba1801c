//! Parts of a surface that are seen from one side without overlap: they do not meet themselves.
//!
//! Let some faces all be turned towards one direction. Seen along it, the faces over a point of the
//! plane are as many as their rims wind around it (the rims of two faces that share a side cancel
//! there). So if the rim of them all, seen so, is simple closed polygons, of which one runs around
//! the others, there is one face over each point within and none elsewhere. Then the faces lie side
//! by side: seen so, hence in space, two of them share what they have in common by right and
//! nothing more. A vertex or a side within the rim is covered all around by its own faces, and the
//! rim touches itself nowhere, so faces do not even touch elsewhere. That normals alone do not
//! suffice, and the rim must be looked at, was seen by Volino and Magnenat-Thalmann ('Efficient
//! self-collision detection on smoothly discretized surface animations using geometrical shape
//! regularity', 1994).
//!
//! All this is proved with the rounding errors bounded, or not at all: a node of the face tree that
//! is not called clear is searched, part by part.
//!
//! Cost: O(n) to prepare; all looks together turn over at most [`LOOKS_A_FACE`] faces for each face
//! of the mesh, and a rim of r sides takes O(r log r), as a rule, and the pairs that `outline`
//! allows.

use std::ops::Range;

use cranny_exact::{DVec2, DVec3};

use super::outline::Outline;
use super::turns::Turn;
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::tree::FaceTree;

/// Nodes of fewer faces are not looked at: judging their pairs is as quick.
const LEAST_FACES: usize = 12;

/// How often each face is looked at, on average over the mesh, before the rest is searched as it
/// is: a tree may be as deep as it has leaves. Sound meshes need a dozen or two.
const LOOKS_A_FACE: usize = 64;

/// How many faces lie between two sums that are kept. Fewer, and sums fill memory; more, and more
/// is added up anew for each node.
const STEP: usize = 8;

fn sum_of(turns: &[Turn], faces: &[FaceId]) -> DVec3 {
    faces.iter().map(|face| turns[face.index()].normal).sum()
}

/// What is needed to look at the nodes of a tree.
pub(super) struct Views<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    tree: &'a FaceTree,
    /// Of each face.
    turns: &'a [Turn],
    /// Sums of the normals of the faces before each [`STEP`]th, in leaf order.
    sums: Vec<DVec3>,
    /// Where each face stands in leaf order.
    places: Vec<u32>,
    looks_left: usize,
    rim: Vec<[VertexId; 2]>,
    outline: Outline,
}

impl<'a> Views<'a> {
    /// With the turns of all faces by their numbers. O(n).
    pub(super) fn of(
        mesh: &'a Mesh,
        topology: &'a Topology,
        tree: &'a FaceTree,
        turns: &'a [Turn],
    ) -> Self {
        let mut sum = DVec3::ZERO;
        let sums = tree.faces().chunks(STEP).map(|faces| {
            let before = sum;
            sum += sum_of(turns, faces);
            before
        });
        let sums = sums.collect();
        let mut places = vec![0; mesh.faces().len()];
        for (place, face) in tree.faces().iter().enumerate() {
            places[face.index()] = place as u32;
        }
        Self {
            mesh,
            topology,
            tree,
            looks_left: LOOKS_A_FACE * turns.len(),
            turns,
            sums,
            places,
            rim: Vec::new(),
            outline: Outline::new(mesh.vertices().len()),
        }
    }

    /// Whether the faces beneath a node are known to lie side by side, as seen along some
    /// direction. O(k), and O(r log r) for a rim of r sides where k faces are turned towards one
    /// direction.
    pub(super) fn is_clear(&mut self, node: u32) -> bool {
        let (_, faces) = self.tree.beneath(node);
        let count = faces.len();
        if count < LEAST_FACES || self.looks_left < count {
            return false;
        }
        let towards = self.sum_before(faces.end) - self.sum_before(faces.start);
        let axis = towards.abs().max_position();
        // The greatest component is 1 or −1, exactly. A sum of zero gives no number, which nothing
        // looks at.
        let towards = towards / towards[axis].abs();
        let turned_away = |face: &FaceId| !self.turns[face.index()].looks_towards(towards);
        let seen = self.tree.faces()[faces.clone()].iter().position(turned_away);
        self.looks_left -= seen.unwrap_or(count);
        seen.is_none() && self.has_simple_rim(node, faces, towards, axis)
    }

    /// The sum of the normals of the faces before a place in leaf order.
    fn sum_before(&self, place: usize) -> DVec3 {
        let whole = (place / STEP).min(self.sums.len() - 1);
        self.sums[whole] + sum_of(self.turns, &self.tree.faces()[whole * STEP..place])
    }

    fn has_simple_rim(
        &mut self,
        node: u32,
        faces: Range<usize>,
        towards: DVec3,
        axis: usize,
    ) -> bool {
        let Self { mesh, topology, tree, places, rim, outline, .. } = self;
        let within = |h: HalfEdgeId| faces.contains(&(places[h.face().index()] as usize));
        rim.clear();
        for &face in &tree.faces()[faces.clone()] {
            let corners = mesh.corners(face);
            for corner in 0..3 {
                if !topology.twin(HalfEdgeId::of(face, corner)).is_some_and(within) {
                    rim.push([corners[corner], corners[(corner + 1) % 3]]);
                }
            }
        }
        let bounds = tree.node(node).bounds;
        let (middle, [across, up]) = (bounds.center(), [(axis + 1) % 3, (axis + 2) % 3]);
        // A shear along `towards`: all points of a line that runs so are seen in one place.
        let slope = DVec2::new(towards[across], towards[up]) * towards[axis];
        let seen = |v: VertexId| {
            let p = mesh.position(v) - middle;
            let seen = DVec2::new(p[across], p[up]) - slope * p[axis];
            // From the front, where faces are counter-clockwise.
            DVec2::new(towards[axis] * seen.x, seen.y)
        };
        let size = (bounds.max - bounds.min).max_element();
        outline.is_simple(rim, seen, size, faces.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns_of(mesh: &Mesh) -> Vec<Turn> {
        (0..mesh.faces().len() as u32).map(|f| Turn::of(&mesh.triangle(FaceId(f)))).collect()
    }

    /// Rows of points, each joined to the next by squares.
    fn sheet(rows: &[Vec<DVec3>]) -> Mesh {
        let n = rows[0].len() as u32;
        let squares = (0..rows.len() as u32 - 1).flat_map(|r| (0..n - 1).map(move |i| r * n + i));
        let faces = squares.flat_map(|i| [[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]).collect();
        Mesh::new(rows.concat(), faces).unwrap()
    }

    /// Around the square of side 2 about the origin in 16 steps.
    fn around(step: u32) -> DVec3 {
        let along = f64::from(step % 4) / 2.0 - 1.0;
        let side = [[1.0, along], [-along, 1.0], [-1.0, -along], [along, -1.0]];
        let [x, y] = side[(step / 4 % 4) as usize];
        DVec3::new(x, y, 0.0)
    }

    /// A ramp around the z-axis.
    fn ramp(steps: u32, rise: f64) -> Mesh {
        let row = |r: f64| {
            (0..=steps).map(|s| r * around(s) + f64::from(s) * rise * DVec3::Z).collect::<Vec<_>>()
        };
        sheet(&[row(3.0), row(2.0), row(1.0)])
    }

    /// A flat square with some of its cells cut out.
    fn plate(side: u32, height: f64, holes: &[u32]) -> Mesh {
        let middle = f64::from(side) / 2.0;
        let row = |y: u32| {
            (0..=side)
                .map(|x| DVec3::new(f64::from(x) - middle, f64::from(y) - middle, height))
                .collect::<Vec<_>>()
        };
        let all = sheet(&(0..=side).map(row).collect::<Vec<_>>());
        let kept = (0u32..).zip(all.faces()).filter(|(f, _)| !holes.contains(&(f / 2)));
        Mesh::new(all.vertices().to_vec(), kept.map(|(_, &f)| f).collect()).unwrap()
    }

    /// Whether the whole mesh is clear, which must be the same from behind and along every axis.
    fn is_clear(mesh: &Mesh) -> bool {
        let known = |mesh: &Mesh| {
            let (topology, tree) = (Topology::of(mesh), FaceTree::of(mesh, 1));
            let turns = turns_of(mesh);
            Views::of(mesh, &topology, &tree, &turns).is_clear(0)
        };
        let clear = known(mesh);
        for axis in 0..3 {
            let turned = |p: &DVec3| DVec3::new(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
            let vertices = mesh.vertices().iter().map(turned).collect();
            let turned = Mesh::new(vertices, mesh.faces().to_vec()).unwrap();
            assert_eq!([known(&turned), known(&turned.turned_inside_out())], [clear; 2]);
        }
        clear
    }

    #[test]
    fn sheets_are_clear_where_all_faces_look_one_way() {
        let hills = |height: f64| {
            let z = |x: u32, y: u32| height * f64::from((x * 7 + y * 5) % 4);
            let point = |x: u32, y: u32| DVec3::new(f64::from(x), f64::from(y), z(x, y));
            let row = |y: u32| (0..6).map(|x| point(x, y)).collect::<Vec<_>>();
            sheet(&(0..6).map(row).collect::<Vec<_>>())
        };
        assert!(is_clear(&hills(0.0)) && is_clear(&hills(0.5)) && is_clear(&hills(1.0)));
        let mut torn = hills(0.5).faces().to_vec();
        torn[7].swap(0, 1);
        assert!(!is_clear(&Mesh::new(hills(0.5).vertices().to_vec(), torn).unwrap()));
    }

    #[test]
    fn a_ramp_is_clear_until_it_comes_around() {
        assert!(is_clear(&ramp(15, 0.1)) && is_clear(&ramp(15, 0.0)));
        for steps in [16, 17, 30, 40] {
            assert!(!is_clear(&ramp(steps, 0.1)), "{steps}");
        }
    }

    #[test]
    fn holes_are_no_obstacle_but_plates_above_each_other_are() {
        assert!(is_clear(&plate(6, 0.0, &[8, 26])));
        // Two holes that touch in a corner.
        assert!(!is_clear(&plate(6, 0.0, &[8, 15])));
        let above = plate(6, 0.0, &[]).joined(&plate(3, 1.0, &[]));
        assert!(!is_clear(&above));
        // Above a hole that is larger, and the other way round.
        let ring: Vec<u32> =
            (0..64).filter(|i| (2..6).contains(&(i % 8)) && (16..48).contains(i)).collect();
        let within = plate(8, 0.0, &ring).joined(&plate(3, 1.0, &[]));
        assert!(!is_clear(&within));
    }
}
