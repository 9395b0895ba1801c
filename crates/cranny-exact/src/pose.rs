//! Where bodies are, and the one function that poses a vertex ([`RigidMap::apply`]). Its rounding
//! is bounded by [`RigidMap::posing_error`].

use glam::{DMat3, DQuat, DVec3};
use thiserror::Error;

use crate::aabb::Aabb;
use crate::domain::{DomainError, check_point};

/// Matrix entries closer than this to −1, 0 or 1 are taken to be −1, 0 or 1.
///
/// A unit quaternion cannot hold a quarter turn exactly (√½ is irrational); its matrix would miss
/// by up to 2 ulps and a box standing on a box would hover or sink by 1e-16. Four ulps cover every
/// such case; larger, and real rotations below 1e-15 radians would be lost; smaller, and
/// `quarter_turns_are_exact` fails. It also keeps the smallest nonzero entry above 2^-51, on which
/// the [`domain`](crate::domain) relies.
const SNAP: f64 = 4.0 * f64::EPSILON;

/// By how much the squared length of a rotation quaternion may differ from 1 before a pose is
/// refused. What is accepted is normalised. Larger, and what was never meant to be a rotation
/// passes for one; smaller, and quaternions that an engine kept in f32, or a file with six digits,
/// are refused.
const UNIT_SLACK: f64 = 1e-5;

/// By how much the length of a quaternion of few digits may differ from 1 and still be meant as a
/// rotation. Larger: four numbers that are none pass for one; smaller: what was written with two
/// digits, or measured in half precision, is refused.
const NEARLY_UNIT: f64 = 0.01;

/// By how much `RᵀR` of an accepted matrix may differ from 1. Larger, and a scaled or sheared body
/// passes for a rigid one; smaller, and matrices written with seven digits are refused.
const GRAM_SLACK: f64 = 1e-6;

/// A matrix that deviates less than this from a rotation is one of few digits, not one that scales.
/// It chooses the advice in a message and nothing else.
const FEW_DIGITS: f64 = 0.02;

/// Quaternions whose squared length is this near to 1 are unit to rounding and kept to the bit.
/// Smaller: what was normalised once would be normalised again, and change. Larger: posing would
/// stretch by more than the culls' slack (see [`RigidMap::bounds`]) holds.
const UNIT_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A rotation that is not one, or a translation outside the domain.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The quaternion's length is not 1.
    #[error(
        "rotation quaternion has length {length}: it must be 1 (to within five parts in a million)"
    )]
    NotUnit {
        /// Length found.
        length: f64,
    },
    /// The quaternion's length is not even nearly 1.
    #[error("rotation quaternion has length {length}: it must be 1 (to within 1 %)")]
    FarFromUnit {
        /// Length found.
        length: f64,
    },
    /// The matrix does not preserve lengths and angles, or not to enough digits.
    #[error(
        "matrix is not a rigid motion: it deviates from a rotation by {deviation:.1e} (at most {limit:e} is accepted); {}",
        what_to_do(*.deviation)
    )]
    NotRigid {
        /// Largest entry of `RᵀR − 1`; infinite where an entry is no number.
        deviation: f64,
        /// The largest accepted deviation.
        limit: f64,
    },
    /// The matrix preserves lengths and mirrors.
    #[error("matrix mirrors, and a rigid motion does not; mirror the mesh itself instead")]
    Mirrors,
    /// The matrix's last row is not (0, 0, 0, 1).
    #[error("matrix has the last row {row:?} where 0, 0, 0, 1 must stand")]
    LastRow {
        /// The row found.
        row: [f64; 4],
    },
    /// The translation lies outside the domain.
    #[error("translation: {0}")]
    Domain(#[from] DomainError),
}

/// What mends a matrix that deviates from a rotation by this much.
fn what_to_do(deviation: f64) -> &'static str {
    match deviation < FEW_DIGITS {
        true => "write its numbers with seven digits or more",
        false => "scale the mesh itself instead",
    }
}

/// Position and orientation of a body: `world_from_body`, a rotation followed by a translation.
///
/// The fields are free, so a quaternion may be anything. Whoever takes poses from outside passes
/// them through [`accepted`](Self::accepted); a world and the pair query do, and everything else
/// relies on unit length to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Unit quaternion (x, y, z, w), see [`accepted`](Self::accepted).
    pub rotation: DQuat,
    /// Of the body's origin, in world coordinates.
    pub translation: DVec3,
}

