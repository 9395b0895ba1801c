//! Every generator yields one closed, oriented shell that does not meet itself, of the genus and
//! volume that its parameters say.

use std::f64::consts::{PI, TAU};

use crate::closed_shell::{genus_of_closed_shell, self_intersection, volume};
use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_shapes::{
    CPrism, ChainLink, Comb, Cuboid, Cup, Cylinder, Floor, Gear, GolfBall, Hook, IsoBolt, IsoNut,
    LPrism, LockPlug, NestedShells, Pyramid, PyramidInCavity, Shape, Sphere, Stairs, Tetrahedron,
    Torus, UPrism,
};

/// Area of the regular polygon inscribed in the unit circle.
fn disc(segments: u32) -> f64 {
    0.5 * f64::from(segments) * (TAU / f64::from(segments)).sin()
}

/// Builds and checks everything; the volume within a relative error.
#[track_caller]
fn check(shape: impl Into<Shape>, genus: i64, expected: f64, relative: f64) -> Mesh {
    let shape = shape.into();
    let mesh = shape.build().unwrap_or_else(|error| panic!("{shape:?}: {error}"));
    assert_eq!(genus_of_closed_shell(&mesh), genus, "{shape:?}");
    let found = volume(&mesh);
    assert!((found - expected).abs() <= relative * expected, "{shape:?}: {found} not {expected}");
    assert_eq!(self_intersection(&mesh), None, "{shape:?}");
    mesh
}

/// The bound where the volume is that of the polyhedron itself.
const ROUNDING: f64 = 1e-9;

#[test]
fn polyhedra() {
    for size in [[1.0; 3], [0.1, 2.0, 30.0], [1e-9, 1e9, 1.0]] {
        let mesh = check(Cuboid { size }, 0, size.iter().product(), ROUNDING);
        assert_eq!(mesh.bounds().max, 0.5 * DVec3::from_array(size));
    }
    for edge in [1.0, 0.3, 1e9] {
        check(Tetrahedron { edge }, 0, edge.powi(3) / 72f64.sqrt(), ROUNDING);
    }
    for (base, height) in [(1.0, 1.0), (3.0, 0.01), (0.1, 20.0)] {
        check(Pyramid { base, height }, 0, base * base * height / 3.0, ROUNDING);
    }
}

#[test]
fn spheres() {
    for (segments, rings) in [(3, 2), (4, 2), (7, 5), (32, 16), (64, 33)] {
        let ring = |k: u32| (PI * f64::from(k) / f64::from(rings)).sin_cos();
        let frustum = |k: u32| {
            let ([r, z], [s, w]) = (<[f64; 2]>::from(ring(k)), <[f64; 2]>::from(ring(k + 1)));
            disc(segments) * (r * r + r * s + s * s) * (z - w) / 3.0
        };
        let expected = (0..rings).map(frustum).sum::<f64>() * 8.0;
        let mesh = check(Sphere { radius: 2.0, segments, rings }, 0, expected, ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 2 * segments * (rings - 1));
    }
    check(Sphere { radius: 1.0, segments: 128, rings: 64 }, 0, 4.0 * PI / 3.0, 2e-3);
}

#[test]
fn tori() {
    for (major, minor) in [(3, 3), (5, 8), (64, 16), (31, 7)] {
        for minor_radius in [0.01, 0.2, 0.99] {
            let torus = Torus {
                major_radius: 1.0,
                minor_radius,
                major_segments: major,
                minor_segments: minor,
            };
            // Pappus on polygons: the section's second moment about its own centre also counts only
            // to the first order, which vanishes by symmetry.
            let expected = 2.0 * disc(major) * disc(minor) * minor_radius.powi(2);
            let mesh = check(torus, 1, expected, ROUNDING);
            assert_eq!(mesh.faces().len() as u32, 2 * major * minor);
        }
    }
    assert_eq!(Torus::default().build().unwrap().faces().len(), 2048);
}

#[test]
fn chain_links() {
    for (arc_segments, wire_segments, wire_radius) in [(2, 3, 0.1), (16, 12, 0.15), (9, 8, 0.49)] {
        let link =
            ChainLink { straight: 2.0, bend_radius: 0.5, wire_radius, arc_segments, wire_segments };
        let section = disc(wire_segments) * wire_radius * wire_radius;
        let arcs = 2.0 * disc(2 * arc_segments) * 0.5;
        let mesh = check(link, 1, section * (arcs + 4.0), ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 4 * (arc_segments + 1) * wire_segments);
    }
}

