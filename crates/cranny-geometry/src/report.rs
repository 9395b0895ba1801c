//! What was found and mended while a model was prepared.

mod finding_kind;
mod provenance;
mod repair_record;

use cranny_exact::DVec3;

use crate::scan::Scanned;

pub use finding_kind::{Element, FindingKind};
pub use provenance::Provenance;
pub use repair_record::{RepairKind, RepairRecord};

/// The outcome of preparing a mesh, or of surveying a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// What was filed and what was mended; `None` of a model that was loaded, whose file does not
    /// say.
    pub provenance: Option<Provenance>,
    /// Vertices of the prepared mesh.
    pub vertices: usize,
    /// Faces of the prepared mesh; [`Model::filed_face`](crate::Model::filed_face) says whence each
    /// came.
    pub faces: usize,
    /// Components that hang together over edges.
    pub components: usize,
    /// Every component bounds a region of space.
    pub closed: bool,
    /// No two faces contradict each other's orientation.
    pub oriented: bool,
    /// Surface area. Unit: length^2.
    pub area: f64,
    /// Volume, where closed. Unit: length^3.
    pub volume: Option<f64>,
    /// What 'the same place' meant for findings and repairs. Unit: length.
    pub weld_distance: f64,
    /// How far the search for faces that meet went.
    pub meetings: MeetingScan,
    /// The flatness that was taken, relative to the largest coordinate magnitude: see
    /// [`Flatness`](crate::Flatness).
    pub flatness: f64,
    /// What is unusual and remains in the prepared mesh.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Whether no finding limits any answer. Harmless ones (edges between faces in one plane,
    /// several shells) may remain.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.findings.iter().all(|finding| finding.kind.limits().is_empty())
    }

    /// What was mended, in order; nothing where that is not known.
    #[must_use]
    pub fn repairs(&self) -> &[RepairRecord] {
        self.provenance.as_ref().map_or(&[], |known| &known.repairs)
    }

    /// Why the volumes of pockets (`cranny_concavity::Measures::pocket_volume`) mean nothing;
    /// `None` where they do, as far as faces that meet were [searched for](Self::meetings).
    #[must_use]
    pub fn volumes_unknown(&self) -> Option<&'static str> {
        let has = |kind| self.findings.iter().any(|finding| finding.kind == kind);
        if !self.closed {
            return Some("the mesh is not closed");
        }
        if has(FindingKind::DuplicateFaces) || has(FindingKind::OppositeFaces) {
            return Some("faces lie in one place with others");
        }
        let crosses = has(FindingKind::SelfIntersection) || has(FindingKind::CoplanarOverlap);
        crosses.then_some("the surface passes through itself")
    }

    /// Takes in what a scan found.
    pub(crate) fn take(&mut self, Scanned { findings, meetings, area }: Scanned) {
        (self.findings, self.meetings, self.area) = (findings, meetings, area);
    }

    /// Adds findings, those about concavities (`cranny_concavity::Concavities::findings`), say.
    /// What limits answers stays first, kind by kind.
    pub fn add(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|finding| (finding.kind.limits().is_empty(), finding.kind));
    }
}

/// How far the search for faces that cross, touch or overlap each other went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeetingScan {
    /// Not wanted: such faces are not reported.
    #[default]
    Skipped,
    /// Every pair was judged.
    Complete,
    /// Given up after so many pairs: there are more than the report lists.
    Stopped {
        /// Pairs judged.
        tests: usize,
    },
}

/// Something unusual, where it is and how large.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is.
    pub kind: FindingKind,
    /// What is concerned: numbers of the prepared mesh's vertices, faces or components, as
    /// [`FindingKind::element`] says, in the order that [`FindingKind::concerned`] gives. In a
    /// finding that sums up many, of the largest.
    pub ids: Vec<u32>,
    /// A point of it, in the body's frame.
    pub at: DVec3,
    /// Its size; [`FindingKind::measured`] says which.
    pub measure: f64,
    /// How many such places this finding stands for; 1 but for kinds that are summed up.
    pub count: usize,
}

impl Finding {
    /// Of one place.
    #[must_use]
    pub fn one(kind: FindingKind, ids: Vec<u32>, at: DVec3, measure: f64) -> Self {
        Self { kind, ids, at, measure, count: 1 }
    }
}
