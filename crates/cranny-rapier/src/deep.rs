//! The way out for bodies that overlap deeply: a fast start, a bad initial pose, a solver that failed.
//!
//! Nearest points tell a way out as long as bodies overlap by less than they are thick. Beyond, a vertex is
//! nearer to the far side of what it is stuck in, and the body is torn between ways; and wholly inside a
//! solid it meets no surface at all. Then one direction has to hold for the whole body:
//!
//! - where surfaces meet, that of the region of contact ([`Region::normal`](cranny_narrow_phase::Region)), the
//!   direction of the area that the curves enclose: it leads back where the body came in, though where a body
//!   overhangs it is oblique, and not the shortest way;
//! - wholly inside, that to the nearest point of the outer surface.
//!
//! Along it, each vertex that is inside has the plane of the other surface before it, as if that were a
//! half-space; so a body moves out as it is, without a turn. How fast is the solver's to say: it corrects by
//! no more than `max_corrective_velocity`, and takes that velocity away again.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{FaceId, Model, VertexId};
use cranny_narrow_phase::{
    Answer, Contact, Containment, Demand, Feature, PairMemory, Region, reduce_contacts,
};

use crate::ask::ask;
use crate::partners::{half_space_contacts, holds};

/// What overlaps by more than this share of the thinner body's thickness, has one way out. Larger: a plate
/// whose middle was passed is pulled through; smaller: curved contacts lose the normals of their own points
/// while they could still tell.
const DEEP: f64 = 0.5;

/// Vertices at least this share of the deepest one's depth inside are led out. Larger: too few to lead a body
/// without turning it; smaller: some of those that stand for it are hardly inside.
const LED: f64 = 0.9;

/// How deep the deepest vertex is told to be, as a share of the thinner body's thickness; all others are told to be
/// as much less deep as they are. The solver caps the speed at which it leads out, and told the whole depth
/// of all, would lead all at that one speed: what leans would go on leaning. Larger: just that; smaller: it takes longer.
const TOLD: f64 = 0.15;

/// Cosine of the angle (a right one and 15 degrees more) up to which what else touches leaves the way out free.
/// Larger: what bears on a side at a right angle comes and goes by rounding; smaller: the far side holds the body in.
const ASIDE: f64 = -0.25;

/// Twice the volume per area of a body (a plate's thickness, a wire's radius); infinite where it bounds no volume.
pub(crate) fn thickness(model: &Model) -> f64 {
    let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
    let area: f64 = faces.map(|face| model.mesh().area_vector(face).length()).sum();
    let volume = model.mass_properties().map(|mass| mass.volume);
    volume.filter(|v| *v > 0.0).map_or(f64::INFINITY, |v| 2.0 * v / area)
}

/// Contacts in place of an answer's own (first body's frame), where those do not lead out; `None` where they do.
pub(crate) fn way_out(
    models: &[Model; 2],
    thickness: f64,
    pose: &Pose,
    answer: &Answer,
    reach: f64,
    memory: &mut PairMemory,
) -> Option<Vec<Contact>> {
    if !answer.solid {
        return None;
    }
    let told = TOLD * thickness;
    if let Some(contained) = answer.contained {
        return out_of_a_solid(models, pose, contained, memory)
            .map(|led| leveled(led, told, reach));
    }
    let deep = DEEP * thickness;
    if answer.contacts.iter().all(|c| -c.separation < deep) {
        return None;
    }
    let asked;
    let regions = if answer.regions.is_empty() {
        asked = ask(models.each_ref(), *pose, Demand::Regions { margin: 0.0 }, memory)?.regions;
        &asked
    } else {
        &answer.regions
    };
    let depth = |region: &&Region| region.depth.unwrap_or(0.0);
    let deepest = || regions.iter().filter(|r| depth(r) >= deep);
    // Of ways that contradict each other, the shortest.
    let way = deepest().min_by(|x, y| depth(x).total_cmp(&depth(y)))?.normal;
    let mut contacts: Vec<Contact> = deepest()
        .filter(|region| region.normal.dot(way) >= ASIDE)
        .flat_map(|region| leveled(out_of_a_region(models, pose, region), told, reach))
        .collect();
    // What touches elsewhere stays, unless it holds the body in.
    let shallow = answer.contacts.iter().filter(|c| -c.separation < deep);
    contacts.extend(shallow.filter(|c| c.normal.dot(way) >= ASIDE));
    contacts.sort_by(|x, y| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id)));
    Some(contacts)
}

