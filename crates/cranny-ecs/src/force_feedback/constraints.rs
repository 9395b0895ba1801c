//! The motion nearest to a wanted one that linear constraints allow.

/// How often the constraints are gone through. More: a tick takes longer; fewer: in a narrow wedge
/// the motion found still enters both flanks, and is then shortened.
const SWEEPS: usize = 128;

/// A motion: a translation, and a rotation vector times a length.
pub(super) type Twist = [f64; 6];

/// `along` · motion >= `least`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraint {
    pub(super) along: Twist,
    pub(super) least: f64,
}

pub(super) fn dot([a, b, c, d, e, f]: &Twist, [u, v, w, x, y, z]: &Twist) -> f64 {
    a * u + b * v + c * w + d * x + e * y + f * z
}

pub(super) fn scaled(a: &Twist, by: f64) -> Twist {
    a.map(|x| by * x)
}

/// The motion of least distance to `wanted` that the constraints allow (Hildreth, 1957: one
/// multiplier after the other, each at its best).
pub(super) fn nearest_allowed(wanted: &Twist, constraints: &[Constraint]) -> Twist {
    let mut motion = *wanted;
    let squares: Vec<f64> = constraints.iter().map(|c| dot(&c.along, &c.along)).collect();
    let mut multipliers = vec![0.0; constraints.len()];
    for _ in 0..SWEEPS {
        let mut changed = false;
        for ((multiplier, constraint), square) in
            multipliers.iter_mut().zip(constraints).zip(&squares)
        {
            let lacking = (constraint.least - dot(&constraint.along, &motion)) / square;
            let change = lacking.max(-*multiplier);
            if change == 0.0 {
                continue;
            }
            changed = true;
            *multiplier += change;
            for (x, along) in motion.iter_mut().zip(constraint.along) {
                *x += change * along;
            }
        }
        if !changed {
            break;
        }
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::*;

    fn upward(along: [f64; 3], least: f64) -> Constraint {
        let [x, y, z] = along;
        Constraint { along: [x, y, z, 0.0, 0.0, 0.0], least }
    }

    fn close(found: Twist, expected: [f64; 3]) -> bool {
        found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-9)
    }

    #[test]
    fn what_is_allowed_is_done_and_what_is_not_slides() {
        let wanted = [1.0, 0.0, -2.0, 0.0, 0.0, 0.0];
        assert_eq!(nearest_allowed(&wanted, &[]), wanted);
        let floor = upward([0.0, 0.0, 1.0], -0.5);
        assert!(close(nearest_allowed(&wanted, &[floor]), [1.0, 0.0, -0.5]));
        let ceiling = upward([0.0, 0.0, -1.0], -9.0);
        assert!(close(nearest_allowed(&wanted, &[ceiling]), [1.0, 0.0, -2.0]));
        // The same one twice is one.
        assert!(close(nearest_allowed(&wanted, &[floor, floor]), [1.0, 0.0, -0.5]));
    }

    #[test]
    fn a_groove_holds_on_both_flanks() {
        let wanted = [0.3, 0.7, -2.0, 0.0, 0.0, 0.0];
        let flanks = [upward([1.0, 0.0, 1.0], 0.0), upward([-1.0, 0.0, 1.0], 0.0)];
        assert!(close(nearest_allowed(&wanted, &flanks), [0.0, 0.7, 0.0]));
    }

    #[test]
    fn what_has_come_in_is_led_out() {
        let still = [0.0; 6];
        assert!(close(nearest_allowed(&still, &[upward([0.0, 0.0, 1.0], 0.25)]), [0.0, 0.0, 0.25]));
    }
}
