//! The one entry: from a question about a pair to its answer.

use std::cmp::Ordering;

use cranny_exact::{DVec3, Interval, Meeting, PoseError};
use cranny_geometry::CreaseAngleError;
use thiserror::Error;

use crate::answer::{Answer, Contact, Counters, Region, Surface};
use crate::coherent::Coherent;
use crate::contacts::{ContactMemory, Wanted, near_patches};
use crate::containment::{Solidity, solidity};
use crate::found::Found;
use crate::hulls::Parting;
use crate::memory::PairMemory;
use crate::near::{NearRegion, near_regions};
use crate::observe::SearchObserver;
use crate::pair::{Pair, accepted};
use crate::penetration::{Penetration, overlaps};
use crate::pockets::PocketMemory;
use crate::query::{Demand, Method, Normals, Placed, Query};
use crate::reduce::reduce;
use crate::regions::meeting_regions;
use crate::surface::{FacePair, strongest};
use crate::tally::{Observed, Tally};

/// A question that cannot be answered.
#[derive(Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A rotation that is no unit quaternion, or a translation outside the coordinate domain.
    #[error("pose of body {body}: {source}")]
    Pose {
        /// `'A'` or `'B'`.
        body: char,
        /// What is wrong with it.
        source: PoseError,
    },
    /// A negative or infinite margin or bound.
    #[error("{what} is {value}: it must be a finite number, 0 or more")]
    Length {
        /// "margin", "within", "below" or "penetrations_from".
        what: &'static str,
        /// The value found.
        value: f64,
    },
    /// A motion that is no such thing.
    #[error("approach: its linear, spread, turn or swing holds an infinity or a NaN")]
    Approach,
    /// A crease angle that is none.
    #[error(transparent)]
    Crease(#[from] CreaseAngleError),
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for QueryError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Answers a question about two placed models.
///
/// The answer does not depend on what `memory` holds. Exchanging A and B exchanges the answer; of
/// one model at one pose, twice, it leaves the question and so the answer as they are.
///
/// Poses are taken as [`Pose::accepted`](cranny_exact::Pose::accepted) returns them: a quaternion
/// that is a little off unit length is normalised, and the answer is the one for that pose.
///
/// # Errors
///
/// [`QueryError`] where a pose, a length or a crease angle of the query is no such thing.
pub fn query(
    a: Placed,
    b: Placed,
    query: &Query,
    memory: &mut PairMemory,
) -> Result<Answer, QueryError> {
    query_counted(a, b, query, memory, |_| Counters::default())
}

/// The same answer as [`query`] to the bit, with the same counters; an observer sees what the
/// search compares.
///
/// Cost: a call for each pair of clusters, faces and features that is compared. [`query`] has
/// neither the calls nor the question whether somebody observes.
///
/// # Errors
///
/// As [`query`].
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, FaceId, Mesh, Model};
/// use cranny_narrow_phase::{
///     Demand, PairMemory, Placed, Query, SearchObserver, query, query_observed,
/// };
///
/// #[derive(Default)]
/// struct Measured(u64);
///
/// impl SearchObserver for Measured {
///     fn faces(&mut self, _: [FaceId; 2]) {
///         self.0 += 1;
///     }
/// }
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let a = Placed { model: &model, pose: Pose::IDENTITY };
/// let b = Placed { model: &model, pose: Pose::at(DVec3::new(3.0, 0.0, 0.0)) };
/// let distance = Query::of(Demand::Distance { below: None });
/// let mut measured = Measured::default();
/// let seen = query_observed(a, b, &distance, &mut PairMemory::default(), &mut measured)?;
/// assert_eq!(seen, query(a, b, &distance, &mut PairMemory::default())?);
/// assert_eq!(measured.0, seen.counters.triangle_tests);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn query_observed(
    a: Placed,
    b: Placed,
    query: &Query,
    memory: &mut PairMemory,
    observer: &mut dyn SearchObserver,
) -> Result<Answer, QueryError> {
    query_counted(a, b, query, memory, |pair| Observed {
        counters: Counters::default(),
        observer,
        swapped: pair.is_swapped(),
    })
}

