//! Surface, solid and containment against exact rationals, on poses that posing does not round.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{Containment, Demand, Placed};
use cranny_testkit::{Contained, OracleVerdict, Rng, rational_verdict};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::solids::{
    angle, ask, cells, channel, cuboid, dyadic_solids, grooved, model, octahedron, quarter_turns,
};

/// Coincident solids lie in each other by the oracle; neither is wholly *inside* the other.
fn contained(oracle: &OracleVerdict) -> Option<Containment> {
    match oracle.contained? {
        Contained::AInB => Some(Containment::AInB),
        Contained::BInA => Some(Containment::BInA),
        Contained::Coincident => None,
    }
}

/// Both demands that decide it differently, in both orders, against the oracle; the oracle's
/// answer.
pub(crate) fn judged(a: Placed, b: Placed, what: &str) -> OracleVerdict {
    let oracle = rational_verdict(a.model.mesh(), &a.pose, b.model.mesh(), &b.pose);
    let expected = (oracle.surface, oracle.solid, contained(&oracle));
    for demand in [Demand::Intersects, Demand::Regions { margin: 0.0 }] {
        let found = ask(a, b, demand);
        assert_eq!(
            (found.surface, found.solid, found.contained),
            expected,
            "{what}: {demand:?}, A at {:?}, B at {:?}",
            a.pose,
            b.pose
        );
        let swapped = ask(b, a, demand);
        assert_eq!(
            (swapped.surface, swapped.solid, swapped.contained),
            (expected.0, expected.1, expected.2.map(Containment::swapped)),
            "{what}, swapped"
        );
    }
    oracle
}

/// A pose that turns axes into axes and moves by multiples of a quarter.
fn lattice_pose(rng: &mut Rng, turns: &[DQuat], reach: i32) -> Pose {
    let mut step = || f64::from(rng.between(-reach, reach)) / 4.0;
    let translation = DVec3::new(step(), step(), step());
    Pose { rotation: turns[rng.below(turns.len())], translation }
}

/// Where B must be so that one of its corners, or the middle of one of its faces' sides, lies on a
/// corner of A, or on the middle of a side of its.
fn attached(rng: &mut Rng, a: &Model, pose_a: &Pose, b: &Model, rotation: DQuat) -> Pose {
    let mut spot = |mesh: &Mesh| {
        let face = mesh.faces()[rng.below(mesh.faces().len())];
        let corner = |i: usize| mesh.vertices()[face[i] as usize];
        match rng.below(3) {
            0 => 0.5 * (corner(0) + corner(1)),
            1 => 0.5 * corner(0) + 0.25 * (corner(1) + corner(2)),
            _ => corner(0),
        }
    };
    let on_a = pose_a.world_from_body().apply(spot(a.mesh()));
    let turned = Pose { rotation, translation: DVec3::ZERO };
    let on_b = turned.world_from_body().apply(spot(b.mesh()));
    Pose { rotation, translation: on_a - on_b }
}

#[test]
fn special_poses_of_every_pair_of_solids_agree_with_rationals() {
    let solids = dyadic_solids();
    let turns = quarter_turns();
    assert_eq!(turns.len(), 24);
    let mut rng = Rng::new(20);
    let (mut touching, mut penetrating, mut nested) = (0, 0, 0);
    for (i, (name_a, a)) in solids.iter().enumerate() {
        for (name_b, b) in &solids[i..] {
            for _ in 0..8 {
                let pose_a = lattice_pose(&mut rng, &turns, 8);
                let rotation = turns[rng.below(24)];
                let pose_b = attached(&mut rng, a, &pose_a, b, rotation);
                let placed = [Placed { model: a, pose: pose_a }, Placed { model: b, pose: pose_b }];
                let oracle = judged(placed[0], placed[1], &format!("{name_a}, {name_b}"));
                if oracle.surface == Meeting::Touch {
                    touching += 1;
                    penetrating += u32::from(oracle.solid);
                    nested += u32::from(oracle.contained.is_some());
                }
            }
        }
    }
    assert!(touching >= 400, "{touching}");
    assert!(penetrating >= 100, "{penetrating}");
    assert!(nested >= 20, "{nested}");
    assert!(touching - penetrating >= 100, "{}", touching - penetrating);
}

