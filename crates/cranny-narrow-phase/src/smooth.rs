//! Normals of contacts as the curved surfaces have them that the meshes stand for.
//!
//! A contact's own normal is that of the facets, or of the way across a gap. On a finely cut thread
//! it is off by degrees from the helicoid's, which brakes a nut. [`smooth_normal`] returns, for a
//! contact that is known, the normal of the curved surfaces ([`SmoothNormals`]) instead. Points and
//! separation are the contact's own and stay; no contact comes or goes.
//!
//! Each body has a normal at its point, or none where it is sharp. Of two, neither is wholly right:
//! the nearest points of two meshes lie beside those of the surfaces, by as much on either, so a
//! normal is wrong by that times the bend of its surface. They are mixed in inverse measure of
//! their bends: a ball on a flat floor has the floor's normal, two flanks that fit each other the
//! mean. Where one body is sharp, the other's normal counts, made square to the sharp curve if that
//! runs on; where two sharp curves cross, what is square to both. Where neither says anything, or
//! they contradict each other or the contact's own normal by more than the crease, the contact's
//! own stays: no normal is ever farther from it than the crease.

use std::sync::Arc;

use cranny_exact::DVec3;
use cranny_geometry::{
    Crease, CreaseAngleError, Edge, ModelTag, SmoothNormals, SurfaceNormal, radians_between,
};

use crate::answer::{Contact, Feature};
use crate::query::Placed;

/// The normal of a contact between two bodies as their curved surfaces have it; unit, from the
/// first to the second. A body without smooth normals is the polyhedron that it is: flat in its
/// faces, sharp at its edges and vertices.
///
/// `contact` is one of the bodies at these poses, in world coordinates.
///
/// # Panics
///
/// Where normals are another model's.
#[must_use]
pub fn smooth_normal(
    contact: &Contact,
    [a, b]: [Placed; 2],
    [smooth_a, smooth_b]: [Option<&SmoothNormals>; 2],
) -> DVec3 {
    let own = contact.normal;
    let crease = [smooth_a, smooth_b].into_iter().flatten().map(SmoothNormals::crease_angle);
    let Some(crease) = crease.reduce(f64::max) else { return own };
    let of_a = at(a, contact.id.0, contact.point_a, smooth_a);
    let of_b = at(b, contact.id.1, contact.point_b, smooth_b);
    let smooth_normal_at = match [of_a, of_b] {
        // What is flat and straight has the contact's own.
        [of_a, of_b] if !of_a.is_bent() && !of_b.is_bent() => return own,
        [Form::Curve(p), Form::Curve(q)] => across(own, p.tangent, q.tangent),
        [Form::Curve(_) | Form::Corner, Form::Curve(_) | Form::Corner] => return own,
        [Form::Surface(p), Form::Corner] => p.normal,
        [Form::Corner, Form::Surface(q)] => -q.normal,
        [Form::Surface(p), Form::Curve(curve)] => beside(p.normal, p.bend, curve),
        [Form::Curve(curve), Form::Surface(q)] => beside(-q.normal, q.bend, curve),
        [Form::Surface(p), Form::Surface(q)] if radians_between(p.normal, -q.normal) > crease => {
            return own;
        }
        [Form::Surface(p), Form::Surface(q)] => {
            let share = q.bend / (p.bend + q.bend);
            (share * p.normal - (1.0 - share) * q.normal).normalize_or_zero()
        }
    };
    let is_same = (smooth_normal_at - own).length() <= SAME;
    if is_same || radians_between(smooth_normal_at, own) > crease { own } else { smooth_normal_at }
}

/// Normals that differ by less, as chords of the unit sphere, differ by rounding: the contact's own
/// stays to the bit. Smaller: contacts of flat faces change in their last bits; larger: very fine
/// meshes stay flat.
const SAME: f64 = 1e-10;

/// What a body is at a point, in world coordinates.
enum Form {
    Surface(SurfaceNormal),
    /// Sharp, and running on.
    Curve(Crease),
    /// Sharp, and nothing more is known.
    Corner,
}

impl Form {
    fn is_bent(&self) -> bool {
        match self {
            Self::Surface(surface) => surface.bend > 0.0,
            Self::Curve(curve) => curve.bend > 0.0,
            Self::Corner => false,
        }
    }
}

