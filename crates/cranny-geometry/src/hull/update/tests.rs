//! A followed hull is the one that is built, bit for bit but for numbers of triangles and facets.

use std::collections::BTreeSet;

use cranny_exact::DQuat;
use cranny_testkit::Rng;

use super::super::shapes::bends_clearly;
use super::super::{FLATNESS, Facet};
use super::*;

/// A point in a cube.
fn anywhere(rng: &mut Rng) -> DVec3 {
    DVec3::new(rng.unit(), rng.unit(), rng.unit())
}

fn follow(hull: &ConvexHull, points: &[DVec3], moved: &[VertexId], flatness: f64) -> Followed {
    let near = |bounds: &Aabb| {
        let all = (0..).map(VertexId).zip(points);
        all.filter(|(_, p)| bounds.contains_point(**p)).map(|(v, _)| v).collect()
    };
    hull.clone().followed(points, moved, hull.inner_point(), flatness, near)
}

/// Everything but numbers of triangles and facets is the same, bit for bit.
fn assert_same(followed: &ConvexHull, rebuilt: &ConvexHull, what: &str) {
    assert_eq!(followed.sources(), rebuilt.sources(), "{what}");
    assert_eq!(followed.positions(), rebuilt.positions(), "{what}");
    let described = |hull: &ConvexHull| {
        let facet = |f: Facet<'_>| {
            let mut triangles: Vec<_> =
                f.triangles.iter().map(|&t| hull.triangle(t as usize)).collect();
            triangles.sort_unstable();
            let mut corners = f.corners.to_vec();
            let lowest = (0..corners.len()).min_by_key(|&i| corners[i]);
            corners.rotate_left(lowest.unwrap_or(0));
            let plane = [f.normal.x, f.normal.y, f.normal.z, f.offset, f.thickness];
            (triangles, corners, plane.map(f64::to_bits))
        };
        let mut facets: Vec<_> = hull.facets().map(facet).collect();
        facets.sort_unstable();
        facets
    };
    assert_eq!(described(followed), described(rebuilt), "{what}");
}

/// Every facet hangs together over edges that do not bend clearly: on that it rests that facets
/// elsewhere do not matter.
fn assert_hanging_together(hull: &ConvexHull, what: &str) {
    let is_open = |&h: &u32| !bends_clearly(&hull.positions, &hull.surface, hull.flatness(), h);
    for facet in hull.facets() {
        let mut left: BTreeSet<u32> = facet.triangles.iter().copied().collect();
        let mut front = Vec::from_iter(left.pop_first());
        while let Some(t) = front.pop() {
            let beside = (3 * t..3 * t + 3)
                .filter(is_open)
                .map(|h| hull.surface.twins[h as usize] / 3)
                .filter(|t| left.remove(t));
            front.extend(beside);
        }
        assert!(left.is_empty(), "{what}: triangles {left:?} hang on nothing");
    }
}

/// Moves points again and again; returns how many triangles were measured, and how many there were.
fn knead(
    mut points: Vec<DVec3>,
    rng: &mut Rng,
    at_once: usize,
    mut to: impl FnMut(&mut Rng, DVec3) -> DVec3,
) -> (usize, usize) {
    let mut hull = ConvexHull::of_points(&points);
    let (mut measured, mut all) = (0, 0);
    for step in 0..40 {
        let mut moved: Vec<VertexId> =
            (0..at_once).map(|_| VertexId(rng.below(points.len()) as u32)).collect();
        moved.sort_unstable();
        moved.dedup();
        for v in &moved {
            points[v.index()] = to(rng, points[v.index()]);
        }
        let followed = follow(&hull, &points, &moved, FLATNESS);
        let rebuilt = ConvexHull::of_points(&points);
        assert_eq!(followed.hull.validate(&points), [], "step {step}");
        assert_same(&followed.hull, &rebuilt, &format!("step {step}"));
        measured += followed.measured;
        all += followed.hull.triangle_count();
        hull = followed.hull;
    }
    (measured, all)
}

