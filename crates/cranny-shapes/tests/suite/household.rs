//! Furniture, vehicles and what scenes put together themselves are solids, of the genus that their
//! openings say.

use cranny_geometry::Mesh;
use cranny_shapes::{
    Boxes, CarBody, Chair, Lamp, Lathe, Propeller, Shape, ShapeError, Shelf, SpokedWheel,
    SubmarineHull, Table, Tub, Wall,
};

use crate::closed_shell::{genus_of_closed_shell, self_intersection, volume};

#[track_caller]
fn solid(shape: impl Into<Shape>, genus: i64) -> Mesh {
    let shape = shape.into();
    let mesh = shape.build().unwrap_or_else(|error| panic!("{shape:?}: {error}"));
    assert_eq!(genus_of_closed_shell(&mesh), genus, "{shape:?}");
    assert!(volume(&mesh) > 0.0, "{shape:?} is inside out");
    assert_eq!(self_intersection(&mesh), None, "{shape:?}");
    mesh
}

#[track_caller]
fn refused(shape: impl Into<Shape>, parameter: &str) {
    match shape.into().build() {
        Err(ShapeError::Parameter { parameter: found, .. }) => assert_eq!(found, parameter),
        other => panic!("{parameter}: {other:?}"),
    }
}

#[test]
fn boxes_are_added_and_cut() {
    let frame = Boxes {
        add: vec![[[0.0; 3], [3.0, 3.0, 1.0]], [[2.0, 2.0, 0.5], [4.0, 4.0, 1.5]]],
        cut: vec![[[1.0, 1.0, -1.0], [2.0, 2.0, 2.0]]],
    };
    let mesh = solid(frame.clone(), 1);
    assert!((volume(&mesh) - (9.0 + 4.0 - 0.5 - 1.0)).abs() < 1e-12);
    let lowered = vec![frame.cut[0], [[-1.0, -1.0, 0.9], [9.0, 9.0, 2.0]]];
    let lowered = Boxes { cut: lowered, ..frame };
    assert!((volume(&solid(lowered, 1)) - (8.0 * 0.9 + 3.0 * 0.4)).abs() < 1e-12);
}

#[test]
fn boxes_that_are_none_are_refused() {
    refused(Boxes { add: vec![], cut: vec![] }, "add");
    let flat = vec![[[0.0; 3], [1.0, 0.0, 1.0]]];
    refused(Boxes { add: flat, cut: vec![] }, "an extent from least to greatest corner");
    let far = vec![[[f64::NAN; 3], [1.0; 3]]];
    refused(Boxes { add: far, cut: vec![] }, "a least corner");
    let touching = vec![[[0.0; 3], [1.0; 3]], [[1.0; 3], [2.0; 3]]];
    let error = Boxes { add: touching, cut: vec![] }.build().unwrap_err();
    assert!(matches!(error, ShapeError::Pinched { at: [1.0, 1.0, 1.0], .. }), "{error}");
}