/// Curves between whose tangents the sine is less run side by side: what is square to both says
/// little but how far the tangents are off. Larger: edges that cross at a small angle keep part of
/// their chords' normal; smaller: rounding and facets turn the normal about.
const SIDE_BY_SIDE: f64 = 0.1;

/// Square to two curves, as near to a normal as may be.
fn across(normal: DVec3, p: DVec3, q: DVec3) -> DVec3 {
    let square = p.cross(q);
    if square.length() < SIDE_BY_SIDE {
        let along = if p.dot(q) < 0.0 { p - q } else { p + q }.normalize();
        return (normal - normal.dot(along) * along).normalize_or(normal);
    }
    square.normalize() * square.dot(normal).signum()
}

/// The normal of a surface where a sharp curve of the other body is near: square to the curve, as
/// it is where the two are nearest. Of facets the nearest points lie beside that place. Where the
/// surface is flat, its normal is right all the same; where it bends half as much as the curve or
/// more, it is the curve that counts.
fn beside(normal: DVec3, bend: f64, curve: Crease) -> DVec3 {
    let share = if curve.bend > 0.0 { (2.0 * bend / curve.bend).min(1.0) } else { 1.0 };
    let share = if bend > 0.0 { share } else { 0.0 };
    (normal - share * normal.dot(curve.tangent) * curve.tangent).normalize_or(normal)
}

/// What a body is at a point of a feature.
fn at(
    Placed { model, pose }: Placed,
    feature: Feature,
    point: DVec3,
    smooth: Option<&SmoothNormals>,
) -> Form {
    let world_from_body = pose.world_from_body();
    let local = || world_from_body.inverse().apply(point);
    let (surface, curve) = match (feature, smooth) {
        (Feature::Vertex(v), Some(smooth)) => {
            (smooth.at_vertex(model, v), smooth.crease_at_vertex(v))
        }
        (Feature::Edge(e), Some(smooth)) => {
            let Edge { from, to, .. } = model.topology().edges()[e.index()];
            let [from, to] = [from, to].map(|v| model.mesh().position(v));
            let along = to - from;
            let share = ((local() - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            (smooth.on_edge(model, e, share), smooth.crease_on_edge(model, e, share))
        }
        (Feature::Face(f), Some(smooth)) => (smooth.on_face(model, f, local()), None),
        (Feature::Face(f), None) => {
            let normal = model.mesh().area_vector(f).try_normalize();
            (normal.map(|normal| SurfaceNormal { normal, bend: 0.0 }), None)
        }
        (Feature::Vertex(_) | Feature::Edge(_), None) => (None, None),
    };
    let turned = |v| world_from_body.apply_vector(v);
    match (surface, curve) {
        (Some(found), _) => Form::Surface(SurfaceNormal { normal: turned(found.normal), ..found }),
        (None, Some(found)) => Form::Curve(Crease { tangent: turned(found.tangent), ..found }),
        (None, None) => Form::Corner,
    }
}

/// The smooth normals of a pair's models, made at the first question and kept while it is about
/// these.
#[derive(Clone, Debug, Default)]
pub(crate) struct SmoothMemory(Option<[(ModelTag, Arc<SmoothNormals>); 2]>);

impl SmoothMemory {
    pub(crate) fn bytes(&self) -> usize {
        let both = self.0.iter().flatten();
        both.map(|(_, normals)| size_of::<SmoothNormals>() + normals.bytes()).sum()
    }

    /// Gives contacts of two bodies smooth normals.
    ///
    /// # Errors
    ///
    /// [`CreaseAngleError`].
    pub(crate) fn replace_normals(
        &mut self,
        contacts: &mut [Contact],
        bodies: [Placed; 2],
        crease_angle: f64,
    ) -> Result<(), CreaseAngleError> {
        let made = |placed: Placed| {
            let known = self.0.iter().flatten().find(|(tag, normals)| {
                tag.is_of(placed.model) && normals.crease_angle() == crease_angle
            });
            Ok(match known {
                Some(known) => known.clone(),
                None => {
                    let normals = SmoothNormals::of(placed.model, crease_angle)?;
                    (ModelTag::of(placed.model), Arc::new(normals))
                }
            })
        };
        let [a, b] = bodies;
        let first = made(a)?;
        let second = if a.model.is_same(b.model) { first.clone() } else { made(b)? };
        for contact in contacts {
            contact.normal = smooth_normal(contact, bodies, [Some(&first.1), Some(&second.1)]);
        }
        self.0 = Some([first, second]);
        Ok(())
    }
}
