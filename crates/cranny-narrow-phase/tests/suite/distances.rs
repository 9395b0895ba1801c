//! Distances of needles, slivers and edges that are nearly parallel, against exact rationals.

use cranny_exact::{DVec3, Meeting, Pose, orient3d};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{Demand, Placed};
use cranny_testkit::{Family, Q, Rng, is_root_within, rational_distance_squared};

use crate::solids::{ask, model};

/// What the head of `triangle_distance` promises, in units of rounding of the largest coordinate;
/// the worst of the cases here has 1.3. A certified interval is wider by the rounding of posing.
const ULPS: f64 = 2.0;

fn sheet(triangle: &[DVec3; 3]) -> Model {
    model(Mesh::new(triangle.to_vec(), vec![[0, 1, 2]]).unwrap())
}

/// A triangle without area is co-planar with every point.
fn has_area(t: &[DVec3; 3]) -> bool {
    let off = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    off.into_iter().any(|o| !orient3d(t[0], t[1], t[2], o).is_zero())
}

/// The distance and the certified interval of two triangles against the oracle.
fn agrees(a: &[DVec3; 3], b: &[DVec3; 3], what: &str) {
    if !has_area(a) || !has_area(b) {
        return; // no model holds just such a face
    }
    let exact = rational_distance_squared(a, b);
    let (sheet_a, sheet_b) = (sheet(a), sheet(b));
    let here = |model| Placed { model, pose: Pose::IDENTITY };
    let found = ask(here(&sheet_a), here(&sheet_b), Demand::Distance { below: None });
    let distance = found.distance.unwrap();
    let largest = a.iter().chain(b).map(|p| p.length()).fold(0.0, f64::max);
    let error = ULPS * f64::EPSILON * largest;
    assert!(
        is_root_within(distance, &exact, error),
        "{what}: {distance:e} of {a:?} and {b:?}; the square is {:e}",
        exact.to_f64().value()
    );
    let between = |low: f64, high: f64| {
        let square = |x: f64| Q::try_from(x).unwrap() * Q::try_from(x).unwrap();
        square(low.max(0.0)) <= exact && exact <= square(high)
    };
    assert!(between(found.separation.lo, found.separation.hi), "{what}: {:?}", found.separation);
    assert_eq!(found.surface == Meeting::None, exact > Q::ZERO, "{what}");
}

/// Up to three times a power of ten between two.
fn magnitude(rng: &mut Rng, low: i32, high: i32) -> f64 {
    (2.0 + rng.unit()) * 10f64.powi(rng.between(low, high))
}

/// An orthonormal frame, at random.
fn frame(rng: &mut Rng) -> [DVec3; 3] {
    let x = rng.direction();
    let y = x.cross(rng.direction()).normalize();
    [x, y, x.cross(y)]
}

/// A triangle of length `scale` and width `width` in the plane of `x` and `y`: blunt or a needle.
fn sliver(rng: &mut Rng, [x, y]: [DVec3; 2], scale: f64, width: f64) -> [DVec3; 3] {
    let apex = match rng.below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => 0.5 + 0.6 * rng.unit(),
    };
    let mut t = [DVec3::ZERO, scale * x, scale * apex * x + width * y];
    t.rotate_left(rng.below(3));
    t
}

/// A point of a triangle, often on its rim (rounded).
fn inner(rng: &mut Rng, t: &[DVec3; 3]) -> DVec3 {
    let mut weights = [0; 3].map(|_| if rng.below(5) == 0 { 0.0 } else { 1.0 + rng.unit() });
    weights[rng.below(3)] += 0.1;
    let total: f64 = weights.iter().sum();
    (0..3).map(|i| t[i] * (weights[i] / total)).sum()
}

#[test]
fn a_corner_over_a_sliver_agrees_with_rationals() {
    let mut rng = Rng::new(40);
    for _ in 0..1000 {
        let [x, y, z] = frame(&mut rng);
        let scale = magnitude(&mut rng, -6, 6);
        let width = scale * magnitude(&mut rng, -16, 0);
        let height = scale * magnitude(&mut rng, -14, 1);
        let t = sliver(&mut rng, [x, y], scale, width);
        let over = inner(&mut rng, &t) + width * rng.unit() * y * f64::from(rng.between(0, 1));
        let p = over + height * z;
        let mut arm = || p + scale * (0.5 * z + 0.3 * rng.unit() * x + 0.3 * rng.unit() * y);
        let mut other = [p, arm(), arm()];
        other.rotate_left(rng.below(3));
        agrees(&t, &other, "corner over a sliver");
    }
}