impl Pose {
    /// The body's frame is the world's.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// A pose without rotation.
    #[must_use]
    pub fn at(translation: DVec3) -> Self {
        Self { rotation: DQuat::IDENTITY, translation }
    }

    /// The pose as a world or a query takes it: kept to the bit where its quaternion is of unit
    /// length to rounding, so that a pose survives being read and set again; else normalised.
    ///
    /// # Errors
    ///
    /// [`PoseError`] where the quaternion's squared length differs from 1 by more than 1e-5 or the
    /// translation is out of domain.
    pub fn accepted(self) -> Result<Self, PoseError> {
        let checked = Self::checked(self.rotation, self.translation)?;
        let unit = (self.rotation.length_squared() - 1.0).abs() <= UNIT_ROUNDING;
        Ok(if unit { self } else { checked })
    }

    /// A validated pose. The quaternion is normalised.
    ///
    /// # Errors
    ///
    /// As for [`accepted`](Self::accepted).
    pub fn checked(rotation: DQuat, translation: DVec3) -> Result<Self, PoseError> {
        check_point(translation)?;
        let length = rotation.length();
        if (rotation.length_squared() - 1.0).abs() <= UNIT_SLACK {
            Ok(Self { rotation: rotation * (1.0 / length), translation })
        } else {
            Err(PoseError::NotUnit { length })
        }
    }

    /// A validated pose of a quaternion that was written or measured with few digits. It is
    /// normalised.
    ///
    /// # Errors
    ///
    /// [`PoseError`] where the quaternion's length differs from 1 by more than 1 % or the
    /// translation is out of domain.
    pub fn of_few_digits(rotation: DQuat, translation: DVec3) -> Result<Self, PoseError> {
        check_point(translation)?;
        let length = rotation.length();
        if (length - 1.0).abs() <= NEARLY_UNIT {
            Ok(Self { rotation: rotation * (1.0 / length), translation })
        } else {
            Err(PoseError::FarFromUnit { length })
        }
    }

    /// From a row-major 4 x 4 matrix `world_from_body` whose last row is (0, 0, 0, 1).
    ///
    /// # Errors
    ///
    /// [`PoseError::LastRow`], [`PoseError::NotRigid`] and [`PoseError::Mirrors`] where it is not a
    /// rotation and a translation, to within 1e-6; [`PoseError::Domain`] where the translation is
    /// out of domain.
    pub fn from_row_major(m: &[f64; 16]) -> Result<Self, PoseError> {
        let linear =
            DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
        let translation = DVec3::new(m[3], m[7], m[11]);
        check_point(translation)?;
        let deviation_of = |entries: &[f64]| {
            let worse =
                |worst: f64, x: &f64| if x.is_nan() { f64::INFINITY } else { worst.max(x.abs()) };
            entries.iter().fold(0.0, worse)
        };
        if deviation_of(&[m[12], m[13], m[14], m[15] - 1.0]) > GRAM_SLACK {
            return Err(PoseError::LastRow { row: [m[12], m[13], m[14], m[15]] });
        }
        let gram = linear.transpose() * linear - DMat3::IDENTITY;
        let deviation = deviation_of(&gram.to_cols_array());
        if deviation > GRAM_SLACK {
            return Err(PoseError::NotRigid { deviation, limit: GRAM_SLACK });
        }
        if linear.determinant() < 0.0 {
            return Err(PoseError::Mirrors);
        }
        let rotation = DQuat::from_mat3(&linear);
        Ok(Self { rotation: rotation * (1.0 / rotation.length()), translation })
    }

    /// Twelve numbers and a last row, row-major: the inverse of
    /// [`from_row_major`](Self::from_row_major).
    #[must_use]
    pub fn to_row_major(&self) -> [f64; 16] {
        let m = self.world_from_body();
        let (l, t) = (m.linear, m.translation);
        [
            l.x_axis.x, l.y_axis.x, l.z_axis.x, t.x, l.x_axis.y, l.y_axis.y, l.z_axis.y, t.y,
            l.x_axis.z, l.y_axis.z, l.z_axis.z, t.z, 0.0, 0.0, 0.0, 1.0,
        ]
    }

