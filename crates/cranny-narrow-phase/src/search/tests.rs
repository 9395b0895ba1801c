//! What the search leaves out is far, whatever is remembered.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, FaceId, Mesh, Model};
use cranny_shapes::{Comb, Cuboid, Cup, Shape, Torus};
use cranny_testkit::Rng;

use super::apart::FacePairs;
use super::cut::Cut;
use super::faces::Faced;
use super::lanes::lanes_of;
use super::*;
use crate::answer::Counters;
use crate::brute_force::brute_force;
use crate::closest::NearestFaces;
use crate::containment::solidity;
use crate::pair::{Pair, Side};
use crate::query::Placed;
use crate::surface::{FacePair, looked_at, strongest};
use cranny_geometry::triangle_distance::{closest_on_triangle, triangle_distance};

fn model(shape: impl Into<Shape>) -> Model {
    Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
}

fn bodies() -> Vec<Model> {
    vec![
        model(Cuboid::default()),
        model(Cup { segments: 9, ..Cup::default() }),
        model(Comb { teeth: 4, ..Comb::default() }),
        model(Torus { major_segments: 12, minor_segments: 7, ..Torus::default() }),
        model(Cuboid { size: [0.06, 0.05, 0.04] }),
    ]
}

fn faces(pair: &Pair, side: Side) -> impl Iterator<Item = FaceId> {
    (0..pair.mesh(side).faces().len() as u32).map(FaceId)
}

/// Every face against every face.
fn all_that_meet(pair: &Pair) -> Vec<FacePair> {
    let mut counters = Counters::default();
    let mut found = Vec::new();
    for f in faces(pair, Side::First) {
        for g in faces(pair, Side::Second) {
            found.extend(looked_at(pair, f, g, &mut counters));
        }
    }
    found
}

/// How far two clusters are apart: the least over all of their faces, and 0 where some meet.
fn cluster_distance(pair: &Pair, ground: &Ground, clusters: [u32; 2]) -> f64 {
    let [own, its] = Side::BOTH.map(|side| {
        let faces = &ground.tree(side).clusters()[clusters[side.index()] as usize].faces;
        &faces.ids[..faces.count as usize]
    });
    let mut least = f64::INFINITY;
    for &f in own {
        for &g in its {
            let meets = looked_at(pair, f, g, &mut Counters::default()).is_some();
            let [a, b] = [pair.triangle(Side::First, f), pair.triangle(Side::Second, g)];
            least = least.min(triangle_distance(&a, &b).squared.sqrt());
            least = if meets { 0.0 } else { least };
        }
    }
    least
}

#[test]
fn faces_that_meet_are_found_among_all() {
    let bodies = bodies();
    let mut rng = Rng::new(9);
    let mut met = [0; 3];
    for round in 0..240 {
        // Every other one is of cubes without a turn: faces lie on faces, and edges on edges.
        let turned = round % 2 == 1;
        let (a, b) = if turned { (rng.below(5), rng.below(5)) } else { (0, 0) };
        let turn = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
        let rotation = if turned { turn } else { DQuat::IDENTITY };
        let mut step = || 0.25 * rng.below(9) as f64 - 1.0;
        let translation = DVec3::new(step(), step(), step());
        let (a, b) = (
            Placed { model: &bodies[a], pose: Pose::IDENTITY },
            Placed { model: &bodies[b], pose: Pose { rotation, translation } },
        );
        let pair = Pair::of_accepted(a, b);
        let mut counters = Counters::default();
        let truth = all_that_meet(&pair);
        assert_eq!(meeting_pairs(&pair, &mut counters), truth, "round {round}");
        let ground = Ground::of(&pair);
        for apart in [false, true] {
            let meets = (Meets::UpToCrossing, apart);
            let (surface, some) = meeting_faces(&pair, &ground, meets, &mut counters);
            assert_eq!(surface, strongest(&truth), "round {round}");
            assert!(some.iter().all(|p| truth.contains(p)), "round {round}");
            assert!(surface == cranny_exact::Meeting::Cross || some == truth, "round {round}");
        }
        met[strongest(&truth) as usize] += 1;
    }
    assert!(met.iter().all(|&n| n > 10), "{met:?}");
}

