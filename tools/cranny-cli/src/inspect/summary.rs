//! What `cranny inspect` reports, as it is written in JSON.

use std::path::Path;
use std::time::Duration;

use cranny_concavity::Concavity;
use cranny_concavity::{Concavities, Envelope, Envelopes};
use cranny_geometry::{Finding, MeetingScan, Model, RepairRecord};
use serde::Serialize;

use crate::failure::Failure;
use crate::model_file::LoadedModel;

/// Everything that is known of a mesh. What this version does not determine is `None` (null), or an
/// empty list: never an invented number.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    version: u32,
    pub(super) file: String,
    pub(super) format: &'static str,
    pub(super) digest: String,
    pub(super) vertices: usize,
    /// As read; null, like the other three of origin, for a saved model, which does not say.
    pub(super) filed_vertices: Option<usize>,
    pub(super) faces: usize,
    pub(super) filed_faces: Option<usize>,
    pub(super) components: usize,
    pub(super) closed: bool,
    pub(super) oriented: bool,
    pub(super) bounds: [[f64; 3]; 2],
    pub(super) volume: Option<f64>,
    pub(super) area: f64,
    pub(super) weld_distance: f64,
    /// What counted as rounding when flat things were recognized, as a share of the largest
    /// coordinate.
    pub(super) flatness: f64,
    /// The prepared surface is the filed one within this distance.
    pub(super) deviation: Option<f64>,
    pub(super) findings: Vec<FindingLine>,
    /// Whether every pair of faces was looked at; if not, more may cross or touch.
    pub(super) findings_complete: bool,
    pub(super) repairs: Option<Vec<RepairLine>>,
    pub(super) hull: HullLine,
    pub(super) features: FeaturesLine,
    pub(super) concavities: Vec<ConcavityLine>,
    /// Why the volumes of pockets are unknown; null where they are known.
    pub(super) volumes_unknown: Option<&'static str>,
    /// Volume between the hull and the faces on it.
    pub(super) skin_volume: f64,
    /// Area of the hull beyond that of the faces on it.
    pub(super) skin_area: f64,
    pub(super) patches: usize,
    /// Of the saved model; null where none was saved.
    pub(super) bytes: Option<usize>,
    pub(super) time_ms: TimesLine,
    pub(super) notes: Vec<String>,
    pub(super) outputs: Vec<String>,
    /// What the colours of the picture mean, a line each.
    pub(super) legend: Vec<String>,
    pub(super) skipped: Vec<Skipped>,
}

/// Something unusual.
#[derive(Debug, Serialize)]
pub(super) struct FindingLine {
    pub(super) kind: &'static str,
    /// What a finding of this kind is, and whence it comes.
    pub(super) meaning: &'static str,
    /// What `ids` number: "vertex", "face" or "component".
    pub(super) of: &'static str,
    pub(super) ids: Vec<u32>,
    pub(super) at: [f64; 3],
    pub(super) measure: f64,
    /// How many places this stands for.
    pub(super) count: usize,
    pub(super) limits: &'static [&'static str],
}

/// Something that was mended.
#[derive(Debug, Serialize)]
pub(super) struct RepairLine {
    pub(super) kind: &'static str,
    pub(super) count: usize,
    /// As filed; empty where nearly all are concerned.
    pub(super) faces: Vec<u32>,
    /// As filed; of what is always done to vertices.
    pub(super) vertices: Vec<u32>,
    /// How far the surface moved at most.
    pub(super) moved: f64,
    pub(super) text: String,
}

/// The convex hull.
#[derive(Debug, Serialize)]
pub(super) struct HullLine {
    pub(super) kind: &'static str,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) facets: usize,
    pub(super) volume: f64,
    pub(super) area: f64,
    pub(super) thickness_max: f64,
}

/// What lies on the hull.
#[derive(Debug, Serialize)]
pub(super) struct FeaturesLine {
    pub(super) convex_sets: usize,
    pub(super) concavities: usize,
    pub(super) boundary_edges: usize,
    /// Vertices on the hull that no face or edge on the hull ends at.
    pub(super) isolated_vertices: usize,
    /// Edges on the hull whose faces are all off it.
    pub(super) ridges: usize,
    /// What lies no deeper beneath the hull is on it.
    pub(super) slab_depth: f64,
}

/// What the hull covers and the body does not fill.
#[derive(Debug, Serialize)]
pub(super) struct ConcavityLine {
    pub(super) id: u32,
    pub(super) kind: &'static str,
    pub(super) faces: usize,
    pub(super) loops: usize,
    pub(super) lids: usize,
    pub(super) cap_area: f64,
    pub(super) area: f64,
    /// Null where the body's volume is unknown, for then it means nothing.
    pub(super) pocket_volume: Option<f64>,
    /// Of one without a lid, what surrounds it.
    pub(super) parent: Option<u32>,
    pub(super) tree_nodes: usize,
    pub(super) envelope_layers: usize,
    /// How many layers lie one beneath the other, at most.
    pub(super) envelope_depth: usize,
    pub(super) envelope_facets: usize,
}

/// Milliseconds a stage.
#[derive(Debug, Serialize)]
pub(super) struct TimesLine {
    pub(super) read: f64,
    pub(super) repair: f64,
    pub(super) scan: f64,
    pub(super) hull: f64,
    pub(super) classify: f64,
    pub(super) caps: f64,
    pub(super) trees: f64,
    pub(super) envelopes: f64,
}

/// Something that was wanted and could not be done.
#[derive(Debug, Serialize)]
pub(super) struct Skipped {
    pub(super) what: String,
    pub(super) why: String,
}

