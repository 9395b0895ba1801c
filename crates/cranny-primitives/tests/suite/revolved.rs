//! Solids of revolution, judged by nested searches that know of a core only how wide it is at a
//! height.

use cranny_exact::{Aabb, DVec2, DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_primitives::revolved::{Revolved, nearest_face};
use cranny_shapes::{Cuboid, Torus};
use cranny_testkit::Rng;

/// A solid as the oracle sees it.
struct Told {
    name: &'static str,
    middle: DVec3,
    axis: DVec3,
    /// Radii at the lowest and the highest point of the core, and half its height.
    radii: [f64; 2],
    half: f64,
    border: f64,
}

impl Told {
    fn solid(&self) -> Revolved {
        let Self { middle, axis, radii: [low, high], half, border, .. } = *self;
        match (low, high) {
            (0.0, 0.0) => Revolved::segment([middle - axis * half, middle + axis * half], border),
            (r, 0.0) => Revolved::cone(middle, axis, half, r, border),
            (r, _) => Revolved::cylinder(middle, axis, half, r, border),
        }
    }

    fn width_at(&self, height: f64) -> f64 {
        if self.half == 0.0 {
            return self.radii[0].max(self.radii[1]);
        }
        let share = (0.5 * (height / self.half + 1.0)).clamp(0.0, 1.0);
        self.radii[0] + (self.radii[1] - self.radii[0]) * share
    }

    fn flat(&self, p: DVec3) -> DVec2 {
        let z = self.axis.dot(p - self.middle);
        DVec2::new((p - self.middle).cross(self.axis).length(), z)
    }

    /// From the core; 0 inside.
    fn distance_of_point(&self, p: DVec3) -> f64 {
        let flat = self.flat(p);
        let at = |z: f64| {
            let r = flat.x.min(self.width_at(z));
            flat.distance(DVec2::new(r, z))
        };
        golden(-self.half, self.half, at)
    }

    /// From a triangle, by a search in a search.
    fn distance_of_triangle(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        golden(0.0, 1.0, |u| {
            golden(0.0, 1.0 - u, |v| self.distance_of_point(a + (b - a) * u + (c - a) * v))
        })
    }

    /// The greatest product of a point of the core with a direction, by its rims from many sides.
    fn reach(&self, direction: DVec3) -> f64 {
        let u = self.axis.any_orthonormal_vector();
        let v = self.axis.cross(u);
        let ends = [(-self.half, self.radii[0]), (self.half, self.radii[1])];
        let rim = |(z, r): (f64, f64)| {
            (0..40_000).map(move |k| {
                let (s, c) = (std::f64::consts::TAU * f64::from(k) / 40_000.0).sin_cos();
                direction.dot(self.middle + self.axis * z + (u * c + v * s) * r)
            })
        };
        ends.into_iter().flat_map(rim).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The least of a convex function.
fn golden(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut x, mut y) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut fx, mut fy) = (f(x), f(y));
    let mut best = f(low).min(f(high)).min(fx).min(fy);
    for _ in 0..48 {
        if fx <= fy {
            (high, y, fy) = (y, x, fx);
            x = high - SHARE * (high - low);
            fx = f(x);
        } else {
            (low, x, fx) = (x, y, fy);
            y = low + SHARE * (high - low);
            fy = f(y);
        }
        best = best.min(fx).min(fy);
    }
    best
}

fn vector(rng: &mut Rng) -> DVec3 {
    DVec3::new(rng.unit(), rng.unit(), rng.unit())
}

/// Of all kinds, flat and thin ones among them, in all directions and along the axes.
fn solids(rng: &mut Rng) -> Vec<Told> {
    let kinds = [
        ("point", [0.0, 0.0], 0.0),
        ("segment", [0.0, 0.0], 0.7),
        ("cylinder", [0.5, 0.5], 0.7),
        ("flat cylinder", [0.8, 0.8], 0.01),
        ("thin cylinder", [0.01, 0.01], 0.8),
        ("nearly a disc", [0.8, 0.8], 1e-9),
        ("disc", [0.8, 0.8], 0.0),
        ("cone", [0.5, 0.0], 0.7),
        ("flat cone", [0.8, 0.0], 0.02),
        ("needle", [0.02, 0.0], 0.9),
    ];
    let mut all = Vec::new();
    for (name, radii, half) in kinds {
        for k in 0..4 {
            let axis = match k {
                0 => DVec3::Z,
                1 => -DVec3::X,
                _ => vector(rng).normalize(),
            };
            let border = if k % 2 == 0 { 0.0 } else { 0.1 };
            all.push(Told { name, middle: vector(rng) * 0.3, axis, radii, half, border });
        }
    }
    all
}

#[test]
fn feet_of_points_are_the_nearest() {
    let mut rng = Rng::new(61);
    for reported in solids(&mut rng) {
        let solid = reported.solid();
        for k in 0..300 {
            // At random; and on planes, circles and lines where one part of the core gives way to
            // another.
            let p = match k % 3 {
                0 => reported.middle + vector(&mut rng) * 1.2,
                1 => reported.middle + reported.axis * (rng.unit() * 1.2),
                _ => {
                    let side = reported.axis.any_orthonormal_vector();
                    let z = [0.0, 1.0, -1.0, 0.5][rng.below(4)] * reported.half;
                    let r = [0.0, 1.0, 0.5, 1.0 + 1e-12][rng.below(4)] * reported.radii[0];
                    reported.middle + reported.axis * z + side * r
                }
            };
            let foot = solid.core_foot(p);
            let what = format!("{} of {p}: {foot:?}", reported.name);
            assert!((foot.outward.length() - 1.0).abs() < 1e-12, "{what}");
            let off = reported.distance_of_point(foot.point);
            assert!(off < 1e-9, "{what}: {off} off the core");
            let oracle = reported.distance_of_point(p);
            assert!((foot.signed.max(0.0) - oracle).abs() < 1e-9, "{what}: {oracle}");
            // The way is along the normal, which no point of the core lies beyond.
            let way = p - foot.point;
            assert!((way - foot.outward * foot.signed).length() < 1e-9, "{what}");
            let beyond = solid.core_reach(foot.outward) - foot.outward.dot(foot.point);
            // What a rounded way of that length may lean by.
            let leaning = if foot.signed > 1e-13 { 1e-15 / foot.signed } else { 0.0 };
            assert!(beyond.abs() < 1e-9 + leaning, "{what}: {beyond} beyond");
            if foot.signed < -1e-6 {
                // A ball of that radius fits in, and a greater one does not.
                for _ in 0..20 {
                    let way = vector(&mut rng).normalize() * -foot.signed;
                    assert!(reported.distance_of_point(p + way) < 1e-9, "{what}");
                }
                let out = p + foot.outward * (1e-6 - foot.signed);
                assert!(reported.distance_of_point(out) > 1e-7, "{what}");
            }
        }
    }
}

#[test]
fn reach_is_that_of_the_farthest_point() {
    let mut rng = Rng::new(62);
    for reported in solids(&mut rng) {
        let solid = reported.solid();
        let random = [(); 12].map(|()| vector(&mut rng).normalize());
        for direction in
            random.into_iter().chain([reported.axis, -reported.axis, DVec3::X, -DVec3::Z])
        {
            let (reach, oracle) = (solid.core_reach(direction), reported.reach(direction));
            assert!((reach - oracle).abs() < 1e-7, "{}: {reach} and {oracle}", reported.name);
            let support = solid.core_support(direction);
            assert!((direction.dot(support) - reach).abs() < 1e-12, "{}", reported.name);
            assert!(reported.distance_of_point(support) < 1e-9, "{}: {support}", reported.name);
        }
    }
}

#[test]
fn triangles_are_as_far_as_a_search_says() {
    let mut rng = Rng::new(63);
    let (mut apart, mut through) = (0, 0);
    for reported in solids(&mut rng) {
        let solid = reported.solid();
        for k in 0..12 {
            let place = reported.middle + vector(&mut rng) * [0.8, 0.3][k % 2];
            let size = [0.05, 0.5, 3.0][k % 3];
            let mut triangle = [(); 3].map(|()| place + vector(&mut rng) * size);
            match k {
                // Without area, square to the axis, along it.
                9 => triangle[2] = triangle[0] + (triangle[1] - triangle[0]) * 0.3,
                10 => triangle = triangle.map(|p| p - reported.axis * reported.axis.dot(p - place)),
                11 => triangle[1] = triangle[0] + reported.axis * size,
                _ => {}
            }
            let least = solid.least_on_triangle(&triangle);
            let oracle = reported.distance_of_triangle(triangle);
            let what = format!("{} and {triangle:?}: {least:?}", reported.name);
            assert!((least.signed.max(0.0) - oracle).abs() < 1e-7, "{what}: {oracle}");
            let signed = solid.core_foot(least.point).signed;
            assert!((signed - least.signed).abs() < 1e-9, "{what}: {signed} there");
            let (on, _) =
                cranny_geometry::triangle_distance::closest_on_triangle(least.point, &triangle);
            assert!(on.distance(least.point) < 1e-12 * (1.0 + size), "{what}: off the triangle");
            if least.signed > 1e-9 {
                let outward = least.outward.expect("apart");
                let way = least.point - least.on_core;
                assert!((way - outward * least.signed).length() < 1e-6, "{what}");
                apart += 1;
            } else {
                through += 1;
            }
        }
    }
    assert!(apart > 100 && through > 80, "{apart} {through}");
}

/// Where a triangle cuts the core, the least is that of all its points: sampled, and at the sides'
/// own.
#[test]
fn no_point_of_a_triangle_is_deeper() {
    let mut rng = Rng::new(64);
    let mut inside = 0;
    for reported in solids(&mut rng) {
        let solid = reported.solid();
        for _ in 0..40 {
            let place = reported.middle
                + reported.axis * (rng.unit() * reported.half)
                + vector(&mut rng) * 0.1;
            let triangle = [(); 3].map(|()| place + vector(&mut rng) * 0.5);
            let least = solid.least_on_triangle(&triangle);
            inside += usize::from(least.signed < -1e-3);
            let [a, b, c] = triangle;
            for i in 0..=40 {
                for j in 0..=(40 - i) {
                    let p = a + (b - a) * (f64::from(i) / 40.0) + (c - a) * (f64::from(j) / 40.0);
                    let signed = solid.core_foot(p).signed;
                    assert!(signed >= least.signed - 1e-12, "{}: {least:?} at {p}", reported.name);
                }
            }
        }
    }
    assert!(inside > 200, "{inside}");
}

fn built(mesh: cranny_geometry::Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).expect("a mesh of the tests").0
}

