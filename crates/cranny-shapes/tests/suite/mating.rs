//! A nut fits its bolt along the whole screw motion, and not beside it.

use std::f64::consts::TAU;

use crate::closed_shell::{meeting_pair, volume};
use cranny_exact::{DVec2, DVec3};
use cranny_geometry::Mesh;
use cranny_shapes::{Gear, IsoBolt, IsoNut};

/// Turned about z, then moved along it.
fn screwed(angle: f64, z: f64) -> impl Fn(DVec3) -> DVec3 {
    let turn = DVec2::from_angle(angle);
    move |p| turn.rotate(DVec2::new(p.x, p.y)).extend(p.z + z)
}

fn m16(segments: u32) -> (Mesh, Mesh) {
    let bolt = IsoBolt { segments, ..IsoBolt::default() }.build().unwrap();
    let nut = IsoNut { segments, ..IsoNut::default() }.build().unwrap();
    (bolt, nut)
}

#[test]
fn the_nut_fits_unturned_at_multiples_of_the_pitch() {
    let (bolt, nut) = m16(144);
    for z in [8.0, 20.0, 26.0] {
        assert_eq!(meeting_pair(&bolt, &nut, screwed(0.0, z)), None, "at {z}");
    }
}

#[test]
fn the_nut_fits_at_24_angles_along_the_helix() {
    let (bolt, nut) = m16(144);
    for step in 0..24 {
        // Angles that are no whole number of columns, over two turns.
        let angle = TAU * (f64::from(step) / 12.0) + 0.01;
        let pose = screwed(angle, 20.0 + 2.0 * angle / TAU);
        assert_eq!(meeting_pair(&bolt, &nut, pose), None, "at {angle} rad");
    }
}

/// Column upon column, chord errors are alike. (A nut whose facets cut across the corner where its
/// lead-in ends met the bolt here.)
#[test]
fn column_upon_column_any_clearance_beyond_rounding_will_do() {
    for flank_segments in [1, 3] {
        let bolt = IsoBolt { segments: 48, flank_segments, ..IsoBolt::default() };
        let bolt = bolt.build().unwrap();
        let nut = |clearance| {
            let nut = IsoNut { segments: 48, flank_segments, clearance, ..IsoNut::default() };
            nut.build().unwrap()
        };
        assert!(meeting_pair(&bolt, &nut(0.0), screwed(0.0, 20.0)).is_some());
        assert_eq!(meeting_pair(&bolt, &nut(1e-6), screwed(0.0, 20.0)), None);
        assert_eq!(meeting_pair(&bolt, &nut(1e-6), screwed(0.0, 28.0)), None);
    }
}

#[test]
fn off_the_helix_the_nut_meets_the_bolt() {
    let (bolt, nut) = m16(72);
    // Flanks are 0.1 tan 30 = 0.058 apart along the axis.
    for (angle, z) in [(0.0, 21.0), (TAU / 4.0, 20.0), (0.0, 20.07), (0.0, 19.93)] {
        assert!(meeting_pair(&bolt, &nut, screwed(angle, z)).is_some(), "{angle} at {z}");
    }
    assert_eq!(meeting_pair(&bolt, &nut, screwed(0.0, 20.05)), None);
    assert_eq!(meeting_pair(&bolt, &nut, screwed(0.0, 19.95)), None);
}

#[test]
fn the_nut_leaves_over_the_tip_and_stops_at_the_head() {
    let (bolt, nut) = m16(72);
    assert_eq!(meeting_pair(&bolt, &nut, screwed(0.0, 48.0)), None, "half off the tip");
    assert_eq!(meeting_pair(&bolt, &nut, screwed(0.0, 60.0)), None, "off the tip");
    assert!(meeting_pair(&bolt, &nut, screwed(0.0, 6.0)).is_some(), "through the head");
}

#[test]
fn two_gears_mesh_at_the_sum_of_their_pitch_radii() {
    let gear = Gear { teeth: 20, backlash: 0.01, flank_segments: 16, ..Gear::default() };
    let mesh = gear.build().unwrap();
    let distance = 2.0 * gear.pitch_radius();
    // A gap of the second faces the first's tooth on +x: half a tooth on, as 20 is even.
    for step in 0..10 {
        let angle = TAU / 20.0 * (f64::from(step) / 10.0);
        let first = screwed(angle, 0.0);
        let driver =
            Mesh::new(mesh.vertices().iter().map(|&p| first(p)).collect(), mesh.faces().to_vec());
        let second = screwed(TAU / 40.0 - angle, 0.0);
        let pose = |p: DVec3| second(p) + distance * DVec3::X;
        assert_eq!(meeting_pair(&driver.unwrap(), &mesh, pose), None, "turned by {angle}");
        let pose = |p: DVec3| screwed(-angle, 0.0)(p) + distance * DVec3::X;
        assert!(meeting_pair(&mesh, &mesh, pose).is_some() || step > 0, "tooth upon tooth");
    }
}

#[test]
fn clearance_is_radial() {
    let narrow =
        IsoNut { clearance: 0.0, lead_in: Some(0.0), ..IsoNut::default() }.build().unwrap();
    let wide = IsoNut { clearance: 0.1, lead_in: Some(0.0), ..IsoNut::default() }.build().unwrap();
    // Mean radius 7.46: the hole grows by 2 pi r c h.
    let grown = volume(&narrow) - volume(&wide);
    assert!((grown / (TAU * 7.46 * 0.1 * 14.4) - 1.0).abs() < 0.02, "{grown}");
}
