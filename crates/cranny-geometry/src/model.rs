//! The one prepared thing: everything that is known of a body before it moves.
//!
//! A [`Model`] is shared (`Arc` inside) and never changes but by [`Model::deform`]. It is filled in
//! stages, each a module of this crate; the stages of the full method stand here in order, so that one
//! sees where the next belongs:
//!
//! 1. weld, repair and scan ([`mesh`](Model::mesh), [`Report`]), 2. adjacency
//!    ([`topology`](Model::topology)), 3. hull ([`hull`](Model::hull)), 4. features: convex, concavity,
//!    boundary ([`features`](Model::features)), 5. caps, concavities and their boundary loops
//!    ([`concavities`](Model::concavities)), 6. trees ([`tree`](Model::tree) over all faces,
//!    [`concavity_trees`](Model::concavity_trees)), 7. envelopes ([`envelopes`](Model::envelopes)),
//!    8. patches ([`patches`](Model::patches)), 9. mass ([`mass_properties`](Model::mass_properties)).

mod file;

use std::sync::{Arc, Weak};

use cranny_exact::{Aabb, DVec3, Tolerance};
use thiserror::Error;

use crate::caps::CapSurface;
use crate::concavity::{Concavities, HullCovers};
use crate::deform::Workshop;
use crate::digest::digest;
use crate::envelope::{EnvelopeOptions, Envelopes, Pocket};
use crate::features::{Assignment, Features};
use crate::flatness::Flatness;
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::late::Late;
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::patches::Patches;
use crate::reach::{farthest, radius};
use crate::repair::proof::ProofError;
use crate::repair::{Repair, mend};
use crate::report::{RepairKind, RepairRecord, Report};
use crate::resolution::default_weld_distance;
use crate::scan::faces::has_no_area;
use crate::scan::scan;
use crate::topology::Topology;
use crate::tree::{FaceForest, FaceTree, Mates};
use crate::weld::weld;

pub use file::DecodeError;

/// How to prepare a model.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Faces per leaf of the tree, at least 1. Default: [`BuildOptions::DEFAULT_LEAF_SIZE`].
    pub leaf_size: usize,
    /// Faces per leaf of the trees over concavities, at least 1. Default: [`FaceForest::DEFAULT_LEAF_SIZE`], as
    /// measured there. Envelopes are made of parts of these trees: leaves of more faces than
    /// [`EnvelopeOptions::leaf_faces`] give envelopes of single faces, which take longer to build.
    pub concavity_leaf_size: usize,
    /// What may be mended. Default: [`Repair::None`], which keeps the surface as it was filed.
    pub repair: Repair,
    /// What 'the same place' means for findings and repairs: at most
    /// [`BuildOptions::LARGEST_WELD_SHARE`] of the mesh's diagonal. Default: `None`, chosen from how
    /// finely the coordinates were stored: twice the step of a grid that holds them all, in any unit,
    /// or eight times the step of single or double precision at the largest coordinate, but never
    /// more than a ten-thousandth of the diagonal.
    pub tolerance: Option<Tolerance>,
    /// Whether faces that cross, touch or overlap each other are searched for. Default: yes.
    pub self_intersections: bool,
    /// How flat is flat. Default: [`Flatness::Auto`].
    pub flatness: Flatness,
}

impl BuildOptions {
    /// One face a leaf made cold queries fastest on tori and threads; more than four slows them.
    pub const DEFAULT_LEAF_SIZE: usize = 1;

    /// The largest weld distance, as a share of the mesh's diagonal. Larger, and everything is near
    /// everything: repairs mean nothing and searches take quadratic time.
    pub const LARGEST_WELD_SHARE: f64 = 0.01;

    /// Refuses leaves without faces.
    fn check_leaves(&self) -> Result<(), BuildError> {
        let all = [("all faces", self.leaf_size), ("concavities", self.concavity_leaf_size)];
        match all.into_iter().find(|&(_, size)| size == 0) {
            Some((trees, _)) => Err(BuildError::LeafSize { trees }),
            None => Ok(()),
        }
    }

