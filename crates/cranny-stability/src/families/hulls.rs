//! Convex hulls of the clouds that break hull codes.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::ConvexHull;
use cranny_geometry::hull::HullKind;
use cranny_testkit::{Q3, rational_hull_fault, spans_a_solid};

use crate::case::{Case, PeerCase};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "hulls",
    question: "The convex hull of lattices, subdivided cubes, spheres, prisms, cones, plates and needles of points, of \
            one point, a line and a plane, with doubles, as they are and turned, scaled by 10^-6 to 10^6 or moved by 10^6 sizes.",
    made: "Exact rationals tell what the points span, and hold all of them against the planes of all triangles; closed, in \
           one piece, without a hole.",
    fails: "a hull that is not convex, misses a point or is not closed; other vertices when points come in another \
            order; a wrong kind (point, line, plane, solid)",
    figure: "thickness of the thickest merged facet, in sizes",
    cases,
};

/// Thicknesses of plates of size 1: one whose sides are facets of their own, one that is thinner
/// than what is merged into a facet. Other values make other cases; none decides anything.
const PLATE: f64 = 1e-9;
const LEAF: f64 = 1e-15;

/// Width of a needle of length 1; likewise.
const NEEDLE: f64 = 1e-6;

/// Clouds of about a unit's size.
fn clouds(trial: &mut Trial<'_>) -> Vec<(&'static str, Vec<DVec3>)> {
    let whole = |n: i32| {
        let range = move || (0..=n).map(f64::from);
        range()
            .flat_map(move |x| range().flat_map(move |y| range().map(move |z| DVec3::new(x, y, z))))
    };
    let on_rim = |n: f64| move |p: &DVec3| p.to_array().iter().any(|&c| c == 0.0 || c == n);
    let circle = |n: usize, z: f64| {
        (0..n).map(move |i| {
            let angle = std::f64::consts::TAU * i as f64 / n as f64;
            DVec3::new(angle.cos(), angle.sin(), z)
        })
    };
    let cube: Vec<DVec3> = whole(3).filter(on_rim(3.0)).map(|p| p / 3.0).collect();
    let thin = |by: f64| cube.iter().map(|p| DVec3::new(p.x, p.y, by * p.z)).collect::<Vec<_>>();
    let needle = |by: f64| cube.iter().map(|p| DVec3::new(p.x, by * p.y, by * p.z)).collect();
    let ball: Vec<DVec3> = (0..60).map(|_| trial.rng.direction()).collect();
    let rings = (1..8).flat_map(|i| {
        let angle = std::f64::consts::PI * f64::from(i) / 8.0;
        circle(12, 0.0).map(move |p| angle.sin() * p + angle.cos() * DVec3::Z)
    });
    let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.1, 0.0), DVec3::new(0.4, 0.2, 0.9)];
    let edges = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let on_edges = edges
        .into_iter()
        .flat_map(|(i, j)| (0..=12).map(move |k| corners[i].lerp(corners[j], f64::from(k) / 12.0)));
    vec![
        ("lattice", whole(3).map(|p| p / 3.0).collect()),
        ("doubled cube", cube.iter().chain(&cube).copied().collect()),
        ("plate of 1e-9", thin(PLATE)),
        ("plate of 1e-15", thin(LEAF)),
        ("needle of 1e-6", needle(NEEDLE)),
        ("sphere", ball),
        ("rings", rings.chain([DVec3::Z, -DVec3::Z]).collect()),
        ("prism", circle(24, 0.0).chain(circle(24, 1.0)).chain(circle(24, 0.5)).collect()),
        ("cone", circle(48, 0.0).chain([DVec3::Z, -0.5 * DVec3::Z, DVec3::ZERO]).collect()),
        ("edges of a tetrahedron", on_edges.collect()),
        ("point", vec![DVec3::new(0.3, -0.7, 0.1); 5]),
        ("line", (-8..=8).map(|i| f64::from(i) * DVec3::new(0.125, -0.25, 0.0625)).collect()),
        ("plane", whole(4).map(|p| DVec3::new(p.x, p.y, p.x - 2.0 * p.y) / 8.0).collect()),
    ]
}

fn cases(trial: &mut Trial<'_>) {
    for round in 0..trial.variants {
        for (i, (name, points)) in clouds(trial).into_iter().enumerate() {
            one(trial, name.to_owned(), &points);
            let frame = trial.frame();
            let turned: Vec<DVec3> = points.iter().map(|&p| frame * p).collect();
            let power = trial.rng.between(-6, 6);
            let by = 1e6 * trial.rng.direction();
            let (how, moved): (String, Vec<DVec3>) = match (i + round as usize) % 3 {
                0 => ("turned".to_owned(), turned),
                1 => {
                    let scale = 10f64.powi(power);
                    let scaled = turned.iter().map(|&p| scale * p).collect();
                    (format!("turned, times 10^{power}"), scaled)
                }
                _ => ("turned, 1e6 sizes off".to_owned(), turned.iter().map(|&p| p + by).collect()),
            };
            one(trial, format!("{name}, {how}"), &moved);
        }
    }
}