    /// The map from body to world coordinates.
    #[must_use]
    pub fn world_from_body(&self) -> RigidMap {
        RigidMap { linear: snapped(DMat3::from_quat(self.rotation)), translation: self.translation }
    }

    /// The pose of a body that is fixed in another:
    /// `world_from_inner = world_from_self · self_from_inner`.
    #[must_use]
    pub fn compose(&self, inner: &Self) -> Self {
        let rotation = self.rotation * inner.rotation;
        Self {
            rotation: rotation * (1.0 / rotation.length()),
            translation: self.world_from_body().apply(inner.translation),
        }
    }

    /// The pose of the world in the body: `body_from_world`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            rotation: self.rotation.conjugate(),
            translation: self.world_from_body().inverse().translation,
        }
    }

    /// The seven numbers that define the pose, as bits: a total order for canonical pairs and
    /// hashes.
    #[must_use]
    pub fn bits(&self) -> [u64; 7] {
        let (q, t) = (self.rotation, self.translation);
        // `+ 0.0` makes −0 and 0, which mean the same pose, the same bits.
        [q.x, q.y, q.z, q.w, t.x, t.y, t.z].map(|x| (x + 0.0).to_bits())
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// A rigid motion between two frames, ready to be applied:
/// `p_in_a = linear · p_in_b + translation`.
///
/// `linear` is a rotation to rounding. [`apply`](Self::apply) is *the* posing function: the exact
/// contract of Cranny reads the points that it returns, rounded as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMap {
    /// Rotation.
    pub linear: DMat3,
    /// Translation, applied after the rotation.
    pub translation: DVec3,
}

impl RigidMap {
    /// Leaves every point where it is.
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// `a_from_b`: takes coordinates in body B's frame to coordinates in body A's.
    #[must_use]
    pub fn between(a: &Pose, b: &Pose) -> Self {
        let (world_from_a, world_from_b) = (a.world_from_body(), b.world_from_body());
        let a_from_world = world_from_a.linear.transpose();
        // Of bodies turned alike, rounding would turn one by a few ulps: in its own place a body
        // would lie inside itself.
        let linear = match world_from_a.linear == world_from_b.linear {
            true => DMat3::IDENTITY,
            false => snapped(a_from_world * world_from_b.linear),
        };
        Self {
            linear,
            translation: a_from_world * (world_from_b.translation - world_from_a.translation),
        }
    }

    /// Poses a point: the one function that does.
    #[must_use]
    #[inline]
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// Turns a direction.
    #[must_use]
    #[inline]
    pub fn apply_vector(&self, v: DVec3) -> DVec3 {
        self.linear * v
    }

    /// The inverse motion (to rounding).
    #[must_use]
    #[inline]
    pub fn inverse(&self) -> Self {
        let linear = self.linear.transpose();
        Self { linear, translation: -(linear * self.translation) }
    }

    /// The rounding of posing: an upper bound of the distance between [`apply`](Self::apply)'s
    /// rounded result and the exact image, for points at most `radius` from the origin.
    ///
    /// `Pair::culling_error` of `cranny-narrow-phase` bounds all that rounds in a query's culls,
    /// this included.
    ///
    /// A coordinate takes three products and three sums. Each partial result is at most
    /// `√3·radius + |t|`, each operation adds half an ulp of it; six operations, three coordinates.
    #[must_use]
    pub fn posing_error(&self, radius: f64) -> f64 {
        let t = self.translation.abs().max_element();
        8.0 * f64::EPSILON * (2.0 * radius + t)
    }

    /// A box that holds the rounded image of every point of `b`.
    ///
    /// Three things round, each by at most [`posing_error`](Self::posing_error): the image of a
    /// point, that of the box's center, and the half extents, which round like a point that is
    /// posed.
    #[must_use]
    pub fn bounds(&self, b: &Aabb) -> Aabb {
        let (center, h, m) = (self.apply(b.center()), b.half_extents(), self.linear);
        let half = m.x_axis.abs() * h.x + m.y_axis.abs() * h.y + m.z_axis.abs() * h.z;
        let radius = b.min.abs().max(b.max.abs()).length();
        Aabb { min: center - half, max: center + half }.grown(3.0 * self.posing_error(radius))
    }
}

