//! The way out for bodies that overlap deeply: a fast start, a bad initial pose, a solver that
//! failed.
//!
//! Nearest points lead out as long as bodies overlap by less than they are thick. Beyond, a vertex
//! is nearer to the far side of what it is stuck in, and the body is torn between ways. Wholly
//! inside a solid it meets no surface at all. Then one direction holds for the whole body:
//!
//! - where surfaces meet, that of the region of contact ([`Penetration::normal`]), mostly the
//!   direction of the area that the curves enclose: it leads back where the body came in. Where a
//!   body overhangs it is oblique, and not the shortest way;
//! - wholly inside, that to the nearest point of the outer surface.
//!
//! Along it the body of the lesser volume, or the one inside, is led by three contacts that do not
//! turn it ([`percussion_centers`]). The solver sets how fast: it should correct by a bounded
//! velocity, and take that velocity away again.
//!
//! A way that nothing else touches lasts while the body goes on along it ([`lasts`]): its leads
//! ride with the bodies, and no search is needed meanwhile.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{
    Answer, Contact, Containment, Demand, Feature, PairMemory, Penetration, QueryError,
};

use crate::percussion::percussion_centers;
use crate::rounded::query_pair;

/// What overlaps by more than this share of the thinner body's thickness has one way out. Larger:
/// a plate whose middle was passed is pulled through; smaller: curved contacts lose the normals of
/// their own points while these still lead out.
const DEEP: f64 = 0.5;

/// The greatest depth of a contact that leads out, as a share of the thinner body's thickness.
/// Larger: the body shoots out; smaller: it takes longer.
const LED_DEPTH: f64 = 0.15;

/// The drift through which the leads of a way out stay as they are, as a share of the thinner
/// body's thickness. Larger: the body goes on along a direction that is no longer its overlap's,
/// and is led on where it has come out by as much; smaller: it is searched for in each step.
const LASTS: f64 = 0.05;

/// Cosine of the angle (105 degrees) up to which what else touches leaves the way out free. Larger:
/// what bears on a side at a right angle comes and goes by rounding; smaller: the far side holds
/// the body in.
const ASIDE: f64 = -0.25;

/// Twice the volume per area of a body (a plate's thickness, a wire's radius); infinite where it
/// bounds no volume.
#[must_use]
pub fn thickness(model: &Model) -> f64 {
    let faces = model.mesh().face_ids();
    let area: f64 = faces.map(|face| model.mesh().area_vector(face).length()).sum();
    let volume = model.mass_properties().map(|mass| mass.volume);
    volume.filter(|v| *v > 0.0).map_or(f64::INFINITY, |v| 2.0 * v / area)
}

/// How deep a contact is from which on two bodies are led out of each other; `thickness` is the
/// lesser of theirs.
#[must_use]
pub fn deep(thickness: f64) -> f64 {
    DEEP * thickness
}

/// How far two bodies may drift from where a way out was found and still be led along it.
#[must_use]
pub fn lasts(thickness: f64) -> f64 {
    LASTS * thickness
}

/// A lead as a solver gets it: no deeper than a share of the lesser thickness, or the body would
/// shoot out.
#[must_use]
pub fn eased(lead: Contact, thickness: f64) -> Contact {
    let separation = lead.separation.max(-LED_DEPTH * thickness);
    Contact { point_b: lead.point_a + lead.normal * separation, separation, ..lead }
}

/// Contacts that lead two bodies out of each other, in the first body's frame.
#[derive(Clone, Debug, Default)]
pub struct WayOut {
    /// Three for each overlap, as deep as it is.
    pub leads: Vec<Contact>,
    /// What else touches, and leaves the way free.
    pub beside: Vec<Contact>,
}

impl WayOut {
    /// As a solver gets them: leads [`eased`], the deepest first.
    #[must_use]
    pub fn contacts(&self, thickness: f64) -> Vec<Contact> {
        let leads = self.leads.iter().map(|&lead| eased(lead, thickness));
        let mut contacts: Vec<Contact> = leads.chain(self.beside.iter().copied()).collect();
        contacts.sort_by(|x, y| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id)));
        contacts
    }
}

