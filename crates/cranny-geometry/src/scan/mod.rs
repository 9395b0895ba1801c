//! The degeneracy scan: everything unusual about a mesh, as typed [`Finding`]s.
//!
//! Reads a mesh whose coincident vertices are welded; moves nothing. Apart from 'near' and 'thin',
//! which measure against the weld distance, every finding is decided exactly. O(n log n), but for
//! the pairs of faces that meet, of which there can be more; that search gives up at a bound
//! ([`MeetingScan::Stopped`](crate::MeetingScan::Stopped)).
//!
//! Sources stand with the parts.

mod arcs;
pub(crate) mod cracks;
mod crowds;
mod edges;
pub(crate) mod faces;
mod judge;
mod meetings;
mod outline;
mod pairs;
mod row;
pub(crate) mod shells;
mod stars;
mod turns;
mod views;

use cranny_exact::{DVec3, Sign};

use crate::ids::{ComponentId, FaceId, VertexId};
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::report::{Finding, FindingKind, MeetingScan};
use crate::topology::Topology;
use crate::tree::FaceTree;
use cracks::TVertex;
use faces::Looked;
use stars::Stars;

/// What a scan found.
pub(crate) struct Scanned {
    /// Kind by kind, harmless ones last.
    pub(crate) findings: Vec<Finding>,
    pub(crate) meetings: MeetingScan,
    /// The sum of the areas of all faces, which was read on the way.
    pub(crate) area: f64,
}

/// The findings of a mesh.
pub(crate) fn scan(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    mass: Option<&MassProperties>,
    weld_distance: f64,
    self_intersections: bool,
) -> Scanned {
    let looked = Looked::at(mesh, weld_distance);
    let Looked { turns, without_area, area, .. } = &looked;
    let in_one_place = faces::coincident(mesh, topology);
    let t_vertices = cracks::t_vertices(mesh, topology, tree, weld_distance);
    let near = cracks::near(mesh, tree, weld_distance, |_| true);
    let mut stars = Stars::of(mesh, topology);

    let mut findings = faces::thin(mesh, &looked, weld_distance);
    findings.extend(faces::in_one_place(mesh, &in_one_place));
    findings.extend(edges::unsound(mesh, topology));
    findings.extend(edges::pinched(mesh, topology, &stars));
    findings.extend(cracks::t_vertex_findings(mesh, topology, &t_vertices));
    findings.extend(cracks::near_findings(mesh, &near));
    findings.extend(shell_findings(mesh, topology, tree, mass.map(|mass| mass.volume)));
    let mut meetings = MeetingScan::Skipped;
    if self_intersections {
        let mut left_out = without_area.clone();
        for copy in in_one_place.iter().flat_map(|group| &group[1..]) {
            left_out[copy.index()] = true;
        }
        let reasons = touches_at_t_vertices(topology, &t_vertices);
        let explained = |f: FaceId, g: FaceId| {
            let touches =
                |f, g| mesh.corners(g).into_iter().any(|v| reasons.binary_search(&(f, v)).is_ok());
            !reasons.is_empty() && (touches(f, g) || touches(g, f))
        };
        let found;
        (found, meetings) =
            meetings::meetings(mesh, topology, tree, &mut stars, turns, &left_out, explained);
        findings.extend(found);
    }
    findings.extend(edges::flat(mesh, topology, turns, without_area));
    findings.sort_by_key(|finding| (finding.kind.limits().is_empty(), finding.kind));
    Scanned { findings, meetings, area: *area }
}

/// Faces with a T-vertex on one of their edges, and that vertex; sorted.
fn touches_at_t_vertices(topology: &Topology, found: &[TVertex]) -> Vec<(FaceId, VertexId)> {
    let mut reasons: Vec<_> = found
        .iter()
        .flat_map(|t| topology.half_edges(t.edge).iter().map(|h| (h.face(), t.vertex)))
        .collect();
    reasons.sort_unstable();
    reasons
}

/// Which way the components look, and how they lie in each other.
fn shell_findings(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    volume: Option<f64>,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let area = |faces: &[FaceId]| faces.iter().map(|&f| mesh.area_vector(f).length()).sum();
    let middle = |f: FaceId| mesh.triangle(f).iter().sum::<DVec3>() / 3.0;
    let shells = shells::shells(mesh, topology, tree, volume);
    let disagreement = shells::disagreement(mesh.faces().len(), topology);
    for group in &disagreement.turned {
        let ids = group.iter().map(|f| f.0).collect();
        let at = middle(group[0]);
        findings.push(Finding::one(FindingKind::BackFaces, ids, at, area(group)));
    }
    let mut areas = vec![0.0; topology.components().len()];
    if !disagreement.twisted.is_empty() {
        for face in mesh.face_ids() {
            areas[topology.component_of(face).index()] += mesh.area_vector(face).length();
        }
    }
    for &face in &disagreement.twisted {
        let component = topology.component_of(face);
        let (kind, at) = (FindingKind::NonOrientable, middle(face));
        findings.push(Finding::one(kind, vec![component.0], at, areas[component.index()]));
    }
    for (component, shell) in shells.iter().enumerate() {
        let kind = match (shell.looks, shell.inside.is_empty()) {
            (Sign::Negative, true) => FindingKind::InsideOut,
            (Sign::Negative, false) => FindingKind::Cavity,
            (Sign::Positive, false) => FindingKind::NestedSolid,
            _ => continue,
        };
        let mut ids = vec![component as u32];
        ids.extend(shell.inside.iter().map(|&ComponentId(id)| id));
        findings.push(Finding::one(kind, ids, shell.center, shell.volume));
    }
    if shells.len() > 1 {
        let bounds = tree.node(0).bounds;
        findings.push(Finding {
            kind: FindingKind::SeveralShells,
            ids: topology.components().iter().map(|c| c.first_face.0).collect(),
            at: bounds.center(),
            measure: bounds.diagonal(),
            count: shells.len(),
        });
    }
    findings
}
