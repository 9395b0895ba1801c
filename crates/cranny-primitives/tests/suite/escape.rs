//! Ways apart: afterwards the two share no interior, and shallow ones are as short as they can be.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_primitives::way_apart;
use cranny_shapes::{Cup, Hook, Torus};
use cranny_testkit::Rng;

use crate::{built, cuboid};

fn regions(a: Placed<'_>, b: Placed<'_>) -> cranny_narrow_phase::Answer {
    let ask = Query::of(Demand::Regions { margin: 0.0 });
    query(a, b, &ask, &mut PairMemory::default()).unwrap()
}

fn placed(model: &Model, at: DVec3) -> Placed<'_> {
    Placed { model, pose: Pose::at(at) }
}

fn way(a: Placed<'_>, b: Placed<'_>) -> Option<DVec3> {
    way_apart(a, b, &regions(a, b)).unwrap()
}

#[test]
fn a_box_goes_back_where_it_came_in() {
    let (large, small) = (cuboid([4.0, 4.0, 1.0]), cuboid([1.0; 3]));
    let floor = placed(&large, DVec3::ZERO);
    let out = way(floor, placed(&small, DVec3::new(0.3, 0.2, 0.875))).unwrap();
    assert!((out - DVec3::new(0.0, 0.0, 0.125)).length() < 1e-6, "{out}");
    // The other of the two, by the negative.
    let out = way(placed(&small, DVec3::new(0.3, 0.2, 0.875)), floor).unwrap();
    assert!((out + DVec3::new(0.0, 0.0, 0.125)).length() < 1e-6, "{out}");
    // Touching is not overlapping.
    assert_eq!(way(floor, placed(&small, DVec3::new(0.3, 0.2, 1.0))), None);
    assert_eq!(way(floor, placed(&small, DVec3::new(0.3, 0.2, 1.5))), None);
}

#[test]
fn what_lies_wholly_inside_comes_out_by_the_nearest_side() {
    let (large, small) = (cuboid([8.0; 3]), cuboid([1.0; 3]));
    let inside = placed(&small, DVec3::new(3.0, 0.5, -1.0));
    let out = way(placed(&large, DVec3::ZERO), inside).unwrap();
    assert!((out - DVec3::new(1.5, 0.0, 0.0)).length() < 1e-6, "{out}");
    let out = way(inside, placed(&large, DVec3::ZERO)).unwrap();
    assert!((out + DVec3::new(1.5, 0.0, 0.0)).length() < 1e-6, "{out}");
}

/// Rings, hooks and cups in each other in all ways.
#[test]
fn whatever_the_overlap_the_way_ends_it() {
    let models = [
        built(Hook::default().build().unwrap()),
        built(Torus::default().build().unwrap()),
        built(Cup::default().build().unwrap()),
        cuboid([0.6, 1.5, 0.4]),
    ];
    let mut rng = Rng::new(7);
    let mut overlaps = 0;
    for i in 0..300 {
        let [a, b] = [&models[i % 4], &models[i / 4 % 4]];
        let reach = 0.7 * (a.radius() + b.radius());
        let offset = DVec3::from_array([(); 3].map(|()| reach * rng.unit()));
        let a = Placed { model: a, pose: Pose { rotation: rng.rotation(), ..Pose::IDENTITY } };
        let b = Placed { model: b, pose: Pose { rotation: rng.rotation(), translation: offset } };
        let found = regions(a, b);
        let way = way_apart(a, b, &found).unwrap();
        assert_eq!(way.is_some(), found.solid, "case {i}");
        let Some(way) = way else { continue };
        overlaps += 1;
        let pose = Pose { translation: b.pose.translation + way, ..b.pose };
        let after = regions(a, Placed { pose, ..b });
        assert!(!after.solid, "case {i}: {way} leaves them in each other");
        assert!(way.length() <= 2.0 * (a.model.radius() + b.model.radius()), "case {i}: {way}");
    }
    assert!(overlaps > 100, "{overlaps}");
}
