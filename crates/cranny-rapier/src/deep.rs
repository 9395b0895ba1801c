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
//! Along it the body of the lesser volume, or the one inside, is led by three contacts that do not turn it (`lead`). How
//! fast is the solver's to say: it corrects by no more than `max_corrective_velocity`, and takes that velocity away
//! again.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{
    Answer, Contact, Containment, Demand, Feature, PairMemory, Query, Region,
};

use crate::ask::ask;
use crate::lead::places;

/// What overlaps by more than this share of the thinner body's thickness, has one way out. Larger: a plate
/// whose middle was passed is pulled through; smaller: curved contacts lose the normals of their own points
/// while they could still tell.
const DEEP: f64 = 0.5;

/// How deep a body is told to be at most, as a share of the thinner one's thickness. Larger: it shoots out; smaller: it
/// takes longer.
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
    models: [&Model; 2],
    thickness: f64,
    pose: &Pose,
    answer: &Answer,
    memory: &mut PairMemory,
) -> Option<Vec<Contact>> {
    if !answer.solid {
        return None;
    }
    let told = TOLD * thickness;
    if let Some(contained) = answer.contained {
        return out_of_a_solid(models, pose, contained, told, memory);
    }
    let deep = DEEP * thickness;
    if answer.contacts.iter().all(|c| -c.separation < deep) {
        return None;
    }
    let asked;
    let regions = if answer.regions.is_empty() {
        asked = ask(models, *pose, &Query::of(Demand::Regions { margin: 0.0 }), memory)?.regions;
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
        .flat_map(|region| out_of_a_region(models, pose, region, told))
        .collect();
    // What touches elsewhere stays, unless it holds the body in.
    let shallow = answer.contacts.iter().filter(|c| -c.separation < deep);
    contacts.extend(shallow.filter(|c| c.normal.dot(way) >= ASIDE));
    contacts.sort_by(|x, y| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id)));
    Some(contacts)
}

/// The lesser body, along the region's normal.
fn out_of_a_region(models: [&Model; 2], pose: &Pose, region: &Region, told: f64) -> [Contact; 3] {
    let volume = |model: &Model| model.mass_properties().map_or(0.0, |mass| mass.volume);
    let first = volume(models[0]) <= volume(models[1]);
    let deepest = &region.deepest;
    let depth = -deepest.separation;
    led(models, pose, first, region.normal, deepest.point_a, depth.min(told))
        .map(|lead| Contact { id: deepest.id, ..lead })
}

/// Contacts so deep that lead the first body, or else the second, along a normal (from first to second); through a
/// point. Told as of the first faces.
fn led(
    models: [&Model; 2],
    pose: &Pose,
    first: bool,
    normal: DVec3,
    through: DVec3,
    depth: f64,
) -> [Contact; 3] {
    let places = if first {
        places(models[0], normal)
    } else {
        let map = pose.world_from_body();
        places(models[1], map.inverse().apply_vector(normal)).map(|p| map.apply(p))
    };
    places.map(|place| {
        let point_a = place + normal * normal.dot(through - place);
        Contact {
            id: (Feature::Face(FaceId(0)), Feature::Face(FaceId(0))),
            point_a,
            point_b: point_a - normal * depth,
            normal,
            separation: -depth,
        }
    })
}

/// A body wholly inside another: out through the nearest point of that one's surface.
fn out_of_a_solid(
    models: [&Model; 2],
    pose: &Pose,
    contained: Containment,
    told: f64,
    memory: &mut PairMemory,
) -> Option<Vec<Contact>> {
    let answer = ask(models, *pose, &Query::of(Demand::Distance { below: None }), memory)?;
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
    let inner_first = contained == Containment::AInB;
    let second_from_first = pose.world_from_body().inverse();
    let (model, way, through) = match inner_first {
        true => (models[0], outward, outer.point),
        false => {
            let way = second_from_first.apply_vector(outward);
            (models[1], way, second_from_first.apply(outer.point))
        }
    };
    let heights = model.mesh().vertices().iter().map(|&p| way.dot(through - p));
    let depth = heights.fold(0.0, f64::max);
    let normal = if inner_first { -outward } else { outward };
    let [a, b] = [first.feature, second.feature];
    let leads = led(models, pose, inner_first, normal, outer.point, depth.min(told));
    Some(leads.map(|lead| Contact { id: (a, b), ..lead }).to_vec())
}
