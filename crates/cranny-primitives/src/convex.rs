//! Two primitives: how far they are apart, and where they meet.
//!
//! Beside a half-space, a ball, a capsule or a segment the signed distance of a solid of revolution
//! has a closed form. Two cylinders or cones, and contacts of all of them, are parry's.

use cranny_exact::{DQuat, DVec3};
use cranny_geometry::{EdgeId, VertexId};
use cranny_narrow_phase::{Contact, Feature, reduce_contacts};
use parry3d_f64::math::Pose as ParryPose;
use parry3d_f64::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
    QueryDispatcher,
};
use parry3d_f64::shape::SharedShape;

use crate::between::WHOLE_PRIMITIVE;
use crate::primitive::{
    Ball, Capsule, Checked, Cone, Cylinder, HalfSpace, Plane, Primitive, PrimitiveError, Segment,
};
use crate::revolved::Revolved;
use crate::separation::Found;

/// Cosine of the angle (0.08 degrees) within which a flat end lies flat on a plane. Larger: it
/// stands on one point of its rim; smaller: what leans has points that are far above the plane.
const FLAT: f64 = 1.0 - 1e-6;

/// How far two primitives of one frame are apart, if by no more than `within`, and whether parry's
/// search found it, which ends at a tolerance of its own.
pub(crate) fn found(
    first: &Primitive,
    second: &Primitive,
    within: f64,
) -> Result<(Found, bool), PrimitiveError> {
    let of_signed = |signed: Signed| (signed.found(within), false);
    Ok(match (first.checked()?, second.checked()?) {
        (Checked::HalfSpace(a), Checked::HalfSpace(b)) => of_signed(of_half_spaces(&a, &b)),
        (Checked::HalfSpace(plane), Checked::Round(solid)) => {
            of_signed(over_plane(&solid, &plane).swapped())
        }
        (Checked::Round(solid), Checked::HalfSpace(plane)) => of_signed(over_plane(&solid, &plane)),
        (Checked::Round(a), Checked::Round(b)) => match (axis_of(first), axis_of(second)) {
            (_, Some((ends, radius))) => of_signed(along(&a, ends, radius)),
            (Some((ends, radius)), _) => of_signed(along(&b, ends, radius).swapped()),
            _ => (searched(first, second, within), true),
        },
    })
}

/// The contacts of two primitives of one frame, of separations up to `margin`, with normals from
/// the first to the second; none of two half-spaces.
pub(crate) fn contacts(
    first: &Primitive,
    second: &Primitive,
    margin: f64,
) -> Result<Vec<Contact>, PrimitiveError> {
    Ok(match (first.checked()?, second.checked()?) {
        (Checked::HalfSpace(_), Checked::HalfSpace(_)) => Vec::new(),
        (Checked::Round(solid), Checked::HalfSpace(plane)) => on_plane(&solid, &plane, margin),
        (Checked::HalfSpace(plane), Checked::Round(solid)) => {
            on_plane(&solid, &plane, margin).into_iter().map(Contact::swapped).collect()
        }
        (Checked::Round(_), Checked::Round(_)) => of_manifolds(first, second, margin),
    })
}

/// Contacts of a solid (A) with the half-space beneath it: the lowest point of each of its circles,
/// and four more of one that lies flat.
fn on_plane(solid: &Revolved, &Plane { normal, offset }: &Plane, margin: f64) -> Vec<Contact> {
    let flat = solid.axis().dot(normal).abs() > FLAT;
    let (u, v) = solid.axis().any_orthonormal_pair();
    let around = solid.circles().flat_map(|(r, c)| [c + r * u, c - r * u, c + r * v, c - r * v]);
    let lowest = solid.rims(-normal);
    let points: Vec<DVec3> = if flat { around.chain(lowest).collect() } else { lowest.collect() };
    let contact = |(k, point): (usize, DVec3)| {
        let point_a = point - normal * solid.radius();
        let separation = normal.dot(point_a) - offset;
        (separation <= margin).then(|| Contact {
            id: (Feature::Vertex(VertexId(k as u32)), WHOLE_PRIMITIVE),
            point_a,
            point_b: point_a - normal * separation,
            normal: -normal,
            separation,
        })
    };
    reduce_contacts(points.into_iter().enumerate().filter_map(contact).collect())
}

/// parry's contacts of two solids.
fn of_manifolds(first: &Primitive, second: &Primitive, margin: f64) -> Vec<Contact> {
    let [(pose, g1), (other, g2)] = [first, second].map(placed);
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let asked = DefaultQueryDispatcher.contact_manifolds(
        &(pose.inverse() * other),
        &*g1,
        &*g2,
        margin,
        &mut manifolds,
        &mut None,
    );
    debug_assert!(asked.is_ok(), "parry has contacts of all these pairs");
    let of_manifold = manifolds.iter().flat_map(|manifold| {
        let normal = pose.rotation * manifold.local_n1;
        manifold.points.iter().map(move |point| (normal, point))
    });
    let near = of_manifold.filter(|(_, point)| point.dist <= margin).enumerate();
    near.map(|(k, (normal, point))| {
        let point_a = pose * point.local_p1;
        Contact {
            id: (WHOLE_PRIMITIVE, Feature::Vertex(VertexId(k as u32))),
            point_a,
            point_b: point_a + normal * point.dist,
            normal,
            separation: point.dist,
        }
    })
    .collect()
}

