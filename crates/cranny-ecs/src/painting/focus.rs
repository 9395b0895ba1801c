//! The contact that matters most, and the plane that shows it: through the contact, along its
//! normal.

use cranny_exact::{Aabb, DQuat, DVec3};
use cranny_narrow_phase::{Answer, Contact, Demand, PairMemory, Query};
use cranny_primitives::{PlacedShape, query_shapes};
use cranny_render::{Camera, CameraError, Section, palette};
use cranny_world::BodyId;

use super::coats::Coats;
use super::{MeetingPair, Moment};

/// What a close-up looks at.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Focus {
    /// The bodies that meet, A and B of the contact; one alone where nothing does.
    pub(crate) bodies: Vec<BodyId>,
    /// The contact; `None` where nothing meets.
    pub(crate) contact: Option<Contact>,
    pub(crate) point: DVec3,
    /// Of the plane: towards who looks; unit.
    pub(crate) plane: DVec3,
    /// 1 where the plane may be nudged along its normal, -1 where against it: into the bodies.
    pub(crate) inwards: f64,
    /// How much a close-up shows around the point, units of length.
    pub(crate) radius: f64,
}

/// A contact that is at least this share as deep as the deepest may be shown in its place, where
/// the last close-up looked nearly there. Smaller: the deepest is missed; larger: close-ups jump.
const AS_DEEP: f64 = 0.6;

/// What a close-up shows around its point, in parts of the smaller body's diagonal.
const AROUND: f64 = 0.3;

/// A body's centre gives the plane a direction where it lies aside of the contact's normal by more
/// than this sine. Smaller: rounding chooses the plane; larger: cuts miss the axis of round bodies.
const ASIDE: f64 = 0.15;

/// Off the contact's own plane, in parts of what the magnified view reaches: a plane that runs
/// along faces or through a tip shows neither side.
const NUDGE: f64 = 0.04;

impl Focus {
    /// Of a moment; `last` is that of the moment before. `None` where there is no body.
    pub(super) fn of(
        coats: &Coats,
        moment: &Moment,
        last: Option<&Focus>,
        camera: &Camera,
    ) -> Option<Self> {
        let pairs = moment.pairs.iter().filter(|pair| !pair.sensed);
        let met = pairs.filter_map(|pair| Some((pair, deepest(&pair.answer)?)));
        let deepest_of_all = met.clone().min_by(|a, b| order(&a.1, &b.1));
        let Some((deepest_pair, least)) = deepest_of_all else {
            return Self::of_lone_body(coats, moment, last, camera);
        };
        let kept = last.and_then(|last| {
            let (pair, contact) = met.clone().find(|(pair, _)| last.bodies == [pair.a, pair.b])?;
            is_as_deep(&contact, &least).then_some(pair)
        });
        let pair = kept.unwrap_or(deepest_pair);
        let last = last.filter(|last| last.bodies == [pair.a, pair.b]);
        Self::of_pair(coats, moment, pair, last, camera)
    }

    fn of_pair(
        coats: &Coats,
        moment: &Moment,
        pair: &MeetingPair,
        last: Option<&Focus>,
        camera: &Camera,
    ) -> Option<Self> {
        let least = deepest(&pair.answer)?;
        let near_last = last.and_then(|last| {
            let away = |c: &Contact| (middle(c) - last.point).dot(last.plane).abs();
            let deep = exact_contacts(&pair.answer).filter(|c| is_as_deep(c, &least));
            deep.min_by(|a, b| away(a).total_cmp(&away(b)))
        });
        let contact = near_last.unwrap_or(least);
        let bounds = [pair.a, pair.b].map(|id| bounds_of(coats, moment, id));
        let [a, b] = bounds.map(|b| b.diagonal());
        let mover = mover_of(coats, pair);
        let center = bounds_of(coats, moment, mover).center();
        let plane = plane_through(middle(&contact), contact.normal, center, camera);
        let turns = [pair.a, pair.b].map(|id| moment.poses.get(&id).map(|pose| pose.rotation));
        let plane = along_an_axis(plane, turns.into_iter().flatten());
        let radius = AROUND * positive_or_one(a.min(b));
        let (point, bodies) = (middle(&contact), vec![pair.a, pair.b]);
        let inwards = if (center - point).dot(plane) < 0.0 { -1.0 } else { 1.0 };
        Some(Self { bodies, contact: Some(contact), point, plane, inwards, radius })
    }

    /// The last one goes on; else the first body that moves, else the first.
    fn of_lone_body(
        coats: &Coats,
        moment: &Moment,
        last: Option<&Focus>,
        camera: &Camera,
    ) -> Option<Self> {
        let present = |id: &BodyId| moment.poses.contains_key(id);
        let moves = coats.iter().filter(|(_, coat)| coat.moves()).map(|(id, _)| id);
        let any = coats.iter().map(|(id, _)| id);
        let before = last.iter().flat_map(|last| &last.bodies).copied();
        let before = before.filter(|id| coats.get(*id).is_some_and(|coat| coat.moves()));
        let body = before.chain(moves).chain(any).find(present)?;
        let bounds = bounds_of(coats, moment, body);
        let plane = level(camera.axes()[2]);
        let radius = 0.6 * positive_or_one(bounds.diagonal());
        let (bodies, point) = (vec![body], bounds.center());
        Some(Self { bodies, contact: None, point, plane, inwards: 1.0, radius })
    }

