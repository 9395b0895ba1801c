//! Point clouds, reproducible.

use cranny_exact::DVec3;

/// Reproducible numbers (Marsaglia 2003, xorshift64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Uniform in [-1, 1), a multiple of 2^-52.
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 * f64::EPSILON - 1.0
    }

    /// Uniform in the cube from -1 to 1.
    pub(crate) fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Uniform in the unit ball.
    pub(crate) fn in_ball(&mut self) -> DVec3 {
        loop {
            let p = self.in_cube();
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Uniform on the unit sphere, to rounding.
    pub(crate) fn on_sphere(&mut self) -> DVec3 {
        loop {
            let p = self.in_ball();
            if p.length_squared() > 0.01 {
                return p.normalize();
            }
        }
    }
}

/// Points in the unit ball.
pub(crate) fn ball(n: usize) -> Vec<DVec3> {
    let mut random = Random::new();
    (0..n).map(|_| random.in_ball()).collect()
}

/// Points on the unit sphere.
pub(crate) fn sphere(n: usize) -> Vec<DVec3> {
    let mut random = Random::new();
    (0..n).map(|_| random.on_sphere()).collect()
}

/// Two apexes over a ring: fans whose triangles share vertices of degree `n`.
pub(crate) fn double_cone(n: usize) -> Vec<DVec3> {
    let ring = (0..n).map(|i| {
        let (s, c) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
        DVec3::new(c, s, 0.0)
    });
    [DVec3::Z, -DVec3::Z].into_iter().chain(ring).collect()
}

/// The surface of a cube, `n` by `n` points a side: nearly all of them inside its facets.
pub(crate) fn cube_grid(n: usize) -> Vec<DVec3> {
    let on_side = |i: usize| i == 0 || i + 1 == n;
    let mut points = Vec::new();
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                if on_side(x) || on_side(y) || on_side(z) {
                    points.push(DVec3::new(x as f64, y as f64, z as f64));
                }
            }
        }
    }
    points
}
