//! The one prepared thing: everything that is known of a body before it moves.
//!
//! A [`Model`] is shared (`Arc` inside) and never changes but by [`Model::deform`]. It is filled in
//! stages, each a module of this crate; the stages of the full method stand here in order, so that
//! one sees where the next belongs:
//!
//! 1. weld, repair and scan ([`mesh`](Model::mesh), [`Report`]), 2. adjacency
//!    ([`topology`](Model::topology)), 3. mass ([`mass_properties`](Model::mass_properties)), 4.
//!    tree over all faces ([`tree`](Model::tree)), 5. patches ([`patches`](Model::patches)),
//!    6. hull ([`hull`](Model::hull)).
//!
//! What lies between the body and its hull is no part of a model. Whoever wants it makes it
//! (`cranny_concavity::Concavities::of`).

mod file;
mod options;
mod parts;
mod tag;

use std::sync::Arc;

use cranny_exact::{Aabb, Tolerance};

use crate::clusters::ClusterTree;
use crate::digest::digest;
use crate::flatness::Flatness;
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::on_demand::{FromStored, OnDemand};
use crate::patches::Patches;
use crate::reach::{farthest, radius};
use crate::repair::{Repair, mend};
use crate::report::{Provenance, RepairKind, RepairRecord, Report};
use crate::scan::faces::has_no_area;
use crate::scan::scan;
use crate::topology::Topology;
use crate::tree::{FaceTree, Mates};
use crate::weld::weld;

pub use file::DecodeError;
pub(crate) use options::no_area;
use options::weld_distance;
pub use options::{BuildError, BuildOptions, Stage};
pub(crate) use parts::Parts;
pub use tag::ModelTag;

/// A prepared body. Cheap to clone; `Send` and `Sync`.
#[derive(Clone, Debug)]
pub struct Model(Arc<Parts>);

impl Model {
    /// Prepares a mesh.
    ///
    /// # Errors
    ///
    /// [`BuildError`] where no face has an area, or an option is none.
    pub fn build(mesh: Mesh, options: &BuildOptions) -> Result<(Self, Report), BuildError> {
        Self::build_observed(mesh, options, &mut |_| {})
    }

