use super::*;
use crate::model::{BuildOptions, Model};
use cranny_testkit::Rng;
use glam::DQuat;

use crate::ids::{EdgeId, VertexId};

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

/// Whether an edge is bent outwards, or has not two faces: by how high the far corner of one face
/// lies above the other. `None` if by too little to say.
fn is_bent_outwards(model: &Model, edge: EdgeId) -> Option<bool> {
    let mesh = model.mesh();
    let [h, g] = model.topology().half_edges(edge) else { return Some(true) };
    let far = mesh.triangle(g.face())[(g.corner() + 2) % 3];
    let (ends, normal) = (mesh.triangle(h.face()), mesh.area_vector(h.face()).normalize());
    let [from, to] = [ends[h.corner()], ends[(h.corner() + 1) % 3]];
    let aside = (far - from).cross((to - from).normalize()).length();
    let sine = normal.dot(far - from) / aside;
    (sine.abs() < 1e-12 || sine.abs() > 1e-5).then_some(sine < -1e-5)
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
        if let Some(is_bent) = is_bent_outwards(model, EdgeId(i as u32)) {
            assert_eq!(n == 1, is_bent);
        }
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

/// The same mesh, turned and scaled, as a file in single precision has it.
fn in_a_file(mesh: &Mesh, rng: &mut Rng) -> Mesh {
    let turn = DQuat::from_scaled_axis(3.0 * rng.direction());
    let scale = 1.5 + 0.5 * rng.unit();
    let single = |p: &DVec3| (scale * (turn * *p)).as_vec3().as_dvec3();
    Mesh::new(mesh.vertices().iter().map(single).collect(), mesh.faces().to_vec()).unwrap()
}

/// The same mesh with its faces in another order.
fn shuffled(mesh: &Mesh, rng: &mut Rng) -> Mesh {
    let mut faces = mesh.faces().to_vec();
    rng.shuffle(&mut faces);
    Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

fn clusters_of(mesh: Mesh) -> usize {
    model(mesh).clusters().clusters().len()
}

#[test]
fn a_plane_falls_into_full_and_flat_clusters() {
    let mut rng = Rng::new(7);
    // 512 faces make 64 clusters of eight, if all fit together.
    let plane = grid(16, |_, _| 0.0);
    let tree = model(plane.clone());
    for cluster in tree.clusters().clusters() {
        let thin = cluster.bounds.half.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(thin <= ROUNDING);
    }
    // Sheared, so that all sides are of one length: equal triangles, which spread evenly.
    let sheared = |p: &DVec3| DVec3::new(p.x + 0.5 * p.y, 0.75f64.sqrt() * p.y, 0.0);
    let lattice = plane.vertices().iter().map(sheared).collect();
    let lattice = Mesh::new(lattice, plane.faces().to_vec()).unwrap();
    for mesh in [&plane, &lattice] {
        assert_eq!(clusters_of(mesh.clone()), 69);
        for _ in 0..10 {
            assert_eq!(clusters_of(in_a_file(mesh, &mut rng)), 69);
        }
    }
    // Of joins of one cost the numbers of faces decide: in another order, fewer fit together.
    for _ in 0..5 {
        let count = clusters_of(shuffled(&plane, &mut rng));
        assert!(count <= 76, "{count}");
    }
}

#[test]
fn a_curved_surface_falls_into_clusters() {
    let bowl = grid(24, |x, y| 0.5 * (x * x + y * y));
    let count = clusters_of(bowl);
    // 1,152 faces: seven a cluster.
    assert!(count <= 164, "{count}");
}

/// Triangles along one line have boxes without area: they go together all the same.
#[test]
fn faces_without_area_fill_clusters() {
    let vertices = (0..50).map(|i| DVec3::X * f64::from(i)).collect();
    let faces = (0..48).map(|i| [i, i + 1, i + 2]).collect();
    let mesh = Mesh::new(vertices, faces).unwrap();
    let topology = Topology::of(&mesh);
    let tree = ClusterTree::of(&mesh, &topology, &Patches::of(&mesh, &topology));
    assert_eq!(tree.clusters().len(), 6);
}

/// A spindle with two tips of so many edges each.
fn spindle(count: u32) -> Mesh {
    let ring = (0..count).map(|i| f64::from(i) * std::f64::consts::TAU / f64::from(count));
    let ring = ring.map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.0));
    let vertices = [2.0 * DVec3::Z, -2.0 * DVec3::Z].into_iter().chain(ring).collect();
    let sides = (0..count).map(|i| [2 + i, 2 + (i + 1) % count]);
    Mesh::new(vertices, sides.flat_map(|[a, b]| [[0, a, b], [1, b, a]]).collect()).unwrap()
}

