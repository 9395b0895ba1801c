//! Up to when two bodies are let on their ways, so that neither passes through the other.
//!
//! Bodies that are apart are let until just before they meet ([`last_apart`]). Where a solver
//! pushes bodies apart, or where they touch from the beginning, one of them is held by a core
//! ([`Cores`]): what touches slides, rolls, leaves and lands, and comes into the other by no more
//! than the core is deep. It is the shallowest core that serves: of those below a share of the
//! thinner body's thickness, the deepest; where the other body is in it already, or about to be,
//! the next one.
//!
//! The core is that of the thicker body, or of two alike of the one of fewer faces: a plate is held
//! by the core of the block that it lands on. Where none of it serves, one of the other body does.

use cranny_exact::Pose;
use cranny_impact::{ImpactOptions, Motion};
use cranny_narrow_phase::{Demand, PairMemory, Query};

use crate::between::{PlacedShape, query_shapes};
use crate::cores::{Cores, LEVELS};
use crate::shape::BodyShape;
use crate::sweep::{MovingShape, Swept, first_meeting, speed};

/// How deep bodies may come into each other within a step, as a part of the thinner body's
/// thickness: the solver has the contact then, and leads them apart. Larger: it may lead them to
/// the other side; smaller: what lands is held back before it has a contact.
const SHALLOW: f64 = 0.05;

/// How near a core is let to what it would meet, as a part of its depth. Larger: the next core has
/// to serve early; smaller: rounding counts.
const NEAR: f64 = 1.0 / 16.0;

/// How deep, as a part of the thinner body's thickness, a body may come into another one while a
/// solver pushes it out, step by step. Larger: it passes the middle of a thin wall, and is led to
/// the other side; smaller: what is pushed in slowly is held for long.
const DEEP: f64 = 0.2;

/// What has to be free of a core's depth for it to serve, up to [`DEEP`]. Larger: bodies come in
/// farther than they need; smaller: what slides as deep as a core lies is held. Deeper in, and
/// where nothing pushes bodies apart, it is enough that the core touches nothing: it serves for
/// good.
const FREE: f64 = 0.25;

/// Which of the shallower cores are tried where none of the deeper ones serves. More: fewer are
/// made in vain; fewer: bodies that hardly overlap are held sooner.
const SHALLOWER: usize = 3;

/// A thickness counts as another's up to this many times it. Larger: plates are held by cores of
/// their own, which their resting overlap reaches; smaller: cores of large meshes are made in vain.
const ALIKE: f64 = 2.0;

/// The share of a way by which a body backs off at least from what it would meet. Larger: bodies
/// stop visibly short; smaller: single precision does not distinguish such poses.
const LEAST_BACK: f64 = 1.0 / 16_777_216.0;

/// A shape on its way, with its cores.
#[derive(Clone, Copy, Debug)]
pub struct MovingCores<'a> {
    /// What.
    pub cores: &'a Cores,
    /// How, over the time from 0 to 1.
    pub motion: Motion,
}

impl<'a> MovingCores<'a> {
    fn whole(self) -> MovingShape<'a> {
        MovingShape { shape: self.cores.shape(), motion: self.motion }
    }

    /// Its thickness, and no more than its radius.
    fn size(&self) -> f64 {
        self.cores.thickness().min(self.cores.shape().radius())
    }
}

