//! Solids of many kinds, moved about at random, against models built anew: a driver for long runs,
//! of which a little runs always.
//!
//! `CRANNY_SEEDS=1000..5000` takes other seeds; with `CRANNY_COINCIDE=1` vertices also land on
//! corners of the hull.

use std::ops::Range;

use crate::body::Body;
use cranny_exact::DVec3;
use cranny_geometry::{DeformError, Mesh, VertexId};
use cranny_shapes::{
    ChainLink, Comb, Cuboid, Cup, Gear, GolfBall, IsoNut, NestedShells, PyramidInCavity, Shape,
    Sphere, Torus, UPrism,
};
use cranny_testkit::Rng;

use crate::equal::{assert_equals_rebuild, assert_tells_changes, options};
use crate::meshes::turned;

/// Seeds that always run: a second's worth.
const SEEDS: Range<u64> = 0..60;

/// And some that alone showed a fault: a cap with a corner that had moved was reported as it was,
/// where no face of the concavity had moved.
const TELLING: [u64; 2] = [487, 883];

/// Deformations of each solid.
const STEPS: usize = 6;

/// A solid of any kind, of a few hundred faces.
fn solid(kind: usize, rng: &mut Rng) -> Mesh {
    let mut some = |least: u32, most: u32| least + rng.below((most - least) as usize) as u32;
    let shape: Shape = match kind {
        0 => GolfBall {
            triangles: 1_000,
            dimples: some(2, 22),
            dimple_depth: 0.05,
            ..GolfBall::default()
        }
        .into(),
        1 => Torus { major_segments: some(6, 20), minor_segments: some(3, 11), ..Torus::default() }
            .into(),
        2 => IsoNut { segments: 12, flank_segments: 1, height: Some(6.0), ..IsoNut::default() }
            .into(),
        3 => Cup { segments: some(4, 18), ..Cup::default() }.into(),
        4 => Gear { bore: 0.0, teeth: some(4, 12), flank_segments: 1, ..Gear::default() }.into(),
        5 => NestedShells { segments: some(5, 17), ..NestedShells::default() }.into(),
        6 => Comb::default().into(),
        7 => PyramidInCavity::default().into(),
        8 => Sphere { radius: 1.0, segments: some(6, 18), rings: some(4, 10) }.into(),
        9 => UPrism::default().into(),
        10 => ChainLink::default().into(),
        _ => Cuboid { size: [2.0, 1.0, 3.0] }.into(),
    };
    shape.build().unwrap()
}

const KINDS: usize = 12;

/// Where a vertex goes: nowhere much, in, out, into a plane of the hull or of the box, onto a
/// lattice, into a face.
fn place(model: &Body, v: VertexId, coincides: bool, rng: &mut Rng) -> DVec3 {
    let (mesh, hull) = (model.mesh(), model.hull());
    let (p, bounds) = (mesh.position(v), model.bounds());
    let size = bounds.diagonal();
    let outward = (p - bounds.center()).normalize_or(DVec3::X);
    let aside = 0.5 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
    let mut of_hull = || match hull.triangle_count() {
        0 => [p; 3],
        count => hull.triangle(rng.below(count)).map(|c| hull.position(c)),
    };
    let ([a, b, c], kind) = (of_hull(), rng.below(if coincides { 13 } else { 12 }));
    match kind {
        0..5 => p + [1e-12, 1e-9, 1e-6, 1e-3, 0.05][kind] * size * aside,
        5 => p - 0.03 * size * outward,
        6 => p + 0.03 * size * outward,
        7 => 0.5 * (a + b),
        8 => 0.25 * (a + b) + 0.5 * c,
        9 => (p * 8.0 / size).round() / 8.0 * size,
        10 => {
            let axis = rng.below(3);
            let mut p = p;
            p[axis] = [bounds.min, bounds.max][rng.below(2)][axis];
            p
        }
        11 => model.topology().faces_at(v).first().map_or(p, |&f| {
            let [a, b, c] = mesh.triangle(f);
            (a + b + c) / 3.0
        }),
        _ => a,
    }
}

/// Moves of up to twenty vertices: neighbours, corners of the hull, or any; home again at times.
fn moves(model: &Body, home: &Mesh, coincides: bool, rng: &mut Rng) -> Vec<(VertexId, DVec3)> {
    let most = if rng.below(3) == 0 { 20 } else { 3 };
    let (is_local, is_on_hull, goes_home) =
        (rng.below(2) == 0, rng.below(2) == 0, rng.below(4) == 0);
    let any = |rng: &mut Rng| VertexId(rng.below(model.mesh().vertices().len()) as u32);
    let mut v = any(rng);
    let mut all: Vec<(VertexId, DVec3)> = Vec::new();
    for _ in 0..1 + rng.below(most) {
        let (faces, corners) = (model.topology().faces_at(v), model.hull().sources());
        v = match () {
            () if is_local && !faces.is_empty() => {
                model.mesh().corners(faces[rng.below(faces.len())])[rng.below(3)]
            }
            () if is_on_hull && !corners.is_empty() => corners[rng.below(corners.len())],
            () => any(rng),
        };
        let to = if goes_home { home.position(v) } else { place(model, v, coincides, rng) };
        if all.iter().all(|m| m.0 != v) {
            all.push((v, to));
        }
    }
    all
}

/// The seeds given; those above if there are none.
fn seeds() -> Vec<u64> {
    let Ok(text) = std::env::var("CRANNY_SEEDS") else { return SEEDS.chain(TELLING).collect() };
    let ends = text.split_once("..").and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
    let ends = ends.map(|ends: Range<u64>| ends.collect());
    ends.unwrap_or_else(|| panic!("CRANNY_SEEDS is '{text}', and should be as 1000..5000"))
}

#[test]
fn solids_of_many_kinds_follow_any_moves() {
    let coincides = std::env::var("CRANNY_COINCIDE").is_ok_and(|text| text == "1");
    let (mut followed, mut anew) = (0, 0);
    for seed in seeds() {
        let mut rng = Rng::new(seed);
        let mesh = solid(seed as usize % KINDS, &mut rng);
        let mesh = if rng.below(2) == 0 { turned(&mesh) } else { mesh };
        let (mut model, _) = Body::build(mesh, &options()).unwrap();
        let home = model.mesh().clone();
        for step in 0..STEPS {
            if rng.below(12) == 0 {
                model = Body::decode(&model.encode()).unwrap();
            }
            let moves = moves(&model, &home, coincides, &mut rng);
            let before = model.clone();
            let what = format!("seed {seed}, step {step}");
            let change = match model.deform(&moves) {
                Err(DeformError::InsideOut { .. } | DeformError::OnlyDegenerateFaces { .. }) => {
                    assert_eq!(before.digest(), model.digest(), "{what}");
                    continue;
                }
                change => change.unwrap_or_else(|e| panic!("{what}: {e}")),
            };
            *(if change.work.is_anew { &mut anew } else { &mut followed }) += 1;
            assert_equals_rebuild(&model, &what);
            assert_tells_changes(&before, &model, &change, &what);
        }
    }
    assert!(followed > 0 && anew > 0, "{followed}, {anew}");
}