fn verdict(a: &Mesh, b: &Mesh, what: &str) -> (Meeting, bool, Option<Containment>) {
    let (a, b) = (model(a.clone()), model(b.clone()));
    let oracle = judged(
        Placed { model: &a, pose: Pose::IDENTITY },
        Placed { model: &b, pose: Pose::IDENTITY },
        what,
    );
    (oracle.surface, oracle.solid, contained(&oracle))
}

const APART: (Meeting, bool, Option<Containment>) = (Meeting::Touch, false, None);
const MEET: (Meeting, bool, Option<Containment>) = (Meeting::Touch, true, None);
const IN_A: (Meeting, bool, Option<Containment>) = (Meeting::Touch, true, Some(Containment::BInA));

#[test]
fn boxes_touch_in_faces_edges_and_corners() {
    let unit = cuboid([0.0; 3], [1.0; 3]);
    for low in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0; 3], [1.0, 0.25, 0.5], [1.0, 1.0, 0.5]] {
        let other = cuboid(low, low.map(|x| x + 1.0));
        assert_eq!(verdict(&unit, &other, "beside"), APART);
    }
}

#[test]
fn coincident_solids_penetrate_and_neither_is_contained() {
    let coarse = cuboid([0.0; 3], [2.0; 3]);
    let two = [0, 1];
    let fine: Vec<[i32; 3]> =
        two.iter().flat_map(|&x| two.iter().flat_map(move |&y| two.map(|z| [x, y, z]))).collect();
    assert_eq!(verdict(&coarse, &coarse, "itself"), MEET);
    assert_eq!(verdict(&coarse, &cells(&fine), "itself, subdivided"), MEET);
    assert_eq!(verdict(&channel(), &channel(), "itself"), MEET);
}

#[test]
fn solids_flush_from_inside_are_contained() {
    let outer = cuboid([0.0; 3], [4.0; 3]);
    for low in [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 3.0], [3.0, 3.0, 0.0]] {
        let inner = cuboid(low, low.map(|x| x + 1.0));
        assert_eq!(verdict(&outer, &inner, "in a corner, on an edge, on a side"), IN_A);
    }
    // Flush on four sides.
    let across = cuboid([0.0, 0.0, 1.0], [4.0, 4.0, 2.0]);
    assert_eq!(verdict(&outer, &across, "a slice"), IN_A);
    // Touching with corners only, in the middle of its sides.
    let corners = cuboid([0.0; 3], [2.0; 3]);
    let spike: Vec<DVec3> = octahedron().vertices().iter().map(|&p| p + DVec3::ONE).collect();
    let spike = Mesh::new(spike, octahedron().faces().to_vec()).unwrap();
    assert_eq!(verdict(&corners, &spike, "with six corners"), IN_A);
}