/// The same contacts, all nearer to the surface by the same length, so that the deepest is as deep as `told`; without
/// those that then are out of reach.
fn leveled(mut contacts: Vec<Contact>, told: f64, reach: f64) -> Vec<Contact> {
    let deepest = contacts.iter().map(|c| -c.separation).fold(0.0, f64::max);
    let nearer = (deepest - told).max(0.0);
    for contact in &mut contacts {
        contact.separation += nearer;
        contact.point_b += contact.normal * nearer;
    }
    contacts.retain(|c| c.separation <= reach);
    contacts
}

/// Of each vertex that lies well inside the other body, along the region's normal.
fn out_of_a_region(models: &[Model; 2], pose: &Pose, region: &Region) -> Vec<Contact> {
    let (normal, deepest) = (region.normal, region.deepest);
    let first_from_second = pose.world_from_body();
    let second_from_first = first_from_second.inverse();
    // No part of a body has farther to go than the region says.
    let depth = -deepest.separation;
    let led = |separation: f64| separation <= -LED * depth;
    let mut contacts = Vec::new();
    for (v, &p) in models[0].mesh().vertices().iter().enumerate() {
        let separation = normal.dot(deepest.point_b - p).max(-depth);
        if led(separation) && holds(&models[1], second_from_first.apply(p)) {
            contacts.push(Contact {
                id: (Feature::Vertex(VertexId(v as u32)), deepest.id.1),
                point_a: p,
                point_b: p + normal * separation,
                normal,
                separation,
            });
        }
    }
    for (v, &q) in models[1].mesh().vertices().iter().enumerate() {
        let q = first_from_second.apply(q);
        let separation = normal.dot(q - deepest.point_a).max(-depth);
        if led(separation) && holds(&models[0], q) {
            contacts.push(Contact {
                id: (deepest.id.0, Feature::Vertex(VertexId(v as u32))),
                point_a: q - normal * separation,
                point_b: q,
                normal,
                separation,
            });
        }
    }
    if contacts.is_empty() {
        return region.points.clone(); // edges that cross, no vertex inside
    }
    reduce_contacts(contacts)
}

/// A body wholly inside another: out through the nearest point of that one's surface.
fn out_of_a_solid(
    models: &[Model; 2],
    pose: &Pose,
    contained: Containment,
    memory: &mut PairMemory,
) -> Option<Vec<Contact>> {
    let answer = ask(models.each_ref(), *pose, Demand::Distance { below: None }, memory)?;
    let [first, second] = answer.witnesses?;
    let (inner, outer) = match contained {
        Containment::AInB => (first, second),
        Containment::BInA => (second, first),
    };
    let first_from_second = pose.world_from_body();
    // From within, the surfaces' nearest points lie on the way out; where they touch, a face has to tell.
    let outward = (outer.point - inner.point).try_normalize().or_else(|| match outer.feature {
        Feature::Face(face) if contained == Containment::BInA => {
            models[0].mesh().area_vector(face).try_normalize()
        }
        Feature::Face(face) => {
            let normal = models[1].mesh().area_vector(face);
            first_from_second.apply_vector(normal).try_normalize()
        }
        _ => None,
    })?;
    // Only what lies deepest is led: it stands for the whole body.
    let led = |model: &Model, normal: DVec3, offset: f64| {
        let heights = model.mesh().vertices().iter().map(|&p| normal.dot(p) - offset);
        let deepest = heights.fold(0.0, f64::min);
        let contacts = half_space_contacts(model, normal, offset, LED * deepest);
        contacts.into_iter().map(|c| Contact { id: (c.id.0, outer.feature), ..c })
    };
    Some(match contained {
        Containment::AInB => led(&models[0], outward, outward.dot(outer.point)).collect(),
        Containment::BInA => {
            let second_from_first = first_from_second.inverse();
            let normal = second_from_first.apply_vector(outward);
            let offset = normal.dot(second_from_first.apply(outer.point));
            led(&models[1], normal, offset).map(|c| c.moved(&first_from_second).swapped()).collect()
        }
    })
}
