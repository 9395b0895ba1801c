//! Bad parameters are refused by name; scene files may leave parameters out.

use cranny_shapes::{
    CPrism, ChainLink, Comb, Cuboid, Cup, Cylinder, Floor, Gear, GolfBall, Hook, IsoBolt, IsoNut,
    LPrism, LockPlug, NestedShells, Pyramid, PyramidInCavity, Shape, ShapeError, Sphere, Stairs,
    Tetrahedron, Torus, UPrism,
};

#[track_caller]
fn refused(shape: impl Into<Shape>, parameter: &str) {
    let shape = shape.into();
    match shape.build() {
        Err(ShapeError::Parameter { shape: name, parameter: found, value, low, high, .. }) => {
            assert_eq!((name, found), (shape.name(), parameter));
            assert!(!(low <= value && value <= high), "{value} is in {low} to {high}");
        }
        other => panic!("{shape:?}: {other:?}"),
    }
}

#[test]
fn every_parameter_is_checked() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        refused(Cuboid { size: [1.0, bad, 1.0] }, "size y");
        refused(Tetrahedron { edge: bad }, "edge");
        refused(Pyramid { base: bad, height: 1.0 }, "base");
        refused(Pyramid { base: 1.0, height: bad }, "height");
        refused(Sphere { radius: bad, ..Sphere::default() }, "radius");
        refused(Torus { major_radius: bad, ..Torus::default() }, "major_radius");
        refused(Torus { minor_radius: bad, ..Torus::default() }, "minor_radius");
        refused(ChainLink { straight: bad, ..ChainLink::default() }, "straight");
        refused(ChainLink { bend_radius: bad, ..ChainLink::default() }, "bend_radius");
        refused(ChainLink { wire_radius: bad, ..ChainLink::default() }, "wire_radius");
        refused(Cup { radius: bad, ..Cup::default() }, "radius");
        refused(Cup { height: bad, ..Cup::default() }, "height");
        refused(Cup { wall: bad, ..Cup::default() }, "wall");
        refused(Cup { floor: bad, ..Cup::default() }, "floor");
        refused(NestedShells { radius: bad, ..NestedShells::default() }, "radius");
        refused(NestedShells { height: bad, ..NestedShells::default() }, "height");
        refused(NestedShells { wall: bad, ..NestedShells::default() }, "wall");
        refused(NestedShells { gap: bad, ..NestedShells::default() }, "gap");
        refused(NestedShells { floor: bad, ..NestedShells::default() }, "floor");
        refused(PyramidInCavity { side: bad, ..PyramidInCavity::default() }, "side");
        refused(PyramidInCavity { wall: bad, ..PyramidInCavity::default() }, "wall");
        refused(PyramidInCavity { base: bad, ..PyramidInCavity::default() }, "base");
        let body = PyramidInCavity { pyramid_height: bad, ..PyramidInCavity::default() };
        refused(body, "pyramid_height");
        refused(LPrism { width: bad, ..LPrism::default() }, "width");
        refused(LPrism { thickness: bad, ..LPrism::default() }, "thickness");
        refused(UPrism { height: bad, ..UPrism::default() }, "height");
        refused(UPrism { depth: bad, ..UPrism::default() }, "depth");
        refused(UPrism { thickness: bad, ..UPrism::default() }, "thickness");
        refused(CPrism { outer_radius: bad, ..CPrism::default() }, "outer_radius");
        refused(CPrism { inner_radius: bad, ..CPrism::default() }, "inner_radius");
        refused(CPrism { opening: bad, ..CPrism::default() }, "opening");
        refused(Comb { tooth_width: bad, ..Comb::default() }, "tooth_width");
        refused(Comb { gap: bad, ..Comb::default() }, "gap");
        refused(Comb { bar: bad, ..Comb::default() }, "bar");
        refused(Gear { module: bad, ..Gear::default() }, "module");
        refused(Gear { thickness: bad, ..Gear::default() }, "thickness");
        refused(GolfBall { radius: bad, ..GolfBall::default() }, "radius");
        refused(GolfBall { dimple_depth: bad, ..GolfBall::default() }, "dimple_depth");
        refused(GolfBall { coverage: bad, ..GolfBall::default() }, "coverage");
        refused(IsoBolt { diameter: bad, ..IsoBolt::default() }, "diameter");
        refused(IsoBolt { pitch: bad, ..IsoBolt::default() }, "pitch");
        refused(IsoBolt { length: Some(bad), ..IsoBolt::default() }, "length");
        refused(IsoBolt { across_flats: Some(bad), ..IsoBolt::default() }, "across_flats");
        refused(IsoBolt { head_height: Some(bad), ..IsoBolt::default() }, "head_height");
        refused(IsoNut { height: Some(bad), ..IsoNut::default() }, "height");
        refused(Cylinder { radius: bad, ..Cylinder::default() }, "radius");
        refused(Cylinder { height: bad, ..Cylinder::default() }, "height");
        refused(Floor { size: [1.0, 1.0, bad], ..Floor::default() }, "size z");
        refused(Hook { length: bad, ..Hook::default() }, "length");
        refused(Hook { opening: bad, ..Hook::default() }, "opening");
        refused(Hook { tip: bad, ..Hook::default() }, "tip");
        refused(Hook { thickness: bad, ..Hook::default() }, "thickness");
        refused(Hook { depth: bad, ..Hook::default() }, "depth");
        refused(Stairs { rise: bad, ..Stairs::default() }, "rise");
        refused(Stairs { tread: bad, ..Stairs::default() }, "tread");
        refused(Stairs { landing: bad, ..Stairs::default() }, "landing");
        refused(Stairs { depth: bad, ..Stairs::default() }, "depth");
        refused(LockPlug { radius: bad, ..LockPlug::default() }, "radius");
        refused(LockPlug { width: bad, ..LockPlug::default() }, "width");
        refused(LockPlug { thickness: bad, ..LockPlug::default() }, "thickness");
        refused(LockPlug { clearance: bad, ..LockPlug::default() }, "clearance");
        refused(LockPlug { depth: bad, ..LockPlug::default() }, "depth");
    }
    for bad in [-0.1, f64::NAN, 1.5] {
        refused(Gear { bore: bad, ..Gear::default() }, "bore");
        refused(Gear { backlash: bad, ..Gear::default() }, "backlash");
        refused(IsoNut { clearance: bad, ..IsoNut::default() }, "clearance");
        refused(IsoNut { lead_in: Some(4.0 * bad), ..IsoNut::default() }, "lead_in");
        refused(IsoBolt { lead_in: Some(4.0 * bad), ..IsoBolt::default() }, "lead_in");
        refused(Cylinder { chamfer: bad, ..Cylinder::default() }, "chamfer");
    }
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    refused(Torus { minor_radius: 1.0, ..Torus::default() }, "minor_radius");
    refused(Cup { wall: 0.5, ..Cup::default() }, "wall");
    refused(NestedShells { shells: 5, ..NestedShells::default() }, "gap");
    refused(Gear { teeth: 4, backlash: 0.03, ..Gear::default() }, "backlash");
    refused(UPrism { thickness: 0.5, ..UPrism::default() }, "thickness");
    refused(CPrism { inner_radius: 0.5, ..CPrism::default() }, "inner_radius");
    refused(IsoNut { across_flats: Some(18.0), ..IsoNut::default() }, "across_flats");
    refused(Cylinder { chamfer: 0.5, ..Cylinder::default() }, "chamfer");
    refused(Hook { tip: 0.9, ..Hook::default() }, "tip");
    refused(LockPlug { radius: 0.55, ..LockPlug::default() }, "radius");
    refused(LockPlug { clearance: 0.25, ..LockPlug::default() }, "clearance");
}

