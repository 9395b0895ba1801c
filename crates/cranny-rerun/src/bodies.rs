//! Bodies: a mesh each, and where it is in each frame.

use std::collections::BTreeMap;

use cranny_exact::Pose;
use cranny_record::{DrawnBody, PosesByName};
use re_sdk::EntityPath;

use crate::archetypes::{Clear, Mesh3D, Transform3D};
use crate::colors;
use crate::error::RerunError;
use crate::shading::ShadedMesh;
use crate::source::Source;
use crate::stream::{Stream, path};

/// The group of bodies.
pub(crate) const GROUP: &str = "bodies";

/// What became of a body at a log time: it has this look from then on, or none.
type Change<'a> = (u64, Option<&'a DrawnBody>);

/// Writes all bodies and their transforms.
pub(crate) fn tell(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    let poses = poses_by_body(&source.transforms);
    for (name, poses) in &poses {
        tell_poses(stream, &path(&[GROUP], name), poses)?;
    }
    for (name, changes) in changes_by_body(source) {
        let path = path(&[GROUP], name);
        match changes[..] {
            // What is static cannot come late or leave.
            [(time, Some(body))] if source.is_before_frames(time) => {
                stream.once(&path, &mesh(body))?;
            }
            _ => {
                let poses = poses.get(name).map_or(&[][..], Vec::as_slice);
                tell_changes(stream, &path, &changes, poses)?;
            }
        }
    }
    Ok(())
}

fn poses_by_body(transforms: &[(u64, PosesByName)]) -> BTreeMap<&str, Vec<(u64, Pose)>> {
    let mut poses: BTreeMap<&str, Vec<_>> = BTreeMap::new();
    for (time, frame) in transforms {
        for (name, pose) in frame {
            poses.entry(name).or_default().push((*time, *pose));
        }
    }
    poses
}

/// Of several changes at one time, the last one holds.
fn changes_by_body(source: &Source) -> BTreeMap<&str, Vec<Change<'_>>> {
    let mut all: BTreeMap<&str, Vec<Change<'_>>> = BTreeMap::new();
    for (time, changes) in &source.bodies {
        let left = changes.left.iter().map(|name| (name.as_str(), None));
        let came = changes.came.iter().map(|body| (body.name.as_str(), Some(body)));
        for (name, body) in left.chain(came) {
            let changes = all.entry(name).or_default();
            changes.pop_if(|before| before.0 == *time);
            changes.push((*time, body));
        }
    }
    all
}

fn tell_poses(stream: &Stream, path: &EntityPath, poses: &[(u64, Pose)]) -> Result<(), RerunError> {
    stream.rows(path, poses, |rows| {
        let translations = rows.iter().map(|(_, pose)| pose.translation.as_vec3().to_array());
        let rotations = rows.iter().map(|(_, pose)| pose.rotation.as_quat().to_array());
        let transforms = Transform3D::update_fields()
            .with_many_translation(translations)
            .with_many_quaternion(rotations);
        Ok(transforms.columns_of_unit_batches()?.collect())
    })
}

fn tell_changes(
    stream: &Stream,
    path: &EntityPath,
    changes: &[Change<'_>],
    poses: &[(u64, Pose)],
) -> Result<(), RerunError> {
    for &(time, body) in changes {
        // Until its first pose it would stand at the origin.
        let placed = poses.iter().map(|(at, _)| *at).find(|at| *at >= time);
        match body {
            Some(body) => stream.at(placed.unwrap_or(time), path, &mesh(body)),
            None => stream.at(time, path, &Clear::flat()),
        }?;
    }
    Ok(())
}

fn mesh(body: &DrawnBody) -> Mesh3D {
    let ShadedMesh { positions, normals, triangles } = ShadedMesh::of(&body.mesh);
    Mesh3D::new(positions)
        .with_vertex_normals(normals)
        .with_triangle_indices(triangles)
        .with_albedo_factor(colors::bytes(body.color))
}
