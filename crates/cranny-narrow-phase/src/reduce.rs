//! Few contacts that stand for many.
//!
//! Contacts are gathered by direction; of each direction the deepest stays, and up to three more
//! that span the extent. Every contact that stays is one that was there: none is averaged.

use cranny_exact::DVec3;

use crate::answer::Contact;

/// Cosine of the angle (15 degrees) within which normals count as one direction. Larger: more
/// contacts for a curved region; smaller: a curved region loses directions that it needs.
const SAME_DIRECTION: f64 = 0.965_925_826_289_068_3;

/// Contacts kept per direction: a plane needs three to stand and one to spare.
const PER_DIRECTION: usize = 4;

/// Reduces contacts to the deepest of each direction and up to three more that span its extent; the
/// deepest of all comes first. Any frame; ties go to the lowest ids.
#[must_use]
pub fn reduce(mut contacts: Vec<Contact>) -> Vec<Contact> {
    let order =
        |x: &Contact, y: &Contact| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id));
    contacts.sort_by(order);
    let mut directions: Vec<Vec<Contact>> = Vec::new();
    for contact in contacts {
        let home =
            directions.iter_mut().find(|d| d[0].normal.dot(contact.normal) >= SAME_DIRECTION);
        match home {
            Some(group) => group.push(contact),
            None => directions.push(vec![contact]),
        }
    }
    let mut kept: Vec<Contact> = directions.iter().flat_map(|group| spanning(group)).collect();
    kept.sort_by(order);
    kept
}

/// The first of a group and those that lie farthest from what is already chosen.
fn spanning(group: &[Contact]) -> Vec<Contact> {
    let mut kept = vec![group[0]];
    while kept.len() < PER_DIRECTION {
        let clearance = |p: DVec3| {
            kept.iter().map(|k| (k.point_a - p).length_squared()).fold(f64::INFINITY, f64::min)
        };
        let farthest = group
            .iter()
            .map(|c| (clearance(c.point_a), c))
            .max_by(|x, y| x.0.total_cmp(&y.0).then(y.1.id.cmp(&x.1.id)));
        match farthest {
            Some((clearance, contact)) if clearance > 0.0 => kept.push(*contact),
            _ => break,
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Feature;
    use cranny_geometry::{FaceId, VertexId};

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

    #[test]
    fn a_crowd_keeps_its_deepest_and_its_corners() {
        let crowd = (0..100)
            .map(|i| {
                let (x, y) = (f64::from(i % 10), f64::from(i / 10));
                contact(i, x, y, if i == 44 { -0.5 } else { 0.0 }, DVec3::Z)
            })
            .collect();
        let kept = reduce(crowd);
        assert_eq!(kept.len(), 4);
        assert_eq!(kept[0].separation, -0.5);
        let corner =
            |c: &Contact| [0.0, 9.0].contains(&c.point_a.x) && [0.0, 9.0].contains(&c.point_a.y);
        assert!(kept[1..].iter().all(corner), "{kept:?}");
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
}