fn query_counted<T: Tally>(
    a: Placed,
    b: Placed,
    query: &Query,
    memory: &mut PairMemory,
    tally: impl FnOnce(&Pair) -> T,
) -> Result<Answer, QueryError> {
    let [a, b] = accepted(a, b)?;
    query.check()?;
    let PairMemory { parting, contacts: kept, coherent, pockets, smooth, tracks, .. } = memory;
    let pair = &Pair::of_accepted(a, b);
    let counters = &mut tally(pair);
    let pockets = (query.method == Method::Envelopes).then_some(pockets);
    let mut found = match query.demand {
        Demand::Contacts { margin, normals } => {
            let approach = query.approach.filter(|approach| approach.within > margin);
            let wanted = Wanted::of(pair, margin, approach.as_ref());
            let wanted = wanted.with_penetrations_from(query.penetrations_from);
            let mut found = contacts(pair, &wanted, parting, (coherent, kept), counters);
            // What regions say where no vertex does leads out of a whole overlap, and is no
            // surface's.
            if let Normals::Smooth { crease_angle } = normals
                && found.regions.is_empty()
            {
                smooth.replace_normals(&mut found.contacts, [a, b], crease_angle)?;
            }
            found
        }
        demand => answer(pair, &demand, parting, (coherent, pockets, kept), counters),
    };
    if matches!(query.demand, Demand::Regions { .. }) || !found.regions.is_empty() {
        tracks.follow([a, b], &mut found.regions);
    }
    Ok(found)
}

