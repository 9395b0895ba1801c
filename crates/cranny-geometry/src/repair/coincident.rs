//! Faces in one place: which copies the surface does not need.
//!
//! No source: this crate's own, for the reason given with the function. Cost: O(n), and O(k log k)
//! for k faces that have copies.

use std::collections::BTreeMap;

use crate::ids::{EdgeId, FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::scan::faces::{coincident, runs_upward};
use crate::topology::{DisjointSets, Topology};

/// The faces to drop, ascending. One copy of every face stays at least, so the surface as a set of
/// points is the same.
///
/// Of copies wound both ways, as many pairs go as leaves one face or one opposite pair: what two
/// opposite faces add to their edges cancels, so this changes no boundary. Of a last opposite pair
/// one goes if edges balance then that do not with both (a face of a closed surface, filed a second
/// time the wrong way round). Of copies wound alike one stays, unless edges that were balanced
/// would be open then. Both are decided for all such faces that hang together (a solid filed twice
/// loses its second copy as a whole).
pub(super) fn superfluous(mesh: &Mesh, topology: &Topology) -> Vec<FaceId> {
    let mut drop = Vec::new();
    let mut alike: Vec<Vec<FaceId>> = Vec::new();
    let mut opposite: Vec<[FaceId; 2]> = Vec::new();
    for group in coincident(mesh, topology) {
        let (up, down): (Vec<FaceId>, Vec<FaceId>) =
            group.into_iter().partition(|f| runs_upward(mesh.faces()[f.index()]));
        let pairs = match up.len() == down.len() {
            true => up.len() - 1,
            false => up.len().min(down.len()),
        };
        let [up, down] = [up, down].map(|mut copies| {
            drop.extend(copies.split_off(copies.len() - pairs));
            copies
        });
        if up.len().abs_diff(down.len()) > 1 {
            alike.push(if up.is_empty() { down } else { up });
        } else if let ([up], [down]) = (&up[..], &down[..]) {
            opposite.push([*up, *down]);
        }
    }
    for cluster in clusters(topology, alike) {
        let extra: Vec<FaceId> = cluster.iter().flat_map(|copies| copies[1..].to_vec()).collect();
        let Unbalanced { before, after } = unbalanced(mesh, topology, &extra);
        if after <= before {
            drop.extend(extra);
        }
    }
    for sides in sides(mesh, topology, &opposite) {
        let [front, back] = sides.each_ref().map(|side| unbalanced(mesh, topology, side));
        let [front_side, back_side] = sides;
        if front.after < front.before.min(back.after) {
            drop.extend(front_side);
        } else if back.after < back.before.min(front.after) {
            drop.extend(back_side);
        }
    }
    drop.sort_unstable();
    drop
}

/// Groups of copies that hang together over edges.
fn clusters(topology: &Topology, mut alike: Vec<Vec<FaceId>>) -> Vec<Vec<Vec<FaceId>>> {
    let mut sets = DisjointSets::new(alike.len());
    let mut seen: BTreeMap<EdgeId, usize> = BTreeMap::new();
    for (i, copies) in alike.iter().enumerate() {
        for edge in edges(topology, copies[0]) {
            let first = *seen.entry(edge).or_insert(i);
            sets.union(first, i);
        }
    }
    let mut taken = |i: usize| std::mem::take(&mut alike[i]);
    sets.groups().into_iter().map(|group| group.into_iter().map(&mut taken).collect()).collect()
}

fn edges(topology: &Topology, face: FaceId) -> impl Iterator<Item = EdgeId> + use<'_> {
    (0..3).map(move |corner| topology.edge_of(HalfEdgeId::of(face, corner)))
}

/// Both sides of what opposite pairs form together, each wound consistently over the edges at which
/// two pairs meet, as far as that can be (a Moebius strip has one side).
fn sides(mesh: &Mesh, topology: &Topology, pairs: &[[FaceId; 2]]) -> Vec<[Vec<FaceId>; 2]> {
    let mut at: BTreeMap<EdgeId, Vec<usize>> = BTreeMap::new();
    for (i, &[face, _]) in pairs.iter().enumerate() {
        edges(topology, face).for_each(|edge| at.entry(edge).or_default().push(i));
    }
    let mut seen = vec![false; pairs.len()];
    let mut found = Vec::new();
    for start in 0..pairs.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut members, mut next) = (vec![(start, 0)], 0);
        while let Some(&(i, side)) = members.get(next) {
            next += 1;
            for h in (0..3).map(|corner| HalfEdgeId::of(pairs[i][side], corner)) {
                let &[one, two] = &at[&topology.edge_of(h)][..] else { continue };
                let other = if one == i { two } else { one };
                let against = |&side: &usize| {
                    let mut corners = (0..3).map(|c| HalfEdgeId::of(pairs[other][side], c));
                    let there = corners.find(|&g| topology.edge_of(g) == topology.edge_of(h));
                    there.is_some_and(|g| runs(mesh, g) != runs(mesh, h))
                };
                let Some(wanted) = [0, 1].iter().position(against) else { continue };
                if !seen[other] {
                    seen[other] = true;
                    members.push((other, wanted));
                }
            }
        }
        let side = |turn: usize| members.iter().map(|&(i, side)| pairs[i][side ^ turn]).collect();
        found.push([side(0), side(1)]);
    }
    found
}