#[test]
fn counts_have_bounds() {
    refused(Sphere { segments: 2, ..Sphere::default() }, "segments");
    refused(Sphere { rings: 1, ..Sphere::default() }, "rings");
    refused(Torus { major_segments: u32::MAX, ..Torus::default() }, "major_segments");
    refused(Gear { teeth: 3, ..Gear::default() }, "teeth");
    refused(Comb { teeth: 1, ..Comb::default() }, "teeth");
    refused(IsoBolt { segments: 11, ..IsoBolt::default() }, "segments");
    refused(NestedShells { shells: 0, ..NestedShells::default() }, "shells");
    refused(Cylinder { segments: 2, ..Cylinder::default() }, "segments");
    refused(Floor { squares: [1, 0], ..Floor::default() }, "squares y");
    refused(Stairs { steps: 0, ..Stairs::default() }, "steps");
    refused(LockPlug { segments: 11, ..LockPlug::default() }, "segments");
    let torus = Torus { major_segments: 16_384, minor_segments: 16_384, ..Torus::default() };
    let limit = cranny_shapes::MAX_FACES;
    let expected = ShapeError::TooManyFaces { shape: "Torus", faces: 1 << 29, limit };
    assert_eq!(torus.build(), Err(expected));
}

#[test]
fn dimples_too_fine_for_the_mesh_are_refused_with_a_number_that_helps() {
    let coarse = GolfBall { triangles: 1_000, ..GolfBall::default() };
    let Err(ShapeError::TooCoarse { triangles: 1_000, enough, .. }) = coarse.build() else {
        panic!("accepted");
    };
    let finer = GolfBall { triangles: enough.try_into().unwrap(), ..coarse };
    assert!(finer.build().is_ok(), "{enough} are not enough");
}

#[test]
fn a_scene_names_a_shape_and_leaves_out_what_is_usual() {
    let options = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES);
    let text = "IsoNut(diameter: 16, pitch: 2, clearance: 0.1, segments: 144)";
    let nut: Shape = options.from_str(text).unwrap();
    assert_eq!(nut, IsoNut::default().into());
    let bolt: Shape = options.from_str("IsoBolt(diameter: 8, pitch: 1.25, length: 20)").unwrap();
    let expected = IsoBolt { diameter: 8.0, pitch: 1.25, length: Some(20.0), ..IsoBolt::default() };
    assert_eq!(bolt, expected.into());
    assert_eq!(
        options.from_str::<Shape>("Cuboid(size: (1, 2, 3))").unwrap(),
        Cuboid { size: [1.0, 2.0, 3.0] }.into()
    );
    assert_eq!(options.from_str::<Shape>("Torus()").unwrap(), Torus::default().into());
    assert!(options.from_str::<Shape>("Torus(radius: 1)").is_err(), "unknown parameter");
    assert!(options.from_str::<Shape>("Teapot()").is_err(), "unknown shape");
}
