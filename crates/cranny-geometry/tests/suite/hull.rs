//! Convex hulls of the point sets that break hull codes, all validated exactly.

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::VertexId;
use cranny_geometry::hull::{
    ConvexHull, HullError, HullKind, HullVertexId, HullViolation, Location,
};
use proptest::prelude::*;

/// A small generator of reproducible numbers (Marsaglia 2003, xorshift64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Uniform in [-1, 1).
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (2.0 / (1u64 << 53) as f64) - 1.0
    }

    fn on_sphere(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.signed(), self.signed(), self.signed());
            let l = p.length();
            if l > 0.1 && l < 1.0 {
                return p / l;
            }
        }
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, (self.next() % (i as u64 + 1)) as usize);
        }
    }
}

/// An arbitrary rotation; applying it rounds.
fn turned(points: &[DVec3]) -> Vec<DVec3> {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    points.iter().map(|&p| turn * p).collect()
}

fn lattice(n: i32, step: f64) -> Vec<DVec3> {
    let range = || 0..=n;
    range()
        .flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))))
        .map(|(x, y, z)| step * DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
        .collect()
}

fn subdivided_cube(n: i32) -> Vec<DVec3> {
    let mut points = lattice(n, 1.0 / f64::from(n));
    points.retain(|p| p.to_array().into_iter().any(|c| c == 0.0 || c == 1.0));
    points.iter().map(|&p| p - DVec3::splat(0.5)).collect()
}

fn circle(n: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
    (0..n).map(move |i| (std::f64::consts::TAU * i as f64 / n as f64).sin_cos())
}

fn uv_sphere(segments: usize, rings: usize) -> Vec<DVec3> {
    let mut points = vec![DVec3::Z, -DVec3::Z];
    for ring in 1..rings {
        let (r, z) = (std::f64::consts::PI * ring as f64 / rings as f64).sin_cos();
        points.extend(circle(segments).map(|(s, c)| DVec3::new(r * c, r * s, z)));
    }
    points
}

fn cylinder(segments: usize, layers: usize) -> Vec<DVec3> {
    (0..layers)
        .flat_map(|k| circle(segments).map(move |(s, c)| DVec3::new(c, s, k as f64 * 0.25)))
        .collect()
}

fn helix(n: usize) -> Vec<DVec3> {
    circle(64)
        .cycle()
        .take(n)
        .enumerate()
        .map(|(i, (s, c))| DVec3::new(c, s, 0.01 * i as f64))
        .collect()
}

/// Points along the six edges of a tetrahedron, most of them rounded off their edge.
fn tetrahedron_edges(n: u32) -> Vec<DVec3> {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.1, 0.0), DVec3::new(0.4, 0.2, 0.9)];
    let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    pairs
        .into_iter()
        .flat_map(|(i, j)| {
            (0..=n).map(move |k| corners[i].lerp(corners[j], f64::from(k) / f64::from(n)))
        })
        .collect()
}

