//! Which stationary bodies stand between the eye and what moves, and which marks lie behind
//! surfaces.

use cranny_exact::{DVec3, Pose, RigidMap};
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

/// What an eye sees of a moment.
pub(super) struct Sight<'a> {
    eye: DVec3,
    /// So far before a point what stands there does not hide it.
    slack: f64,
    bodies: Vec<Screen<'a>>,
}

/// A body that lines of sight may meet.
struct Screen<'a> {
    model: &'a Model,
    body_from_world: RigidMap,
    /// Of a ball around it, in world coordinates.
    center: DVec3,
    radius: f64,
}

impl<'a> Sight<'a> {
    /// From a camera, of all that is drawn; `slack` is a length in which a mark still counts as on
    /// the surface that it touches.
    pub(super) fn of(coats: &'a Coats, moment: &Moment, eye: DVec3, slack: f64) -> Self {
        let placed = coats.iter().filter_map(|(id, coat)| Some((coat, moment.poses.get(&id)?)));
        let bodies = placed.filter_map(|(coat, pose)| {
            let (model, bounds) = (coat.seen()?, coat.bounds(pose));
            Some(Screen {
                model,
                body_from_world: pose.world_from_body().inverse(),
                center: bounds.center(),
                radius: 0.5 * bounds.diagonal(),
            })
        });
        Self { eye, slack, bodies: bodies.collect() }
    }

    /// Whether a surface stands before a point.
    pub(super) fn hides(&self, point: DVec3) -> bool {
        let way = point - self.eye;
        let length = way.length() - self.slack;
        let along = way.normalize_or_zero();
        self.bodies.iter().any(|body| {
            let from = body.center - self.eye;
            let nearest = from.dot(along).clamp(0.0, length.max(0.0)) * along;
            // No line of sight is no ray.
            nearest.distance(from) <= body.radius
                && cast_ray(
                    body.model,
                    body.body_from_world.apply(self.eye),
                    body.body_from_world.apply_vector(along),
                    length,
                )
                .is_ok_and(|hit| hit.is_some())
        })
    }
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
    fn what_is_inside_or_behind_is_hidden_and_what_lies_on_the_near_side_is_not() {
        let cube = Cuboid { size: [2.0; 3] }.build().unwrap();
        let (cube, _) = Model::build(cube, &BuildOptions::default()).unwrap();
        let at = DVec3::X * 10.0;
        let obstacle = Screen {
            model: &cube,
            body_from_world: Pose::at(at).world_from_body().inverse(),
            center: at,
            radius: 2.0,
        };
        let eye = at + DVec3::Z * 9.0;
        let sight = Sight { eye, slack: 0.1, bodies: vec![obstacle] };
        let hides = |x: f64, z: f64| sight.hides(at + DVec3::new(x, 0.0, z));
        assert!(hides(0.0, -9.0) && hides(0.0, 0.0), "behind it, and inside");
        assert!(!hides(0.0, 0.95) && !hides(0.0, 1.0) && !hides(0.0, 2.0), "as good as on it");
        assert!(!hides(4.0, -9.0) && !hides(0.0, 20.0), "beside it, and behind the eye");
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
