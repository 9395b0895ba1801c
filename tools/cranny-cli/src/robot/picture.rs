//! The picture of `cranny robot --render`: links as they collide, and which of them meet.

use std::sync::Arc;

use cranny_exact::Pose;
use cranny_render::{Color, DrawList, DrawMesh, DrawMeshError, Ground, Instance, Label};
use cranny_scene::Robot;

/// Of links that meet nothing: neighbours differ.
const GREYS: [Color; 2] = [Color::rgb(186, 191, 198), Color::rgb(132, 150, 176)];

/// Of links that meet.
const MEETS: Color = Color::rgb(220, 40, 40);

/// Opacity of links that collide with nothing, which are drawn by their visual meshes.
const GLASS: u8 = 110;

/// The links at their poses, in colours that distinguish them.
pub(super) fn draw_list(
    robot: &Robot,
    poses: &[Pose],
    meeting: &[(usize, usize)],
) -> Result<DrawList, DrawMeshError> {
    let mut list = DrawList::new();
    for (index, (link, pose)) in robot.links.iter().zip(poses).enumerate() {
        let Some(mesh) = link.collision.as_ref().or(link.visual.as_ref()) else { continue };
        let meets = meeting.iter().any(|&(a, b)| [a, b].contains(&index));
        let color = if meets { MEETS } else { GREYS[index % GREYS.len()] };
        let color = if link.collision.is_some() { color } else { color.with_alpha(GLASS) };
        let mesh = Arc::new(DrawMesh::new(mesh.vertices(), mesh.faces())?);
        if meets {
            let middle = pose.world_from_body().apply(mesh.bounds().center());
            list.labels.push(Label::new(middle, link.name.clone()));
        }
        list.instances.push(Instance::solid(mesh, *pose, color));
    }
    list.ground = Some(Ground::under(&list.bounds()));
    Ok(list)
}