/// Every family, by name, without turning.
fn families() -> Vec<(&'static str, Vec<DVec3>)> {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let cube = subdivided_cube(8);
    let doubled: Vec<DVec3> = cube.iter().chain(&cube).copied().collect();
    let mut cone = vec![3.0 * DVec3::Z, -DVec3::Z];
    cone.extend(circle(360).map(|(s, c)| DVec3::new(c, s, 0.0)));
    let mut capped = cylinder(96, 3);
    capped.extend([DVec3::ZERO, 0.5 * DVec3::Z]);
    let sliver = |z: f64| {
        lattice(3, 1.0).into_iter().map(|p| DVec3::new(p.x, p.y, p.z * z)).collect::<Vec<_>>()
    };
    let grids =
        lattice(12, 0.1).into_iter().filter(|p| (p.z * 10.0).round() % 4.0 == 0.0).collect();
    vec![
        ("subdivided cube", cube),
        ("integer lattice", lattice(7, 1.0)),
        ("duplicated points", doubled),
        ("sliver of 1e-9", sliver(1e-9)),
        ("sliver of 1e-16", sliver(1e-16)),
        ("UV sphere", uv_sphere(32, 16)),
        ("prism", cylinder(7, 2)),
        ("helix", helix(400)),
        ("cospherical", (0..2000).map(|_| random.on_sphere()).collect()),
        ("in a ball", (0..3000).map(|_| random.on_sphere() * random.signed()).collect()),
        ("cone fan", cone),
        ("cylinder fan", capped),
        ("stacked grids", grids),
        (
            "full lattice with a far point",
            lattice(9, 1.0).into_iter().chain([1e4 * DVec3::ONE]).collect(),
        ),
        (
            "two clusters far apart",
            (0..800)
                .map(|i| random.on_sphere() * 0.01 + f64::from(i % 2) * 100.0 * DVec3::X)
                .collect(),
        ),
        ("edges of a tetrahedron", tetrahedron_edges(40)),
        ("tetrahedron", vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]),
        (
            "thin wedge",
            vec![
                DVec3::ZERO,
                DVec3::X,
                DVec3::new(0.5, 1.0, 0.0),
                DVec3::new(0.5, 0.5, 1e-300f64.sqrt().sqrt().sqrt()),
                DVec3::new(0.25, 0.125, 0.0),
            ],
        ),
    ]
}

#[track_caller]
fn assert_valid(name: &str, points: &[DVec3]) -> ConvexHull {
    let hull = ConvexHull::of_points(points);
    let found = hull.validate(points);
    assert!(
        found.is_empty(),
        "{name}: {} violations, first {:?}",
        found.len(),
        &found[..found.len().min(4)]
    );
    let areas = hull.facets().map(|f| f.triangles.len()).sum::<usize>();
    assert_eq!(areas, hull.triangle_count(), "{name}: every triangle is in one facet");
    hull
}

#[test]
fn every_family_is_valid_as_it_is_turned_moved_and_scaled() {
    for (name, points) in families() {
        for (how, points) in [("plain", points.clone()), ("turned", turned(&points))] {
            let name = format!("{name}, {how}");
            let hull = assert_valid(&name, &points);
            assert_eq!(hull.kind(), HullKind::Volume, "{name}");
            let far: Vec<DVec3> = points.iter().map(|&p| p + DVec3::splat(1e6)).collect();
            assert_valid(&format!("{name}, at 1e6"), &far);
            for scale in [1e-20, 1e-6, 1e6] {
                let scaled: Vec<DVec3> = points.iter().map(|&p| scale * p).collect();
                assert_valid(&format!("{name}, times {scale:e}"), &scaled);
            }
        }
    }
}

/// The outlines of the facets as places, each from its least corner on, sorted: independent of ids.
fn outlines(hull: &ConvexHull) -> Vec<Vec<[u64; 3]>> {
    let place = |v: &HullVertexId| hull.position(*v).to_array().map(|c| (c + 0.0).to_bits());
    let mut outlines: Vec<Vec<[u64; 3]>> = hull
        .facets()
        .map(|facet| {
            let mut outline: Vec<_> = facet.corners.iter().map(place).collect();
            let least = (0..outline.len()).min_by_key(|&i| outline[i]).unwrap();
            outline.rotate_left(least);
            outline
        })
        .collect();
    outlines.sort_unstable();
    outlines
}

/// Thinner than the tolerance: how its sides are shared out to the two facets is arbitrary.
const AMBIGUOUS: &str = "sliver of 1e-16";

#[test]
fn powers_of_two_change_no_bit() {
    let scale = 2f64.powi(-66);
    for (name, points) in families() {
        for points in [points.clone(), turned(&points)] {
            let hull = ConvexHull::of_points(&points);
            let scaled: Vec<DVec3> = points.iter().map(|&p| scale * p).collect();
            let small = ConvexHull::of_points(&scaled);
            assert!(hull.source_triangles().eq(small.source_triangles()), "{name}");
            assert_eq!(hull.facet_count(), small.facet_count(), "{name}");
            for (facet, other) in hull.facets().zip(small.facets()) {
                assert_eq!(facet.normal, other.normal, "{name}");
                assert_eq!(facet.triangles, other.triangles, "{name}");
                assert_eq!(facet.corners, other.corners, "{name}");
                assert_eq!(facet.thickness * scale, other.thickness, "{name}");
            }
        }
    }
}