#[test]
fn boxes_flush_on_all_sides_but_their_ends_penetrate() {
    let unit = cuboid([0.0; 3], [1.0; 3]);
    assert_eq!(verdict(&unit, &cuboid([0.5, 0.0, 0.0], [1.5, 1.0, 1.0]), "shifted"), MEET);
    let cross = cuboid([-1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    assert_eq!(
        verdict(&unit, &cross, "through it"),
        (Meeting::Touch, true, Some(Containment::AInB))
    );
}

#[test]
fn a_box_that_fills_a_notch_or_a_void_does_not_penetrate() {
    let plug = cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 2.0]);
    assert_eq!(verdict(&channel(), &plug, "fills the channel"), APART);
    let wedge = Mesh::new(
        vec![
            DVec3::new(1.0, 2.0, 0.0),
            DVec3::new(2.0, 1.0, 0.0),
            DVec3::new(3.0, 2.0, 0.0),
            DVec3::new(1.0, 2.0, 2.0),
            DVec3::new(2.0, 1.0, 2.0),
            DVec3::new(3.0, 2.0, 2.0),
        ],
        vec![
            [0, 2, 1],
            [3, 4, 5],
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [2, 0, 3],
            [2, 3, 5],
        ],
    )
    .unwrap();
    assert_eq!(verdict(&grooved(), &wedge, "fills the groove"), APART);
    let void = crate::solids::inverted(&cuboid([1.0; 3], [3.0; 3]));
    let shell = cuboid([0.0; 3], [4.0; 3]).joined(&void);
    assert_eq!(verdict(&shell, &cuboid([1.0; 3], [3.0; 3]), "fills the void"), APART);
    let both = cuboid([1.0; 3], [3.0; 3]).joined(&cuboid([0.25; 3], [0.5; 3]));
    assert_eq!(verdict(&shell, &both, "fills the void, and a speck is in the wall"), MEET);
    assert_eq!(
        verdict(&shell, &cuboid([0.0; 3], [4.0; 3]), "the full box holds the hollow one"),
        (Meeting::Touch, true, Some(Containment::AInB))
    );
}

#[test]
fn one_of_two_coincident_parts_is_contained() {
    let unit = cuboid([0.0; 3], [1.0; 3]);
    let two = unit.clone().joined(&cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]));
    assert_eq!(verdict(&two, &unit, "one of two boxes"), IN_A);
}

#[test]
fn a_face_over_a_reflex_edge_lies_inside() {
    // The box's side x = 1 lies on the angle's inner side above y = 1 and in its inside below: the
    // reflex edge runs through it, and no face of the angle dips behind it.
    let inside = cuboid([0.25, 0.25, 0.25], [1.0, 1.75, 0.75]);
    assert_eq!(verdict(&angle(), &inside, "along the inner side"), IN_A);
    let across = cuboid([0.25, 0.25, 0.0], [1.0, 1.75, 1.0]);
    assert_eq!(verdict(&angle(), &across, "flush at both ends too"), IN_A);
    // The groove's bottom edge runs in the top of the box, whose sides are in the solid.
    let under = cuboid([1.5, 0.5, 0.0], [2.5, 1.0, 2.0]);
    assert_eq!(verdict(&grooved(), &under, "under the groove"), IN_A);
}

#[test]
fn tetrahedra_whose_overlap_is_bounded_by_edges_in_faces_penetrate() {
    // The overlap is the tetrahedron v w p q. Each of its faces is a part of a larger face, cut off
    // by an edge of the other body that lies in it; no corner of either body is inside the other.
    let (v, w) = (DVec3::ZERO, DVec3::X);
    let (p, q) = (DVec3::Y, DVec3::Z);
    let beyond = |from: DVec3, to: DVec3| from + 2.0 * (to - from);
    let a = tetrahedron([v, w, beyond(w, p), beyond(v, q)]);
    let b = tetrahedron([p, q, beyond(p, v), beyond(q, w)]);
    assert_eq!(verdict(&a, &b, "interlocked"), MEET);
}