    /// A little off the point.
    pub(super) fn section(&self) -> Option<Section> {
        let reach = self.magnified().unwrap_or(self.radius);
        let nudged = self.point + NUDGE * reach * self.inwards * self.plane;
        Section::through(nudged, self.plane, palette::OVERLAP)
    }

    /// Looks at the plane, a little from above and aside, so that what is behind it is seen too.
    pub(super) fn camera(&self, radius: f64) -> Result<Camera, CameraError> {
        let up = (DVec3::Z - self.plane.z * self.plane).normalize_or_zero();
        let direction = self.plane + 0.2 * up + 0.12 * up.cross(self.plane);
        let half = 0.5 * Camera::FIELD_OF_VIEW.to_radians();
        let eye = self.point + radius / half.tan() * direction.normalize();
        Camera::look_at(eye, self.point)
    }

    /// How far a close-up reaches that shows the depth or gap itself; `None` where nothing meets.
    pub(super) fn magnified(&self) -> Option<f64> {
        let gap = self.contact?.separation.abs();
        Some((MAGNIFIED * gap).clamp(FINEST * self.radius, COARSEST * self.radius))
    }
}

/// A magnified view reaches this many times the depth or gap.
const MAGNIFIED: f64 = 5.0;

/// No magnified view is finer than this part of a close-up: bodies are drawn in single precision.
const FINEST: f64 = 2e-4;

/// Nor coarser than this one: it would show what the close-up shows.
const COARSEST: f64 = 0.35;

fn positive_or_one(length: f64) -> f64 {
    if length.is_normal() { length } else { 1.0 }
}

fn bounds_of(coats: &Coats, moment: &Moment, id: BodyId) -> Aabb {
    let coat = coats.get(id).zip(moment.poses.get(&id));
    coat.map_or(Aabb::EMPTY, |(coat, pose)| coat.bounds(pose))
}

/// Of two bodies that which moves; of two that do, the one which is pushed up.
pub(super) fn mover_of(coats: &Coats, pair: &MeetingPair) -> BodyId {
    let moves = |id: BodyId| coats.get(id).is_some_and(|coat| coat.moves());
    let up = deepest(&pair.answer).is_some_and(|contact| contact.normal.z > 0.0);
    match (moves(pair.a), moves(pair.b)) {
        (true, true) => {
            if up {
                pair.b
            } else {
                pair.a
            }
        }
        (false, true) => pair.b,
        _ => pair.a,
    }
}

/// Holds the normal and, where it lies aside, the body's centre: a cut through the axis of what is
/// round. Turned towards the camera.
fn plane_through(point: DVec3, normal: DVec3, center: DVec3, camera: &Camera) -> DVec3 {
    let backward = camera.axes()[2];
    let aside = (center - point).normalize_or_zero().cross(normal);
    let across = backward - backward.dot(normal) * normal;
    let plane = match aside.length() > ASIDE {
        true => aside.normalize(),
        false => across.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector()),
    };
    if plane.dot(backward) < 0.0 { -plane } else { plane }
}

/// Cosine within which a plane is turned to one of a body's own axes, across which its sections are
/// those that people draw.
const NEARLY_AN_AXIS: f64 = 0.96;

/// The axis that a direction nearly has, else the direction.
fn along_an_axis(direction: DVec3, turns: impl Iterator<Item = DQuat>) -> DVec3 {
    let axes = turns.flat_map(|turn| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis));
    let axes = axes.map(|axis| axis * axis.dot(direction).signum());
    let nearest = axes.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
    nearest.filter(|axis| axis.dot(direction) > NEARLY_AN_AXIS).unwrap_or(direction)
}

/// A direction without its height, where it has another.
fn level(direction: DVec3) -> DVec3 {
    let flat = DVec3::new(direction.x, direction.y, 0.0);
    flat.try_normalize().unwrap_or(DVec3::NEG_Y)
}

pub(super) fn middle(contact: &Contact) -> DVec3 {
    0.5 * (contact.point_a + contact.point_b)
}

/// All contacts of an answer: those for a solver, else those of its regions.
pub(super) fn contacts(answer: &Answer) -> impl Iterator<Item = Contact> + Clone + '_ {
    let of_regions = answer.regions.iter().filter(|_| answer.contacts.is_empty());
    let of_regions = of_regions.flat_map(|region| &region.points);
    answer.contacts.iter().chain(of_regions).copied()
}