#[test]
fn the_order_of_points_changes_no_vertex_and_no_facet() {
    let mut random = Random(7);
    for (name, points) in families() {
        for mut points in [points.clone(), turned(&points)] {
            let hull = ConvexHull::of_points(&points);
            let places = |hull: &ConvexHull| {
                let mut bits: Vec<_> = hull
                    .positions()
                    .iter()
                    .map(|p| p.to_array().map(|c| (c + 0.0).to_bits()))
                    .collect();
                bits.sort_unstable();
                bits
            };
            random.shuffle(&mut points);
            let shuffled = ConvexHull::of_points(&points);
            assert_eq!(places(&hull), places(&shuffled), "{name}");
            if name != AMBIGUOUS {
                assert_eq!(outlines(&hull), outlines(&shuffled), "{name}");
            }
        }
    }
}

/// The least width of a facet's outline: over its edges, how far it reaches from the edge's line.
fn width(hull: &ConvexHull, corners: &[HullVertexId]) -> f64 {
    let at = |i: usize| hull.position(corners[i % corners.len()]);
    (0..corners.len()).fold(f64::INFINITY, |least, i| {
        let along = (at(i + 1) - at(i)).normalize();
        let reach = (0..corners.len()).map(|k| (at(k) - at(i)).cross(along).length());
        least.min(reach.fold(0.0, f64::max))
    })
}

#[test]
fn needles_are_no_facets_and_no_facet_is_thicker_than_the_tolerance() {
    for (name, points) in families() {
        for points in [points.clone(), turned(&points)] {
            let hull = ConvexHull::of_points(&points);
            assert!(hull.thickness_max() <= hull.flatness(), "{name}");
            for facet in hull.facets() {
                let width = width(&hull, facet.corners);
                assert!(width > hull.flatness(), "{name}: {width:e} {:?}", facet.triangles);
            }
            // Sides a billionth as wide as they are long have right normals all the same.
            assert!(!name.starts_with("sliver of 1e-9") || hull.facet_count() == 6, "{name}");
        }
    }
}

#[test]
fn ten_thousand_cospherical_points() {
    let mut random = Random(3);
    let points: Vec<DVec3> = (0..10_000).map(|_| random.on_sphere()).collect();
    for points in [points.clone(), turned(&points)] {
        let hull = assert_valid("cospherical", &points);
        assert_eq!(hull.vertex_count(), 10_000);
        assert!((hull.volume() / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 2e-3);
    }
}

#[test]
fn a_turned_and_rounded_subdivided_cube_has_six_facets() {
    for n in [1, 2, 3, 8, 16, 32] {
        let cube = subdivided_cube(n);
        let plain = assert_valid("cube", &cube);
        assert_eq!((plain.vertex_count(), plain.triangle_count(), plain.facet_count()), (8, 12, 6));
        let hull = assert_valid("turned cube", &turned(&cube));
        assert_eq!(hull.facet_count(), 6, "{n}");
        assert!(hull.facets().all(|f| f.corners.len() == 4), "{n}");
        assert!(hull.thickness_max() <= 8.0 * f64::EPSILON, "{n}: {:e}", hull.thickness_max());
        assert!((hull.volume() - 1.0).abs() < 1e-14 && (hull.area() - 6.0).abs() < 1e-14);
        assert!(hull.centroid().unwrap().length() < 1e-15);
        // Rounding made domes of the sides: without merging there would be more than six.
        assert!(n < 8 || ConvexHull::with_flatness(&turned(&cube), 0.0).facet_count() > 6);
        let far: Vec<DVec3> = turned(&cube).iter().map(|&p| p + DVec3::splat(1e6)).collect();
        assert_eq!(assert_valid("far cube", &far).facet_count(), 6, "{n}");
        let single: Vec<DVec3> = turned(&cube).iter().map(|p| p.as_vec3().as_dvec3()).collect();
        let hull = ConvexHull::with_flatness(&single, 2e-7);
        assert!(hull.validate(&single).is_empty());
        assert_eq!(hull.facet_count(), 6, "{n}, single precision");
    }
}

#[test]
fn real_creases_are_not_merged() {
    // A roof over a square, 1e-12 high: sixty times the tolerance, one ten-millionth of a degree.
    let mut roof = subdivided_cube(1);
    roof.push(DVec3::new(0.0, 0.0, 0.5 + 1e-12));
    assert_eq!(assert_valid("roof", &roof).facet_count(), 9);
    // A wedge so thin that each side is within the tolerance of the other's plane.
    let flat = 1e-15;
    let wedge = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, flat)];
    let hull = assert_valid("wedge", &wedge);
    assert_eq!(hull.kind(), HullKind::Volume);
    assert!(hull.facet_count() >= 2);
}

