//! Cones of normals, bounded so that rounding cannot put a normal outside.
//!
//! Source: cones of normals are Shirman and Abi-Ezzi's (1993, "The cone of normals technique for
//! fast processing of curved patches"); the bounds of rounding are derived here. Cost: O(1) for a
//! union, O(n) to measure n faces.

use cranny_exact::DVec3;

use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Directions that make no more than a given angle with an axis.
///
/// For a face with corners a, b, c and N = (b − a) × (c − a), both as real numbers, the cone holds
/// the face's normal when `N · axis >= cosine |N| |axis|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalCone {
    /// Unit vector, to rounding; in the body's frame.
    pub axis: DVec3,
    /// Cosine of the half-angle, rounded down. −1: every direction.
    pub cosine: f64,
}

/// What rounding may take off a cosine: a dozen operations on numbers of at most 1, axes whose
/// lengths are off by two ulps. Smaller, and a normal may lie outside; larger, and flat patches get
/// wider cones (this one stands for 2e-7 radians).
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Sine of the angle between the two shorter edges of a face below which it has no normal worth the
/// name: rounding may then turn the normal by more than 2^-19 radians. Larger, and thin faces
/// that do have a normal lose it; smaller, and one needle widens the cone of a whole patch.
const NEEDLE_SINE: f64 = 1.0 / (1u64 << 30) as f64;

/// Twice a face's area vector as computed, and what rounding may have done to it.
#[derive(Clone, Copy)]
pub(super) struct Normal {
    vector: DVec3,
    length: f64,
    error: f64,
}

impl Normal {
    /// `None` for needles and faces without area.
    pub(super) fn of(mesh: &Mesh, face: FaceId) -> Option<Self> {
        let [a, b, c] = mesh.triangle(face);
        // From the corner between the two shorter edges the product rounds least.
        let [ab, bc, ca] = [b - a, c - b, a - c];
        let [x, y, z] = [ab, bc, ca].map(DVec3::length_squared);
        let (e, f, scale) = if y >= x && y >= z {
            (ca, ab, z * x)
        } else if z >= x {
            (ab, bc, x * y)
        } else {
            (bc, ca, y * z)
        };
        let (vector, scale) = (e.cross(f), scale.sqrt());
        let length = vector.length();
        // Edges round by half an ulp, products and their difference by another: 4 of them a
        // coordinate, and the sum of absolute products is at most twice the product of lengths.
        let error = 8.0 * f64::EPSILON * scale;
        (length > NEEDLE_SINE * scale).then_some(Self { vector, length, error })
    }

    pub(super) fn unit(&self) -> DVec3 {
        self.vector / self.length
    }

    /// A lower bound of the cosine of its angle with a unit vector.
    fn cosine_lower(&self, axis: DVec3) -> f64 {
        let along = self.vector.dot(axis) - self.error;
        if along > 0.0 { along / (self.length + self.error) - ROUNDING } else { -1.0 }
    }
}

/// The unit normal of a face, to rounding; `None` for needles and faces without area.
pub(super) fn unit_normal(mesh: &Mesh, face: FaceId) -> Option<DVec3> {
    Normal::of(mesh, face).map(|n| n.unit())
}

/// Those of all faces: growth needs each several times, and measuring once more.
#[derive(Default)]
pub(super) struct Normals(Vec<Normal>);

impl Normals {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let none = Normal { vector: DVec3::ZERO, length: 0.0, error: 0.0 };
        let faces = mesh.face_ids();
        Self(faces.map(|face| Normal::of(mesh, face).unwrap_or(none)).collect())
    }

    /// Of how many faces.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// `None` for needles and faces without area.
    #[inline]
    pub(super) fn get(&self, face: FaceId) -> Option<Normal> {
        Some(self.0[face.index()]).filter(|normal| normal.length > 0.0)
    }
}

/// What the normals of some faces have in common.
pub(super) struct Measured {
    /// The narrowest cone about a given axis that certainly holds all normals but the needles'.
    pub(super) cone: NormalCone,
    pub(super) needles: u32,
    pub(super) area: f64,
}

