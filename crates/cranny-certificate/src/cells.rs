//! What two faces share, and the cells into which a face falls when it is cut along what it shares
//! with others. Constructed in exact rationals, in steps of the pair's grid.

use dashu_ratio::RBig;

use crate::exact::Vector;

/// A point.
pub(crate) type Site = [RBig; 3];

fn site(v: &Vector) -> Site {
    v.each_ref().map(|x| RBig::from(x.clone()))
}

fn minus(a: &Site, b: &Site) -> Site {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Site, b: &Site) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Site, b: &Site) -> Site {
    let [[ax, ay, az], [bx, by, bz]] = [a, b];
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

fn is_zero(a: &Site) -> bool {
    a.iter().all(RBig::is_zero)
}

/// Of a convex polygon: at least one corner of weight 1, growing by `stride` from corner to corner.
pub(crate) fn mean(polygon: &[Site], stride: u32) -> Site {
    let weights = (0u32..).map(|i| RBig::from(1 + i * stride));
    let total: RBig = weights.clone().take(polygon.len()).fold(RBig::ZERO, |sum, w| sum + w);
    std::array::from_fn(|axis| {
        let parts = polygon.iter().zip(weights.clone());
        parts.fold(RBig::ZERO, |sum, (p, w)| sum + &p[axis] * w) / &total
    })
}

/// The points `x` with `normal . (x - at) >= 0`.
struct HalfSpace {
    at: Site,
    normal: Site,
}

impl HalfSpace {
    fn height(&self, p: &Site) -> RBig {
        dot(&self.normal, &minus(p, &self.at))
    }

    fn opposite(&self) -> Self {
        let normal = self.normal.each_ref().map(|x| -x.clone());
        Self { at: self.at.clone(), normal }
    }

    /// What of a convex polygon, a segment or a point lies in the half-space.
    fn clip(&self, polygon: &[Site]) -> Vec<Site> {
        let heights: Vec<RBig> = polygon.iter().map(|p| self.height(p)).collect();
        let mut rest = Vec::new();
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            let (from, to) = (&heights[i], &heights[j]);
            if *from >= RBig::ZERO {
                rest.push(polygon[i].clone());
            }
            let passes = (*from > RBig::ZERO && *to < RBig::ZERO)
                || (*from < RBig::ZERO && *to > RBig::ZERO);
            if passes {
                let t = from / (from - to);
                let way = minus(&polygon[j], &polygon[i]);
                rest.push(std::array::from_fn(|k| &polygon[i][k] + &way[k] * &t));
            }
        }
        rest.dedup();
        if rest.len() > 1 && rest.first() == rest.last() {
            rest.pop();
        }
        rest
    }
}

/// What a triangle shares with another that has an area: corners of a convex polygon, the ends of a
/// segment, a point, or nothing.
pub(crate) fn shared(a: &[Vector; 3], b: &[Vector; 3]) -> Vec<Site> {
    let (mut rest, corners) = (a.each_ref().map(site).to_vec(), b.each_ref().map(site));
    let normal = normal(&corners);
    let plane = HalfSpace { at: corners[0].clone(), normal: normal.clone() };
    rest = plane.opposite().clip(&plane.clip(&rest));
    for rim in rims(&corners, &normal) {
        rest = rim.clip(&rest);
    }
    rest
}

fn normal(corners: &[Site]) -> Site {
    cross(&minus(&corners[1], &corners[0]), &minus(&corners[2], &corners[0]))
}

/// The half-spaces beside the sides of a convex polygon whose corners turn left about a normal.
fn rims(corners: &[Site], normal: &Site) -> Vec<HalfSpace> {
    let rim = |i: usize| {
        let (from, to) = (&corners[i], &corners[(i + 1) % corners.len()]);
        HalfSpace { at: from.clone(), normal: cross(normal, &minus(to, from)) }
    };
    (0..corners.len()).map(rim).collect()
}

/// The open pieces of a triangle with area between the segments and rims that it shares with
/// others. A cut goes straight on through a piece that it enters, so that pieces stay convex.
pub(crate) fn cells(face: &[Vector; 3], shared: &[Vec<Site>]) -> Vec<Vec<Site>> {
    let corners = face.each_ref().map(site);
    let normal = normal(&corners);
    let mut pieces = vec![corners.to_vec()];
    for polygon in shared.iter().filter(|polygon| polygon.len() >= 2) {
        let sides = if polygon.len() == 2 { 1 } else { polygon.len() };
        for i in 0..sides {
            let (from, to) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
            let left = HalfSpace { at: from.clone(), normal: cross(&normal, &minus(to, from)) };
            pieces = pieces
                .into_iter()
                .flat_map(|piece| divided(piece, [from, to], &left, &normal))
                .collect();
        }
    }
    pieces
}

fn divided(piece: Vec<Site>, cut: [&Site; 2], left: &HalfSpace, normal: &Site) -> Vec<Vec<Site>> {
    if enters(cut, &piece, normal) {
        vec![left.clip(&piece), left.opposite().clip(&piece)]
    } else {
        vec![piece]
    }
}

/// Whether a segment in the plane of a convex polygon runs through its inside.
fn enters(segment: [&Site; 2], polygon: &[Site], normal: &Site) -> bool {
    let rims = rims(polygon, normal);
    let all = segment.map(Clone::clone).to_vec();
    let inner = rims.iter().fold(all, |rest, rim| rim.clip(&rest));
    inner.len() == 2 && {
        let middle = mean(&inner, 0);
        rims.iter().all(|rim| rim.height(&middle) > RBig::ZERO)
    }
}

/// Whether a triangle without area has been met.
pub(crate) fn has_area(triangle: &[Vector; 3]) -> bool {
    !is_zero(&normal(&triangle.each_ref().map(site)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_int::IBig;

    fn triangle(corners: [[i64; 3]; 3]) -> [Vector; 3] {
        corners.map(|p| p.map(IBig::from))
    }

    #[test]
    fn a_face_falls_into_cells_along_what_it_shares() {
        let floor = triangle([[0, 0, 0], [8, 0, 0], [0, 8, 0]]);
        let flush = triangle([[1, 1, 0], [3, 1, 0], [1, 3, 0]]);
        let overlap = shared(&floor, &flush);
        assert_eq!(overlap.len(), 3);
        let pieces = cells(&floor, &[overlap]);
        assert_eq!(pieces.len(), 4);
        assert!(pieces.iter().all(|piece| piece.len() >= 3));
        let wall = triangle([[-1, 1, 0], [9, 1, 0], [1, 1, 5]]);
        let edge = shared(&floor, &wall);
        assert_eq!(edge.len(), 2);
        assert_eq!(cells(&floor, &[edge]).len(), 2);
        let above = triangle([[1, 1, 0], [1, 2, 3], [2, 1, 3]]);
        let point = shared(&floor, &above);
        assert_eq!((point.len(), cells(&floor, &[point]).len()), (1, 1));
        assert!(shared(&floor, &triangle([[9, 9, 0], [9, 10, 0], [10, 9, 0]])).is_empty());
        assert!(has_area(&floor) && !has_area(&triangle([[0, 0, 0], [1, 1, 1], [2, 2, 2]])));
    }
}
