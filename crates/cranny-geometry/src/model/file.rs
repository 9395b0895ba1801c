//! Model files: a prepared model as bytes, and back.
//!
//! A file is a head ([`head`]) and sections. Section: four letters, length of its body, body.
//! Everything is little-endian, and the same model gives the same bytes on every machine. What a
//! section says stands beside the structure that it is of (`codec`).
//!
//! The digest of the mesh is believed: to hash it again would take a tenth of loading, and whoever
//! forges it turns the order of bodies in pairs around, no more.

mod head;

use std::sync::Arc;

use cranny_exact::{DMat3, DVec3};

use super::{Model, Parts};
use crate::codec::{Flaw, Reader, Writer, check, is_flatness};
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::on_demand::{FromStored, OnDemand};
use crate::patches::Patches;
use crate::reach::{farthest, radius};
use crate::scan::faces::has_no_area;
use crate::topology::Topology;
use crate::tree::StoredTree;
use head::{HEAD, check_head, doubtful_field, seal, write_head};

pub use head::DecodeError;

/// The sections: their tags, and how errors name them.
mod section {
    pub(super) type Section = ([u8; 4], &'static str);

    pub(super) const MESH: Section = (*b"MESH", "mesh");
    pub(super) const TOPOLOGY: Section = (*b"TOPO", "topology");
    pub(super) const HULL: Section = (*b"HULL", "hull");
    pub(super) const TREE: Section = (*b"TREE", "tree");
    pub(super) const PATCHES: Section = (*b"PTCH", "patches");
    pub(super) const MASS: Section = (*b"MASS", "mass");
    pub(super) const ORIGIN: Section = (*b"ORIG", "origin");
}
use section::Section;

impl Model {
    /// As bytes that [`decode`](Self::decode) turns into the same model. The same model always
    /// gives the same bytes, 65 to 125 a face. Cost: linear.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let Parts {
            mesh,
            topology,
            hull,
            tree: _,
            patches,
            mass,
            // Made again from the mesh.
            radius: _,
            digest,
            filed_faces,
            flatness,
            leaf_size,
            // Made when it is needed.
            only_read: _,
            clusters: _,
            workshop: _,
        } = &*self.0;
        let mut out = Writer::default();
        write_head(&mut out);
        let mut section = |(tag, _): Section, body: &dyn Fn(&mut Writer)| out.section(tag, body);
        section(section::MESH, &|out| {
            out.one(*digest);
            out.one(mesh.faces().len() as u64);
            // `+ 0`: no zero has a sign, as in the digest.
            let vertices = mesh.vertices().iter().map(|&p| p + DVec3::ZERO);
            out.items(mesh.vertices().len(), vertices);
            mesh.faces().iter().for_each(|&face| out.one(face));
        });
        section(section::TOPOLOGY, &|out| topology.encode(out));
        section(section::HULL, &|out| hull.encode(out));
        section(section::TREE, &|out| self.tree().encode(out));
        section(section::PATCHES, &|out| patches.encode(out));
        section(section::MASS, &|out| out.list(&mass_numbers(mass.as_ref())));
        section(section::ORIGIN, &|out| {
            out.one(*flatness);
            out.one(*leaf_size as u64);
            // None at all where all are as filed; a mesh has at least one.
            out.list(filed_faces.as_deref().unwrap_or_default());
        });
        let mut bytes = out.into_bytes();
        seal(&mut bytes);
        bytes
    }

    /// From bytes that [`encode`](Self::encode) made.
    ///
    /// Bytes from anywhere may be given, with a right checksum or not: either they are refused, or
    /// the model can be read and queried like any other, and its answers are only as true as the
    /// bytes. Memory is bounded by a small multiple of their number. Cost: linear.
    ///
    /// # What is left for later
    ///
    /// The boxes of [`tree`](Self::tree) are made when they are first used, in linear time: by the
    /// first query whose bodies no plane between their hulls parts. What the file says of it is
    /// checked here.
    ///
    /// The graph over the hull's vertices ([`ConvexHull::support`], [`ConvexHull::neighbours`]) is
    /// made when it is first used, in linear time: by the first query that looks for a plane
    /// between two hulls.
    ///
    /// The faces at each vertex ([`Topology::faces_at`](crate::Topology::faces_at)) likewise: by
    /// the first query that finds a contact at a vertex.
    ///
    /// Whoever wants no late cost calls [`prepare_all`](Self::prepare_all).
    ///
    /// # What is checked
    ///
    /// Length and checksum; that every section is of the length it says, every index in range,
    /// every number one, every unit vector of length 1. Beyond that:
    ///
    /// - Mesh: as [`Mesh::new`], and that a face has an area. The radius is computed; the digest is
    ///   what the file says.
    /// - Topology: that half-edges are each there once, sorted by edge, and that no edge joins two
    ///   components. All else is made from that. Not that the faces of a component hang together.
    /// - Hull: exactly, that its triangles are the boundary of a convex body, gone around once,
    ///   that twins are twins, and that its box is that of all vertices. Not that it holds the
    ///   other vertices, nor that the planes of its facets lie above it.
    /// - Tree: that it holds each face once, in leaves that make a tree. Boxes are made again.
    /// - Patches: that each face is in one. Not that cones, boxes and sizes are theirs.
    /// - Mass: that it is there where the mesh is closed. Not that it is the mesh's.
    ///
    /// [`deform`](Self::deform) builds on more than is proved here, and so believes nothing but the
    /// mesh: the first deformation of a loaded model prepares it again.
    ///
    /// # Errors
    ///
    /// [`DecodeError`], which says what is wrong and what to do.
    pub fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        let Err(error) = check_head(bytes) else { return Self::of_sections(&bytes[HEAD..]) };
        // A model of another version, or cut off, as a rule cannot be read.
        let is_whole = |_: &&str| Self::of_sections(&bytes[HEAD..]).is_ok();
        let damaged = doubtful_field(bytes, &error).filter(is_whole);
        Err(damaged.map_or(error, |field| DecodeError::Head { field }))
    }

    fn of_sections(bytes: &[u8]) -> Result<Self, DecodeError> {
        let mut sections = Reader::new(bytes);
        let (mesh, digest) = read(&mut sections, section::MESH, read_mesh)?;
        let topology = read(&mut sections, section::TOPOLOGY, |s| Topology::decode(s, &mesh))?;
        let hull = read(&mut sections, section::HULL, |s| ConvexHull::decode(s, &mesh))?;
        let tree = read(&mut sections, section::TREE, |s| StoredTree::decode(s, &mesh))?;
        let patches = read(&mut sections, section::PATCHES, |s| Patches::decode(s, &mesh))?;
        let mass = read(&mut sections, section::MASS, |s| read_mass(s, topology.is_closed()))?;
        let Origin { flatness, leaf_size, filed_faces } =
            read(&mut sections, section::ORIGIN, |s| read_origin(s, mesh.faces().len()))?;
        sections.end().map_err(|flaw| flawed(section::ORIGIN, flaw))?;
        let radius = radius(farthest(mesh.vertices()));
        let parts = Parts {
            mesh,
            topology,
            hull,
            tree: FromStored::stored(tree),
            patches,
            clusters: OnDemand::default(),
            mass,
            radius,
            digest,
            filed_faces,
            flatness,
            leaf_size,
            only_read: true,
            workshop: None,
        };
        Ok(Self(Arc::new(parts)))
    }
}

