//! Few contacts that stand for many.
//!
//! Contacts are gathered by direction; of each direction the deepest stays, and those that would be
//! deepest after a little turn about any of eight axes in their plane: a small turn, which leaves
//! what a body rests on with all its corners, and a larger one, which leaves what a body lands on
//! as it turns. Where these are few, the farthest of the others stay too. Every contact that stays
//! is one that was there: none is averaged.
//!
//! What contacts of one direction can press and twist is the convex hull of their places. Those
//! that bear alike keep the farthest along eight directions, of which none is farther than 45
//! degrees from the next: no corner that is left out reaches beyond the line between its neighbours
//! by more than 0.21 (half the tangent of 22.5 degrees) of the extent. The eight do not depend on
//! the contacts, so the choice changes only where another contact reaches as far.

use cranny_exact::DVec3;

use crate::answer::Contact;
use crate::contacts::nearer;

/// Cosine of the angle (15 degrees) within which normals count as one direction. Larger: more
/// contacts for a curved region; smaller: a curved region loses directions that it needs.
const SAME_DIRECTION: f64 = 0.965_925_826_289_068_3;

/// Tangents of the turns (1.1 and 8.5 degrees). Smaller than the first: what rests on a line or an
/// area loses ends and corners as it rocks. Larger than the second: contacts that no solver's step
/// comes to; without it, a coin that falls on its edge sinks in where its rim comes down.
const TURNS: [f64; 2] = [0.02, 0.15];

/// Cosine and sine of 22.5 degrees. So far from the axes that sides along them, or half-way between
/// them, are not square to any of the directions: all their points would reach as far, and rounding
/// would choose.
const ASKEW: [f64; 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];

/// Directions around a normal.
const AROUND: usize = 8;

/// Contacts of a direction that stay at least, where there are as many. More: a solver goes through
/// them in vain; fewer: each of them gives way to a greater share of the load, and a key that is
/// turned goes into its lock by a third more.
const LEAST: usize = 4;

/// Component of a normal along x from which y takes the place of x as what the directions around it
/// begin with. No common angle has this cosine, so rounding does not turn them.
const BEGINS_WITH_Y: f64 = 0.8;

/// Cosine of the angle (0.03 degrees) within which normals are one. Larger angles: a curved flank
/// gets normals that are not its own, and 0.3 degrees already cost a turning nut motion; smaller:
/// flat contacts fall apart into single points by rounding.
pub const SAME_NORMAL: f64 = 0.999_999_9;

/// Reduces contacts to the deepest of each direction and those that span its extent, 17 at most;
/// the deepest of all comes first. Any frame; ties go to the lowest ids.
#[must_use]
pub fn reduce(contacts: Vec<Contact>) -> Vec<Contact> {
    of_directions(contacts, SAME_DIRECTION)
}

/// Reduces contacts of one normal each, within 0.03 degrees, as [`reduce`] does those of a
/// direction: a flat ring on a floor keeps what it stands on, and of a curved flank every normal
/// stays. The deepest of all comes first.
#[must_use]
pub fn reduce_level(contacts: Vec<Contact>) -> Vec<Contact> {
    of_directions(contacts, SAME_NORMAL)
}

fn of_directions(mut contacts: Vec<Contact>, cosine: f64) -> Vec<Contact> {
    if contacts.len() < 2 {
        return contacts;
    }
    contacts.sort_by(nearer);
    let mut normals: Vec<DVec3> = Vec::new();
    let with_direction = |contact: Contact| {
        let known = normals.iter().position(|normal| normal.dot(contact.normal) >= cosine);
        let direction = known.unwrap_or_else(|| {
            normals.push(contact.normal);
            normals.len() - 1
        });
        (direction, contact)
    };
    let mut all: Vec<(usize, Contact)> = contacts.into_iter().map(with_direction).collect();
    // Stable: the deepest of a direction stays its first.
    all.sort_by_key(|(direction, _)| *direction);
    let groups = all.chunk_by(|(one, _), (other, _)| one == other);
    let mut kept: Vec<Contact> = groups.flat_map(spanning).collect();
    kept.sort_by(nearer);
    kept
}

/// The first of a group, which is the deepest, and those that turns would make the deepest.
fn spanning(group: &[(usize, Contact)]) -> impl Iterator<Item = Contact> {
    let mut chosen = Vec::with_capacity(1 + TURNS.len() * AROUND);
    chosen.push(0);
    if group.len() > 1 {
        let mut along = Vec::with_capacity(group.len());
        for towards in around(group[0].1.normal) {
            along.clear();
            along.extend(group.iter().map(|(_, contact)| towards.dot(contact.point_a)));
            for turn in TURNS {
                let turned = group.iter().zip(&along).map(|((_, c), x)| c.separation - turn * x);
                let deepest = turned.enumerate().min_by(|(_, x), (_, y)| x.total_cmp(y));
                chosen.extend(deepest.map(|(i, _)| i));
            }
        }
        chosen.sort_unstable();
        chosen.dedup();
    }
    while chosen.len() < LEAST.min(group.len()) {
        let clearance = |(_, contact): &(usize, Contact)| {
            let to = |&k: &usize| (group[k].1.point_a - contact.point_a).length_squared();
            chosen.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        let clearances = group.iter().map(clearance).enumerate();
        match clearances.max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0))) {
            Some((farthest, clearance)) if clearance > 0.0 => chosen.push(farthest),
            _ => break,
        }
    }
    chosen.into_iter().map(|i| group[i].1)
}

