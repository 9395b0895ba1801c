//! Things by where they stand, seen along a direction: boxes in the plane at right angles to it.
//!
//! Boxes lie side by side in lanes, eight to a block, in single precision and grown by more than
//! that rounds. Of few things all blocks are looked at. Many are listed in every cell of a grid
//! that their boxes meet; it has about as many cells as things, or fewer if these are long: no more
//! than [`LISTINGS`] listings a thing.

use cranny_exact::DVec3;
use wide::f32x8;

use crate::search::lanes_of;

/// Boxes in a block.
const LANES: usize = 8;

/// As many things are not worth a grid. More: all are looked at for each; fewer: a grid is made
/// that costs more than it spares.
const FEW: usize = 384;

/// Listings a thing on average, at most. More: memory; fewer: coarser grids around long things.
const LISTINGS: usize = 12;

/// By what part of the plane's extent a box is grown: more than coordinates in the plane are off by
/// rounding. Smaller, and what stands over a point could be lost; larger, and what stands beside it
/// is found too. (Single precision loses nothing: it rounds a box and a point in it alike.)
const SLACK: f64 = 1e-6;

/// Least and most along each axis of the plane.
type Extent2 = [[f64; 2]; 2];

/// Least and most along each axis, of eight boxes.
type BoxLanes = [[f32x8; 2]; 2];

/// Things by their boxes in a plane.
pub(crate) struct Footprints {
    axes: [DVec3; 2],
    low: [f64; 2],
    blocks: Vec<BoxLanes>,
    grid: Option<Grid>,
}

impl Footprints {
    /// Lists things by the corners of their outlines, seen along `normal` (unit).
    ///
    /// Cost: linear in the things, for each time that a grid proves too fine.
    pub(crate) fn of<'o>(normal: DVec3, outlines: impl Iterator<Item = &'o [DVec3]>) -> Self {
        let axes: [DVec3; 2] = normal.any_orthonormal_pair().into();
        let boxes: Vec<Extent2> = outlines.map(|outline| seen(&axes, outline)).collect();
        let mut plane = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for seen in &boxes {
            for (all, [least, most]) in plane.iter_mut().zip(seen) {
                *all = [all[0].min(*least), all[1].max(*most)];
            }
        }
        let extent = plane.map(|[least, most]| (most - least).max(0.0));
        let slack = SLACK * (extent[0] + extent[1]);
        let low = plane.map(|[least, _]| least);
        let block = |boxes: &[Extent2]| {
            [0, 1].map(|axis| {
                // No box meets the lanes that are left over.
                let (mut least, mut most) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
                for (lane, seen) in boxes.iter().enumerate() {
                    least[lane] = (seen[axis][0] - low[axis] - slack) as f32;
                    most[lane] = (seen[axis][1] - low[axis] + slack) as f32;
                }
                [f32x8::from(least), f32x8::from(most)]
            })
        };
        let grid = (boxes.len() > FEW).then(|| Grid::of(&boxes, low, extent, slack));
        Self { axes, low, blocks: boxes.chunks(LANES).map(block).collect(), grid }
    }

    /// Replaces `found` by the numbers below `end`, ascending, of all things whose footprints may
    /// meet that of an outline or a point, and of some more.
    pub(crate) fn beside(&self, outline: &[DVec3], end: usize, found: &mut Vec<u32>) {
        found.clear();
        let around = seen(&self.axes, outline);
        if let Some(grid) = &self.grid {
            let listed = grid.beside(&around);
            found.extend(listed.flat_map(|cell| cell.iter().take_while(|&&i| i < end as u32)));
            found.sort_unstable();
            found.dedup();
            return;
        }
        let [[left, right], [bottom, top]] =
            [0, 1].map(|axis| around[axis].map(|x| f32x8::splat((x - self.low[axis]) as f32)));
        for (number, [[least_x, most_x], [least_y, most_y]]) in
            self.blocks.iter().take(end.div_ceil(LANES)).enumerate()
        {
            let meets = least_x.simd_le(right)
                & most_x.simd_ge(left)
                & least_y.simd_le(top)
                & most_y.simd_ge(bottom);
            for lane in lanes_of(meets.to_bitmask()) {
                let thing = number * LANES + lane;
                if thing < end {
                    found.push(thing as u32);
                }
            }
        }
    }
}

/// Things listed by the cells of a plane.
struct Grid {
    low: [f64; 2],
    slack: f64,
    /// Cells a length.
    scale: [f64; 2],
    cells: usize,
    /// Where each cell's list begins, row by row, and the end of the last.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl Grid {
    fn of(boxes: &[Extent2], low: [f64; 2], extent: [f64; 2], slack: f64) -> Self {
        let cells = (boxes.len() as f64).sqrt().ceil() as usize;
        let (starts, listed) = (Vec::new(), Vec::new());
        let mut grid = Self { low, slack, scale: [0.0; 2], cells, starts, listed };
        let mut spans: Vec<[[usize; 2]; 2]> = Vec::with_capacity(boxes.len());
        loop {
            grid.scale = extent.map(|e| if e > 0.0 { grid.cells as f64 / e } else { 0.0 });
            spans.clear();
            spans.extend(boxes.iter().map(|seen| grid.span(seen)));
            let listings: usize =
                spans.iter().map(|[[a, b], [c, d]]| (b - a + 1) * (d - c + 1)).sum();
            if grid.cells == 1 || listings <= LISTINGS * boxes.len() {
                break;
            }
            grid.cells = grid.cells.div_ceil(2);
        }
        grid.list(&spans);
        grid
    }