    /// [`build`](Self::build), calling `observe` with each [`Stage`] as it begins.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_observed(
        mesh: Mesh,
        options: &BuildOptions,
        observe: &mut dyn FnMut(Stage),
    ) -> Result<(Self, Report), BuildError> {
        if options.leaf_size == 0 {
            return Err(BuildError::LeafSize);
        }
        observe(Stage::Repair);
        let weld_distance = weld_distance(options.tolerance, options.flatness, &mesh)?;
        let mut report = Report { weld_distance, ..Report::default() };
        let PreparedMesh { mut mesh, filed_faces, mut provenance } =
            mended(mesh, options.repair, weld_distance)?;
        if mesh.face_ids().all(|f| has_no_area(&mesh, f)) {
            return Err(BuildError::OnlyDegenerateFaces { faces: mesh.faces().len() });
        }
        let mut topology = Topology::of(&mesh);
        let mut mass = topology.is_closed().then(|| MassProperties::of(&mesh));
        if mass.is_some_and(|m| m.volume < 0.0) {
            mesh = mesh.turned_inside_out();
            topology = Topology::of(&mesh);
            mass = Some(MassProperties::of(&mesh));
            let turned = RepairRecord::new(RepairKind::TurnedRightSideOut, mesh.faces().len());
            provenance.repairs.push(turned);
        }
        report.provenance = Some(provenance);
        describe(&mesh, &topology, mass.as_ref(), &mut report);

        observe(Stage::Trees);
        let mates = Mates::of(&mesh, &topology);
        let tree = FaceTree::of_pairs(&mesh, &mates, options.leaf_size);
        let patches = Patches::with_mates(&mesh, &topology, &mates);
        observe(Stage::Scan);
        let mass_of = mass.as_ref();
        let searches = options.self_intersections;
        report.take(scan(&mesh, &topology, &tree, mass_of, weld_distance, searches));

        observe(Stage::Hull);
        report.flatness = options.flatness.resolve(&mesh);
        let hull = ConvexHull::with_flatness(mesh.vertices(), report.flatness);
        let (radius, digest) = (radius(farthest(mesh.vertices())), digest(&mesh));
        observe(Stage::Done);
        let parts = Parts {
            mesh,
            topology,
            hull,
            tree: FromStored::made(tree),
            patches,
            clusters: OnDemand::default(),
            mass,
            radius,
            digest,
            filed_faces,
            flatness: report.flatness,
            leaf_size: options.leaf_size,
            only_read: false,
            workshop: None,
        };
        Ok((Self(Arc::new(parts)), report))
    }

    /// Scans the prepared mesh once more: the report that [`build`](Self::build) would make of it,
    /// for a model that was loaded. What was mended before the model was saved is not known any
    /// more.
    ///
    /// `tolerance` and `self_intersections` mean what they mean in [`BuildOptions`]; without a
    /// tolerance, how finely a mesh was stored is read off its coordinates, as with
    /// [`Flatness::Auto`].
    ///
    /// # Errors
    ///
    /// [`BuildError::WeldDistance`], as [`build`](Self::build).
    pub fn survey(
        &self,
        tolerance: Option<Tolerance>,
        self_intersections: bool,
    ) -> Result<Report, BuildError> {
        let Parts { mesh, topology, mass, flatness, .. } = &*self.0;
        let mut report = Report {
            weld_distance: weld_distance(tolerance, Flatness::Auto, mesh)?,
            flatness: *flatness,
            ..Report::default()
        };
        describe(mesh, topology, mass.as_ref(), &mut report);
        let (mass, distance) = (mass.as_ref(), report.weld_distance);
        report.take(scan(mesh, topology, self.tree(), mass, distance, self_intersections));
        Ok(report)
    }

    /// The mended mesh. Face ids are those that were filed unless repairs other than
    /// [`Repair::None`] parted or dropped faces; see [`filed_face`](Self::filed_face). **Vertices
    /// are numbered anew**, in the order in which faces use them first: [`Provenance::vertex`]
    /// says what became of each filed one.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.0.mesh
    }

    /// The filed face that a face is, or is a part of.
    #[must_use]
    pub fn filed_face(&self, face: FaceId) -> FaceId {
        self.0.filed_faces.as_ref().map_or(face, |filed| filed[face.index()])
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
    ///
    /// A model that was [loaded](Self::decode) makes its boxes at the first call, in linear time.
    #[must_use]
    #[inline]
    pub fn tree(&self) -> &FaceTree {
        self.0.tree()
    }

    /// Makes what a model that was [loaded](Self::decode) would otherwise make at their first use:
    /// [`tree`](Self::tree), the [search tree](Self::clusters), the graph over the vertices of the
    /// [`hull`](Self::hull), and the faces at vertices. For whoever wants no late cost.
    pub fn prepare_all(&self) {
        self.0.tree();
        self.0.clusters();
        self.0.hull.prepare_all();
        self.0.topology.prepare_all();
    }

    /// The surface in connected patches of nearly one normal.
    #[must_use]
    #[inline]
    pub fn patches(&self) -> &Patches {
        &self.0.patches
    }

    /// The search tree that questions about pairs go down.
    ///
    /// Made at the first call, and anew at the first call after a [deformation](Self::deform): O(n
    /// log n), about 3 microseconds a face. Call it where a body is made if no first query is to
    /// wait for it.
    #[inline]
    pub fn clusters(&self) -> &ClusterTree {
        self.0.clusters()
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
        self.0.hull.bounds()
    }

    /// No vertex is farther than this from the origin of the body's frame (rounded up).
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.0.radius
    }

    /// A hash of the prepared geometry: equal meshes have equal digests on every machine. Of a
    /// loaded model, what was saved.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        self.0.digest
    }

    /// The [digest](Self::digest) in hexadecimal digits.
    #[must_use]
    pub fn digest_text(&self) -> String {
        self.0.digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    pub(crate) fn parts(&self) -> &Parts {
        &self.0
    }

    /// The parts of this model alone: a copy, where they are shared.
    pub(crate) fn parts_mut(&mut self) -> &mut Parts {
        Arc::make_mut(&mut self.0)
    }

    /// Whether both are the very same shared model (not only equal ones).
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Counts and measures what is prepared.
fn describe(mesh: &Mesh, topology: &Topology, mass: Option<&MassProperties>, report: &mut Report) {
    report.vertices = mesh.vertices().len();
    report.faces = mesh.faces().len();
    report.components = topology.components().len();
    report.closed = topology.is_closed();
    report.oriented = topology.is_oriented();
    report.volume = mass.map(|m| m.volume);
}

/// A mesh that may have been mended.
struct PreparedMesh {
    mesh: Mesh,
    /// The filed face of each face, where these are not the same.
    filed_faces: Option<Vec<FaceId>>,
    provenance: Provenance,
}

/// Welds what is in exactly the same place, then mends as far as the policy goes.
fn mended(mesh: Mesh, policy: Repair, weld_distance: f64) -> Result<PreparedMesh, BuildError> {
    let mut provenance = Provenance {
        vertices: mesh.vertices().len(),
        faces: mesh.faces().len(),
        ..Provenance::default()
    };
    let welded = weld(&mesh);
    for (kind, vertices) in [
        (RepairKind::WeldedVertices, &welded.duplicates),
        (RepairKind::DroppedVertices, &welded.unreferenced),
    ] {
        if !vertices.is_empty() {
            let record = RepairRecord::new(kind, vertices.len());
            provenance.repairs.push(RepairRecord { vertices: vertices.clone(), ..record });
        }
    }
    if policy == Repair::None {
        provenance.new_ids = welded.new_id;
        return Ok(PreparedMesh { mesh: welded.mesh, filed_faces: None, provenance });
    }
    let mended = mend(&mesh, welded, policy == Repair::Full, weld_distance)?;
    provenance.repairs.extend(mended.records);
    provenance.deviation = mended.deviation;
    provenance.new_ids = mended.new_id;
    Ok(PreparedMesh { mesh: mended.mesh, filed_faces: mended.filed_face, provenance })
}