fn answer(
    pair: &Pair,
    demand: &Demand,
    parting: &mut Parting,
    (coherent, mut pockets, kept): (&mut Coherent, Option<&mut PocketMemory>, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Answer {
    let mut out = Answer::nothing();
    if *demand == Demand::None {
        return out;
    }
    coherent.begin(pair);
    // What crossed last is looked at first: mostly it crosses still.
    let gap = match pockets.is_none() && coherent.has_crossed() {
        true => 0.0,
        false => parting.gap(pair, enough(demand), counters),
    };
    let parted = gap > 0.0;
    let wants_regions = demand.margin().is_some();
    // Pairs are enumerated only for contacts; a verdict ends at the first crossing.
    let pairs = if parted {
        Vec::new()
    } else if let Some(pockets) = &mut pockets {
        let pairs = pockets.meetings(pair, !wants_regions, counters);
        out.surface = strongest(&pairs);
        pairs
    } else if wants_regions {
        let pairs = coherent.meetings(pair, counters);
        out.surface = strongest(&pairs);
        pairs
    } else {
        let below = match *demand {
            Demand::Distance { below } => Some(below.unwrap_or(f64::INFINITY)),
            _ => None,
        };
        let (surface, touching) = coherent.verdict(pair, below, counters);
        out.surface = surface;
        touching
    };
    if !parted {
        let found = match pockets {
            Some(_) => solidity(pair, out.surface, &pairs, counters),
            None => coherent.solidity(pair, out.surface, &pairs, counters),
        };
        out.solid = found.solid;
        out.contained = found.contained.map(|c| pair.ordered_containment(c));
    }
    if matches!(demand, Demand::Distance { .. } | Demand::Regions { .. }) {
        measure(pair, demand, &pairs, (gap, parting.direction()), coherent, &mut out, counters);
    }
    if let Some(margin) = demand.margin() {
        out.triangle_pairs = pairs.len() as u32;
        let (regions, depth_error) = meeting_regions(pair, &pairs, out.solid, counters);
        out.regions = regions;
        if gap > margin {
            kept.let_go();
        } else if margin > 0.0 {
            out.regions.extend(gaps(pair, margin, (coherent, kept), counters));
        }
        out.regions.sort_by(|x, y| deepest_first(pair, &x.deepest, &y.deepest));
        out.contacts = out.regions.iter().flat_map(|r| r.points.iter().copied()).collect();
        if let Some(depth) = out.regions.iter().filter_map(|r| r.depth).reduce(f64::max)
            && depth > 0.0
        {
            out.separation = Interval::around(-depth, depth_error);
        }
    }
    coherent.end(pair);
    counters.counters().front_held = coherent.held();
    out.counters = *counters.counters();
    out
}

/// Of equally deep contacts the ids decide, in the pair's own order: not in that of A and B.
fn deepest_first(pair: &Pair, x: &Contact, y: &Contact) -> Ordering {
    let key = |contact: &Contact| pair.ordered(contact.id.0, contact.id.1);
    x.separation.total_cmp(&y.separation).then_with(|| key(x).cmp(&key(y)))
}

/// How far apart surfaces need only be known to be.
fn enough(demand: &Demand) -> f64 {
    match *demand {
        Demand::Distance { below: Some(length) }
        | Demand::Contacts { margin: length, .. }
        | Demand::Regions { margin: length } => length,
        Demand::Distance { below: None } | Demand::Intersects | Demand::None => 0.0,
    }
}

/// Contacts for a solver, which `contacts::near_patches` finds, and the verdict that comes with
/// them.
fn contacts(
    pair: &Pair,
    wanted: &Wanted,
    parting: &mut Parting,
    (coherent, memory): (&mut Coherent, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Answer {
    let mut out = Answer::nothing();
    coherent.begin(pair);
    if parting.gap(pair, wanted.farthest(), counters) > wanted.farthest() {
        coherent.let_go();
        memory.let_go();
        out.separation = gap_seen(&out, pair.length_error());
        out.counters = *counters.counters();
        return out;
    }
    let near = near_patches(pair, wanted, (coherent, memory), counters);
    out.surface = near.surface;
    out.triangle_pairs = near.meeting.len() as u32;
    let Solidity { solid, contained } =
        coherent.solidity(pair, out.surface, &near.meeting, counters);
    (out.solid, out.contained) = (solid, contained.map(|c| pair.ordered_containment(c)));
    out.contacts = near.contacts.into_iter().map(|c| pair.world_contact(c)).collect();
    let mut measured = None;
    let sees_no_overlap = || out.contacts.first().is_none_or(|c| c.separation >= 0.0);
    if solid && (near.left_to_regions || sees_no_overlap()) {
        // Small bodies; faces laid into each other, open surfaces: no vertex is inside, no edges
        // cross.
        let (regions, _) = meeting_regions(pair, &near.meeting, solid, counters);
        out.contacts.extend(regions.iter().flat_map(|r| r.points.iter().copied()));
        // Stable: ties keep an order that does not depend on which body is called A.
        out.contacts.sort_by(|x, y| x.separation.total_cmp(&y.separation));
        measured = Some(regions);
    }
    // A depth of 0 is a separation of 0: never of −0, which is printed with its sign.
    out.contacts.iter_mut().for_each(|contact| contact.separation += 0.0);
    if solid && pair.is_closed() && out.contacts.first().is_some_and(|c| wanted.is_deep(c)) {
        out.penetrations = match &measured {
            Some(regions) => regions.iter().filter_map(Penetration::of).collect(),
            None => overlaps(pair, &near.meeting, counters),
        };
    }
    if !near.left_to_regions {
        out.regions = measured.unwrap_or_default();
    }
    out.separation = if solid && out.surface != Meeting::None {
        Interval { lo: f64::NEG_INFINITY, hi: 0.0 }
    } else {
        gap_seen(&out, pair.length_error())
    };
    coherent.end(pair);
    counters.counters().front_held = coherent.held();
    out.counters = *counters.counters();
    out
}

/// What contacts alone say of the separation of surfaces that do not overlap: the least gap is no
/// larger than that of any contact.
fn gap_seen(answer: &Answer, error: f64) -> Interval {
    if answer.surface != Surface::None {
        return Interval::point(0.0);
    }
    let least = answer.contacts.iter().map(|c| c.separation).fold(f64::INFINITY, f64::min);
    Interval { lo: 0.0, hi: least + error }
}

/// Distance and witnesses of surfaces that are known to be at least `gap` apart, along a direction.
fn measure(
    pair: &Pair,
    demand: &Demand,
    pairs: &[FacePair],
    (gap, parting): (f64, DVec3),
    coherent: &mut Coherent,
    out: &mut Answer,
    counters: &mut impl Tally,
) {
    if out.surface != Surface::None {
        out.distance = Some(0.0);
        out.separation = Interval::point(0.0);
        // Of surfaces that cross, a verdict ends at any crossing: which one depends on memory.
        let touching = pairs.first().filter(|_| out.surface == Surface::Touch);
        out.witnesses = touching.map(|faces| faces.witnesses(pair));
        return;
    }
    let below = match demand {
        Demand::Distance { below: Some(below) } => *below,
        _ => f64::INFINITY,
    };
    let found = if gap > below { None } else { coherent.closest(pair, below, parting, counters) };
    match found {
        Some(found) => {
            out.distance = Some(found.distance);
            out.separation = Interval::around(found.distance, pair.length_error());
            out.separation.lo = out.separation.lo.max(0.0);
            let [p, q] = found.points;
            let [f, g] = found.features;
            out.witnesses = Some(pair.ordered(pair.world_witness(p, f), pair.world_witness(q, g)));
        }
        None => {
            out.distance = Some(f64::INFINITY);
            let lo = (below - pair.length_error()).max(0.0);
            out.separation = Interval { lo, hi: f64::INFINITY };
        }
    }
}

/// Regions of positive separation.
fn gaps(
    pair: &Pair,
    margin: f64,
    memory: (&mut Coherent, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Vec<Region> {
    let region = |NearRegion { contacts, faces }: NearRegion| {
        let (points, curves) = (reduce(contacts), Vec::new());
        let normal = points[0].normal;
        let found = Found { normal, depth: None, area: None, points, curves, faces };
        let region = found.finish(pair);
        Region { triangle_pairs: 0, normal: region.deepest.normal, ..region }
    };
    near_regions(pair, margin, memory, counters).into_iter().map(region).collect()
}
