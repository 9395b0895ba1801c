//! The faces of a pocket in groups of a few that lie together and face the same way.
//!
//! Layers are made of groups, not of faces: there are a third as many, and what is summed once over
//! the faces of a group need not be looked at again in every layer. Groups are taken from the tree
//! over the pocket's faces: the largest parts of it that are few enough and lie across no sharp
//! edge. How layers divide groups is judged with more care (`cluster`).
//!
//! Cost: O(n), given the tree.
//!
//! No source: this crate's own; any grouping is right.

use cranny_exact::{Aabb, DVec3};

use super::moments::Opening;
use cranny_geometry::Mesh;
use cranny_geometry::{Content, FaceTree};
use cranny_geometry::{FaceId, VertexId};

/// Faces whose unit normals spread wider than this along an axis are no group: that is what lies on
/// both sides of an edge of 45 degrees. Smaller, and groups of bent walls have single faces;
/// larger, and groups lie across edges, where no plane is near to all of their faces.
const BENT: f64 = 0.75;

/// A group, as layers divide it.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// What it may be divided by: the mean of its faces' middles in the opening's frame, with the
    /// pocket's size as unit, and its mean unit normal (zero where areas cancel).
    pub(super) keys: [f64; 6],
    /// Sums over its faces of the means over their corners of the products of coordinates: xx, yy,
    /// zz, xy, yz, zx.
    pub(super) products: [f64; 6],
    /// Length of the sum of area vectors.
    pub(super) area: f64,
    /// Number of faces.
    pub(super) count: u32,
}

/// What a group holds.
pub(super) struct FaceGroup {
    /// Range of [`FaceGroups::faces`].
    faces: [u32; 2],
    /// Range of [`FaceGroups::corners`].
    corners: [u32; 2],
    pub(super) bounds: Aabb,
    /// The largest inner product of a corner with the opening's axis, as computed.
    pub(super) reach: f64,
}

/// The groups of a pocket, in memory that is used again from pocket to pocket.
#[derive(Default)]
pub(super) struct FaceGroups {
    /// What layers divide them by.
    pub(super) items: Vec<Item>,
    /// What they hold.
    groups: Vec<FaceGroup>,
    faces: Vec<FaceId>,
    /// Each once in a group.
    corners: Vec<VertexId>,
    /// Of the group in the making: how often each of its corners is one of a face, and its area
    /// vectors.
    times: Vec<u32>,
    areas: Vec<DVec3>,
    /// Of each vertex the last group that it is a corner of, counted through all pockets, and its
    /// place there.
    places: Vec<[u32; 2]>,
    /// How many groups have been made in all.
    made: u32,
}

impl FaceGroups {
    /// Takes the place of earlier ones: groups of at most `most` of the faces beneath a node of a
    /// tree. What is too many or lies across an edge in a leaf falls into single faces.
    pub(super) fn fill(
        &mut self,
        mesh: &Mesh,
        tree: &FaceTree,
        root: u32,
        opening: &Opening,
        most: usize,
    ) {
        self.items.clear();
        self.groups.clear();
        self.faces.clear();
        self.corners.clear();
        self.places.resize(mesh.vertices().len(), [0; 2]);
        let (nodes, faces) = tree.beneath(root);
        // They are half full as a rule.
        let groups = 2 * faces.len().div_ceil(most);
        self.items.reserve(groups);
        self.groups.reserve(groups);
        self.faces.reserve(faces.len());
        // In depth-first order: the next node is the left child, or what follows all beneath this
        // one.
        let mut node = nodes.start;
        while node < nodes.end {
            if tree.surely_has_more(node, most) {
                node += 1;
                continue;
            }
            let (beneath, range) = tree.beneath(node);
            let faces = &tree.faces()[range];
            if faces.len() <= most && !self.is_bent(mesh, faces) {
                self.add(mesh, opening, faces);
                node = beneath.end;
                continue;
            }
            if let Content::Leaf { .. } = tree.content(node) {
                for face in faces.chunks(1) {
                    self.areas.clear();
                    self.areas.push(mesh.area_vector(face[0]));
                    self.add(mesh, opening, face);
                }
            }
            node += 1;
        }
    }

    /// What the group of an item holds.
    pub(super) fn group(&self, item: u32) -> &FaceGroup {
        &self.groups[item as usize]
    }

    pub(super) fn corners(&self, group: &FaceGroup) -> &[VertexId] {
        let [start, end] = group.corners;
        &self.corners[start as usize..end as usize]
    }

    /// All corners, some of them several times.
    pub(super) fn all_corners(&self) -> &[VertexId] {
        &self.corners
    }

    /// All faces in the order of some items.
    pub(super) fn ordered_faces(&self, order: &[u32]) -> impl Iterator<Item = FaceId> {
        order.iter().flat_map(|&item| {
            let [start, end] = self.group(item).faces;
            self.faces[start as usize..end as usize].iter().copied()
        })
    }

