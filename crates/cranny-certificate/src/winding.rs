//! Where a point lies: the faces are counted that a ray from it along +x leaves and enters by.
//!
//! The ray starts beside the point by `(0, e, e^2)` with an `e` smaller than anything: it meets no
//! edge, no corner and no face that is parallel to it. A point that is on no face has the same
//! number of faces around it there as in its own place.

use std::cmp::Ordering;

use crate::body::Body;
use crate::exact::{Point, Vector, cross, dot, is_zero, minus, normal, sign};

/// Where a point lies with respect to the components of a body that bound a region of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    /// They wind around it.
    Inside,
    /// On a face of them.
    On,
    Outside,
}

impl Body {
    /// Locates a point.
    pub(crate) fn locate(&self, p: &Point) -> Location {
        let mut winding = 0i64;
        for triangle in self.before(p) {
            if holds(&triangle, p) {
                return Location::On;
            }
            winding += passage(&triangle, p, None);
        }
        if winding == 0 { Location::Outside } else { Location::Inside }
    }

    /// Whether the components wind around a point beside `p` by as little as one likes, along a
    /// direction that leads off each face that holds `p`.
    pub(crate) fn winds_beside(&self, p: &Point, along: &Vector) -> bool {
        let passages = self.before(p).map(|triangle| passage(&triangle, p, Some(along)));
        passages.sum::<i64>() != 0
    }

    /// Whether a face that bounds space holds a point and does not lie at right angles to a
    /// direction.
    pub(crate) fn passes_through(&self, p: &Point, normal: &Vector) -> bool {
        let askew = |triangle: &[Vector; 3]| !is_zero(&cross(normal, &self::normal(triangle)));
        self.before(p).any(|triangle| holds(&triangle, p) && askew(&triangle))
    }

    /// The faces that bound space, but for those that a ray from a point along +x misses because
    /// they lie before the point, above, below or aside.
    fn before(&self, p: &Point) -> impl Iterator<Item = [Vector; 3]> {
        let faces = (0..self.faces.len() as u32).filter(|&face| self.bounds_space(face));
        faces.filter_map(move |face| {
            let corners = self.faces[face as usize].map(|v| &self.vertices[v as usize]);
            let misses = |axis: usize, order: Ordering| {
                corners.iter().all(|c| p.compare(axis, &c[axis]) == order)
            };
            let aside = |axis| misses(axis, Ordering::Less) || misses(axis, Ordering::Greater);
            let missed = misses(0, Ordering::Greater) || aside(1) || aside(2);
            (!missed).then(|| corners.map(Clone::clone))
        })
    }
}

/// +1 where the ray leaves through the face, -1 where it enters, 0 where it misses it. The ray
/// starts beside the point along `shift` first, where there is one, and then by `(0, e, e^2)`.
fn passage(triangle: &[Vector; 3], p: &Point, shift: Option<&Vector>) -> i64 {
    let n = normal(triangle);
    let facing = sign(&n[0]);
    let [a, b, c] = triangle;
    let passes = facing.is_ne()
        && [[a, b], [b, c], [c, a]].iter().all(|side| beside(side, p, shift) == facing);
    // The ray goes towards +x: the point is behind the face where it is below and the face looks
    // along +x, or the other way round.
    let off = || shift.map_or(Ordering::Equal, |shift| sign(&dot(&n, shift)));
    let height = sign(&dot(&n, &p.from(a))).then_with(off);
    match (passes && height == facing.reverse(), facing) {
        (false, _) | (_, Ordering::Equal) => 0,
        (true, Ordering::Greater) => 1,
        (true, Ordering::Less) => -1,
    }
}

/// On which side of a face's side the ray passes, seen along x: greater is left.
fn beside([from, to]: &[&Vector; 2], p: &Point, shift: Option<&Vector>) -> Ordering {
    let along = minus(to, from);
    let turn = |way: &Vector| -> Ordering { sign(&(&along[1] * &way[2] - &along[2] * &way[1])) };
    turn(&p.from(from))
        .then_with(|| shift.map_or(Ordering::Equal, turn))
        .then_with(|| sign(&along[2]).reverse())
        .then_with(|| sign(&along[1]))
}

/// Whether a closed triangle, with area or without, holds a point.
pub(crate) fn holds(triangle: &[Vector; 3], p: &Point) -> bool {
    let [a, b, c] = triangle;
    let n = normal(triangle);
    let sides = [[a, b], [b, c], [c, a]];
    if is_zero(&n) {
        return sides.iter().any(|side| on_segment(side, p));
    }
    let is_left =
        |[from, to]: &[&Vector; 2]| sign(&dot(&n, &cross(&minus(to, from), &p.from(from)))).is_ge();
    sign(&dot(&n, &p.from(a))).is_eq() && sides.iter().all(is_left)
}

fn on_segment([from, to]: &[&Vector; 2], p: &Point) -> bool {
    let (along, way) = (minus(to, from), p.from(from));
    let covered = dot(&along, &way);
    is_zero(&cross(&along, &way))
        && sign(&covered).is_ge()
        && covered <= dot(&along, &along) * &p.over
        && (!is_zero(&along) || is_zero(&way))
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;

    use super::*;
    use crate::body::Triangles;
    use crate::exact::Grid;

    /// A cube from 0 to 4, and a point in quarters.
    fn located(p: [i64; 3]) -> Location {
        let vertices: Vec<[f64; 3]> =
            (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|bit| 4.0 * f64::from(bit))).collect();
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let cube = Triangles { vertices, faces };
        let body = Body::new(&cube, &cube, Grid::of(cube.numbers()));
        assert!(body.is_closed());
        // The grid's step is 4.
        body.locate(&Point { over: IBig::from(16), xyz: p.map(IBig::from) })
    }

    #[test]
    fn corners_edges_and_diagonals_in_the_ray_s_way_do_not_confuse_it() {
        for (p, expected) in [
            ([8, 8, 8], Location::Inside),
            ([1, 15, 15], Location::Inside),
            ([-1, 8, 8], Location::Outside),
            ([-1, 0, 0], Location::Outside),
            ([-1, 16, 8], Location::Outside),
            ([-1, 8, 0], Location::Outside),
            ([17, 8, 8], Location::Outside),
            ([0, 8, 8], Location::On),
            ([16, 3, 9], Location::On),
            ([8, 0, 0], Location::On),
            ([16, 16, 16], Location::On),
            ([8, 16, 5], Location::On),
            ([8, 17, 5], Location::Outside),
        ] {
            assert_eq!(located(p), expected, "{p:?}");
        }
    }
}
