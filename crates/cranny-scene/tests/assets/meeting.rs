//! Whether two surfaces meet: every pair of triangles whose boxes overlap, decided exactly.

use cranny_exact::{Aabb, DVec3, Meeting, Pose, classify_triangles};
use cranny_geometry::Mesh;

type Placed<'a> = (&'a Mesh, &'a Pose);

fn posed((mesh, pose): Placed<'_>) -> Vec<([DVec3; 3], Aabb)> {
    let world = pose.world_from_body();
    let points: Vec<DVec3> = mesh.vertices().iter().map(|&p| world.apply(p)).collect();
    let triangle = |f: &[u32; 3]| {
        let corners = f.map(|i| points[i as usize]);
        (corners, Aabb::of_points(corners))
    };
    mesh.faces().iter().map(triangle).collect()
}

fn bounds(triangles: &[([DVec3; 3], Aabb)]) -> Option<Aabb> {
    triangles.iter().map(|(_, bounds)| *bounds).reduce(|a, b| a.union(&b))
}

pub(crate) fn surfaces_meet(a: Placed<'_>, b: Placed<'_>) -> bool {
    let (a, b) = (posed(a), posed(b));
    let (Some(box_a), Some(box_b)) = (bounds(&a), bounds(&b)) else { return false };
    // Only what reaches into the other's box can meet it.
    let near: Vec<_> = b.iter().filter(|(_, bounds)| bounds.overlaps(&box_a)).collect();
    let mut sorted: Vec<_> = a.iter().filter(|(_, bounds)| bounds.overlaps(&box_b)).collect();
    sorted.sort_by(|(_, p), (_, q)| p.min.z.total_cmp(&q.min.z));
    near.iter().any(|(t, bounds)| {
        let reach = sorted.partition_point(|(_, other)| other.min.z <= bounds.max.z);
        sorted[..reach]
            .iter()
            .any(|(s, other)| other.overlaps(bounds) && classify_triangles(s, t) != Meeting::None)
    })
}
