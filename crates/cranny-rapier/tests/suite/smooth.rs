//! Smooth normals: what a solver gets, and nobody else.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_rapier::{
    BodyKind, BodySpec, MeshShape, Normals, ShapeError, Simulation, SimulationError,
    SimulationOptions, dispatcher, pose_to_rapier, wide,
};
use cranny_shapes::GolfBall;
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::Real;
use rapier3d::parry::query::{PersistentQueryDispatcher, QueryDispatcher};
use rapier3d::parry::shape::{Compound, Shape, SharedShape};

use crate::world::{cuboid, model, spec};

type Manifold = rapier3d::parry::query::ContactManifold<ContactManifoldData, ContactData>;

fn manifolds(pose: &Pose, a: &dyn Shape, b: &dyn Shape) -> Vec<Manifold> {
    let (mut found, mut workspace) = (Vec::new(), None);
    dispatcher()
        .contact_manifolds(&pose_to_rapier(pose), a, b, 0.05, &mut found, &mut workspace)
        .expect("ours answers");
    found
}

/// Normals and distances by their points on the first shape.
fn points(manifolds: &[Manifold]) -> Vec<(DVec3, Real, DVec3)> {
    let reported = manifolds.iter().flat_map(|manifold| {
        let normal = wide(manifold.local_n1);
        manifold.points.iter().map(move |p| (wide(p.local_p1), p.dist, normal))
    });
    let mut all: Vec<_> = reported.collect();
    all.sort_by(|x, y| x.0.to_array().partial_cmp(&y.0.to_array()).expect("numbers"));
    all
}

/// Balls of radius 1 and 320 faces that just touch: facets lean by up to 0.17.
fn balls() -> [MeshShape; 2] {
    let ball = model(GolfBall { dimples: 0, triangles: 320, ..GolfBall::default() });
    let flat = MeshShape::new(&ball, 0).expect("parry takes it");
    [flat.clone(), flat.with_smooth_normals(0.5).expect("an angle")]
}

fn touching(k: u32) -> Pose {
    let turn = |axis: DVec3| DQuat::from_scaled_axis(axis * f64::from(k));
    let along = turn(DVec3::new(0.7, 0.3, 0.5)) * DVec3::X;
    Pose { rotation: turn(DVec3::new(-0.2, 0.9, 0.4)), translation: 2.0 * along }
}

#[test]
fn a_solver_gets_the_curved_surfaces_normals_at_the_same_points() {
    let [flat, smooth] = balls();
    let [mut flat_worst, mut told_worst] = [0.0f64; 2];
    for k in 0..40 {
        let pose = touching(k);
        let along = pose.translation.normalize();
        let own = points(&manifolds(&pose, &flat, &flat));
        let reported = points(&manifolds(&pose, &smooth, &smooth));
        assert!(own.len() == reported.len() && !own.is_empty());
        for (own, reported) in own.iter().zip(&reported) {
            assert_eq!((own.0, own.1), (reported.0, reported.1));
        }
        let nearest = |all: &[(DVec3, Real, DVec3)]| {
            let first = all.iter().min_by(|x, y| x.1.total_cmp(&y.1)).expect("one");
            first.2.angle_between(along)
        };
        flat_worst = flat_worst.max(nearest(&own));
        told_worst = told_worst.max(nearest(&reported));
        // As a part of a compound it is as smooth.
        let whole: SharedShape = SharedShape::new(smooth.clone());
        let compound = Compound::new(vec![(Default::default(), whole)]);
        assert_eq!(points(&manifolds(&pose, &compound, &smooth)), reported);
    }
    assert!(flat_worst > 0.05 && told_worst < 0.4 * flat_worst, "{told_worst} {flat_worst}");
}

#[test]
fn all_other_answers_are_those_of_the_mesh() {
    let [flat, smooth] = balls();
    for k in 0..20 {
        let pose = pose_to_rapier(&touching(k));
        let ask = |shape: &MeshShape| dispatcher().contact(&pose, shape, shape, 0.05);
        let [own, reported] =
            [&flat, &smooth].map(|shape| ask(shape).expect("ours").expect("near"));
        assert_eq!(
            (own.normal1, own.dist, own.point1),
            (reported.normal1, reported.dist, reported.point1)
        );
        let apart = |shape: &MeshShape| dispatcher().distance(&pose, shape, shape);
        let [own, reported] = [&flat, &smooth].map(|shape| apart(shape).expect("ours").distance);
        assert_eq!(own, reported);
    }
}

#[test]
fn a_crease_angle_that_is_none_is_refused() {
    let cube = cuboid(1.0, 1.0, 1.0);
    let refused = MeshShape::new(&cube, 0).expect("parry takes it").with_smooth_normals(4.0);
    assert!(matches!(refused, Err(ShapeError::Crease(_))));
    let mut simulation = Simulation::new(SimulationOptions::default());
    let normals = Normals::Smooth { crease_angle: f64::NAN };
    let body = BodySpec { normals, ..spec(&cube, BodyKind::Fixed, DVec3::ZERO) };
    let refused = simulation.insert(&body);
    assert!(matches!(refused, Err(SimulationError::Shape(ShapeError::Crease(_)))));
}
