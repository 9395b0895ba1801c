//! Our own messages: JSON with a schema, the same types for writing and for reading.
//!
//! What viewers can read limits the form: a key has one type (what is unknown is absent, not null),
//! arrays hold numbers, strings or objects but no arrays, and no number is infinite.

use cranny_exact::{DVec3, Interval};
use cranny_narrow_phase::{Contact, Containment, Feature, Region, Surface, Witness};
use cranny_world::PairEventKind;
use serde::{Deserialize, Serialize};

use crate::digest::answer_digest;
use crate::exact_pose::ExactPose;
use crate::frame::{Frame, PairContacts};

/// A JSON schema under its name.
pub(crate) struct Schema {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
}

pub(crate) const CONTACTS_SCHEMA: Schema =
    Schema { name: "cranny.Contacts", text: include_str!("../schemas/contacts.json") };
pub(crate) const EVENTS_SCHEMA: Schema =
    Schema { name: "cranny.PairEvents", text: include_str!("../schemas/pair_events.json") };
pub(crate) const STATS_SCHEMA: Schema =
    Schema { name: "cranny.StepStats", text: include_str!("../schemas/step_stats.json") };

/// A point or direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VectorMessage {
    /// Along the world's x axis.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

impl From<DVec3> for VectorMessage {
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

/// An interval; an end that is absent is unbounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IntervalMessage {
    /// Lower end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lo: Option<f64>,
    /// Upper end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hi: Option<f64>,
}

impl From<Interval> for IntervalMessage {
    fn from(interval: Interval) -> Self {
        Self { lo: finite(interval.lo), hi: finite(interval.hi) }
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// `cranny.Contacts`: what was found about pairs in a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactsMessage {
    /// The step.
    pub step: u64,
    /// One a pair that was looked at.
    pub pairs: Vec<PairMessage>,
}

/// What was found about a pair. Points are world coordinates; normals point from A to B.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairMessage {
    /// Name of body A.
    pub a: String,
    /// Name of body B.
    pub b: String,
    /// Where A was.
    pub pose_a: ExactPose,
    /// Where B was.
    pub pose_b: ExactPose,
    /// The frame in which a solver computed it; absent: the world's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameMessage>,
    /// Regions farther apart were not looked for; absent where nobody says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// Hash of verdicts and regions to the bit, points and curves with them: 32 hexadecimal digits.
    pub digest: String,
    /// `none`, `touch` or `cross`.
    pub surface: String,
    /// Whether the bodies share interior points.
    pub solid: bool,
    /// `A_in_B`, `B_in_A` or absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contained: Option<String>,
    /// Least distance of the surfaces; absent where it was not demanded, and where it is beyond
    /// what was demanded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Where it is known to lie; below 0: depth.
    pub separation: IntervalMessage,
    /// Points at that distance; `None` where surfaces cross.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub witnesses: Option<[WitnessMessage; 2]>,
    /// How many triangle pairs meet.
    pub triangle_pairs: u32,
    /// Connected regions of contact.
    pub regions: Vec<RegionMessage>,
    /// How many contacts there are; `/contacts/points` and `/contacts/normals` hold them.
    pub contact_count: u32,
}

/// The frame of one body of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameMessage {
    /// Whether the frame is that of A.
    pub first_is_a: bool,
    /// The other body's pose in it.
    pub first_from_second: ExactPose,
}

/// A point of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WitnessMessage {
    /// Where.
    pub point: VectorMessage,
    /// The feature that holds it: its kind and its number, as `face:12`.
    pub feature: String,
}

/// A connected region of contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegionMessage {
    /// Stays the same while the region lasts; 0 in recordings of before it was written.
    #[serde(default)]
    pub id: u32,
    /// The contact of least separation.
    pub deepest: ContactMessage,
    /// Describes the region.
    pub normal: VectorMessage,
    /// Least translation along the normal that parts the pieces, or how deep the deepest place lies
    /// where no short one does; absent where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<f64>,
    /// Enclosed area, projected along the normal; absent where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// How many triangle pairs meet in it.
    pub triangle_pairs: u32,
    /// How many contacts represent it.
    pub point_count: u32,
    /// How many curves bound it; `/contacts/scene` holds them.
    pub curve_count: u32,
}