    fn weld_distance(&self, mesh: &Mesh) -> Result<f64, BuildError> {
        let Some(Tolerance { weld_distance }) = self.tolerance else {
            return Ok(default_weld_distance(mesh));
        };
        let limit = Self::LARGEST_WELD_SHARE * mesh.bounds().diagonal();
        match (0.0..=limit).contains(&weld_distance) {
            true => Ok(weld_distance),
            false => Err(BuildError::WeldDistance { weld_distance, limit }),
        }
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            leaf_size: Self::DEFAULT_LEAF_SIZE,
            concavity_leaf_size: FaceForest::DEFAULT_LEAF_SIZE,
            repair: Repair::None,
            tolerance: None,
            self_intersections: true,
            flatness: Flatness::default(),
        }
    }
}

/// That no face of so many has an area, in words.
pub(crate) fn no_area(faces: usize) -> String {
    match faces {
        1 => "the only face has zero area".to_owned(),
        n => format!("all {n} faces have zero area"),
    }
}

/// A model that cannot be prepared.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh holds no triangle with an area.
    #[error("{}: a body needs at least one triangle with an area", no_area(*.faces))]
    OnlyDegenerateFaces {
        /// Number of faces.
        faces: usize,
    },
    /// A weld distance that is negative, no number, or too large for the mesh.
    #[error(
        "the weld distance {weld_distance:?} is not between 0 and {limit:?}, a hundredth of the mesh's diagonal"
    )]
    WeldDistance {
        /// The distance asked for.
        weld_distance: f64,
        /// The largest for this mesh.
        limit: f64,
    },
    /// Trees whose leaves would hold no face.
    #[error("leaves of 0 faces are asked for, in trees over {trees}: ask for at least 1")]
    LeafSize {
        /// What the trees are over.
        trees: &'static str,
    },
    /// A repair whose proof does not hold: an error of this crate. Build with [`Repair::None`].
    #[error("the repaired mesh could not be proved to be the same surface: {0}")]
    NotProved(#[from] ProofError),
}

/// A stage of preparation, told to whoever measures times (this crate reads no clock).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Weld, repair, adjacency.
    Repair,
    /// The box tree over all faces, and patches.
    Trees,
    /// Scan for findings.
    Scan,
    /// Convex hull.
    Hull,
    /// Features: convex, concavity, boundary.
    Classify,
    /// Caps, concavities, boundary loops.
    Caps,
    /// A box tree for each concavity.
    ConcavityTrees,
    /// Envelopes of concavities.
    Envelopes,
    /// All done.
    Done,
}

/// A prepared body. Cheap to clone; `Send` and `Sync`.
#[derive(Clone, Debug)]
pub struct Model(Arc<Parts>);

/// Envelopes of before one or several deformations.
#[derive(Clone, Debug)]
pub(crate) struct FormerEnvelopes {
    pub(crate) envelopes: Envelopes,
    /// For each concavity now the one before that has the same envelope, if any.
    pub(crate) kept: Vec<Option<usize>>,
}

/// What a model consists of.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology,
    pub(crate) hull: ConvexHull,
    pub(crate) features: Features,
    pub(crate) concavities: Concavities,
    /// Follows from hull, features and concavities.
    pub(crate) hull_covers: Late<HullCovers>,
    pub(crate) tree: FaceTree,
    pub(crate) concavity_trees: Late<FaceForest>,
    pub(crate) envelopes: Late<Envelopes>,
    /// Where a deformation has left some of them to be built: what the others are taken from.
    pub(crate) former_envelopes: Option<FormerEnvelopes>,
    /// Whether trees and envelopes of concavities are those that would be made now from the other parts; not
    /// so after a deformation.
    pub(crate) is_as_made: bool,
    pub(crate) patches: Patches,
    pub(crate) mass: Option<MassProperties>,
    pub(crate) radius: f64,
    pub(crate) digest: [u8; 32],
    /// The filed face of each face; `None` where all are as filed.
    pub(crate) filed_faces: Option<Vec<FaceId>>,
    /// How flat is flat, relative to the largest coordinate magnitude.
    pub(crate) flatness: f64,
    /// Faces per leaf of the tree.
    pub(crate) leaf_size: usize,
    /// Faces per leaf of the trees over concavities.
    pub(crate) concavity_leaf_size: usize,
    /// Whether it was read from bytes and never deformed, so that of what was prepared only the mesh is
    /// sure.
    pub(crate) only_read: bool,
    /// What deformations need beside; none before the first.
    pub(crate) workshop: Option<Box<Workshop>>,
}

