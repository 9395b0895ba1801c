//! A face whose edges are split at vertices within them, as smaller faces.
//!
//! No source: this crate's own. Parts tile the face because each cut runs from a corner to a point
//! of the side across. Cost: O(s log s) for a face with s vertices within its edges, besides
//! looking them up.

use std::collections::BTreeMap;

use crate::ids::VertexId;

/// Vertices inserted into edges. Faces look their edges up here, so all faces of an edge are split
/// alike, and what cancelled along it before still does.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Splits(BTreeMap<(u32, u32), Vec<u32>>);

impl Splits {
    /// Splits the edge `from to` at `inside`, vertices in this order, none of them an end.
    pub(crate) fn insert(&mut self, from: VertexId, to: VertexId, mut inside: Vec<u32>) {
        if to < from {
            inside.reverse();
        }
        self.0.insert((from.0.min(to.0), from.0.max(to.0)), inside);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The vertices strictly between `from` and `to`, in that direction.
    pub(crate) fn between(&self, from: u32, to: u32) -> Vec<u32> {
        let mut inside = self.0.get(&(from.min(to), from.max(to))).cloned().unwrap_or_default();
        if to < from {
            inside.reverse();
        }
        inside
    }

    /// The triangles of a face whose edges are split: a face is parted at the middle vertex of its
    /// most split edge, by a line to the corner across, and so are the parts. Laid out flat, with
    /// the inserted vertices on the edges, the parts tile the face and keep its winding. Triangles
    /// with two corners alike are among them where a corner of the face is a vertex of an edge
    /// across; they are part of the tiling, and have no area.
    pub(crate) fn parts(&self, face: [u32; 3]) -> Vec<[u32; 3]> {
        let [a, b, c] = face;
        let mut parts = Vec::new();
        let sides = [self.between(a, b), self.between(b, c), self.between(c, a)];
        part(face, sides, &mut parts);
        parts
    }
}

fn part([a, b, c]: [u32; 3], sides: [Vec<u32>; 3], parts: &mut Vec<[u32; 3]>) {
    // From here on the most split side comes first (on a tie the first of them).
    let most = (0..3).rev().max_by_key(|&i| sides[i].len()).unwrap_or(0);
    let [a, b, c] = [[a, b, c], [b, c, a], [c, a, b]][most];
    let mut sides = sides;
    sides.rotate_left(most);
    let [ab, bc, ca] = sides;
    if ab.is_empty() {
        parts.push([a, b, c]);
        return;
    }
    let middle = ab.len() / 2;
    let m = ab[middle];
    part([a, m, c], [ab[..middle].to_vec(), Vec::new(), ca], parts);
    part([m, b, c], [ab[middle + 1..].to_vec(), bc, Vec::new()], parts);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The boundary of triangles as a chain: directed edges that no opposite one cancels, sorted.
    fn boundary(parts: &[[u32; 3]]) -> Vec<(u32, u32)> {
        let mut edges: Vec<(u32, u32)> =
            parts.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        let mut open = Vec::new();
        while let Some((a, b)) = edges.pop() {
            match edges.iter().position(|&e| e == (b, a)) {
                Some(i) => drop(edges.remove(i)),
                None => open.push((a, b)),
            }
        }
        open.sort_unstable();
        open
    }

    #[test]
    fn a_face_split_on_all_sides_is_tiled_by_its_parts() {
        let mut splits = Splits::default();
        splits.insert(VertexId(0), VertexId(1), vec![3, 4, 5]);
        splits.insert(VertexId(2), VertexId(1), vec![7, 6]); // read from 2 to 1
        splits.insert(VertexId(2), VertexId(0), vec![8]);
        assert_eq!(splits.between(1, 2), [6, 7]);
        for face in [[0, 1, 2], [1, 2, 0], [2, 1, 0]] {
            let parts = splits.parts(face);
            assert_eq!(parts.len(), 7); // a polygon of 9 corners
            let forward =
                vec![(0, 3), (1, 6), (2, 8), (3, 4), (4, 5), (5, 1), (6, 7), (7, 2), (8, 0)];
            let mut expected = forward.clone();
            if face == [2, 1, 0] {
                expected = forward.into_iter().map(|(a, b)| (b, a)).collect();
                expected.sort_unstable();
            }
            assert_eq!(boundary(&parts), expected);
        }
    }

    #[test]
    fn parts_have_area_where_the_face_has() {
        // On the sides of a right triangle, each vertex at its place.
        let place = [[0, 0], [8, 0], [0, 8], [2, 0], [4, 0], [6, 0], [6, 2], [2, 6], [0, 4]];
        let mut splits = Splits::default();
        splits.insert(VertexId(0), VertexId(1), vec![3, 4, 5]);
        splits.insert(VertexId(1), VertexId(2), vec![6, 7]);
        splits.insert(VertexId(2), VertexId(0), vec![8]);
        let twice_area = |[a, b, c]: [u32; 3]| {
            let [p, q, r] = [a, b, c].map(|v| place[v as usize]);
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let areas: Vec<i32> = splits.parts([0, 1, 2]).into_iter().map(twice_area).collect();
        assert!(areas.iter().all(|&area| area > 0), "{areas:?}");
        assert_eq!(areas.iter().sum::<i32>(), 64);
    }

    #[test]
    fn a_corner_on_the_edge_across_leaves_no_area() {
        let mut splits = Splits::default();
        splits.insert(VertexId(0), VertexId(1), vec![2]);
        assert_eq!(splits.parts([0, 1, 2]), [[0, 2, 2], [2, 1, 2]]);
        assert_eq!(splits.parts([5, 6, 7]), [[5, 6, 7]]);
    }
}
