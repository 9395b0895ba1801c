//! Hulls for the walk to compare, and judges of its answers that follow no features.
//!
//! [`faults_beside`] holds an answer against the truth, which [`HullTruth`](crate::HullTruth) has
//! in exact rationals, and checks the proof of its lower end in rationals too; lengths are compared
//! to [`rounding`]. [`faults`] takes [`brute_force`] for the truth: all pairs of triangles, fast,
//! but by the same predicates and closest points of triangles that the walk falls back on.
//! [`brute_force_depth`] tries all faces of the set of differences in `f64`.

use cranny_concavity::walk::{FeatureGraph, HullAnswer, Relation, WalkHull};
use cranny_exact::{DVec3, Interval, Meeting, Pose, RigidMap, Sign, classify_triangles, orient3d};
use cranny_geometry::ConvexHull;
use cranny_geometry::hull::{HullKind, HullVertexId};
use cranny_geometry::triangle_distance::{closest_on_segments, closest_on_triangle};
use cranny_testkit::{Q, Q3, Rng};

/// How far from length 1 a normal may be: a few roundings.
const UNIT: f64 = 48.0 * f64::EPSILON;

/// Below this share of their lengths' product the cross product of two edges is rounding: they are
/// parallel.
const PARALLEL: f64 = 1e-9;

/// A hull with its features.
#[derive(Debug)]
pub struct Body {
    /// The hull.
    pub hull: ConvexHull,
    /// Its features.
    pub graph: FeatureGraph,
}

impl Body {
    /// Of the hull of some points.
    ///
    /// # Panics
    ///
    /// Where the hull's features do not keep their promises.
    #[must_use]
    pub fn of(points: &[DVec3]) -> Self {
        let hull = ConvexHull::of_points(points);
        let graph = FeatureGraph::new(&hull).unwrap_or_else(|error| panic!("no features: {error}"));
        assert_eq!(graph.validate(&hull), [""; 0]);
        Self { hull, graph }
    }

    /// As the walk takes it.
    #[must_use]
    pub fn walkable(&self) -> WalkHull<'_> {
        WalkHull { hull: &self.hull, graph: &self.graph }
    }

    fn reach(&self) -> f64 {
        self.hull.positions().iter().fold(0.0, |most, p| p.length().max(most))
    }

    /// The exact triangles, posed; thin hulls are degenerate ones.
    pub(crate) fn triangles(&self, map: &RigidMap) -> Vec<[DVec3; 3]> {
        let at = |v: HullVertexId| map.apply(self.hull.position(v));
        match self.hull.kind() {
            HullKind::Point => vec![[0, 0, 0].map(|v| at(HullVertexId(v)))],
            HullKind::Segment => vec![[0, 1, 1].map(|v| at(HullVertexId(v)))],
            _ => (0..self.hull.triangle_count()).map(|t| self.hull.triangle(t).map(at)).collect(),
        }
    }
}

/// A length below which rounding rules.
#[must_use]
pub fn rounding(a: &Body, b: &Body, map: &RigidMap) -> f64 {
    256.0 * f64::EPSILON * (a.reach() + b.reach() + map.translation.length())
}

/// Least distance over all pairs of triangles, and whether any two meet or one hull holds the
/// other.
#[must_use]
pub fn brute_force(a: &Body, b: &Body, map: &RigidMap) -> (bool, f64) {
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

/// The penetration depth of two small volumes: over every face of the set of differences, whose
/// normals are those of triangles and the cross products of edges.
#[must_use]
pub fn brute_force_depth(a: &Body, b: &Body, map: &RigidMap) -> f64 {
    let (first, second) = (a.triangles(&RigidMap::IDENTITY), b.triangles(map));
    let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
    let mut directions: Vec<DVec3> = first.iter().map(normal).collect();
    directions.extend(second.iter().map(|t| -normal(t)));
    for t in &first {
        for s in &second {
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let cross = (t[(i + 1) % 3] - t[i]).cross(s[(j + 1) % 3] - s[j]);
                let (u, v) = ((t[(i + 1) % 3] - t[i]).length(), (s[(j + 1) % 3] - s[j]).length());
                if cross.length() > PARALLEL * u * v {
                    directions.extend([cross, -cross]);
                }
            }
        }
    }
    directions.iter().map(|&d| overlap_along(a, b, map, d)).fold(f64::INFINITY, f64::min)
}

