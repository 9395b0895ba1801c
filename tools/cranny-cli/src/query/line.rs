//! One line of `cranny query`.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Contact, Containment, Region, Surface, Witness};
use serde::Serialize;

use crate::args::DemandArg;

/// What decides which fields are filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    /// What was asked.
    pub(super) demand: DemandArg,
    /// Whether A and B are closed.
    pub(super) closed: [bool; 2],
}

/// An answer as it is printed, in world coordinates. What was not asked for is `None`.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    pose: usize,
    surface: &'static str,
    solid: bool,
    contained: Option<&'static str>,
    distance: Option<f64>,
    witness_a: Option<[f64; 3]>,
    witness_b: Option<[f64; 3]>,
    triangle_pairs: Option<u32>,
    contacts: Option<Vec<ContactLine>>,
    regions: Option<Vec<RegionLine>>,
    tests: u64,
    micros: f64,
    closed_a: bool,
    closed_b: bool,
}

#[derive(Debug, Serialize)]
struct ContactLine {
    point_a: [f64; 3],
    point_b: [f64; 3],
    normal: [f64; 3],
    separation: f64,
}

#[derive(Debug, Serialize)]
struct RegionLine {
    /// Half-way between the deepest contact's two points.
    point: [f64; 3],
    normal: [f64; 3],
    depth: Option<f64>,
    area: Option<f64>,
    separation: f64,
    triangle_pairs: u32,
}

impl Line {
    /// The line of an answer.
    pub(super) fn new(pose: usize, answer: &Answer, micros: f64, shown: Shown) -> Self {
        let asks = |least: DemandArg| shown.demand as u8 >= least as u8;
        let witness = |i: usize| {
            let of = |witnesses: &[Witness; 2]| witnesses[i].point.to_array();
            answer.witnesses.as_ref().filter(|_| asks(DemandArg::Distance)).map(of)
        };
        let contacts = || answer.contacts.iter().map(ContactLine::new).collect();
        let regions = || answer.regions.iter().map(RegionLine::new).collect();
        let counters = &answer.counters;
        Self {
            pose,
            surface: surface_name(answer.surface),
            solid: answer.solid,
            contained: answer.contained.map(containment_name),
            distance: answer.distance,
            witness_a: witness(0),
            witness_b: witness(1),
            triangle_pairs: asks(DemandArg::Regions).then_some(answer.triangle_pairs),
            contacts: asks(DemandArg::Contacts).then(contacts),
            regions: asks(DemandArg::Regions).then(regions),
            tests: counters.node_tests + counters.triangle_tests + counters.inside_tests,
            micros,
            closed_a: shown.closed[0],
            closed_b: shown.closed[1],
        }
    }

    /// The line for people, below [`heading`].
    pub(super) fn text(&self) -> String {
        let verdict = match (self.contained, self.solid) {
            (Some("A_in_B"), _) => "A in B",
            (Some(_), _) => "B in A",
            (None, true) => "yes",
            (None, false) => "no",
        };
        let number =
            |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |x| format!("{x:.9e}"));
        let depth = self
            .regions
            .as_ref()
            .and_then(|regions| regions.iter().filter_map(|region| region.depth).reduce(f64::max));
        let count = self.regions.as_ref().map_or_else(|| "-".to_owned(), |r| r.len().to_string());
        let (distance, depth) = (number(self.distance), number(depth));
        format!(
            "{:>6}  {:<7}  {:<6}  {:>17}  {:>7}  {:>17}  {:>9}  {:>10.1}",
            self.pose, self.surface, verdict, distance, count, depth, self.tests, self.micros
        )
    }
}

/// What the columns of [`Line::text`] mean.
pub(super) fn heading() -> String {
    format!(
        "{:>6}  {:<7}  {:<6}  {:>17}  {:>7}  {:>17}  {:>9}  {:>10}",
        "pose", "surface", "solid", "distance", "regions", "depth", "tests", "micros"
    )
}

impl ContactLine {
    fn new(contact: &Contact) -> Self {
        Self {
            point_a: contact.point_a.to_array(),
            point_b: contact.point_b.to_array(),
            normal: contact.normal.to_array(),
            separation: contact.separation,
        }
    }
}

impl RegionLine {
    fn new(region: &Region) -> Self {
        let middle: DVec3 = 0.5 * (region.deepest.point_a + region.deepest.point_b);
        Self {
            point: middle.to_array(),
            normal: region.normal.to_array(),
            depth: region.depth,
            area: region.area,
            separation: region.deepest.separation,
            triangle_pairs: region.triangle_pairs,
        }
    }
}

fn surface_name(surface: Surface) -> &'static str {
    match surface {
        Surface::None => "none",
        Surface::Touch => "touch",
        Surface::Cross => "cross",
    }
}

fn containment_name(contained: Containment) -> &'static str {
    match contained {
        Containment::AInB => "A_in_B",
        Containment::BInA => "B_in_A",
    }
}
