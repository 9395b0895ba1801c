//! Solids made of the cells of a grid, which a map may bend: boxes added and cut, in any number.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use cranny_exact::DVec3;
use cranny_geometry::Mesh;

use crate::builder::MeshBuilder;
use crate::error::{Checked, MAX_FACES, MIN_DETAIL, ShapeError};

/// Coordinates of an axis.
type Axis = Vec<f64>;

/// A box, and whether it is solid.
struct Block {
    solid: bool,
    min: DVec3,
    max: DVec3,
}

/// Boxes in order: what is added and cut later counts.
#[derive(Default)]
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    /// Where x is an angle: a whole turn.
    period: Option<f64>,
}

impl Blocks {
    /// x is an angle and `period` a whole turn; boxes may run beyond it.
    pub(crate) fn around(period: f64) -> Self {
        Self { blocks: Vec::new(), period: Some(period) }
    }

    pub(crate) fn add(self, min: [f64; 3], max: [f64; 3]) -> Self {
        self.with(true, min, max)
    }

    pub(crate) fn cut(self, min: [f64; 3], max: [f64; 3]) -> Self {
        self.with(false, min, max)
    }

    fn with(mut self, solid: bool, min: [f64; 3], max: [f64; 3]) -> Self {
        let [min, max] = [min, max].map(DVec3::from);
        self.blocks.push(Block { solid, min, max });
        self
    }

    /// The boundary of the solid.
    pub(crate) fn build(self, checked: &Checked) -> Result<Mesh, ShapeError> {
        self.bent(checked, [f64::INFINITY; 3], |p| p)
    }

    /// The boundary of the solid, cut into pieces no longer than `longest` along the axes, its
    /// vertices mapped. The map keeps orientation and takes neighbouring cells to bodies that meet
    /// only where the cells do.
    pub(crate) fn bent(
        self,
        checked: &Checked,
        longest: [f64; 3],
        map: impl Fn(DVec3) -> DVec3,
    ) -> Result<Mesh, ShapeError> {
        let axes = [0, 1, 2].map(|axis| self.axis(axis, longest[axis]));
        let counts = axes.each_ref().map(|axis| axis.len() as u64 - 1);
        if counts.iter().try_fold(1, |n: u64, &c| n.checked_mul(c)).is_none_or(|n| n > MAX_FACES) {
            return checked.faces(u64::MAX).and(Err(ShapeError::Outline { shape: checked.shape }));
        }
        let cells = Cells::new(&self, axes);
        if let Some(corner) = cells.pinched() {
            let at = cells.point(corner).to_array();
            return Err(ShapeError::Pinched { shape: checked.shape, at });
        }
        cells.boundary(map).finish(checked.shape)
    }

    /// The coordinates of an axis, rising; those nearer together than the least detail are one.
    fn axis(&self, axis: usize, longest: f64) -> Axis {
        let ends = self.blocks.iter().flat_map(|block| [block.min[axis], block.max[axis]]);
        let mut at: Axis = ends.collect();
        if let Some(period) = self.period.filter(|_| axis == 0) {
            at.iter_mut().for_each(|x| *x = x.rem_euclid(period));
            at.extend([0.0, period]);
        }
        at.sort_by(f64::total_cmp);
        let extent = at.last().zip(at.first()).map_or(0.0, |(last, first)| last - first);
        let last = at.last().copied();
        at.dedup_by(|b, a| *b - *a <= MIN_DETAIL * extent);
        if let Some((end, last)) = at.last_mut().zip(last) {
            *end = last;
        }
        refined(&at, longest)
    }

    fn holds(&self, p: DVec3) -> bool {
        let inside = |block: &&Block| {
            let beyond = p - block.min;
            let along_x = self.period.map_or(beyond.x, |period| beyond.x.rem_euclid(period));
            let along = DVec3::new(along_x, beyond.y, beyond.z);
            along.cmpgt(DVec3::ZERO).all() && along.cmplt(block.max - block.min).all()
        };
        self.blocks.iter().rev().find(inside).is_some_and(|block| block.solid)
    }
}

/// The same coordinates with others between them, evenly.
fn refined(at: &[f64], longest: f64) -> Axis {
    let mut all: Axis = at.first().copied().into_iter().collect();
    for pair in at.windows(2) {
        let parts = ((pair[1] - pair[0]) / longest).ceil().max(1.0) as u32;
        let inner = |k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(parts);
        all.extend((1..parts).map(inner).chain([pair[1]]));
    }
    all
}

/// Which cells of a grid are solid.
struct Cells {
    axes: [Axis; 3],
    counts: [i64; 3],
    wraps: bool,
    solid: Vec<bool>,
}

/// The faces of a cell, seen from outside counter-clockwise: the neighbour, and the corners.
const SIDES: [([i64; 3], [[i64; 3]; 4]); 6] = [
    ([-1, 0, 0], [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]),
    ([1, 0, 0], [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]]),
    ([0, -1, 0], [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]),
    ([0, 1, 0], [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]]),
    ([0, 0, -1], [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]),
    ([0, 0, 1], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]),
];

impl Cells {
    fn new(blocks: &Blocks, axes: [Axis; 3]) -> Self {
        let counts = axes.each_ref().map(|axis| axis.len() as i64 - 1);
        let middle =
            |axis: usize, i: i64| 0.5 * (axes[axis][i as usize] + axes[axis][i as usize + 1]);
        let solid = every(counts)
            .map(|[i, j, k]| blocks.holds(DVec3::new(middle(0, i), middle(1, j), middle(2, k))))
            .collect();
        Self { axes, counts, wraps: blocks.period.is_some(), solid }
    }