#[test]
fn a_corner_at_the_very_point_that_is_sampled_hides_nothing() {
    // A dent whose apex touches the box's face in the middle of one of its triangles.
    let face = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
    let bottom = DVec3::new(0.0, 0.0, -4.0);
    let inner = Mesh::new(
        vec![face[0], face[1], face[2], bottom],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    )
    .unwrap();
    for weights in [[2, 1, 1], [1, 2, 1], [1, 1, 2]] {
        let apex: DVec3 = (0..3).map(|i| 0.25 * f64::from(weights[i]) * face[i]).sum();
        let (low, high) = (DVec3::new(-1.0, -1.0, -6.0), DVec3::new(6.0, 6.0, 1.0));
        let corners = [
            DVec3::new(low.x, low.y, high.z),
            DVec3::new(high.x, low.y, high.z),
            DVec3::new(high.x, high.y, high.z),
            DVec3::new(low.x, high.y, high.z),
        ];
        let floor = corners.map(|p| DVec3::new(p.x, p.y, low.z));
        let mut vertices = corners.to_vec();
        vertices.extend(floor);
        vertices.push(apex);
        let mut faces = vec![[4, 6, 5], [4, 7, 6]];
        for i in 0..4u32 {
            let j = (i + 1) % 4;
            faces.extend([[i, j, 8], [i, i + 4, j], [j, i + 4, j + 4]]);
        }
        let dented = Mesh::new(vertices, faces).unwrap();
        assert_eq!(verdict(&dented, &inner, "under the dent"), IN_A);
    }
}

/// A tetrahedron through four points, outward.
fn tetrahedron(corners: [DVec3; 4]) -> Mesh {
    let [o, x, y, z] = corners;
    let mut faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    if (x - o).cross(y - o).dot(z - o) < 0.0 {
        faces.iter_mut().for_each(|f| f.swap(1, 2));
    }
    Mesh::new(corners.to_vec(), faces).unwrap()
}

#[test]
fn solids_glued_at_a_face_do_not_penetrate_though_their_coordinates_round() {
    let mut rng = Rng::new(7);
    let mut point = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
    for _ in 0..60 {
        let [a, b, c, d] = [point(), point(), point(), point()];
        let middle = 0.3 * a + 0.25 * b + 0.25 * c + 0.2 * d;
        let [whole, first, second] =
            [[a, b, c, d], [a, b, c, middle], [b, c, d, middle]].map(tetrahedron);
        assert_eq!(verdict(&first, &second, "two quarters"), APART);
        assert_eq!(verdict(&whole, &first, "a quarter in the whole"), IN_A);
        assert_eq!(verdict(&whole, &whole, "the whole in itself"), MEET);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Two tetrahedra on a small lattice: faces in common planes and edges through edges abound.
    #[test]
    fn lattice_tetrahedra_agree_with_rationals(
        a in prop::array::uniform4(prop::array::uniform3(0..4i32)),
        b in prop::array::uniform4(prop::array::uniform3(0..4i32)),
    ) {
        let solid = |corners: [[i32; 3]; 4]| {
            let vertices = corners.map(|c| DVec3::from_array(c.map(f64::from)));
            let [o, x, y, z] = vertices;
            let volume = (x - o).cross(y - o).dot(z - o);
            let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            (volume != 0.0).then(|| model(Mesh::new(vertices.to_vec(), faces).unwrap()))
        };
        let (Some(a), Some(b)) = (solid(a), solid(b)) else { return Ok(()) };
        let here = Pose::IDENTITY;
        judged(Placed { model: &a, pose: here }, Placed { model: &b, pose: here }, "tetrahedra");
    }

    /// Two unions of cells of one lattice, or of lattices half a cell apart.
    #[test]
    fn unions_of_cells_agree_with_rationals(
        masks in prop::array::uniform2(1..4096u32),
        turns in prop::array::uniform2(0..24usize),
        offset in prop::array::uniform3(-3..4i32),
    ) {
        let union = |mask: u32| {
            let chosen = (0..12).filter(|i| mask >> i & 1 == 1);
            model(cells(&chosen.map(|i| [i % 3, i / 3 % 2, i / 6]).collect::<Vec<_>>()))
        };
        let (a, b) = (union(masks[0]), union(masks[1]));
        let rotations = turns.map(|i| quarter_turns()[i]);
        let pose_a = Pose { rotation: rotations[0], translation: DVec3::ZERO };
        let translation = 0.5 * DVec3::from_array(offset.map(f64::from));
        let pose_b = Pose { rotation: rotations[1], translation };
        judged(Placed { model: &a, pose: pose_a }, Placed { model: &b, pose: pose_b }, "cells");
    }
}
