//! Names of the bodies that touch, each beside its body.

use std::collections::BTreeSet;

use cranny_exact::DVec3;
use cranny_render::{Anchor, Camera, Color, DrawList, ImageSize, Label};
use cranny_world::BodyId;

use super::Moment;
use super::coats::Coats;

/// Bodies that are named at most, those of the deepest pairs first. More: names bury the bodies.
const NAMED: usize = 16;

/// Pixels.
const LETTERS: f32 = 14.0;

/// A body in the picture.
struct Outline {
    /// Its name on each of its sides.
    names: [Label; 4],
    /// Left, top, right and bottom edge of the body in the picture.
    room: [f32; 4],
}

/// Adds the names of the bodies that touch, or nearly do. A name covers no other, and as few other
/// bodies as can be; one for which there is no room is left out.
pub(super) fn name_touching(
    list: &mut DrawList,
    coats: &Coats,
    moment: &Moment,
    (camera, size): (&Camera, ImageSize),
) {
    let mut pairs: Vec<_> = moment.pairs.iter().collect();
    pairs.sort_by(|p, q| q.answer.depth().total_cmp(&p.answer.depth()));
    let mut seen = BTreeSet::new();
    let bodies: Vec<BodyId> =
        pairs.iter().flat_map(|pair| [pair.a, pair.b]).filter(|&id| seen.insert(id)).collect();
    let outlines: Vec<Outline> = bodies
        .into_iter()
        .take(NAMED)
        .filter_map(|id| outline(coats, moment, id, (camera, size)))
        .collect();
    list.labels.extend(placed(&outlines, camera, size));
}

/// `None` where a body is not in front of the camera.
fn outline(
    coats: &Coats,
    moment: &Moment,
    id: BodyId,
    (camera, size): (&Camera, ImageSize),
) -> Option<Outline> {
    let (coat, pose) = (coats.get(id)?, moment.poses.get(&id)?);
    let world_from_body = pose.world_from_body();
    let vertices = coat.of.mesh().vertices().iter().map(|&p| world_from_body.apply(p));
    let [r, g, b] = [coat.color.r, coat.color.g, coat.color.b].map(|channel| channel / 2);
    let label = Label { size: LETTERS, color: Color::rgb(r, g, b), ..Label::new(DVec3::ZERO, "") };
    outlined(vertices, Label { text: coat.name.clone(), ..label }, camera, size)
}

/// Of points: its extremes, each with the name on its side.
fn outlined(
    points: impl Iterator<Item = DVec3>,
    name: Label,
    camera: &Camera,
    size: ImageSize,
) -> Option<Outline> {
    let (low, high) = (f32::INFINITY, f32::NEG_INFINITY);
    let mut room = [low, low, high, high];
    let mut extremes = [DVec3::ZERO; 4];
    for point in points {
        let [x, y] = camera.project(point, size)?.map(|c| c as f32);
        for (side, (at, sign)) in [(x, -1.0), (y, -1.0), (x, 1.0), (y, 1.0)].into_iter().enumerate()
        {
            if sign * at > sign * room[side] {
                (room[side], extremes[side]) = (at, point);
            }
        }
    }
    let [left, top, right, bottom] = extremes;
    let sides = [
        (right, Anchor::Right),
        (left, Anchor::Left),
        (top, Anchor::Above),
        (bottom, Anchor::Below),
    ];
    let names = sides.map(|(at, anchor)| Label { at, anchor, ..name.clone() });
    room.iter().all(|edge| edge.is_finite()).then_some(Outline { names, room })
}

/// One name a body where there is room.
fn placed(outlines: &[Outline], camera: &Camera, size: ImageSize) -> Vec<Label> {
    let mut taken: Vec<[f32; 4]> = Vec::new();
    let mut found = Vec::new();
    for (i, outline) in outlines.iter().enumerate() {
        let others = || outlines.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, one)| one);
        let free = outline.names.iter().filter_map(|label| {
            let room = label.room(camera, size)?;
            let covers = |other: &[f32; 4]| overlap(&room, other);
            // At the border a name may be moved onto its own body.
            if taken.iter().any(covers) || covers(&outline.room) {
                return None;
            }
            Some((others().filter(|other| covers(&other.room)).count(), room, label))
        });
        if let Some((_, room, label)) = free.min_by_key(|(covered, ..)| *covered) {
            taken.push(room);
            found.push(label.clone());
        }
    }
    found
}

fn overlap(a: &[f32; 4], b: &[f32; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera that looks along y: 10 units are 60 pixels about.
    fn view() -> (Camera, ImageSize) {
        let camera = Camera::look_at(DVec3::new(0.0, -100.0, 0.0), DVec3::ZERO).unwrap();
        (camera, ImageSize::new(640, 480).unwrap())
    }

    fn square(x: f64, z: f64, half: f64, name: &str) -> Outline {
        let (camera, size) = view();
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(u, v)| DVec3::new(x + half * u, 0.0, z + half * v));
        outlined(corners.into_iter(), Label::new(DVec3::ZERO, name), &camera, size).unwrap()
    }

    #[test]
    fn two_chains_are_named_on_their_outer_sides() {
        let (camera, size) = view();
        let chain = |x: f64| (0..5).map(move |i| square(x, 8.0 - 4.0 * f64::from(i), 3.0, "torus"));
        let outlines: Vec<Outline> = chain(-4.0).chain(chain(4.0)).collect();
        let names = placed(&outlines, &camera, size);
        let anchors: Vec<Anchor> = names.iter().map(|label| label.anchor).collect();
        assert_eq!(anchors, [[Anchor::Left; 5], [Anchor::Right; 5]].concat());
    }

    #[test]
    fn names_cover_no_other_and_not_their_body() {
        let (camera, size) = view();
        for half in [0.5, 2.0, 9.0, 24.0] {
            let at = |i: i32| (f64::from(i * 7 % 11) - 5.0, f64::from(i * 5 % 7) - 3.0);
            let name = |i: i32| format!("a body of a long name, {i}");
            let outlines: Vec<Outline> =
                (0..12).map(|i| square(3.0 * at(i).0, 2.0 * at(i).1, half, &name(i))).collect();
            let names = placed(&outlines, &camera, size);
            let rooms: Vec<[f32; 4]> =
                names.iter().map(|label| label.room(&camera, size).unwrap()).collect();
            for (i, (label, room)) in names.iter().zip(&rooms).enumerate() {
                assert!(!rooms[..i].iter().any(|other| overlap(room, other)), "{half}: {i}");
                let own = outlines.iter().find(|one| one.names[0].text == label.text).unwrap();
                assert!(!overlap(room, &own.room), "{half}: {label:?}");
                assert!(room[0] >= 0.0 && room[1] >= 0.0 && room[2] <= 640.0 && room[3] <= 480.0);
            }
            assert!(!names.is_empty(), "{half}");
        }
        // A body that fills the picture has no name.
        assert!(placed(&[square(0.0, 0.0, 60.0, "wall")], &camera, size).is_empty());
    }

    #[test]
    fn what_is_behind_the_camera_has_no_outline() {
        let (camera, size) = view();
        let behind = [DVec3::new(0.0, -200.0, 0.0)];
        let name = Label::new(DVec3::ZERO, "behind");
        assert!(outlined(behind.into_iter(), name.clone(), &camera, size).is_none());
        assert!(outlined([].into_iter(), name, &camera, size).is_none());
    }
}