fn triangles(hull: &ConvexHull) -> Vec<[DVec3; 3]> {
    (0..hull.triangle_count()).map(|t| hull.triangle(t).map(|v| hull.position(v))).collect()
}

/// Vertices in an order of their own; adding zero makes −0 and 0 one place.
fn places(hull: &ConvexHull) -> Vec<[u64; 3]> {
    let bits = |p: &DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut places: Vec<_> = hull.positions().iter().map(bits).collect();
    places.sort_unstable();
    places
}

/// What the points span, in exact rationals.
fn kind_of(points: &[DVec3]) -> HullKind {
    let exact: Vec<Q3> = points.iter().map(|&p| Q3::exactly(p)).collect();
    let Some((o, rest)) = exact.split_first() else { return HullKind::Empty };
    let Some(u) = rest.iter().map(|p| p - o).find(|u| !u.is_zero()) else {
        return HullKind::Point;
    };
    if rest.iter().all(|p| u.cross(&(p - o)).is_zero()) {
        return HullKind::Segment;
    }
    match spans_a_solid(points) {
        true => HullKind::Volume,
        false => HullKind::Polygon,
    }
}

fn one(trial: &mut Trial<'_>, name: String, points: &[DVec3]) {
    trial.case(name, |trial, case| judge(trial, case, points));
}

fn judge(trial: &mut Trial<'_>, case: &mut Case, points: &[DVec3]) {
    let kind = kind_of(points);
    trial.count(kind.as_str(), 1);
    case.truth = kind.as_str().to_owned();
    let mut shuffled = points.to_vec();
    trial.rng.shuffle(&mut shuffled);
    let size = Aabb::of_points(points.iter().copied()).diagonal();
    case.peer = peer(trial, points, size);

    let hull = ConvexHull::of_points(points);
    case.answer = format!(
        "{}: {} vertices, {} triangles, {} facets",
        hull.kind().as_str(),
        hull.vertex_count(),
        hull.triangle_count(),
        hull.facet_count()
    );
    if hull.kind() != kind {
        case.faults.push(format!(
            "it is {}, but reported to be {}",
            case.truth,
            hull.kind().as_str()
        ));
    } else if kind == HullKind::Volume {
        case.faults.extend(rational_hull_fault(points, &triangles(&hull)).map(|fault| fault.what));
    }
    let violations = hull.validate(points);
    if let Some(first) = violations.first() {
        case.faults.push(format!("{} invariants broken, first {first:?}", violations.len()));
    }
    if places(&ConvexHull::of_points(&shuffled)) != places(&hull) {
        case.faults.push("other vertices in another order of points".to_owned());
    }
    // A point has no size, and nothing to merge.
    case.figure = (size > 0.0).then(|| hull.thickness_max() / size);
}

/// How far outside of a peer's hull a point may lie, in sizes: single precision, after some
/// operations.
const ALLOWED: f64 = 32.0 * f32::EPSILON as f64;

/// The peer's hull of the points as it stores them; where these are flat, any answer is right.
fn peer(trial: &mut Trial<'_>, points: &[DVec3], size: f64) -> Option<PeerCase> {
    let reply = trial.peer.as_mut()?.hull(points);
    Some(match reply {
        Err(why) => PeerCase { answer: why, wrong: false, refused: true, figure: None },
        Ok((stored, triangles)) => {
            let fault = spans_a_solid(&stored).then(|| rational_hull_fault(&stored, &triangles));
            let fault = fault.flatten();
            let outside = fault.as_ref().map_or(Some(0.0), |fault| fault.outside);
            PeerCase {
                answer: fault.map_or(format!("{} triangles", triangles.len()), |fault| fault.what),
                wrong: outside.is_none_or(|outside| outside > ALLOWED * size),
                refused: false,
                figure: None,
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_points_span_is_told_to_the_last_bit() {
        let line = [0.0, 1.0, 3.0].map(|t| t * DVec3::new(1.0, 2.0, -1.0));
        assert_eq!(kind_of(&[]), HullKind::Empty);
        assert_eq!(kind_of(&line[1..2].repeat(3)), HullKind::Point);
        assert_eq!(kind_of(&line), HullKind::Segment);
        let mut flat = line.to_vec();
        flat[2].x = flat[2].x.next_up();
        assert_eq!(kind_of(&flat), HullKind::Polygon);
        flat.push(DVec3::new(0.0, 0.0, f64::EPSILON));
        assert_eq!(kind_of(&flat), HullKind::Volume);
    }

    #[test]
    fn clouds_of_every_kind_are_asked() {
        let mut trial = Trial::new("hulls", &crate::Settings { seed: 1, variants: 1 }, None);
        cases(&mut trial);
        let counts = trial.finish().counts;
        for kind in [HullKind::Point, HullKind::Segment, HullKind::Polygon, HullKind::Volume] {
            assert!(counts.contains_key(kind.as_str()), "{counts:?}");
        }
    }
}