/// A pair of points where bodies meet or nearly do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactMessage {
    /// Feature of A.
    pub feature_a: String,
    /// Feature of B.
    pub feature_b: String,
    /// On A.
    pub point_a: VectorMessage,
    /// On B.
    pub point_b: VectorMessage,
    /// Unit.
    pub normal: VectorMessage,
    /// Above 0: apart.
    pub separation: f64,
}

/// `cranny.PairEvents`: what began and ended in a step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventsMessage {
    /// The step.
    pub step: u64,
    /// In the order of body ids.
    pub events: Vec<EventMessage>,
}

/// One event.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventMessage {
    /// `began`, `ended`, `region_split` or `region_merged`.
    pub kind: String,
    /// Name of the one body.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// Of a beginning: `true` where it is open if the two touch, at their level or within a budget.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub open: bool,
    /// Of regions that split or merged: the one that goes on, by its id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<u32>,
    /// The one that is new, or gone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<u32>,
}

/// `cranny.StepStats`: what a step cost and found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatsMessage {
    /// The step.
    pub step: u64,
    /// Bodies, each with one box.
    pub boxes: usize,
    /// Pairs of boxes that overlap.
    pub candidate_pairs: usize,
    /// Pairs that the narrow phase answered.
    pub queried_pairs: usize,
    /// Pairs whose answer came from the solver's step.
    pub supplied_pairs: usize,
    /// Pairs that touch or overlap.
    pub touching_pairs: usize,
    /// Contacts, summed.
    pub contacts: usize,
    /// Regions, summed.
    pub regions: usize,
    /// Pairs of tree nodes compared.
    pub node_tests: u64,
    /// Pairs of triangles looked at.
    pub triangle_tests: u64,
    /// Points classified against solids.
    pub inside_tests: u64,
    /// Pairs of triangles whose meeting or parting plain floating point settled; 0 in recordings
    /// made before these were written.
    #[serde(default)]
    pub triangles_filtered: u64,
    /// Pairs of triangles of which adaptive arithmetic had to decide a sign.
    #[serde(default)]
    pub triangles_adaptive: u64,
    /// Pairs of tree nodes kept for the next step.
    #[serde(default)]
    pub front_held: u64,
    /// Pairs of tree nodes kept from the last step that had to be looked at again.
    #[serde(default)]
    pub front_tested: u64,
    /// Pairs of tree nodes added to what is kept.
    #[serde(default)]
    pub front_split: u64,
    /// Pairs of tree nodes fewer, after what had grown too fine was found anew.
    #[serde(default)]
    pub front_merged: u64,
    /// Tests of one box against another.
    pub box_tests: u64,
    /// End points of boxes that changed places.
    pub swaps: u64,
    /// Pairs that were estimated, at a level or within a budget: they are not answered exactly.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub estimated_pairs: usize,
    /// Of these, pairs with an open verdict; `touching_pairs` leaves them out.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub open_pairs: usize,
    /// Elementary tests of all estimates.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub estimate_tests: u64,
    /// The deepest overlap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deepest: Option<DeepestMessage>,
    /// Further numbers by name.
    pub measures: Vec<MeasureMessage>,
}

/// The deepest overlap of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeepestMessage {
    /// > 0.
    pub depth: f64,
    /// Name of the one body.
    pub a: String,
    /// Name of the other.
    pub b: String,
}

/// A number by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureMessage {
    /// What it measures.
    pub name: String,
    /// How much; absent where it is no finite number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
}

impl MeasureMessage {
    fn of(&(name, value): &(&str, f64)) -> Self {
        Self { name: name.to_owned(), value: finite(value) }
    }
}

impl ContactsMessage {
    pub(crate) fn of(frame: &Frame) -> Self {
        Self { step: frame.step, pairs: frame.contacts.iter().map(PairMessage::of).collect() }
    }
}

