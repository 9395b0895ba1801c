//! Three contacts by which a solver leads a body along one way without turning it.
//!
//! A solver takes contacts one after the other, and in each substep but once. What it lifts at a
//! corner turns about the middle, and goes down again where the next corner is lifted: bodies led
//! by their corners leaned by degrees, whichever corners, and stayed so, since what is lifted last
//! is always lifted best. So a body is led where no impulse moves the place of another: at centres
//! of percussion of each other. Of impulses along n at x and y (from the centre of mass, square to
//! n) that is where 1/m + (x × n) · I⁻¹ (y × n) = 0, and for three places that turn by a third
//! about the centre each pair is such. Where the partner moves too, this holds for the led body's
//! part alone.

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::Model;

/// Directions in a plane that differ by a third of a turn, √2 long: products of two are −1.
const THIRDS: [[f64; 2]; 3] = [
    [std::f64::consts::SQRT_2, 0.0],
    [-std::f64::consts::FRAC_1_SQRT_2, SQRT_3_2],
    [-std::f64::consts::FRAC_1_SQRT_2, -SQRT_3_2],
];

/// √(3/2).
const SQRT_3_2: f64 = 1.224_744_871_391_589;

/// Places in a model's frame, in the plane through its centre of mass that is square to a unit
/// normal. A model that bounds no solid is led as if its mass were in its vertices; what has no
/// width across the normal, at its centre.
#[must_use]
pub fn percussion_centers(model: &Model, normal: DVec3) -> [DVec3; 3] {
    let solid = model.mass_properties().filter(|mass| mass.volume > 0.0);
    let (center, gyration) = match solid {
        Some(mass) => (mass.center, mass.inertia * (1.0 / mass.volume)),
        None => of_vertices(model),
    };
    around(gyration, normal).map(|offset| center + offset)
}

/// Mean of the vertices, and their inertia about it over their mass.
fn of_vertices(model: &Model) -> (DVec3, DMat3) {
    let vertices = model.mesh().vertices();
    let share = 1.0 / vertices.len() as f64;
    let center = vertices.iter().sum::<DVec3>() * share;
    let inertia = vertices.iter().fold(DMat3::ZERO, |sum, &p| {
        let r = p - center;
        let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        sum + DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer
    });
    (center, inertia * share)
}

/// Offsets from the centre of mass for an inertia per mass.
fn around(gyration: DMat3, normal: DVec3) -> [DVec3; 3] {
    let (u, v) = normal.any_orthonormal_pair();
    let inverse = gyration.inverse();
    // Of offsets a u + b v: (x × n) · G⁻¹ (y × n), as a form in (a, b).
    let [along_u, along_v] = [u.cross(normal), v.cross(normal)];
    let form = [
        along_u.dot(inverse * along_u),
        along_u.dot(inverse * along_v),
        along_v.dot(inverse * along_v),
    ];
    let Some([p, q, r]) = inverse_root(form) else {
        return [DVec3::ZERO; 3];
    };
    THIRDS.map(|[a, b]| (p * a + q * b) * u + (q * a + r * b) * v)
}

/// The root of the inverse of a symmetric form [xx, xy, yy]; `None` where it is not positive and
/// finite.
fn inverse_root([xx, xy, yy]: [f64; 3]) -> Option<[f64; 3]> {
    let root = (xx * yy - xy * xy).sqrt();
    // Of the inverse (Cayley-Hamilton: root(S) = (S + √det S) / √(tr S + 2 √det S)).
    let [p, q, r] = [(yy / root + 1.0) / root, -xy / (root * root), (xx / root + 1.0) / root];
    let scale = 1.0 / ((xx + yy) / (root * root) + 2.0 / root).sqrt();
    let found = [p * scale, q * scale, r * scale];
    (root > 0.0 && found.iter().all(|x| x.is_finite())).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DQuat;
    use cranny_geometry::BuildOptions;
    use cranny_shapes::{Cuboid, Cup, LPrism, Shape};

    fn built(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    /// What an impulse of 1/m along the normal at one place gives the speed of another.
    fn moved(model: &Model, normal: DVec3, at: DVec3, of: DVec3) -> f64 {
        let mass = model.mass_properties().unwrap();
        let inverse = (mass.inertia * (1.0 / mass.volume)).inverse();
        let arm = |p: DVec3| (p - mass.center).cross(normal);
        1.0 + arm(at).dot(inverse * arm(of))
    }

    #[test]
    fn an_impulse_at_one_place_does_not_move_the_others() {
        let bodies = [
            built(Cuboid { size: [3.0, 1.0, 0.2] }),
            built(LPrism::default()),
            built(Cup { segments: 9, ..Cup::default() }),
        ];
        for model in &bodies {
            for k in 0..20 {
                let turn = DVec3::new(0.3, 0.7, -0.4) * f64::from(k);
                let normal = DQuat::from_scaled_axis(turn) * DVec3::Z;
                let places = percussion_centers(model, normal);
                let center = model.mass_properties().unwrap().center;
                for i in 0..3 {
                    assert!(normal.dot(places[i] - center).abs() < 1e-9);
                    for j in 0..3 {
                        let moves = moved(model, normal, places[i], places[j]);
                        // 1 + 2: as easily as three places of a third of the mass each.
                        let expected = if i == j { 3.0 } else { 0.0 };
                        assert!((moves - expected).abs() < 1e-9, "{k}: {moves}");
                    }
                }
            }
        }
    }

    /// A cube's gyration is a sixth of its squared side: places lie 1/√3 from its centre.
    #[test]
    fn a_cube_is_led_at_known_places() {
        let cube = built(Cuboid { size: [1.0, 1.0, 1.0] });
        for place in percussion_centers(&cube, DVec3::X) {
            assert!((place.length() - 3f64.sqrt().recip()).abs() < 1e-12, "{place}");
        }
    }

    #[test]
    fn what_has_no_width_is_led_at_its_centre() {
        assert_eq!(around(DMat3::ZERO, DVec3::Z), [DVec3::ZERO; 3]);
    }
}
