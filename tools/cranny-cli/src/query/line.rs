//! One line of `cranny query`; in text, its contacts below it.

use cranny_estimate::{Estimate, Place, Verdict};
use cranny_exact::DVec3;
use cranny_narrow_phase::{Contact, Containment, Feature, Region, Surface, Witness};
use serde::Serialize;

use crate::args::DemandArg;
use crate::words::number;

/// What decides which fields are filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShownFields {
    /// The question.
    pub(super) demand: DemandArg,
    /// Whether A and B are closed.
    pub(super) closed: [bool; 2],
}

/// An answer as it is printed, in world coordinates. What was not demanded is `None`.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    pose: usize,
    verdict: &'static str,
    surface: &'static str,
    solid: Option<bool>,
    contained: Option<&'static str>,
    distance: Option<f64>,
    separation: Option<[f64; 2]>,
    witness_a: Option<[f64; 3]>,
    witness_b: Option<[f64; 3]>,
    triangle_pairs: Option<u32>,
    contacts: Option<Vec<ContactLine>>,
    regions: Option<Vec<RegionLine>>,
    places: Option<Vec<PlaceLine>>,
    tests: u64,
    micros: f64,
    closed_a: bool,
    closed_b: bool,
    /// The question.
    #[serde(skip)]
    demand: DemandArg,
}

#[derive(Debug, Serialize)]
struct ContactLine {
    /// Of A and of B; only people read them.
    #[serde(skip)]
    features: [Feature; 2],
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

#[derive(Debug, Serialize)]
struct PlaceLine {
    min: [f64; 3],
    max: [f64; 3],
    separation: [f64; 2],
}

impl Line {
    /// The line of what was found.
    pub(super) fn new(pose: usize, found: &Estimate, micros: f64, shown: ShownFields) -> Self {
        let asks = |least: DemandArg| shown.demand as u8 >= least as u8;
        let witness = |i: usize| {
            let of = |witnesses: &[Witness; 2]| witnesses[i].point.to_array();
            found.witnesses.as_ref().filter(|_| asks(DemandArg::Distance)).map(of)
        };
        let answer = found.answer.as_ref();
        let wanted = |least: DemandArg| answer.filter(|_| asks(least));
        Self {
            pose,
            verdict: match found.verdict {
                Verdict::Certain => "certain",
                Verdict::Excluded => "excluded",
                Verdict::Open => "open",
            },
            surface: found.surface.map_or("unknown", surface_name),
            solid: found.solid,
            contained: found.contained.map(containment_name),
            distance: answer.and_then(|answer| answer.distance),
            separation: asks(DemandArg::Distance)
                .then_some([found.separation.lo, found.separation.hi]),
            witness_a: witness(0),
            witness_b: witness(1),
            triangle_pairs: wanted(DemandArg::Regions).map(|answer| answer.triangle_pairs),
            contacts: wanted(DemandArg::Contacts)
                .map(|answer| answer.contacts.iter().map(ContactLine::new).collect()),
            regions: wanted(DemandArg::Regions)
                .map(|answer| answer.regions.iter().map(RegionLine::new).collect()),
            places: (asks(DemandArg::Contacts) && answer.is_none())
                .then(|| found.places.iter().map(PlaceLine::new).collect()),
            tests: found.tests(),
            micros,
            closed_a: shown.closed[0],
            closed_b: shown.closed[1],
            demand: shown.demand,
        }
    }

    /// The line for people, below [`heading`]; where contacts are the question, each on a line
    /// below it.
    pub(super) fn text(&self) -> String {
        let verdict = match (self.contained, self.solid) {
            (Some("A_in_B"), _) => "A in B",
            (Some(_), _) => "B in A",
            (None, Some(true)) => "yes",
            (None, Some(false)) => "no",
            (None, None) => "open",
        };
        let number =
            |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |x| format!("{x:.9e}"));
        let distance = match (self.distance, self.separation) {
            (None, Some([lo, hi])) => format!("{lo:.2e}..{hi:.2e}"),
            (distance, _) => number(distance),
        };
        let depth = self
            .regions
            .as_ref()
            .and_then(|regions| regions.iter().filter_map(|region| region.depth).reduce(f64::max));
        let count = self.regions.as_ref().map_or_else(|| "-".to_owned(), |r| r.len().to_string());
        let depth = number(depth);
        let asked = self.contacts.iter().flatten().filter(|_| self.demand == DemandArg::Contacts);
        let contacts: String = asked.map(|contact| format!("\n{}", contact.text())).collect();
        format!(
            "{:>6}  {:<7}  {:<6}  {:>17}  {:>7}  {:>17}  {:>9}  {:>10.1}{contacts}",
            self.pose, self.surface, verdict, distance, count, depth, self.tests, self.micros
        )
    }
}

/// What the columns of [`Line::text`] mean.
pub(super) fn heading(demand: DemandArg) -> String {
    let contacts = match demand {
        DemandArg::Contacts => format!("\n{}", contact_heading()),
        _ => String::new(),
    };
    format!(
        "{:>6}  {:<7}  {:<6}  {:>17}  {:>7}  {:>17}  {:>9}  {:>10}{contacts}",
        "pose", "surface", "solid", "distance", "regions", "depth", "tests", "micros"
    )
}

/// What the columns of [`ContactLine::text`] mean.
fn contact_heading() -> String {
    let columns = ["feature of A", "feature of B"].map(|name| format!("  {name:<14}")).concat();
    let normal = ["normal x", "y", "z"].map(|name| format!("  {name:>11}")).concat();
    let point = ["point x", "y", "z"].map(|name| format!("  {name:>11}")).concat();
    format!("{:6}{columns}  {:>17}{normal}{point}", "", "separation")
}

impl ContactLine {
    /// The line for people, below [`contact_heading`]: the point lies half-way between the two.
    fn text(&self) -> String {
        let features = self.features.map(|feature| format!("  {:<14}", feature_name(feature)));
        let numbers = |of: [f64; 3]| of.map(|x| format!("  {:>11}", number(x))).concat();
        let middle = [0, 1, 2].map(|k| 0.5 * (self.point_a[k] + self.point_b[k]));
        let (normal, point) = (numbers(self.normal), numbers(middle));
        format!("{:6}{}  {:>17.9e}{normal}{point}", "", features.concat(), self.separation)
    }

    fn new(contact: &Contact) -> Self {
        let (of_a, of_b) = contact.id;
        Self {
            features: [of_a, of_b],
            point_a: contact.point_a.to_array(),
            point_b: contact.point_b.to_array(),
            normal: contact.normal.to_array(),
            separation: contact.separation,
        }
    }
}

impl PlaceLine {
    fn new(place: &Place) -> Self {
        Self {
            min: place.bounds.min.to_array(),
            max: place.bounds.max.to_array(),
            separation: [place.separation.lo, place.separation.hi],
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

fn feature_name(feature: Feature) -> String {
    match feature {
        Feature::Vertex(vertex) => format!("vertex {}", vertex.0),
        Feature::Edge(edge) => format!("edge {}", edge.0),
        Feature::Face(face) => format!("face {}", face.0),
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
