//! The search tree of a model: clusters of a few faces under nodes of eight oriented boxes.
//!
//! One structure, made once with the model, serves every question about a pair: which faces meet,
//! which are nearest, which features make contacts. A *cluster* holds at most eight neighbouring
//! faces of nearly one normal (`grow`), with what the narrow phase compares eight at a time: planes
//! and corners of its faces, vertices and ridges. A *node* holds up to eight boxes side by side
//! (`build`), each around a node or a cluster. Each of them knows with what wrenches its contacts
//! can press (`wrenches`), so how fast a motion closes them.
//!
//! Everything here serves to leave things out, so it is in single precision: coordinates are
//! relative to [`ClusterTree::origin`] and divided by [`ClusterTree::unit`], a power of two, so
//! that no magnitude overflows and scaling a model by a power of two changes no bit. Boxes are
//! rounded outward. The clusters' own coordinates are rounded to nearest and relative to the
//! cluster's centre; [`ROUNDING`] bounds what that may be off by.
//!
//! Sources: oriented boxes, Gottschalk, Lin and Manocha (1996); wide nodes, Wald, Benthin and
//! Boulos (2008, "Getting rid of packets"). Clusters grown along the surface are this crate's own:
//! cut along a tree, those of a thread mix flank and crest, and twice as many pairs of them come
//! near.

mod build;
mod features;
mod grow;
mod lanes;
mod oriented;
mod wrenches;

use cranny_exact::{Aabb, DVec3};

pub use self::features::Owned;
use self::features::{Owners, Tip};
pub use self::lanes::{CornerLanes, FaceLanes, LANES, Lanes, Lanes3, RidgeLanes};
pub use self::oriented::OrientedBox;
use self::oriented::PointPair;
pub use self::wrenches::{WRENCH, WrenchBox, WrenchLanes};
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::patches::Patches;
use crate::topology::Topology;

/// By how much, as a share of the lengths that take part, a sum of a few products of
/// single-precision coordinates may be off: 2^-19, or 32 units in the last place.
///
/// A stored coordinate is off by half a unit; turning and moving it rounds six times more, an inner
/// product with a stored unit vector, itself off by half a unit each way, again as often. Twenty in
/// all; 32 leave room. Smaller, and something near is left out; larger, and more is looked at in
/// vain.
pub const ROUNDING: f32 = 1.0 / (1 << 19) as f32;

/// What a lane of a node leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    const CLUSTER: u32 = 1 << 31;

    /// The root of every tree.
    pub const ROOT: Self = Self(0);

    pub(crate) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(crate) fn of_cluster(index: usize) -> Self {
        Self(index as u32 | Self::CLUSTER)
    }

    /// Whether it is a cluster.
    #[must_use]
    #[inline]
    pub fn is_cluster(self) -> bool {
        self.0 & Self::CLUSTER != 0
    }

    /// The index of the node or of the cluster.
    #[must_use]
    #[inline]
    pub fn index(self) -> usize {
        (self.0 & !Self::CLUSTER) as usize
    }
}

/// Up to eight boxes side by side.
#[derive(Clone, Debug)]
pub struct WideNode {
    /// Centres of the boxes.
    pub center: Lanes3,
    /// Their axes: unit and at right angles, to rounding.
    pub axes: [Lanes3; 3],
    /// Half their lengths along these.
    pub half: Lanes3,
    /// Radii of balls about the centres that hold the boxes.
    pub radius: Lanes,
    /// With what wrenches contacts in the boxes can press.
    pub wrenches: WrenchLanes,
    /// What the boxes hold; [`Child::ROOT`] beyond [`count`](Self::count).
    pub children: [Child; LANES],
    /// Number of boxes, at least 1.
    pub count: u32,
}

impl WideNode {
    /// The bits of the lanes that hold something.
    #[must_use]
    #[inline]
    pub fn mask(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// One of the boxes.
    #[must_use]
    #[inline]
    pub fn boxed(&self, lane: usize) -> OrientedBox {
        OrientedBox {
            center: self.center.get(lane),
            axes: [self.axes[0].get(lane), self.axes[1].get(lane), self.axes[2].get(lane)],
            half: self.half.get(lane),
            radius: self.radius.0[lane],
        }
    }
}

/// A few neighbouring faces of nearly one normal, with what contacts of them can be made of.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// What its coordinates are relative to, in the body's frame and in the body's unit of length.
    pub center: DVec3,
    /// Around its faces; its centre is the origin.
    pub bounds: OrientedBox,
    /// The mean of the normals of its faces, unit; of faces without area any direction.
    pub normal: [f32; 3],
    /// With what wrenches its contacts can press.
    pub wrenches: WrenchBox,
    /// Its faces, at most eight.
    pub faces: FaceLanes,
    points: [u32; 2],
    corners: [u32; 2],
    ridges: [u32; 2],
}