#[test]
fn edges_that_are_nearly_parallel_agree_with_rationals() {
    let mut rng = Rng::new(41);
    for _ in 0..1000 {
        let [x, y, z] = frame(&mut rng);
        let scale = magnitude(&mut rng, -6, 6);
        let angle = magnitude(&mut rng, -17, 0);
        let height = scale * magnitude(&mut rng, -14, 1);
        let d = x + angle * y;
        let (s, t) = (scale * rng.unit(), scale * rng.unit());
        let lengths = [magnitude(&mut rng, -3, 0), magnitude(&mut rng, -3, 0)].map(|l| l * scale);
        let lower = [s * x, s * x - lengths[0] * x, -scale * z + scale * rng.unit() * y];
        let low = height * z + t * d;
        let upper = [low, low + lengths[1] * d, (height + scale) * z + scale * rng.unit() * y];
        agrees(&lower, &upper, "edges at a small angle");
    }
}

#[test]
fn slivers_near_slivers_agree_with_rationals() {
    let mut rng = Rng::new(42);
    for _ in 0..800 {
        let scale = magnitude(&mut rng, -6, 6);
        let [x, y, z] = frame(&mut rng);
        let [u, v, w] = if rng.below(2) == 0 {
            let tilt = magnitude(&mut rng, -16, 0);
            [x + tilt * y, y - tilt * z, z + tilt * x]
        } else {
            frame(&mut rng)
        };
        let widths = [magnitude(&mut rng, -16, 0), magnitude(&mut rng, -16, 0)].map(|w| w * scale);
        let a = sliver(&mut rng, [x, y], scale, widths[0]);
        let b = sliver(&mut rng, [u, v], scale, widths[1]);
        let gap = scale * magnitude(&mut rng, -14, 1);
        let offset = inner(&mut rng, &a) - inner(&mut rng, &b) + gap * (w + 0.1 * rng.unit() * u);
        agrees(&a, &b.map(|p| p + offset), "two slivers");
    }
}

#[test]
fn degenerate_pairs_agree_with_rationals() {
    let mut rng = Rng::new(43);
    for family in Family::ALL {
        for _ in 0..60 {
            let (a, b) = family.pair(&mut rng);
            agrees(&a, &b, "as made");
            let shift = DVec3::new(rng.unit(), rng.unit(), rng.unit()) * magnitude(&mut rng, -9, 1);
            agrees(&a, &b.map(|p| p + shift), "moved");
        }
    }
}

#[test]
fn a_closed_needle_below_a_corner_is_at_the_distance_that_its_face_is() {
    // The point stands over the face's inside, so its height is the distance, exactly.
    let mut rng = Rng::new(44);
    let faces = vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
    for power in 3..9 {
        for height in [1.0, 1e-2, 1e-4, 1e-6, 1e-9] {
            let w = 10f64.powi(-power);
            let needle =
                [DVec3::ZERO, DVec3::X, DVec3::new(0.5, w, 0.0), DVec3::new(0.5, w / 3.0, -1.0)];
            let needle = model(Mesh::new(needle.to_vec(), faces.clone()).unwrap());
            for _ in 0..20 {
                let p =
                    DVec3::new(0.5 + 0.2 * rng.unit(), 0.5 * w * (0.5 + 0.4 * rng.unit()), height);
                let arms = [DVec3::new(0.01, 0.0, 0.1), DVec3::new(0.0, 0.01, 0.1)];
                let tip = [p, p + arms[0], p + arms[1], p + arms[0] + DVec3::new(0.0, 0.01, 0.0)];
                let tip = model(Mesh::new(tip.to_vec(), faces.clone()).unwrap());
                let here = |model| Placed { model, pose: Pose::IDENTITY };
                let found = ask(here(&needle), here(&tip), Demand::Distance { below: None });
                let distance = found.distance.unwrap();
                assert!((distance - height).abs() <= ULPS * f64::EPSILON, "{w:e}: {distance:e}");
                assert!(found.separation.contains(height));
            }
        }
    }
}
