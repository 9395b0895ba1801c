//! The one prepared thing: everything that is known of a body before it moves.
//!
//! A [`Model`] is immutable and shared (`Arc` inside). It is filled in stages, each a module of this
//! crate; the stages of the full method stand here in order, so that one sees where the next belongs:
//!
//! 1. weld ([`mesh`](Model::mesh)), 2. adjacency ([`topology`](Model::topology)), 3. hull
//!    ([`hull`](Model::hull)), 4. features (convex, concavity, boundary), 5. loops and caps,
//!    6. trees ([`tree`](Model::tree); one over all faces now, one per concavity once caps exist),
//!    7. envelopes, 8. patches ([`patches`](Model::patches)), 9. mass ([`mass_properties`](Model::mass_properties)).
//!
//! Stages 4, 5 and 7 are not built yet; nothing that exists pretends to be them.

use std::sync::Arc;

use cranny_exact::{Aabb, DVec3};
use thiserror::Error;

use crate::hull::ConvexHull;
use crate::ids::{EdgeId, FaceId};
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::patches::Patches;
use crate::report::{Finding, FindingKind, Repair, Report};
use crate::topology::{EdgeKind, Topology};
use crate::tree::FaceTree;
use crate::weld::weld;

/// How to prepare a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// Faces per leaf of the tree, at least 1. Default: [`BuildOptions::DEFAULT_LEAF_SIZE`].
    pub leaf_size: usize,
}

impl BuildOptions {
    /// One face a leaf made cold queries fastest on tori and threads; more than four slows them.
    pub const DEFAULT_LEAF_SIZE: usize = 1;
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { leaf_size: Self::DEFAULT_LEAF_SIZE }
    }
}

/// A model that cannot be prepared.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh holds no triangle with an area.
    #[error("all {faces} faces have zero area: a body needs at least one triangle with an area")]
    OnlyDegenerateFaces {
        /// Number of faces.
        faces: usize,
    },
}

/// A stage of preparation, told to whoever measures times (this crate reads no clock).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Weld, scan, repair, adjacency.
    Repair,
    /// Convex hull.
    Hull,
    /// Box trees and patches.
    Trees,
    /// All done.
    Done,
}

/// A prepared body. Cheap to clone; `Send` and `Sync`.
#[derive(Clone, Debug)]
pub struct Model(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    mesh: Mesh,
    topology: Topology,
    hull: ConvexHull,
    tree: FaceTree,
    patches: Patches,
    mass: Option<MassProperties>,
    radius: f64,
    digest: [u8; 32],
}

impl Model {
    /// Prepares a mesh.
    ///
    /// # Errors
    ///
    /// [`BuildError`] where no face has an area.
    pub fn build(mesh: Mesh, options: &BuildOptions) -> Result<(Self, Report), BuildError> {
        Self::build_observed(mesh, options, &mut |_| {})
    }