#[test]
fn vessels() {
    for (wall, floor, segments) in [(0.1, 0.1, 64), (0.49, 0.9, 3), (1e-5, 1e-5, 17)] {
        let cup = Cup { radius: 0.5, height: 1.0, wall, floor, segments };
        let well = (0.5 - wall).powi(2) * (1.0 - floor);
        check(cup, 0, disc(segments) * (0.25 - well), ROUNDING);
    }
    for shells in [1, 2, 3, 6] {
        let body = NestedShells { shells, wall: 0.08, gap: 0.07, ..NestedShells::default() };
        let floor = body.floor;
        let section: f64 = (0..shells)
            .map(|k| 1.0 - 0.15 * f64::from(k))
            .map(|r| r * r - (r - 0.08).powi(2))
            .sum();
        let expected = disc(body.segments) * (floor + section * (1.0 - floor));
        let mesh = check(body, 0, expected, ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 8 * body.segments * shells);
    }
    for pyramid_height in [0.2, 0.6, 3.0] {
        let body = PyramidInCavity { pyramid_height, ..PyramidInCavity::default() };
        let expected = 1.0 - 0.8 * 0.8 * 0.9 + 0.25 * pyramid_height / 3.0;
        assert_eq!(check(body, 0, expected, ROUNDING).faces().len(), 40);
    }
}

#[test]
fn prisms() {
    for (width, height, thickness) in [(1.0, 1.0, 0.3), (3.0, 0.5, 0.01), (0.2, 0.7, 0.09)] {
        let depth = 0.4;
        let l = LPrism { width, height, thickness, depth };
        check(l, 0, depth * thickness * (width + height - thickness), ROUNDING);
        let u = UPrism { width, height, thickness, depth };
        let expected = depth * thickness * (width + 2.0 * (height - thickness));
        check(u, 0, expected, ROUNDING);
    }
    for (opening, segments) in [(1.0, 48), (0.001, 3), (5.0, 7), (TAU - 0.001, 3)] {
        let c = CPrism { opening, segments, ..CPrism::default() };
        let triangle = 0.5 * ((TAU - opening) / f64::from(segments)).sin();
        let expected = 0.5 * f64::from(segments) * triangle * (0.25 - 0.09);
        let mesh = check(c, 0, expected, ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 8 * segments + 4);
    }
    for teeth in [2, 3, 8, 100] {
        let comb = Comb { teeth, ..Comb::default() };
        let n = f64::from(teeth);
        let area = (0.2 * n - 0.1) * 0.2 + n * 0.1 * 0.6;
        let mesh = check(comb, 0, 0.1 * area, ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 16 * teeth + 4);
    }
}

#[test]
fn floors_are_level() {
    for squares in [[1, 1], [2, 3], [7, 1], [20, 20]] {
        let floor = Floor { size: [3.0, 2.0, 0.7], squares };
        let mesh = check(floor, 0, 4.2, ROUNDING);
        let [n, m] = squares.map(|k| k as usize);
        assert_eq!(mesh.faces().len(), 4 * (n * m + n + m));
        let on_top = mesh.vertices().iter().filter(|p| p.z == 0.0).count();
        assert_eq!(on_top, (n + 1) * (m + 1), "one plane, to the bit");
    }
}

#[test]
fn cylinders() {
    for (chamfer, segments) in [(0.0, 3), (0.1, 48), (1e-3, 64), (0.299, 7)] {
        let cylinder = Cylinder { radius: 0.4, height: 0.6, chamfer, segments };
        let cone = (0.16 + 0.4 * (0.4 - chamfer) + (0.4 - chamfer).powi(2)) * chamfer / 3.0;
        let expected = disc(segments) * (0.16 * (0.6 - 2.0 * chamfer) + 2.0 * cone);
        let mesh = check(cylinder, 0, expected, ROUNDING);
        let bands = if chamfer == 0.0 { 4 } else { 8 };
        assert_eq!(mesh.faces().len() as u32, bands * segments);
    }
}