#[test]
fn a_ball_of_points_is_kneaded_and_stays_the_hull() {
    let mut rng = Rng::new(1);
    let mut ball: Vec<DVec3> = Vec::new();
    while ball.len() < 400 {
        let p = anywhere(&mut rng);
        ball.extend(Some(p).filter(|p| p.length() < 1.0));
    }
    // Corners that never move keep the box.
    ball.extend((0..6).map(|i| DVec3::AXES[i / 2] * if i % 2 == 0 { 2.0 } else { -2.0 }));
    let inward = |rng: &mut Rng, p: DVec3| {
        if p.length() == 2.0 { p } else { (p * (1.0 + 0.5 * rng.unit())).clamp_length_max(1.9) }
    };
    let (measured, all) = knead(ball, &mut rng, 5, inward);
    assert!(5 * measured < 4 * all, "{measured} of {all}");
}

#[test]
fn a_smooth_hull_is_repaired_where_it_is_dented_and_bumped() {
    let mut rng = Rng::new(2);
    let mut sphere: Vec<DVec3> = (0..2000).map(|_| anywhere(&mut rng).normalize()).collect();
    sphere.extend(DVec3::AXES.into_iter().flat_map(|a| [1.2 * a, -1.2 * a]));
    let nudge = |rng: &mut Rng, p: DVec3| {
        if p.length() > 1.1 { p } else { p * (1.0 + 0.02 * rng.unit()) }
    };
    let (measured, all) = knead(sphere, &mut rng, 1, nudge);
    assert!(100 * measured < 3 * all, "{measured} of {all}");
}

#[test]
fn points_of_a_lattice_come_out_in_planes_and_on_top_of_each_other() {
    let mut rng = Rng::new(3);
    let cell = |i: i32| f64::from(i % 5 - 2);
    let lattice = (0..125).map(|i| DVec3::new(cell(i), cell(i / 5), cell(i / 25))).collect();
    let onto = |rng: &mut Rng, _: DVec3| (2.4 * anywhere(rng)).round();
    knead(lattice, &mut rng, 3, onto);
}

#[test]
fn what_cannot_be_repaired_is_exchanged_where_it_changes() {
    // Points of a lattice in a ball: its sides are polygons of many corners, and
    // have vertices in their middle, which come out and go in again.
    let radius = 9i32;
    let range = || -radius..=radius;
    let lattice = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    let in_ball = lattice.filter(|p| p.iter().map(|x| x * x).sum::<i32>() <= radius * radius);
    let mut points: Vec<DVec3> = in_ball.map(|p| DVec3::from_array(p.map(f64::from))).collect();
    let mut hull = ConvexHull::of_points(&points);
    let first = hull.triangle_count();
    let is_away = |p: DVec3| p.abs().max_element() < f64::from(radius);
    let corners: Vec<VertexId> =
        hull.sources().iter().copied().filter(|v| is_away(points[v.index()])).collect();
    let (mut measured, mut all) = (0, 0);
    for pair in corners.chunks_exact(2).step_by(3) {
        let there = pair.iter().map(|v| points[v.index()]).collect::<Vec<_>>();
        for scale in [1.01, 1.0, 0.875, 1.0] {
            for (v, place) in pair.iter().zip(&there) {
                points[v.index()] = scale * place;
            }
            let followed = follow(&hull, &points, pair, FLATNESS);
            assert_eq!(followed.hull.validate(&points), []);
            assert_same(&followed.hull, &ConvexHull::of_points(&points), "");
            measured += followed.measured;
            all += followed.hull.triangle_count();
            hull = followed.hull;
        }
    }
    assert_eq!(hull.triangle_count(), first);
    assert!(2 * measured < all, "{measured} of {all}");
}

#[test]
fn a_vertex_pushed_in_brings_out_what_lay_beneath() {
    // An octahedron with a smaller one inside.
    let corners = |r: f64| DVec3::AXES.into_iter().flat_map(move |a| [r * a, -r * a]);
    let mut points: Vec<DVec3> = corners(1.0).chain(corners(0.75)).collect();
    let hull = ConvexHull::of_points(&points);
    assert_eq!(hull.vertex_count(), 6);
    points[0] = DVec3::ZERO;
    let Followed { hull, .. } = follow(&hull, &points, &[VertexId(0)], FLATNESS);
    assert_eq!(hull.validate(&points), []);
    assert_eq!(hull.sources(), [1, 2, 3, 4, 5, 6].map(VertexId));
    assert!(!hull.contains_point(0.8 * DVec3::X) && hull.contains_point(0.75 * DVec3::X));
}

