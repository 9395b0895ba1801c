//! Solids that touch in coordinates that round: points inside their faces are no `f64`.

use cranny_exact::{DQuat, DVec3, Meeting, Pose, Sign, orient3d};
use cranny_geometry::Mesh;
use cranny_narrow_phase::Placed;
use cranny_testkit::{OracleVerdict, Rng};

use crate::solids::{cells, model, quarter_turns};
use crate::verdict::judged;

/// Both where they stand, so that no pose rounds anything more.
fn judged_here(a: &Mesh, b: &Mesh, what: &str) -> OracleVerdict {
    let (a, b) = (model(a.clone()), model(b.clone()));
    assert!(a.is_closed() && b.is_closed());
    let here = |model| Placed { model, pose: Pose::IDENTITY };
    judged(here(&a), here(&b), what)
}

fn anywhere(rng: &mut Rng) -> DVec3 {
    DVec3::new(rng.unit(), rng.unit(), rng.unit())
}

fn rotation(rng: &mut Rng) -> DQuat {
    loop {
        let q = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit());
        if (0.1..=1.0).contains(&q.length_squared()) {
            return q.normalize();
        }
    }
}

fn turned(mesh: &Mesh, rotation: DQuat) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&p| rotation * p).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

/// How many cases of touching surfaces there were, by the oracle.
#[derive(Debug, Default)]
struct Tally {
    apart: u32,
    penetrating: u32,
    nested: u32,
}

impl Tally {
    fn add(&mut self, verdict: &OracleVerdict) {
        if verdict.surface == Meeting::Touch {
            let count = if verdict.solid { &mut self.penetrating } else { &mut self.apart };
            *count += 1;
            self.nested += u32::from(verdict.contained.is_some());
        }
    }
}

/// Two pyramids over the two sides of a quad that is planar but for rounding, and that each of them
/// splits along another diagonal.
fn pyramids(quad: [DVec3; 4], [above, below]: [DVec3; 2]) -> [Mesh; 2] {
    let [a, b, c, d] = quad;
    let upper = vec![[1, 0, 3], [1, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let lower = vec![[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]];
    [
        Mesh::new(vec![a, b, c, d, above], upper).unwrap(),
        Mesh::new(vec![a, b, c, d, below], lower).unwrap(),
    ]
}

#[test]
fn pyramids_on_a_quad_that_rounding_warps_agree_with_rationals() {
    let mut rng = Rng::new(30);
    let mut tally = Tally::default();
    for _ in 0..150 {
        // Tenths, so that their sums round.
        let mut tenth = || 0.1 * anywhere(&mut rng);
        let (a, b, c) = (tenth(), tenth(), tenth());
        let d = a + c - b;
        let warp = orient3d(a, b, c, d);
        if warp.is_zero() {
            continue;
        }
        let (normal, middle) = ((b - a).cross(c - a).normalize(), 0.5 * (a + c));
        let tips = [middle + normal, middle - normal];
        let [upper, lower] = pyramids([a, b, c, d], tips);
        let verdict = judged_here(&upper, &lower, "warped quad");
        // Either a sliver of tetrahedron lies between the two, or both hold it.
        assert_eq!(verdict.solid, warp == Sign::Negative);
        tally.add(&verdict);
        // Both from the same side: one holds the other's sliver, or not.
        let nested = pyramids([a, b, c, d], [tips[0]; 2]).map(|mesh| {
            if mesh.faces()[0] == [1, 0, 3] { mesh } else { crate::solids::inverted(&mesh) }
        });
        tally.add(&judged_here(&nested[0], &nested[1], "same side"));
    }
    assert!(tally.apart >= 25 && tally.penetrating >= 100, "{tally:?}");
    assert!(tally.nested >= 25, "{tally:?}");
}

#[test]
fn pyramids_on_a_quad_with_one_decimal_are_apart() {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let quad = [at(-0.5, -0.6, 0.0), at(-0.9, 0.5, 0.7), at(0.1, -0.2, -0.4), at(0.5, -1.3, -1.1)];
    let [upper, lower] = pyramids(quad, [at(-0.875, -0.125, -0.875), at(0.5, -0.625, 0.5)]);
    let verdict = judged_here(&upper, &lower, "one decimal");
    assert_eq!((verdict.surface, verdict.solid), (Meeting::Touch, false));
}

#[test]
fn lattice_solids_turned_and_rounded_agree_with_rationals() {
    let mut rng = Rng::new(31);
    let turns = quarter_turns();
    let mut tally = Tally::default();
    for _ in 0..250 {
        let mut union = || {
            let mask = rng.bits() as u32 % 4095 + 1;
            let chosen = (0..12).filter(|i| mask >> i & 1 == 1);
            cells(&chosen.map(|i| [i % 3, i / 3 % 2, i / 6]).collect::<Vec<_>>())
        };
        let (a, b) = (union(), union());
        let offset = 0.5 * DVec3::from_array([0; 3].map(|_| f64::from(rng.between(-4, 4))));
        let moved = turned(&b, turns[rng.below(24)]);
        let vertices = moved.vertices().iter().map(|&p| p.round() + offset).collect();
        let b = Mesh::new(vertices, moved.faces().to_vec()).unwrap();
        let turn = rotation(&mut rng);
        tally.add(&judged_here(&turned(&a, turn), &turned(&b, turn), "turned cells"));
    }
    assert!(tally.apart >= 10 && tally.penetrating >= 2, "{tally:?}");
}

/// Two tetrahedra glued at a face: closed, embedded, often not convex.
fn bipyramid([a, b, c]: [DVec3; 3], mut tips: [DVec3; 2]) -> Option<Mesh> {
    let [s, t] = tips.map(|tip| orient3d(a, b, c, tip));
    if s.is_zero() || t != s.flipped() {
        return None;
    }
    if s == Sign::Negative {
        tips.swap(0, 1);
    }
    let faces = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
    Some(Mesh::new(vec![a, b, c, tips[0], tips[1]], faces).unwrap())
}

#[test]
fn solids_on_common_corners_agree_with_rationals() {
    let mut rng = Rng::new(32);
    let mut tally = Tally::default();
    let mut tried = 0;
    while tried < 600 {
        // Some corners are middles of others, rounded: beside edges and planes by an ulp.
        let mut pool: Vec<DVec3> = (0..5).map(|_| anywhere(&mut rng)).collect();
        pool.push(pool[0] + pool[1] - pool[2]);
        pool.push(0.5 * pool[0] + 0.5 * pool[3]);
        pool.push(0.25 * pool[0] + 0.35 * pool[1] + 0.4 * pool[2]);
        let mut solid = || {
            for i in (1..pool.len()).rev() {
                let j = rng.below(i + 1);
                pool.swap(i, j);
            }
            bipyramid([pool[0], pool[1], pool[2]], [pool[3], pool[4]])
        };
        if let (Some(a), Some(b)) = (solid(), solid()) {
            tried += 1;
            tally.add(&judged_here(&a, &b, "common corners"));
        }
    }
    assert!(tally.apart >= 50 && tally.penetrating >= 50, "{tally:?}");
}
