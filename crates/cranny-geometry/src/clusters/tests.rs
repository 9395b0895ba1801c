use super::*;
use crate::model::{BuildOptions, Model};
use cranny_testkit::Rng;

use crate::ids::VertexId;

fn grid(n: u32, mut lift: impl FnMut(f64, f64) -> f64) -> Mesh {
    let mut at = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        DVec3::new(x, y, lift(x, y))
    };
    let vertices = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| at(i, j));
    let name = |i: u32, j: u32| i * (n + 1) + j;
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(vertices.collect(), faces.collect()).unwrap()
}

fn model(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

/// Whether a box holds a point, with `spare` for single precision.
fn holds(bounds: &OrientedBox, p: DVec3, spare: f64) -> bool {
    let v = |a: [f32; 3]| DVec3::from_array(a.map(f64::from));
    let from = p - v(bounds.center);
    from.length() <= f64::from(bounds.radius) + spare
        && (0..3).all(|i| v(bounds.axes[i]).dot(from).abs() <= f64::from(bounds.half[i]) + spare)
}

/// Every face is in one cluster, below boxes that hold it; every vertex and ridge is looked at
/// once.
fn check(model: &Model) {
    let (mesh, topology, tree) = (model.mesh(), model.topology(), model.clusters());
    let place = |v: VertexId| (mesh.position(v) - tree.origin()) / tree.unit();
    let mut seen = vec![0; mesh.faces().len()];
    let (mut vertices, mut edges) =
        (vec![0; mesh.vertices().len()], vec![0; topology.edges().len()]);
    let mut met = vec![0; tree.clusters().len()];
    let mut stack = vec![(Child::ROOT, vec![*tree.root()])];
    while let Some((child, above)) = stack.pop() {
        if !child.is_cluster() {
            let node = &tree.nodes()[child.index()];
            for lane in 0..node.count as usize {
                let mut above = above.clone();
                above.push(node.boxed(lane));
                stack.push((node.children[lane], above));
            }
            continue;
        }
        let cluster = &tree.clusters()[child.index()];
        met[child.index()] += 1;
        let middle = (cluster.center - tree.origin()) / tree.unit();
        for lane in 0..cluster.faces.count as usize {
            let face = cluster.faces.ids[lane];
            seen[face.index()] += 1;
            for (i, v) in mesh.corners(face).into_iter().enumerate() {
                assert!(above.iter().all(|b| holds(b, place(v), 1e-12)));
                assert!(holds(&cluster.bounds, place(v) - middle, 1e-12));
                let stored = DVec3::from_array(cluster.faces.corners[i].get(lane).map(f64::from));
                let error = f64::from(ROUNDING * cluster.bounds.radius);
                assert!((stored - (place(v) - middle)).length() <= error);
            }
        }
        for block in tree.corners(cluster) {
            for lane in 0..block.count as usize {
                vertices[block.ids[lane].index()] += 1;
                assert!(holds(&cluster.bounds, place(block.ids[lane]) - middle, 1e-12));
            }
        }
        for block in tree.ridges(cluster) {
            block.ids[..block.count as usize].iter().for_each(|e| edges[e.index()] += 1);
        }
    }
    assert!(seen.iter().all(|&n| n == 1) && met.iter().all(|&n| n == 1));
    assert!(vertices.iter().all(|&n| n == 1));
    for (i, &n) in edges.iter().enumerate() {
        let around = topology.half_edges(crate::ids::EdgeId(i as u32));
        assert_eq!(n == 1, may_be_ridge(mesh, around));
    }
}

#[test]
fn every_face_is_below_boxes_that_hold_it() {
    let mut rng = Rng::new(3);
    for n in [1, 2, 5, 17] {
        check(&model(grid(n, |_, _| 0.0)));
        check(&model(grid(n, |x, y| 0.3 * (x * x - y * y))));
        check(&model(grid(n, |_, _| 0.2 * rng.unit())));
    }
}

#[test]
fn a_plane_falls_into_full_and_flat_clusters() {
    let model = model(grid(16, |_, _| 0.0));
    let tree = model.clusters();
    // 512 faces: nearly all clusters are full, and none has a thickness.
    assert!(tree.clusters().len() <= 80, "{}", tree.clusters().len());
    for cluster in tree.clusters() {
        let thin = cluster.bounds.half.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(thin <= ROUNDING);
    }
}

/// Scaling by a power of two changes no bit, however large or small the body.
#[test]
fn powers_of_two_change_nothing() {
    let plain = model(grid(6, |x, y| x * y));
    for exponent in [-100, 100] {
        let scale = 2f64.powi(exponent);
        let mesh = grid(6, |x, y| x * y);
        let vertices = mesh.vertices().iter().map(|p| *p * scale).collect();
        let scaled = model(Mesh::new(vertices, mesh.faces().to_vec()).unwrap());
        assert_eq!(scaled.clusters().unit(), scale * plain.clusters().unit());
        for (a, b) in plain.clusters().nodes().iter().zip(scaled.clusters().nodes()) {
            assert_eq!((a.center, a.axes, a.half), (b.center, b.axes, b.half));
        }
        for (a, b) in plain.clusters().clusters().iter().zip(scaled.clusters().clusters()) {
            assert_eq!((a.bounds, a.center * scale), (b.bounds, b.center));
        }
    }
}
