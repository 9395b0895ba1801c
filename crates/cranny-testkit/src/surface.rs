//! How the surfaces of two posed meshes meet, pair by pair.

use cranny_exact::{Aabb, DVec3, Meeting, Pose, RigidMap, classify_triangles};
use cranny_geometry::Mesh;

use crate::triangle::rational_meeting;

/// The strongest meeting of any face of A with any face of B, by the product's own exact classifier
/// but over all pairs. B is posed into A's frame as the exact contract demands
/// ([`RigidMap::between`], [`RigidMap::apply`]): pass the meshes in their canonical order.
#[must_use]
pub fn brute_force_surface(mesh_a: &Mesh, pose_a: &Pose, mesh_b: &Mesh, pose_b: &Pose) -> Meeting {
    let a = posed_triangles(mesh_a, &RigidMap::IDENTITY);
    let b = posed_triangles(mesh_b, &RigidMap::between(pose_a, pose_b));
    strongest(&a, &b, classify_triangles)
}

/// The strongest meeting of any face of A with any face of B, in exact rationals on the world
/// vertices, each posed by [`Pose::world_from_body`] and rounded.
#[must_use]
pub fn rational_surface(mesh_a: &Mesh, pose_a: &Pose, mesh_b: &Mesh, pose_b: &Pose) -> Meeting {
    let a = posed_triangles(mesh_a, &pose_a.world_from_body());
    let b = posed_triangles(mesh_b, &pose_b.world_from_body());
    strongest(&a, &b, rational_meeting)
}

fn strongest(
    a: &[[DVec3; 3]],
    b: &[[DVec3; 3]],
    meeting: impl Fn(&[DVec3; 3], &[DVec3; 3]) -> Meeting,
) -> Meeting {
    let mut found = Meeting::None;
    for (i, j) in overlapping_pairs(a, b) {
        found = found.max(meeting(&a[i], &b[j]));
        if found == Meeting::Cross {
            break;
        }
    }
    found
}

/// The faces, every vertex posed by `map` and rounded.
pub(crate) fn posed_triangles(mesh: &Mesh, map: &RigidMap) -> Vec<[DVec3; 3]> {
    let vertices: Vec<DVec3> = mesh.vertices().iter().map(|&p| map.apply(p)).collect();
    mesh.faces().iter().map(|face| face.map(|i| vertices[i as usize])).collect()
}

/// The pairs whose closed boxes share a point; exact, since boxes of points do not round.
pub(crate) fn overlapping_pairs(a: &[[DVec3; 3]], b: &[[DVec3; 3]]) -> Vec<(usize, usize)> {
    let boxes =
        |ts: &[[DVec3; 3]]| -> Vec<Aabb> { ts.iter().map(|&t| Aabb::of_points(t)).collect() };
    let (boxes_a, boxes_b) = (boxes(a), boxes(b));
    let whole = |boxes: &[Aabb]| boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
    let (whole_a, whole_b) = (whole(&boxes_a), whole(&boxes_b));
    let mut near_a: Vec<usize> = (0..b.len()).filter(|&j| boxes_b[j].overlaps(&whole_a)).collect();
    near_a.sort_by(|&i, &j| boxes_b[i].min.x.total_cmp(&boxes_b[j].min.x));
    let mut pairs = Vec::new();
    for (i, one) in boxes_a.iter().enumerate().filter(|(_, one)| one.overlaps(&whole_b)) {
        let begun = near_a.partition_point(|&j| boxes_b[j].min.x <= one.max.x);
        let met = near_a[..begun].iter().filter(|&&j| boxes_b[j].overlaps(one));
        pairs.extend(met.map(|&j| (i, j)));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;
    use cranny_exact::DQuat;

    /// Triangles on a small lattice, so that posed by quarter turns they touch and cross exactly.
    fn soup(rng: &mut Rng) -> Mesh {
        let mut whole = || f64::from(rng.between(0, 4));
        let vertices = (0..6).map(|_| DVec3::new(whole(), whole(), whole())).collect();
        Mesh::new(vertices, vec![[0, 1, 2], [2, 3, 4], [4, 5, 0]]).unwrap()
    }

    #[test]
    fn both_oracles_agree_where_posing_is_exact() {
        let mut rng = Rng::new(5);
        let half = 0.5f64.sqrt();
        let turns = [
            DQuat::IDENTITY,
            DQuat::from_xyzw(half, 0.0, 0.0, half),
            DQuat::from_xyzw(0.0, -half, 0.0, half),
            DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
        ];
        let mut found = [0; 3];
        for _ in 0..2_000 {
            let (a, b) = (soup(&mut rng), soup(&mut rng));
            let mut pose = || {
                let rotation = turns[rng.below(4)];
                let mut step = || f64::from(rng.between(-2, 2));
                Pose { rotation, translation: DVec3::new(step(), step(), step()) }
            };
            let (pose_a, pose_b) = (pose(), pose());
            let meeting = rational_surface(&a, &pose_a, &b, &pose_b);
            assert_eq!(brute_force_surface(&a, &pose_a, &b, &pose_b), meeting);
            assert_eq!(rational_surface(&b, &pose_b, &a, &pose_a), meeting);
            found[meeting as usize] += 1;
        }
        assert!(found.iter().all(|&count| count >= 100), "{found:?}");
    }
}