#[test]
fn hooks_stairs_and_keyways() {
    for (length, opening, tip, thickness) in [(1.2, 0.7, 0.5, 0.3), (4.0, 0.1, 0.01, 1.0)] {
        let hook = Hook { length, opening, tip, thickness, depth: 0.3 };
        // Shank, bar without the shank, tip.
        let area = thickness * (length + (opening + thickness) + tip);
        assert_eq!(check(hook, 0, 0.3 * area, ROUNDING).faces().len(), 28);
    }
    for steps in [1, 2, 9] {
        let stairs = Stairs { steps, rise: 0.2, tread: 0.3, landing: 0.5, depth: 2.0 };
        let n = f64::from(steps);
        let area = 0.2 * (0.5 * (n + 1.0) + 0.3 * n * (n + 1.0) / 2.0);
        let mesh = check(stairs, 0, 2.0 * area, ROUNDING);
        assert_eq!(mesh.faces().len() as u32, 8 * steps + 12);
    }
    for (width, height, thickness, clearance) in
        [(0.8, 0.8, 0.3, 0.01), (1.2, 0.4, 0.2, 1e-3), (0.3, 1.1, 0.1, 0.05)]
    {
        let plug = LockPlug { width, height, thickness, clearance, ..LockPlug::default() };
        // The keyway is an L of its own: longer arms, thicker by twice the clearance.
        let [w, h, t] = [width, height, thickness].map(|x| x + 2.0 * clearance);
        let expected = 0.5 * (disc(48) - t * (w + h - t));
        let mesh = check(plug, 1, expected, ROUNDING);
        assert_eq!(mesh.faces().len(), 4 * (48 + 6));
    }
}

#[test]
fn gears() {
    for teeth in [4, 5, 8, 16, 41, 42, 60, 200] {
        for bore in [0.0, 0.05] {
            for backlash in [0.0, 0.02] {
                let gear = Gear { teeth, bore, backlash, ..Gear::default() };
                // Half of the ring between root and tip is teeth, nearly; the module is 0.1.
                let (root, tip) = (gear.pitch_radius() - 0.125, gear.pitch_radius() + 0.1);
                let ring = tip * tip - root * root;
                let thinner = backlash * 0.225 * f64::from(teeth);
                let area = PI * (root * root + 0.5 * ring - bore * bore) - thinner;
                let expected = gear.thickness * area;
                // Few teeth are pointed: less than half of the ring.
                let bound = if teeth < 16 { 0.25 } else { 0.06 };
                let mesh = check(gear, i64::from(bore > 0.0), expected, bound);
                let reach = mesh.vertices().iter().map(|p| p.x.hypot(p.y)).fold(0.0, f64::max);
                assert!((reach - tip).abs() < 1e-12);
            }
        }
    }
    let default = check(Gear::default(), 1, 0.3 * PI * (0.8 * 0.8 - 0.3 * 0.3), 0.05);
    assert!((396..=1536).contains(&default.faces().len()));
}

#[test]
fn golf_balls() {
    for triangles in [20, 80, 1_000, 10_000] {
        let smooth = GolfBall { dimples: 0, triangles, ..GolfBall::default() };
        let bound = 40.0 / f64::from(triangles);
        check(smooth, 0, 4.0 * PI / 3.0, bound.min(0.5));
    }
    for (dimples, triangles, dimple_depth) in
        [(1, 80, 0.2), (2, 1_000, 0.1), (24, 980, 0.25), (336, 20_480, 0.03), (92, 2_000, 0.05)]
    {
        let ball = GolfBall { dimples, triangles, dimple_depth, ..GolfBall::default() };
        let mesh = check(ball, 0, 4.0 * PI / 3.0, 0.5);
        let frequency = (f64::from(triangles) / 20.0).sqrt().round() as usize;
        assert_eq!(mesh.faces().len(), 20 * frequency * frequency);
        let dented = mesh.vertices().iter().filter(|p| p.length() < 1.0 - 1e-9).count();
        assert!(dented >= dimples as usize && dented < mesh.vertices().len(), "{dented}");
    }
}