    fn is_solid(&self, [i, j, k]: [i64; 3]) -> bool {
        let [nx, ny, nz] = self.counts;
        let i = if self.wraps { i.rem_euclid(nx) } else { i };
        let within = (0..nx).contains(&i) && (0..ny).contains(&j) && (0..nz).contains(&k);
        within && self.solid[((i * ny + j) * nz + k) as usize]
    }

    fn point(&self, corner: [i64; 3]) -> DVec3 {
        DVec3::from([0, 1, 2].map(|axis| self.axes[axis][corner[axis] as usize]))
    }

    /// A corner at which solid or space around it hangs together by an edge or a point alone.
    fn pinched(&self) -> Option<[i64; 3]> {
        every(self.counts.map(|n| n + 1)).find(|&[i, j, k]| {
            let around = |bit: usize| {
                let [di, dj, dk] = [bit & 1, bit >> 1 & 1, bit >> 2].map(|d| d as i64 - 1);
                self.is_solid([i + di, j + dj, k + dk])
            };
            let solid = (0..8).filter(|&bit| around(bit)).fold(0_u8, |bits, bit| bits | 1 << bit);
            !hangs_together(solid) || !hangs_together(!solid)
        })
    }

    fn boundary(&self, map: impl Fn(DVec3) -> DVec3) -> MeshBuilder {
        let mut builder = MeshBuilder::default();
        let mut known: BTreeMap<[i64; 3], (u32, DVec3)> = BTreeMap::new();
        let mut vertex = |builder: &mut MeshBuilder, corner: [i64; 3]| {
            let [mut i, j, k] = corner;
            if self.wraps {
                i = i.rem_euclid(self.counts[0]);
            }
            match known.entry([i, j, k]) {
                Entry::Occupied(found) => *found.get(),
                Entry::Vacant(place) => {
                    let p = map(self.point([i, j, k]));
                    *place.insert((builder.vertex(p), p))
                }
            }
        };
        for cell in every(self.counts).filter(|&cell| self.is_solid(cell)) {
            for (step, corners) in SIDES {
                if self.is_solid(plus(cell, step)) {
                    continue;
                }
                let corners = corners.map(|corner| vertex(&mut builder, plus(cell, corner)));
                let [a, b, c, d] = corners.map(|(index, _)| index);
                let [p, q, r, s] = corners.map(|(_, point)| point);
                // The shorter diagonal bends the surface less.
                if p.distance_squared(r) <= q.distance_squared(s) {
                    builder.quad(a, b, c, d);
                } else {
                    builder.quad(b, c, d, a);
                }
            }
        }
        builder
    }
}

fn plus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// All indices below the counts, the last one running fastest.
fn every([nx, ny, nz]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
}

/// Whether those of the eight cells about a corner that are set reach each other through faces.
fn hangs_together(cells: u8) -> bool {
    let Some(first) = (0..8).find(|bit| cells >> bit & 1 == 1) else { return true };
    let mut reached = 1_u8 << first;
    loop {
        // A face leads from a cell to one whose number differs in one bit.
        let across = |mask: u8, shift: u32| (reached & mask) << shift | (reached >> shift & mask);
        let next = (reached | across(0x55, 1) | across(0x33, 2) | across(0x0f, 4)) & cells;
        if next == reached {
            return reached == cells;
        }
        reached = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHECKED: Checked = Checked { shape: "Boxes" };

    #[test]
    fn cells_about_a_corner_hang_together_through_faces_only() {
        assert!(hangs_together(0) && hangs_together(0xff) && hangs_together(0b11));
        assert!(!hangs_together(0b1001) && !hangs_together(0b1000_0001));
        assert!(hangs_together(0b1011) && hangs_together(0b1101_0101));
    }

    #[test]
    fn boxes_that_touch_along_an_edge_are_refused_where_they_do() {
        let blocks =
            Blocks::default().add([0.0; 3], [1.0; 3]).add([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]);
        let error = blocks.build(&CHECKED).unwrap_err();
        assert_eq!(error, ShapeError::Pinched { shape: "Boxes", at: [1.0, 1.0, 0.0] });
    }

    #[test]
    fn coordinates_that_differ_by_rounding_are_one() {
        let blocks =
            Blocks::default().add([0.0; 3], [0.3; 3]).add([0.1 + 0.2, 0.0, 0.0], [1.0, 0.3, 0.3]);
        assert_eq!(blocks.build(&CHECKED).unwrap().faces().len(), 20);
    }

    #[test]
    fn a_ring_closes_where_its_angle_ends() {
        let ring = Blocks::around(4.0).add([3.5, 1.0, 0.0], [7.5, 2.0, 1.0]);
        let mesh = ring
            .bent(&CHECKED, [1.0, 9.0, 9.0], |p| {
                let turn = cranny_exact::DVec2::from_angle(0.25 * std::f64::consts::TAU * p.x);
                (p.y * turn).extend(p.z)
            })
            .unwrap();
        // Cut at 0, 1, 2, 3 and 3.5; four sides of two triangles each.
        assert_eq!(mesh.faces().len(), 5 * 4 * 2);
    }
}