#[test]
fn the_nearest_face_is_that_of_all_faces() {
    let torus = Torus { major_segments: 24, minor_segments: 12, ..Torus::default() };
    let model = built(torus.build().expect("defaults"));
    let mut rng = Rng::new(65);
    let (mut apart, mut meeting) = (0, 0);
    for _ in 0..8 {
        for reported in solids(&mut rng) {
            let reported = Told { middle: vector(&mut rng) * 1.6, ..reported };
            let solid = reported.solid();
            let faces = (0..model.mesh().faces().len() as u32).map(cranny_geometry::FaceId);
            let all = faces.map(|f| solid.least_on_triangle(&model.mesh().triangle(f)).signed);
            let truth = all.fold(f64::INFINITY, f64::min) - reported.border;
            let found = nearest_face(&model, &solid, f64::INFINITY).expect("there are faces");
            let what = format!("{}: {found:?}, {truth}", reported.name);
            if truth > 1e-12 {
                apart += 1;
                assert_eq!(found.distance, truth, "{what}");
                assert!((found.on_model.distance(found.on_solid) - truth).abs() < 1e-9, "{what}");
                let off = reported.distance_of_point(found.on_solid) - reported.border;
                assert!(off.abs() < 1e-9, "{what}: off by {off}");
                assert!(nearest_face(&model, &solid, truth).is_some(), "{what}");
                assert!(nearest_face(&model, &solid, 0.999 * truth).is_none(), "{what}");
            } else {
                meeting += 1;
                assert!(found.distance <= 0.0, "{what}");
                assert!(nearest_face(&model, &solid, 0.0).is_some(), "{what}");
            }
            let bounds = solid.bounds();
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let reach = |d: DVec3| reported.reach(d) + reported.border;
                assert!((bounds.max.dot(axis) - reach(axis)).abs() < 1e-7, "{what}");
                assert!((bounds.min.dot(axis) + reach(-axis)).abs() < 1e-7, "{what}");
            }
        }
    }
    assert!(apart > 100 && meeting > 40, "{apart} {meeting}");
}

