//! Model files: a prepared model as bytes, and back.
//!
//! A file is a head and sections. Head: [`MAGIC`], version, 0, length of the file, checksum. Section: four
//! letters, length of its body, body. Everything is little-endian, and the same model gives the same
//! bytes on every machine. What a section says stands beside the structure that it is of (`codec`).
//!
//! The checksum is the [BLAKE3] of what is before it, the model's digest, and what is behind it but for what
//! the digest is of. That is the first section, the mesh, behind the number of faces; so nothing is
//! hashed twice.
//!
//! [BLAKE3]: https://github.com/BLAKE3-team/BLAKE3-specs

use std::sync::Arc;

use cranny_exact::DVec3;
use thiserror::Error;

use super::{Model, Parts, radius};
use crate::codec::{Flaw, Plain, Reader, Writer, check, is_size};
use crate::concavity::Concavities;
use crate::envelope::Envelopes;
use crate::features::Features;
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::patches::Patches;
use crate::scan::faces::has_no_area;
use crate::topology::Topology;
use crate::tree::{FaceForest, FaceTree};

/// A model file begins with this: no text, and spoilt by whatever changes line ends.
const MAGIC: [u8; 8] = *b"\x89CRANNY\n";

/// Of the sections and what they hold; a file of any other version is refused.
const VERSION: u32 = 2;

/// What is before the checksum: magic, version, 0, length.
const BEFORE_CHECKSUM: usize = 8 + 4 + 4 + 8;

const HEAD: usize = BEFORE_CHECKSUM + 32;

/// What is before the part of the mesh that is hashed by itself: head, tag, length, number of faces.
const BEFORE_MESH: usize = HEAD + 4 + 8 + 8;

/// The sections: their tags, and how errors name them.
mod section {
    pub(super) type Section = ([u8; 4], &'static str);

    pub(super) const MESH: Section = (*b"MESH", "mesh");
    pub(super) const TOPOLOGY: Section = (*b"TOPO", "topology");
    pub(super) const HULL: Section = (*b"HULL", "hull");
    pub(super) const FEATURES: Section = (*b"FEAT", "features");
    pub(super) const CONCAVITIES: Section = (*b"CONC", "concavities");
    pub(super) const TREE: Section = (*b"TREE", "tree");
    pub(super) const CONCAVITY_TREES: Section = (*b"CTRE", "trees of concavities");
    pub(super) const ENVELOPES: Section = (*b"ENVE", "envelopes");
    pub(super) const PATCHES: Section = (*b"PTCH", "patches");
    pub(super) const ORIGIN: Section = (*b"ORIG", "origin");
}
use section::Section;

/// Bytes that are no model.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// They do not begin as a model does.
    #[error(
        "it is no saved model: it does not begin as one. Save one with `cranny inspect MESH --save MODEL`, or name a mesh file"
    )]
    NotAModel,
    /// They were written by another version of this crate.
    #[error(
        "it is a saved model of version {found}, and version {supported} is read here. Prepare the mesh again and save it, or use the Cranny that saved it"
    )]
    Version {
        /// Version found.
        found: u32,
        /// Version that is read.
        supported: u32,
    },
    /// There are fewer or more bytes than were written.
    #[error(
        "the saved model has {found} bytes where {stated} were written: it was cut off or added to. Copy it again"
    )]
    Length {
        /// Bytes there are.
        found: usize,
        /// Bytes there should be.
        stated: u64,
    },
    /// A byte is not what was written.
    #[error("the saved model is damaged: its checksum does not match. Copy or save it again")]
    Checksum,
    /// The checksum is right, yet a section cannot be part of a model: no such file was written by
    /// [`Model::encode`].
    #[error(
        "the saved model is not one that Cranny wrote: in its section of the {section}, {flaw}. Prepare the mesh again and save it"
    )]
    Section {
        /// The section.
        section: &'static str,
        /// What is wrong with it.
        flaw: String,
    },
}

impl Model {
    /// Whether some bytes begin as a saved model does.
    #[must_use]
    pub fn is_encoded(bytes: &[u8]) -> bool {
        bytes.starts_with(&MAGIC)
    }