/// Eight at a time, bounds of distances are certain, and nearly always as good as distances.
#[test]
fn bounds_of_faces_are_certain_and_close() {
    let bodies = bodies();
    let mut rng = Rng::new(31);
    let (mut all, mut close, mut met) = (0, 0, 0);
    for round in 0..400 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let size = a.radius() + b.radius();
        let turn = DQuat::from_axis_angle(rng.direction(), f64::from(round % 3));
        let translation = 0.6 * rng.unit() * size * rng.direction();
        let (a, b) = (
            Placed { model: a, pose: Pose::IDENTITY },
            Placed { model: b, pose: Pose { rotation: turn, translation } },
        );
        let pair = Pair::of_accepted(a, b);
        let ground = Ground::of(&pair);
        let unit = ground.tree(Side::First).unit();
        let count = |side: Side| ground.tree(side).clusters().len();
        let clusters = [rng.below(count(Side::First)), rng.below(count(Side::Second))];
        let faced = Faced::of(&ground, clusters.map(|i| i as u32));
        let (its, mut pairs) = (faced.its(), FacePairs::new());
        for lane in 0..faced.count() {
            let (near, gaps) = faced.near(lane, f32::INFINITY);
            for other in lanes_of(near) {
                let known = gaps.to_array()[other];
                pairs.push(&faced, (lane, &faced.own(lane)), (other, &its), known);
            }
            for ([f, g], bound) in pairs.take() {
                let [x, y] = [pair.triangle(Side::First, f), pair.triangle(Side::Second, g)];
                let meets = looked_at(&pair, f, g, &mut Counters::default()).is_some();
                let far = if meets { 0.0 } else { triangle_distance(&x, &y).squared.sqrt() };
                let bound = f64::from(bound) * unit;
                assert!(bound <= far, "round {round}: {bound} of {far}");
                (all, met) = (all + 1, met + u32::from(meets));
                close += u32::from(bound >= far - 1e-5 * size);
            }
        }
    }
    assert!(all > 1_000 && met > 0 && close * 10 > all * 9, "{close} of {all}, {met}");
}

/// Eight at a time, what is certain is true, and little is left to exact arithmetic but what hardly
/// meets or hardly misses.
#[test]
fn crossings_are_certain_and_many() {
    let bodies = bodies();
    let mut rng = Rng::new(77);
    let (mut all, mut crossing, mut apart, mut left) = (0, 0, 0, 0);
    for round in 0..240 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let size = a.radius() + b.radius();
        // Also where they stand square to each other, off by hardly anything, and far from where
        // their coordinates begin.
        let turn = DQuat::from_axis_angle(rng.direction(), f64::from(round % 3));
        let translation = match round % 4 {
            0 => DVec3::new(0.25, 0.5, 0.25) * size * rng.unit().round(),
            1 => DVec3::new(0.25, 0.25, 0.0) + 1e-7 * rng.unit() * rng.direction(),
            _ => 0.5 * rng.unit() * size * rng.direction(),
        };
        let far = if round % 5 == 0 { 1e4 * rng.direction() } else { DVec3::ZERO };
        let (a, b) = (
            Placed { model: a, pose: Pose::at(far) },
            Placed { model: b, pose: Pose { rotation: turn, translation: far + translation } },
        );
        let pair = Pair::of_accepted(a, b);
        let ground = Ground::of(&pair);
        let mut pairs = FacePairs::new();
        let mut check = |pairs: &mut FacePairs| {
            let crossings = pairs.crossings();
            for lane in lanes_of(pairs.lanes()) {
                let [f, g] = pairs.faces(lane);
                let truth = looked_at(&pair, f, g, &mut Counters::default());
                all += 1;
                if crossings.crossing() >> lane & 1 != 0 {
                    let known = truth.and_then(|found| found.crossing);
                    assert!(known.is_some(), "round {round}: {truth:?}");
                    assert_eq!(crossings.at(lane), known, "round {round}");
                    crossing += 1;
                } else if crossings.apart() >> lane & 1 != 0 {
                    assert_eq!(truth, None, "round {round}");
                    apart += 1;
                } else if round % 4 > 1 {
                    left += 1;
                }
            }
            pairs.clear();
        };
        let count = |side: Side| ground.tree(side).clusters().len() as u32;
        for clusters in
            (0..count(Side::First)).flat_map(|i| (0..count(Side::Second)).map(move |j| [i, j]))
        {
            let faced = Faced::of(&ground, clusters);
            let its = faced.its();
            for lane in 0..faced.count() {
                let (near, gaps) = faced.near(lane, faced.bound(0.02 * size));
                for other in lanes_of(near) {
                    let known = gaps.to_array()[other];
                    pairs.push(&faced, (lane, &faced.own(lane)), (other, &its), known);
                    if pairs.is_full() {
                        check(&mut pairs);
                    }
                }
            }
        }
        check(&mut pairs);
    }
    assert!(
        crossing > 2_000 && apart > 5_000 && 100 * left < all,
        "{all}: {crossing}, {apart}, {left}"
    );
}

