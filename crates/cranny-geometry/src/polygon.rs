//! Polygons of any number of corners in triangles, as mesh files need it.
//!
//! A polygon is seen along the greatest component of its normal (Newell's: the sum over its
//! corners), so nothing is rounded: a coordinate is left out. A convex one becomes a fan from its
//! first corner. Any other is triangulated by the sweep that also makes caps, on exact signs, and
//! that keeps every corner and every edge: a corner in the midst of a straight side stays one, so
//! that neighbours still fit.
//!
//! Source: the normal is Newell's (Tampieri 1992, "Newell's method for computing the plane equation
//! of a polygon"), the sweep that of Hertel and Mehlhorn (1983). Cost: with [`split_polygon`].

use std::cmp::Ordering;

use cranny_exact::{DVec2, DVec3, Sign, orient2d};

use crate::projection::seen_along;
use crate::triangulate::triangulate;

/// Newell's sum shows the plane where it is more than this share of the sum of its terms. Smaller,
/// and the plane of lobes that cancel is read off rounding; larger is only a plane chosen by lobes
/// one by one.
const SHOWS_PLANE: f64 = 1e-6;

/// A polygon in triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplitPolygon {
    /// Numbers of corners, turning as the polygon does. Together they have the polygon's sides for
    /// boundary.
    pub triangles: Vec<[u32; 3]>,
    /// Whether they cover what the polygon encloses, each place once. If not, the polygon crosses
    /// itself, a corner lies on a side of its, or it has no area, seen along its normal.
    pub simple: bool,
    /// How far corners lie off the plane through their mean.
    pub thickness: f64,
}

/// Splits a polygon into triangles.
///
/// A simple one of `n` corners, convex or not, gives `n - 2` triangles that cover it once, the same
/// for every first corner and, turned over, for either direction, unless it is convex: then they
/// are a fan from the first. Corners in one place count as the first of them: so a polygon that is
/// led to a hole and back along the same way is triangulated around the hole.
///
/// Where the polygon crosses itself, triangles overlap or are turned over, such that its sides
/// still are their boundary; one whose sides all cancel is a fan. Coordinates must lie in the
/// [`domain`](cranny_exact::domain). Fewer than three corners give nothing.
///
/// Cost: `O(n)` if convex, else `O(n log n)`, more where it crosses itself.
///
/// ```
/// use cranny_exact::DVec3;
/// use cranny_geometry::split_polygon;
/// let arrow = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
/// let split = split_polygon(&arrow);
/// assert!(split.simple && split.thickness == 0.0);
/// assert_eq!(split.triangles.len(), 2);
/// assert!(split.triangles.iter().all(|t| t.contains(&1) && t.contains(&3))); // along the notch
/// ```
#[must_use]
pub fn split_polygon(corners: &[DVec3]) -> SplitPolygon {
    if corners.len() < 3 {
        return SplitPolygon::default();
    }
    let walk = Walk::new(corners);
    let (plane, thickness) = ViewAxis::of(&walk);
    let seen: Vec<DVec2> = corners.iter().map(|&p| seen_along(plane.axis, p)).collect();
    if is_convex(&seen) {
        return SplitPolygon { triangles: fan(corners.len()), simple: true, thickness };
    }
    let first_in_place = first_in_place(corners);
    let made = triangulate(&seen, &walk.sides(&first_in_place, plane.turns_left), &[]);
    let mut triangles = made.triangles;
    let simple = made.exact && cover_once(&triangles, &seen, &first_in_place);
    if walk.backward == plane.turns_left {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    if triangles.is_empty() {
        triangles = fan(corners.len());
    }
    SplitPolygon { triangles, simple, thickness }
}

fn fan(corners: usize) -> Vec<[u32; 3]> {
    (2..corners as u32).map(|k| [0, k - 1, k]).collect()
}

/// The corners from the lexicographically first on, towards the lesser of its neighbours: in an
/// order that does not depend on where and in which direction the polygon was begun, so that sums
/// over it do not either.
struct Walk<'a> {
    corners: &'a [DVec3],
    start: usize,
    backward: bool,
}

impl<'a> Walk<'a> {
    fn new(corners: &'a [DVec3]) -> Self {
        let before = |i: usize, j: usize| lexicographic(corners[i], corners[j]) == Ordering::Less;
        let n = corners.len();
        let start = (1..n).fold(0, |first, k| if before(k, first) { k } else { first });
        let backward = before((start + n - 1) % n, (start + 1) % n);
        Self { corners, start, backward }
    }

