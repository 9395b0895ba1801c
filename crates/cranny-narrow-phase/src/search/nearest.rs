//! The nearest faces of two surfaces.

use std::ops::ControlFlow;

use super::cut::Cut;
use super::descent::{Pending, Visitor, descend};
use super::faces::for_near_faces;
use super::ground::Ground;
use crate::answer::Counters;
use crate::closest::NearestFaces;

struct Nearest<'s, 'g, 'p, 'm> {
    ground: &'g Ground<'m>,
    faces: &'s mut NearestFaces<'p, 'm>,
}

impl Visitor for Nearest<'_, '_, '_, '_> {
    fn reach(&self) -> f64 {
        self.faces.limit()
    }

    fn clusters(&mut self, pair: [u32; 2], _: f64, counters: &mut Counters) -> ControlFlow<()> {
        let toward = self.faces.toward().map(|d| d.to_array().map(|x| x as f32));
        let reach = self.faces.limit();
        for_near_faces(self.ground, pair, reach, toward, |[f, g], _| {
            self.faces.offer(f, g, counters);
            self.faces.limit()
        });
        ControlFlow::Continue(())
    }
}

/// Offers all faces that may be nearest; the fewer, the nearer those are that have been offered
/// before.
pub(crate) fn nearest_faces<'p, 'm>(
    ground: &Ground<'m>,
    stack: &mut Vec<Pending>,
    faces: &mut NearestFaces<'p, 'm>,
    counters: &mut Counters,
) {
    // Nothing ends it.
    let _ = descend(ground, stack, &mut Nearest { ground, faces }, counters);
}

/// The same among the clusters that a cut lists, which reaches at least as far as those that have
/// been offered.
pub(crate) fn nearest_in<'p, 'm>(
    cut: &mut Cut,
    ground: &Ground<'m>,
    faces: &mut NearestFaces<'p, 'm>,
    counters: &mut Counters,
) {
    let posing = ground.posing();
    let (leaves, spent) = cut.leaves();
    let mut nearest = Nearest { ground, faces };
    for leaf in leaves {
        let limit = nearest.faces.limit();
        if spent.left(leaf) > limit {
            continue;
        }
        let gap = ground.cluster_gap(leaf, limit);
        spent.note_along(leaf, gap, posing);
        if gap <= limit {
            // Nothing ends it.
            let _ = nearest.clusters(leaf.pair, 0.0, counters);
        }
    }
}
