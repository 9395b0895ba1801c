//! Where bodies are, kept between an app's questions about places.

use std::sync::{Arc, Mutex, PoisonError};

use bevy_ecs::change_detection::Tick;
use cranny_broad_phase::BoxIndex;
use cranny_exact::Aabb;
use cranny_world::BodyId;

/// The boxes of all bodies, as a system saw them last. Each system has its own.
#[derive(Debug, Default)]
pub struct SpatialIndex {
    seen: Mutex<Option<Arc<SeenBoxes>>>,
}

/// Boxes in a tree, and when they were what they say.
#[derive(Debug)]
pub(crate) struct SeenBoxes {
    boxes: BoxIndex,
    /// Of the boxes, in the order in which the system's query has them.
    bodies: Vec<BodyId>,
    at: Tick,
}

impl SpatialIndex {
    /// The boxes as they are now: those seen before where nothing has changed since, else anew.
    ///
    /// `bodies` are those that there are, each with when it last changed, and `bodies_changed` is
    /// when any came or was taken for another. A change in the very run in which they were seen may
    /// have come before or after: they are seen anew.
    pub(crate) fn now(
        &self,
        this_run: Tick,
        bodies_changed: Tick,
        bodies: impl Iterator<Item = (BodyId, Tick)>,
        boxes: impl Iterator<Item = (BodyId, Aabb)>,
    ) -> Arc<SeenBoxes> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(seen) = &*seen {
            let is_before = |change: Tick| seen.at.is_newer_than(change, this_run);
            let mut known = seen.bodies.iter();
            let mut is_known = |(body, change)| known.next() == Some(&body) && is_before(change);
            if is_before(bodies_changed) && { bodies }.all(&mut is_known) && known.next().is_none()
            {
                return Arc::clone(seen);
            }
        }
        let (bodies, boxes): (Vec<BodyId>, Vec<Aabb>) = boxes.unzip();
        let now = Arc::new(SeenBoxes { boxes: BoxIndex::of(boxes), bodies, at: this_run });
        *seen = Some(Arc::clone(&now));
        now
    }
}

impl SeenBoxes {
    /// The bodies whose boxes a region [reaches](BoxIndex::reached), in no particular order.
    pub(crate) fn reached<'a>(
        &'a self,
        reaches: impl Fn(&Aabb) -> bool + 'a,
    ) -> impl Iterator<Item = BodyId> + 'a {
        self.boxes.reached(reaches).map(|number| self.bodies[number])
    }

    /// The bodies whose boxes overlap another one, ascending.
    pub(crate) fn overlapping(&self, around: &Aabb) -> Vec<BodyId> {
        let mut found: Vec<BodyId> = self.reached(|held| held.overlaps(around)).collect();
        found.sort_unstable();
        found
    }
}
