//! More contacts along a direction in which a solid of revolution and a mesh touch: those that span
//! what they share.
//!
//! - points of the solid's rims, against what of the mesh lies opposite: of each rim the lowest
//!   one, and of a flat end that faces that way points all around;
//! - vertices of the mesh under a flat end, and where its edges pass under the rim of one.
//!
//! All are measured along the direction of the contact found, so none has a normal that no surface
//! has.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{EdgeId, FaceId, Model, VertexId};
use cranny_narrow_phase::{Contact, Feature};

use super::solid::Near;
use crate::normal_cone::is_least_within;
use crate::revolved::Revolved;

/// Points around a flat end. More: dearer; fewer: what stands askew sinks in between two of them,
/// by a share of 1 - cos(180 degrees / count) of what its rim is tilted by.
const AROUND: u32 = 8;

/// Cosine and sine of 45 degrees.
const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Cosine of the angle (45 degrees) up to which a flat end faces a direction.
const FACES: f64 = DIAGONAL;

/// Cosine of the angle (60 degrees) up to which a face faces back.
const FACES_BACK: f64 = 0.5;

/// Cosine of the angle (0.8 degrees) within which contacts have one direction.
const SAME_DIRECTION: f64 = 0.999_9;

/// Sine of the angle by which a direction may lean from those in which a vertex or an edge is the
/// nearest of what is around it. Larger: inner corners count; smaller: what stands on edges loses
/// corners as it rocks.
const SLACK: f64 = 0.1;

/// How far back along the direction the mesh is looked for, as a multiple of the overlap. Larger:
/// the far side of what is thin is taken for the near one; smaller: points deeper than the deepest
/// contact found are left out.
const BACK: f64 = 2.0;

/// A share of the solid's extent: contacts of one direction that are nearer to each other are one.
const SAME_PLACE: f64 = 1e-3;

/// A share of a triangle beyond its sides that still counts as its own, so that what lies over a
/// side is over one of two faces.
const OVER: f64 = 1e-9;

/// Contacts besides those given, along the directions of these.
pub(super) fn spread(
    model: &Model,
    solid: &Revolved,
    near: &Near,
    reach: f64,
    given: &[Contact],
) -> Vec<Contact> {
    let mut order: Vec<&Contact> = given.iter().collect();
    order.sort_by(|x, y| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id)));
    let mut directions: Vec<&Contact> = Vec::new();
    for contact in order {
        if directions.iter().all(|d| d.normal.dot(contact.normal) < SAME_DIRECTION) {
            directions.push(contact);
        }
    }
    let mut all: Vec<Contact> = given.to_vec();
    for deepest in directions {
        let along = Along {
            model,
            solid,
            normal: deepest.normal,
            back: BACK * (-deepest.separation).max(0.0) + OVER * solid.extent(),
            reach,
        };
        let found = along.rims().into_iter().chain(along.vertices(near)).chain(along.edges(near));
        for contact in found {
            let same = |c: &Contact| {
                c.normal.dot(contact.normal) > SAME_DIRECTION
                    && c.point_a.distance(contact.point_a) < SAME_PLACE * solid.extent()
            };
            if !all.iter().any(same) {
                all.push(contact);
            }
        }
    }
    all.split_off(given.len())
}

/// A direction in which mesh and solid touch.
struct Along<'a> {
    model: &'a Model,
    solid: &'a Revolved,
    /// From the mesh to the solid.
    normal: DVec3,
    /// Overlap at most.
    back: f64,
    /// Separation at most.
    reach: f64,
}

