//! Deformation: vertices of a prepared model are moved, and what depends on them follows.
//!
//! What follows, in this order: boxes of trees are fitted again, from the moved faces up, and parts
//! of trees that have become bad are grown again. Patches with a moved face are measured, and
//! divided where they have become too bent. The hull stays if no vertex of it has moved and none
//! has left it, by exact signs; otherwise its surface is repaired around the vertices that moved in
//! or out. Concavities follow by themselves, where somebody has them
//! (`cranny_concavity::FollowedConcavities`), by the [`Trail`].
//!
//! The adjacency of faces knows no positions and never changes.
//!
//! Sources: boxes fitted again from the leaves up are van den Bergen's (1997, "Efficient collision
//! detection of complex deformable models using AABB trees"); those of the hull's repair stand with
//! it (`hull/repair`). That everything follows local changes and equals a rebuild is this crate's
//! own. Cost: see [`Model::deform`].

mod change;
mod dent;
mod follow;
mod renew;
mod totals;

use cranny_exact::{DVec3, check_point};

pub use self::change::{ChangeSet, DeformError, Trail, Work};
pub use self::dent::{Blow, Dent};
use self::follow::Deformation;
use self::renew::Renewal;
use self::totals::Totals;
use crate::each_once::each_once;
use crate::ids::{FaceId, OptionalIndex, PatchId, VertexId};
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::model::{Model, Parts};
use crate::projection::collinear;
use crate::scan::faces::has_no_area;
use crate::tree::GrownAreas;

/// What deformations need and preparation throws away. Made at the first one, in linear time.
#[derive(Clone, Debug)]
pub(crate) struct Workshop {
    tree: GrownAreas,
    /// A point certainly in the interior of the hull, if one is known.
    inside: Option<DVec3>,
    /// For each vertex a triangle of the hull above it, or near it, from which to look for where it
    /// goes.
    above: Vec<u32>,
    totals: Totals,
}

impl Workshop {
    fn of(parts: &Parts) -> Self {
        Self {
            tree: GrownAreas::of(parts.tree().nodes()),
            inside: parts.hull.inner_point(),
            above: triangles_near(parts),
            totals: Totals::of(parts),
        }
    }
}

/// For each vertex a triangle at the vertex of the hull that is the fewest edges away. O(n).
fn triangles_near(parts: &Parts) -> Vec<u32> {
    let Parts { mesh, topology, hull, .. } = parts;
    let mut near = vec![OptionalIndex::NONE; mesh.vertices().len()];
    let mut found: Vec<u32> = Vec::with_capacity(near.len());
    for triangle in (0..hull.triangle_count() as u32).rev() {
        for corner in hull.triangle(triangle as usize) {
            let v = hull.source(corner);
            if near[v.index()].is_none() {
                found.push(v.0);
            }
            near[v.index()] = OptionalIndex::some(triangle);
        }
    }
    let mut next = 0;
    while let Some(&v) = found.get(next) {
        for &f in topology.faces_at(VertexId(v)) {
            for w in mesh.faces()[f.index()] {
                if near[w as usize].is_none() {
                    near[w as usize] = near[v as usize];
                    found.push(w);
                }
            }
        }
        next += 1;
    }
    // Any for what does not hang together with the hull.
    near.into_iter().map(|triangle| triangle.get().unwrap_or(0)).collect()
}