/// The search tree of a model.
#[derive(Clone, Debug)]
pub struct ClusterTree {
    origin: DVec3,
    unit: f64,
    root: OrientedBox,
    nodes: Vec<WideNode>,
    clusters: Vec<Cluster>,
    points: Vec<Lanes3>,
    corners: Vec<CornerLanes>,
    ridges: Vec<RidgeLanes>,
    owned: Vec<Owned>,
    solids: Vec<Aabb>,
}

impl ClusterTree {
    /// Of a mesh, its adjacency, and its patches, by which features are shared out.
    ///
    /// Cost: O(n log n).
    #[must_use]
    pub fn of(mesh: &Mesh, topology: &Topology, patches: &Patches) -> Self {
        let bounds = mesh.bounds();
        let origin = bounds.center();
        let unit = power_of_two_above(0.5 * (bounds.max - bounds.min).length());
        let places: Vec<DVec3> = mesh.vertices().iter().map(|p| (*p - origin) / unit).collect();
        let normals: Vec<DVec3> =
            mesh.face_ids().map(|f| mesh.area_vector(f).normalize_or_zero()).collect();
        let surface = Surface { mesh, topology, places: &places, normals: &normals };
        let groups = grow::groups(&surface);
        let is_ridge = features::ridges_of(&surface);
        let owners = Owners::of(&surface, &groups, &is_ridge);
        let tips = Tip::all(&surface);
        let owned = features::owned(&surface, patches, &tips, &is_ridge);
        let built = build::build(&surface, &groups);
        let mut tree = Self {
            origin,
            unit,
            root: built.root,
            nodes: built.nodes,
            clusters: Vec::with_capacity(groups.len()),
            points: Vec::new(),
            corners: Vec::new(),
            ridges: Vec::new(),
            owned,
            solids: solids(mesh, topology),
        };
        for (number, &group) in built.order.iter().enumerate() {
            let bounds = built.bounds[number];
            let of_mesh = (&surface, patches, tips.as_slice());
            tree.add(of_mesh, (&groups[group], owners.of_group(group)), bounds);
        }
        wrenches::fill_nodes(&mut tree.nodes, &tree.clusters);
        tree
    }

    /// Adds a cluster: its faces, and the features that are looked at from it.
    fn add(
        &mut self,
        (surface, patches, tips): (&Surface, &Patches, &[Tip]),
        (faces, share): (&[FaceId], features::Share),
        bounds: OrientedBox,
    ) {
        let middle = DVec3::from_array(bounds.center.map(f64::from));
        let from = |p: DVec3| p - middle;
        let range = |start: usize, end: usize| [start as u32, end as u32];
        let (points, corners, ridges) = (self.points.len(), self.corners.len(), self.ridges.len());
        self.points.extend(features::points(surface, faces, from));
        self.corners.extend(features::corners(surface, (patches, tips), share.vertices, from));
        self.ridges.extend(features::ridges(surface, patches, share.edges, from));
        self.clusters.push(Cluster {
            center: self.origin + self.unit * middle,
            bounds: OrientedBox { center: [0.0; 3], ..bounds },
            normal: features::mean_normal(surface, faces),
            wrenches: wrenches::of_cluster((surface, tips), faces, share),
            faces: features::faces(surface, (&self.owned, patches), faces, from),
            points: range(points, self.points.len()),
            corners: range(corners, self.corners.len()),
            ridges: range(ridges, self.ridges.len()),
        });
    }

    /// What all coordinates of boxes are relative to, in the body's frame.
    #[must_use]
    #[inline]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The length that single-precision coordinates are multiples of: a power of two, no point is
    /// farther than that from the [`origin`](Self::origin).
    #[must_use]
    #[inline]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// A box around everything.
    #[must_use]
    #[inline]
    pub fn root(&self) -> &OrientedBox {
        &self.root
    }

    /// The nodes; the first is the root.
    #[must_use]
    #[inline]
    pub fn nodes(&self) -> &[WideNode] {
        &self.nodes
    }