impl Measured {
    /// `normal_of` returns the [normal](Normal::of) of a face. Cost: O(n).
    pub(super) fn of(
        normal_of: impl Fn(FaceId) -> Option<Normal>,
        mesh: &Mesh,
        faces: &[FaceId],
        axis: DVec3,
    ) -> Self {
        let (mut cosine, mut needles, mut area) = (1.0 - ROUNDING, 0, 0.0);
        for &face in faces {
            if let Some(normal) = normal_of(face) {
                cosine = normal.cosine_lower(axis).min(cosine);
                area += 0.5 * normal.length;
            } else {
                needles += 1;
                area += mesh.area_vector(face).length();
            }
        }
        let none = needles as usize == faces.len() || cosine < 0.0;
        let cone = if none { NormalCone::WHOLE } else { NormalCone { axis, cosine } };
        Self { cone, needles, area }
    }
}

impl NormalCone {
    /// Every direction.
    pub const WHOLE: Self = Self { axis: DVec3::Z, cosine: -1.0 };

    /// Whether the cone is known to be narrower than the whole of directions.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.cosine > -1.0
    }

    /// Sine of the half-angle, rounded to nearest; of an angle up to a right one.
    pub(super) fn sine(&self) -> f64 {
        // 1 − cosine is exact where the cosine is above ½, so that no digit of a small angle is
        // lost.
        ((1.0 - self.cosine) * (1.0 + self.cosine)).max(0.0).sqrt()
    }

    /// The cone of one direction.
    pub(super) fn of_direction(unit: DVec3) -> Self {
        Self { axis: unit, cosine: 1.0 }
    }

    /// A cone that certainly holds both: the narrowest one, to rounding; [`WHOLE`](Self::WHOLE)
    /// where its half-angle is above a right one.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let [a, b] = [self, other];
        if a.cosine < 0.0 || b.cosine < 0.0 {
            return Self::WHOLE;
        }
        if b.cosine >= 1.0 {
            return a.with(b.axis);
        }
        let (sa, sb) = (a.sine(), b.sine());
        let between = a.axis.dot(b.axis);
        let nested = a.cosine * b.cosine + sa * sb; // cosine of the difference of half-angles
        if between >= nested {
            let wider = if a.cosine <= b.cosine { a } else { b };
            return Self {
                axis: wider.axis,
                cosine: a.least_cosine(wider.axis).min(b.least_cosine(wider.axis)),
            };
        }
        if between < sa * sb - a.cosine * b.cosine {
            return Self::WHOLE;
        }
        // The outermost directions of both in the plane of the axes; the new axis lies midway.
        let normal = a.axis.cross(b.axis);
        let across = normal.cross(a.axis).normalize_or_zero();
        let back = b.axis.cross(normal).normalize_or_zero();
        let middle = (a.cosine * a.axis - sa * across) + (b.cosine * b.axis - sb * back);
        let Some(axis) = middle.try_normalize() else { return Self::WHOLE };
        let cosine = a.least_cosine(axis).min(b.least_cosine(axis));
        if cosine < 0.0 { Self::WHOLE } else { Self { axis, cosine } }
    }

    /// [`union`](Self::union) with the cone of one direction; of one up to a half-angle of 90
    /// degrees.
    fn with(&self, unit: DVec3) -> Self {
        let (sine, between) = (self.sine(), self.axis.dot(unit));
        if between >= self.cosine {
            let cosine = self.least_cosine(self.axis).min(between - ROUNDING);
            return Self { axis: self.axis, cosine };
        }
        if between < -self.cosine {
            return Self::WHOLE;
        }
        let across = self.axis.cross(unit).cross(self.axis).normalize_or_zero();
        let middle = (self.cosine * self.axis - sine * across) + unit;
        let Some(axis) = middle.try_normalize() else { return Self::WHOLE };
        let cosine = self.least_cosine(axis).min(axis.dot(unit) - ROUNDING);
        if cosine < 0.0 { Self::WHOLE } else { Self { axis, cosine } }
    }

    /// A lower bound of the cosine between a unit vector and any direction of this cone.
    fn least_cosine(&self, unit: DVec3) -> f64 {
        let along = self.axis.dot(unit);
        if self.cosine < 0.0 || along < -self.cosine {
            return -1.0;
        }
        let across = self.axis.cross(unit).length();
        (along * self.cosine - across * self.sine() - ROUNDING).max(-1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(axis: DVec3, degrees: f64) -> NormalCone {
        NormalCone { axis: axis.normalize(), cosine: degrees.to_radians().cos() }
    }

    fn degrees(cone: &NormalCone) -> f64 {
        cone.cosine.acos().to_degrees()
    }

    #[test]
    fn unions_by_hand() {
        // Axes 60 degrees apart, half-angles 10 and 20: from −10 to 80, so 45 about 35.
        let a = cone(DVec3::X, 10.0);
        let b = cone(DVec3::new(0.5, 0.75f64.sqrt(), 0.0), 20.0);
        let u = a.union(&b);
        assert!((degrees(&u) - 45.0).abs() < 1e-9, "{}", degrees(&u));
        assert!((u.axis.y.atan2(u.axis.x).to_degrees() - 35.0).abs() < 1e-9);
        // One inside the other, either way round; the same twice.
        let inner = cone(DVec3::new(1.0, 0.05, 0.0), 3.0);
        assert!((degrees(&a.union(&inner)) - 10.0).abs() < 1e-6);
        assert!((degrees(&inner.union(&a)) - 10.0).abs() < 1e-6);
        assert!((degrees(&a.union(&a)) - 10.0).abs() < 1e-6);
        // From −10 to 190: more than half a turn.
        assert!(!a.union(&cone(-DVec3::X, 10.0)).is_bounded());
        assert!(!a.union(&NormalCone::WHOLE).is_bounded());
        // From −10 to 170 exactly fits, less and it is bounded.
        assert!(a.union(&cone(DVec3::new(-0.9, 0.5, 0.0), 10.0)).is_bounded());
    }

    #[test]
    fn a_union_holds_both_whatever_the_rounding() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for k in 0..20_000 {
            let spread = 0.5f64.powi(k % 60);
            let axis = DVec3::new(random(), random(), random()).normalize();
            let near = (axis + spread * DVec3::new(random(), random(), random())).normalize();
            let [a, b] = [axis, near].map(|axis| NormalCone {
                axis,
                cosine: 1.0 - 0.5 * spread * spread * (1.0 + random()),
            });
            let u = a.union(&b);
            for c in [a, b] {
                // The boundary direction farthest from the new axis.
                let away = c.axis.cross(u.axis.cross(c.axis)).normalize_or_zero();
                let away =
                    if away == DVec3::ZERO { c.axis.any_orthonormal_vector() } else { -away };
                let far = c.cosine * c.axis + c.sine() * away;
                assert!(far.dot(u.axis) >= u.cosine, "{a:?} {b:?} {u:?}");
            }
        }
    }

    #[test]
    fn needles_have_no_normal_but_small_slim_faces_have() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        let mesh = |c: [DVec3; 3]| Mesh::new(c.to_vec(), vec![[0, 1, 2]]).unwrap();
        let needle = mesh([at(0.0, 0.0), at(1.0, 0.0), at(0.5, 1e-10)]);
        assert_eq!(unit_normal(&needle, FaceId(0)), None);
        let line = mesh([at(0.0, 0.0), at(1.0, 1.0), at(3.0, 3.0)]);
        assert_eq!(unit_normal(&line, FaceId(0)), None);
        let slim = mesh([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1e-10)]);
        assert_eq!(unit_normal(&slim, FaceId(0)), Some(DVec3::Z));
        let about = |axis| Measured::of(|f| Normal::of(&slim, f), &slim, &[FaceId(0)], axis).cone;
        assert!(about(DVec3::Z).cosine > 1.0 - 1e-9);
        assert!(!about(-DVec3::Z).is_bounded());
    }
}
