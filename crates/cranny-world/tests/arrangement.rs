//! Lists of poses, against a query of every pair.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{Cuboid, Shape, Torus};
use cranny_world::{Arrangement, ArrangementError, NearestPair, Wanted};

fn model(shape: impl Into<Shape>) -> Model {
    Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
}

/// Three rings, a small cube, and a large cube that may hold them; one place has no geometry.
fn parts() -> Vec<Option<Model>> {
    let ring = model(Torus { major_radius: 0.5, minor_radius: 0.1, ..Torus::default() });
    let [small, large] = [0.2, 1.5].map(|size| model(Cuboid { size: [size; 3] }));
    vec![Some(ring.clone()), Some(small), None, Some(ring.clone()), Some(large), Some(ring)]
}

fn poses(k: u32) -> Vec<Pose> {
    let wave = |i: usize, j: u32| (0.37 * f64::from(k) + 2.1 * i as f64 + 1.3 * f64::from(j)).sin();
    let pose = |i: usize| Pose {
        rotation: DQuat::from_scaled_axis(DVec3::new(wave(i, 0), wave(i, 1), wave(i, 2))),
        // They come together and part again.
        translation: (0.8 + 0.7 * (0.11 * f64::from(k)).sin())
            * DVec3::new(wave(i, 3) + 0.4 * i as f64, wave(i, 4), wave(i, 5)),
    };
    (0..6).map(pose).collect()
}

fn all_pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|b| (0..b).map(move |a| (a, b)))
}

/// Every pair, one by one.
fn expected(models: &[Option<Model>], poses: &[Pose]) -> (Vec<(usize, usize)>, NearestPair) {
    let mut meeting = Vec::new();
    let mut nearest: Option<NearestPair> = None;
    for (a, b) in all_pairs() {
        let (Some(of_a), Some(of_b)) = (&models[a], &models[b]) else { continue };
        let placed =
            [Placed { model: of_a, pose: poses[a] }, Placed { model: of_b, pose: poses[b] }];
        let ask = Query::of(Demand::Distance { below: None });
        let answer = query(placed[0], placed[1], &ask, &mut PairMemory::default()).unwrap();
        let distance = if answer.touches() { 0.0 } else { answer.distance.unwrap() };
        if answer.touches() {
            meeting.push((a, b));
        }
        if nearest.is_none_or(|nearest| distance < nearest.distance) {
            nearest = Some(NearestPair { pair: (a, b), distance });
        }
    }
    (meeting, nearest.unwrap())
}

#[test]
fn what_meets_and_what_is_nearest_is_what_a_query_of_every_pair_says() {
    let models = parts();
    let mut arrangement = Arrangement::new(models.clone(), all_pairs());
    assert_eq!(arrangement.pairs().len(), 10);
    let (mut met, mut apart) = (0, 0);
    for k in 0..60 {
        let poses = poses(k);
        let (meeting, nearest) = expected(&models, &poses);
        let found = arrangement.at(&poses, Wanted::Nearest).unwrap();
        assert_eq!(found.meeting, meeting, "{k}");
        assert_eq!(found.nearest, Some(nearest), "{k}");
        let found = arrangement.at(&poses, Wanted::Meeting).unwrap();
        assert_eq!((found.meeting, found.nearest), (meeting.clone(), None), "{k}");
        if meeting.is_empty() { apart += 1 } else { met += 1 }
    }
    assert!(met > 10 && apart > 10, "{met} met, {apart} apart");
}

#[test]
fn of_pairs_that_are_equally_near_the_first_is_named() {
    let cube = model(Cuboid { size: [1.0; 3] });
    let models = vec![Some(cube.clone()), Some(cube.clone()), Some(cube)];
    let mut arrangement = Arrangement::new(models, [(0, 1), (1, 2), (0, 2)]);
    let row = |gaps: [f64; 2]| {
        let x = [0.0, 1.0 + gaps[0], 2.0 + gaps[0] + gaps[1]];
        x.map(|x| Pose::at(DVec3::X * x))
    };
    let mut nearest = |gaps| arrangement.at(&row(gaps), Wanted::Nearest).unwrap().nearest;
    let named = |pair, distance| Some(NearestPair { pair, distance });
    assert_eq!(nearest([0.5, 0.25]), named((1, 2), 0.25));
    // The second was nearest before.
    assert_eq!(nearest([0.5, 0.5]), named((0, 1), 0.5));
    assert_eq!(nearest([0.0, 0.5]), named((0, 1), 0.0), "touching");
}

#[test]
fn without_pairs_nothing_is_nearest_and_poses_are_counted() {
    let cube = model(Cuboid { size: [1.0; 3] });
    let mut arrangement = Arrangement::new(vec![Some(cube), None], [(0, 1), (0, 7)]);
    assert_eq!(arrangement.pairs().len(), 0);
    let found = arrangement.at(&[Pose::IDENTITY; 2], Wanted::Nearest).unwrap();
    assert!(found.meeting.is_empty() && found.nearest.is_none());
    let error = arrangement.at(&[Pose::IDENTITY], Wanted::Meeting).unwrap_err();
    assert_eq!(error, ArrangementError::Poses { shapes: 2, poses: 1 });
    assert!(error.to_string().contains("1 poses for 2 shapes"));
    let nowhere = Pose::at(DVec3::splat(f64::NAN));
    let half = Pose { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.5), ..Pose::IDENTITY };
    for none in [nowhere, half] {
        let error = arrangement.at(&[none, Pose::IDENTITY], Wanted::Meeting).unwrap_err();
        assert!(matches!(error, ArrangementError::Pose { shape: 0, .. }), "{error}");
    }
    assert!(arrangement.at(&[Pose::IDENTITY, nowhere], Wanted::Meeting).is_ok(), "not read");
}