/// Whether, in exact rationals, along the answer's normal the vertices, as stored and as posed and
/// rounded, are apart by the lower end of the separation.
#[must_use]
pub fn proves_lower_end(a: &Body, b: &Body, map: &RigidMap, found: &HullAnswer) -> bool {
    let normal = Q3::exactly(found.normal);
    let heights = |points: Vec<DVec3>| -> Vec<Q> {
        points.into_iter().map(|p| normal.dot(&Q3::exactly(p))).collect()
    };
    let posed = b.hull.positions().iter().map(|&q| map.apply(q)).collect();
    let (top, low) = (heights(a.hull.positions().to_vec()), heights(posed));
    let (Some(top), Some(low)) = (top.into_iter().max(), low.into_iter().min()) else {
        return false;
    };
    let Ok(lo) = Q::try_from(found.separation.lo) else { return false };
    // The normal is of length 1 to rounding: compare lo |n| with the gap, by squares of like signs.
    let (gap, length_squared) = (low - top, normal.dot(&normal));
    match (lo >= Q::ZERO, gap >= Q::ZERO) {
        (true, true) => &lo * &lo * length_squared <= &gap * &gap,
        (true, false) => false,
        (false, true) => true,
        (false, false) => &lo * &lo * length_squared >= &gap * &gap,
    }
}

/// What is wrong with an answer, held against brute force; nothing where it is right.
#[must_use]
pub fn faults(a: &Body, b: &Body, map: &RigidMap, found: &HullAnswer) -> Vec<String> {
    faults_beside(a, b, map, found, brute_force(a, b, map))
}

/// What is wrong with an answer where hulls meet, or do not and are so far apart; nothing where it
/// is right.
#[must_use]
pub fn faults_beside(
    a: &Body,
    b: &Body,
    map: &RigidMap,
    found: &HullAnswer,
    (meets, distance): (bool, f64),
) -> Vec<String> {
    let slack = rounding(a, b, map);
    let mut faults = Vec::new();
    let mut check = |right: bool, what: &str| {
        if !right {
            faults.push(format!("{what}: {found:?}, but: meets {meets}, {distance:e} apart"));
        }
    };
    let Interval { lo, hi } = found.separation;
    check(lo <= hi, "no interval");
    check((found.normal.length() - 1.0).abs() <= UNIT, "normal not of length 1");
    match found.relation {
        Relation::Separated => {
            check(!meets, "said to be apart");
            check(lo - slack <= distance && distance <= hi + slack, "distance not in interval");
            check(found.separation.width() <= 2.0 * slack, "wide interval");
            let [p, q] = found.points;
            check((p.distance(q) - distance).abs() <= slack, "points not at that distance");
        }
        Relation::Touching => {
            check(meets, "said to touch");
            check(hi >= 0.0 && lo <= 0.0, "touching, yet not zero apart");
        }
        Relation::Penetrating => {
            check(meets, "said to overlap");
            check(hi <= 0.0, "overlapping, yet apart");
            let overlap = overlap_along(a, b, map, found.normal);
            check((overlap + lo).abs() <= slack, "not the overlap along the normal");
        }
    }
    // Zero may stem from exact predicates; an infinite depth from nothing having been tried.
    if lo.is_finite() && lo != 0.0 {
        check(proves_lower_end(a, b, map, found), "lower end not proved by the normal");
    }
    faults
}

/// The second turned anyhow and its origin put `distance` away from the first's, anywhere.
pub fn random_map(rng: &mut Rng, distance: f64) -> RigidMap {
    let rotation = rng.rotation();
    Pose { rotation, translation: distance * rng.direction() }.world_from_body()
}

/// The second moved, not turned.
#[must_use]
pub fn at(x: f64, y: f64, z: f64) -> RigidMap {
    RigidMap { translation: DVec3::new(x, y, z), ..RigidMap::IDENTITY }
}

/// The box from −half to half.
#[must_use]
pub fn cuboid(half: DVec3) -> Body {
    let sign = |bit: u32| if bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i: u32| half * DVec3::new(sign(i), sign(i >> 1), sign(i >> 2));
    Body::of(&(0..8).map(corner).collect::<Vec<_>>())
}

/// Tetrahedron, cube, octahedron, icosahedron, dodecahedron, about the origin.
#[must_use]
pub fn platonic_solids() -> Vec<Body> {
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
#[must_use]
pub fn sphere(count: usize, seed: u64) -> Body {
    let mut rng = Rng::new(seed);
    Body::of(&(0..count).map(|_| rng.direction()).collect::<Vec<_>>())
}

/// A prism of `count` sides, radius 1; flat where `half` is 0.
#[must_use]
pub fn disk(count: usize, half: f64) -> Body {
    let rim = (0..count).map(|i| {
        let angle = std::f64::consts::TAU * i as f64 / count as f64;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    });
    Body::of(&rim.flat_map(|p| [p + half * DVec3::Z, p - half * DVec3::Z]).collect::<Vec<_>>())
}