impl Along<'_> {
    /// The contact of a point of the mesh with one of the core, `height` above it.
    fn contact(&self, id: (Feature, Feature), on_mesh: DVec3, height: f64) -> Option<Contact> {
        let separation = height - self.solid.radius();
        (separation <= self.reach && separation >= -self.back).then(|| Contact {
            id,
            point_a: on_mesh,
            point_b: on_mesh + self.normal * separation,
            normal: self.normal,
            separation,
        })
    }

    /// The flat ends that face the mesh, numbered: outward normal, centre, radius.
    fn caps(&self) -> impl Iterator<Item = (u32, (DVec3, DVec3, f64))> + '_ {
        let caps = (0u32..).zip(self.solid.caps());
        caps.filter(|(_, (out, ..))| -out.dot(self.normal) > FACES)
    }

    fn rims(&self) -> Vec<Contact> {
        let lowest = (0u32..).zip(self.solid.rims(-self.normal));
        let around = self.caps().flat_map(|(cap, (out, center, radius))| {
            // Square to the axis, and the same whichever way the body is turned about it.
            let u = out.any_orthonormal_vector();
            let v = out.cross(u);
            (0..AROUND).map(move |k| {
                let (c, s) = eighth(k);
                (AROUND * (cap + 1) + k, center + (u * c + v * s) * radius)
            })
        });
        let points: Vec<(u32, DVec3)> = lowest.chain(around).collect();
        points.into_iter().filter_map(|(number, p)| self.below(number, p)).collect()
    }

    /// The contact of a point of the core with what of the mesh lies opposite.
    fn below(&self, number: u32, p: DVec3) -> Option<Contact> {
        let down = -self.normal;
        let far = self.reach + self.solid.radius();
        let start = p - down * (self.back - self.solid.radius()).max(0.0);
        let window = Aabb::of_points([start, p + down * far]).grown(OVER * self.solid.extent());
        let mut first: Option<(f64, FaceId)> = None;
        let mesh = self.model.mesh();
        self.model.tree().visit(
            |b| b.overlaps(&window),
            |face| {
                let facing = mesh.area_vector(face).normalize_or_zero().dot(self.normal);
                let closed = self.model.topology().in_closed_component(face);
                if facing < FACES_BACK && (closed || facing > -FACES_BACK) {
                    return;
                }
                if let Some(height) = height_above(p, self.normal, &mesh.triangle(face)) {
                    let before = first.is_none_or(|(least, _)| height < least);
                    if before && height - self.solid.radius() >= -self.back {
                        first = Some((height, face));
                    }
                }
            },
        );
        let (height, face) = first?;
        let id = (Feature::Face(face), Feature::Vertex(VertexId(number)));
        self.contact(id, p + down * height, height)
    }

    fn vertices(&self, near: &Near) -> Vec<Contact> {
        let under = |(cap, (out, center, radius)): (u32, (DVec3, DVec3, f64))| {
            near.vertices.iter().filter_map(move |&v| {
                let p = self.model.mesh().position(v);
                let height = out.dot(center - p) / out.dot(self.normal);
                let on_cap = p + self.normal * height;
                let feature = Feature::Vertex(v);
                if on_cap.distance(center) > radius || !self.is_outer(feature) {
                    return None;
                }
                self.contact((feature, Feature::Face(FaceId(1 + cap))), p, height)
            })
        };
        self.caps().flat_map(under).collect()
    }

    /// Where edges pass under the rim of a flat end.
    fn edges(&self, near: &Near) -> Vec<Contact> {
        let edges = self.model.topology().edges();
        let under = |(cap, (out, center, radius)): (u32, (DVec3, DVec3, f64))| {
            near.edges.iter().flat_map(move |&e| {
                let [a, b] = [edges[e.index()].from, edges[e.index()].to]
                    .map(|v| self.model.mesh().position(v));
                // Seen along the direction, on the plane of the flat end.
                let slope = 1.0 / out.dot(self.normal);
                let height = move |p: DVec3| out.dot(center - p) * slope;
                let seen = move |p: DVec3| p + self.normal * height(p) - center;
                let crossings = crossings(seen(a), seen(b), radius);
                let outer =
                    crossings.iter().any(Option::is_some) && self.is_outer(Feature::Edge(e));
                crossings.into_iter().enumerate().filter_map(move |(i, s)| {
                    let p = a + (b - a) * s.filter(|_| outer)?;
                    let own = Feature::Edge(EdgeId(2 * cap + i as u32));
                    self.contact((Feature::Edge(e), own), p, height(p))
                })
            })
        };
        self.caps().flat_map(under).collect()
    }

    fn is_outer(&self, feature: Feature) -> bool {
        is_least_within(self.model, feature, self.normal, SLACK)
    }
}

/// Cosine and sine of so many times 45 degrees.
fn eighth(k: u32) -> (f64, f64) {
    let (c, s) = [(1.0, 0.0), (DIAGONAL, DIAGONAL)][(k % 2) as usize];
    match k / 2 % 4 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

/// How far along a direction a point is above a triangle, if it is.
fn height_above(p: DVec3, up: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
    let normal = (*b - *a).cross(*c - *a);
    let (slope, size) = (normal.dot(up), normal.length_squared());
    if size <= 0.0 || slope.abs() <= OVER * size.sqrt() {
        return None;
    }
    let height = normal.dot(p - *a) / slope;
    let foot = p - up * height;
    let inside =
        |from: DVec3, to: DVec3| (to - from).cross(foot - from).dot(normal) >= -OVER * size;
    (inside(*a, *b) && inside(*b, *c) && inside(*c, *a)).then_some(height)
}

/// Where a segment crosses a sphere's surface around the origin, between its ends.
fn crossings(a: DVec3, b: DVec3, radius: f64) -> [Option<f64>; 2] {
    let along = b - a;
    let square = along.length_squared();
    let middle = -a.dot(along) / square;
    let half = (radius * radius - (a + along * middle).length_squared()) / square;
    if square <= 0.0 || half < 0.0 {
        return [None; 2];
    }
    [middle - half.sqrt(), middle + half.sqrt()].map(|s| (s > 0.0 && s < 1.0).then_some(s))
}