    /// [`build`](Self::build), telling each [`Stage`] as it begins.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_observed(
        mesh: Mesh,
        options: &BuildOptions,
        observe: &mut dyn FnMut(Stage),
    ) -> Result<(Self, Report), BuildError> {
        observe(Stage::Repair);
        let mut report = Report::default();
        let filed_vertices = mesh.vertices().len();
        let welded = weld(&mesh);
        if welded.duplicates > 0 {
            report.repairs.push(Repair::WeldedVertices { count: welded.duplicates });
        }
        if welded.unreferenced > 0 {
            report.repairs.push(Repair::DroppedVertices { count: welded.unreferenced });
        }
        let mut mesh = welded.mesh;
        let degenerate = degenerate_faces(&mesh);
        if degenerate.len() == mesh.faces().len() {
            return Err(BuildError::OnlyDegenerateFaces { faces: mesh.faces().len() });
        }
        let mut topology = Topology::of(&mesh);
        let mut mass = topology.is_closed().then(|| MassProperties::of(&mesh));
        if mass.is_some_and(|m| m.volume < 0.0) {
            mesh = mesh.turned_inside_out();
            topology = Topology::of(&mesh);
            mass = Some(MassProperties::of(&mesh));
            report.repairs.push(Repair::TurnedRightSideOut { faces: mesh.faces().len() });
        }
        scan(&mesh, &topology, degenerate, &mut report);
        report.filed_vertices = filed_vertices;
        report.vertices = mesh.vertices().len();
        report.faces = mesh.faces().len();
        report.components = topology.components().len();
        report.closed = topology.is_closed();
        report.oriented = topology.is_oriented();
        report.area =
            (0..mesh.faces().len() as u32).map(|f| mesh.area_vector(FaceId(f)).length()).sum();
        report.volume = mass.map(|m| m.volume);

        observe(Stage::Hull);
        let hull = ConvexHull::of_points(mesh.vertices());
        observe(Stage::Trees);
        let tree = FaceTree::of(&mesh, options.leaf_size);
        let patches = Patches::of(&mesh, &topology);
        let radius = mesh.vertices().iter().map(|p| p.length()).fold(0.0, f64::max).next_up();
        let digest = digest(&mesh);
        observe(Stage::Done);
        Ok((
            Self(Arc::new(Parts { mesh, topology, hull, tree, patches, mass, radius, digest })),
            report,
        ))
    }

    /// The welded mesh; face ids are those that were filed.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.0.mesh
    }

    /// Adjacency of [`mesh`](Self::mesh).
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.0.topology
    }

    /// Convex hull of the vertices.
    #[must_use]
    pub fn hull(&self) -> &ConvexHull {
        &self.0.hull
    }

    /// Box tree over all faces.
    #[must_use]
    pub fn tree(&self) -> &FaceTree {
        &self.0.tree
    }

    /// The surface in connected patches of nearly one normal.
    #[must_use]
    pub fn patches(&self) -> &Patches {
        &self.0.patches
    }

    /// Whether every component is closed, so that the model bounds a solid.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.0.topology.is_closed()
    }

    /// Volume, centre and inertia; `None` where the mesh is not closed.
    #[must_use]
    pub fn mass_properties(&self) -> Option<&MassProperties> {
        self.0.mass.as_ref()
    }

    /// Box of all vertices, in the body's frame.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.0.tree.node(0).bounds
    }

    /// No vertex is farther than this from the origin of the body's frame (rounded up).
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.0.radius
    }

    /// A hash of the prepared geometry: equal meshes have equal digests on every machine.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        self.0.digest
    }

    /// Whether both are the very same shared model (not only equal ones).
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

fn digest(mesh: &Mesh) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&(mesh.vertices().len() as u64).to_le_bytes());
    for p in mesh.vertices() {
        for x in p.to_array() {
            // `+ 0.0`: −0 and 0 are the same place.
            hasher.update(&(x + 0.0).to_bits().to_le_bytes());
        }
    }
    for &i in mesh.faces().iter().flatten() {
        hasher.update(&i.to_le_bytes());
    }
    *hasher.finalize().as_bytes()
}

/// Faces whose corners lie on a line or in a point, exactly: co-linear in all three projections.
fn degenerate_faces(mesh: &Mesh) -> Vec<FaceId> {
    use cranny_exact::{DVec2, orient2d};
    let flat = |[a, b, c]: [DVec3; 3], x: usize, y: usize| {
        let p = |v: DVec3| DVec2::new(v[x], v[y]);
        orient2d(p(a), p(b), p(c)).is_zero()
    };
    (0..mesh.faces().len() as u32)
        .map(FaceId)
        .filter(|&f| {
            let t = mesh.triangle(f);
            flat(t, 0, 1) && flat(t, 1, 2) && flat(t, 2, 0)
        })
        .collect()
}

fn scan(mesh: &Mesh, topology: &Topology, degenerate: Vec<FaceId>, report: &mut Report) {
    for face in degenerate {
        let [a, b, c] = mesh.triangle(face);
        report.findings.push(Finding {
            kind: FindingKind::ZeroAreaFace,
            ids: vec![face.0],
            at: (a + b + c) / 3.0,
            measure: (b - a).length().max((c - b).length()).max((a - c).length()),
        });
    }
    for (e, edge) in topology.edges().iter().enumerate() {
        let kind = match edge.kind {
            EdgeKind::Manifold => continue,
            _ if edge.from == edge.to => continue, // the short side of a collapsed face
            EdgeKind::Open => FindingKind::OpenEdge,
            EdgeKind::Contradictory => FindingKind::ContradictoryEdge,
            EdgeKind::Balanced | EdgeKind::Tangled => FindingKind::NonManifoldEdge,
        };
        let (p, q) = (mesh.position(edge.from), mesh.position(edge.to));
        report.findings.push(Finding {
            kind,
            ids: topology.half_edges(EdgeId(e as u32)).iter().map(|h| h.face().0).collect(),
            at: 0.5 * (p + q),
            measure: (q - p).length(),
        });
    }
}
