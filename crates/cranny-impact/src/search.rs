//! Which parts of two moving surfaces meet first: a descent of the two box trees in space and time.
//!
//! A *candidate* is a pair of nodes, or of faces, with a time before which they certainly share no
//! point. The earliest candidate is taken from a queue, tested at the poses of its time, and either
//! put off to the time until which its gap lasts, or opened. The search ends when the earliest is
//! later than a hit, or than time 1.
//!
//! Pairs that were opened when the bodies were near stay opened, though they may part again; so
//! after some turning the queue is dropped and the search begins anew from the roots, at the time
//! that has been reached.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use cranny_exact::Interval;
use cranny_geometry::{FaceId, PairedStep};
use cranny_narrow_phase::Witness;
use cranny_narrow_phase::operations::Side;

use crate::bodies::{Bodies, Moment};
use crate::faces::{Next, settle};
use crate::impact::{Hit, Impact, ImpactCounters, ImpactOptions};
use crate::reach::boxes_apart;

/// Radians after which the search begins anew from the roots. Measured on tori, cups and combs that
/// fly past each other: half of it costs as much, double of it a third more; without it, bodies
/// that turn by ten radians or more open fifteen to a hundred times as many pairs of faces.
const TURN_OF_A_DESCENT: f64 = 0.5;

/// A candidate whose gap lasts for this part of the time left, or more, is put off unopened.
/// Larger: pairs are opened that would have been rid of in some steps (at one half, two to ten
/// times as many); smaller: wide boxes creep along.
const WORTH_WAITING: f64 = 0.03125;

/// A candidate whose gap is this part of the larger box's radius, or more, is put off unopened:
/// opening it could not make its gap much wider. At 1, one in five more pairs is opened.
const WIDE_GAP: f64 = 0.25;

/// A pair of nodes or of faces that may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Nodes(u32, u32),
    Faces(FaceId, FaceId),
}

/// A pair that shares no point before a time; ordered by time. (The bits of floating-point numbers
/// that are not negative are in the order of the numbers.)
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    time_bits: u64,
    target: Target,
}

/// A first meeting found so far.
struct Found {
    /// No pair of faces that was settled meets before.
    lower: f64,
    hit: Hit,
}

struct Search<'a> {
    bodies: &'a Bodies<'a>,
    tolerance: f64,
    queue: BinaryHeap<Reverse<Candidate>>,
    found: Option<Found>,
    /// Where this descent ends.
    until: f64,
    budget: u64,
    counters: ImpactCounters,
}

/// Finds the first meeting of two bodies that share no point at time 0.
pub(crate) fn search(bodies: &Bodies, options: &ImpactOptions) -> (Impact, ImpactCounters) {
    let mut search = Search {
        bodies,
        // What the arithmetic may be off is then less than the part left to it: see `faces`.
        tolerance: options.tolerance.max(16.0 * bodies.rounding),
        queue: BinaryHeap::new(),
        found: None,
        until: 0.0,
        budget: options.budget,
        counters: ImpactCounters::default(),
    };
    let turn = Side::BOTH.map(|s| bodies.spin(s).length()).into_iter().fold(0.0, f64::max);
    let duration = TURN_OF_A_DESCENT / turn;
    let mut free_before = 0.0;
    search.begin_at(0.0, duration);
    let mut spent = false;
    while let Some(Reverse(candidate)) = search.queue.pop() {
        let time = f64::from_bits(candidate.time_bits);
        free_before = time;
        if search.is_over(time) {
            break;
        }
        if search.is_spent() {
            spent = true;
            break;
        }
        if time > search.until {
            search.begin_at(time, duration);
            continue;
        }
        let moment = bodies.at(time);
        match candidate.target {
            Target::Nodes(a, b) => search.descend(a, b, &moment),
            Target::Faces(f, g) => search.faces(f, g, &moment),
        }
    }
    let impact = match search.found {
        Some(Found { lower, mut hit }) => {
            hit.time.lo = if spent { lower.min(free_before) } else { lower };
            Impact::Hit(hit)
        }
        None if spent => Impact::Open { free_before },
        None => Impact::None,
    };
    (impact, search.counters)
}

