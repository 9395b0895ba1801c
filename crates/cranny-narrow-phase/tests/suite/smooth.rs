//! Smooth normals of contacts: near those of the curved surfaces that meshes stand for; all else of
//! an answer stays.

use std::f64::consts::TAU;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{Model, SmoothNormals, radians_between};
use cranny_narrow_phase::{
    Answer, Demand, Feature, Normals, PairMemory, Placed, Query, QueryError, query, smooth_normal,
};
use cranny_shapes::{Cuboid, Cup, Cylinder, GolfBall, IsoBolt, IsoNut, Torus};
use cranny_testkit::Rng;

use crate::solids::{ask, at, cuboid, model, octahedron, shape};

/// 10 degrees more than facets of these bodies meet at; less than their chamfers and rims do.
const CREASE: f64 = 0.5;

fn smooth(margin: f64, crease_angle: f64) -> Demand {
    Demand::Contacts { margin, normals: Normals::Smooth { crease_angle } }
}

/// The same answer but for normals.
fn same_but_for_normals(flat: &Answer, found: &Answer) {
    let mut found = found.clone();
    assert_eq!(found.contacts.len(), flat.contacts.len());
    for (contact, own) in found.contacts.iter_mut().zip(&flat.contacts) {
        contact.normal = own.normal;
    }
    assert_eq!(&found, flat);
}

fn ball(triangles: u32) -> Model {
    shape(GolfBall { dimples: 0, triangles, ..GolfBall::default() })
}

fn turn(rng: &mut Rng) -> DQuat {
    DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit() + 1.5).normalize()
}

/// Whatever the demand: points, separations and verdicts are those of the meshes; normals are unit,
/// no farther from the meshes' own than the crease; the order of the bodies and what was demanded
/// before do not matter.
#[test]
fn only_normals_change_and_none_is_far_off() {
    let bodies = [
        shape(Cuboid::default()),
        shape(Cup { segments: 12, ..Cup::default() }),
        shape(Torus { major_segments: 16, minor_segments: 8, ..Torus::default() }),
        ball(320),
        model(octahedron()),
    ];
    let mut rng = Rng::new(17);
    let (mut memory, mut changed, mut kept) = (PairMemory::default(), 0, 0);
    for round in 0..300 {
        let [a, b] = [&bodies[rng.below(5)], &bodies[rng.below(5)]];
        let reach = a.radius() + b.radius();
        let translation = reach * 0.6 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let a = Placed { model: a, pose: Pose { rotation: turn(&mut rng), translation } };
        let b = Placed { model: b, pose: Pose { rotation: turn(&mut rng), ..Pose::IDENTITY } };
        let (margin, crease) = (0.2 * reach, [0.0, 0.3, 0.8, 3.0][rng.below(4)]);
        let (flat, found) =
            (ask(a, b, Demand::contacts(margin)), ask(a, b, smooth(margin, crease)));
        same_but_for_normals(&flat, &found);
        for (contact, own) in found.contacts.iter().zip(&flat.contacts) {
            assert!((contact.normal.length() - 1.0).abs() < 1e-12);
            let off = radians_between(contact.normal, own.normal);
            assert!(off <= crease + 1e-12, "round {round}: {off} of {crease}");
            changed += u32::from(off > 0.0);
            kept += u32::from(off == 0.0);
        }
        let swapped = ask(b, a, smooth(margin, crease)).swapped();
        for (contact, its) in found.contacts.iter().zip(&swapped.contacts) {
            assert_eq!(contact.id, its.id);
            assert!((contact.normal - its.normal).length() < 1e-15);
        }
        let warm = query(a, b, &Query::of(smooth(margin, crease)), &mut memory).unwrap();
        assert_eq!(warm.contacts, found.contacts, "round {round}");
    }
    assert!(changed > 300 && kept > 300, "{changed} {kept}");
}

/// Cubes are flat at any crease below a right angle: answers are the same to the bit.
#[test]
fn between_flat_faces_nothing_changes() {
    let cube = shape(Cuboid::default());
    let mut rng = Rng::new(2);
    let mut some = 0;
    for _ in 0..100 {
        let translation = 0.8 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let b = Placed { model: &cube, pose: Pose { rotation: turn(&mut rng), translation } };
        let a = at(&cube, 0.0, 0.0, 0.0);
        let flat = ask(a, b, Demand::contacts(0.3));
        assert_eq!(ask(a, b, smooth(0.3, CREASE)), flat);
        some += flat.contacts.len();
    }
    assert!(some > 100, "{some}");
}