/// Each pair of the edges of a vertex is compared with all, so of those of many edges nothing is
/// known: they may be tips, and press any way.
#[test]
fn tips_of_many_edges_are_not_known() {
    let most = features::MOST_EDGES as u32;
    for (count, is_known) in [(most, true), (most + 1, false), (20_000, false)] {
        let model = model(spindle(count));
        check(&model);
        let tree = model.clusters();
        for cluster in tree.clusters() {
            for block in tree.corners(cluster) {
                let Some(lane) = block.ids.iter().position(|v| v.0 == 0) else { continue };
                assert!(block.tips >> lane & 1 != 0);
                assert_eq!(cluster.wrenches == WrenchBox::WHOLE, !is_known);
            }
        }
        if is_known {
            assert!(check_wrenches(&model, &mut Rng::new(1)).0 > 0);
        }
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
        let [of_plain, of_scaled] = [&plain, &scaled].map(Model::clusters);
        assert_eq!(of_scaled.unit(), scale * of_plain.unit());
        assert_eq!(of_plain.nodes().len(), of_scaled.nodes().len());
        assert_eq!(of_plain.clusters().len(), of_scaled.clusters().len());
        for (a, b) in of_plain.nodes().iter().zip(of_scaled.nodes()) {
            assert_eq!((a.center, a.axes, a.half), (b.center, b.axes, b.half));
        }
        for (a, b) in of_plain.clusters().iter().zip(of_scaled.clusters()) {
            assert_eq!(a.faces.ids, b.faces.ids);
            assert_eq!((a.bounds, a.center * scale), (b.bounds, b.center));
        }
    }
}

/// Whether a box holds the wrench of a normal at a place of the tree's coordinates.
fn presses(bounds: &WrenchBox, p: DVec3, n: DVec3) -> bool {
    let wrench = n.to_array().into_iter().chain(p.cross(n).to_array());
    wrench
        .zip(bounds.least.iter().zip(&bounds.most))
        .all(|(x, (least, most))| x >= f64::from(*least) && x <= f64::from(*most))
}

/// Every normal that a contact of a cluster can have is held by its box, and by those above it.
/// Returns how many were not of faces, and how many clusters know nothing.
fn check_wrenches(model: &Model, rng: &mut Rng) -> (usize, usize) {
    let (mesh, topology, tree) = (model.mesh(), model.topology(), model.clusters());
    let place = |v: VertexId| (mesh.position(v) - tree.origin()) / tree.unit();
    let (mut others, mut whole) = (0, 0);
    let mut stack = vec![(Child::ROOT, Vec::new())];
    while let Some((child, above)) = stack.pop() {
        if !child.is_cluster() {
            let node = &tree.nodes()[child.index()];
            for lane in 0..node.count as usize {
                let mut above: Vec<WrenchBox> = above.clone();
                above.push(node.wrenches.get(lane));
                stack.push((node.children[lane], above));
            }
            continue;
        }
        let cluster = &tree.clusters()[child.index()];
        whole += usize::from(cluster.wrenches == WrenchBox::WHOLE);
        let all = |p, n| above.iter().chain([&cluster.wrenches]).all(|b| presses(b, p, n));
        let normal = |face: FaceId| mesh.area_vector(face).normalize_or_zero();
        for face in &cluster.faces.ids[..cluster.faces.count as usize] {
            let [a, b, c] = mesh.corners(*face).map(place);
            let (s, t) = (rng.unit().abs(), rng.unit().abs());
            let inside = a + s * ((b - a) + t * (c - b));
            assert!([a, b, c, inside].iter().all(|&p| all(p, normal(*face))));
        }
        for block in tree.ridges(cluster) {
            for edge in &block.ids[..block.count as usize] {
                let [h, g] = topology.half_edges(*edge) else { continue };
                let ends = topology.edges()[edge.index()];
                let (p, q) = (place(ends.from), place(ends.to));
                for _ in 0..4 {
                    let [s, t] = [0, 1].map(|_| rng.unit().abs());
                    let between = (1.0 - s) * normal(h.face()) + s * normal(g.face());
                    assert!(all(p + t * (q - p), between.normalize_or_zero()));
                    others += 1;
                }
            }
        }
        for block in tree.corners(cluster) {
            for vertex in &block.ids[..block.count as usize] {
                let around = topology.faces_at(*vertex);
                let p = place(*vertex);
                for _ in 0..60 {
                    // Near the faces' normals, where there may be few.
                    let mean: DVec3 = around.iter().map(|&face| normal(face)).sum();
                    let n = (mean.normalize_or_zero() + rng.direction()).normalize_or_zero();
                    let ends = around.iter().flat_map(|&face| mesh.corners(face).map(place));
                    if ends.into_iter().all(|q| (q - p).dot(n) <= 0.0) {
                        assert!(all(p, n), "{vertex:?} along {n}");
                        others += 1;
                    }
                }
            }
        }
    }
    (others, whole)
}

