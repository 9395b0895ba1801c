//! The nearest faces of two surfaces.

use std::ops::ControlFlow;

use cranny_geometry::FaceId;
use cranny_geometry::clusters::LANES;

use super::apart::FacePairs;
use super::cut::Cut;
use super::descent::{Order, Visitor, descend};
use super::faces::Faced;
use super::ground::Ground;
use super::lanes::{lanes_of, single};
use crate::closest::NearestFaces;
use crate::pair::Side;
use crate::surface::looked_at;
use crate::tally::Tally;

struct Nearest<'s, 'g, 'p, 'm> {
    ground: &'g Ground<'m>,
    faces: &'s mut NearestFaces<'p, 'm>,
    /// That are to be measured.
    pairs: FacePairs,
    /// Whether faces are looked for that meet: the first ends the search.
    judges: bool,
    meet: bool,
}

impl<'s, 'g, 'p, 'm> Nearest<'s, 'g, 'p, 'm> {
    fn new(ground: &'g Ground<'m>, faces: &'s mut NearestFaces<'p, 'm>) -> Self {
        Self { ground, faces, pairs: FacePairs::new(), judges: false, meet: false }
    }

    /// Notes the faces of two clusters that may be nearest.
    fn look(&mut self, clusters: [u32; 2], counters: &mut impl Tally) {
        let faced = Faced::of(self.ground, clusters);
        let (bound, mut its) = (faced.bound(self.faces.limit()), None);
        for lane in 0..faced.count() {
            let (near, gaps) = faced.near(lane, bound);
            if near == 0 {
                continue;
            }
            let (own, gaps) = (faced.own(lane), gaps.to_array());
            let its = its.get_or_insert_with(|| faced.its());
            for other in lanes_of(near) {
                self.pairs.push(&faced, (lane, &own), (other, its), gaps[other]);
                if self.pairs.is_full() {
                    self.measure(counters);
                }
            }
        }
    }

    /// Offers what was noted, the nearest first as far as single precision shows.
    fn measure(&mut self, counters: &mut impl Tally) {
        let unit = self.ground.tree(Side::First).unit();
        let limit = |faces: &NearestFaces| ((faces.limit() / unit) as f32).next_up();
        let mut bound = limit(self.faces);
        let mut near = [(f32::INFINITY, [FaceId(0); 2]); LANES];
        let mut count = 0;
        for (faces, gap) in self.pairs.take() {
            if gap <= bound {
                near[count] = (gap, faces);
                count += 1;
            }
        }
        let near = &mut near[..count];
        near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        for &(gap, [f, g]) in near.iter() {
            if self.judges && !self.meet && gap <= 0.0 {
                self.meet = looked_at(self.faces.pair(), f, g, counters).is_some();
            }
            if gap <= bound {
                self.faces.offer(f, g, counters);
                bound = limit(self.faces);
            }
        }
    }
}

impl Visitor for Nearest<'_, '_, '_, '_> {
    const ORDER: Order = Order::Nearest;

    fn reach(&self) -> f64 {
        self.faces.limit()
    }

    fn clusters(&mut self, pair: [u32; 2], _: f64, counters: &mut impl Tally) -> ControlFlow<()> {
        counters.clusters(pair);
        if let Some(toward) = self.faces.toward() {
            let gap = self.ground.cluster_gap_along(pair, single(toward));
            if gap > self.faces.limit() {
                return ControlFlow::Continue(());
            }
        }
        self.look(pair, counters);
        // At once: the nearer they are, the less is left to descend into.
        if !self.pairs.is_empty() {
            self.measure(counters);
        }
        if self.meet { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Offers all faces that may be nearest; the fewer, the nearer those are that have been offered
/// before. `judges`: ends at the first that meet, and returns whether there are any.
pub(crate) fn nearest_faces<'p, 'm>(
    ground: &Ground<'m>,
    (faces, judges): (&mut NearestFaces<'p, 'm>, bool),
    counters: &mut impl Tally,
) -> bool {
    let mut nearest = Nearest { judges, ..Nearest::new(ground, faces) };
    // Who ends it knows.
    let _ = descend(ground, &mut nearest, counters);
    nearest.meet
}

/// The same as [`nearest_faces`] among the clusters that a cut lists, which reaches at least as far
/// as those that have been offered.
pub(crate) fn nearest_in<'p, 'm>(
    cut: &mut Cut,
    ground: &Ground<'m>,
    faces: &mut NearestFaces<'p, 'm>,
    counters: &mut impl Tally,
) {
    let posing = ground.posing();
    let (leaves, spent) = cut.leaves();
    let mut nearest = Nearest::new(ground, faces);
    for leaf in leaves {
        let limit = nearest.faces.limit();
        if spent.left(leaf) > limit {
            continue;
        }
        counters.clusters(leaf.pair);
        let (gap, _) = ground.cluster_gap(leaf, limit);
        spent.note_along(leaf, gap, posing);
        if gap <= limit {
            nearest.look(leaf.pair, counters);
        }
    }
    nearest.measure(counters);
}
