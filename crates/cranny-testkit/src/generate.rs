//! Seeded generators of triangle pairs, most of them degenerate by construction.

use cranny_exact::DVec3;

use crate::random::Rng;

/// How a pair of triangles is made. Wherever a feature is said to lie *on* another it does so
/// exactly: corners are small multiples of 2^-4, so that the sums that place them do not round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Corners anywhere.
    Random,
    /// Corners on a small integer lattice: shared features, co-planar and collinear points abound.
    Lattice,
    /// A common corner, the others anywhere.
    SharedVertex,
    /// A common edge, the third corners anywhere.
    SharedEdge,
    /// Both in one slanted plane.
    Coplanar,
    /// A corner of B on A, often on its rim.
    VertexOnFace,
    /// Two corners of B on A.
    EdgeOnFace,
    /// An edge of B through a point of A, often through its rim.
    EdgeThroughFace,
    /// Needles: one triangle (or both) a few ulps wide.
    Sliver,
    /// One triangle (or both) without area, often touching the other.
    ZeroArea,
    /// Another family, some coordinates moved by an ulp or two.
    NearUlp,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 11] = [
        Self::Random,
        Self::Lattice,
        Self::SharedVertex,
        Self::SharedEdge,
        Self::Coplanar,
        Self::VertexOnFace,
        Self::EdgeOnFace,
        Self::EdgeThroughFace,
        Self::Sliver,
        Self::ZeroArea,
        Self::NearUlp,
    ];

    /// A pair of this family, in random order, with corners in random order.
    #[must_use]
    pub fn pair(self, rng: &mut Rng) -> ([DVec3; 3], [DVec3; 3]) {
        let (mut a, mut b) = self.ordered_pair(rng);
        for t in [&mut a, &mut b] {
            t.rotate_left(rng.below(3));
            if rng.chance(2) {
                t.swap(0, 1);
            }
        }
        if rng.chance(2) { (b, a) } else { (a, b) }
    }

    fn ordered_pair(self, rng: &mut Rng) -> ([DVec3; 3], [DVec3; 3]) {
        match self {
            Self::Random => (triangle(rng, Rng::anywhere), triangle(rng, Rng::anywhere)),
            Self::Lattice => {
                let reach = rng.between(1, 3);
                let on_lattice = |rng: &mut Rng| rng.lattice(reach);
                (triangle(rng, on_lattice), triangle(rng, on_lattice))
            }
            Self::SharedVertex => {
                let (a, mut b) = Self::Random.ordered_pair(rng);
                b[0] = a[0];
                (a, b)
            }
            Self::SharedEdge => {
                let (a, mut b) = Self::Random.ordered_pair(rng);
                (b[0], b[1]) = (a[1], a[0]);
                (a, b)
            }
            Self::Coplanar => {
                let (o, u, v) = (rng.lattice(16), rng.lattice(7), rng.lattice(7));
                let in_plane = |rng: &mut Rng| {
                    o + f64::from(rng.between(-4, 4)) * u + f64::from(rng.between(-4, 4)) * v
                };
                (triangle(rng, in_plane), triangle(rng, in_plane))
            }
            Self::VertexOnFace => {
                let a = coarse(rng);
                (a, [point_on(&a, rng), rng.lattice(64), rng.lattice(64)])
            }
            Self::EdgeOnFace => {
                let a = coarse(rng);
                (a, [point_on(&a, rng), point_on(&a, rng), rng.lattice(64)])
            }
            Self::EdgeThroughFace => {
                let (a, arm) = (coarse(rng), rng.lattice(32));
                let through = point_on(&a, rng);
                (a, [through - arm, through + f64::from(rng.between(1, 3)) * arm, rng.lattice(64)])
            }
            Self::Sliver => {
                let (mut a, mut b) = Self::Random.ordered_pair(rng);
                a[2] = nudged(a[0] + rng.unit() * (a[1] - a[0]), rng);
                if rng.chance(2) {
                    // Across or along the needle, close by.
                    b[0] = nudged(a[0] + rng.unit().abs() * (a[1] - a[0]), rng);
                }
                if rng.chance(3) {
                    b[2] = nudged(b[0] + rng.unit() * (b[1] - b[0]), rng);
                }
                (a, b)
            }
            Self::ZeroArea => zero_area(rng),
            Self::NearUlp => {
                let family = Self::ALL[1 + rng.below(Self::ALL.len() - 2)];
                let (a, b) = family.ordered_pair(rng);
                (a.map(|p| nudged(p, rng)), b.map(|p| nudged(p, rng)))
            }
        }
    }
}

fn triangle(rng: &mut Rng, mut corner: impl FnMut(&mut Rng) -> DVec3) -> [DVec3; 3] {
    [corner(rng), corner(rng), corner(rng)]
}

/// A triangle with integer corners, so that sixteenths of its edges are exact.
fn coarse(rng: &mut Rng) -> [DVec3; 3] {
    triangle(rng, |rng| rng.lattice(64))
}

/// A point of the triangle whose barycentric coordinates are sixteenths; half of them on the rim.
fn point_on(t: &[DVec3; 3], rng: &mut Rng) -> DVec3 {
    let first = if rng.chance(2) { 0 } else { rng.between(0, 16) };
    let second = if rng.chance(8) { 0 } else { rng.between(0, 16 - first) };
    let weights = [first, second, 16 - first - second].map(|w| f64::from(w) / 16.0);
    let turn = rng.below(3);
    (0..3).map(|i| weights[i] * t[(i + turn) % 3]).sum()
}

fn zero_area(rng: &mut Rng) -> ([DVec3; 3], [DVec3; 3]) {
    let b = if rng.chance(3) { triangle(rng, |rng| rng.lattice(2)) } else { coarse(rng) };
    // Either a point of B or close to it; an arm of zero makes A a point.
    let at = if rng.chance(2) { point_on(&b, rng) } else { rng.lattice(3) };
    let arm = match rng.below(4) {
        0 => DVec3::ZERO,
        1 => (b[1] - b[0]) / 16.0,
        _ => rng.lattice(16),
    };
    let mut along = || at + f64::from(rng.between(-2, 2)) * arm;
    let a = [along(), along(), along()];
    if rng.chance(3) {
        let other = rng.lattice(2);
        return (a, [at, at + other, at - other].map(|p| p + f64::from(rng.between(0, 1)) * arm));
    }
    (a, b)
}

/// The point with each coordinate moved by up to two ulps, half of the time. Zero moves by 2^-80,
/// since its ulp lies outside the coordinate domain.
fn nudged(p: DVec3, rng: &mut Rng) -> DVec3 {
    const BESIDE_ZERO: f64 = 1.0 / (1u128 << 80) as f64;
    DVec3::from_array(p.to_array().map(|x| match rng.between(-4, 4) {
        steps if x == 0.0 && steps.abs() <= 2 => f64::from(steps) * BESIDE_ZERO,
        1 => x.next_up(),
        2 => x.next_up().next_up(),
        -1 => x.next_down(),
        -2 => x.next_down().next_down(),
        _ => x,
    }))
}
