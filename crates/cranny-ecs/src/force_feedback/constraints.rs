//! The motion nearest to a wanted one that linear constraints allow.

/// How often all constraints are gone through. More: a tick takes longer; fewer: what a motion
/// meets only after the others have turned it is not seen.
const SWEEPS: usize = 16;

/// How often those that hold, before all are gone through again. More: a tick takes longer; fewer:
/// in a narrow wedge the motion found still enters both flanks, and is then shortened.
const SWEEPS_OF_HELD: usize = 16;

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
/// multiplier after the other, each at its best). Of many constraints few hold: those are gone
/// through most.
pub(super) fn nearest_allowed(wanted: &Twist, constraints: &[Constraint]) -> Twist {
    let mut motion = *wanted;
    let mut all: Vec<Multiplier<'_>> = constraints.iter().map(Multiplier::of).collect();
    for _ in 0..SWEEPS {
        if !improve(&mut all, &mut motion) {
            break;
        }
        let mut held: Vec<_> = all.iter_mut().filter(|multiplier| multiplier.value > 0.0).collect();
        for _ in 0..SWEEPS_OF_HELD {
            if !improve(held.iter_mut().map(|multiplier| &mut **multiplier), &mut motion) {
                break;
            }
        }
    }
    motion
}

/// Each multiplier at its best, one after the other; whether any changed.
fn improve<'m, 'c: 'm>(
    multipliers: impl IntoIterator<Item = &'m mut Multiplier<'c>>,
    motion: &mut Twist,
) -> bool {
    let mut changed = false;
    for multiplier in multipliers {
        changed |= multiplier.improve(motion);
    }
    changed
}

/// By how much a constraint turns the motion aside.
struct Multiplier<'a> {
    constraint: &'a Constraint,
    square: f64,
    /// Not negative.
    value: f64,
}

impl<'a> Multiplier<'a> {
    fn of(constraint: &'a Constraint) -> Self {
        Self { constraint, square: dot(&constraint.along, &constraint.along), value: 0.0 }
    }

    /// Its best value, where the others stay; whether it is another one.
    fn improve(&mut self, motion: &mut Twist) -> bool {
        let Constraint { along, least } = self.constraint;
        let change = ((least - dot(along, motion)) / self.square).max(-self.value);
        if change == 0.0 {
            return false;
        }
        self.value += change;
        for (x, along) in motion.iter_mut().zip(along) {
            *x += change * along;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_testkit::Rng;

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

    /// All constraints gone through one after the other.
    fn plainly(wanted: &Twist, constraints: &[Constraint], sweeps: u32) -> Twist {
        let mut motion = *wanted;
        let mut all: Vec<Multiplier<'_>> = constraints.iter().map(Multiplier::of).collect();
        for _ in 0..sweeps {
            improve(&mut all, &mut motion);
        }
        motion
    }

    /// Contacts all around a body, of which few hold: as good as 128 sweeps of all, on the mean.
    #[test]
    fn going_through_those_that_hold_comes_nearer_than_through_all() {
        let mut rng = Rng::new(7);
        let (mut off, mut off_plainly, mut turned_aside) = (0.0, 0.0, 0);
        for _ in 0..30 {
            let mut twist = |scale: f64| -> Twist { std::array::from_fn(|_| scale * rng.unit()) };
            let (wanted, allowed) = (twist(2.0), twist(0.5));
            let constraints: Vec<Constraint> = (0..60)
                .map(|_| twist(1.0))
                .map(|along| Constraint { along, least: dot(&along, &allowed) - 0.1 })
                .collect();
            let best = plainly(&wanted, &constraints, 20_000);
            let from_best = |found: Twist| {
                let off: Twist = std::array::from_fn(|i| found[i] - best[i]);
                dot(&off, &off).sqrt()
            };
            off += from_best(nearest_allowed(&wanted, &constraints));
            off_plainly += from_best(plainly(&wanted, &constraints, 128));
            turned_aside += u32::from(best != wanted);
        }
        assert!(off < off_plainly, "{off} {off_plainly}");
        assert!(off < 0.3 && turned_aside > 25, "{off} {turned_aside}");
    }
}