/// Two balls of radius 1 and 320 faces that touch, but for what facets lack: edges subtend 0.3, so
/// facets lean by up to 0.17. What one vertex is off the line of centres, the other body's normal
/// is off the other way.
#[test]
fn balls_push_along_their_centres() {
    let ball = ball(320);
    let mut rng = Rng::new(8);
    let [mut flat_worst, mut told_worst] = [0.0f64; 2];
    for _ in 0..60 {
        let along = DVec3::new(rng.unit(), rng.unit(), rng.unit()).normalize();
        let a = Placed { model: &ball, pose: Pose { rotation: turn(&mut rng), ..Pose::IDENTITY } };
        let pose = Pose { rotation: turn(&mut rng), translation: 2.0 * along };
        let b = Placed { model: &ball, pose };
        let (flat, found) = (ask(a, b, Demand::contacts(0.05)), ask(a, b, smooth(0.05, CREASE)));
        // Where the surfaces are nearest; elsewhere their true normals are others.
        let (Some(own), Some(found)) = (flat.contacts.first(), found.contacts.first()) else {
            panic!("balls this near make contacts");
        };
        flat_worst = flat_worst.max(radians_between(own.normal, along));
        told_worst = told_worst.max(radians_between(found.normal, along));
    }
    assert!(flat_worst > 0.08 && told_worst < 0.4 * flat_worst, "{told_worst} {flat_worst}");
}

/// On a flat floor a ball has the floor's normal, whichever of the two has the vertex.
#[test]
fn a_flat_face_is_right_about_its_normal() {
    let ball = ball(320);
    // A floor whose vertices are many, and flat.
    let cells: Vec<[i32; 3]> = (0..36).map(|i| [i % 6 - 3, i / 6 - 3, -1]).collect();
    let floor = model(cranny_testkit::bodies::cells(&cells));
    let mut rng = Rng::new(4);
    let mut vertices_of_floor = 0;
    for _ in 0..200 {
        let translation = DVec3::new(2.0 * rng.unit(), 2.0 * rng.unit(), 0.99);
        let pose = Pose { rotation: turn(&mut rng), translation };
        let (a, b) = (at(&floor, 0.0, 0.0, 0.0), Placed { model: &ball, pose });
        let found = ask(a, b, smooth(0.02, CREASE));
        for contact in &found.contacts {
            vertices_of_floor += u32::from(!matches!(contact.id.0, Feature::Face(_)));
            let off = radians_between(contact.normal, DVec3::Z);
            assert!(off < 1e-15, "{contact:?}");
        }
        assert!(!found.contacts.is_empty());
    }
    // Also where the ball's own facet would tell another.
    assert!(vertices_of_floor > 0, "{vertices_of_floor}");
}

/// A sharp corner has no normal of its own: the ball's counts alone.
#[test]
fn a_corner_pushes_along_the_curved_surface() {
    let (ball, corner) = (ball(320), model(cuboid([0.0; 3], [1.0; 3])));
    let mut rng = Rng::new(6);
    let [mut flat_worst, mut told_worst] = [0.0f64; 2];
    for _ in 0..100 {
        // The cube's corner at its origin points at the ball's centre.
        let away = DVec3::new(rng.unit(), rng.unit(), rng.unit()).normalize();
        let rotation = DQuat::from_rotation_arc(DVec3::ONE.normalize(), away);
        let pose = Pose { rotation, translation: 1.02 * away };
        let (a, b) = (at(&ball, 0.0, 0.0, 0.0), Placed { model: &corner, pose });
        let (flat, found) = (ask(a, b, Demand::contacts(0.05)), ask(a, b, smooth(0.05, CREASE)));
        let (own, found) = (flat.contacts[0], found.contacts[0]);
        assert!(matches!(own.id.1, Feature::Vertex(_)), "{own:?}");
        told_worst = told_worst.max(radians_between(found.normal, away));
        flat_worst = flat_worst.max(radians_between(own.normal, away));
    }
    assert!(flat_worst > 0.1 && told_worst < 0.15 * flat_worst, "{told_worst} {flat_worst}");
}

/// A shaft of 48 sides in a bore as fine: normals are radial and square to the axis.
#[test]
fn a_shaft_in_its_bore_pushes_along_radii() {
    let shaft = shape(Cylinder { radius: 0.99, height: 1.0, segments: 48, ..Cylinder::default() });
    let bore = shape(Cup { radius: 1.2, wall: 0.2, height: 3.0, segments: 48, ..Cup::default() });
    let half = 0.5 * TAU / 48.0;
    let [mut flat_worst, mut told_worst, mut count] = [0.0f64, 0.0, 0.0];
    for k in 0..40 {
        let rotation = DQuat::from_rotation_z(0.0123 * f64::from(k));
        let inner = Placed { model: &shaft, pose: Pose { rotation, translation: 2.0 * DVec3::Z } };
        let outer = at(&bore, 0.0, 0.0, 0.0);
        let flat = ask(inner, outer, Demand::contacts(0.02));
        for (own, found) in
            flat.contacts.iter().zip(&ask(inner, outer, smooth(0.02, CREASE)).contacts)
        {
            let p = own.point_a;
            let radial = DVec3::new(p.x, p.y, 0.0).normalize();
            flat_worst = flat_worst.max(radians_between(own.normal, radial));
            told_worst = told_worst.max(radians_between(found.normal, radial));
            count += 1.0;
        }
    }
    assert!(count > 100.0 && flat_worst > 0.5 * half, "{count} {flat_worst}");
    assert!(told_worst < 0.1 * flat_worst, "{told_worst} {flat_worst}");
}

