//! Fat boxes: a body's box in single precision, rounded outward, with room to move in.

use cranny_exact::{Aabb, DVec3};
use parry3d::bounding_volume::Aabb as FatBox;
use parry3d::math::Vector;

/// Coordinates are cut to this size. The cut keeps their order, so what overlaps still does; beyond
/// it, products of three of the tree's extents would overflow single precision. Boxes that are
/// farther out than this are candidates of each other.
const FARTHEST: f64 = (1u64 << 40) as f64;

/// For how many updates like the last one the room should last. Smaller: boxes leave it often, and
/// each time are searched for anew; larger: more pairs of boxes are looked at for nothing. The
/// table in the crate's README has both ends.
const UPDATES: f64 = 16.0;

/// The most room, as a share of the box's largest extent. Larger, and what is fast is near
/// everything.
const LARGEST_SHARE: f64 = 0.25;

/// A step of more than so many of the box's largest extents is a jump, and says nothing of the
/// next. Smaller: what is fast is searched for in every update; larger: where all bodies are put
/// elsewhere, each is near all others, and candidates are as many as pairs.
const JUMP: f64 = 4.0;

/// The least room of what has moved or may, as such a share: single precision alone gives none.
const LEAST_SHARE: f64 = 1.0 / 64.0;

/// The smallest box in single precision around another.
pub(crate) fn rounded(aabb: &Aabb) -> FatBox {
    FatBox {
        mins: vector(aabb.min.to_array().map(below)),
        maxs: vector(aabb.max.to_array().map(above)),
    }
}

/// A [rounded] box in double precision; it has no bound where that was cut off.
pub(crate) fn unrounded(aabb: &FatBox) -> Aabb {
    let [min, max] = [aabb.mins, aabb.maxs].map(wide);
    let limit = DVec3::splat(FARTHEST);
    Aabb {
        min: DVec3::select(min.cmple(-limit), DVec3::NEG_INFINITY, min),
        max: DVec3::select(max.cmpge(limit), DVec3::INFINITY, max),
    }
}

/// A box with room for a body whose box was `before` and is `now`.
pub(super) fn fattened(before: &Aabb, now: &Aabb) -> FatBox {
    let (step, size) = (step(before, now), (now.max - now.min).max_element());
    // Infinite faces have no room and need none.
    let [step, size] = [step, size].map(|x| if x.is_finite() { x } else { 0.0 });
    let room = (UPDATES * step).clamp(LEAST_SHARE * size, LARGEST_SHARE * size);
    let room = if step <= JUMP * size { room.max(step) } else { room };
    let room = DVec3::splat(room);
    rounded(&Aabb { min: now.min - room, max: now.max + room })
}

/// The farthest that a face of a box has moved along its axis.
pub(super) fn step(before: &Aabb, now: &Aabb) -> f64 {
    (now.min - before.min).abs().max((now.max - before.max).abs()).max_element()
}

/// How many times its own size a box has moved, at most once: then it is anywhere.
pub(super) fn wear(before: &Aabb, now: &Aabb) -> f64 {
    let wear = step(before, now) / (now.max - now.min).max_element();
    if wear <= 1.0 { wear } else { 1.0 }
}

/// Whether a fat box holds a box, or what the cut leaves of it.
pub(super) fn holds(fat: &FatBox, aabb: &Aabb) -> bool {
    let [low, high] = [fat.mins, fat.maxs].map(wide);
    let limit = DVec3::splat(FARTHEST);
    low.cmple(aabb.min.clamp(-limit, limit)).all()
        && high.cmpge(aabb.max.clamp(-limit, limit)).all()
}

fn wide(v: Vector) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn vector([x, y, z]: [f32; 3]) -> Vector {
    Vector::new(x, y, z)
}

/// The largest number of single precision that is not above `x`, which is cut first.
fn below(x: f64) -> f32 {
    let cut = x.clamp(-FARTHEST, FARTHEST);
    let near = cut as f32;
    if f64::from(near) > cut { near.next_down() } else { near }
}

fn above(x: f64) -> f32 {
    -below(-x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_goes_outward_and_keeps_what_fits() {
        let third = 1.0 / 3.0;
        assert!(f64::from(below(third)) < third && third < f64::from(above(third)));
        assert_eq!(above(third), below(third).next_up());
        assert_eq!([below(0.5), above(0.5), below(-0.0), above(0.0)], [0.5, 0.5, 0.0, 0.0]);
        // Subnormal numbers of double precision round to zero or the least of single precision.
        let tiny = f64::MIN_POSITIVE;
        assert_eq!([below(tiny), above(-tiny)], [0.0, 0.0]);
        assert!(above(tiny) > 0.0 && below(-tiny) < 0.0);
    }

    #[test]
    fn what_is_too_far_out_is_cut_in_order() {
        let limit = FARTHEST as f32;
        assert_eq!([below(f64::INFINITY), above(1e300)], [limit, limit]);
        assert_eq!([below(f64::NEG_INFINITY), above(-1e300)], [-limit, -limit]);
    }

    #[test]
    fn room_follows_the_speed_between_its_bounds() {
        let cube = |x: f64| Aabb { min: DVec3::splat(x), max: DVec3::splat(x + 1.0) };
        let room = |step: f64| -f64::from(fattened(&cube(-step), &cube(0.0)).mins.x);
        assert_eq!(room(0.0), LEAST_SHARE);
        assert_eq!(room(1.0 / 128.0), 16.0 / 128.0);
        assert_eq!(room(0.125), LARGEST_SHARE);
        assert_eq!([room(4.0), room(4.5)], [4.0, LARGEST_SHARE]);
        let half_space = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::new(1.0, 1.0, 0.0) };
        assert_eq!(fattened(&half_space, &half_space), rounded(&half_space));
    }

    #[test]
    fn a_fat_box_holds_its_box_and_not_one_beyond() {
        let cube = |x: f64| Aabb { min: DVec3::splat(x), max: DVec3::splat(x + 1.0) };
        let fat = fattened(&cube(0.0), &cube(0.0));
        assert!(holds(&fat, &cube(LEAST_SHARE)));
        assert!(!holds(&fat, &cube(LEAST_SHARE + 0.001)));
        assert!(!holds(&fat, &cube(-LEAST_SHARE - 0.001)));
        let far = Aabb { min: DVec3::splat(-1e300), max: DVec3::INFINITY };
        assert!(holds(&rounded(&far), &far) && !holds(&fat, &far));
    }

    #[test]
    fn wear_is_a_share_of_the_size_and_at_most_one() {
        let cube = |x: f64| Aabb { min: DVec3::splat(x), max: DVec3::splat(x + 2.0) };
        assert_eq!([wear(&cube(0.0), &cube(0.5)), wear(&cube(0.0), &cube(9.0))], [0.25, 1.0]);
        let point = Aabb { min: DVec3::ONE, max: DVec3::ONE };
        assert_eq!(wear(&point, &point), 1.0, "of a point nothing is known");
    }
}