impl Search<'_> {
    /// Whether no more work may be done.
    fn is_spent(&self) -> bool {
        self.counters.total() >= self.budget
    }

    /// Drops all candidates; the bodies share no point before `time`.
    fn begin_at(&mut self, time: f64, duration: f64) {
        self.queue.clear();
        self.until = time + duration;
        self.counters.descents += 1;
        self.put_off(Target::Nodes(0, 0), time);
    }

    /// Whether no candidate of this time can change the answer.
    fn is_over(&self, time: f64) -> bool {
        time > 1.0 || self.found.as_ref().is_some_and(|f| time >= f.hit.time.hi)
    }

    /// The end of the time that has to be searched.
    fn end(&self) -> f64 {
        self.found.as_ref().map_or(1.0, |f| f.hit.time.hi)
    }

    fn put_off(&mut self, target: Target, time: f64) {
        if !self.is_over(time) {
            self.queue.push(Reverse(Candidate { time_bits: time.to_bits(), target }));
        }
    }

    /// Opens a pair of nodes as far as need be, at a moment.
    fn descend(&mut self, a: u32, b: u32, moment: &Moment) {
        let bodies = self.bodies;
        let (first, second) = (bodies.tree(Side::First), bodies.tree(Side::Second));
        let time_left = self.end().min(self.until) - moment.time;
        let mut stack = vec![(a, b)];
        while let Some((a, b)) = stack.pop() {
            if self.is_spent() {
                // What is left of this moment is unknown from it on.
                self.put_off(Target::Nodes(a, b), moment.time);
                continue;
            }
            self.counters.node_tests += 1;
            let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
            let boxes = [
                bodies.posed_box(Side::First, box_a, moment),
                bodies.posed_box(Side::Second, box_b, moment),
            ];
            let radii = boxes.map(|b| b.radius());
            let apart = boxes_apart(bodies, moment, &boxes, radii);
            let until = (moment.time + apart.lasting).next_down();
            if until > moment.time
                && (apart.lasting >= WORTH_WAITING * time_left
                    || apart.gap >= WIDE_GAP * radii[0].max(radii[1]))
            {
                self.put_off(Target::Nodes(a, b), until);
                continue;
            }
            match PairedStep::of_larger([first, second], [a, b]) {
                PairedStep::First(left, right) => stack.extend([(right, b), (left, b)]),
                PairedStep::Second(left, right) => stack.extend([(a, right), (a, left)]),
                PairedStep::Leaves => {
                    for &f in first.leaf_faces(a) {
                        for &g in second.leaf_faces(b) {
                            self.faces(f, g, moment);
                        }
                    }
                }
            }
        }
    }

    /// Settles a pair of faces from a moment on.
    fn faces(&mut self, f: FaceId, g: FaceId, moment: &Moment) {
        let end = self.end();
        match settle(self.bodies, (f, g), moment, end, self.tolerance, &mut self.counters) {
            Next::Later(time) => self.put_off(Target::Faces(f, g), time),
            Next::Free => {}
            Next::Met { lower, meeting } => {
                let time = meeting.time;
                let earliest = self.found.as_ref().map_or(lower, |f| f.lower.min(lower));
                match &mut self.found {
                    // Equally early ones are left to the one that was found first, which is the
                    // lowest in a fixed order.
                    Some(found) if found.hit.time.hi <= time => found.lower = earliest,
                    _ => {
                        let [a, b] = meeting.witnesses.map(|(point, feature)| {
                            let point = self.bodies.world_point(point, time);
                            Witness { point, feature }
                        });
                        let hit = Hit {
                            time: Interval { lo: earliest, hi: time },
                            witnesses: self.bodies.ordered(a, b),
                            normal: self.bodies.ordered_normal(meeting.normal),
                            distance: meeting.distance,
                        };
                        self.found = Some(Found { lower: earliest, hit });
                    }
                }
            }
        }
    }
}
