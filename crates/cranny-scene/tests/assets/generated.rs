//! The text of every committed asset.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_scene::encode_obj;
use cranny_shapes::{LPrism, UPrism};

use crate::{arm, cell, crowds, house, physical, vehicles};

/// Path under `assets/` and content.
pub(crate) fn files() -> Vec<(String, String)> {
    let mut files = vec![
        ("scenes/ring_of_tori.ron".to_owned(), ring_of_tori()),
        ("scenes/nut_on_bolt.ron".to_owned(), nut_on_bolt()),
        ("scenes/mixed_pile.ron".to_owned(), mixed_pile(500, 10.0, 23.0, 24.0)),
        ("scenes/mixed_pile_50.ron".to_owned(), mixed_pile(50, 5.0, 10.0, 11.0)),
        ("scenes/robot_arm.ron".to_owned(), arm::scene()),
        ("scenes/house.ron".to_owned(), house::house()),
        ("scenes/automobile.ron".to_owned(), vehicles::automobile()),
        ("scenes/submarine.ron".to_owned(), vehicles::submarine()),
        ("meshes/l.obj".to_owned(), encode_obj(&cut(&LPrism::default().build().unwrap(), 5))),
        ("meshes/u.obj".to_owned(), encode_obj(&cut(&UPrism::default().build().unwrap(), 4))),
    ];
    files.extend(crowds::files());
    files.extend(physical::files());
    files.extend(arm::files());
    files.extend(cell::files());
    files
}

/// Nine digits, as a quaternion of unit length needs and a reader bears.
pub(crate) fn number(x: f64) -> String {
    let rounded = format!("{x:.9}");
    let short = rounded.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// How far apart the centres of neighbouring links are. In a straight chain the tube of one would
/// lie 0.65 from the other's, a gap of 0.25; the ring's bends leave half of it.
const SPACING: f64 = 1.35;

fn ring_of_tori() -> String {
    let mut s = String::from(
        "// A closed chain of twelve interlinked tori, hanging from the first. Their centres lie on a\n\
         // circle in the xz plane; every other torus is turned by 90 degrees about the circle's \
         tangent.\n\
         (\n    version: 1,\n    gravity: (0, 0, -9.81),\n    step: 0.004166666666666667, // 1/240 s\n    duration: 5,\n    bodies: [\n",
    );
    let radius = 0.5 * SPACING / (PI / 12.0).sin();
    for i in 0..12 {
        let angle = TAU * f64::from(i) / 12.0;
        let at = [radius * angle.sin(), 0.0, radius * angle.cos()];
        // A torus lies in its xy plane. Even ones: z axis to y, about x. Odd ones: z axis to the
        // circle's radius, about y.
        let half = if i % 2 == 0 { -0.25 * PI } else { 0.5 * angle };
        let rotation = if i % 2 == 0 {
            [half.sin(), 0.0, 0.0, half.cos()]
        } else {
            [0.0, half.sin(), 0.0, half.cos()]
        };
        let kind = if i == 0 { "Fixed" } else { "Dynamic" };
        let list =
            |numbers: &[f64]| numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            s,
            "        (\n            name: \"torus_{i}\",\n            shape: Generator(Torus(major_radius: 1, minor_radius: 0.2, major_segments: 64, minor_segments: 16)),\n            kind: {kind},\n            pose: (at: ({}), rotation: ({})),\n            material: (density: 1, friction: 0.5, restitution: 0),\n        ),",
            list(&at),
            list(&rotation)
        );
    }
    s + "    ],\n    effects: [Response(), Contacts(margin: 0.01)],\n    cameras: [(name: \"main\", look_at: (eye: (11, -15, 1), target: (0, 0, -2.2), field_of_view: 0.68)), (name: \"front\", preset: Front)],\n    record: (every: 4),\n)\n"
}

