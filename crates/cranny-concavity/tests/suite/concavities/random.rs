//! Random bodies, hulls and soups keep the invariants.

use crate::body::Body;
use cranny_exact::DVec3;
use cranny_geometry::hull::HullKind;
use cranny_geometry::{BuildOptions, ConvexHull, Mesh};
use cranny_testkit::Rng;

use super::bodies;
use super::check::{checked, closed_checked};
use super::ways::{census, four_ways, rounded_to_decimals, rounded_to_single, turned};

#[test]
fn random_bodies_keep_the_invariants() {
    let mut rng = Rng::new(5);
    for _ in 0..60 {
        let body = bodies::random_blocks(&mut rng);
        closed_checked(&body);
        closed_checked(&turned(&body));
        closed_checked(&rounded_to_single(&turned(&body)));
    }
}

/// The hull of some points, as a mesh of its triangles.
fn hull_of(points: &[DVec3]) -> Option<Mesh> {
    let hull = ConvexHull::of_points(points);
    let corners = |t: usize| hull.triangle(t).map(|v| v.0);
    let faces = (0..hull.triangle_count()).map(corners).collect();
    (hull.kind() == HullKind::Volume).then(|| Mesh::new(hull.positions().to_vec(), faces).unwrap())
}

#[test]
fn hulls_of_lattice_points_are_convex_however_they_are_rounded() {
    let mut rng = Rng::new(8);
    for round in 0..120 {
        let reach = rng.between(1, 6);
        let mut point = || DVec3::from_array([0; 3].map(|_| f64::from(rng.between(-reach, reach))));
        let points: Vec<DVec3> = (0..40).map(|_| point()).collect();
        let Some(mesh) = hull_of(&points) else { continue };
        let turned = turned(&mesh);
        for mesh in
            four_ways(&mesh).into_iter().chain([rounded_to_decimals(&turned, 4 + round % 3)])
        {
            let model = closed_checked(&mesh);
            assert_eq!(model.features().convex_sets().len(), 1, "round {round}");
            assert_eq!(census(&model), [], "round {round}");
        }
    }
}

#[test]
fn soups_of_triangles_keep_the_invariants_up_to_their_edges() {
    let mut rng = Rng::new(6);
    for round in 0..400 {
        let (points, faces) = (3 + rng.below(12), 1 + rng.below(30));
        // Reach 0 in an axis gives flat soups, reach 1 and 2 many coplanar and coincident faces.
        let reach = [rng.between(0, 3), rng.between(1, 3), rng.between(1, 8)];
        let mut point = || DVec3::from_array(reach.map(|r| f64::from(rng.between(-r, r))));
        let vertices: Vec<DVec3> = (0..points).map(|_| point()).collect();
        let faces = (0..faces).map(|_| [0; 3].map(|_| rng.below(points) as u32)).collect();
        let soup = Mesh::new(vertices, faces).unwrap();
        if Body::build(soup.clone(), &BuildOptions::default()).is_ok() {
            checked(&soup);
            if round % 2 == 0 {
                checked(&turned(&soup));
            }
        }
    }
}
