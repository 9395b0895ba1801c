//! Hulls for the walk to compare, and judges of its answers that share nothing with it: all pairs of
//! triangles, all faces of the set of differences, and certificates checked in exact rationals.

use cranny_exact::{DQuat, DVec3, Meeting, Pose, RigidMap, Sign, classify_triangles, orient3d};
use cranny_geometry::ConvexHull;
use cranny_geometry::hull::{HullKind, HullVertexId};
use cranny_narrow_phase::walk::{
    FeatureGraph, HullAnswer, Relation, WalkCounters, WalkHull, WalkState, walk_hulls,
};
use cranny_narrow_phase::{closest_on_segments, closest_on_triangle};
use cranny_testkit::{Q, Q3, Rng};

/// A hull with its features.
pub(crate) struct Body {
    pub(crate) hull: ConvexHull,
    pub(crate) graph: FeatureGraph,
}

impl Body {
    pub(crate) fn of(points: &[DVec3]) -> Self {
        let hull = ConvexHull::of_points(points);
        let graph = FeatureGraph::new(&hull).unwrap();
        assert_eq!(graph.validate(&hull), [""; 0]);
        Self { hull, graph }
    }

    pub(crate) fn walkable(&self) -> WalkHull<'_> {
        WalkHull { hull: &self.hull, graph: &self.graph }
    }

    fn reach(&self) -> f64 {
        self.hull.positions().iter().fold(0.0, |most, p| p.length().max(most))
    }

    /// The exact triangles, posed; thin hulls are degenerate ones.
    fn triangles(&self, map: &RigidMap) -> Vec<[DVec3; 3]> {
        let at = |v: HullVertexId| map.apply(self.hull.position(v));
        match self.hull.kind() {
            HullKind::Point => vec![[0, 0, 0].map(|v| at(HullVertexId(v)))],
            HullKind::Segment => vec![[0, 1, 1].map(|v| at(HullVertexId(v)))],
            _ => (0..self.hull.triangle_count()).map(|t| self.hull.triangle(t).map(at)).collect(),
        }
    }
}

/// Compares from a given state.
pub(crate) fn ask(a: &Body, b: &Body, map: &RigidMap, state: &mut WalkState) -> HullAnswer {
    walk_hulls(a.walkable(), b.walkable(), map, state, &mut WalkCounters::default()).unwrap()
}

/// Compares without history.
pub(crate) fn ask_cold(a: &Body, b: &Body, map: &RigidMap) -> HullAnswer {
    ask(a, b, map, &mut WalkState::default())
}

/// A length below which rounding rules.
pub(crate) fn rounding(a: &Body, b: &Body, map: &RigidMap) -> f64 {
    256.0 * f64::EPSILON * (a.reach() + b.reach() + map.translation.length())
}

/// Least distance over all pairs of triangles, and whether any two meet or one hull holds the other.
pub(crate) fn brute_force(a: &Body, b: &Body, map: &RigidMap) -> (bool, f64) {
    let (first, second) = (a.triangles(&RigidMap::IDENTITY), b.triangles(map));
    let (mut meets, mut least) = (false, f64::INFINITY);
    for t in &first {
        for s in &second {
            meets |= classify_triangles(t, s) != Meeting::None;
            for i in 0..3 {
                least = least.min(closest_on_triangle(t[i], s).0.distance(t[i]));
                least = least.min(closest_on_triangle(s[i], t).0.distance(s[i]));
                for j in 0..3 {
                    let (p, q) = ([t[i], t[(i + 1) % 3]], [s[j], s[(j + 1) % 3]]);
                    let (u, v) = closest_on_segments(&p, &q);
                    least =
                        least.min((p[0] + u * (p[1] - p[0])).distance(q[0] + v * (q[1] - q[0])));
                }
            }
        }
    }
    (meets || holds(a, &first, second[0][0]) || holds(b, &second, first[0][0]), least)
}

