//! A body's box in the world, such that boxes of bodies that meet always overlap.

use cranny_exact::{Aabb, Pose};
use cranny_primitives::BodyShape;

/// Room for rounding, in units of the body's size and distance from the origin.
///
/// A pair is decided in the frame of one of its bodies, by matrices that miss a rotation by about
/// 16 ulps (quaternions of unit length to 8 ulps by [`Pose::accepted`], entries snapped by at most
/// 4) and arithmetic that adds a handful. Taken back to the world, a vertex may so lie up to about
/// 40 ulps of `radius + |translation|` away from where the world's frame has it. Smaller than that
/// bound: the proof fails that bodies which touch by a rounding have overlapping boxes (in practice
/// the outward rounding of half extents and growth suffices:
/// `corners_that_touch_by_a_rounding_are_found` passes without it, over 3,900 tries). Larger:
/// nothing but a few more candidates.
const BOX_SLACK: f64 = 64.0 * f64::EPSILON;

/// The body's box in world coordinates, grown by `margin >= 0` and by all rounding. That of a
/// half-space is [as large as can be](BodyShape::bounds): it overlaps whatever may meet it.
#[must_use]
pub fn world_box(shape: &BodyShape, pose: &Pose, margin: f64) -> Aabb {
    // A half-space is as large as what it meets, which has room of its own; its plane is not.
    let radius = Some(shape.radius()).filter(|radius| radius.is_finite());
    let radius = radius.unwrap_or_else(|| shape.center().length());
    let scale = radius + pose.translation.abs().max_element() + margin;
    shape.bounds(&pose.world_from_body()).grown(margin + BOX_SLACK * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, DVec3};
    use cranny_geometry::{BuildOptions, Mesh, Model};

    fn wedge() -> Model {
        let vertices = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
    }

    #[test]
    fn the_box_holds_every_posed_vertex_and_little_more() {
        let model = wedge();
        let rotation = DQuat::from_xyzw(0.3, -0.5, 0.2, 0.78).normalize();
        let pose = Pose { rotation, translation: DVec3::new(40.0, -1e3, 0.125) };
        let around = world_box(&model.clone().into(), &pose, 0.0);
        let map = pose.world_from_body();
        assert!(model.mesh().vertices().iter().all(|&p| around.contains_point(map.apply(p))));
        let size = around.max - around.min;
        assert!(size.max_element() < 1.0 + 2.0 + 3.0);
        let wide = world_box(&model.into(), &pose, 0.5);
        assert!((wide.max - around.max - DVec3::splat(0.5)).abs().max_element() < 1e-12);
        assert!((around.min - wide.min - DVec3::splat(0.5)).abs().max_element() < 1e-12);
    }

    #[test]
    fn an_unrotated_box_fits_to_rounding() {
        let around = world_box(&wedge().into(), &Pose::IDENTITY, 0.0);
        assert!((around.max - DVec3::new(1.0, 2.0, 3.0)).abs().max_element() < 1e-12);
        assert!(around.max.cmpge(DVec3::new(1.0, 2.0, 3.0)).all());
    }
}
