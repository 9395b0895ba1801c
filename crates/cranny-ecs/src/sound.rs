//! `Sound`: what is to be heard of contacts. Impacts, sliding and rolling, each reported as it
//! begins.
//!
//! The solver says which pairs press on each other, and how hard; velocities at the beginning of
//! the step say how fast surfaces meet, slip past each other and roll. A sliding or rolling sound
//! goes on until it is slower than half of what it took to begin, or the pair has not pressed for
//! [`SILENCE`]: contacts of facets come and go.

use std::collections::BTreeMap;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Remove;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use cranny_world::BodyId;

use crate::body::{Bodies, Body};
use crate::clock::{CrannyStep, SimulatedTime, StepSystems};
use crate::collision::{CollisionPoint, Velocities, hardest};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable, Pair};
use crate::response::ResponseSystems;
use crate::solved::RigidBodies;

/// Seconds for which a pair may not press before its sound ends. Longer: a second touch is no new
/// sound; shorter: a rolling polyhedron is heard anew at each edge.
const SILENCE: f64 = 0.1;

/// The share of the speed at which a sliding or rolling sound begins below which it ends. Larger:
/// what slides at about that speed begins again and again; smaller: a sound goes on that nobody
/// hears.
const HELD: f64 = 0.5;

/// The systems of `Sound`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SoundSystems {
    /// Messages and [`OngoingSounds`].
    Report,
}

/// What makes a sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SoundKind {
    /// Surfaces meet; over at once.
    Impact,
    /// Surfaces slip past each other.
    Slide,
    /// A surface rolls, or tips, on another one that it does not slip on.
    Roll,
}

/// A sound begins; in [`OngoingSounds`]: goes on.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct SoundEvent {
    /// What makes it.
    pub kind: SoundKind,
    /// The body with the lower id.
    pub body: Entity,
    /// The other.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
    /// Where they press hardest, seen from `body`.
    pub at: CollisionPoint,
    /// What the contacts gave each body along their normals in the step, summed as numbers: mass x
    /// length / second.
    pub impulse: f64,
    /// At the point, at the beginning of the step, units of length a second: of an impact that at
    /// which the bodies approach each other, of sliding that at which the surfaces slip, of rolling
    /// that at which the faster turning body's centre of mass would pass the point.
    pub speed: f64,
    /// Of the contact: that of the convex hull of the points at which the bodies press on each
    /// other, seen along the normal. 0 for a point or a line.
    pub area: f64,
}

/// What slides or rolls now, by ids.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct OngoingSounds {
    /// One a pair at most.
    pub sounds: Vec<SoundEvent>,
}

/// What is remembered of a pair that may be heard.
#[derive(Clone, Copy, Debug, Default)]
struct Heard {
    /// Whether it met fast when it last pressed.
    hits: bool,
    /// What goes on.
    going: Option<SoundKind>,
    /// Steps since it last pressed.
    silent: u64,
}

/// Pairs that pressed lately.
#[derive(Resource, Default)]
struct HeardPairs(BTreeMap<Pair, Heard>);

/// Reports [`SoundEvent`], and keeps [`OngoingSounds`].
#[derive(Clone, Copy, Debug, Default)]
pub struct SoundPlugin;

impl Plugin for SoundPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<SoundEvent>();
        app.init_resource::<OngoingSounds>().init_resource::<HeardPairs>();
        app.add_observer(forget);
        app.add_systems(
            CrannyStep,
            report_sounds
                .in_set(StepSystems::Report)
                .in_set(SoundSystems::Report)
                .after(ResponseSystems::Tally),
        );
    }
}

/// A body that left makes no sound.
fn forget(removed: On<Remove<Body>>, bodies: Query<&Body>, mut heard: ResMut<HeardPairs>) {
    if let Ok(&Body { id }) = bodies.get(removed.entity) {
        heard.0.retain(|pair, _| pair.0 != id && pair.1 != id);
    }
}

/// What a pair that presses does.
#[derive(Clone, Copy)]
struct Pressing {
    at: CollisionPoint,
    impulse: f64,
    area: f64,
    closing: f64,
    slip: f64,
    roll: f64,
}

/// What is known of pairs that press.
#[derive(SystemParam)]
struct Ears<'w, 's> {
    solver: Res<'w, RigidBodies>,
    bodies: Res<'w, Bodies>,
    velocities: Velocities<'w, 's>,
}

impl Ears<'_, '_> {
    fn pressing(&self, (a, b): Pair, impulse: f64) -> Option<Pressing> {
        let points = self.solver.presses((a, b));
        let at = hardest(&points)?;
        let [of_a, of_b] = [a, b].map(|body| self.velocities.at(&self.bodies, body, at.point));
        let passing = of_a - of_b;
        let closing = passing.dot(at.normal);
        let slip = (passing - closing * at.normal).length();
        let area = area(&points, &at);
        let roll = self.velocities.rolling(&self.bodies, [a, b], &at);
        Some(Pressing { at, impulse, area, closing, slip, roll })
    }