impl Skipped {
    /// A file that was to be written, and why it was not.
    pub(super) fn after(path: &Path, failure: &Failure) -> Self {
        Self { what: path.display().to_string(), why: failure.to_string() }
    }
}

impl Summary {
    /// The report of a prepared model.
    pub(super) fn new(path: &Path, loaded: &LoadedModel, concavities: &Concavities) -> Self {
        let LoadedModel { model, report, format, notes, times } = loaded;
        let bounds = model.bounds();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let volumes_unknown = report.volumes_unknown();
        let filed = report.provenance.as_ref();
        Self {
            version: 1,
            file: path.display().to_string(),
            format,
            digest: model.digest_text(),
            vertices: report.vertices,
            filed_vertices: filed.map(|filed| filed.vertices),
            faces: report.faces,
            filed_faces: filed.map(|filed| filed.faces),
            components: report.components,
            closed: report.closed,
            oriented: report.oriented,
            bounds: [bounds.min.to_array(), bounds.max.to_array()],
            volume: report.volume,
            area: report.area,
            weld_distance: report.weld_distance,
            flatness: report.flatness,
            deviation: filed.map(|filed| filed.deviation),
            findings: report.findings.iter().map(FindingLine::new).collect(),
            findings_complete: report.meetings == MeetingScan::Complete,
            repairs: filed.map(|filed| filed.repairs.iter().map(RepairLine::new).collect()),
            hull: HullLine::new(model),
            features: FeaturesLine::new(concavities),
            concavities: concavities
                .iter()
                .map(|one| ConcavityLine::new(concavities, &one, volumes_unknown.is_none()))
                .collect(),
            volumes_unknown,
            skin_volume: concavities.skin().volume,
            skin_area: concavities.skin().area,
            patches: model.patches().len(),
            bytes: None,
            time_ms: TimesLine {
                read: ms(times.read),
                repair: ms(times.repair),
                scan: ms(times.scan),
                hull: ms(times.hull),
                classify: ms(times.classify),
                caps: ms(times.caps),
                trees: ms(times.trees),
                envelopes: ms(times.envelopes),
            },
            notes: notes.clone(),
            outputs: Vec::new(),
            legend: Vec::new(),
            skipped: Vec::new(),
        }
    }
}

impl FindingLine {
    fn new(finding: &Finding) -> Self {
        Self {
            kind: finding.kind.name(),
            meaning: finding.kind.meaning(),
            of: finding.kind.element().name(),
            ids: finding.ids.clone(),
            at: finding.at.to_array(),
            measure: finding.measure,
            count: finding.count,
            limits: finding.kind.limits(),
        }
    }
}

impl RepairLine {
    fn new(repair: &RepairRecord) -> Self {
        Self {
            kind: repair.kind.name(),
            count: repair.count,
            faces: repair.faces.clone(),
            vertices: repair.vertices.clone(),
            moved: repair.moved,
            text: repair.to_string(),
        }
    }
}

impl FeaturesLine {
    fn new(concavities: &Concavities) -> Self {
        let features = concavities.features();
        Self {
            convex_sets: features.convex_sets().len(),
            concavities: concavities.len(),
            boundary_edges: features.boundary_edge_count(),
            isolated_vertices: features.isolated_vertices().len(),
            ridges: features.ridges().len(),
            slab_depth: features.slab_depth(),
        }
    }
}

impl ConcavityLine {
    fn new(all: &Concavities, concavity: &Concavity<'_>, is_known: bool) -> Self {
        let index = concavity.id().index();
        let envelopes = all.envelopes();
        let layers = Layers::of(envelopes, &envelopes.envelope(index));
        Self {
            id: concavity.id().0,
            kind: concavity.kind.as_str(),
            faces: concavity.faces.len(),
            loops: concavity.loops().len(),
            lids: concavity.lids().len(),
            cap_area: concavity.measures.cap_area,
            area: concavity.measures.face_area,
            pocket_volume: is_known.then_some(concavity.measures.pocket_volume),
            parent: concavity.parent.map(|id| id.0),
            tree_nodes: all.trees().nodes(index).len(),
            envelope_layers: layers.count,
            envelope_depth: layers.depth,
            envelope_facets: layers.facets,
        }
    }
}

/// The size of an envelope.
#[derive(Default)]
struct Layers {
    count: usize,
    depth: usize,
    facets: usize,
}

impl Layers {
    fn of(all: &Envelopes, envelope: &Envelope<'_>) -> Self {
        let mut layers = Self::default();
        let mut open: Vec<_> = envelope.first_layer().map(|first| (first, 1)).into_iter().collect();
        while let Some((layer, depth)) = open.pop() {
            layers.count += 1;
            layers.depth = layers.depth.max(depth);
            layers.facets += all.layer(layer).len();
            let beneath = all.layer(layer).filter_map(|facet| all.layer_beneath(facet));
            open.extend(beneath.map(|layer| (layer, depth + 1)));
        }
        layers
    }
}

impl HullLine {
    fn new(model: &Model) -> Self {
        let hull = model.hull();
        Self {
            kind: hull.kind().as_str(),
            vertices: hull.vertex_count(),
            triangles: hull.triangle_count(),
            facets: hull.facet_count(),
            volume: hull.volume(),
            area: hull.area(),
            // Rounding outward leaves the least of all numbers where there is nothing.
            thickness_max: Some(hull.thickness_max()).filter(|t| t.is_normal()).unwrap_or(0.0),
        }
    }
}
