//! Eight numbers or vectors at once.

use cranny_exact::DVec3;
use cranny_geometry::clusters::{LANES, Lanes, Lanes3};
use wide::f32x8;

/// Eight vectors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wide3 {
    pub(crate) x: f32x8,
    pub(crate) y: f32x8,
    pub(crate) z: f32x8,
}

/// Eight numbers, loaded.
#[inline(always)]
pub(crate) fn wide(lanes: &Lanes) -> f32x8 {
    f32x8::from(lanes.0)
}

/// A vector in single precision.
#[inline(always)]
pub(crate) fn single(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| x as f32)
}

/// The bits of the lanes that are not greater than a bound: those too that are no number, since
/// nothing is known of them.
#[inline(always)]
pub(crate) fn within(numbers: f32x8, bound: f32x8) -> u32 {
    !numbers.simd_gt(bound).to_bitmask() & ((1 << LANES) - 1)
}

/// The greatest of eight; what is no number does not count.
#[inline(always)]
pub(crate) fn greatest(numbers: f32x8) -> f32 {
    let greater = |x: f32, y: f32| if x > y { x } else { y };
    let [a, b, c, d, e, f, g, h] = numbers.to_array();
    let [a, b, c, d] = [greater(e, a), greater(f, b), greater(g, c), greater(h, d)];
    greater(greater(greater(c, a), greater(d, b)), f32::NEG_INFINITY)
}

/// Numbers of the lanes of a mask, and another in the others.
#[inline(always)]
pub(crate) fn masked(numbers: f32x8, mask: u32, rest: f32) -> f32x8 {
    let mut lanes = numbers.to_array();
    for (lane, x) in lanes.iter_mut().enumerate() {
        *x = if mask >> lane & 1 == 0 { rest } else { *x };
    }
    f32x8::from(lanes)
}

/// The numbers of the bits that are set, ascending.
#[inline(always)]
pub(crate) fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}

impl Wide3 {
    #[inline(always)]
    pub(crate) fn of(lanes: &Lanes3) -> Self {
        Self { x: wide(&lanes.x), y: wide(&lanes.y), z: wide(&lanes.z) }
    }

    #[inline(always)]
    pub(crate) fn all([x, y, z]: [f32; 3]) -> Self {
        Self { x: f32x8::splat(x), y: f32x8::splat(y), z: f32x8::splat(z) }
    }

    #[inline(always)]
    pub(crate) fn dot(&self, other: &Self) -> f32x8 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(&self, other: &Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    #[inline(always)]
    pub(crate) fn times(&self, by: f32x8) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    #[inline(always)]
    pub(crate) fn to_arrays(self) -> [[f32; LANES]; 3] {
        [self.x.to_array(), self.y.to_array(), self.z.to_array()]
    }
}

/// One of eight vectors that are held as arrays, eight times.
#[inline(always)]
pub(crate) fn lane_of(arrays: &[[f32; LANES]; 3], lane: usize) -> Wide3 {
    Wide3::all([arrays[0][lane], arrays[1][lane], arrays[2][lane]])
}
