//! Things by where they stand, seen along a direction: boxes in the plane at right angles to it.
//!
//! Few things are looked at box by box. Of more, each is listed in every cell of a grid that its box
//! meets. The grid has about as many cells as things, or fewer if these are long: no more than
//! [`LISTINGS`] listings a thing. So what stands over a point is found in constant time where
//! things are of a size and in no crowd.

use cranny_exact::DVec3;

/// As many things are not worth a grid. More: all are looked at for each; fewer: grids are made of
/// regions that few faces bound, which most are.
const FEW: usize = 48;

/// Listings a thing on average, at most. More: memory; fewer: coarser grids around long things.
const LISTINGS: usize = 12;

/// By what part of the plane's extent a box is grown: far more than rounding moves a coordinate,
/// far less than a cell. Smaller, and a point on a rim could be sought beside it; larger, and what
/// stands beside a point is found too.
const SLACK: f64 = 1e-9;

/// Least and most along each axis of the plane.
type Seen = [[f64; 2]; 2];

/// Things by their boxes in a plane.
pub(crate) struct Footprints {
    axes: [DVec3; 2],
    /// Grown by the slack.
    boxes: Vec<Seen>,
    grid: Option<Grid>,
}

impl Footprints {
    /// Lists things by the corners of their outlines, seen along `normal` (unit).
    ///
    /// Cost: linear in the things, for each time that the grid proves too fine.
    pub(crate) fn of<'o>(normal: DVec3, outlines: impl Iterator<Item = &'o [DVec3]>) -> Self {
        let axes: [DVec3; 2] = normal.any_orthonormal_pair().into();
        let mut boxes: Vec<Seen> = outlines.map(|outline| seen(&axes, outline)).collect();
        let mut plane = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for seen in &boxes {
            for (all, [least, most]) in plane.iter_mut().zip(seen) {
                *all = [all[0].min(*least), all[1].max(*most)];
            }
        }
        let extent = plane.map(|[least, most]| (most - least).max(0.0));
        let slack = SLACK * (extent[0] + extent[1]);
        for [least, most] in boxes.iter_mut().flatten() {
            (*least, *most) = (*least - slack, *most + slack);
        }
        let low = plane.map(|[least, _]| least);
        let grid = (boxes.len() > FEW).then(|| Grid::of(&boxes, low, extent));
        Self { axes, boxes, grid }
    }

    /// Replaces `found` by the numbers below `end`, ascending, of all things whose footprints may
    /// meet that of an outline or a point, and of some more.
    pub(crate) fn beside(&self, outline: &[DVec3], end: u32, found: &mut Vec<u32>) {
        found.clear();
        let around = seen(&self.axes, outline);
        let meets = |&thing: &u32| {
            let of_axis = |i: usize| {
                let ([least, most], [from, to]) = (self.boxes[thing as usize][i], around[i]);
                least <= to && from <= most
            };
            of_axis(0) & of_axis(1)
        };
        match &self.grid {
            None => found.extend((0..end.min(self.boxes.len() as u32)).filter(meets)),
            Some(grid) => {
                let listed = grid.beside(&around).map(|cell| {
                    cell.iter().copied().take_while(|&thing| thing < end).filter(meets)
                });
                found.extend(listed.flatten());
                found.sort_unstable();
                found.dedup();
            }
        }
    }
}

/// Things listed by the cells of a plane.
struct Grid {
    low: [f64; 2],
    /// Cells a length.
    scale: [f64; 2],
    cells: usize,
    /// Where each cell's list begins, row by row, and the end of the last.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl Grid {
    fn of(boxes: &[Seen], low: [f64; 2], extent: [f64; 2]) -> Self {
        let mut grid = Self {
            low,
            scale: [0.0; 2],
            cells: (boxes.len() as f64).sqrt().ceil().max(1.0) as usize,
            starts: Vec::new(),
            listed: Vec::new(),
        };
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
    fn span(&self, seen: &Seen) -> [[usize; 2]; 2] {
        [0, 1].map(|i| {
            // A cast saturates: what lies before the first cell counts as in it.
            let cell = |x: f64| (((x - self.low[i]) * self.scale[i]) as usize).min(self.cells - 1);
            seen[i].map(cell)
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

    /// The lists, ascending each, of the cells that a box meets.
    fn beside(&self, around: &Seen) -> impl Iterator<Item = &[u32]> {
        let [[left, right], [bottom, top]] = self.span(around);
        let cells = (bottom..=top)
            .flat_map(move |row| (left..=right).map(move |column| row * self.cells + column));
        cells.map(|cell| &self.listed[self.starts[cell] as usize..self.starts[cell + 1] as usize])
    }
}

/// The box of an outline in the plane.
fn seen(axes: &[DVec3; 2], outline: &[DVec3]) -> Seen {
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

    #[test]
    fn what_stands_over_a_point_is_listed_and_little_else() {
        let (grid, mut over) = (of(&squares(20)), Vec::new());
        for (x, y) in [(0.5, 0.5), (7.25, 3.5), (19.5, 19.5)] {
            grid.beside(&[DVec3::new(x, y, -7.0)], 400, &mut over);
            assert!(over.contains(&(y as u32 * 20 + x as u32)), "{x} {y}: {over:?}");
            assert!(over.len() <= 4, "{over:?}");
        }
        // On a rim: both neighbours.
        grid.beside(&[DVec3::new(5.0, 5.5, 0.0)], 400, &mut over);
        assert!(over.contains(&104) && over.contains(&105), "{over:?}");
    }

    #[test]
    fn an_outline_finds_every_neighbour_once() {
        let grid = of(&squares(20));
        let mut found = vec![7];
        grid.beside(&[DVec3::new(2.5, 2.5, 0.0), DVec3::new(2.5, 9.5, 3.0)], 400, &mut found);
        let column = (2..10).map(|y| y * 20 + 2);
        assert!(column.clone().all(|i| found.contains(&i)), "{found:?}");
        assert!(found.is_sorted_by(|a, b| a < b) && found.len() <= 40, "{found:?}");
        let below: Vec<u32> = found.iter().copied().filter(|&i| i < 100).collect();
        grid.beside(&[DVec3::new(2.5, 2.5, 0.0), DVec3::new(2.5, 9.5, 3.0)], 100, &mut found);
        assert_eq!(found, below);
    }

    #[test]
    fn long_things_make_the_grid_coarser_and_nothing_is_lost() {
        let needle = |i: u32| {
            let y = 0.01 * f64::from(i);
            [DVec3::new(0.0, y, 0.0), DVec3::new(100.0, 100.0 + y, 0.0)]
        };
        let needles: Vec<_> = (0..300).map(needle).collect();
        let grid = of(&needles);
        assert!(grid.grid.as_ref().unwrap().listed.len() <= LISTINGS * 300);
        let mut found = Vec::new();
        grid.beside(&[DVec3::new(50.0, 40.0, 0.0), DVec3::new(50.0, 60.0, 0.0)], 300, &mut found);
        assert_eq!(found.len(), 300);
    }

    #[test]
    fn nothing_and_points_in_one_place_are_no_trouble() {
        let none: [[DVec3; 3]; 0] = [];
        let mut found = vec![7];
        of(&none).beside(&[DVec3::ONE], 9, &mut found);
        assert!(found.is_empty());
        for count in [5, 500] {
            of(&vec![[DVec3::ONE; 3]; count]).beside(&[DVec3::ONE], count as u32, &mut found);
            assert!(found.iter().copied().eq(0..count as u32), "{count}: {found:?}");
        }
    }
}