    /// First and last column, first and last row of a box in the plane.
    fn span(&self, seen: &Extent2) -> [[usize; 2]; 2] {
        [0, 1].map(|i| {
            let [least, most] = seen[i];
            // A cast saturates: what lies before the first cell counts as in it.
            let cell = |x: f64| (((x - self.low[i]) * self.scale[i]) as usize).min(self.cells - 1);
            [cell(least - self.slack), cell(most + self.slack)]
        })
    }

    fn list(&mut self, spans: &[[[usize; 2]; 2]]) {
        let cells = self.cells;
        let cells_of = |&[[left, right], [bottom, top]]: &[[usize; 2]; 2]| {
            (bottom..=top).flat_map(move |row| (left..=right).map(move |c| row * cells + c))
        };
        // Counted two places on, so that filling leaves each start where it belongs.
        self.starts = vec![0; cells * cells + 2];
        for cell in spans.iter().flat_map(cells_of) {
            self.starts[cell + 2] += 1;
        }
        for cell in 2..cells * cells + 2 {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.listed = vec![0; self.starts[cells * cells + 1] as usize];
        for (thing, span) in spans.iter().enumerate() {
            for cell in cells_of(span) {
                let next = &mut self.starts[cell + 1];
                self.listed[*next as usize] = thing as u32;
                *next += 1;
            }
        }
    }

    /// The lists, each ascending, of the cells that a box meets.
    fn beside(&self, around: &Extent2) -> impl Iterator<Item = &[u32]> {
        let [[left, right], [bottom, top]] = self.span(around);
        let cells = (bottom..=top)
            .flat_map(move |row| (left..=right).map(move |column| row * self.cells + column));
        cells.map(|cell| &self.listed[self.starts[cell] as usize..self.starts[cell + 1] as usize])
    }
}

/// The box of an outline in the plane.
fn seen(axes: &[DVec3; 2], outline: &[DVec3]) -> Extent2 {
    axes.map(|axis| {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for p in outline {
            let along = axis.dot(*p);
            range = [range[0].min(along), range[1].max(along)];
        }
        range
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen from above.
    fn of<const N: usize>(outlines: &[[DVec3; N]]) -> Footprints {
        Footprints::of(DVec3::Z, outlines.iter().map(|o| o.as_slice()))
    }

    /// `n` by `n` unit squares in the plane z = x, seen from above.
    fn squares(n: u32) -> Vec<[DVec3; 4]> {
        let at = |x: u32, y: u32| DVec3::new(f64::from(x), f64::from(y), f64::from(x));
        let square = |i: u32| {
            let (x, y) = (i % n, i / n);
            [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]
        };
        (0..n * n).map(square).collect()
    }

    /// Few, and so many that they get a grid.
    const SIDES: [u32; 2] = [10, 20];

    #[test]
    fn what_stands_over_a_point_is_listed_and_little_else() {
        for n in SIDES {
            let (footprints, mut over) = (of(&squares(n)), Vec::new());
            let all = (n * n) as usize;
            assert_eq!(footprints.grid.is_some(), all > FEW);
            for (x, y) in [(0.5, 0.5), (7.25, 3.5), (9.5, 9.5)] {
                footprints.beside(&[DVec3::new(x, y, -7.0)], all, &mut over);
                assert!(over.contains(&(y as u32 * n + x as u32)), "{x} {y}: {over:?}");
                assert!(over.len() <= 9, "{over:?}");
            }
            // On a rim: both neighbours.
            footprints.beside(&[DVec3::new(5.0, 5.5, 0.0)], all, &mut over);
            assert!(over.contains(&(5 * n + 4)) && over.contains(&(5 * n + 5)), "{over:?}");
        }
    }

    #[test]
    fn an_outline_finds_every_neighbour_once() {
        for n in SIDES {
            let (footprints, mut found) = (of(&squares(n)), vec![7]);
            let along = [DVec3::new(2.5, 2.5, 0.0), DVec3::new(2.5, 8.5, 3.0)];
            footprints.beside(&along, (n * n) as usize, &mut found);
            assert!((2..9).map(|y| y * n + 2).all(|i| found.contains(&i)), "{found:?}");
            assert!(found.is_sorted_by(|a, b| a < b) && found.len() <= 40, "{found:?}");
            let below: Vec<u32> = found.iter().copied().filter(|&i| i < 50).collect();
            footprints.beside(&along, 50, &mut found);
            assert_eq!(found, below);
        }
    }

    #[test]
    fn long_things_make_the_grid_coarser_and_nothing_is_lost() {
        let needle = |i: u32| {
            let y = 0.01 * f64::from(i);
            [DVec3::new(0.0, y, 0.0), DVec3::new(100.0, 100.0 + y, 0.0)]
        };
        let needles: Vec<_> = (0..500).map(needle).collect();
        let footprints = of(&needles);
        assert!(footprints.grid.as_ref().unwrap().listed.len() <= LISTINGS * 500);
        let mut found = Vec::new();
        let across = [DVec3::new(50.0, 40.0, 0.0), DVec3::new(50.0, 60.0, 0.0)];
        footprints.beside(&across, 500, &mut found);
        assert_eq!(found.len(), 500);
    }

    #[test]
    fn nothing_and_points_in_one_place_are_no_trouble() {
        let none: [[DVec3; 3]; 0] = [];
        let mut found = vec![7];
        of(&none).beside(&[DVec3::ONE], 9, &mut found);
        assert!(found.is_empty());
        for count in [5, 500] {
            of(&vec![[DVec3::ONE; 3]; count]).beside(&[DVec3::ONE], count, &mut found);
            assert!(found.iter().copied().eq(0..count as u32), "{count}: {found:?}");
        }
    }
}