impl Model {
    /// Prepares a mesh.
    ///
    /// # Errors
    ///
    /// [`BuildError`] where no face has an area, or an option is none.
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
        options.check_leaves()?;
        observe(Stage::Repair);
        let mut report = Report {
            filed_vertices: mesh.vertices().len(),
            filed_faces: mesh.faces().len(),
            weld_distance: options.weld_distance(&mesh)?,
            ..Report::default()
        };
        let (mut mesh, filed_faces) = mended(mesh, options.repair, &mut report)?;
        if (0..mesh.faces().len() as u32).all(|f| has_no_area(&mesh, FaceId(f))) {
            return Err(BuildError::OnlyDegenerateFaces { faces: mesh.faces().len() });
        }
        let mut topology = Topology::of(&mesh);
        let mut mass = topology.is_closed().then(|| MassProperties::of(&mesh));
        if mass.is_some_and(|m| m.volume < 0.0) {
            mesh = mesh.turned_inside_out();
            topology = Topology::of(&mesh);
            mass = Some(MassProperties::of(&mesh));
            let turned = RepairRecord::new(RepairKind::TurnedRightSideOut, mesh.faces().len());
            report.repairs.push(turned);
        }
        describe(&mesh, &topology, mass.as_ref(), &mut report);

        observe(Stage::Trees);
        let mates = Mates::of(&mesh, &topology);
        let tree = FaceTree::of_pairs(&mesh, &mates, options.leaf_size);
        let patches = Patches::with_mates(&mesh, &topology, &mates);
        observe(Stage::Scan);
        let weld_distance = report.weld_distance;
        let mass_of = mass.as_ref();
        let searches = options.self_intersections;
        report.take(scan(&mesh, &topology, &tree, mass_of, weld_distance, searches));