/// A body wanders about another, by small steps and large ones, with rests: a cut lists all
/// clusters within its reach, what it says that is left between clusters is there, what is found in
/// it is what is found without, and where it says that surfaces stayed apart, what lies inside what
/// is as it was.
#[test]
fn a_cut_lists_all_that_is_within_reach() {
    let bodies = bodies();
    let mut rng = Rng::new(23);
    let (mut followed, mut rested, mut begun, mut near, mut met) = (0, 0, 0, 0, 0);
    let (mut stayed, mut changed) = (0, 0);
    for round in 0..60 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let size = a.radius() + b.radius();
        let mut pose = Pose {
            rotation: DQuat::from_axis_angle(rng.direction(), 1.0 + rng.unit()),
            translation: [0.3, 0.6, 0.8][round % 3] * size * rng.direction(),
        };
        let reach = [0.0, 0.02, 0.1, 0.3][rng.below(4)] * size;
        let spare = [0.0, 0.5][rng.below(2)] * reach;
        let mut cut: Option<Cut> = None;
        let mut before = None;
        for frame in 0..40 {
            let pace =
                if frame % 7 == 0 { 0.0 } else { size * 0.1f64.powi(1 + rng.below(4) as i32) };
            pose.translation += pace * (rng.direction() - 0.2 * pose.translation / size);
            if frame % 13 == 12 {
                pose.translation = 0.4 * rng.unit() * size * rng.direction();
            }
            let turn = DQuat::from_axis_angle(rng.direction(), pace / size);
            pose.rotation = (turn * pose.rotation).normalize();
            let (a, b) = (Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose });
            let pair = Pair::of_accepted(a, b);
            let ground = Ground::of(&pair);
            let mut counters = Counters::default();
            let last = cut.take().and_then(|mut cut| {
                let follows = cut.follow(&pair, &ground, &mut counters);
                followed += u32::from(follows);
                follows.then_some(cut)
            });
            // How many leaves are not of this pose.
            let old = last.as_ref().map_or(0, |cut| cut.held_leaves().unwrap_or(0));
            let mut now =
                last.unwrap_or_else(|| Cut::build(&pair, &ground, (reach, spare), &mut counters));
            let what = format!("round {round}, frame {frame}");
            let (leaves, spent) = now.leaves();
            let mut listed: Vec<[u32; 2]> = leaves.iter().map(|leaf| leaf.pair).collect();
            for (i, leaf) in leaves.iter().enumerate() {
                let left = spent.left(leaf);
                assert!(left <= cluster_distance(&pair, &ground, leaf.pair), "{what}");
                *(if i < old { &mut rested } else { &mut begun }) += u32::from(left > 0.0);
            }
            listed.sort_unstable();
            let count = |side: Side| ground.tree(side).clusters().len() as u32;
            for i in 0..count(Side::First) {
                for j in 0..count(Side::Second) {
                    if listed.binary_search(&[i, j]).is_err() {
                        let apart = cluster_distance(&pair, &ground, [i, j]);
                        assert!(apart > reach, "{what}: {apart} of {reach}");
                    }
                }
            }
            near += listed.len();
            let least = now.held() as usize * 28 + size_of_val(now.leaves().0);
            assert!(now.bytes() <= least * 5 / 4 + 1_000, "{what}: {} of {least}", now.bytes());
            let lists = Lists { reach: [0.0, 0.5, 1.0][frame % 3] * reach, closing: None };
            let lists = (frame % 4 > 0).then_some(lists);
            let mut listed = Vec::new();
            let wanted = (lists, Meets::All, pace);
            let (surface, found, stayed_apart) =
                near_in(&mut now, &pair, &ground, wanted, &mut listed, &mut counters);
            listed.sort_unstable();
            if let Some(lists) = lists {
                for leaf in now.leaves().0.iter() {
                    let is_near = cluster_distance(&pair, &ground, leaf.pair) <= lists.reach;
                    let is_listed = listed.binary_search(&leaf.pair).is_ok();
                    assert!(is_listed || !is_near, "{what}: {:?}", leaf.pair);
                }
            }
            assert_eq!(found, all_that_meet(&pair), "{what}");
            assert_eq!(surface, strongest(&found), "{what}");
            met += usize::from(surface.meets());
            let slow = brute_force(a, b).unwrap();
            let inside = (!surface.meets())
                .then(|| solidity(&pair, surface, &found, &mut Counters::default()));
            if inside.is_some() && before.is_some() {
                assert!(inside == before || !stayed_apart, "{what}");
                stayed += u32::from(stayed_apart);
                changed += u32::from(inside != before);
            }
            before = inside;
            if !surface.meets() && slow.distance <= reach {
                let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
                nearest.offer(FaceId(0), FaceId(0), &mut counters);
                nearest_in(&mut now, &ground, &mut nearest, &mut counters);
                assert_eq!(nearest.found().map(|n| n.distance), Some(slow.distance), "{what}");
            }
            cut = Some(now);
        }
    }
    assert!(
        followed > 1_000 && rested > 1_000 && begun > 1_000 && near > 1_000 && met > 200,
        "{followed} {rested} {begun} {near} {met}"
    );
    assert!(stayed > 500 && changed > 5, "{stayed} {changed}");
}

