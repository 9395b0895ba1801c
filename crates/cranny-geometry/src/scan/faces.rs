//! Faces that are unusual by themselves, and faces in one place.
//!
//! No source: definitions, decided exactly where rounded numbers do not. Cost: O(n); faces in one
//! place cost more where very many share an edge.

use cranny_exact::DVec3;

use super::turns::Turn;
use crate::ids::{FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::projection::collinear;
use crate::report::{Finding, FindingKind};
use crate::topology::Topology;

/// Whether the corners of a face lie on a line or in a point, exactly.
pub(crate) fn has_no_area(mesh: &Mesh, face: FaceId) -> bool {
    let [a, b, c] = mesh.triangle(face);
    collinear(a, b, c)
}

/// What is read of each face by itself, in one pass.
pub(super) struct Looked {
    pub(super) turns: Vec<Turn>,
    /// Whether each has no area, exactly.
    pub(super) without_area: Vec<bool>,
    /// Those that may be [`thin`]; ascending.
    low: Vec<FaceId>,
    /// The sum of all areas.
    pub(super) area: f64,
}

impl Looked {
    /// O(n).
    pub(super) fn at(mesh: &Mesh, weld_distance: f64) -> Self {
        let count = mesh.faces().len();
        let (mut turns, mut low) = (Vec::with_capacity(count), Vec::new());
        let mut without_area = vec![false; count];
        let mut twice_area = 0.0;
        for face in (0..count as u32).map(FaceId) {
            let [a, b, c] = mesh.triangle(face);
            let turn = Turn::of(&[a, b, c]);
            // Twice as high, which rounding leaves alone where nothing is lost below the least
            // number.
            let squared = turn.normal.length_squared();
            let is_high = squared > 4.0 * weld_distance * weld_distance * longest_squared(a, b, c);
            if !(is_high && squared > f64::MIN_POSITIVE && turn.has_area()) {
                without_area[face.index()] = !turn.has_area() && has_no_area(mesh, face);
                low.push(face);
            }
            twice_area += squared.sqrt();
            turns.push(turn);
        }
        Self { turns, without_area, low, area: 0.5 * twice_area }
    }
}

fn longest_squared(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [x, y, z] = [b - a, c - b, a - c].map(DVec3::length_squared);
    // Not by `f64::max`, which would look for NaN among them.
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    larger(larger(x, y), z)
}

/// Faces without area, and needles: faces no higher than the weld distance.
pub(super) fn thin(mesh: &Mesh, looked: &Looked, weld_distance: f64) -> Vec<Finding> {
    let Looked { without_area, low, .. } = looked;
    let finding = |face: FaceId| {
        let [a, b, c] = mesh.triangle(face);
        let longest = longest_squared(a, b, c).sqrt();
        let (kind, measure) = if without_area[face.index()] {
            (FindingKind::ZeroAreaFace, longest)
        } else {
            (FindingKind::NeedleFace, 2.0 * mesh.area_vector(face).length() / longest)
        };
        let unusual = kind == FindingKind::ZeroAreaFace || measure <= weld_distance;
        let at = (a + b + c) / 3.0;
        unusual.then(|| Finding::one(kind, vec![face.0], at, measure))
    };
    low.iter().filter_map(|&face| finding(face)).collect()
}

/// Groups of two and more faces on the same three vertices, each ascending, by their vertices. O(n)
/// where few faces share an edge: only those that share one *and* the corner across it come into
/// question. They share all three edges, so one a face is looked at.
pub(crate) fn coincident(mesh: &Mesh, topology: &Topology) -> Vec<Vec<FaceId>> {
    let across = |h: HalfEdgeId| mesh.corners(h.face())[(h.corner() + 2) % 3];
    let mut candidates: Vec<([u32; 3], FaceId)> = Vec::new();
    for (face, corners) in (0..).map(FaceId).zip(mesh.faces()) {
        let first = HalfEdgeId::of(face, 0);
        if topology.twin(first).is_some_and(|twin| across(twin).0 != corners[2]) {
            continue; // nearly every face
        }
        let around = topology.half_edges(topology.edge_of(first));
        if around.len() < 2 || corners[0] == corners[1] {
            continue;
        }
        let mut faces: Vec<_> = around.iter().map(|&h| (across(h), h.face())).collect();
        faces.sort_unstable();
        for group in faces.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            candidates.extend(group.iter().map(|&(_, f)| (sorted(mesh.faces()[f.index()]), f)));
        }
    }
    candidates.retain(|(key, _)| key[0] < key[1] && key[1] < key[2]);
    candidates.sort_unstable();
    candidates.dedup();
    candidates
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|group| group.len() > 1)
        .map(|group| group.iter().map(|&(_, f)| f).collect())
        .collect()
}

pub(crate) fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// Whether a face runs through its corners in their ascending order, up to rotation.
pub(crate) fn runs_upward([a, b, c]: [u32; 3]) -> bool {
    (a < b) as u8 + (b < c) as u8 + (c < a) as u8 == 2
}

pub(super) fn in_one_place(mesh: &Mesh, groups: &[Vec<FaceId>]) -> Vec<Finding> {
    let finding = |group: &Vec<FaceId>| {
        let upward = |f: &FaceId| runs_upward(mesh.faces()[f.index()]);
        let alike = group.iter().all(|f| upward(f) == upward(&group[0]));
        let kind = if alike { FindingKind::DuplicateFaces } else { FindingKind::OppositeFaces };
        let at = mesh.triangle(group[0]).iter().sum::<DVec3>() / 3.0;
        let ids = group.iter().map(|f| f.0).collect();
        Finding::one(kind, ids, at, mesh.area_vector(group[0]).length())
    };
    groups.iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winding_is_read_off_the_order_of_corners() {
        for rotation in [[1, 4, 7], [4, 7, 1], [7, 1, 4]] {
            assert!(runs_upward(rotation));
        }
        for rotation in [[1, 7, 4], [7, 4, 1], [4, 1, 7]] {
            assert!(!runs_upward(rotation));
        }
    }

    #[test]
    fn faces_in_one_place_are_grouped_and_collapsed_ones_are_not() {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces =
            vec![[0, 1, 2], [2, 0, 1], [0, 1, 3], [3, 1, 0], [0, 0, 1], [1, 0, 0], [1, 2, 3]];
        let mesh = Mesh::new(vertices, faces).unwrap();
        let groups = coincident(&mesh, &Topology::of(&mesh));
        assert_eq!(groups, [[FaceId(0), FaceId(1)], [FaceId(2), FaceId(3)]]);
        let kinds: Vec<_> = in_one_place(&mesh, &groups).iter().map(|f| f.kind).collect();
        assert_eq!(kinds, [FindingKind::DuplicateFaces, FindingKind::OppositeFaces]);
    }

    #[test]
    fn needles_are_no_higher_than_the_weld_distance() {
        let tip = DVec3::new(0.5, 0.125, 0.0);
        let mesh = Mesh::new(vec![DVec3::ZERO, DVec3::X, tip], vec![[0, 1, 2]]).unwrap();
        let thin = |distance| thin(&mesh, &Looked::at(&mesh, distance), distance);
        let found = thin(0.125);
        assert_eq!((found[0].kind, found[0].measure), (FindingKind::NeedleFace, 0.125));
        assert!(thin(0.124).is_empty());
    }
}