    /// The clusters, in the order of a walk through the tree: neighbours stand near each other.
    #[must_use]
    #[inline]
    pub fn clusters(&self) -> &[Cluster] {
        &self.clusters
    }

    /// The vertices of a cluster's faces; the last lanes repeat the first.
    #[must_use]
    #[inline]
    pub fn points(&self, cluster: &Cluster) -> &[Lanes3] {
        let [start, end] = cluster.points;
        &self.points[start as usize..end as usize]
    }

    /// The vertices that are looked at from a cluster. Each vertex of the mesh is looked at from
    /// one.
    #[must_use]
    #[inline]
    pub fn corners(&self, cluster: &Cluster) -> &[CornerLanes] {
        let [start, end] = cluster.corners;
        &self.corners[start as usize..end as usize]
    }

    /// The ridges that are looked at from a cluster: each edge that may make a contact is looked at
    /// from one.
    #[must_use]
    #[inline]
    pub fn ridges(&self, cluster: &Cluster) -> &[RidgeLanes] {
        let [start, end] = cluster.ridges;
        &self.ridges[start as usize..end as usize]
    }

    /// What counts to a face rather than to its neighbours.
    #[must_use]
    #[inline]
    pub fn owned(&self, face: FaceId) -> Owned {
        self.owned[face.index()]
    }

    /// A box around each closed component, in the body's frame: what lies in none of them is
    /// outside.
    #[must_use]
    #[inline]
    pub fn solids(&self) -> &[Aabb] {
        &self.solids
    }

    /// Heap bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
            + size_of_val(&*self.clusters)
            + size_of_val(&*self.points)
            + size_of_val(&*self.corners)
            + size_of_val(&*self.ridges)
            + size_of_val(&*self.owned)
            + size_of_val(&*self.solids)
    }
}

/// A face of less height than this, in the tree's unit, says nothing of its normal at a pose: what
/// posing rounds turns it. Smaller: bounds are passed by faces that are nearly lines; larger:
/// clusters of fine meshes are not bounded.
const LEAST_HEIGHT: f64 = 1.0 / (1 << 16) as f64;

/// What clusters are made of.
pub(crate) struct Surface<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// Vertices in the tree's coordinates, in double precision.
    places: &'a [DVec3],
    /// Unit, or zero without area.
    normals: &'a [DVec3],
}

impl Surface<'_> {
    fn triangle(&self, face: FaceId) -> [DVec3; 3] {
        self.mesh.corners(face).map(|v| self.places[v.index()])
    }

    fn normal(&self, face: FaceId) -> DVec3 {
        self.normals[face.index()]
    }

    /// The normal of a face, if posing does not turn it.
    fn certain_normal(&self, face: FaceId) -> Option<DVec3> {
        let [a, b, c] = self.triangle(face);
        let longest = (b - a).length_squared().max((c - b).length_squared());
        let longest = longest.max((a - c).length_squared()).sqrt();
        let area = (b - a).cross(c - a).length();
        (area > LEAST_HEIGHT * longest).then(|| self.normal(face))
    }

    /// Where vertices are, two at a time.
    fn points_at(&self, vertices: &[VertexId]) -> impl Iterator<Item = PointPair> {
        let at = |v: VertexId| self.places[v.index()];
        vertices.chunks(2).map(move |two| PointPair::of([at(two[0]), at(two[two.len() - 1])]))
    }

    /// The vertices of some faces, each once, ascending.
    fn vertices_of(&self, faces: &[FaceId]) -> Vec<VertexId> {
        let mut vertices = Vec::with_capacity(3 * faces.len());
        vertices.extend(faces.iter().flat_map(|&face| self.mesh.corners(face)));
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }
}

/// A box around each closed component.
fn solids(mesh: &Mesh, topology: &Topology) -> Vec<Aabb> {
    let mut boxes = vec![Aabb::EMPTY; topology.components().len()];
    for face in mesh.face_ids() {
        let own = &mut boxes[topology.component_of(face).index()];
        *own = own.union(&Aabb::of_points(mesh.triangle(face)));
    }
    let closed = topology.components().iter().map(|component| component.closed);
    boxes.into_iter().zip(closed).filter(|(_, closed)| *closed).map(|(own, _)| own).collect()
}

/// The least power of two that is greater than a positive number.
fn power_of_two_above(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    f64::from_bits((exponent + 1) << 52)
}

#[cfg(test)]
mod tests;
