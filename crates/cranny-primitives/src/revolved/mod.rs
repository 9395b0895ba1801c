//! Solids of revolution against a mesh: segments, capsules, cylinders and cones, each also with a
//! border radius.
//!
//! A solid is all that lies within a radius of a *core*: a convex polygon in a half-plane (its
//! *profile*, from axis to axis), turned about the axis. `profile` knows the core in its
//! half-plane, this file in space; `least` finds where the signed distance from the core, a convex
//! function, is least on a segment and on a triangle; `nearest` searches a model's faces for the
//! nearest one.
//!
//! Nothing is tessellated. Distances are within a few dozen units of rounding of the largest length
//! of the pair.

mod least;
mod nearest;
mod profile;

pub use least::{LeastOnSegment, LeastOnTriangle};
pub use nearest::{NearestFace, nearest_face};
pub use profile::CorePart;

use cranny_exact::{Aabb, DVec2, DVec3};

use profile::Profile;

/// A convex solid of revolution, placed.
#[derive(Clone, Copy, Debug)]
pub struct Revolved {
    /// Where heights are counted from.
    origin: DVec3,
    /// Unit.
    axis: DVec3,
    profile: Profile,
    radius: f64,
}

/// Where a point lies about the core of a solid.
#[derive(Clone, Copy, Debug)]
pub struct CoreFoot {
    /// Signed distance from the core's surface: negative inside.
    pub signed: f64,
    /// The nearest point of the surface.
    pub point: DVec3,
    /// Unit normal of the core there, outward; amid those of an edge where it holds the point
    /// itself.
    pub outward: DVec3,
    /// What holds the nearest point.
    pub part: CorePart,
}

impl Revolved {
    /// All within `radius >= 0` of a segment: a capsule; a ball, where its ends are the same.
    #[must_use]
    pub fn segment(ends: [DVec3; 2], radius: f64) -> Self {
        let along = ends[1] - ends[0];
        let length = along.length();
        let axis = along.try_normalize().unwrap_or(DVec3::Z);
        Self { origin: ends[0], axis, profile: Profile::of(&[[0.0, 0.0], [0.0, length]]), radius }
    }

    /// A cylinder about a unit axis through its middle, with a border radius outside of it.
    #[must_use]
    pub fn cylinder(
        middle: DVec3,
        axis: DVec3,
        half_height: f64,
        radius: f64,
        border: f64,
    ) -> Self {
        let h = half_height;
        let profile = Profile::of(&[[0.0, -h], [radius, -h], [radius, h], [0.0, h]]);
        Self { origin: middle, axis, profile, radius: border }
    }

    /// A cone about a unit axis, from its base, half its height below the middle, to its apex; with
    /// a border radius outside of it.
    #[must_use]
    pub fn cone(middle: DVec3, axis: DVec3, half_height: f64, radius: f64, border: f64) -> Self {
        let h = half_height;
        let profile = Profile::of(&[[0.0, -h], [radius, -h], [0.0, h]]);
        Self { origin: middle, axis, profile, radius: border }
    }

    /// The border radius around the core.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Unit.
    #[must_use]
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Whether the core has no interior: a point, a segment, a disc.
    #[must_use]
    pub fn is_thin(&self) -> bool {
        self.profile.is_thin()
    }

    /// A point that the core holds: half-way along its axis, or the centre of the largest ball
    /// inside it.
    #[must_use]
    pub fn middle(&self) -> DVec3 {
        self.origin + self.axis * self.profile.middle()
    }

    /// The radius of a ball around [`middle`](Self::middle) that holds the core.
    #[must_use]
    pub fn extent(&self) -> f64 {
        self.profile.extent()
    }

    /// The profile's corners: radius of the circle, and the circle's centre.
    pub fn circles(&self) -> impl Iterator<Item = (f64, DVec3)> + '_ {
        self.profile.corners().iter().map(|c| (c.x, self.origin + self.axis * c.y))
    }

    /// The flat ends: outward normal, centre and radius (> 0) of each.
    pub fn caps(&self) -> impl Iterator<Item = (DVec3, DVec3, f64)> + '_ {
        self.profile
            .caps()
            .map(|(up, rim)| (self.axis * up, self.origin + self.axis * rim.y, rim.x))
    }

    /// The box of the solid, its border included.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let DVec3 { x, y, z } = self.axis;
        // Without cancellation where the axis is nearly one of the frame's.
        let length = |p: f64, q: f64| (p * p + q * q).sqrt();
        let spread = DVec3::new(length(y, z), length(z, x), length(x, y));
        let ends = self.circles().flat_map(|(r, c)| [c - r * spread, c + r * spread]);
        let size = self.middle().abs().max_element() + self.extent() + self.radius;
        Aabb::of_points(ends).grown(self.radius + ROUNDING * size)
    }

    /// The signed distance of a point from the core, and where the core is nearest.
    #[must_use]
    pub fn core_foot(&self, p: DVec3) -> CoreFoot {
        let (flat, across) = self.parted(p - self.origin);
        let foot = self.profile.foot(flat);
        let in_space = |q: DVec2| across * q.x + self.axis * q.y;
        CoreFoot {
            signed: foot.signed,
            point: self.origin + in_space(foot.point),
            outward: in_space(foot.outward),
            part: foot.part,
        }
    }

    /// How far the core reaches in a unit direction: the greatest product with a point of it.
    #[must_use]
    pub fn core_reach(&self, direction: DVec3) -> f64 {
        let (flat, _) = self.parted(direction);
        direction.dot(self.origin) + self.profile.farthest(flat).1
    }

    /// A point of the core that reaches farthest in a direction: one of many, where the core is
    /// flat there.
    #[must_use]
    pub fn core_support(&self, direction: DVec3) -> DVec3 {
        let (flat, across) = self.parted(direction);
        let corner = self.profile.corners()[self.profile.farthest(flat).0];
        self.origin + across * corner.x + self.axis * corner.y
    }

    /// Of each circle of the profile the point that reaches farthest in a direction.
    pub fn rims(&self, direction: DVec3) -> impl Iterator<Item = DVec3> + '_ {
        let across = self.parted(direction).1;
        self.circles().map(move |(r, center)| center + across * r)
    }

    /// A vector's parts across the axis and along it, and the unit direction of the former: any,
    /// where it is 0.
    fn parted(&self, v: DVec3) -> (DVec2, DVec3) {
        let z = self.axis.dot(v);
        let across = v - self.axis * z;
        let r = across.length();
        // What rounding leaves of a vector along the axis is not square to it.
        let square = across - self.axis * self.axis.dot(across);
        let unit = square.try_normalize().unwrap_or_else(|| self.axis.any_orthonormal_vector());
        (DVec2::new(r, z), unit)
    }
}

/// Units of rounding, relative to the largest length in play, by which a computed length may be
/// off. Smaller: bounds are not bounds; larger: searches look at boxes in vain.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