impl PairMessage {
    fn of(pair: &PairContacts) -> Self {
        let answer = pair.answer;
        let frame = pair.frame.map(|frame| FrameMessage {
            first_is_a: frame.first_is_a,
            first_from_second: ExactPose(frame.first_from_second),
        });
        Self {
            a: pair.a.to_owned(),
            b: pair.b.to_owned(),
            pose_a: ExactPose(pair.pose_a),
            pose_b: ExactPose(pair.pose_b),
            frame,
            margin: pair.margin,
            digest: answer_digest(answer),
            surface: surface_name(answer.surface).to_owned(),
            solid: answer.solid,
            contained: answer.contained.map(|c| containment_name(c).to_owned()),
            distance: answer.distance.and_then(finite),
            separation: answer.separation.into(),
            witnesses: answer.witnesses.as_ref().map(|w| [&w[0], &w[1]].map(WitnessMessage::of)),
            triangle_pairs: answer.triangle_pairs,
            regions: answer.regions.iter().map(RegionMessage::of).collect(),
            contact_count: answer.contacts.len() as u32,
        }
    }
}

impl WitnessMessage {
    fn of(witness: &Witness) -> Self {
        Self { point: witness.point.into(), feature: feature_name(witness.feature) }
    }
}

impl RegionMessage {
    fn of(region: &Region) -> Self {
        Self {
            id: region.id.0,
            deepest: ContactMessage::of(&region.deepest),
            normal: region.normal.into(),
            depth: region.depth,
            area: region.area,
            triangle_pairs: region.triangle_pairs,
            point_count: region.points.len() as u32,
            curve_count: region.curves.len() as u32,
        }
    }
}

impl ContactMessage {
    fn of(contact: &Contact) -> Self {
        Self {
            feature_a: feature_name(contact.id.0),
            feature_b: feature_name(contact.id.1),
            point_a: contact.point_a.into(),
            point_b: contact.point_b.into(),
            normal: contact.normal.into(),
            separation: contact.separation,
        }
    }
}

impl EventsMessage {
    pub(crate) fn of(frame: &Frame) -> Self {
        let event = |e: &crate::frame::RecordedEvent| {
            let [region, other] = match e.kind {
                PairEventKind::RegionSplit { region, part } => [region, part].map(|id| Some(id.0)),
                PairEventKind::RegionMerged { region, gone } => [region, gone].map(|id| Some(id.0)),
                _ => [None; 2],
            };
            let kind = PairEventKind::name(e.kind).to_owned();
            EventMessage { kind, a: e.a.to_owned(), b: e.b.to_owned(), open: e.open, region, other }
        };
        Self { step: frame.step, events: frame.events.iter().map(event).collect() }
    }
}

impl StatsMessage {
    pub(crate) fn of(frame: &Frame) -> Self {
        let stats = &frame.stats;
        Self {
            step: frame.step,
            boxes: stats.boxes,
            candidate_pairs: stats.candidate_pairs,
            queried_pairs: stats.queried_pairs,
            supplied_pairs: stats.supplied_pairs,
            touching_pairs: stats.touching_pairs,
            contacts: stats.contacts,
            regions: stats.regions,
            node_tests: stats.counters.node_tests,
            triangle_tests: stats.counters.triangle_tests,
            inside_tests: stats.counters.inside_tests,
            triangles_filtered: stats.counters.triangles_filtered,
            triangles_adaptive: stats.counters.triangles_adaptive,
            front_held: stats.counters.front_held,
            front_tested: stats.counters.front_tested,
            front_split: stats.counters.front_split,
            front_merged: stats.counters.front_merged,
            box_tests: stats.broad_phase.box_tests,
            swaps: stats.broad_phase.swaps,
            estimated_pairs: stats.estimates.pairs,
            open_pairs: stats.estimates.open,
            estimate_tests: stats.estimates.tests,
            deepest: frame.deepest.map(|d| DeepestMessage {
                depth: d.depth,
                a: d.a.to_owned(),
                b: d.b.to_owned(),
            }),
            measures: frame.measures.iter().map(MeasureMessage::of).collect(),
        }
    }
}

/// Whether a count says nothing.
fn is_zero<T: Default + PartialEq>(count: &T) -> bool {
    *count == T::default()
}

fn surface_name(surface: Surface) -> &'static str {
    match surface {
        Surface::None => "none",
        Surface::Touch => "touch",
        Surface::Cross => "cross",
    }
}

fn containment_name(containment: Containment) -> &'static str {
    match containment {
        Containment::AInB => "A_in_B",
        Containment::BInA => "B_in_A",
    }
}

fn feature_name(feature: Feature) -> String {
    match feature {
        Feature::Vertex(id) => format!("vertex:{}", id.0),
        Feature::Edge(id) => format!("edge:{}", id.0),
        Feature::Face(id) => format!("face:{}", id.0),
    }
}