fn flawed((_, section): Section, Flaw(flaw): Flaw) -> DecodeError {
    DecodeError::Section { section, flaw }
}

/// Reads one section, all of it.
fn read<T>(
    sections: &mut Reader,
    section: Section,
    body: impl FnOnce(&mut Reader) -> Result<T, Flaw>,
) -> Result<T, DecodeError> {
    let whole = || {
        let mut own = sections.section(section.0)?;
        let read = body(&mut own)?;
        own.end()?;
        Ok(read)
    };
    whole().map_err(|flaw| flawed(section, flaw))
}

/// The mesh and its digest.
fn read_mesh(input: &mut Reader) -> Result<(Mesh, [u8; 32]), Flaw> {
    let (digest, count): ([u8; 32], u64) = (input.one()?, input.one()?);
    let vertices: Vec<DVec3> = input.list()?;
    let faces: Vec<[u32; 3]> = input.items(count)?;
    let is_digested = |x: f64| x.to_bits() != (-0.0f64).to_bits();
    let coordinates = || vertices.iter().flat_map(|p| p.to_array());
    check(coordinates().fold(true, |all, x| all & is_digested(x)), "a zero has a sign")?;
    let mesh = Mesh::new(vertices, faces)?;
    check(mesh.face_ids().any(|f| !has_no_area(&mesh, f)), "no face has an area")?;
    Ok((mesh, digest))
}

/// Written of the mass: the volume, the centre, the columns of the inertia tensor. Nothing of a
/// mesh that is not closed.
fn mass_numbers(mass: Option<&MassProperties>) -> Vec<f64> {
    let Some(&MassProperties { volume, center, inertia }) = mass else { return Vec::new() };
    [&[volume][..], &center.to_array(), &inertia.to_cols_array()].concat()
}

fn read_mass(input: &mut Reader, is_closed: bool) -> Result<Option<MassProperties>, Flaw> {
    let numbers: Vec<f64> = input.list()?;
    check(numbers.is_empty() != is_closed, "only a closed mesh has a mass")?;
    if numbers.is_empty() {
        return Ok(None);
    }
    check(numbers.iter().all(|x| x.is_finite()), "the mass is no number")?;
    let flaw = "the mass has too few or too many numbers";
    let &[volume, x, y, z, ref inertia @ ..] = numbers.as_slice() else { return Err(flaw.into()) };
    let inertia: &[f64; 9] = inertia.try_into().map_err(|_| flaw)?;
    check(volume >= 0.0, "the mass is negative")?;
    Ok(Some(MassProperties {
        volume,
        center: DVec3::new(x, y, z),
        inertia: DMat3::from_cols_array(inertia),
    }))
}

/// How the model was built; as in [`Parts`].
struct Origin {
    flatness: f64,
    leaf_size: usize,
    filed_faces: Option<Vec<FaceId>>,
}

fn read_origin(input: &mut Reader, faces: usize) -> Result<Origin, Flaw> {
    let (flatness, leaf_size): (f64, u64) = (input.one()?, input.one()?);
    let filed: Vec<FaceId> = input.list()?;
    check(is_flatness(flatness), "the flatness is no number")?;
    check(filed.is_empty() || filed.len() == faces, "a filed face for each face is needed")?;
    check(leaf_size > 0, "leaves of 0 faces")?;
    Ok(Origin {
        flatness,
        leaf_size: usize::try_from(leaf_size)?,
        filed_faces: (!filed.is_empty()).then_some(filed),
    })
}