/// 1 along its edge, from the vertex of the lower number to the other; -1 against it.
fn runs(mesh: &Mesh, h: HalfEdgeId) -> i64 {
    let corners = mesh.corners(h.face());
    if corners[h.corner()] < corners[(h.corner() + 1) % 3] { 1 } else { -1 }
}

/// Of the edges of some faces, how many are run through more often one way than the other.
struct Unbalanced {
    before: usize,
    /// Without the faces.
    after: usize,
}

fn unbalanced(mesh: &Mesh, topology: &Topology, without: &[FaceId]) -> Unbalanced {
    let mut lost: BTreeMap<EdgeId, i64> = BTreeMap::new();
    for &face in without {
        for h in (0..3).map(|corner| HalfEdgeId::of(face, corner)) {
            *lost.entry(topology.edge_of(h)).or_default() += runs(mesh, h);
        }
    }
    let mut found = Unbalanced { before: 0, after: 0 };
    for (edge, lost) in lost {
        let sum: i64 = topology.half_edges(edge).iter().map(|&h| runs(mesh, h)).sum();
        found.before += usize::from(sum != 0);
        found.after += usize::from(sum != lost);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn dropped(faces: &[[u32; 3]]) -> Vec<u32> {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mesh = Mesh::new(vertices, faces.to_vec()).unwrap();
        superfluous(&mesh, &Topology::of(&mesh)).iter().map(|f| f.0).collect()
    }

    #[test]
    fn a_second_copy_goes_whether_of_a_face_or_of_all() {
        assert_eq!(dropped(&[&TETRAHEDRON[..], &[[1, 0, 2]]].concat()), [4]);
        assert_eq!(dropped(&[TETRAHEDRON, TETRAHEDRON].concat()), [4, 5, 6, 7]);
    }

    #[test]
    fn opposite_copies_cancel_while_one_stays() {
        // Twice forward, once back: once forward.
        let more = [[0, 1, 2], [1, 0, 2]];
        assert_eq!(dropped(&[&TETRAHEDRON[..], &more[..]].concat()), [4, 5]);
        // A lone sheet with a back side stays; two of them are one.
        assert_eq!(dropped(&[[0, 1, 2], [1, 0, 2]]), [0; 0]);
        assert_eq!(dropped(&[[0, 1, 2], [1, 0, 2], [0, 1, 2], [1, 0, 2]]), [2, 3]);
    }

    #[test]
    fn of_an_opposite_pair_the_copy_that_fits_its_neighbours_stays() {
        let back = |face: [u32; 3]| [face[0], face[2], face[1]];
        for face in TETRAHEDRON {
            assert_eq!(dropped(&[&TETRAHEDRON[..], &[back(face)]].concat()), [4]);
            assert_eq!(dropped(&[&[back(face)], &TETRAHEDRON[..]].concat()), [0]);
        }
        // Two that hang together go together, whichever way their numbers run.
        for (one, two) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let more = [back(TETRAHEDRON[one]), back(TETRAHEDRON[two])];
            assert_eq!(dropped(&[&TETRAHEDRON[..], &more[..]].concat()), [4, 5]);
        }
        // With a back side of everything nothing is missing; a fin has both its sides.
        assert_eq!(dropped(&[TETRAHEDRON, TETRAHEDRON.map(back)].concat()), [0; 0]);
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::splat(2.0)];
        let faces = [&TETRAHEDRON[..], &[[1, 2, 4], [2, 1, 4]]].concat();
        let mesh = Mesh::new(vertices, faces).unwrap();
        assert!(superfluous(&mesh, &Topology::of(&mesh)).is_empty());
    }

    #[test]
    fn a_copy_that_balances_others_stays() {
        // Twice the floor below two different roofs, the second turned over the first's outside.
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, 2.0 * DVec3::Z];
        let roof = |top: u32| [[0, 1, top], [1, 2, top], [2, 0, top]];
        let floor = [[0, 2, 1], [0, 2, 1]];
        let faces = [&floor[..], &roof(3), &roof(4)].concat();
        let mesh = Mesh::new(vertices, faces).unwrap();
        let topology = Topology::of(&mesh);
        assert!(topology.is_closed());
        assert!(superfluous(&mesh, &topology).is_empty());
    }
}