/// Two apexes over a ring of `n`: fans whose triangles share vertices of degree `n`.
fn bipyramid(n: usize) -> Vec<DVec3> {
    let ring = circle(n).map(|(s, c)| DVec3::new(c, s, 0.0));
    [DVec3::Z, -DVec3::Z].into_iter().chain(ring).collect()
}

#[test]
fn wide_fans_take_no_quadratic_time() {
    // Planes of crowded triangles are bounded, not measured: validated like the others.
    for points in [bipyramid(700), turned(&bipyramid(700))] {
        let hull = assert_valid("bipyramid", &points);
        assert_eq!((hull.vertex_count(), hull.facet_count()), (702, 1400));
        assert!(hull.thickness_max() < 1e-13);
    }
    // Measured, 50,000 neighbours for each of 100,000 triangles would take the better part of a
    // minute.
    assert_eq!(ConvexHull::of_points(&bipyramid(50_000)).triangle_count(), 100_000);
}

#[test]
fn facets_of_prisms_are_polygons() {
    let hull = assert_valid("prism", &turned(&cylinder(7, 3)));
    let mut sides: Vec<usize> = hull.facets().map(|f| f.corners.len()).collect();
    sides.sort_unstable();
    assert_eq!(sides, [4, 4, 4, 4, 4, 4, 4, 7, 7]);
    let ends: Vec<_> = hull.facets().filter(|f| f.corners.len() == 7).collect();
    assert!(ends[0].normal.dot(ends[1].normal) < -1.0 + 1e-14);
    for end in ends {
        assert!(end.neighbours.iter().all(|&side| hull.facet(side).corners.len() == 4));
    }
}

#[test]
fn flat_inputs_are_typed_results() {
    assert_eq!(assert_valid("nothing", &[]).kind(), HullKind::Empty);
    let point = assert_valid("point", &[DVec3::ONE; 4]);
    assert_eq!((point.kind(), point.vertex_count()), (HullKind::Point, 1));
    assert_eq!(point.sources()[0].index(), 0);
    assert_eq!(point.centroid(), Some(DVec3::ONE));
    assert_eq!(
        (point.locate(DVec3::ONE), point.locate(DVec3::ZERO)),
        (Location::On, Location::Outside)
    );

    let line: Vec<DVec3> = (0..9).map(|i| f64::from(i) * DVec3::new(0.5, -0.25, 1.0)).collect();
    let segment = assert_valid("line", &line);
    assert_eq!((segment.kind(), segment.vertex_count()), (HullKind::Segment, 2));
    assert_eq!(segment.source(segment.support(DVec3::Z, None).unwrap()).index(), 8);
    assert_eq!(segment.locate(line[3].map(|c| c * 1.5)), Location::On);
    assert_eq!(segment.locate(DVec3::new(0.5, -0.25, 1.0f64.next_up())), Location::Outside);

    let sheet: Vec<DVec3> = lattice(4, 1.0)
        .into_iter()
        .filter(|p| p.z == 0.0)
        .map(|p| DVec3::new(p.x, p.y, p.x + p.y))
        .collect();
    let plate = assert_valid("plane", &sheet);
    assert_eq!((plate.kind(), plate.vertex_count()), (HullKind::Polygon, 4));
    assert_eq!((plate.triangle_count(), plate.facet_count(), plate.volume()), (4, 2, 0.0));
    assert!((plate.area() - 32.0 * 3f64.sqrt()).abs() < 1e-12);
    assert_eq!(plate.locate(DVec3::new(1.5, 2.0, 3.5)), Location::On);
    assert_eq!(plate.locate(DVec3::new(1.5, 2.0, 3.5f64.next_up())), Location::Outside);
    assert_valid("disk", &turned(&cylinder(100, 1)));
    assert_valid("disk", &cylinder(100, 1));
}