/// Directions square to a normal.
fn around(normal: DVec3) -> [DVec3; AROUND] {
    let begin = if normal.x.abs() > BEGINS_WITH_Y { DVec3::Y } else { DVec3::X };
    let u = normal.cross(begin).normalize_or_zero();
    let v = normal.cross(u);
    let [c, s] = ASKEW;
    let quarter = [c * u + s * v, s * u + c * v, c * v - s * u, s * v - c * u];
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k: usize| if k < 4 { quarter[k] } else { -quarter[k - 4] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Feature;
    use cranny_geometry::{FaceId, VertexId};
    use cranny_testkit::Rng;

    fn contact(i: u32, x: f64, y: f64, separation: f64, normal: DVec3) -> Contact {
        let p = DVec3::new(x, y, 0.0);
        Contact {
            id: (Feature::Vertex(VertexId(i)), Feature::Face(FaceId(0))),
            point_a: p,
            point_b: p + normal * separation,
            normal,
            separation,
        }
    }

    fn has(kept: &[Contact], x: f64, y: f64) -> bool {
        kept.iter().any(|c| c.point_a.x == x && c.point_a.y == y)
    }

    #[test]
    fn a_crowd_keeps_its_deepest_and_its_corners() {
        let crowd = (0..100)
            .map(|i| {
                let (x, y) = (f64::from(i % 10), f64::from(i / 10));
                contact(i, x, y, if i == 44 { -0.5 } else { 0.0 }, DVec3::Z)
            })
            .collect();
        let kept = reduce(crowd);
        assert_eq!(kept.len(), 5);
        assert_eq!(kept[0].separation, -0.5);
        let corner =
            |c: &Contact| [0.0, 9.0].contains(&c.point_a.x) && [0.0, 9.0].contains(&c.point_a.y);
        assert!(kept[1..].iter().all(corner), "{kept:?}");
    }

    /// Whichever of equal ones rounding makes the deepest, in a corner or amid a face, the corners
    /// stay.
    #[test]
    fn rounding_costs_no_corner() {
        for deepest in 0..100 {
            let level = |i: u32| if i == deepest { -1e-12 } else { 1e-13 * f64::from(i % 7) };
            let at = |i: u32| (f64::from(i % 10), f64::from(i / 10));
            let crowd = (0..100).map(|i| contact(i, at(i).0, at(i).1, level(i), DVec3::Z));
            let kept = reduce(crowd.collect());
            for (x, y) in [(0.0, 0.0), (9.0, 0.0), (0.0, 9.0), (9.0, 9.0)] {
                assert!(has(&kept, x, y), "{deepest}: {kept:?}");
            }
            assert!(kept.len() <= 5, "{deepest}: {kept:?}");
        }
    }

    /// What rests on a line across a floor, and has more of itself above the floor on both sides.
    #[test]
    fn a_line_keeps_both_its_ends() {
        let beside = (0..50).map(|i| {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            contact(100 + i, side * 0.2, 0.02 * f64::from(i), 0.02, DVec3::Z)
        });
        let line = (0..11).map(|i| {
            // Rocked by half a degree.
            contact(i, 0.0, 0.1 * f64::from(i), 0.0009 * f64::from(i), DVec3::Z)
        });
        let kept = reduce(line.chain(beside).collect());
        assert!(has(&kept, 0.0, 0.0) && has(&kept, 0.0, 1.0), "{kept:?}");
    }

    /// A coin of many sides over a floor, on its edge: whichever way it turns on, by up to ten
    /// degrees, what was kept goes in nearly as deep as all of it.
    #[test]
    fn a_turn_brings_nothing_down_that_was_left_out() {
        let mut worst = 0.0f64;
        for lean in [0.0f64, 0.02, 0.05, 0.1] {
            let rim: Vec<Contact> = (0..64)
                .map(|i| {
                    let angle = std::f64::consts::TAU * f64::from(i) / 64.0;
                    let (x, y) = (0.5 * angle.cos(), 0.5 * angle.sin());
                    contact(i, x, y, lean * (0.5 - x), DVec3::Z)
                })
                .collect();
            let kept = reduce(rim.clone());
            for k in 0..72 {
                let (s, c) = f64::from(5 * k).to_radians().sin_cos();
                for turn in [0.0, 0.02, 0.05, 0.1, 0.15, 0.18] {
                    let depth = |all: &[Contact]| {
                        let turned = |p: DVec3| turn * (c * p.x + s * p.y);
                        let deep = all.iter().map(|p| turned(p.point_a) - p.separation);
                        deep.fold(f64::NEG_INFINITY, f64::max)
                    };
                    worst = worst.max(depth(&rim) - depth(&kept));
                }
            }
        }
        // Of what 0.18 of a radius of 0.5 comes down by, which is 0.09.
        assert!(worst < 0.02, "{worst}");
    }

    /// The most that contacts can press along a wrench's force and twist along its torque, with
    /// forces of 1 in all.
    fn support(contacts: &[Contact], force: DVec3, torque: DVec3) -> f64 {
        let wrench = |c: &Contact| force.dot(c.normal) + torque.dot(c.point_a.cross(c.normal));
        contacts.iter().map(wrench).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Wrenches of the kept contacts against those of all, over directions, on areas of many forms.
    #[test]
    fn few_contacts_press_and_twist_as_all_do() {
        let mut rng = Rng::new(31);
        let mut worst = 0.0f64;
        for round in 0..400 {
            let (long, count) = (rng.unit().abs(), 3 + rng.below(60) as u32);
            let mut place = |i: u32| match round % 4 {
                0 => {
                    let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                    (angle.cos(), long * angle.sin())
                }
                1 => (rng.unit(), long * rng.unit()),
                // A blunt corner above a line.
                2 => {
                    let x = rng.unit();
                    (x, 0.4 * long * (1.0 - x.abs()))
                }
                _ => (if i.is_multiple_of(2) { 0.7 } else { -0.7 }, long * rng.unit()),
            };
            let all: Vec<Contact> = (0..count)
                .map(|i| (i, place(i)))
                .map(|(i, (x, y))| contact(i, x, y, 0.0, DVec3::Z))
                .collect();
            let places: Vec<DVec3> = all.iter().map(|c| c.point_a).collect();
            let apart = places.iter().flat_map(|p| places.iter().map(move |q| (p - q).length()));
            let extent = apart.fold(0.0, f64::max);
            let kept = reduce(all.clone());
            assert!(kept.len() <= 9, "{}: all bear alike", kept.len());
            for k in 0..360 {
                let angle = f64::from(k).to_radians();
                let torque = DVec3::new(angle.cos(), angle.sin(), rng.unit());
                let force = DVec3::new(rng.unit(), rng.unit(), rng.unit());
                let lost = support(&all, force, torque) - support(&kept, force, torque);
                worst = worst.max(lost / extent);
                assert!(lost > -1e-12 && lost < 0.21 * extent, "round {round}: {lost} of {extent}");
            }
        }
        assert!(worst > 0.1, "{worst}: blunt corners lose much");
    }

    /// A box of fine sides slides over a floor: its corners bear from step to step, and nothing
    /// else comes or goes.
    #[test]
    fn sliding_changes_nothing() {
        let at = |i: u32| (0.1 * f64::from(i % 11), 0.1 * f64::from(i / 11));
        let corners = [0, 10, 110, 120].map(|i| Feature::Vertex(VertexId(i)));
        for step in 0..300 {
            let shift = 0.01 * f64::from(step);
            for turned in [0.0, 0.3 * shift] {
                let all = (0..121).map(|i| {
                    let (x, y) = at(i);
                    let (x, y) = (x + shift, y + 0.37 * shift);
                    let (x, y) = (x - turned * y, y + turned * x);
                    contact(i, x, y, 1e-9 * (shift * f64::from(i)).sin(), DVec3::Z)
                });
                let kept = reduce(all.collect());
                let held = corners.iter().filter(|f| kept.iter().any(|c| c.id.0 == **f)).count();
                // The deepest by rounding may be any other.
                assert!(held == 4 && kept.len() <= 5, "step {step}: {kept:?}");
            }
        }
    }

    #[test]
    fn every_direction_stays() {
        let kept = reduce(vec![
            contact(0, 0.0, 0.0, 0.1, DVec3::X),
            contact(1, 0.0, 0.0, 0.2, DVec3::Y),
            contact(2, 0.0, 0.0, 0.05, DVec3::Y),
        ]);
        assert_eq!(kept.iter().map(|c| c.normal).collect::<Vec<_>>(), [DVec3::Y, DVec3::X]);
        assert_eq!(kept[0].separation, 0.05);
    }

    /// A fine ring stands on a few of its contacts; a slightly curved flank keeps each of its
    /// normals.
    #[test]
    fn what_is_level_keeps_what_it_stands_on() {
        let at = |i: u32| f64::from(i).to_radians().sin_cos();
        let ring = |i: u32| contact(i, at(i).0, at(i).1, 0.0, DVec3::Z);
        let all: Vec<Contact> = (0..360).map(ring).collect();
        let kept = reduce_level(all.clone());
        assert!((4..=17).contains(&kept.len()), "{}", kept.len());
        for k in 0..72 {
            let (s, c) = f64::from(5 * k).to_radians().sin_cos();
            let torque = DVec3::new(c, s, 0.0);
            let [most, held] = [&all, &kept].map(|of| support(of, DVec3::ZERO, torque));
            assert!(held > 0.9 * most, "{held} of {most} along {torque}");
        }
        let curved = |i: u32| {
            let normal = DVec3::new(1e-3 * f64::from(i), 0.0, 1.0).normalize();
            contact(i, f64::from(i), 0.0, 0.0, normal)
        };
        assert_eq!(reduce_level((0..50).map(curved).collect()).len(), 50);
    }
}