/// A signed distance: below 0 where the two overlap, along a direction that parts them.
struct Signed {
    distance: f64,
    points: [DVec3; 2],
    features: [Feature; 2],
}

impl Signed {
    fn found(self, within: f64) -> Found {
        let Self { distance, points, features } = self;
        if distance <= 0.0 {
            Found::Meeting
        } else if distance <= within {
            Found::Apart { distance, points, features }
        } else {
            Found::Farther
        }
    }

    fn swapped(self) -> Self {
        let (points, features) = (self.points, self.features);
        let (points, features) = ([points[1], points[0]], [features[1], features[0]]);
        Self { points, features, ..self }
    }
}

/// Two half-spaces meet unless they look away from each other.
fn of_half_spaces(a: &Plane, b: &Plane) -> Signed {
    let opposite = a.normal == -b.normal;
    let distance = if opposite { -b.offset - a.offset } else { f64::NEG_INFINITY };
    let points = [a.normal * a.offset, a.normal * -b.offset];
    Signed { distance, points, features: [WHOLE_PRIMITIVE; 2] }
}

/// A solid and the half-space beneath it.
fn over_plane(solid: &Revolved, &Plane { normal, offset }: &Plane) -> Signed {
    let lowest = solid.core_support(-normal) - normal * solid.radius();
    let distance = -solid.core_reach(-normal) - solid.radius() - offset;
    let points = [lowest, lowest - normal * distance];
    Signed { distance, points, features: [WHOLE_PRIMITIVE; 2] }
}

/// The axis and the radius of what is all within a distance of a segment.
fn axis_of(primitive: &Primitive) -> Option<([DVec3; 2], f64)> {
    match *primitive {
        Primitive::Ball(Ball { center, radius }) => Some(([center; 2], radius)),
        Primitive::Capsule(Capsule { ends, radius }) => Some((ends, radius)),
        Primitive::Segment(Segment { ends }) => Some((ends, 0.0)),
        Primitive::Cylinder(_) | Primitive::Cone(_) | Primitive::HalfSpace(_) => None,
    }
}

/// A solid and all within a radius of a segment.
fn along(solid: &Revolved, ends: [DVec3; 2], radius: f64) -> Signed {
    let least = solid.least_on_segment(ends);
    let on_axis = ends[0] + (ends[1] - ends[0]) * least.at;
    let way = least.foot.outward;
    let points = [least.foot.point + way * solid.radius(), on_axis - way * radius];
    let part = match least.at {
        0.0 => Feature::Vertex(VertexId(0)),
        1.0 => Feature::Vertex(VertexId(1)),
        _ => Feature::Edge(EdgeId(0)),
    };
    // A thin core has no inside, so that a foot of 0 is one that is met.
    let distance = least.foot.signed - solid.radius() - radius;
    Signed { distance, points, features: [WHOLE_PRIMITIVE, part] }
}

/// Two cylinders or cones.
fn searched(first: &Primitive, second: &Primitive, within: f64) -> Found {
    let [(pose, g1), (other, g2)] = [first, second].map(placed);
    let relative = pose.inverse() * other;
    match DefaultQueryDispatcher.closest_points(&relative, &*g1, &*g2, within) {
        Ok(ClosestPoints::Intersecting) | Err(_) => Found::Meeting,
        Ok(ClosestPoints::Disjoint) => Found::Farther,
        Ok(ClosestPoints::WithinMargin(p, q)) => {
            let points = [pose * p, other * q];
            let distance = points[0].distance(points[1]);
            Found::Apart { distance, points, features: [WHOLE_PRIMITIVE; 2] }
        }
    }
}

/// parry's shape, and where it stands: cylinders and cones stand along y.
pub(crate) fn placed(primitive: &Primitive) -> (ParryPose, SharedShape) {
    let at = |translation: DVec3| ParryPose { rotation: DQuat::IDENTITY, translation };
    let along = |axis: DVec3, translation: DVec3| {
        let rotation = DQuat::from_rotation_arc(DVec3::Y, axis.normalize_or(DVec3::Y));
        ParryPose { rotation, translation }
    };
    match *primitive {
        Primitive::Ball(Ball { center, radius }) => (at(center), SharedShape::ball(radius)),
        Primitive::Capsule(Capsule { ends: [a, b], radius }) => {
            (ParryPose::IDENTITY, SharedShape::capsule(a, b, radius))
        }
        Primitive::Segment(Segment { ends: [a, b] }) => {
            (ParryPose::IDENTITY, SharedShape::segment(a, b))
        }
        Primitive::Cylinder(Cylinder { center, axis, half_height, radius, border }) => {
            (along(axis, center), cylinder(half_height, radius, border))
        }
        Primitive::Cone(Cone { center, axis, half_height, radius, border }) => {
            (along(axis, center), cone(half_height, radius, border))
        }
        Primitive::HalfSpace(HalfSpace { point, normal }) => {
            (at(point), SharedShape::halfspace(normal.normalize_or(DVec3::Y)))
        }
    }
}

fn cylinder(half_height: f64, radius: f64, border: f64) -> SharedShape {
    if border == 0.0 {
        return SharedShape::cylinder(half_height, radius);
    }
    SharedShape::round_cylinder(half_height, radius, border)
}

fn cone(half_height: f64, radius: f64, border: f64) -> SharedShape {
    if border == 0.0 {
        return SharedShape::cone(half_height, radius);
    }
    SharedShape::round_cone(half_height, radius, border)
}