        observe(Stage::Hull);
        report.flatness = options.flatness.resolve(&mesh);
        let hull = ConvexHull::with_flatness(mesh.vertices(), report.flatness);
        let Covered { features, concavities, concavity_trees, envelopes } =
            Covered::of(&mesh, &topology, &hull, &tree, options.concavity_leaf_size, observe);
        report.add(concavities.surface().findings(
            &mesh,
            &hull,
            features.slab_depth(),
            topology.is_closed(),
        ));
        let (radius, digest) = (radius(farthest(mesh.vertices())), digest(&mesh));
        observe(Stage::Done);
        let parts = Parts {
            mesh,
            topology,
            hull,
            features,
            concavities,
            hull_covers: Late::default(),
            tree,
            concavity_trees: Late::made(concavity_trees),
            envelopes: Late::made(envelopes),
            former_envelopes: None,
            is_as_made: true,
            patches,
            mass,
            radius,
            digest,
            filed_faces,
            flatness: report.flatness,
            leaf_size: options.leaf_size,
            concavity_leaf_size: options.concavity_leaf_size,
            only_read: false,
            workshop: None,
        };
        Ok((Self(Arc::new(parts)), report))
    }

    /// Scans the prepared mesh once more: the report that [`build`](Self::build) would make of it, for a
    /// model that was loaded. What was mended before the model was saved is not known any more.
    ///
    /// # Errors
    ///
    /// [`BuildError::WeldDistance`], as [`build`](Self::build).
    pub fn survey(&self, options: &BuildOptions) -> Result<Report, BuildError> {
        let Parts { mesh, topology, hull, features, concavities, tree, mass, flatness, .. } =
            &*self.0;
        let mut report = Report {
            filed_vertices: mesh.vertices().len(),
            filed_faces: mesh.faces().len(),
            weld_distance: options.weld_distance(mesh)?,
            flatness: *flatness,
            ..Report::default()
        };
        describe(mesh, topology, mass.as_ref(), &mut report);
        let (mass, distance) = (mass.as_ref(), report.weld_distance);
        report.take(scan(mesh, topology, tree, mass, distance, options.self_intersections));
        report.add(concavities.surface().findings(
            mesh,
            hull,
            features.slab_depth(),
            topology.is_closed(),
        ));
        Ok(report)
    }

    /// The mended mesh. Face ids are those that were filed unless repairs other than
    /// [`Repair::None`] parted or dropped faces; see [`filed_face`](Self::filed_face).
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

    /// Which features lie on the hull.
    #[must_use]
    pub fn features(&self) -> &Features {
        &self.0.features
    }

    /// What the hull covers and the body does not fill: concavities, their caps and boundary loops.
    #[must_use]
    pub fn concavities(&self) -> &Concavities {
        &self.0.concavities
    }

    /// What covers facets, edges and vertices of the [`hull`](Self::hull): faces of the mesh, or lids of which
    /// [`concavities`](Self::concavities).
    ///
    /// Made at the first call, also of a model that was built: few ask. See [`HullCovers`] for the cost.
    #[must_use]
    pub fn hull_covers(&self) -> &HullCovers {
        let Parts { mesh, topology, hull, features, concavities, hull_covers, .. } = &*self.0;
        hull_covers.get(|| HullCovers::of(mesh, topology, hull, features, concavities))
    }

    /// Box tree over all faces.
    #[must_use]
    pub fn tree(&self) -> &FaceTree {
        &self.0.tree
    }

    /// A box tree for each of the [`concavities`](Self::concavities), by their ids.
    ///
    /// A model that was [loaded](Self::decode) makes them at the first call, which then costs what that stage
    /// of building does (README); see [`prepare_all`](Self::prepare_all).
    #[must_use]
    pub fn concavity_trees(&self) -> &FaceForest {
        self.0.concavity_trees()
    }

    /// An envelope for each of the [`concavities`](Self::concavities), by their ids.
    ///
    /// A model that was [loaded](Self::decode) makes them, and the trees that they are made from, at the first
    /// call, which then costs what these stages of building do (README); see
    /// [`prepare_all`](Self::prepare_all). After a [deformation](Self::deform) those of concavities that it
    /// touched are made at the first call.
    #[must_use]
    pub fn envelopes(&self) -> &Envelopes {
        self.0.envelopes()
    }

    /// Makes what a model that was [loaded](Self::decode) would otherwise make when first asked:
    /// [`concavity_trees`](Self::concavity_trees) and [`envelopes`](Self::envelopes), and the graph over the vertices
    /// of the [`hull`](Self::hull). For whoever wants no late cost; nothing to do for a model that was built and not deformed. Not
    /// [`hull_covers`](Self::hull_covers), which building leaves for later too.
    pub fn prepare_all(&self) {
        self.0.envelopes();
        self.0.hull.prepare_all();
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

    /// A hash of the prepared geometry: equal meshes have equal digests on every machine. Of a loaded model,
    /// what was saved.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        self.0.digest
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

impl Parts {
    pub(crate) fn concavity_trees(&self) -> &FaceForest {
        let Self { mesh, tree, concavities, concavity_leaf_size, .. } = self;
        self.concavity_trees.get(|| concavity_trees(mesh, tree, concavities, *concavity_leaf_size))
    }

    pub(crate) fn envelopes(&self) -> &Envelopes {
        let Self { mesh, concavities, former_envelopes, .. } = self;
        self.envelopes.get(|| match former_envelopes {
            None => envelopes(mesh, concavities, self.concavity_trees()),
            Some(FormerEnvelopes { envelopes, kept }) => {
                let openings = openings(concavities);
                let (pockets, trees) = (pockets(concavities, &openings), self.concavity_trees());
                envelopes.updated(mesh, pockets, trees, |i| kept[i])
            }
        })
    }

    /// Takes the trees of concavities out, for whoever puts others in their places, and what there is of
    /// envelopes.
    pub(crate) fn take_late(&mut self) -> (FaceForest, Option<FormerEnvelopes>) {
        let Self { mesh, tree, concavities, concavity_leaf_size, .. } = self;
        let make_trees = || concavity_trees(mesh, tree, concavities, *concavity_leaf_size);
        let trees = std::mem::take(&mut self.concavity_trees).into_made(make_trees);
        let former = self.former_envelopes.take();
        let all = std::mem::take(&mut self.envelopes).if_taken();
        let made = all.map(|envelopes| FormerEnvelopes {
            kept: (0..concavities.len()).map(Some).collect(),
            envelopes,
        });
        (trees, made.or(former))
    }
}

/// Stages 4 to 7: what the hull covers, and whether the body fills it.
pub(crate) struct Covered {
    pub(crate) features: Features,
    pub(crate) concavities: Concavities,
    pub(crate) concavity_trees: FaceForest,
    pub(crate) envelopes: Envelopes,
}

impl Covered {
    pub(crate) fn of(
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
        tree: &FaceTree,
        leaf_size: usize,
        observe: &mut dyn FnMut(Stage),
    ) -> Self {
        observe(Stage::Classify);
        let assignment = Assignment::of(mesh, topology, hull, tree);
        let (features, ridges) = Features::of(mesh, topology, &assignment);
        observe(Stage::Caps);
        let caps = CapSurface::build(mesh, topology, hull, &assignment, &ridges);
        let concavities = Concavities::of(mesh, topology, hull, &features, caps);
        observe(Stage::ConcavityTrees);
        let concavity_trees = concavity_trees(mesh, tree, &concavities, leaf_size);
        observe(Stage::Envelopes);
        let envelopes = envelopes(mesh, &concavities, &concavity_trees);
        Self { features, concavities, concavity_trees, envelopes }
    }
}

/// For each concavity how its lids open.
pub(crate) fn openings(concavities: &Concavities) -> Vec<Vec<DVec3>> {
    concavities.iter().map(|c| c.lids().map(|lid| lid.opening).collect()).collect()
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

/// Names one prepared model without keeping it alive: for memories that hold numbers of its faces and
/// nodes. A clone of the model has the same name; an equal one that was built apart has another, and so
/// does what a deformation makes of it.
#[derive(Clone, Debug)]
pub struct ModelTag(Weak<Parts>);

impl ModelTag {
    /// The name of a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self(Arc::downgrade(&model.0))
    }

    /// Whether this is the model's name.
    #[must_use]
    pub fn is_of(&self, model: &Model) -> bool {
        // The tag holds on to the place, so no other model can have come to stand there.
        std::ptr::eq(self.0.as_ptr(), Arc::as_ptr(&model.0))
    }
}

/// A tree for each concavity, given the one over all faces.
fn concavity_trees(
    mesh: &Mesh,
    tree: &FaceTree,
    concavities: &Concavities,
    leaf_size: usize,
) -> FaceForest {
    let groups = concavities.iter().map(|concavity| concavity.faces);
    FaceForest::within(tree, mesh, groups, leaf_size)
}

/// An envelope for each concavity, which opens through its lids.
fn envelopes(mesh: &Mesh, concavities: &Concavities, trees: &FaceForest) -> Envelopes {
    let openings = openings(concavities);
    Envelopes::within(mesh, pockets(concavities, &openings), trees, &EnvelopeOptions::default())
}

fn pockets<'a>(
    concavities: &'a Concavities,
    openings: &'a [Vec<DVec3>],
) -> impl Iterator<Item = Pocket<'a>> {
    let pockets = concavities.iter().zip(openings);
    pockets.map(|(concavity, openings)| Pocket { faces: concavity.faces, openings })
}

/// Welds what is in exactly the same place, then mends as far as the policy goes. Returns the mesh
/// and the filed face of each of its faces where these are not the same.
fn mended(
    mesh: Mesh,
    policy: Repair,
    report: &mut Report,
) -> Result<(Mesh, Option<Vec<FaceId>>), BuildError> {
    let welded = weld(&mesh);
    for (kind, vertices) in [
        (RepairKind::WeldedVertices, &welded.duplicates),
        (RepairKind::DroppedVertices, &welded.unreferenced),
    ] {
        if !vertices.is_empty() {
            let record = RepairRecord::new(kind, vertices.len());
            report.repairs.push(RepairRecord { vertices: vertices.clone(), ..record });
        }
    }
    if policy == Repair::None {
        return Ok((welded.mesh, None));
    }
    let mended = mend(&mesh, welded, policy == Repair::Full, report.weld_distance)?;
    report.repairs.extend(mended.records);
    report.deviation = mended.deviation;
    Ok((mended.mesh, mended.filed_face))
}
