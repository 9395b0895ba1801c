//! Where the work of a query is counted, and shown to whoever observes it.
//!
//! What searches is written for any [`Tally`]. For [`Counters`] alone it is compiled without the
//! observer: a query that nobody observes has no code for one.

use cranny_exact::Arithmetic;
use cranny_geometry::FaceId;

use crate::answer::{Counters, Feature};
use crate::observe::{ComparedBoxes, SearchObserver};

/// Counts work.
///
/// A method about pairs passes [`Counters`] for it.
pub trait Tally {
    /// The counts so far.
    fn counters(&mut self) -> &mut Counters;

    /// Takes note of boxes that are compared, and counted by who compares them. Bodies are numbered
    /// in the pair's order. To say which they are is work, and nobody does it unobserved.
    #[inline(always)]
    fn boxes(&mut self, _: impl FnOnce() -> ComparedBoxes) {}

    /// Counts two clusters that are compared: of the first body, of the second.
    #[inline(always)]
    fn clusters(&mut self, _: [u32; 2]) {
        self.counters().cluster_tests += 1;
    }

    /// Counts two faces that are classified or measured.
    #[inline(always)]
    fn faces(&mut self, _: [FaceId; 2]) {
        self.counters().triangle_tests += 1;
    }

    /// Counts two features of which the contact is computed.
    #[inline(always)]
    fn features(&mut self, _: [Feature; 2]) {
        self.counters().triangle_tests += 1;
    }

    /// Counts how it was decided whether two faces meet.
    #[inline(always)]
    fn judged(&mut self, by: Arithmetic) {
        let counters = self.counters();
        match by {
            Arithmetic::Filter => counters.triangles_filtered += 1,
            Arithmetic::Adaptive => counters.triangles_adaptive += 1,
        }
    }
}

impl Tally for Counters {
    #[inline(always)]
    fn counters(&mut self) -> &mut Counters {
        self
    }
}

/// Counts work, and shows it to an observer in the caller's order of the bodies.
pub(crate) struct Observed<'o> {
    pub(crate) counters: Counters,
    pub(crate) observer: &'o mut dyn SearchObserver,
    /// The pair's first body is the caller's B.
    pub(crate) swapped: bool,
}

impl Observed<'_> {
    fn ordered<T>(&self, [first, second]: [T; 2]) -> [T; 2] {
        if self.swapped { [second, first] } else { [first, second] }
    }
}

impl Tally for Observed<'_> {
    fn counters(&mut self) -> &mut Counters {
        &mut self.counters
    }

    fn boxes(&mut self, boxes: impl FnOnce() -> ComparedBoxes) {
        let boxes = boxes();
        let body = if self.swapped { 1 - boxes.body } else { boxes.body };
        self.observer.boxes(ComparedBoxes { body, ..boxes });
    }

    fn clusters(&mut self, clusters: [u32; 2]) {
        self.counters.clusters(clusters);
        self.observer.clusters(self.ordered(clusters));
    }

    fn faces(&mut self, faces: [FaceId; 2]) {
        self.counters.faces(faces);
        self.observer.faces(self.ordered(faces));
    }

    fn features(&mut self, features: [Feature; 2]) {
        self.counters.features(features);
        self.observer.features(self.ordered(features));
    }
}