/// A small body jumps to and fro through the surface of a large one: wherever it comes to lie
/// inside or leaves, the surfaces are not said to have stayed apart.
#[test]
fn what_goes_through_a_surface_did_not_stay_apart() {
    let mut rng = Rng::new(47);
    let bodies = bodies();
    let scaled = |body: &Model| {
        let mesh = body.mesh();
        let vertices = mesh.vertices().iter().map(|p| *p * 0.02).collect();
        Model::build(Mesh::new(vertices, mesh.faces().to_vec()).unwrap(), &BuildOptions::default())
            .unwrap()
            .0
    };
    let small: Vec<Model> = bodies.iter().map(scaled).collect();
    let (mut changed, mut stayed) = (0, 0);
    for round in 0..120 {
        let (a, b) = (&bodies[rng.below(bodies.len())], &small[rng.below(small.len())]);
        let face = FaceId(rng.below(a.mesh().faces().len()) as u32);
        let [p, q, r] = a.mesh().triangle(face);
        let normal = (q - p).cross(r - p).normalize();
        let (middle, depth) = ((p + q + r) / 3.0, 2.5 * b.radius());
        let mut cut: Option<Cut> = None;
        let mut before = None;
        for frame in 0..12 {
            // To the other side in every third frame, else a little.
            let side = if frame / 3 % 2 == 0 { depth } else { -depth };
            let beside = 0.1 * b.radius() * rng.direction();
            let rotation = DQuat::from_axis_angle(rng.direction(), 0.02 * rng.unit());
            let translation = middle + side * normal + beside - b.bounds().center();
            let pose = Pose { rotation, translation };
            let pair = Pair::of_accepted(
                Placed { model: a, pose: Pose::IDENTITY },
                Placed { model: b, pose },
            );
            let ground = Ground::of(&pair);
            let counters = &mut Counters::default();
            let last =
                cut.take().and_then(|mut cut| cut.follow(&pair, &ground, counters).then_some(cut));
            let reach = (8.0 * depth, 0.0);
            let mut now = last.unwrap_or_else(|| Cut::build(&pair, &ground, reach, counters));
            let wanted = (None, Meets::All, depth);
            let (surface, found, stayed_apart) =
                near_in(&mut now, &pair, &ground, wanted, &mut Vec::new(), counters);
            let inside = (!surface.meets()).then(|| solidity(&pair, surface, &found, counters));
            if inside.is_some() && before.is_some() {
                assert!(inside == before || !stayed_apart, "round {round}, frame {frame}");
                changed += u32::from(inside != before);
                stayed += u32::from(stayed_apart);
            }
            before = inside;
            cut = Some(now);
        }
    }
    assert!(changed > 50 && stayed > 50, "{changed} {stayed}");
}