impl Model {
    /// Moves vertices of [`mesh`](Self::mesh) to new places, in the body's frame, all at once, and
    /// brings what was prepared up to date. A vertex that is moved to where it is has not moved;
    /// where none has, nothing changes. In place where this model is not shared; otherwise this one
    /// becomes a copy and the others stay.
    ///
    /// # What equals a rebuild
    ///
    /// Compared with [`build`](Self::build) of the moved mesh, with
    /// [`Repair::None`](crate::Repair::None) and this model's flatness, and as long as no two
    /// vertices coincide (a rebuild would weld them; a deformation keeps vertices, faces and edges
    /// as they are):
    ///
    /// - the hull has the same vertices, with the same numbers, the same triangles and the same
    ///   merged facets, in the same planes to the bit. Triangles and facets may be numbered
    ///   otherwise, so that those away from a change keep the numbers that they had;
    /// - all sizes and the mass properties agree to rounding, box, radius and digest to the bit;
    /// - trees hold the same faces in exact boxes, but may divide them otherwise;
    /// - patches keep their promises, but may be others: growth is greedy, and one face more or
    ///   less would move every border behind it. See [`ChangeSet::patches`].
    ///
    /// # Cost
    ///
    /// The first deformation also makes sums over the whole mesh, and that of a model that was
    /// [loaded](Self::decode) prepares it all again, but for the scan; so does it copy one that is
    /// shared. Each looks at the moved faces and the patches that these belong to, and walks along
    /// the hull to where moved vertices lie: [`Work`] counts it. As long as the hull stays and no
    /// patch is divided, what else there is to do is short:
    ///
    /// - volume, centre, inertia and radius are put together from sums over chunks of 128 faces or
    ///   vertices, the digest from blocks of 32 KiB, of which those with a moved vertex are made
    ///   again. Where the box of the body changes, all are;
    /// - the change set has an entry for each patch, and each patch is glanced at.
    ///
    /// Where the hull changes, triangles and facets away from the change keep their numbers; new
    /// ones take those that are free, and the last ones fill what gaps remain. Beside what is
    /// looked at there is
    ///
    /// - each exactly planar polygon of the hull that gets a new triangle, and all facets that hang
    ///   together with one that changes over edges that do not bend clearly: on a body that is flat
    ///   nearly everywhere, however far that goes;
    /// - a comparison of each facet's plane with the new vertices, and copying of rows;
    /// - where vertices come onto the hull or leave it, all corners of the hull are renamed;
    /// - where a patch is divided, one over all faces.
    ///
    /// Where the hull changes and a twelfth of all faces or more have moved, following would cost
    /// more than building ([`Work::is_anew`]): everything is built anew, and the next deformation
    /// makes what deformations keep once more.
    ///
    /// Where the box of the hull changes, so does what counts as flat, and all facets are measured.
    /// Where a hull's surface cannot be repaired (a vertex inside a flat facet comes out, vertices
    /// coincide) it is built anew, and what is as before keeps its number. Where the body is or
    /// becomes flat, or shrinks away from the point that was known to be inside, all triangles and
    /// facets count as new.
    ///
    /// Vertices have the numbers of [`mesh`](Self::mesh), not those that were filed: see
    /// [`Provenance::vertex`](crate::Provenance::vertex).
    ///
    /// # Errors
    ///
    /// [`DeformError`], and then nothing has changed: a vertex that does not exist or is named
    /// twice, a place outside the [`domain`](cranny_exact::domain), no face left with an area, or a
    /// closed body turned inside out.
    pub fn deform(&mut self, moves: &[(VertexId, DVec3)]) -> Result<ChangeSet, DeformError> {
        let moves = checked(self.mesh(), moves)?;
        let faces = faces_of(self, &moves);
        accept_faces(self.parts(), &moves, &faces)?;
        if moves.is_empty() {
            return Ok(unchanged(self));
        }
        let from = self.digest();
        let parts = self.parts_mut();
        let renewal = Renewal::of(parts);
        let mut workshop = match parts.workshop.take() {
            Some(workshop) => workshop,
            None => Box::new(Workshop::of(parts)),
        };
        let (mut change, has_followed) =
            Deformation::begin(parts, &mut workshop, &moves, faces).run(from);
        parts.workshop = has_followed.then_some(workshop);
        if let Some(renewal) = renewal {
            renewal.report(&mut change, parts);
        }
        Ok(change)
    }
}

/// The moves that lead anywhere, by vertex.
fn checked(
    mesh: &Mesh,
    moves: &[(VertexId, DVec3)],
) -> Result<Vec<(VertexId, DVec3)>, DeformError> {
    let vertices = mesh.vertices().len();
    for (at, &(vertex, place)) in moves.iter().enumerate() {
        if vertex.index() >= vertices {
            return Err(DeformError::UnknownVertex { at, vertex, vertices });
        }
        check_point(place).map_err(|source| DeformError::Coordinate { vertex, source })?;
    }
    let mut sorted = moves.to_vec();
    sorted.sort_by_key(|m| m.0);
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(DeformError::MovedTwice { vertex: pair[0].0 });
    }
    sorted.retain(|&(vertex, place)| mesh.position(vertex) != place);
    Ok(sorted)
}

/// The faces of moved vertices, ascending.
fn faces_of(model: &Model, moves: &[(VertexId, DVec3)]) -> Vec<FaceId> {
    each_once(moves.iter().flat_map(|m| model.topology().faces_at(m.0)).copied())
}

/// Refuses what [`Model::build`] would refuse or turn around.
fn accept_faces(
    parts: &Parts,
    moves: &[(VertexId, DVec3)],
    faces: &[FaceId],
) -> Result<(), DeformError> {
    let mesh = &parts.mesh;
    let place = |v: VertexId| match moves.binary_search_by_key(&v, |m| m.0) {
        Ok(i) => moves[i].1,
        Err(_) => mesh.position(v),
    };
    let count = mesh.faces().len();
    let others = (0..count as u32).map(FaceId).filter(|f| faces.binary_search(f).is_err());
    let moved = faces.iter().map(|&f| mesh.corners(f).map(place));
    let has_area = others.into_iter().any(|f| !has_no_area(mesh, f))
        || moved.clone().any(|[a, b, c]| !collinear(a, b, c));
    if !has_area {
        return Err(DeformError::OnlyDegenerateFaces { faces: count });
    }
    if let Some(mass) = &parts.mass {
        let center = parts.hull.bounds().center();
        let below = |[a, b, c]: [DVec3; 3]| {
            let [a, b, c] = [a - center, b - center, c - center];
            a.dot(b.cross(c)) / 6.0
        };
        let before: f64 = faces.iter().map(|&f| below(mesh.triangle(f))).sum();
        // What a file says of the volume was believed.
        let whole = if parts.only_read { MassProperties::of(mesh).volume } else { mass.volume };
        let volume = whole - before + moved.map(below).sum::<f64>();
        if volume < 0.0 {
            return Err(DeformError::InsideOut { volume });
        }
    }
    Ok(())
}

fn unchanged(model: &Model) -> ChangeSet {
    ChangeSet {
        patches: (0..model.patches().len() as u32).map(|p| Some(PatchId(p))).collect(),
        ..ChangeSet::default()
    }
}