/// Flanks of a nut on its bolt: the helicoid's normals. Facets of 48 a turn, on flanks at 30
/// degrees, lean by up to 1.9. The crease lies between what flanks' facets meet at (3.8 degrees)
/// and flank and chamfer do (15).
#[test]
fn flanks_push_as_helicoids_do() {
    let (bolt, nut) = (
        shape(IsoBolt { diameter: 16.0, pitch: 2.0, segments: 48, ..IsoBolt::default() }),
        shape(IsoNut {
            diameter: 16.0,
            pitch: 2.0,
            clearance: 0.1,
            segments: 48,
            ..IsoNut::default()
        }),
    );
    let lead = 2.0 / TAU;
    let (mut flat_sum, mut told_sum, mut count) = (0.0, 0.0, 0);
    for k in 0..12 {
        // Lowered until the upper flanks of the bolt bear, at other places of the thread.
        let (turned, z) = (0.031 * f64::from(k), 20.0 - 0.05);
        let pose = Pose {
            rotation: DQuat::from_rotation_z(turned),
            translation: DVec3::new(0.0, 0.0, z + lead * turned),
        };
        let (a, b) = (at(&bolt, 0.0, 0.0, 0.0), Placed { model: &nut, pose });
        let flat = ask(a, b, Demand::contacts(0.02));
        for (own, found) in flat.contacts.iter().zip(&ask(a, b, smooth(0.02, 0.17)).contacts) {
            let p = 0.5 * (own.point_a + own.point_b);
            let (radius, height) = (p.truncate().length(), own.normal.z.abs());
            // Flanks lie between the crest of the nut and that of the bolt; threads end in
            // chamfers.
            if !(7.1..7.9).contains(&radius) || !(0.7..0.95).contains(&height) {
                continue;
            }
            // Height over the thread as a function of angle and radius: its gradient.
            let [radial, around] =
                [DVec3::new(p.x, p.y, 0.0) / radius, DVec3::new(-p.y, p.x, 0.0) / radius];
            let slope = (30f64.to_radians()).tan().copysign(own.normal.dot(radial) * own.normal.z);
            let up = DVec3::Z + slope * radial - (lead / radius) * around;
            let truth = up.normalize() * own.normal.z.signum();
            let [off, flat_off] = [found, own].map(|c| radians_between(c.normal, truth));
            told_sum += off;
            flat_sum += flat_off;
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
    assert!(told_sum < 0.25 * flat_sum, "{told_sum} {flat_sum}");
}

/// Bodies without smooth normals are the polyhedra that they are, and neither smooth is the
/// contact's own.
#[test]
fn a_body_may_be_smooth_alone() {
    let (ball, cube) = (ball(320), shape(Cuboid::default()));
    let normals = SmoothNormals::of(&ball, CREASE).unwrap();
    let (a, b) = (at(&ball, 0.0, 0.0, 0.0), at(&ball, 0.99, 0.02, 0.01));
    let contact = ask(a, b, Demand::contacts(0.1)).contacts[0];
    assert_eq!(smooth_normal(&contact, [a, b], [None, None]), contact.normal);
    let found = smooth_normal(&contact, [a, b], [Some(&normals), None]);
    let back = smooth_normal(&contact.swapped(), [b, a], [None, Some(&normals)]);
    assert_eq!(found, -back);
    // On the cube's face: that face's.
    let (a, b) = (at(&ball, 0.0, 0.0, 0.0), at(&cube, 1.0, 0.0, 0.0));
    let (mut across, mut within) = (0, 0);
    for b in [b, at(&cube, 1.52, 0.0, 0.0)] {
        for contact in ask(a, b, Demand::contacts(0.1)).contacts {
            if matches!(contact.id.1, Feature::Face(_)) {
                let found = smooth_normal(&contact, [a, b], [Some(&normals), None]);
                assert!((found - DVec3::X).length() < 1e-12, "{contact:?}: {found}");
                let count = if contact.separation < 0.0 { &mut within } else { &mut across };
                *count += 1;
            }
        }
    }
    assert!(across > 0 && within > 0, "{across} across the gap, {within} within");
}

#[test]
fn a_crease_that_is_none_is_refused() {
    let cube = shape(Cuboid::default());
    let (a, b) = (at(&cube, 0.0, 0.0, 0.0), at(&cube, 9.0, 0.0, 0.0));
    for crease in [-0.1, 3.2, f64::NAN] {
        let wanted = Query::of(smooth(0.1, crease));
        let refused = query(a, b, &wanted, &mut PairMemory::default()).unwrap_err();
        assert!(matches!(refused, QueryError::Crease(_)), "{refused}");
        assert!(refused.to_string().contains(&crease.to_string()));
    }
}
