//! The face of a model that is nearest to a solid of revolution, by its box tree.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Content, FaceId, Model};

use super::{LeastOnTriangle, ROUNDING, Revolved};
use cranny_narrow_phase::Feature;

/// Where a model's surface is nearest to a solid of revolution.
#[derive(Clone, Copy, Debug)]
pub struct NearestFace {
    /// From the solid with its border: 0 or less where it meets the surface, and then not the
    /// least.
    pub distance: f64,
    /// What of the model is nearest.
    pub feature: Feature,
    /// On the model's surface, the model's frame.
    pub on_model: DVec3,
    /// On the solid's surface, its border included.
    pub on_solid: DVec3,
}

/// Where the surface of a model is nearest to a solid of revolution in its frame, if it is no
/// farther than `within`; where they meet, a place where they do: a segment or a disc without a
/// border meets what is a few units of rounding away. A solid inside the model's material has a
/// distance from its surface.
///
/// Cost: the faces about as near as the nearest one, and the boxes on the way to them.
#[must_use]
pub fn nearest_face(model: &Model, solid: &Revolved, within: f64) -> Option<NearestFace> {
    let tree = model.tree();
    let limits = solid.bounds();
    let mut best: Option<(f64, FaceId, LeastOnTriangle)> = None;
    let mut limit = within;
    let mut open: Vec<(f64, u32)> = Vec::new();
    if !tree.nodes().is_empty() {
        open.push((solid.gap_of_box(&tree.node(0).bounds, &limits), 0));
    }
    while let Some((bound, index)) = open.pop() {
        // Not `>=`: at the limit itself there may be an answer still.
        if bound > limit {
            continue;
        }
        match tree.content(index) {
            Content::Inner { left, right } => {
                let child = |i: u32| (solid.gap_of_box(&tree.node(i).bounds, &limits), i);
                let (left, right) = (child(left), child(right));
                // The nearer one is taken up first.
                open.extend(if left.0 <= right.0 { [right, left] } else { [left, right] });
            }
            Content::Leaf { .. } => {
                for &face in tree.leaf_faces(index) {
                    let least = solid.least_on_triangle(&model.mesh().triangle(face));
                    let distance = solid.gap_at(least.signed, least.point);
                    if distance < limit || (best.is_none() && distance <= limit) {
                        limit = distance;
                        best = Some((distance, face, least));
                    }
                }
                if limit <= 0.0 && best.is_some() {
                    break;
                }
            }
        }
    }
    let (distance, face, least) = best?;
    let way = solid.outward_at(&least);
    Some(NearestFace {
        distance,
        feature: Feature::of_part(least.part, model, face),
        on_model: least.point,
        on_solid: least.on_core + way * solid.radius(),
    })
}

impl Revolved {
    /// How far the solid is from a point at a signed distance from its core. What has no inside is
    /// never less than 0 away: a distance of rounding means that it passes through.
    fn gap_at(&self, signed: f64, point: DVec3) -> f64 {
        let size = point.abs().max_element() + self.middle().abs().max_element() + self.extent();
        let pierced = self.is_thin() && signed <= ROUNDING * size;
        if pierced { -self.radius() } else { signed - self.radius() }
    }

    /// Whether anything in a box may be as near to the solid as `within`; `own` is the solid's box.
    #[must_use]
    pub fn may_reach(&self, own: &Aabb, bounds: &Aabb, within: f64) -> bool {
        self.gap_of_box(bounds, own) <= within
    }

    /// A lower bound of the distance of anything in a box from the solid, whose own box is given:
    /// negative where the box may reach into it.
    fn gap_of_box(&self, bounds: &Aabb, own: &Aabb) -> f64 {
        let between_boxes = bounds.distance_squared_lower(own).sqrt();
        let (center, half) = (bounds.center(), bounds.half_extents());
        let foot = self.core_foot(center);
        // The plane square to the way to the box's centre parts them, if anything that simple does.
        let spread = foot.outward.abs().dot(half);
        let size = center.abs().max_element() + half.max_element() + self.extent();
        let beyond_plane = foot.signed - spread - self.radius - ROUNDING * size;
        if between_boxes > 0.0 { between_boxes.max(beyond_plane) } else { beyond_plane }
    }
}