    fn event(&self, kind: SoundKind, ids: [BodyId; 2], found: &Pressing) -> Option<SoundEvent> {
        let [body, other] = [self.bodies.entity(ids[0])?, self.bodies.entity(ids[1])?];
        let speed = match kind {
            SoundKind::Impact => found.closing,
            SoundKind::Slide => found.slip,
            SoundKind::Roll => found.roll,
        };
        let Pressing { at, impulse, area, .. } = *found;
        Some(SoundEvent { kind, body, other, ids, at, impulse, speed, area })
    }
}

fn report_sounds(
    ears: Ears,
    effects: Res<EffectTable>,
    time: Res<SimulatedTime>,
    mut heard: ResMut<HeardPairs>,
    mut ongoing: ResMut<OngoingSounds>,
    mut events: MessageWriter<SoundEvent>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Sound);
    ongoing.sounds.clear();
    let limit = (SILENCE / time.step()).ceil() as u64;
    heard.0.retain(|_, pair| {
        pair.silent += 1;
        pair.silent <= limit
    });
    for (pair @ (a, b), impulse) in ears.solver.impulses_in_order() {
        let Some(above) = effects.heard_above(a, b) else { continue };
        let Some(found) = ears.pressing(pair, impulse) else { continue };
        let known = heard.0.entry(pair).or_default();
        let before = std::mem::replace(known, known.next(&found, above));
        // In two steps one after the other it is one hit.
        let goes_on = before.hits && before.silent == 1;
        let hit = (known.hits && !goes_on).then_some(SoundKind::Impact);
        let began = known.going.filter(|_| known.going != before.going);
        for kind in hit.into_iter().chain(began) {
            events.write_batch(ears.event(kind, [a, b], &found));
        }
        let going = known.going.and_then(|kind| ears.event(kind, [a, b], &found));
        ongoing.sounds.extend(going);
    }
}

impl Heard {
    /// What it is after a step in which the pair pressed.
    fn next(self, found: &Pressing, above: f64) -> Self {
        let least = |kind| if self.going == Some(kind) { HELD * above } else { above };
        let slides = found.slip > least(SoundKind::Slide);
        let rolls = found.roll > least(SoundKind::Roll);
        let going = match (slides, rolls) {
            (true, _) => Some(SoundKind::Slide),
            (false, true) => Some(SoundKind::Roll),
            (false, false) => None,
        };
        // What rolls hits with each facet, more slowly than it rolls.
        let rolling = if self.going == Some(SoundKind::Roll) { found.roll } else { 0.0 };
        Self { hits: found.closing > above.max(rolling), going, silent: 0 }
    }
}

/// The area of the convex hull of points, along the normal of one of them.
fn area(points: &[(CollisionPoint, f64)], at: &CollisionPoint) -> f64 {
    let (u, v) = at.normal.any_orthonormal_pair();
    let seen = points.iter().map(|(point, _)| [point.point.dot(u), point.point.dot(v)]);
    hull_area(seen.collect())
}

/// Of points in a plane (Andrew's chain, 1979).
fn hull_area(mut points: Vec<[f64; 2]>) -> f64 {
    points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    let cross = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2], [cx, cy]: [f64; 2]| {
        (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    };
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && cross(a, b, point) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain
    };
    let below = chain(&mut points.iter().copied());
    let above = chain(&mut points.iter().rev().copied());
    let around: Vec<[f64; 2]> = below.into_iter().chain(above).collect();
    let next = around.iter().cycle().skip(1);
    let twice: f64 = around.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    0.5 * twice.abs()
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    #[test]
    fn the_area_of_points_is_that_of_their_hull() {
        let square = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        assert!((hull_area(square.clone()) - 2.0).abs() < 1e-12);
        let more = [square, vec![[1.0, 0.5], [1.0, 0.0], [2.0, 0.0]]].concat();
        assert!((hull_area(more) - 2.0).abs() < 1e-12);
        for flat in [vec![], vec![[3.0, 1.0]], vec![[3.0, 1.0], [4.0, 2.0]]] {
            assert_eq!(hull_area(flat), 0.0);
        }
        assert!(hull_area(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).abs() < 1e-12);
    }

    fn pressing(closing: f64, slip: f64, roll: f64) -> Pressing {
        let at = CollisionPoint { point: DVec3::ZERO, normal: DVec3::Z, depth: 0.0 };
        Pressing { at, impulse: 1.0, area: 0.0, closing, slip, roll }
    }

    #[test]
    fn a_sound_goes_on_until_it_is_half_as_fast_as_it_began() {
        let mut pair = Heard::default();
        let kinds = [0.9, 1.1, 0.8, 0.6, 0.4, 0.9].map(|slip| {
            pair = pair.next(&pressing(0.0, slip, 0.0), 1.0);
            pair.going
        });
        let slide = Some(SoundKind::Slide);
        assert_eq!(kinds, [None, slide, slide, slide, None, None]);
        let from_slide_to_roll = [2.0, 0.6, 0.4].map(|slip| {
            pair = pair.next(&pressing(0.0, slip, 3.0), 1.0);
            pair.going
        });
        assert_eq!(from_slide_to_roll, [slide, slide, Some(SoundKind::Roll)]);
    }
}
