//! Rounded models and the way out of deep overlaps, by hand.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_primitives::deep::{deep, thickness, way_out};
use cranny_primitives::{Rounded, Separation, rounded_contacts, rounded_separation};

use crate::cuboid;

/// Unit cubes with borders of 0.125 and 0.25 above each other: the gap between the cubes less both.
#[test]
fn rounded_cubes_are_nearer_by_their_borders() {
    let lower = Rounded { model: cuboid([1.0; 3]), radius: 0.125 };
    let upper = Rounded { model: cuboid([1.0; 3]), radius: 0.25 };
    let mut memory = PairMemory::default();
    for gap in [0.125, 0.0, -0.0625] {
        let pose = Pose::at(DVec3::Z * (1.0 + 0.375 + gap));
        let found = rounded_contacts([&lower, &upper], &pose, 0.25, &mut memory).expect("a pose");
        assert!(found.len() >= 3, "{gap}: {found:?}");
        for contact in found {
            assert!((contact.separation - gap).abs() < 1e-12, "{contact:?}");
            assert_eq!((contact.normal, contact.point_a.z), (DVec3::Z, 0.625));
        }
        let apart = rounded_separation([&lower, &upper], &pose, 0.25, &mut memory).expect("a pose");
        match apart {
            Separation::Apart { distance, witnesses: [a, b] } => {
                assert!(gap > 0.0 && (distance - gap).abs() < 1e-12, "{distance}");
                assert!((b - a - DVec3::Z * gap).length() < 1e-12, "{a}, {b}");
            }
            other => assert_eq!((other, gap <= 0.0), (Separation::Meeting, true)),
        }
    }
    let far = Pose::at(DVec3::Z * 3.0);
    let found = rounded_separation([&lower, &upper], &far, 0.25, &mut memory);
    assert_eq!(found.expect("a pose"), Separation::Farther);
    let broken = Pose::at(DVec3::new(f64::NAN, 0.0, 0.0));
    assert!(rounded_separation([&lower, &upper], &broken, 0.25, &mut memory).is_err());
    assert!(rounded_contacts([&lower, &upper], &broken, 0.25, &mut memory).is_err());
}

/// A plate 0.1 thick in a block: shallow, its own contacts lead out; beyond half its thickness, and
/// wholly inside, three contacts of one normal do.
#[test]
fn a_deep_overlap_has_one_way_out() {
    let (block, plate) = (cuboid([4.0, 4.0, 2.0]), cuboid([1.0, 1.0, 0.1]));
    // Twice 0.1 over 2.4: the rim makes it thinner.
    let thin = thickness(&plate);
    assert!((thin - 0.2 / 2.4).abs() < 1e-12, "{thin}");
    assert!(thickness(&block) > thin);
    let mut memory = PairMemory::default();
    for (depth, leads) in [(0.01, false), (0.07, true), (0.5, true)] {
        let pose = Pose::at(DVec3::Z * (1.05 - depth));
        let a = Placed { model: &block, pose: Pose::IDENTITY };
        let b = Placed { model: &plate, pose };
        let demand = Demand::Contacts { margin: 0.01, normals: Default::default() };
        let answer = query(a, b, &Query::of(demand).penetrations_from(deep(thin)), &mut memory)
            .expect("poses");
        let found = way_out([&block, &plate], thin, &pose, &answer, &mut memory).expect("a pose");
        assert_eq!(found.is_some(), leads, "{depth} deep");
        let led = found.unwrap_or_default().contacts(thin);
        assert!(led.iter().all(|c| (c.normal - DVec3::Z).length() < 1e-9), "{depth}: {led:?}");
        assert!(led.iter().all(|c| c.separation < 0.0 && -c.separation < thin), "{depth}: {led:?}");
        assert_eq!(led.len(), if leads { 3 } else { 0 }, "{depth} deep");
    }
}

/// Of two plates that are one body one is deep in a block and one is not: the deep one is led, what
/// the other touches stays as it is.
#[test]
fn what_is_shallow_beside_a_deep_overlap_keeps_its_contacts() {
    let (block, plate) = (cuboid([8.0, 4.0, 2.0]), cuboid([1.0, 1.0, 0.1]));
    let aside = DVec3::new(2.0, 0.0, 0.06);
    let places = plate.mesh().vertices().iter().flat_map(|&p| [p, p + aside]);
    let faces = plate.mesh().faces().iter();
    let faces = faces.flat_map(|face| [0, 1].map(|copy| face.map(|v| 2 * v + copy)));
    let plates = Mesh::new(places.collect(), faces.collect()).expect("two plates");
    let plates = Model::build(plates, &BuildOptions::default()).expect("a body").0;
    let thin = thickness(&plates);
    let pose = Pose::at(DVec3::Z * (1.05 - 0.07));
    let (a, b) = (Placed { model: &block, pose: Pose::IDENTITY }, Placed { model: &plates, pose });
    let mut memory = PairMemory::default();
    let answer =
        query(a, b, &Query::of(Demand::contacts(0.0)).penetrations_from(deep(thin)), &mut memory)
            .expect("poses");
    let led = way_out([&block, &plates], thin, &pose, &answer, &mut memory).expect("a pose");
    let (shallow, deep): (Vec<_>, Vec<_>) =
        led.expect("one is deep").contacts(thin).into_iter().partition(|c| c.separation > -0.011);
    assert_eq!(deep.len(), 3, "{deep:?}");
    assert!(!shallow.is_empty() && shallow.iter().all(|c| c.point_b.x > 1.4), "{shallow:?}");
}