    /// Numbers of the corners, once around.
    fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        let n = self.corners.len();
        let step = if self.backward { n - 1 } else { 1 };
        (0..n).scan(self.start, move |at, _| {
            let here = *at;
            *at = (here + step) % n;
            Some(here)
        })
    }

    fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.numbers().map(|k| self.corners[k])
    }

    /// Sides between places, in the direction of the walk or against it.
    fn sides(&self, first_in_place: &[u32], along: bool) -> Vec<[u32; 2]> {
        let places: Vec<u32> = self.numbers().map(|k| first_in_place[k]).collect();
        let n = places.len();
        (0..n)
            .map(|k| [places[k], places[(k + 1) % n]])
            .map(|[a, b]| if along { [a, b] } else { [b, a] })
            .collect()
    }
}

/// For each corner, the first one in its place.
fn first_in_place(corners: &[DVec3]) -> Vec<u32> {
    let at = |k: u32| corners[k as usize];
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.sort_unstable_by(|&i, &j| lexicographic(at(i), at(j)).then(i.cmp(&j)));
    let mut first = vec![0; corners.len()];
    for same in order.chunk_by(|&i, &j| at(i) == at(j)) {
        same.iter().for_each(|&k| first[k as usize] = same[0]);
    }
    first
}

/// Order by x, then y, then z. Total for finite coordinates (−0 equals 0).
pub(crate) fn lexicographic(p: DVec3, q: DVec3) -> Ordering {
    let compare = |a: f64, b: f64| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    compare(p.x, q.x).then(compare(p.y, q.y)).then(compare(p.z, q.z))
}

/// From which side a polygon is seen: along an axis, from its positive end.
struct ViewAxis {
    axis: usize,
    /// Whether the walk goes counter-clockwise so.
    turns_left: bool,
}

impl ViewAxis {
    /// The plane of a walk, and how far its corners lie off the one through their mean.
    fn of(walk: &Walk<'_>) -> (Self, f64) {
        let origin = walk.corners[walk.start];
        let (mut normal, mut terms, mut mean) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        let mut last = DVec3::ZERO;
        for p in walk.positions().map(|p| p - origin) {
            let term = last.cross(p);
            normal += term;
            terms += term.abs();
            mean += p / walk.corners.len() as f64;
            last = p;
        }
        let shown = normal.abs().max_element() > SHOWS_PLANE * terms.max_element();
        let axis = if shown { normal.abs() } else { terms }.max_position();
        let unit = normal.normalize_or_zero();
        let thickness =
            walk.positions().map(|p| unit.dot(p - origin - mean).abs()).fold(0.0, f64::max);
        (Self { axis, turns_left: normal[axis] >= 0.0 }, thickness)
    }
}

/// Whether a polygon goes around once, never turning to the other side, and its fan has no triangle
/// without area.
fn is_convex(polygon: &[DVec2]) -> bool {
    let n = polygon.len();
    let at = |k: usize| polygon[k % n];
    let way = orient2d(at(0), at(1), at(2));
    let turns = (0..n).all(|k| {
        let turn = orient2d(at(k), at(k + 1), at(k + 2));
        turn == way || turn == Sign::Zero
    });
    let fan = (2..n).all(|k| orient2d(at(0), at(k - 1), at(k)) == way);
    // Sides lead towards greater x, then towards lesser: twice around, they change more often.
    let ahead = |k: usize| {
        let (p, q) = (at(k), at(k + 1));
        (p.x, p.y) < (q.x, q.y)
    };
    let changes = (0..n).filter(|&k| ahead(k) != ahead(k + 1)).count();
    way != Sign::Zero && turns && fan && changes == 2
}

/// Whether triangles of one orientation and with an area, none twice, take up all corners.
fn cover_once(triangles: &[[u32; 3]], seen: &[DVec2], first_in_place: &[u32]) -> bool {
    let mut used = vec![false; seen.len()];
    let mut sorted = Vec::with_capacity(triangles.len());
    let mut ways = [false; 3];
    for &triangle in triangles {
        let [a, b, c] = triangle.map(|k| seen[k as usize]);
        ways[(orient2d(a, b, c).as_i8() + 1) as usize] = true;
        triangle.iter().for_each(|&k| used[k as usize] = true);
        let mut corners = triangle;
        corners.sort_unstable();
        sorted.push(corners);
    }
    sorted.sort_unstable();
    let twice = sorted.windows(2).any(|w| w[0] == w[1]);
    let one_way = matches!(ways, [true, false, false] | [false, false, true]);
    one_way && !twice && first_in_place.iter().all(|&k| used[k as usize])
}
