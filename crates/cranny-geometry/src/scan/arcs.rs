//! Where faces lie, seen from a point or along a line: boxes around arcs of directions.
//!
//! Two triangles with a common corner meet elsewhere only along rays from it, so what they cut out
//! of the unit sphere about it overlaps. Two triangles, a corner of each on one line, meet off that
//! line only where the directions from it overlap. Boxes around such arcs part faces whose own
//! boxes all overlap, those of a cone.
//!
//! No source: this crate's own, argued above. Cost: O(1) a face.

use cranny_exact::{Aabb, DVec3};

use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;

/// The directions of points nearer the line than this share of their distance from its foot are not
/// read. Smaller, and rounding turns them by more than [`TURNED`]; larger, and faces that end near
/// the line are paired with all others.
const NEAR_LINE: f64 = 1.0 / (1 << 20) as f64;

/// What rounding turns directions by, at most, beyond [`NEAR_LINE`]: some 32 epsilons over that
/// share.
const TURNED: f64 = 64.0 * f64::EPSILON / NEAR_LINE;

/// A box around the arc of the unit sphere that a face cuts out about one of its corners; none for
/// a face that ends there.
pub(super) fn about_point(mesh: &Mesh, vertex: VertexId, face: FaceId) -> Option<Aabb> {
    let middle = mesh.position(vertex);
    let [p, q] = others(mesh, vertex, face)?.map(|p| p - middle);
    if p == DVec3::ZERO || q == DVec3::ZERO {
        return None;
    }
    Some(around(p / p.length(), q / q.length(), 16.0 * f64::EPSILON))
}

/// A line through two vertices, as something to look along.
pub(super) struct Line {
    from: DVec3,
    /// Three directions square to each other, the last one along the line; each about 1 long.
    frame: [DVec3; 3],
    length: f64,
}

impl Line {
    /// Between two places that are not one.
    pub(super) fn through(from: DVec3, to: DVec3) -> Self {
        let length = (to - from).length();
        let along = (to - from) / length;
        let across = along.any_orthonormal_vector();
        Self { from, frame: [across, along.cross(across), along], length }
    }

    /// A box around a face with a corner on the line: its arc of directions from the line, and how
    /// far it reaches along the line. All directions where the face may meet the line in more than
    /// the corner. Two faces with corners in different places of the line do not meet where these
    /// boxes do not.
    pub(super) fn about(&self, mesh: &Mesh, vertex: VertexId, face: FaceId) -> Option<Aabb> {
        let corner = mesh.position(vertex);
        let [across, up, along] = self.frame;
        let ends = others(mesh, vertex, face)?.map(|p| p - corner);
        let direction = |p: DVec3| {
            let seen = DVec3::new(p.dot(across), p.dot(up), 0.0);
            let distance = seen.length();
            (distance > NEAR_LINE * p.length()).then(|| seen / distance)
        };
        let mut bounds = match ends.map(direction) {
            [Some(p), Some(q)] => around(p, q, TURNED),
            _ => Aabb { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) }, // around all directions
        };
        let places =
            [corner, corner + ends[0], corner + ends[1]].map(|p| (p - self.from).dot(along));
        let reach = places
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
        let far = ends.iter().fold((corner - self.from).length(), |far, p| far + p.length());
        let slack = 32.0 * f64::EPSILON * far;
        bounds.min.z = (reach.0 - slack) / self.length;
        bounds.max.z = (reach.1 + slack) / self.length;
        Some(bounds)
    }
}

/// The other corners of a face.
fn others(mesh: &Mesh, vertex: VertexId, face: FaceId) -> Option<[DVec3; 2]> {
    let corners = mesh.corners(face);
    let at = corners.iter().position(|&v| v == vertex)?;
    Some([1, 2].map(|i| mesh.position(corners[(at + i) % 3])))
}

/// A box around the shorter arc between two directions.
///
/// An arc of angle a rises 1 − cos(a/2) above its chord, and that is no more than sin²(a/2), a
/// quarter of the chord's square.
fn around(p: DVec3, q: DVec3, slack: f64) -> Aabb {
    Aabb::of_points([p, q]).grown(0.25 * p.distance_squared(q) + slack)
}
