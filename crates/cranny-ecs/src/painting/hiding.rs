//! Which stationary bodies stand between the eye and what moves.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;
use cranny_primitives::cast_ray;
use cranny_world::BodyId;

use super::Moment;
use super::coats::Coats;

/// Points of a moving body that are looked for. Fewer: a corner decides; more: nothing changes but
/// the time.
const LOOKED_FOR: usize = 16;

/// A body hides another when more than this share of those points lies behind it. Smaller: a bolt
/// fades because it hides its nut's far side; larger: walls stay in the way.
const HIDDEN: f64 = 0.55;

/// Stationary bodies that alone hide most of some moving body from `eye`. What collides of a body
/// stands for what is drawn of it.
pub(super) fn of(coats: &Coats, moment: &Moment, eye: DVec3) -> Vec<BodyId> {
    let posed = |moves: bool| {
        let all = coats.iter().filter(move |(_, coat)| coat.moves() == moves);
        all.filter_map(|(id, coat)| Some((id, coat.seen()?, moment.poses.get(&id)?)))
    };
    let sought: Vec<Vec<DVec3>> = posed(true).map(|(_, model, pose)| points(model, pose)).collect();
    let stands_before = |model: &Model, pose: &Pose| {
        sought.iter().any(|points| {
            let hidden = points.iter().filter(|&&p| hides(model, pose, eye, p)).count();
            hidden as f64 > HIDDEN * points.len() as f64
        })
    };
    posed(false).filter(|(_, model, pose)| stands_before(model, pose)).map(|(id, ..)| id).collect()
}

/// The farthest vertices of what collides in directions all around: what of a body is seen from
/// outside.
fn points(model: &Model, pose: &Pose) -> Vec<DVec3> {
    let map = pose.world_from_body();
    let farthest = |i: usize| {
        let top = model.hull().support(direction(i), None)?;
        Some(map.apply(model.hull().position(top)))
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

/// How near its end a line of sight may meet a face without being hidden by it, in parts of its
/// length: what rests on a floor is seen.
const BEFORE_THE_END: f64 = 0.999;

/// Whether a body stands between an eye and a point.
fn hides(model: &Model, pose: &Pose, eye: DVec3, point: DVec3) -> bool {
    let map = pose.world_from_body().inverse();
    let (eye, point) = (map.apply(eye), map.apply(point));
    let way = point - eye;
    // No line of sight is no ray.
    cast_ray(model, eye, way, BEFORE_THE_END * way.length()).is_ok_and(|hit| hit.is_some())
}

#[cfg(test)]
mod tests {
    use cranny_geometry::BuildOptions;
    use cranny_shapes::Cuboid;

    use super::*;

    #[test]
    fn a_body_hides_what_is_behind_it_and_not_what_lies_on_it() {
        let cube = Cuboid { size: [2.0; 3] }.build().unwrap();
        let (cube, _) = Model::build(cube, &BuildOptions::default()).unwrap();
        let pose = Pose::at(DVec3::X * 10.0);
        let eye = DVec3::new(10.0, 0.0, 9.0);
        let hides = |x: f64, z: f64| hides(&cube, &pose, eye, DVec3::new(x, 0.0, z));
        assert!(hides(10.0, -9.0) && hides(10.0, 0.0), "behind it, and inside");
        assert!(!hides(10.0, 1.0) && !hides(10.0, 2.0), "on it, and before it");
        assert!(!hides(14.0, -9.0), "beside it");
    }

    #[test]
    fn a_body_is_sought_by_its_farthest_points() {
        let cube = Cuboid { size: [2.0; 3] }.build().unwrap();
        let (cube, _) = Model::build(cube, &BuildOptions::default()).unwrap();
        let found = points(&cube, &Pose::at(DVec3::Y * 5.0));
        assert_eq!(found.len(), LOOKED_FOR);
        let corners = |p: &DVec3| (*p - DVec3::Y * 5.0).abs() == DVec3::ONE;
        assert!(found.iter().all(corners) && found.iter().any(|p| p.y > 5.0 && p.z < 0.0));
    }
}
