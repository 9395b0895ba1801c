//! The new faces of a step of quickhull, stored so that a point is held against several of them at
//! once.
//!
//! Whether a point lies above a face cannot be foretold, and a branch that the machine foretells
//! wrongly takes longer than the test: so several faces are tested in one go, and what they say
//! is looked at once.
//!
//! Source: none; which face is meant is the same as when one after the other is tested. Cost: O(1)
//! a face.

use cranny_exact::{DVec3, Sign};

use super::side::Side;
use crate::rows::NOBODY;

/// Faces that are tested at once. Smaller, and there are more branches; larger, and faces are
/// tested for nothing.
const LANES: usize = 4;

/// The faces that close a hole.
#[derive(Default)]
pub(super) struct Fan {
    blocks: Vec<Block>,
    count: usize,
}

/// Some faces: their sides, by component.
struct Block {
    normals: [[f64; LANES]; 3],
    anchors: [[f64; LANES]; 3],
    margins: [f64; LANES],
    faces: [u32; LANES],
}

impl Block {
    /// Stands for no faces: every point is far below each.
    const EMPTY: Self = Self {
        normals: [[1.0; LANES], [0.0; LANES], [0.0; LANES]],
        anchors: [[f64::MAX; LANES], [0.0; LANES], [0.0; LANES]],
        margins: [0.0; LANES],
        faces: [NOBODY; LANES],
    };

    /// As [`Side::height`] of each.
    #[inline]
    fn heights(&self, p: DVec3) -> [f64; LANES] {
        let [nx, ny, nz] = &self.normals;
        let [ax, ay, az] = &self.anchors;
        std::array::from_fn(|i| {
            nx[i] * (p.x - ax[i]) + ny[i] * (p.y - ay[i]) + nz[i] * (p.z - az[i])
        })
    }
}

impl Fan {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.count = 0;
    }

    pub(super) fn push(&mut self, face: u32, side: &Side) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.blocks.push(Block::EMPTY);
        }
        self.count += 1;
        if let Some(block) = self.blocks.last_mut() {
            for axis in 0..3 {
                block.normals[axis][lane] = side.normal[axis];
                block.anchors[axis][lane] = side.anchor[axis];
            }
            block.margins[lane] = side.margin();
            block.faces[lane] = face;
        }
    }

    pub(super) fn faces(&self) -> impl Iterator<Item = u32> + '_ {
        self.blocks.iter().flat_map(|block| block.faces).take(self.count)
    }

    /// The first face that a point lies strictly above, and its height. `exactly` returns the side
    /// where the height is within the margin.
    #[inline]
    pub(super) fn first_above(
        &self,
        p: DVec3,
        exactly: impl Fn(u32, f64) -> Sign,
    ) -> Option<(u32, f64)> {
        self.blocks.iter().find_map(|block| {
            let heights = block.heights(p);
            let above: [f64; LANES] = std::array::from_fn(|i| heights[i] - block.margins[i]);
            let clear: [f64; LANES] = std::array::from_fn(|i| heights[i].abs() - block.margins[i]);
            let least =
                clear.into_iter().fold(f64::MAX, |least, x| if x < least { x } else { least });
            if least <= 0.0 {
                let is_above = |&i: &usize| {
                    block.faces[i] != NOBODY
                        && exactly(block.faces[i], heights[i]) == Sign::Positive
                };
                return (0..LANES).find(is_above).map(|i| (block.faces[i], heights[i]));
            }
            let first = above.iter().position(|&x| x > 0.0)?;
            Some((block.faces[first], heights[first]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_face_above_which_a_point_lies_is_the_one_that_asking_each_in_turn_finds() {
        let mut state = 1u64;
        let mut number = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let (mut near, mut found) = (0, 0);
        for count in 1..=11 {
            for _ in 0..200 {
                let triangles: Vec<[DVec3; 3]> = (0..count)
                    .map(|_| [(); 3].map(|()| DVec3::new(number(), number(), number())))
                    .collect();
                let sides: Vec<Side> =
                    triangles.iter().map(|&t| Side::new(t, DVec3::ONE)).collect();
                let mut fan = Fan::default();
                for (face, side) in (0..).zip(&sides) {
                    fan.push(10 * face, side);
                }
                assert!(fan.faces().eq((0..count).map(|face| 10 * face)));
                // In the plane of one of them, but for rounding.
                let [a, b, c] = triangles[(number() * f64::from(count)) as usize];
                let p = a + number() * (b - a) + number() * (c - a);
                let sign = |face: u32, height: f64| {
                    sides[face as usize].sign(height, p, || triangles[face as usize])
                };
                let in_turn = (0..count).find_map(|face| {
                    let height = sides[face as usize].height(p);
                    near += u32::from(height.abs() <= sides[face as usize].margin());
                    (sign(face, height) == Sign::Positive).then_some((10 * face, height))
                });
                found += u32::from(in_turn.is_some());
                assert_eq!(fan.first_above(p, |face, height| sign(face / 10, height)), in_turn);
            }
        }
        assert!(near > 500 && found > 500, "{near} {found}");
    }
}