/// A cylinder holds the prism that is inscribed in it, and is held by the one around it: between
/// the exact distances of both.
#[test]
fn a_cylinder_lies_between_two_prisms() {
    let slab = built(Cuboid { size: [1.0, 0.6, 0.4] }.build().expect("a cuboid"));
    let prism = |radius: f64| {
        const SIDES: u32 = 64;
        let ring = |z: f64| {
            (0..SIDES).map(move |k| {
                let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(SIDES)).sin_cos();
                DVec3::new(radius * c, radius * s, z)
            })
        };
        let vertices = ring(-0.5).chain(ring(0.5)).collect();
        let mut faces = Vec::new();
        for k in 0..SIDES {
            let (a, b) = (k, (k + 1) % SIDES);
            faces.extend([[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]);
            if k > 0 && k + 1 < SIDES {
                faces.extend([[0, b, a], [SIDES, a + SIDES, b + SIDES]]);
            }
        }
        built(cranny_geometry::Mesh::new(vertices, faces).expect("in range"))
    };
    let around = 0.3 / (std::f64::consts::PI / 64.0).cos();
    let (inner, outer) = (prism(0.3), prism(around));
    let mut rng = Rng::new(66);
    let mut apart = 0;
    for _ in 0..200 {
        let pose = Pose { translation: vector(&mut rng) * 1.2, rotation: rng.rotation() };
        let exact = |model: &Model| {
            let a = Placed { model: &slab, pose: Pose::IDENTITY };
            let ask = Query::of(Demand::Distance { below: None });
            let answer = query(a, Placed { model, pose }, &ask, &mut PairMemory::default());
            let answer = answer.expect("valid poses");
            if answer.solid { 0.0 } else { answer.distance.unwrap_or(0.0) }
        };
        let map = pose.world_from_body();
        let axis = map.apply_vector(DVec3::Z);
        let solid = Revolved::cylinder(pose.translation, axis, 0.5, 0.3, 0.0);
        let found = nearest_face(&slab, &solid, f64::INFINITY).expect("faces").distance.max(0.0);
        let (far, near) = (exact(&inner), exact(&outer));
        if near > 0.0 {
            assert!((near - 1e-12..=far + 1e-12).contains(&found), "{found}: {near} to {far}");
            apart += 1;
        }
    }
    assert!(apart > 50, "{apart}");
}

/// The border is not in the way of a point far off: boxes of a far model are judged by where they
/// are.
#[test]
fn an_empty_window_has_no_face() {
    let slab = built(Cuboid { size: [1.0, 1.0, 1.0] }.build().expect("a cuboid"));
    let solid = Revolved::cone(DVec3::new(1e6, 0.0, 0.0), DVec3::Y, 0.5, 0.5, 0.0);
    assert!(nearest_face(&slab, &solid, 1.0).is_none());
    assert!(Aabb::of_points([DVec3::ZERO]).overlaps(&slab.bounds()));
}