#[test]
fn duplicates_count_as_their_lowest_index() {
    let cube = subdivided_cube(1);
    let mut points = vec![DVec3::ZERO];
    for _ in 0..3 {
        points.extend(cube.iter().rev());
    }
    let hull = assert_valid("cube in triplicate", &points);
    assert_eq!(hull.sources().iter().map(|v| v.0).collect::<Vec<_>>(), (1..=8).collect::<Vec<_>>());
}

#[test]
fn bad_coordinates_are_refused_or_set_aside() {
    let mut points = subdivided_cube(2);
    points.insert(3, DVec3::new(0.0, f64::NAN, 0.0));
    points.push(DVec3::splat(1e40));
    points.push(DVec3::new(1e-100, 0.0, f64::NEG_INFINITY));
    let error = ConvexHull::checked(&points).unwrap_err();
    assert!(matches!(error, HullError::Coordinate { point: 3, .. }));
    assert!(error.to_string().contains("coordinate y is NaN"));
    let hull = assert_valid("with bad points", &points);
    assert_eq!(hull.excluded().iter().map(|v| v.0).collect::<Vec<_>>(), [3, 27, 28]);
    assert_eq!((hull.vertex_count(), hull.volume()), (8, 1.0));
    assert!(hull.sources().iter().all(|v| v.0 != 3 && v.0 < 27));
    let nothing = ConvexHull::of_points(&[DVec3::NAN; 5]);
    assert_eq!((nothing.kind(), nothing.excluded().len()), (HullKind::Empty, 5));
}

#[test]
fn locate_is_exact_on_and_next_to_the_surface() {
    let hull = ConvexHull::of_points(&lattice(3, 0.1));
    let top = hull.bounds().max.z;
    assert_eq!(hull.locate(DVec3::new(0.1, 0.07, top)), Location::On);
    assert_eq!(hull.locate(DVec3::new(0.1, 0.07, top.next_down())), Location::Inside);
    assert_eq!(hull.locate(DVec3::new(0.1, 0.07, top.next_up())), Location::Outside);
    assert_eq!(hull.locate(DVec3::NAN), Location::Outside);
    let octahedron: Vec<DVec3> =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|a| [a, -a]).collect();
    let hull = ConvexHull::of_points(&octahedron);
    assert_eq!(hull.locate(DVec3::new(0.25, 0.25, 0.5)), Location::On);
    assert_eq!(hull.locate(DVec3::new(0.25, 0.25, 0.5f64.next_up())), Location::Outside);
    assert_eq!(hull.locate(DVec3::new(0.25, 0.25, 0.5f64.next_down())), Location::Inside);
}

