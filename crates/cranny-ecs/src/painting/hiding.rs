//! Which stationary bodies stand between the eye and what moves.

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_world::BodyId;

use super::Moment;
use super::coats::{Coat, Coats};

/// Points of a moving body that are looked for. Fewer: a corner decides; more: nothing changes but
/// the time.
const LOOKED_FOR: usize = 16;

/// A body hides another when more than this share of those points lies behind it. Smaller: a bolt
/// fades because it hides its nut's far side; larger: walls stay in the way.
const HIDDEN: f64 = 0.55;

/// Stationary bodies of which one alone hides most of some moving body from `eye`.
pub(super) fn of(coats: &Coats, moment: &Moment, eye: DVec3) -> Vec<BodyId> {
    let posed = |moves: bool| {
        let all = coats.iter().filter(move |(_, coat)| coat.moves() == moves);
        all.filter_map(|(id, coat)| Some((id, coat, moment.poses.get(&id)?)))
    };
    let sought: Vec<Vec<DVec3>> = posed(true).map(|(_, coat, pose)| points(coat, pose)).collect();
    let stands_before = |coat: &Coat, pose: &Pose| {
        let bounds = coat.bounds(pose);
        let blind = Blind { coat, pose, bounds, eye };
        sought.iter().any(|points| {
            let hidden = points.iter().filter(|&&p| blind.hides(p)).count();
            hidden as f64 > HIDDEN * points.len() as f64
        })
    };
    posed(false).filter(|(_, coat, pose)| stands_before(coat, pose)).map(|(id, ..)| id).collect()
}

/// The farthest vertices in directions all around: what of a body is seen from outside.
fn points(coat: &Coat, pose: &Pose) -> Vec<DVec3> {
    let map = pose.world_from_body();
    let vertices = coat.of.mesh().vertices();
    let farthest = |i: usize| {
        let direction = direction(i);
        let along = |p: &DVec3| p.dot(direction);
        vertices.iter().max_by(|a, b| along(a).total_cmp(&along(b))).map(|&p| map.apply(p))
    };
    (0..LOOKED_FOR).filter_map(farthest).collect()
}

/// Evenly spread over the sphere, along a spiral.
fn direction(i: usize) -> DVec3 {
    let z = 1.0 - (2 * i + 1) as f64 / LOOKED_FOR as f64;
    let angle = i as f64 * std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * angle.cos(), r * angle.sin(), z)
}

/// A stationary body, and who looks.
struct Blind<'a> {
    coat: &'a Coat,
    pose: &'a Pose,
    bounds: Aabb,
    eye: DVec3,
}

impl Blind<'_> {
    fn hides(&self, point: DVec3) -> bool {
        if !passes_box(&self.bounds, self.eye, point) {
            return false;
        }
        let map = self.pose.world_from_body().inverse();
        let (eye, point) = (map.apply(self.eye), map.apply(point));
        let mesh = self.coat.of.mesh();
        let corner = |i: u32| mesh.vertices()[i as usize];
        mesh.faces().iter().any(|face| meets(face.map(corner), eye, point))
    }
}

/// Whether a segment passes through a box.
fn passes_box(bounds: &Aabb, from: DVec3, to: DVec3) -> bool {
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (start, along) = (from[axis], to[axis] - from[axis]);
        let [a, b] = [bounds.min[axis], bounds.max[axis]].map(|side| (side - start) / along);
        if along == 0.0 {
            if start < bounds.min[axis] || start > bounds.max[axis] {
                return false;
            }
            continue;
        }
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    enters <= leaves
}

/// How near its end a segment may meet a face without being hidden by it, in parts of its length:
/// what rests on a floor is seen.
const BEFORE_THE_END: f64 = 0.999;

/// Whether a segment meets a triangle before its end (Möller and Trumbore 1997). For the eye: what
/// rounds does not matter.
fn meets([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let along = to - from;
    let (u, v) = (b - a, c - a);
    let p = along.cross(v);
    let determinant = u.dot(p);
    if determinant == 0.0 {
        return false;
    }
    let t = from - a;
    let first = t.dot(p) / determinant;
    let q = t.cross(u);
    let second = along.dot(q) / determinant;
    let at = v.dot(q) / determinant;
    first >= 0.0 && second >= 0.0 && first + second <= 1.0 && at > 0.0 && at < BEFORE_THE_END
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_meets_a_triangle_between_its_ends_only() {
        let face = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let inside = DVec3::new(0.2, 0.2, 0.0);
        assert!(meets(face, inside + DVec3::Z, inside - DVec3::Z));
        assert!(!meets(face, inside + DVec3::Z, inside + 0.1 * DVec3::Z));
        assert!(!meets(face, inside + DVec3::Z, inside), "it ends on it");
        let beside = DVec3::new(0.7, 0.7, 0.0);
        assert!(!meets(face, beside + DVec3::Z, beside - DVec3::Z));
    }

    #[test]
    fn a_segment_passes_a_box_or_does_not() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let high = DVec3::new(0.5, 0.5, 3.0);
        assert!(passes_box(&bounds, high, DVec3::new(0.5, 0.5, -1.0)));
        assert!(!passes_box(&bounds, high, DVec3::new(0.5, 0.5, 2.0)));
        assert!(!passes_box(&bounds, high, DVec3::new(3.0, 0.5, 0.9)));
        assert!(!passes_box(&bounds, DVec3::new(2.0, 0.5, 0.5), DVec3::new(2.0, 0.6, 0.5)));
    }
}