    /// As bytes that [`decode`](Self::decode) turns into the same model. The same model always gives the
    /// same bytes, about 180 a face. Cost: linear.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let Parts {
            mesh,
            topology,
            hull,
            features,
            concavities,
            tree,
            concavity_trees,
            envelopes,
            patches,
            // Made again from the mesh.
            mass: _,
            radius: _,
            digest: _,
            filed_faces,
            flatness,
            leaf_size,
            // Made when it is needed.
            only_read: _,
            workshop: _,
        } = &*self.0;
        let mut out = Writer::default();
        out.one(MAGIC);
        out.one([VERSION, 0]);
        out.one(0u64);
        out.one([0u8; 32]);
        let mut section = |(tag, _): Section, body: &dyn Fn(&mut Writer)| out.section(tag, body);
        section(section::MESH, &|out| {
            out.one(mesh.faces().len() as u64);
            // `+ 0`: no zero has a sign, as in the digest.
            let vertices = mesh.vertices().iter().map(|&p| p + DVec3::ZERO);
            out.items(mesh.vertices().len(), vertices);
            mesh.faces().iter().for_each(|&face| out.one(face));
        });
        section(section::TOPOLOGY, &|out| topology.encode(out));
        section(section::HULL, &|out| hull.encode(out));
        section(section::FEATURES, &|out| features.encode(out));
        section(section::CONCAVITIES, &|out| concavities.encode(out));
        section(section::TREE, &|out| tree.encode(out));
        section(section::CONCAVITY_TREES, &|out| concavity_trees.encode(out));
        section(section::ENVELOPES, &|out| envelopes.encode(out));
        section(section::PATCHES, &|out| patches.encode(out));
        section(section::ORIGIN, &|out| {
            out.one(*flatness);
            out.one(*leaf_size as u64);
            // None at all where all are as filed; a mesh has at least one.
            out.list(filed_faces.as_deref().unwrap_or_default());
        });
        let mut bytes = out.into_bytes();
        let length = bytes.len() as u64;
        bytes[BEFORE_CHECKSUM - 8..BEFORE_CHECKSUM].copy_from_slice(&length.to_le_bytes());
        let (checksum, _) = checksum_and_digest(&bytes);
        bytes[BEFORE_CHECKSUM..HEAD].copy_from_slice(&checksum);
        bytes
    }

    /// From bytes that [`encode`](Self::encode) made.
    ///
    /// Bytes from anywhere may be given, with a right checksum or not: either they are refused, or the
    /// model can be read and queried like any other, and its answers are only as true as the bytes. Memory
    /// is bounded by a small multiple of their number. Cost: linear.
    ///
    /// [`deform`](Self::deform) builds on more than is proved here, and so believes nothing but the mesh:
    /// the first deformation of a loaded model prepares it again.
    ///
    /// # Errors
    ///
    /// [`DecodeError`], which says what is wrong and what to do.
    pub fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        let digest = check_head(bytes)?;
        let mut sections = Reader::new(&bytes[HEAD..]);
        let mesh = read(&mut sections, section::MESH, read_mesh)?;
        let topology = read(&mut sections, section::TOPOLOGY, |s| Topology::decode(s, &mesh))?;
        let hull = read(&mut sections, section::HULL, |s| ConvexHull::decode(s, &mesh))?;
        let features = read(&mut sections, section::FEATURES, |s| {
            Features::decode(s, &mesh, &topology, &hull)
        })?;
        let concavities = read(&mut sections, section::CONCAVITIES, |s| {
            Concavities::decode(s, &mesh, &hull, &features)
        })?;
        let tree = read(&mut sections, section::TREE, |s| FaceTree::decode(s, &mesh))?;
        let concavity_trees = read(&mut sections, section::CONCAVITY_TREES, |s| {
            let trees = FaceForest::decode(s, &mesh)?;
            check(trees.len() == concavities.len(), "a tree for each concavity is needed")?;
            let holds = |(tree, concavity): (usize, crate::concavity::Concavity)| {
                let faces = trees.faces(tree);
                faces.len() == concavity.faces.len()
                    && faces.iter().all(|&f| concavities.of_face(f) == Some(concavity.id()))
            };
            check((0..).zip(concavities.iter()).all(holds), "a tree is not over its concavity")?;
            Ok(trees)
        })?;
        let envelopes =
            read(&mut sections, section::ENVELOPES, |s| Envelopes::decode(s, &mesh, &concavities))?;
        let patches =
            read(&mut sections, section::PATCHES, |s| Patches::decode(s, &mesh, &topology))?;
        let (flatness, leaf_size, filed_faces) =
            read(&mut sections, section::ORIGIN, |s| read_origin(s, mesh.faces().len()))?;
        sections.end().map_err(|flaw| flawed(section::ORIGIN, flaw))?;
        let mass = topology.is_closed().then(|| MassProperties::of(&mesh));
        let radius = radius(&mesh);
        let parts = Parts {
            mesh,
            topology,
            hull,
            features,
            concavities,
            tree,
            concavity_trees,
            envelopes,
            patches,
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

/// Everything but the sections. Returns the digest of the mesh.
fn check_head(bytes: &[u8]) -> Result<[u8; 32], DecodeError> {
    if !Model::is_encoded(bytes) {
        return Err(DecodeError::NotAModel);
    }
    let cut_off = |_| DecodeError::Length { found: bytes.len(), stated: HEAD as u64 };
    let mut head = Reader::new(&bytes[MAGIC.len()..]);
    let [version, reserved]: [u32; 2] = head.one().map_err(cut_off)?;
    if version != VERSION || reserved != 0 {
        return Err(DecodeError::Version { found: version, supported: VERSION });
    }
    let stated: u64 = head.one().map_err(cut_off)?;
    let stored: [u8; 32] = head.one().map_err(cut_off)?;
    if stated != bytes.len() as u64 {
        return Err(DecodeError::Length { found: bytes.len(), stated });
    }
    let (checksum, digest) = checksum_and_digest(bytes);
    if checksum == stored { Ok(digest) } else { Err(DecodeError::Checksum) }
}

/// The checksum, which depends on all other bytes, and the digest. Where the first section is said to be longer than
/// the file, or too short for a mesh, there is nothing in it, and reading it will say so.
fn checksum_and_digest(bytes: &[u8]) -> ([u8; 32], [u8; 32]) {
    let length = bytes.get(HEAD + 4..HEAD + 12).map_or(0, u64::get);
    let end = usize::try_from(length).ok().and_then(|length| length.checked_add(HEAD + 12));
    let mesh = end.and_then(|end| bytes.get(BEFORE_MESH..end)).unwrap_or_default();
    let behind = if mesh.is_empty() { HEAD } else { BEFORE_MESH + mesh.len() };
    let digest = *blake3::hash(mesh).as_bytes();
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[..BEFORE_CHECKSUM]).update(&digest);
    hasher.update(&bytes[HEAD..behind.min(BEFORE_MESH)]).update(&bytes[behind..]);
    (*hasher.finalize().as_bytes(), digest)
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

fn read_mesh(input: &mut Reader) -> Result<Mesh, Flaw> {
    let count = input.one()?;
    let vertices: Vec<DVec3> = input.list()?;
    let is_digested = |x: f64| x != 0.0 || x.is_sign_positive();
    let coordinates = vertices.iter().flat_map(|p| p.to_array());
    check(coordinates.into_iter().all(is_digested), "a zero has a sign")?;
    let mesh = Mesh::new(vertices, input.items(count)?)?;
    let is_flat = |f| has_no_area(&mesh, FaceId(f));
    check(!(0..mesh.faces().len() as u32).all(is_flat), "no face has an area")?;
    Ok(mesh)
}

/// How the model was built: flatness, faces per leaf, filed faces.
fn read_origin(
    input: &mut Reader,
    faces: usize,
) -> Result<(f64, usize, Option<Vec<FaceId>>), Flaw> {
    let (flatness, leaf_size): (f64, u64) = (input.one()?, input.one()?);
    let filed: Vec<FaceId> = input.list()?;
    check(is_size(flatness), "the flatness is no number")?;
    check(leaf_size > 0, "leaves without faces are asked for")?;
    check(filed.is_empty() || filed.len() == faces, "a filed face for each face is needed")?;
    Ok((flatness, usize::try_from(leaf_size)?, (!filed.is_empty()).then_some(filed)))
}