    /// Whether faces lie across a sharp edge. Notes their area vectors.
    fn is_bent(&mut self, mesh: &Mesh, faces: &[FaceId]) -> bool {
        self.areas.clear();
        if let [face] = faces {
            self.areas.push(mesh.area_vector(*face));
            return false;
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &face in faces {
            let area = mesh.area_vector(face);
            self.areas.push(area);
            let length = area.length();
            let normal = if length > 0.0 { area * (1.0 / length) } else { DVec3::ZERO };
            (low, high) = (low.min(normal), high.max(normal));
        }
        (high - low).max_element() > BENT
    }

    /// Makes a group of faces whose area vectors are noted.
    fn add(&mut self, mesh: &Mesh, opening: &Opening, faces: &[FaceId]) {
        let starts = [self.faces.len(), self.corners.len()];
        let (mut bounds, mut reach) = (Aabb::EMPTY, f64::NEG_INFINITY);
        let [mut place, mut squares, mut mixed] = [DVec3::ZERO; 3];
        self.times.clear();
        self.times.resize(3 * faces.len(), 0);
        self.corners.resize(starts[1] + 3 * faces.len(), VertexId(0));
        self.made += 1;
        let (corners, mut count) = (&mut self.corners[starts[1]..], 0);
        for &face in faces {
            for vertex in mesh.corners(face) {
                // Where it stands, or behind the others: without a branch that nobody can predict.
                let [group, place] = self.places[vertex.index()];
                let at = if group == self.made { place } else { count };
                self.places[vertex.index()] = [self.made, at];
                corners[at as usize] = vertex;
                self.times[at as usize] += 1;
                count += u32::from(at == count);
            }
        }
        self.corners.truncate(starts[1] + count as usize);
        for (&vertex, &times) in self.corners[starts[1]..].iter().zip(&self.times) {
            let times = f64::from(times);
            let p = mesh.position(vertex);
            let q = opening.beside_origin(p);
            place += times * q;
            squares += times * (q * q);
            mixed += times * (q * DVec3::new(q.y, q.z, q.x));
            bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
            reach = larger(reach, opening.axis.dot(p));
        }
        self.faces.extend_from_slice(faces);
        let ends = [self.faces.len(), self.corners.len()];
        let [range, corners] = [0, 1].map(|k| [starts[k] as u32, ends[k] as u32]);
        self.groups.push(FaceGroup { faces: range, corners, bounds, reach });
        let area: DVec3 = self.areas.iter().sum();
        let length = area.length();
        let normal = if length > 0.0 { opening.turned(area) / length } else { DVec3::ZERO };
        let [x, y, z] = (opening.turned(place) / (3 * faces.len()) as f64).to_array();
        let [a, b, c] = normal.to_array();
        // No zero has a sign, so that all orders agree.
        let keys = [x, y, z, a, b, c].map(|key| key + 0.0);
        let products = opening.turned_products(squares / 3.0, mixed / 3.0);
        self.items.push(Item { keys, products, area: length, count: faces.len() as u32 });
    }
}

/// The larger of two numbers. Unlike `f64::max` one instruction: neither is NaN.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_do_not_lie_across_a_sharp_edge() {
        // A strip of eight squares in the plane z = 0 that goes on with eight in the plane x = 8.
        let place = |i: u32| [i.min(8), i.max(8) - 8].map(f64::from);
        let point = |i: u32, y: f64| DVec3::new(place(i)[0], y, place(i)[1]);
        let vertices = (0..=16).flat_map(|i| [point(i, 0.0), point(i, 1.0)]).collect();
        let square = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
        let mesh = Mesh::new(vertices, (0..16).flat_map(square).collect()).unwrap();
        let faces: Vec<FaceId> = (0..32).map(FaceId).collect();
        let tree = FaceTree::over(&mesh, &faces, 2);
        let opening = Opening::of(&[DVec3::Z], &mesh.bounds());
        let mut groups = FaceGroups::default();
        groups.fill(&mesh, &tree, 0, &opening, 4);
        assert_eq!(groups.items.len(), 8);
        let (along, across) = (opening.turned(DVec3::Z), opening.turned(-DVec3::X));
        for (name, item) in (0..).zip(&groups.items) {
            // Four triangles of two squares, which have six corners.
            assert_eq!((item.count, item.area), (4, 2.0));
            assert_eq!(groups.corners(groups.group(name)).len(), 6);
            let normal = DVec3::from_slice(&item.keys[3..]);
            assert!(normal == along || normal == across, "{normal}");
        }
        let mut ordered: Vec<FaceId> = groups.ordered_faces(&[0, 1, 2, 3, 4, 5, 6, 7]).collect();
        ordered.sort_unstable();
        assert_eq!(ordered, faces);
        let highest = (0..8).map(|item| groups.group(item).reach).fold(0.0, f64::max);
        assert_eq!(highest, 8.0);
    }
}
