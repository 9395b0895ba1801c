//! A mug with a handle, and the hook that takes it by the handle: meshes of the robot cell. Lengths
//! in metres.

use std::f64::consts::{PI, TAU};

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_scene::encode_obj;

use crate::{assert_apart, scene};

pub(crate) fn files() -> Vec<(String, String)> {
    vec![
        ("meshes/mug.obj".to_owned(), encode_obj(&mug())),
        ("robots/arm/meshes/hook.obj".to_owned(), encode_obj(&hook())),
    ]
}

/// A mesh in the making.
#[derive(Default)]
struct Draft {
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

impl Draft {
    fn vertex(&mut self, x: f64, y: f64, z: f64) -> u32 {
        self.vertices.push(DVec3::new(x, y, z));
        self.vertices.len() as u32 - 1
    }

    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.faces.extend([[a, b, c], [a, c, d]]);
    }

    /// A circle about z, and the number that its vertex at angle 0 has, or would have: the first so
    /// many vertices are left out.
    fn ring(&mut self, radius: f64, z: f64, left_out: u32) -> u32 {
        let first = self.vertices.len() as u32 - left_out;
        for s in left_out..SEGMENTS {
            let (sin, cos) = (f64::from(s) * TAU / f64::from(SEGMENTS)).sin_cos();
            self.vertex(radius * cos, radius * sin, z);
        }
        first
    }

    /// What joins two circles; an open one has a hole on either side of angle 0.
    fn band(&mut self, low: u32, high: u32, open: bool) {
        for s in 0..SEGMENTS {
            let next = (s + 1) % SEGMENTS;
            if !open || (s > 0 && next > 0) {
                self.quad([low + s, low + next, high + next, high + s]);
            }
        }
    }

    fn finish(self) -> Mesh {
        Mesh::new(self.vertices, self.faces).unwrap()
    }
}

/// Around the mug's axis.
const SEGMENTS: u32 = 48;

/// Of the circles of the mug's outside. The handle grows out of the second to the fourth and out of
/// the fifth to the seventh.
const HEIGHTS: [f64; 8] = [0.0, 0.006, 0.013, 0.02, 0.115, 0.122, 0.129, 0.14];

const OUTER_RADIUS: f64 = 0.05;
const INNER_RADIUS: f64 = 0.043;
const FLOOR: f64 = 0.008;

/// Radius of the handle's tube, and of its bends, to the middle of the tube.
const TUBE: f64 = 0.007;
const BEND: f64 = 0.012;

/// From the mug's axis to where the bends begin.
const REACH: f64 = 0.075;

/// The vertices of a hole as (segment, circle), the way around in which the tube's vertices go.
const HOLE: [(u32, usize); 8] = [(1, 1), (1, 2), (0, 2), (47, 2), (47, 1), (47, 0), (0, 0), (1, 0)];

/// It stands on z = 0, its handle at +x.
fn mug() -> Mesh {
    let mut draft = Draft::default();
    let mut outer = [0; 8];
    for (i, z) in HEIGHTS.into_iter().enumerate() {
        outer[i] = draft.ring(OUTER_RADIUS, z, u32::from(i == 2 || i == 5));
    }
    let rim = draft.ring(INNER_RADIUS, HEIGHTS[7], 0);
    let floor = draft.ring(INNER_RADIUS, FLOOR, 0);
    let [below, above] = [0.0, FLOOR].map(|z| draft.vertex(0.0, 0.0, z));
    for (i, pair) in outer.windows(2).enumerate() {
        draft.band(pair[0], pair[1], [1, 2, 4, 5].contains(&i));
    }
    draft.band(outer[7], rim, false);
    draft.band(rim, floor, false);
    for s in 0..SEGMENTS {
        let next = (s + 1) % SEGMENTS;
        draft.faces.push([floor + s, floor + next, above]);
        draft.faces.push([outer[0] + next, outer[0] + s, below]);
    }
    handle(&mut draft, &outer);
    draft.finish()
}

/// A tube from the upper hole out, down and back into the lower one.
fn handle(draft: &mut Draft, outer: &[u32; 8]) {
    let hole = |circles: [usize; 3]| HOLE.map(|(s, circle)| outer[circles[circle]] + s);
    let mut rings = vec![hole([4, 5, 6])];
    for (first, z) in [(0, HEIGHTS[5] - BEND), (4, HEIGHTS[2] + BEND)] {
        for station in first..=first + 4 {
            let (sin, cos) = (f64::from(station) * PI / 8.0).sin_cos();
            rings.push([0, 1, 2, 3, 4, 5, 6, 7].map(|k| {
                let (outward, aside) = (f64::from(k) * TAU / 8.0).sin_cos();
                let from_bend = BEND + TUBE * outward;
                draft.vertex(REACH + from_bend * sin, TUBE * aside, z + from_bend * cos)
            }));
        }
    }
    rings.push(hole([3, 2, 1]));
    for pair in rings.windows(2) {
        for k in 0..8 {
            let next = (k + 1) % 8;
            draft.quad([pair[0][k], pair[0][next], pair[1][next], pair[1][k]]);
        }
    }
}

/// Its outline, counter-clockwise, as (y, z): a plate, a shank, a blade with a raised tip. z points
/// away from the arm.
const HOOK: [(f64, f64); 10] = [
    (-0.05, -0.015),
    (0.05, -0.015),
    (0.05, 0.015),
    (-0.032, 0.015),
    (-0.032, 0.075),
    (0.05, 0.075),
    (0.05, 0.065),
    (0.065, 0.065),
    (0.065, 0.13),
    (-0.05, 0.13),
];

/// Triangles that the outline is made of.
const HOOK_SIDE: [[u32; 3]; 8] =
    [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 9], [4, 5, 8], [4, 8, 9], [5, 6, 7], [5, 7, 8]];

/// Half the hook's thickness, along x.
const HOOK_HALF: f64 = 0.011;

fn hook() -> Mesh {
    let mut draft = Draft::default();
    for x in [-HOOK_HALF, HOOK_HALF] {
        for (y, z) in HOOK {
            draft.vertex(x, y, z);
        }
    }
    let count = HOOK.len() as u32;
    for k in 0..count {
        let next = (k + 1) % count;
        draft.quad([k, next, count + next, count + k]);
    }
    for [a, b, c] in HOOK_SIDE {
        draft.faces.push([a, c, b]);
        draft.faces.push([count + a, count + b, count + c]);
    }
    draft.finish()
}

#[test]
fn the_cell_and_the_screws_start_apart() {
    for name in ["robot_cell.ron", "screw_insertion.ron"] {
        assert_apart(&scene(name).description);
    }
}