/// Contacts as they are at the very poses that are drawn: those of regions where they are known. A
/// solver's may be carried on from poses a little away.
fn exact_contacts(answer: &Answer) -> impl Iterator<Item = Contact> + '_ {
    let of_regions = answer.regions.iter().flat_map(|r| r.points.iter().chain([&r.deepest]));
    let others = answer.contacts.iter().filter(|_| answer.regions.is_empty());
    of_regions.chain(others).copied()
}

fn deepest(answer: &Answer) -> Option<Contact> {
    let finite = |c: &Contact| middle(c).is_finite() && c.normal.try_normalize().is_some();
    exact_contacts(answer).filter(finite).min_by(order)
}

fn order(a: &Contact, b: &Contact) -> std::cmp::Ordering {
    a.separation.total_cmp(&b.separation)
}

fn is_as_deep(contact: &Contact, least: &Contact) -> bool {
    match least.separation < 0.0 {
        true => contact.separation <= AS_DEEP * least.separation,
        false => contact.separation <= least.separation / AS_DEEP,
    }
}

/// Where nothing meets, pairs are looked at that are no farther apart than this part of the smaller
/// body's size.
const NEARLY: f64 = 0.5;

/// Where nothing meets: the pair that is nearest, with its distance as a contact across a gap. A
/// question of the painter's own, about as many pairs as [`look_into`] takes. `None` where some
/// touch, of which nobody has computed contacts.
pub(super) fn nearest(coats: &Coats, moment: &Moment) -> Option<MeetingPair> {
    let placed = || coats.iter().filter_map(|(id, c)| Some((id, c, moment.poses.get(&id)?)));
    let mut near = Vec::new();
    for (a, coat_a, pose_a) in placed() {
        for (b, coat_b, pose_b) in placed().filter(|(b, ..)| *b > a) {
            let [box_a, box_b] = [coat_a.bounds(pose_a), coat_b.bounds(pose_b)];
            let reach = NEARLY * box_a.diagonal().min(box_b.diagonal());
            let (Some(of_a), Some(of_b)) = (&coat_a.shape, &coat_b.shape) else { continue };
            if (coat_a.moves() || coat_b.moves()) && box_a.grown(reach).overlaps(&box_b) {
                near.push(([a, b], [of_a, of_b], [*pose_a, *pose_b]));
            }
        }
    }
    if near.len() > PAIRS_LOOKED_INTO {
        return None;
    }
    let found = near.into_iter().filter_map(|([a, b], shapes, poses)| {
        let [placed_a, placed_b] = [0, 1].map(|i| PlacedShape { shape: shapes[i], pose: poses[i] });
        let question = Query::of(Demand::Distance { below: None });
        let answer =
            query_shapes(placed_a, placed_b, &question, &mut PairMemory::default()).ok()?;
        Some(MeetingPair { a, b, answer, impulse: 0.0, sensed: false })
    });
    let found: Vec<_> = found.collect();
    if found.iter().any(|pair: &MeetingPair| pair.answer.touches()) {
        return None;
    }
    found.into_iter().filter_map(with_witnesses).min_by(|a, b| {
        let separation = |pair: &MeetingPair| pair.answer.contacts[0].separation;
        separation(a).total_cmp(&separation(b))
    })
}

/// The nearest points as a contact.
fn with_witnesses(mut pair: MeetingPair) -> Option<MeetingPair> {
    let [a, b] = pair.answer.witnesses?;
    let separation = pair.answer.distance.filter(|distance| *distance > 0.0)?;
    let normal = (b.point - a.point).try_normalize()?;
    let id = (a.feature, b.feature);
    pair.answer.contacts =
        vec![Contact { id, point_a: a.point, point_b: b.point, normal, separation }];
    Some(pair)
}

/// Pairs at most whose regions are computed for a picture, where only contacts are known: more are
/// too small to be seen.
const PAIRS_LOOKED_INTO: usize = 24;

/// Finds what regions a few pairs meet in, so that they can be painted. It is the painter's own
/// question: the run knows nothing of it.
pub(super) fn look_into(coats: &Coats, moment: &mut Moment, surely: &[BodyId]) {
    let all = moment.pairs.len() <= PAIRS_LOOKED_INTO;
    let wanted = |pair: &&mut MeetingPair| all || surely == [pair.a, pair.b];
    let unknown = moment.pairs.iter_mut().filter(|pair| pair.answer.regions.is_empty());
    for pair in unknown.filter(wanted) {
        let margin = contacts(&pair.answer).map(|c| c.separation).fold(0.0, f64::max);
        let shapes = [pair.a, pair.b].map(|id| coats.get(id)?.shape.as_ref());
        let poses = [pair.a, pair.b].map(|id| moment.poses.get(&id).copied());
        let ([Some(a), Some(b)], [Some(pose_a), Some(pose_b)]) = (shapes, poses) else { continue };
        let of = |shape, pose| PlacedShape { shape, pose };
        let question = Query::of(Demand::Regions { margin });
        let memory = &mut PairMemory::default();
        if let Ok(found) = query_shapes(of(a, pose_a), of(b, pose_b), &question, memory) {
            pair.answer.regions = found.regions;
        }
    }
}