/// The way by which a solver leads two bodies out of each other, in place of an answer's contacts;
/// `None` where those do. All is in the first body's frame: `answer` is one of at least
/// [`Demand::Contacts`] about the first model at the origin and the second one at the pose, with
/// [penetrations from](cranny_narrow_phase::Query::penetrations_from) [`deep`] on.
/// `thickness` is the lesser of the bodies' [`thickness`].
///
/// # Errors
///
/// [`QueryError`] where the pose is invalid.
pub fn way_out(
    models: [&Model; 2],
    thickness: f64,
    first_from_second: &Pose,
    answer: &Answer,
    memory: &mut PairMemory,
) -> Result<Option<WayOut>, QueryError> {
    let pose = first_from_second;
    if !answer.solid {
        return Ok(None);
    }
    if let Some(contained) = answer.contained {
        let leads = out_of_a_solid(models, pose, contained, memory)?;
        return Ok(leads.map(|leads| WayOut { leads: leads.to_vec(), beside: Vec::new() }));
    }
    let deep = deep(thickness);
    if answer.contacts.iter().all(|c| -c.separation < deep) {
        return Ok(None);
    }
    let deepest = || answer.penetrations.iter().filter(|overlap| overlap.depth() >= deep);
    // Of ways that contradict each other, the shortest.
    let Some(shortest) = deepest().min_by(|x, y| x.depth().total_cmp(&y.depth())) else {
        return Ok(None);
    };
    let way = shortest.normal;
    let leads = deepest()
        .filter(|overlap| overlap.normal.dot(way) >= ASIDE)
        .flat_map(|overlap| out_of_an_overlap(models, pose, overlap));
    // What touches elsewhere stays, unless it holds the body in.
    let shallow = answer.contacts.iter().filter(|c| -c.separation < deep);
    let beside = shallow.filter(|c| c.normal.dot(way) >= ASIDE).copied();
    Ok(Some(WayOut { leads: leads.collect(), beside: beside.collect() }))
}

/// The lesser body, along the overlap's normal.
fn out_of_an_overlap(models: [&Model; 2], pose: &Pose, overlap: &Penetration) -> [Contact; 3] {
    let volume = |model: &Model| model.mass_properties().map_or(0.0, |mass| mass.volume);
    let first = volume(models[0]) <= volume(models[1]);
    let deepest = &overlap.deepest;
    led(models, pose, first, overlap.normal, deepest.point_a, overlap.depth())
        .map(|lead| Contact { id: deepest.id, ..lead })
}

/// Contacts so deep that lead the first body, or else the second, along a normal (from first to
/// second); through a point. Their features are the first faces.
fn led(
    models: [&Model; 2],
    pose: &Pose,
    first: bool,
    normal: DVec3,
    through: DVec3,
    depth: f64,
) -> [Contact; 3] {
    let places = if first {
        percussion_centers(models[0], normal)
    } else {
        let map = pose.world_from_body();
        percussion_centers(models[1], map.inverse().apply_vector(normal)).map(|p| map.apply(p))
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
    memory: &mut PairMemory,
) -> Result<Option<[Contact; 3]>, QueryError> {
    let answer = query_pair(models, pose, Demand::Distance { below: None }, memory)?;
    let Some([first, second]) = answer.witnesses else { return Ok(None) };
    let (inner, outer) = match contained {
        Containment::AInB => (first, second),
        Containment::BInA => (second, first),
    };
    let first_from_second = pose.world_from_body();
    // From within, the surfaces' nearest points lie on the way out; where they touch, the outer
    // face's normal does.
    let outward = (outer.point - inner.point).try_normalize();
    let outward = outward.or_else(|| match outer.feature {
        Feature::Face(face) if contained == Containment::BInA => {
            models[0].mesh().area_vector(face).try_normalize()
        }
        Feature::Face(face) => {
            let normal = models[1].mesh().area_vector(face);
            first_from_second.apply_vector(normal).try_normalize()
        }
        _ => None,
    });
    let Some(outward) = outward else { return Ok(None) };
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
    let leads = led(models, pose, inner_first, normal, outer.point, depth);
    Ok(Some(leads.map(|lead| Contact { id: (a, b), ..lead })))
}
