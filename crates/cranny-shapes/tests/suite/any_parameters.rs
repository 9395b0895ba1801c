//! Solids from parameters drawn from the whole accepted range, its ends above all.

use cranny_shapes::{ChainLink, Gear, IsoBolt, IsoNut, NestedShells, Shape, ShapeError, Torus};

use crate::closed_shell::{genus_of_closed_shell, self_intersection, volume};

/// Numbers in [0, 1) from a linear congruence (Knuth's MMIX constants).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.roll()
    }

    /// An end of the range as often as something between.
    fn edgy(&mut self, low: f64, high: f64) -> f64 {
        match self.roll() {
            r if r < 0.25 => low,
            r if r < 0.5 => high,
            _ => self.between(low, high),
        }
    }

    fn whole(&mut self, low: u32, high: u32) -> u32 {
        self.edgy(f64::from(low), f64::from(high)).round() as u32
    }
}

/// Coarse and steep threads, cut anywhere, in heads and nuts as narrow as they may be.
#[test]
fn threads_of_any_accepted_parameters_are_solids() {
    let mut dice = Dice(68);
    for _ in 0..150 {
        let (diameter, segments) = (10.0, dice.whole(12, 40));
        let pitch = dice.edgy(0.5, 2.5);
        let depth = 0.625 * 0.75f64.sqrt() * pitch;
        let clearance = dice.edgy(0.0, depth);
        let lead_in = dice.edgy(0.0, depth + 0.4 * pitch).max(1e-4 * pitch);
        let length = dice.edgy(2.0, 6.0) * pitch;
        let hole = 2.0 * (5.0 + clearance).max(5.0 + clearance - depth + lead_in);
        let bolt = IsoBolt {
            diameter,
            pitch,
            length: Some(length),
            segments,
            flank_segments: dice.whole(1, 5),
            lead_in: Some(lead_in),
            across_flats: Some(12.0),
            head_height: Some(1.0),
        };
        let nut = IsoNut {
            diameter,
            pitch,
            clearance,
            height: Some(length),
            segments,
            flank_segments: dice.whole(1, 5),
            lead_in: Some(lead_in),
            across_flats: Some(1.2 * hole),
        };
        solid(bolt, 0);
        solid(nut, 1);
    }
}

/// Few pointed teeth or many blunt ones, bores up to the roots.
#[test]
fn gears_of_any_accepted_parameters_are_solids() {
    let mut dice = Dice(53);
    let mut built = 0;
    for _ in 0..30 {
        let gear = Gear {
            teeth: dice.whole(4, 200),
            module: 1.0,
            thickness: 1.0,
            bore: 0.0,
            backlash: dice.edgy(0.0, 0.5),
            flank_segments: dice.whole(1, 8),
        };
        let root = gear.pitch_radius() - 1.25;
        let bored = Gear { bore: dice.edgy(1e-5, 0.999_99) * root, ..gear };
        match gear.build() {
            // Few teeth bear less backlash than many.
            Err(ShapeError::Parameter { parameter: "backlash", .. }) => continue,
            Err(error) => panic!("{gear:?}: {error}"),
            Ok(_) => built += 1,
        }
        solid(gear, 0);
        solid(bored, 1);
    }
    assert!(built > 15, "only {built}");
}

#[test]
fn rings_and_wells_of_any_accepted_parameters_are_solids() {
    let mut dice = Dice(7);
    for _ in 0..100 {
        let thin = dice.edgy(1e-5, 0.999_99);
        let [around, across] = [dice.whole(3, 20), dice.whole(3, 20)];
        let torus = Torus {
            major_radius: 1.0,
            minor_radius: thin,
            major_segments: around,
            minor_segments: across,
        };
        solid(torus, 1);
        let link = ChainLink {
            straight: dice.edgy(1e-5, 1e5),
            bend_radius: 1.0,
            wire_radius: thin,
            arc_segments: around,
            wire_segments: across,
        };
        solid(link, 1);
        let shells = dice.whole(1, 12);
        let share = 0.999 / f64::from(2 * shells);
        let (wall, gap) = (share * dice.edgy(1e-3, 1.0), share * dice.edgy(1e-3, 1.0));
        let body = NestedShells {
            shells,
            radius: 1.0,
            wall,
            gap,
            height: dice.edgy(1e-3, 1e3),
            floor: 1e-4,
            segments: around,
        };
        let floor = body.height * thin;
        solid(NestedShells { floor, ..body }, 0);
    }
}

#[track_caller]
fn solid(shape: impl Into<Shape>, genus: i64) {
    let shape = shape.into();
    let mesh = shape.build().unwrap_or_else(|error| panic!("{shape:?}: {error}"));
    assert_eq!(genus_of_closed_shell(&mesh), genus, "{shape:?}");
    assert!(volume(&mesh) > 0.0, "{shape:?}");
    assert_eq!(self_intersection(&mesh), None, "{shape:?}");
}