/// Shapes with sides that are flat, exactly or but for rounding, in many ways.
fn of_family(family: usize, rng: &mut Rng) -> DVec3 {
    let lattice = |rng: &mut Rng, n: i32| {
        DVec3::from_array(std::array::from_fn(|_| f64::from(rng.between(-n, n))))
    };
    match family {
        // Points of a lattice: all is exactly flat, or clearly bent.
        0 => lattice(rng, 2),
        // In six sides.
        1 => {
            let mut p = lattice(rng, 3);
            p[rng.below(3)] = if rng.below(2) == 0 { 3.0 } else { -3.0 };
            p
        }
        // Two polygons of many corners.
        2 => {
            let angle = rng.below(24) as f64 * std::f64::consts::TAU / 24.0;
            DVec3::new(angle.cos(), angle.sin(), f64::from(rng.between(0, 1)))
        }
        // Flat but for rounding, of the last digits of what is turned.
        3 => DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize() * lattice(rng, 4),
        // Rough by less than what is merged.
        4 => lattice(rng, 2) + 4.0 * f64::EPSILON * lattice(rng, 2),
        // A plate as thick as what is merged.
        5 => {
            let z = if rng.below(3) == 0 { 512.0 * f64::EPSILON * rng.unit() } else { 0.0 };
            lattice(rng, 3).with_z(z)
        }
        // A rod thinner than that.
        6 => rng.unit() * DVec3::new(1.0, 0.3, 0.7) + 32.0 * f64::EPSILON * lattice(rng, 3),
        _ => anywhere(rng).normalize(),
    }
}

#[test]
fn a_followed_hull_is_the_one_that_is_built_however_flat_it_is() {
    let (mut kept, mut steps) = (0, 0);
    for seed in 0..240 {
        let mut rng = Rng::new(seed);
        let family = seed as usize % 8;
        let count = [6, 20, 60, 120][rng.below(4)];
        let flatness = [FLATNESS, 1e-3, 0.02][seed as usize / 8 % 3];
        let mut points: Vec<DVec3> = (0..count).map(|_| of_family(family, &mut rng)).collect();
        if rng.below(2) == 0 {
            // Corners keep the box, so that facets may keep their planes.
            let bit = |i: usize, k: usize| if i >> k & 1 == 1 { 4.0 } else { -4.0 };
            points.extend((0..8).map(|i| DVec3::new(bit(i, 0), bit(i, 1), bit(i, 2))));
        }
        let mut hull = ConvexHull::with_flatness(&points, flatness);
        for step in 0..8 {
            let how = rng.below(5);
            let mut moved: Vec<VertexId> =
                (0..[1, 2, 5][rng.below(3)]).map(|_| VertexId(rng.below(count) as u32)).collect();
            moved.sort_unstable();
            moved.dedup();
            for v in &moved {
                let other = points[rng.below(count)];
                let p = &mut points[v.index()];
                *p = match how {
                    0 => of_family(family, &mut rng),
                    1 => 0.875 * *p,
                    2 => 1.125 * *p,
                    3 => other,
                    _ => *p + f64::EPSILON * of_family(0, &mut rng),
                };
            }
            let followed = follow(&hull, &points, &moved, flatness);
            let what = format!("seed {seed}, step {step}");
            assert_eq!(followed.hull.validate(&points), [], "{what}");
            assert_hanging_together(&followed.hull, &what);
            assert_same(&followed.hull, &ConvexHull::with_flatness(&points, flatness), &what);
            kept += usize::from(followed.measured < followed.hull.triangle_count());
            steps += usize::from(followed.hull.kind() == HullKind::Volume);
            hull = followed.hull;
        }
    }
    // Many are followed in earnest.
    assert!(5 * kept > steps, "{kept} of {steps}");
}