/// Points wander beside a surface, and jump: the face nearest to each is visited, whatever list
/// serves it.
#[test]
fn the_nearest_face_to_a_point_is_visited() {
    let mut rng = Rng::new(31);
    let mut bodies = bodies();
    // Of more clusters than a list for points to come may hold.
    bodies.push(model(Torus { major_segments: 64, minor_segments: 24, ..Torus::default() }));
    let (mut tests, mut searches) = (0, 0);
    for body in &bodies {
        let (mesh, tree) = (body.mesh(), body.clusters());
        let nearest_of_all = |p: DVec3| {
            let near = |f: u32| {
                let foot = closest_on_triangle(p, &mesh.triangle(FaceId(f))).0;
                ((foot - p).length(), FaceId(f), foot)
            };
            let of_faces = (0..mesh.faces().len() as u32).map(near);
            of_faces.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1))).unwrap()
        };
        let (mut vicinity, mut last) = (Vicinity::default(), None);
        let mut p = DVec3::ZERO;
        for round in 0..400 {
            let step = DVec3::new(rng.unit(), rng.unit(), rng.unit());
            p = if round % 25 == 0 { 2.0 * step } else { p + 0.05 * step };
            let reach = last.map_or(f64::INFINITY, |last: DVec3| (last - p).length() + 1e-12);
            let mut best: Option<(f64, FaceId)> = None;
            let mut counters = Counters::default();
            if round % 10 == 5 {
                // Now and then for less than where the next points are.
                let radius = 0.02 * rng.below(9) as f64;
                vicinity.gather(tree, (p, radius), 1e-12, &mut counters, |face| {
                    (closest_on_triangle(p, &mesh.triangle(face)).0 - p).length()
                });
            }
            vicinity.for_faces_near(tree, p, (reach, 1e-12), &mut counters, |face| {
                let distance = (closest_on_triangle(p, &mesh.triangle(face)).0 - p).length();
                if best.is_none_or(|best| (distance, face) < best) {
                    best = Some((distance, face));
                }
                best.map_or(reach, |best| best.0.min(reach))
            });
            let (distance, face, foot) = nearest_of_all(p);
            assert_eq!(best, Some((distance, face)), "round {round}");
            last = Some(foot);
            tests += counters.node_tests;
            vicinity = if round % 50 == 49 { Vicinity::default() } else { vicinity };
            let beside = |fresh: &mut Vicinity| {
                // A list that is made for others serves it, and one too long is none.
                let ball = (p + 0.05 * step, [0.06, 1e3][round % 2]);
                let center =
                    |face| (closest_on_triangle(ball.0, &mesh.triangle(face)).0 - ball.0).length();
                let counters = &mut Counters::default();
                let mut nearest = f64::INFINITY;
                fresh.gather(tree, ball, 1e-12, counters, |face| {
                    nearest = center(face).min(nearest);
                    nearest
                });
                let mut best: Option<(f64, FaceId)> = None;
                fresh.for_faces_near(tree, p, (f64::INFINITY, 1e-12), counters, |face| {
                    let distance = (closest_on_triangle(p, &mesh.triangle(face)).0 - p).length();
                    if best.is_none_or(|best| (distance, face) < best) {
                        best = Some((distance, face));
                    }
                    best.map_or(f64::INFINITY, |best| best.0)
                });
                best
            };
            assert_eq!(beside(&mut Vicinity::default()), Some((distance, face)), "round {round}");
            let alone = &mut Counters::default();
            Vicinity::default().for_faces_near(tree, p, (reach, 1e-12), alone, |_| distance);
            searches += alone.node_tests;
        }
    }
    // A list serves more points than one.
    assert!(3 * tests < 2 * searches, "{tests} {searches}");
}