#[test]
fn support_is_the_brute_force_maximum_from_every_start() {
    let mut random = Random(11);
    for (name, points) in families() {
        for points in [points.clone(), turned(&points)] {
            let hull = ConvexHull::of_points(&points);
            // Directions at random, along the axes, and straight at facets, where corners tie.
            let mut directions: Vec<DVec3> = (0..40).map(|_| random.on_sphere()).collect();
            directions.extend([
                DVec3::X,
                -DVec3::Y,
                DVec3::Z,
                DVec3::new(1.0, 1.0, 0.0),
                DVec3::ZERO,
            ]);
            directions.extend(hull.facets().take(40).map(|f| f.normal));
            directions.extend(directions.clone().iter().map(|&d| 1e-200 * d));
            for d in directions {
                let heights: Vec<f64> = hull.positions().iter().map(|&p| d.dot(p)).collect();
                let most = heights.iter().copied().fold(f64::MIN, f64::max);
                let expected =
                    heights.iter().position(|&h| h == most).map(|i| HullVertexId(i as u32));
                assert_eq!(hull.support(d, None), expected, "{name} {d}");
                for _ in 0..4 {
                    let start = HullVertexId((random.next() % hull.vertex_count() as u64) as u32);
                    assert_eq!(hull.support(d, Some(start)), expected, "{name} {d} from {start:?}");
                }
            }
            assert!(hull.support(DVec3::NAN, None).is_some());
            assert!(hull.support(DVec3::splat(f64::INFINITY), None).is_some());
        }
    }
}

#[test]
fn validate_finds_what_is_wrong() {
    let points = subdivided_cube(2);
    let hull = ConvexHull::of_points(&points);
    let mut moved = points.clone();
    moved[0] *= 2.0; // a corner: now its vertex is elsewhere, and the point outside
    let found = hull.validate(&moved);
    assert!(found.iter().any(|v| matches!(v, HullViolation::WrongSource(_))));
    assert!(found.iter().any(|v| matches!(v, HullViolation::PointOutside(p) if p.0 == 0)));
}

/// Points of a small lattice: nearly every subset of them is degenerate.
fn lattice_points() -> impl Strategy<Value = Vec<DVec3>> {
    let coordinate = -3i32..=3;
    let point = (coordinate.clone(), coordinate.clone(), coordinate);
    prop::collection::vec(
        point.prop_map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z))),
        0..60,
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn lattice_points_have_valid_hulls(points in lattice_points()) {
        let hull = ConvexHull::of_points(&points);
        prop_assert_eq!(hull.validate(&points), vec![]);
        let turned = turned(&points);
        let hull = ConvexHull::of_points(&turned);
        prop_assert_eq!(hull.validate(&turned), vec![]);
    }

    #[test]
    fn points_a_few_ulps_from_a_lattice_have_valid_hulls(
        points in lattice_points(), ulps in prop::collection::vec(-2i8..=2, 180)
    ) {
        let nudge = |x: f64, n: i8| (0..n.abs()).fold(x, |x, _| if n > 0 { x.next_up() } else { x.next_down() });
        let nudged: Vec<DVec3> = points
            .iter()
            .zip(ulps.chunks(3))
            .map(|(p, n)| {
                let p = 0.1 * (*p + DVec3::splat(7.0));
                DVec3::new(nudge(p.x, n[0]), nudge(p.y, n[1]), nudge(p.z, n[2]))
            })
            .collect();
        let hull = ConvexHull::of_points(&nudged);
        prop_assert_eq!(hull.validate(&nudged), vec![]);
    }
}

#[test]
fn triangles_of_the_hull_are_found_from_any_corner_but_not_turned_over() {
    // Point 0 is inside the tetrahedron of the others.
    let p = [0.25 * DVec3::ONE, DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y, 2.0 * DVec3::Z];
    let hull = ConvexHull::of_points(&p);
    let mut triangles = Vec::new();
    for corners in [[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]] {
        let [a, b, c] = corners.map(VertexId);
        let found = hull.triangle_of([a, b, c]);
        triangles.extend(found);
        assert_eq!(found, hull.triangle_of([b, c, a]));
        assert_eq!(found, hull.triangle_of([c, a, b]));
        assert_eq!(hull.triangle_of([b, a, c]), None);
        assert_eq!(hull.triangle_of([VertexId(0), b, c]), None);
    }
    triangles.sort_unstable();
    assert_eq!(triangles, [0, 1, 2, 3]);
}