#[test]
fn every_contact_presses_within_its_wrenches() {
    let mut rng = Rng::new(8);
    let (mut others, mut whole, mut all) = (0, 0, 0);
    let mut bodies = vec![model(grid(5, |_, _| 0.0)), model(grid(5, |x, y| x * x - y * y))];
    for _ in 0..20 {
        bodies.push(model(grid(6, |_, _| 0.2 * rng.unit())));
        bodies.push(model(grid(3, |_, _| 2.0 * rng.unit())));
    }
    for body in &bodies {
        let (of_body, whole_of_body) = check_wrenches(body, &mut rng);
        others += of_body;
        whole += whole_of_body;
        all += body.clusters().clusters().len();
    }
    assert!(others > 5_000, "{others}");
    // Those at the border, where an edge has no second face.
    assert!(whole * 10 < all * 9, "{whole} of {all} clusters know nothing");
}

/// A cube, whole or with a face turned: what touches an edge where faces contradict each
/// other is not between their normals.
#[test]
fn faces_that_contradict_each_other_bound_nothing() {
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let corners = (0..8u32).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from));
    let corners: Vec<DVec3> = corners.map(DVec3::from_array).collect();
    for is_bounded in [true, false] {
        let mut faces: Vec<[u32; 3]> =
            sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        if !is_bounded {
            faces[0].swap(0, 1);
        }
        let mesh = Mesh::new(corners.clone(), faces).unwrap();
        let topology = Topology::of(&mesh);
        let patches = Patches::of(&mesh, &topology);
        let tree = ClusterTree::of(&mesh, &topology, &patches);
        let contradict = |edge: EdgeId| {
            let [h, g] = topology.half_edges(edge) else { panic!("an edge of two faces") };
            let [h, g] = [h, g].map(|h| mesh.corners(h.face())[h.corner()]);
            h == g
        };
        let mut seen = 0;
        for cluster in tree.clusters() {
            let blocks = tree.ridges(cluster).iter();
            let mut edges = blocks.flat_map(|b| b.ids[..b.count as usize].iter().copied());
            let contradicts = edges.any(contradict);
            seen += u32::from(contradicts);
            assert_eq!(cluster.wrenches == WrenchBox::WHOLE, contradicts);
        }
        assert_eq!(seen == 0, is_bounded);
    }
}

/// Half the surface of a box, corner by corner.
fn surface_along(points: &[DVec3], frame: &oriented::Frame) -> f64 {
    let along = |axis: &DVec3| points.iter().map(|p| axis.dot(*p)).collect::<Vec<f64>>();
    let [x, y, z] = frame.each_ref().map(|axis| {
        let at = along(axis);
        at.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - at.iter().copied().fold(f64::INFINITY, f64::min)
    });
    x * y + y * z + z * x
}

#[test]
fn sets_spread_together_as_their_points_do() {
    let mut rng = Rng::new(5);
    for round in 0..200 {
        // Far from the origin, as a cluster of a large mesh is.
        let far = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let small = if round % 2 == 0 { 1.0 } else { 1e-6 };
        let size = small * DVec3::new(1.0, rng.unit(), rng.unit());
        let mut point = || far + size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let points: Vec<DVec3> = (0..17).map(|_| point()).collect();
        let of = |points: &[DVec3]| oriented::Spread::of(points.iter().copied());
        let whole = of(&points);
        let parts = points.chunks(1 + round % 7);
        let together = parts.fold(oriented::Spread::default(), |sum, part| sum.with(&of(part)));
        let normal = DVec3::new(rng.unit(), rng.unit(), rng.unit() + 0.1).normalize();
        let [own, its] = [&whole, &together].map(|s| oriented::frame_along(s, normal));
        for (x, y) in own.iter().zip(&its) {
            assert!((*x - *y).length() < 1e-5, "{x} {y}");
        }
        // No direction across the normal has more of the points' spread.
        let mean = points.iter().sum::<DVec3>() / points.len() as f64;
        let along = |d: DVec3| points.iter().map(|p| (*p - mean).dot(d).powi(2)).sum::<f64>();
        for i in 0..64 {
            let angle = std::f64::consts::TAU * f64::from(i) / 64.0;
            let other = own[0] * angle.cos() + own[1] * angle.sin();
            assert!(along(other) <= along(own[0]) * (1.0 + 1e-9), "{angle}");
        }
        let twos: Vec<_> =
            points.chunks(2).map(|two| PointPair::of([two[0], two[two.len() - 1]])).collect();
        assert_eq!(oriented::half_area_along(twos.iter(), &own), surface_along(&points, &own));
    }
}
