//! What an observer of estimates is shown is what they use: all faces, with bounds that hold, that
//! motion widens and opening narrows.

use cranny_concavity::walk::HullFeature;
use cranny_estimate::{Accuracy, Effort, EstimateMemory, EstimateObserver, KeptNodes, estimate};
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Content, FaceId, FaceTree, Model};
use cranny_narrow_phase::{Demand, Placed, Query, query};
use cranny_shapes::{Comb, Cuboid, Cup, Torus};
use cranny_testkit::{Rng, Walk, from_surface, shape, world_triangles};

/// All that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    cut: Vec<KeptNodes>,
    walk: Option<[HullFeature; 2]>,
}

impl EstimateObserver for Seen {
    fn cut(&mut self, kept: KeptNodes) {
        self.cut.push(kept);
    }

    fn walk(&mut self, features: [HullFeature; 2]) {
        self.walk = Some(features);
    }
}

fn seen(memory: &EstimateMemory, a: Placed, b: Placed) -> Seen {
    let mut seen = Seen::default();
    memory.observe(a, b, &mut seen).unwrap();
    seen
}

fn beneath(tree: &FaceTree, node: u32) -> Vec<FaceId> {
    match tree.content(node) {
        Content::Leaf { .. } => tree.leaf_faces(node).to_vec(),
        Content::Inner { left, right } => [beneath(tree, left), beneath(tree, right)].concat(),
    }
}

/// Every pair of faces lies beneath just one pair of nodes.
fn assert_covers(kept: &[KeptNodes], a: &Model, b: &Model, what: &str) {
    let [m, n] = [a, b].map(|model| model.mesh().faces().len());
    let mut times = vec![0u8; m * n];
    for pair in kept {
        for f in beneath(a.tree(), pair.nodes[0]) {
            for g in beneath(b.tree(), pair.nodes[1]) {
                times[f.index() * n + g.index()] += 1;
            }
        }
    }
    assert!(times.iter().all(|&times| times == 1), "{what}");
}

/// No corner beneath the one node is nearer to a face beneath the other than the pair's separation.
fn assert_holds(kept: &KeptNodes, a: Placed, b: Placed, what: &str) {
    let triangles = |placed: Placed, node| {
        let all = world_triangles(placed.model, &placed.pose);
        beneath(placed.model.tree(), node).iter().map(|f| all[f.index()]).collect::<Vec<_>>()
    };
    let (of_a, of_b) = (triangles(a, kept.nodes[0]), triangles(b, kept.nodes[1]));
    let one = of_a.iter().flatten().map(|p| from_surface(*p, &of_b));
    let other = of_b.iter().flatten().map(|p| from_surface(*p, &of_a));
    let room = one.chain(other).fold(f64::INFINITY, f64::min);
    assert!(kept.separation <= room, "{what}: {} of {room}", kept.separation);
}

fn exchanged(kept: &[KeptNodes]) -> Vec<KeptNodes> {
    let of = |kept: &KeptNodes| KeptNodes { nodes: [kept.nodes[1], kept.nodes[0]], ..*kept };
    kept.iter().map(of).collect()
}

fn bodies() -> [Model; 4] {
    [
        shape(Torus { major_segments: 9, minor_segments: 5, ..Torus::default() }),
        shape(Cup { segments: 7, ..Cup::default() }),
        shape(Comb { teeth: 3, ..Comb::default() }),
        shape(Cuboid::default()),
    ]
}

#[test]
fn the_cut_shown_bounds_the_distance_as_the_estimate_does() {
    let bodies = bodies();
    let mut rng = Rng::new(43);
    let mut bounds = 0;
    for round in 0..40 {
        let (a, b) = (&bodies[round % 4], &bodies[rng.below(4)]);
        let reach = a.radius() + b.radius();
        let mut walk = Walk::new(&mut rng, reach);
        let mut memory = EstimateMemory::default();
        for frame in 0..6 {
            walk.step(&mut rng, reach);
            let a = Placed { model: a, pose: Pose::IDENTITY };
            let b = Placed { model: b, pose: walk.pose };
            let question = Query::of(Demand::Distance { below: None });
            let effort = Effort::tests(20 + rng.below(100) as u64);
            let found = estimate(a, b, &question, &effort, &mut memory).unwrap();
            let now = seen(&memory, a, b);
            let what = format!("round {round}, frame {frame}");
            assert_covers(&now.cut, a.model, b.model, &what);
            for kept in now.cut.iter().step_by(5) {
                assert_holds(kept, a, b, &what);
            }
            let least = now.cut.iter().map(|kept| kept.separation).fold(f64::INFINITY, f64::min);
            if found.separation.hi > 0.0 {
                assert!(least.min(found.separation.hi) <= found.separation.lo, "{what}");
                // Nothing but the cut bounds the first estimate from below.
                if frame == 0 {
                    assert_eq!(least.min(found.separation.hi), found.separation.lo, "{what}");
                    bounds += 1;
                }
            }
            assert_eq!(seen(&memory, b, a).cut, exchanged(&now.cut), "{what}");
        }
    }
    assert!(bounds > 10, "{bounds}");
}

#[test]
fn what_stems_from_elsewhere_is_not_shown() {
    let [torus, cup, ..] = bodies();
    let a = Placed { model: &torus, pose: Pose::IDENTITY };
    let at = |x: f64| Placed { model: &cup, pose: Pose::at(DVec3::new(0.7 + x, 0.1, 0.2)) };
    let mut memory = EstimateMemory::default();
    let nothing = Seen::default();
    assert_eq!(seen(&memory, a, at(0.0)), nothing);
    let question = Query::of(Demand::Regions { margin: 0.0 });
    for x in [1e-4, 2e-4, 3e-4] {
        query(a, at(x), &question, memory.queries()).unwrap();
    }
    assert_eq!(seen(&memory, a, at(3e-4)), nothing);
    let effort = Effort::of(Accuracy::Hulls);
    estimate(a, at(3e-4), &question, &effort, &mut memory).unwrap();
    let here = seen(&memory, a, at(3e-4));
    assert!(!here.cut.is_empty() && here.walk.is_some(), "{here:?}");
    assert_eq!(seen(&memory, a, at(2e-4)), nothing);
    // Another body at the same place.
    let other = shape(Cuboid::default());
    let other = Placed { model: &other, pose: at(3e-4).pose };
    assert_eq!(seen(&memory, a, other), nothing);
    let nowhere = Placed { model: &cup, pose: Pose::at(DVec3::splat(f64::NAN)) };
    assert!(memory.observe(a, nowhere, &mut Seen::default()).is_err());
}