fn snapped(m: DMat3) -> DMat3 {
    DMat3::from_cols_array(&m.to_cols_array().map(|x| {
        // Entries of rotations: `round` is a call where the machine is an old one, and integers in
        // between keep the entries from being treated side by side.
        let nearest = if x.abs() > 0.5 { 1.0f64.copysign(x) } else { 0.0 };
        if (x - nearest).abs() <= SNAP { nearest } else { x }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_testkit::Rng;

    #[test]
    fn bodies_turned_alike_are_not_turned_against_each_other() {
        let mut rng = Rng::new(7);
        let mut next = || rng.unit();
        for _ in 0..1_000 {
            let q = DQuat::from_xyzw(next(), next(), next(), next()).normalize();
            let translation = DVec3::new(next(), next(), next());
            for rotation in [q, -q] {
                let (a, b) = (Pose { rotation: q, translation }, Pose { rotation, translation });
                assert_eq!(RigidMap::between(&a, &b), RigidMap::IDENTITY);
            }
        }
    }

    /// The 24 rotations that take the axes to the axes.
    fn cube_rotations() -> Vec<DMat3> {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
        let mut all = Vec::new();
        for x in axes {
            for y in axes.into_iter().filter(|y| y.dot(x) == 0.0) {
                all.push(DMat3::from_cols(x, y, x.cross(y)));
            }
        }
        all
    }

    fn row_major(r: DMat3, t: DVec3) -> [f64; 16] {
        [
            r.x_axis.x, r.y_axis.x, r.z_axis.x, t.x, r.x_axis.y, r.y_axis.y, r.z_axis.y, t.y,
            r.x_axis.z, r.y_axis.z, r.z_axis.z, t.z, 0.0, 0.0, 0.0, 1.0,
        ]
    }

    #[test]
    fn only_entries_next_to_minus_one_zero_and_one_are_snapped() {
        let entry = |x: f64| snapped(DMat3::from_diagonal(DVec3::splat(x))).y_axis.y;
        let near = 0.5 * SNAP;
        for (x, to) in [(1.0 - near, 1.0f64), (near - 1.0, -1.0), (near, 0.0), (-near, 0.0)] {
            assert_eq!(entry(x).to_bits(), to.to_bits(), "{x}");
        }
        for x in [0.5, -0.5, 0.7, 3.0 * SNAP, 1.0 - 3.0 * SNAP, 3.0 * SNAP - 1.0] {
            assert_eq!(entry(x), x);
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let p = DVec3::new(0.375, -1.5, 1024.0625);
        let rotations = cube_rotations();
        assert_eq!(rotations.len(), 24);
        for &ra in &rotations {
            for &rb in &rotations {
                let (ta, tb) = (DVec3::new(1.0, -2.5, 0.125), DVec3::new(-3.0, 0.75, 8.0));
                let a = Pose::from_row_major(&row_major(ra, ta)).unwrap();
                let b = Pose::from_row_major(&row_major(rb, tb)).unwrap();
                assert_eq!(a.world_from_body().apply(p), ra * p + ta);
                let expected = ra.transpose() * (rb * p + tb - ta);
                assert_eq!(RigidMap::between(&a, &b).apply(p), expected);
                assert_eq!(a.to_row_major(), row_major(ra, ta));
            }
        }
    }

    #[test]
    fn matrices_that_scale_mirror_or_shear_are_refused() {
        let refused = |m: DMat3| Pose::from_row_major(&row_major(m, DVec3::ZERO)).is_err();
        assert!(refused(DMat3::from_diagonal(DVec3::splat(2.0))));
        assert!(refused(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))));
        assert!(refused(DMat3::from_cols(DVec3::X, DVec3::new(0.1, 1.0, 0.0), DVec3::Z)));
        assert!(refused(DMat3::from_diagonal(DVec3::splat(f64::NAN))));
        assert!(!refused(DMat3::IDENTITY));
        let mut projective = row_major(DMat3::IDENTITY, DVec3::ZERO);
        projective[13] = 0.5;
        assert!(Pose::from_row_major(&projective).is_err());
    }

    #[test]
    fn the_posing_error_bounds_what_rounding_does() {
        let rotation = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.64).normalize();
        let map = Pose { rotation, translation: DVec3::new(1e3, 0.1, -7.0) }.world_from_body();
        let p = DVec3::new(0.3, -0.9, 0.2);
        // Splitting the point in two halves gives the same image up to rounding.
        let halves = map.linear * (0.5 * p) + (map.linear * (0.5 * p) + map.translation);
        assert!((map.apply(p) - halves).length() <= 2.0 * map.posing_error(p.length()));
        assert!(map.posing_error(1.0) < 1e-11);
    }

    #[test]
    fn bounds_hold_every_posed_point_and_little_more() {
        let b = Aabb { min: DVec3::new(-0.3, 0.1, -2.0), max: DVec3::new(0.7, 0.15, 3.0) };
        for k in 0..200 {
            let t = f64::from(k);
            let rotation = DQuat::from_xyzw(0.1 * t, 1.0, -0.3, 0.2 * t - 4.0).normalize();
            let map =
                Pose { rotation, translation: DVec3::new(t, -10.0 * t, 0.1) }.world_from_body();
            let bounds = map.bounds(&b);
            let corners = (0..8).map(|i| {
                let pick = |axis: usize| if i >> axis & 1 == 0 { b.min[axis] } else { b.max[axis] };
                map.apply(DVec3::new(pick(0), pick(1), pick(2)))
            });
            let tight = Aabb::of_points(corners);
            assert!(bounds.min.cmple(tight.min).all() && tight.max.cmple(bounds.max).all());
            assert!((bounds.max - tight.max).max(tight.min - bounds.min).max_element() < 1e-9);
        }
        assert!(RigidMap::IDENTITY.bounds(&b).contains_point(b.max));
    }

    #[test]
    fn a_pose_is_kept_to_the_bit_once_it_is_accepted() {
        let nine_digits = DQuat::from_xyzw(0.301_234_567, -0.5, 0.2, 0.786_612_345);
        let rotation = nine_digits * (1.000_000_1 / nine_digits.length());
        let once = Pose { rotation, translation: DVec3::X }.accepted().unwrap();
        assert_ne!(once.rotation, rotation);
        assert_eq!(once.accepted().unwrap(), once);
        let of_length = |squared: f64| {
            let rotation = DQuat::from_xyzw(0.0, 0.0, squared.sqrt(), 0.0);
            Pose { rotation, translation: DVec3::X }.accepted()
        };
        assert_eq!(of_length(1.0 + 9e-6).unwrap().rotation.z, 1.0);
        assert_eq!(of_length(1.0 - 9e-6).unwrap().rotation.z, 1.0);
        assert!(matches!(of_length(1.0 + 2e-5), Err(PoseError::NotUnit { .. })));
        assert!(of_length(0.0).is_err() && of_length(f64::NAN).is_err());
        assert!(Pose::at(DVec3::splat(f64::NAN)).accepted().is_err());
    }

    #[test]
    fn a_quaternion_of_few_digits_is_normalised_and_four_numbers_are_refused() {
        let of = |length| Pose::of_few_digits(DQuat::IDENTITY * length, DVec3::X);
        for length in [0.991, 1.0, 1.009] {
            assert_eq!(of(length), Ok(Pose::at(DVec3::X)));
        }
        for length in [0.0, 0.98, 1.02, f64::NAN, f64::INFINITY] {
            assert!(matches!(of(length), Err(PoseError::FarFromUnit { .. })), "{length}");
        }
        let far = Pose::of_few_digits(DQuat::IDENTITY, DVec3::X * f64::NAN);
        assert!(matches!(far, Err(PoseError::Domain(_))));
    }

    #[test]
    fn composition_follows_the_frames() {
        let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt());
        let outer = Pose { rotation: quarter, translation: DVec3::X };
        let inner = Pose { rotation: quarter, translation: DVec3::Y };
        let both = outer.compose(&inner).world_from_body();
        assert_eq!(both.apply(DVec3::X), DVec3::new(-1.0, 0.0, 0.0));
        assert_eq!(outer.world_from_body().inverse().apply(DVec3::X), DVec3::ZERO);
    }
}