fn nut_on_bolt() -> String {
    "// An M16 x 2 nut, spun once a second up its fixed bolt without friction: it should climb 2 mm a turn.
// One unit is a millimetre. Gravity keeps the number that it has in metres: 9.81 units/s^2, \
gentle here.
// The nut stands at a multiple of the pitch, where it fits unturned, with 0.1 mm of radial \
clearance.
(
    version: 1,
    gravity: (0, 0, -9.81),
    step: 0.004166666666666667, // 1/240 s
    duration: 5,
    bodies: [
        (
            name: \"bolt\",
            shape: Generator(IsoBolt(diameter: 16, pitch: 2, segments: 144)),
            kind: Fixed,
            material: (friction: 0),
        ),
        (
            name: \"nut\",
            shape: Generator(IsoNut(diameter: 16, pitch: 2, clearance: 0.1, segments: 144)),
            pose: (at: (0, 0, 20)),
            velocity: (angular: (0, 0, 6.283185307)),
            material: (friction: 0),
        ),
    ],
    effects: [Response(), Contacts(margin: 0.01)],
    cameras: [(name: \"main\", preset: Isometric), (name: \"side\", preset: Side)],
    record: (every: 4),
)
"
    .to_owned()
}

fn mixed_pile(count: u32, inner: f64, region_top: f64, walls: f64) -> String {
    let half = 0.5 * inner;
    let (wall, middle) = (half + 0.5, 0.5 * walls);
    let n = number;
    let mut s = format!(
        "// {count} bodies of six kinds that are not convex, 448 to 1,280 triangles each, dropped into a box.\n(\n    version: 1,\n    gravity: (0, 0, -9.81),\n    step: 0.016666666666666666, // 1/60 s\n    duration: 5,\n    seed: 1,\n    bodies: [\n"
    );
    let mut slab = |name: &str, size: [f64; 3], at: [f64; 3]| {
        let _ = writeln!(
            s,
            "        (name: \"{name}\", shape: Generator(Cuboid(size: ({}, {}, {}))), kind: Fixed, pose: (at: ({}, {}, {}))),",
            n(size[0]),
            n(size[1]),
            n(size[2]),
            n(at[0]),
            n(at[1]),
            n(at[2])
        );
    };
    slab("floor", [inner + 2.0, inner + 2.0, 1.0], [0.0, 0.0, -0.5]);
    slab("wall_west", [1.0, inner + 2.0, walls], [-wall, 0.0, middle]);
    slab("wall_east", [1.0, inner + 2.0, walls], [wall, 0.0, middle]);
    slab("wall_south", [inner, 1.0, walls], [0.0, -wall, middle]);
    slab("wall_north", [inner, 1.0, walls], [0.0, wall, middle]);
    let _ = write!(
        s,
        "    ],
    groups: [
        Pile(
            name: \"piece\",
            count: {count},
            region: (min: (-{h}, -{h}, 0.2), max: ({h}, {h}, {top})),
            shapes: [
                Mesh(path: \"../meshes/l.obj\"),
                Mesh(path: \"../meshes/u.obj\"),
                Generator(CPrism(segments: 64)),
                Generator(Cup(segments: 64)),
                Generator(Gear(teeth: 16, module: 0.06, thickness: 0.3, bore: 0.18)),
                Generator(GolfBall(radius: 0.5, dimples: 32, dimple_depth: 0.05, triangles: 1280)),
            ],
            material: (density: 1, friction: 0.5, restitution: 0),
        ),
    ],
    effects: [Response(), Contacts(margin: 0.02)],
    cameras: [(name: \"main\", look_at: (eye: ({eye}, -{eye}, {up}), target: (0, 0, {aim})))],
)
",
        h = n(half),
        top = n(region_top),
        eye = n(1.6 * walls.max(inner)),
        up = n(2.0 * walls),
        aim = n(0.25 * walls),
    );
    s
}

/// Every triangle cut into `parts`² equal ones, with shared vertices on shared edges.
pub(crate) fn cut(mesh: &Mesh, parts: u32) -> Mesh {
    let mut vertices = mesh.vertices().to_vec();
    let mut on_edge: HashMap<(u32, u32, u32), u32> = HashMap::new();
    let mut faces = Vec::new();
    for &[a, b, c] in mesh.faces() {
        let mut grid: HashMap<(u32, u32), u32> = HashMap::new();
        for i in 0..=parts {
            for j in 0..=parts - i {
                let weights = [parts - i - j, i, j];
                let corners = [a, b, c];
                let zero = weights.iter().filter(|&&w| w == 0).count();
                let mut add = |terms: &[(u32, u32)]| {
                    let sum: DVec3 = terms
                        .iter()
                        .map(|&(v, w)| mesh.vertices()[v as usize] * f64::from(w))
                        .sum();
                    vertices.push(sum / f64::from(parts));
                    vertices.len() as u32 - 1
                };
                let mut terms: Vec<(u32, u32)> =
                    corners.into_iter().zip(weights).filter(|&(_, w)| w > 0).collect();
                terms.sort_unstable();
                let index = match zero {
                    2 => terms[0].0,
                    1 => {
                        let key = (terms[0].0, terms[1].0, terms[1].1);
                        *on_edge.entry(key).or_insert_with(|| add(&terms))
                    }
                    _ => add(&terms),
                };
                grid.insert((i, j), index);
            }
        }
        for i in 0..parts {
            for j in 0..parts - i {
                let at = |di: u32, dj: u32| grid[&(i + di, j + dj)];
                faces.push([at(0, 0), at(1, 0), at(0, 1)]);
                if i + j + 2 <= parts {
                    faces.push([at(1, 0), at(1, 1), at(0, 1)]);
                }
            }
        }
    }
    Mesh::new(vertices, faces).unwrap()
}
