//! Sides rough by about as little as rounding: volumes and areas are right to within slabs.

use crate::body::Body;
use cranny_exact::DVec3;
use cranny_geometry::{Finding, FindingKind, Mesh};
use cranny_testkit::Rng;

use super::bodies;
use super::check::{checked_told, closed_checked};
use super::noisy::{Written, noisy_cube};
use super::ways::{rounded_to_decimals, rounded_to_single, turned};

/// A rough cube of a kind that a seed decides, up to so many flatnesses; and the flatnesses.
fn rough_cube(seed: u64) -> (Mesh, f64) {
    let mut rng = Rng::new(seed);
    let cells = 2 + rng.below(4) as i32;
    let rough = [1.5, 2.0, 3.0, 4.0, 6.0, 8.0][rng.below(6)];
    let written = Written::ALL[rng.below(3)];
    let is_turned = rng.below(2) == 1;
    (noisy_cube(cells, rough, written, is_turned, &mut rng), rough)
}

/// The area of the strip, as wide as slabs are deep, along every edge.
fn strip(model: &Body) -> f64 {
    let at = |v: cranny_geometry::VertexId| model.mesh().position(v);
    let edges = model.topology().edges().iter();
    model.features().slab_depth() * edges.map(|e| at(e.from).distance(at(e.to))).sum::<f64>()
}

fn told_twice(findings: &[Finding]) -> f64 {
    let found = findings.iter().filter(|f| f.kind == FindingKind::NegativeCap);
    found.map(|f| f.measure).sum()
}

#[test]
fn caps_do_not_cut_corners_off_where_slivers_join_two_sides() {
    // Each of them had a cap from one side of the cube to the next.
    for seed in [79, 422, 2553, 2906, 4433, 8420, 8899, 9367, 9818, 18_025] {
        let (model, findings) = checked_told(&rough_cube(seed).0);
        assert!(told_twice(&findings) <= strip(&model), "seed {seed}: {findings:?}");
    }
}

#[test]
fn a_side_as_rough_as_slabs_are_deep_is_covered_once_but_for_strips() {
    for seed in 0..400 {
        let (mesh, rough) = rough_cube(seed);
        let (model, findings) = checked_told(&mesh);
        if rough <= 2.0 {
            assert!(told_twice(&findings) <= strip(&model), "seed {seed}: {findings:?}");
        }
    }
}

/// A square plate with wells of unit cells, 4 deep at the most.
fn plate_with_wells(wells: &[Vec<i32>]) -> Mesh {
    let size = wells.len() as i32;
    bodies::of_cells([size, size, 5], |[x, y, z]| z < 5 - wells[x as usize][y as usize])
}

fn as_files_keep_it(mesh: &Mesh) -> [Mesh; 4] {
    let turned = turned(mesh);
    let [single, decimals] = [rounded_to_single(&turned), rounded_to_decimals(&turned, 5)];
    [mesh.clone(), turned, single, decimals]
}

#[test]
fn wells_hold_what_their_cells_count() {
    let mut rng = Rng::new(31);
    for round in 0..24 {
        let mut wells = vec![vec![0; 9]; 9];
        for x in (1..9).step_by(2) {
            for y in (1..9).step_by(2) {
                wells[x][y] = rng.between(0, 4);
            }
        }
        let mut counted: Vec<f64> =
            wells.iter().flatten().filter(|&&d| d > 0).map(|&d| f64::from(d)).collect();
        counted.sort_unstable_by(f64::total_cmp);
        for mesh in as_files_keep_it(&plate_with_wells(&wells)) {
            let model = closed_checked(&mesh);
            let all = model.concavities();
            let mut measured: Vec<f64> = all.iter().map(|c| c.measures.pocket_volume).collect();
            measured.sort_unstable_by(f64::total_cmp);
            assert_eq!(measured.len(), counted.len(), "round {round}");
            let error = model.features().slab_depth() * model.hull().area();
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= error;
            assert!(measured.iter().zip(&counted).all(near), "round {round}: {measured:?}");
        }
    }
}

#[test]
fn wells_that_run_together_hold_what_their_cells_count() {
    let mut rng = Rng::new(32);
    for round in 0..24 {
        let mut wells = vec![vec![0; 7]; 7];
        let inner = wells.iter_mut().skip(1).take(5).flat_map(|row| row[1..6].iter_mut());
        inner.for_each(|depth| *depth = rng.between(-2, 4).max(0));
        let counted: f64 = wells.iter().flatten().map(|&d| f64::from(d)).sum();
        for mesh in as_files_keep_it(&plate_with_wells(&wells)) {
            let model = closed_checked(&mesh);
            let all = model.concavities();
            let measured: f64 = all.iter().map(|c| c.measures.pocket_volume).sum();
            let openings: DVec3 = all.iter().map(|c| c.measures.opening).sum();
            let open = wells.iter().flatten().filter(|&&d| d > 0).count() as f64;
            let error = model.features().slab_depth() * model.hull().area();
            assert!((measured - counted).abs() <= error, "round {round}: {measured}");
            assert!((openings.length() - open).abs() <= error, "round {round}: {openings}");
        }
    }
}

/// A closed solid in single precision, some of whose vertices lie within slabs of each other and of
/// three facets.
fn crumpled() -> Mesh {
    let vertices: [[f32; 3]; 9] = [
        [0.211_970_03, 0.110_793_53, -0.072_761_95],
        [1.177_389_4, -1.429_966_9, 1.252_578_5],
        [1.177_39, -1.429_966_7, 1.252_578_3],
        [0.734_217_2, -1.138_920_7, 0.404_703_38],
        [1.468_436_5, -2.277_841_6, 0.809_406_64],
        [1.468_435_8, -2.277_841_8, 0.809_406_9],
        [1.468_436_1, -2.277_841_6, 0.809_406_76],
        [0.582_092_46, -1.695_749_9, -0.886_343_06],
        [-0.304_250_45, -1.113_657_7, -2.582_093],
    ];
    #[rustfmt::skip]
    let faces = vec![
        [2, 3, 1], [3, 5, 1], [1, 5, 2], [5, 6, 2], [2, 6, 0], [6, 4, 0], [3, 2, 5], [5, 8, 6],
        [6, 8, 4], [8, 0, 4], [7, 8, 5], [5, 2, 7], [7, 2, 8], [0, 8, 2],
    ];
    let places = vertices.map(|p| DVec3::from_array(p.map(f64::from)));
    Mesh::new(places.to_vec(), faces).unwrap()
}

#[test]
fn pieces_with_the_opposites_of_several_facets_are_dropped_in_pairs() {
    // What one facet had too much of two others lacked: all three pieces were dropped, and hull,
    // faces and caps did not add up any more.
    let (model, _) = checked_told(&crumpled());
    let hull = model.hull();
    assert!(hull.volume() > model.features().slab_depth() * hull.area(), "it is thicker than skin");
}
