//! What touches: points, normals and curves, in the world.

use cranny_exact::{DVec3, Pose};
use cranny_record::{ContactsMessage, DrawnContact, DrawnCurve};
use re_sdk::EntityPath;

use crate::archetypes::{Arrows3D, LineStrips3D, Points3D};
use crate::colors;
use crate::components::Radius;
use crate::error::RerunError;
use crate::source::Source;
use crate::stream::{Stream, path};

/// The group of contacts.
pub(crate) const GROUP: &str = "contacts";

/// Radius of a point, in points of the screen: it stays that large from near and far. Smaller:
/// points drown in a mesh; larger: they hide the region that they mark.
const POINT_RADIUS: f32 = 4.0;

/// Of curves and arrows. Smaller: lines drown in a mesh; larger: they hide small regions.
const LINE_RADIUS: f32 = 1.5;

/// Length of an arrow, in parts of the smallest body's diagonal. Smaller: arrows hide in their
/// points; larger: they hide the neighbours.
const ARROW_LENGTH: f64 = 0.15;

/// Length of an arrow where no body has a size, units of length.
const LONE_ARROW_LENGTH: f64 = 0.1;

/// Writes all contacts.
pub(crate) fn tell(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    tell_points(stream, source)?;
    tell_normals(stream, source)?;
    tell_curves(stream, &source.curves)
}

fn entity(name: &str) -> EntityPath {
    path(&[GROUP], name)
}

/// Points with a label each, which the viewer shows on hovering.
fn tell_points(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    let path = entity("points");
    let looks = Points3D::update_fields()
        .with_radii([Radius::new_ui_points(POINT_RADIUS)])
        .with_show_labels(false);
    stream.once(&path, &looks)?;
    let deepest = deepest(&source.points);
    let rows: Vec<_> = source.points.iter().map(|(time, points)| (*time, &points[..])).collect();
    stream.rows(&path, &rows, |rows| {
        let contacts = rows.iter().flat_map(|(_, contacts)| *contacts);
        let labels = rows.iter().flat_map(|(time, contacts)| {
            let pairs = source.pairs(*time);
            contacts.iter().map(move |contact| label(contact, pairs))
        });
        let points = Points3D::new(contacts.clone().map(|contact| contact.point))
            .with_colors(contacts.map(|contact| colors::of_contact(contact.separation, deepest)))
            .with_labels(labels);
        Ok(points.columns(lengths(rows))?.collect())
    })
}

/// Depth of the deepest contact of all.
fn deepest(points: &[(u64, Vec<DrawnContact>)]) -> f32 {
    let contacts = points.iter().flat_map(|(_, contacts)| contacts);
    contacts.map(|contact| -contact.separation).fold(0.0, f32::max)
}

fn label(contact: &DrawnContact, pairs: Option<&ContactsMessage>) -> String {
    let how = match contact.separation > 0.0 {
        true => format!("{} apart", contact.separation),
        false => format!("{} deep", contact.separation.abs()),
    };
    match pairs.and_then(|message| message.pairs.get(contact.pair)) {
        Some(pair) => format!("{} and {}: {how}", pair.a, pair.b),
        None => how,
    }
}

fn tell_normals(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    let path = entity("normals");
    let looks = Arrows3D::update_fields()
        .with_radii([Radius::new_ui_points(LINE_RADIUS)])
        .with_colors([colors::NORMAL]);
    stream.once(&path, &looks)?;
    let length = arrow_length(source);
    let rows: Vec<_> = source.normals.iter().map(|(time, poses)| (*time, &poses[..])).collect();
    stream.rows(&path, &rows, |rows| {
        let poses = rows.iter().flat_map(|(_, poses)| *poses);
        let vector = |pose: &Pose| (pose.rotation * (length * DVec3::X)).as_vec3().to_array();
        let arrows = Arrows3D::from_vectors(poses.clone().map(vector))
            .with_origins(poses.map(|pose| pose.translation.as_vec3().to_array()));
        Ok(arrows.columns(lengths(rows))?.collect())
    })
}

fn arrow_length(source: &Source) -> f64 {
    let bodies = source.bodies.iter().flat_map(|(_, changes)| &changes.came);
    let diagonals = bodies.map(|body| body.mesh.bounds().diagonal()).filter(|&d| d > 0.0);
    diagonals.reduce(f64::min).map_or(LONE_ARROW_LENGTH, |smallest| ARROW_LENGTH * smallest)
}

fn tell_curves(stream: &Stream, curves: &[(u64, Vec<DrawnCurve>)]) -> Result<(), RerunError> {
    let path = entity("curves");
    let looks = LineStrips3D::update_fields()
        .with_radii([Radius::new_ui_points(LINE_RADIUS)])
        .with_colors([colors::CURVE]);
    stream.once(&path, &looks)?;
    let rows: Vec<_> = curves.iter().map(|(time, curves)| (*time, &curves[..])).collect();
    stream.rows(&path, &rows, |rows| {
        let strips = rows.iter().flat_map(|(_, curves)| curves.iter().map(strip));
        Ok(LineStrips3D::new(strips).columns(lengths(rows))?.collect())
    })
}

/// The points in order; of a closed curve, the first one again.
fn strip(curve: &DrawnCurve) -> Vec<[f32; 3]> {
    let again = curve.points.first().filter(|_| curve.closed);
    curve.points.iter().chain(again).map(|point| point.as_vec3().to_array()).collect()
}

/// How many things each row holds.
fn lengths<'a, T>(rows: &'a [(u64, &[T])]) -> impl Iterator<Item = usize> + Clone + 'a {
    rows.iter().map(|(_, things)| things.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_curve_ends_where_it_begins() {
        let points = [0.0, 1.0, 2.0].map(|x| DVec3::new(x, x * x, 0.5)).to_vec();
        let open = DrawnCurve { points, closed: false };
        let closed = DrawnCurve { closed: true, ..open.clone() };
        assert_eq!(strip(&open).len(), 3);
        assert_eq!((strip(&closed).len(), strip(&closed)[3]), (4, [0.0, 0.0, 0.5]));
    }

    #[test]
    fn labels_say_who_and_how_deep() {
        let contact = DrawnContact { point: [0.0; 3], separation: -0.25, pair: 7 };
        assert_eq!(label(&contact, None), "0.25 deep");
        assert_eq!(label(&DrawnContact { separation: 0.5, ..contact }, None), "0.5 apart");
    }
}