/// The share of two motions, from 0 to 1, up to which bodies are let that a solver pushes apart:
/// until one is in the other by a twentieth of the thinner one's thickness, or by a little more
/// than it is already. `None` where they do not come so deep, where one begins within the other or
/// overlaps all cores, where two surfaces without a volume touch, and for numbers that are refused:
/// those are reported by whoever detects the pair.
///
/// `budget` is that of [`ImpactOptions`].
#[must_use]
pub fn let_until(ends: [MovingCores<'_>; 2], budget: u64) -> Option<f64> {
    let thin = ends[0].size().min(ends[1].size());
    Held { ends, from: SHALLOW * thin, pushed_to: DEEP * thin, budget }.until()
}

/// The share of two motions up to which bodies are let that nothing pushes apart, and that are to
/// stay apart in the numbers in which their poses are stored; 0 where they cannot move, `None`
/// where they do not meet. Surfaces within `options.tolerance` may count as meeting.
///
/// What touches at the beginning leaves or slides along, and is let into the other by no more than
/// a millionth of the thicker body's thickness, or than it overlaps already.
pub fn last_apart(
    ends: [MovingCores<'_>; 2],
    options: &ImpactOptions,
    stored: impl Fn(&Pose) -> Pose,
) -> Option<f64> {
    let whole = ends.map(MovingCores::whole);
    let gap = |time: f64| {
        let poses = whole.map(|end| stored(&end.motion.pose_at(time)));
        gap([(whole[0].shape, poses[0]), (whole[1].shape, poses[1])], options.tolerance)
    };
    let Some(first_gap) = gap(0.0) else {
        return Held { ends, from: 0.0, pushed_to: 0.0, budget: options.budget }.until();
    };
    // What is nearer than the tolerance already is not met by it.
    let tolerance = options.tolerance.min(0.5 * first_gap);
    let time = match met(whole, &ImpactOptions { tolerance, ..*options }) {
        None if gap(1.0).is_some() => return None,
        None => 1.0,
        Some(time) => time,
    };
    let mut back = back(whole, tolerance);
    while back < time {
        if gap(time - back).is_some() {
            return Some(time - back);
        }
        back *= 2.0;
    }
    Some(0.0)
}

/// How far apart two shapes are, or that they are at least so far; `None` where they touch.
fn gap([a, b]: [(&BodyShape, Pose); 2], within: f64) -> Option<f64> {
    let [a, b] = [a, b].map(|(shape, pose)| PlacedShape { shape, pose });
    let nearest = Query::of(Demand::Distance { below: Some(within) });
    let answer = query_shapes(a, b, &nearest, &mut PairMemory::default()).ok()?;
    let distance = answer.distance.unwrap_or(f64::INFINITY);
    (!answer.touches() && distance > 0.0).then_some(distance)
}

/// Up to when two are free, where they do not stay so and begin so.
fn met([a, b]: [MovingShape<'_>; 2], options: &ImpactOptions) -> Option<f64> {
    match first_meeting(a, b, options).ok()? {
        Swept::Initially | Swept::Free => None,
        Swept::Hit { time, .. } => Some(time),
        Swept::Open { free_before } => Some(free_before),
    }
}

/// The share of their ways in which two come nearer by a tolerance, at most.
fn back([a, b]: [MovingShape<'_>; 2], tolerance: f64) -> f64 {
    (tolerance / speed(&a, &b)).max(LEAST_BACK)
}

/// Two bodies, one of them held by a core.
struct Held<'a> {
    ends: [MovingCores<'a>; 2],
    /// How deep the first core is that may serve, at most.
    from: f64,
    /// Up to which depth a solver pushes bodies apart.
    pushed_to: f64,
    budget: u64,
}

impl Held<'_> {
    fn until(&self) -> Option<f64> {
        let owners = self.owners();
        if owners.is_empty() {
            let tolerance = NEAR * SHALLOW * self.ends[0].size().min(self.ends[1].size());
            return self.let_by(self.ends.map(MovingCores::whole), tolerance);
        }
        owners.into_iter().find_map(|owner| self.until_core_of(owner))?
    }

    /// Up to when the first core of a body that serves is let, which is `None` where it meets
    /// nothing; `None` where none of them serves.
    fn until_core_of(&self, owner: usize) -> Option<Option<f64>> {
        let cores = self.ends[owner].cores;
        let first = (0..LEVELS).rev().find(|&level| cores.depth(level) <= self.from).unwrap_or(0);
        // Where a core pokes out of its body, by crossing itself, a shallower one does so less.
        let shallower = (0..first).rev().step_by(SHALLOWER);
        (first..LEVELS).chain(shallower).find_map(|level| {
            let core = cores.core(level)?;
            let mut held = self.ends.map(MovingCores::whole);
            held[owner].shape = &core;
            let depth = cores.depth(level);
            // The next core is twice as deep.
            let free = if 2.0 * depth <= self.pushed_to { FREE } else { 0.0 };
            let starts = held.map(|end| (end.shape, end.motion.start));
            let serves = gap(starts, depth).is_some_and(|gap| gap > free * depth);
            serves.then(|| self.let_by(held, NEAR * depth))
        })
    }

    /// Whose cores are held, those first that serve better; empty where neither bounds a volume.
    fn owners(&self) -> Vec<usize> {
        let thick = |k: usize| self.ends[k].cores.thickness();
        let mut owners = vec![0, 1];
        owners.retain(|&k| thick(k).is_finite());
        let most = owners.iter().map(|&k| thick(k)).fold(0.0, f64::max);
        owners.sort_by_key(|&k| (ALIKE * thick(k) < most, self.ends[k].cores.faces()));
        owners
    }

    fn let_by(&self, held: [MovingShape<'_>; 2], tolerance: f64) -> Option<f64> {
        let time = met(held, &ImpactOptions { tolerance, budget: self.budget })?;
        Some((time - back(held, tolerance)).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cuboid, Shape};

    use crate::primitive::{Ball, Primitive};

    const TOLERANCE: f64 = 1e-4;

    fn built(shape: impl Into<Shape>) -> BodyShape {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0.into()
    }

    /// What lies on a block slides and leaves, and goes into it by no more than a core is deep,
    /// step by step, whether it overlaps a little or not.
    #[test]
    fn what_touches_slides_and_leaves_and_does_not_sink() {
        let [plate, block] =
            [[0.6, 0.5, 0.1], [4.0, 4.0, 1.0]].map(|size| Cores::of(built(Cuboid { size })));
        let ball = Primitive::from(Ball { center: DVec3::ZERO, radius: 0.2 });
        let ball = Cores::of(BodyShape::from(ball));
        for (body, half) in [(&plate, 0.05), (&ball, 0.2)] {
            for sunk in [-1e-9, 0.0, 1e-9, 1e-4, 1e-3] {
                let start = Pose::at(DVec3::new(0.1, 0.2, 0.5 + half - sunk));
                let below = MovingCores { cores: &block, motion: Motion::at_rest(Pose::IDENTITY) };
                let let_by = |start: Pose, travel: DVec3, pushed: bool| {
                    let above =
                        MovingCores { cores: body, motion: Motion::straight(start, travel) };
                    let options = ImpactOptions::within(TOLERANCE);
                    match pushed {
                        true => let_until([below, above], options.budget),
                        false => last_apart([below, above], &options, |pose| *pose),
                    }
                };
                for pushed in [true, false] {
                    for free in [DVec3::X, DVec3::new(1.0, 0.5, 0.0), DVec3::Z] {
                        assert_eq!(let_by(start, free, pushed), None, "{half} {sunk} {free}");
                    }
                    let mut pose = start;
                    let most = if pushed { 0.3 } else { 1e-5 + 2.0 * sunk.max(0.0) };
                    for step in 0..8 {
                        let travel = DVec3::new(0.1, 0.0, -3.0);
                        let until = let_by(pose, travel, pushed).expect("it is led into the block");
                        pose.translation += until * travel;
                        let deep = 0.5 + half - pose.translation.z;
                        assert!(deep < most, "{half} {sunk} {pushed}: {deep} in step {step}");
                    }
                }
            }
        }
    }

    /// In single precision the last time at which two are apart is before they meet.
    #[test]
    fn the_last_time_apart_is_just_before_the_meeting() {
        let [ball, block] = [
            BodyShape::from(Primitive::from(Ball { center: DVec3::ZERO, radius: 0.5 })),
            built(Cuboid { size: [1.0; 3] }),
        ]
        .map(Cores::of);
        let stored = |pose: &Pose| {
            let [x, y, z] = pose.translation.to_array().map(|x| f64::from(x as f32));
            Pose { translation: DVec3::new(x, y, z), ..*pose }
        };
        let options = ImpactOptions::within(TOLERANCE);
        for far in [0.0, 3e4] {
            let start = Pose::at(DVec3::X * far);
            let travel = DVec3::X * 10.0;
            let moving = MovingCores { cores: &ball, motion: Motion::straight(start, travel) };
            let beside = |x: f64, y: f64| {
                let start = Pose::at(DVec3::new(far + x, y, 0.0));
                MovingCores { cores: &block, motion: Motion::at_rest(start) }
            };
            let last = last_apart([moving, beside(6.0, 0.0)], &options, stored).unwrap();
            assert!((0.499..0.5).contains(&last), "{far}: {last}");
            assert_eq!(last_apart([moving, beside(6.0, 1.1)], &options, stored), None);
            assert_eq!(last_apart([moving, beside(-6.0, 0.0)], &options, stored), None);
            // From within it leaves.
            assert_eq!(last_apart([moving, beside(0.5, 0.0)], &options, stored), None);
        }
        // It ends between two numbers of single precision, and would be rounded into the block.
        let [from, end] = [3e4, 3e4 + 9.0 + 4e-4];
        let motion = Motion::straight(Pose::at(DVec3::X * from), DVec3::X * (end - from));
        let moving = MovingCores { cores: &ball, motion };
        let wall = Pose::at(DVec3::X * (end + 1.0 + 2e-4));
        let wall = MovingCores { cores: &block, motion: Motion::at_rest(wall) };
        let up = |pose: &Pose| {
            let x = pose.translation.x;
            Pose { translation: DVec3::X * if x == end { x + 1e-3 } else { x }, ..*pose }
        };
        assert_eq!(first_meeting(moving.whole(), wall.whole(), &options), Ok(Swept::Free));
        assert!(last_apart([moving, wall], &options, up).is_some_and(|last| last < 1.0));
    }
}