#[test]
fn profiles_are_turned() {
    solid(Lathe::default(), 0);
    let ring = Lathe { profile: vec![[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]], segments: 5 };
    assert_eq!(solid(ring, 1).faces().len(), 2 * 5 * 3);
    refused(Lathe { profile: vec![[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], segments: 5 }, "a radius");
    refused(Lathe { segments: 2, ..Lathe::default() }, "segments");
    refused(Lathe { profile: vec![[1.0, 0.0]], segments: 8 }, "profile");
}

#[test]
fn walls_have_as_many_handles_as_windows() {
    let wall = solid(Wall::default(), 1);
    let openings = 0.9 * 2.0 + 1.4 * 1.1;
    assert!((volume(&wall) - 0.2 * (4.0 * 2.5 - openings)).abs() < 1e-12);
    let windows = (0..5).map(|k| 0.1 + 0.75 * f64::from(k)).map(|x| [x, 0.9, x + 0.5, 2.0]);
    solid(Wall { openings: windows.collect(), ..Wall::default() }, 5);
    solid(Wall { openings: Vec::new(), ..Wall::default() }, 0);
    let through = vec![[0.5, 0.0, 1.4, 2.5]];
    refused(Wall { openings: through, ..Wall::default() }, "an opening's upper side");
    let beyond = vec![[0.5, 0.0, 4.4, 2.0]];
    refused(Wall { openings: beyond, ..Wall::default() }, "an opening's right side");
}

#[test]
fn furniture_is_solid_whatever_its_measures() {
    for width in [0.3, 0.44, 0.9] {
        // Two gaps between the slats, and one between seat and lowest slat.
        solid(Chair { width, ..Chair::default() }, 3);
    }
    for size in [[1.6, 0.9, 0.75], [0.5, 0.5, 0.5], [3.0, 1.0, 0.4]] {
        solid(Table { size, ..Table::default() }, 3);
    }
    for (levels, columns) in [(1, 1), (5, 1), (2, 7)] {
        solid(Shelf { levels, columns, board: 0.01, ..Shelf::default() }, 0);
    }
    for (roundness, taper) in [(0.0, 1.0), (0.8, 0.75), (1.0, 0.1)] {
        solid(Tub { roundness, taper, ..Tub::default() }, 0);
    }
    let lamp = solid(Lamp::default(), 0);
    assert!((lamp.bounds().max.z - 1.6).abs() < 1e-12);
    solid(Lamp { height: 0.4, foot: 0.1, shade: 0.15, ..Lamp::default() }, 0);
}

#[test]
fn vehicles_are_solid_at_any_fineness() {
    for segments in [8, 32, 48] {
        // Six windows, less one, for the cabin hangs together.
        solid(CarBody { segments, ..CarBody::default() }, 5);
    }
    for (spokes, segments) in [(2, 8), (8, 64), (13, 100)] {
        solid(SpokedWheel { spokes, segments, ..SpokedWheel::default() }, i64::from(spokes) + 1);
    }
    for (blades, pitch) in [(2, -1.0), (5, 0.6), (8, 1.0)] {
        solid(Propeller { blades, pitch, ..Propeller::default() }, 1);
    }
    for segments in [24, 48] {
        // Hatch, tube and shaft lead out: three mouths; each bulkhead has one hatch.
        solid(SubmarineHull { segments, ..SubmarineHull::default() }, 2);
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        refused(Wall { length: bad, ..Wall::default() }, "length");
        refused(Wall { thickness: bad, ..Wall::default() }, "thickness");
        refused(Chair { width: bad, ..Chair::default() }, "width");
        refused(Chair { thickness: bad, ..Chair::default() }, "thickness");
        refused(Table { size: [1.0, bad, 1.0], ..Table::default() }, "size y");
        refused(Shelf { board: bad, ..Shelf::default() }, "board");
        refused(Tub { wall: bad, ..Tub::default() }, "wall");
        refused(Tub { taper: bad, ..Tub::default() }, "taper");
        refused(Lamp { shade: bad, ..Lamp::default() }, "shade");
        refused(CarBody { size: [bad, 1.0, 1.0], ..CarBody::default() }, "size x");
        refused(SpokedWheel { rim: bad, ..SpokedWheel::default() }, "rim");
        refused(Propeller { radius: bad, ..Propeller::default() }, "radius");
        refused(SubmarineHull { radius: bad, ..SubmarineHull::default() }, "radius");
    }
    refused(Chair { back: 0.4, ..Chair::default() }, "back");
    refused(Shelf { levels: 0, ..Shelf::default() }, "levels");
    refused(Tub { roundness: 1.1, ..Tub::default() }, "roundness");
    refused(CarBody { segments: 7, ..CarBody::default() }, "segments");
    refused(SpokedWheel { spokes: 40, ..SpokedWheel::default() }, "segments");
    refused(Propeller { blades: 1, ..Propeller::default() }, "blades");
}