/// Volume of the ideal threaded rod, per length, by integrating one pitch of the square of the
/// radius: two flats and two flanks.
fn rod_area(crest: f64, pitch: f64) -> f64 {
    let root = crest - 0.625 * 0.75f64.sqrt() * pitch;
    let flank = (crest * crest + crest * root + root * root) / 3.0;
    PI * (0.125 * crest * crest + 0.25 * root * root + 0.625 * flank)
}

fn hexagon_area(across_flats: f64) -> f64 {
    0.5 * 3f64.sqrt() * across_flats * across_flats
}

#[test]
fn bolts() {
    for (diameter, pitch, segments, flank_segments) in [
        (16.0, 2.0, 144, 1),
        (16.0, 2.0, 12, 1),
        (1.6, 0.35, 50, 3),
        (8.0, 2.0, 13, 2),
        (10.0, 0.5, 31, 1),
    ] {
        for length in [2.0 * pitch, 7.3 * pitch, 10.125 * pitch] {
            for lead_in in [None, Some(0.0), Some(0.2 * pitch), Some(0.9 * pitch)] {
                let bolt = IsoBolt {
                    diameter,
                    pitch,
                    length: Some(length),
                    segments,
                    flank_segments,
                    lead_in,
                    ..IsoBolt::default()
                };
                let head = hexagon_area(1.5 * diameter) * 0.625 * diameter;
                let rod = rod_area(0.5 * diameter, pitch) * length * disc(segments) / PI;
                check(bolt, 0, head + rod, 0.08);
            }
        }
    }
}

#[test]
fn nuts() {
    for (diameter, pitch, segments, flank_segments) in [
        (16.0, 2.0, 144, 4),
        (16.0, 2.0, 12, 1),
        (1.6, 0.35, 50, 3),
        (8.0, 2.0, 13, 2),
        (10.0, 0.5, 31, 1),
    ] {
        for height in [2.0 * pitch, 5.3 * pitch, 6.125 * pitch] {
            for lead_in in [None, Some(0.0), Some(0.2 * pitch), Some(0.9 * pitch)] {
                let nut = IsoNut {
                    diameter,
                    pitch,
                    clearance: 0.05 * pitch,
                    height: Some(height),
                    segments,
                    flank_segments,
                    lead_in,
                    across_flats: Some(2.0 * diameter),
                };
                let crest = 0.5 * diameter + 0.05 * pitch;
                let hole = rod_area(crest, pitch) * disc(segments) / PI;
                let expected = (hexagon_area(2.0 * diameter) - hole) * height;
                check(nut, 1, expected, 0.08);
            }
        }
    }
}

#[test]
fn the_default_m16_pair_has_the_size_of_the_reference_scene() {
    let bolt = check(IsoBolt::default(), 0, 24.0f64.powi(2) * 8.66 + 48.0 * 172.0, 0.03);
    let nut = check(IsoNut::default(), 1, 14.4 * (24.0f64.powi(2) * 0.866 - 174.0), 0.03);
    let (bolt, nut) = (bolt.faces().len(), nut.faces().len());
    assert!((27_000..29_000).contains(&bolt), "bolt: {bolt}");
    assert!((20_000..22_500).contains(&nut), "nut: {nut}");
}

#[test]
fn every_default_builds_a_solid() {
    for shape in Shape::defaults() {
        let mesh = shape.build().unwrap();
        genus_of_closed_shell(&mesh);
        assert!(volume(&mesh) > 0.0, "{}", shape.name());
    }
}

#[test]
fn the_checks_see_what_they_look_for() {
    let cube = Cuboid::default().build().unwrap();
    let mut vertices = cube.vertices().to_vec();
    vertices[6] = DVec3::new(-0.7, -0.8, -0.9); // pulled through the opposite corner
    let pierced = Mesh::new(vertices, cube.faces().to_vec()).unwrap();
    assert!(self_intersection(&pierced).is_some());
    let mut vertices = cube.vertices().to_vec();
    vertices[6] = DVec3::new(0.0, 0.0, -0.5); // onto the middle of the opposite face
    let touching = Mesh::new(vertices, cube.faces().to_vec()).unwrap();
    assert!(self_intersection(&touching).is_some());
    let turned = cube.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(volume(&Mesh::new(cube.vertices().to_vec(), turned).unwrap()) < 0.0);
}