/// Whether a point lies below all triangles of a volume: exact.
fn holds(body: &Body, triangles: &[[DVec3; 3]], p: DVec3) -> bool {
    let below = |t: &[DVec3; 3]| orient3d(t[0], t[1], t[2], p) == Sign::Negative;
    body.hull.kind() == HullKind::Volume && triangles.iter().all(below)
}

/// Overlap of the supports along a direction (not of length 1): positive where they overlap.
fn overlap_along(a: &Body, b: &Body, map: &RigidMap, direction: DVec3) -> f64 {
    let top = a.hull.positions().iter().map(|&p| direction.dot(p)).fold(f64::MIN, f64::max);
    let low = b.hull.positions().iter().map(|&q| direction.dot(map.apply(q)));
    (top - low.fold(f64::MAX, f64::min)) / direction.length()
}

/// The penetration depth of two small volumes: over every face of the set of differences, whose normals are
/// those of triangles and the cross products of edges.
pub(crate) fn brute_force_depth(a: &Body, b: &Body, map: &RigidMap) -> f64 {
    let (first, second) = (a.triangles(&RigidMap::IDENTITY), b.triangles(map));
    let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
    let mut directions: Vec<DVec3> = first.iter().map(normal).collect();
    directions.extend(second.iter().map(|t| -normal(t)));
    for t in &first {
        for s in &second {
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let cross = (t[(i + 1) % 3] - t[i]).cross(s[(j + 1) % 3] - s[j]);
                if cross.length() > 1e-9 {
                    directions.extend([cross, -cross]);
                }
            }
        }
    }
    directions.iter().map(|&d| overlap_along(a, b, map, d)).fold(f64::INFINITY, f64::min)
}

/// Checks in exact rationals that along the answer's normal the vertices, as stored and as posed and rounded,
/// are apart by the lower end of the separation.
pub(crate) fn assert_lower_end_in_rationals(
    a: &Body,
    b: &Body,
    map: &RigidMap,
    found: &HullAnswer,
) {
    let normal = Q3::exactly(found.normal);
    let heights = |points: Vec<DVec3>| -> Vec<Q> {
        points.into_iter().map(|p| normal.dot(&Q3::exactly(p))).collect()
    };
    let top = heights(a.hull.positions().to_vec()).into_iter().max().unwrap();
    let posed = b.hull.positions().iter().map(|&q| map.apply(q)).collect();
    let gap = heights(posed).into_iter().min().unwrap() - top;
    let lo = Q::try_from(found.separation.lo).unwrap();
    // The normal is of length 1 to rounding: compare lo |n| with the gap, by squares of like signs.
    let length_squared = normal.dot(&normal);
    let ordered = match (lo >= Q::ZERO, gap >= Q::ZERO) {
        (true, true) => &lo * &lo * length_squared <= &gap * &gap,
        (true, false) => false,
        (false, true) => true,
        (false, false) => &lo * &lo * length_squared >= &gap * &gap,
    };
    assert!(ordered, "lower end {lo} is not proved by normal {:?}", found.normal);
}

/// Holds an answer against brute force.
pub(crate) fn judge(a: &Body, b: &Body, map: &RigidMap, found: &HullAnswer) {
    let slack = rounding(a, b, map);
    let (meets, distance) = brute_force(a, b, map);
    assert!(found.separation.lo <= found.separation.hi, "{found:?}");
    assert!((found.normal.length() - 1.0).abs() < 1e-14, "{found:?}");
    match found.relation {
        Relation::Separated => {
            assert!(!meets, "said to be apart: {found:?}");
            let (lo, hi) = (found.separation.lo - slack, found.separation.hi + slack);
            assert!(lo <= distance && distance <= hi, "{distance} is not in {found:?}");
            assert!(found.separation.width() <= 2.0 * slack, "wide: {found:?}");
            let [p, q] = found.points;
            assert!((p.distance(q) - distance).abs() <= slack, "witnesses {found:?}");
        }
        Relation::Touching => {
            assert!(meets, "said to touch: {found:?}");
            assert!(found.separation.hi >= 0.0 && found.separation.lo <= 0.0);
        }
        Relation::Penetrating => {
            assert!(meets, "said to overlap: {found:?}");
            assert!(found.separation.hi <= 0.0);
            let overlap = overlap_along(a, b, map, found.normal);
            assert!((overlap + found.separation.lo).abs() <= slack, "{overlap} {found:?}");
        }
    }
    // Zero may stem from exact predicates; an infinite depth from nothing having been tried.
    if found.separation.lo.is_finite() && found.separation.lo != 0.0 {
        assert_lower_end_in_rationals(a, b, map, found);
    }
}

pub(crate) fn random_direction(rng: &mut Rng) -> DVec3 {
    loop {
        let p = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        if (0.1..1.0).contains(&p.length()) {
            return p.normalize();
        }
    }
}

pub(crate) fn random_rotation(rng: &mut Rng) -> DQuat {
    loop {
        let q = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit());
        if (0.1..1.0).contains(&q.length()) {
            return q.normalize();
        }
    }
}

/// The second turned anyhow and its origin put `distance` away from the first's, anywhere.
pub(crate) fn random_map(rng: &mut Rng, distance: f64) -> RigidMap {
    let rotation = random_rotation(rng);
    Pose { rotation, translation: distance * random_direction(rng) }.world_from_body()
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> RigidMap {
    RigidMap { translation: DVec3::new(x, y, z), ..RigidMap::IDENTITY }
}

/// The box from −half to half.
pub(crate) fn cuboid(half: DVec3) -> Body {
    let sign = |bit: u32| if bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i: u32| half * DVec3::new(sign(i), sign(i >> 1), sign(i >> 2));
    Body::of(&(0..8).map(corner).collect::<Vec<_>>())
}

/// Tetrahedron, cube, octahedron, icosahedron, dodecahedron, about the origin.
pub(crate) fn platonic_solids() -> Vec<Body> {
    let golden = f64::midpoint(1.0, 5f64.sqrt());
    let signs = [1.0, -1.0];
    let cyclic = |p: DVec3| [p, DVec3::new(p.z, p.x, p.y), DVec3::new(p.y, p.z, p.x)];
    let rectangles = |long: f64, short: f64| -> Vec<DVec3> {
        let corners =
            signs.iter().flat_map(|s| signs.map(|t| DVec3::new(0.0, s * short, t * long)));
        corners.flat_map(cyclic).collect()
    };
    let cube: Vec<DVec3> = signs
        .iter()
        .flat_map(|&x| signs.map(|y| (x, y)))
        .flat_map(|(x, y)| signs.map(|z| DVec3::new(x, y, z)))
        .collect();
    let tetrahedron: Vec<DVec3> = cube.iter().copied().filter(|p| p.x * p.y * p.z > 0.0).collect();
    let octahedron: Vec<DVec3> =
        signs.iter().flat_map(|&s| cyclic(DVec3::new(s, 0.0, 0.0))).collect();
    let mut dodecahedron = cube.clone();
    dodecahedron.extend(rectangles(golden, 1.0 / golden));
    [tetrahedron, cube, octahedron, rectangles(golden, 1.0), dodecahedron]
        .iter()
        .map(|points| Body::of(points))
        .collect()
}

/// Points on the unit sphere.
pub(crate) fn sphere(count: usize, seed: u64) -> Body {
    let mut rng = Rng::new(seed);
    Body::of(&(0..count).map(|_| random_direction(&mut rng)).collect::<Vec<_>>())
}

/// A prism of `count` sides, radius 1; flat where `half` is 0.
pub(crate) fn disk(count: usize, half: f64) -> Body {
    let rim = (0..count).map(|i| {
        let angle = std::f64::consts::TAU * i as f64 / count as f64;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    });
    Body::of(&rim.flat_map(|p| [p + half * DVec3::Z, p - half * DVec3::Z]).collect::<Vec<_>>())
}
