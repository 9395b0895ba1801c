//! Which faces of two clusters may be near each other.
//!
//! The planes of the faces part them, and boxes along one frame: for each face of the first cluster
//! all of the second's at once. What is left is for double precision to decide.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;
use wide::f32x8;

use super::ground::{Ground, rounding};
use super::lanes::{Wide3, lane_of, lanes_of, wide, within};
use crate::pair::Side;

/// How far eight faces reach along a direction.
struct Sight {
    axis: Wide3,
    least: f32x8,
    most: f32x8,
}

impl Sight {
    #[inline(always)]
    fn of(axis: [f32; 3], corners: &[Wide3; 3]) -> Self {
        let axis = Wide3::all(axis);
        let [x, y, z] = corners.each_ref().map(|corner| axis.dot(corner));
        let (least, most) = (x.fast_min(y).fast_min(z), x.fast_max(y).fast_max(z));
        Self { axis, least, most }
    }

    /// Squares of the gaps between a face and the eight.
    #[inline(always)]
    fn gap_squared(&self, face: &[Wide3; 3]) -> f32x8 {
        let [x, y, z] = face.each_ref().map(|corner| self.axis.dot(corner));
        let (least, most) = (x.fast_min(y).fast_min(z), x.fast_max(y).fast_max(z));
        let gap = (self.least - most).fast_max(least - self.most).fast_max(f32x8::splat(0.0));
        gap * gap
    }
}

/// How far a face and the eight are apart, seen along three directions at right angles.
#[inline(always)]
fn seen_apart(sights: &[Sight; 3], face: &[Wide3; 3]) -> f32x8 {
    let squares = sights.each_ref().map(|sight| sight.gap_squared(face));
    (squares[0] + squares[1] + squares[2]).sqrt()
}

/// A unit direction and two at right angles to it, to rounding.
fn frame(toward: [f32; 3]) -> [[f32; 3]; 3] {
    let direction = DVec3::from_array(toward.map(f64::from)).normalize_or(DVec3::Z);
    let (u, v) = direction.any_orthonormal_pair();
    [direction, u, v].map(|axis| axis.to_array().map(|x| x as f32))
}

/// Calls `visit` with every pair of faces of two clusters that may be within `reach`, a length of
/// the pair, and a certain lower bound of their distance, 0 or less where they may meet. `toward`:
/// a unit direction from first to second, in the first's frame, along which the surfaces are known
/// to be nearest. `visit` returns the reach from there on.
pub(crate) fn for_near_faces(
    ground: &Ground,
    [a, b]: [u32; 2],
    reach: f64,
    toward: Option<[f32; 3]>,
    mut visit: impl FnMut([FaceId; 2], f64) -> f64,
) {
    let (first, second) = (ground.tree(Side::First), ground.tree(Side::Second));
    let (a, b) = (&first.clusters()[a as usize], &second.clusters()[b as usize]);
    // In the first's frame and lengths, about its own cluster's centre.
    let placing = ground.into(Side::First);
    let offset = ground.between(Side::First, a, b);
    let (ratio, unit) = (placing.ratio(), first.unit());
    let scale =
        a.bounds.radius + b.bounds.radius * ratio + offset.iter().map(|x| x.abs()).sum::<f32>();
    let error = rounding(scale) + (ground.posing() / unit) as f32;
    let limit = |reach: f64| ((reach / unit) as f32).next_up() + error;
    // Of what overflowed nothing is certain.
    let certain = |gap: f32| (f64::from(gap - error).next_down() * unit).max(f64::NEG_INFINITY);
    let shift = Wide3::all(offset);
    let faces = &b.faces;
    let corners = faces.corners.each_ref().map(|corner| {
        placing.turned_all(&Wide3::of(corner).times(f32x8::splat(ratio))).plus(&shift)
    });
    let normal = placing.turned_all(&Wide3::of(&faces.normal));
    let level = normal.dot(&shift);
    let top = wide(&faces.top) * f32x8::splat(ratio) + level;
    let bottom = wide(&faces.bottom) * f32x8::splat(ratio) + level;
    let mut bound = limit(reach);
    let own = a.faces.corners.each_ref().map(|corner| Wide3::of(corner).to_arrays());
    let own_normal = Wide3::of(&a.faces.normal).to_arrays();
    let along_box = a.bounds.axes.map(|axis| Sight::of(axis, &corners));
    let along_way = toward.map(|toward| frame(toward).map(|axis| Sight::of(axis, &corners)));
    for lane in 0..a.faces.count as usize {
        let [p, q, r] = own.each_ref().map(|corner| lane_of(corner, lane));
        // Along the normals of the second's faces.
        let heights = [normal.dot(&p), normal.dot(&q), normal.dot(&r)];
        let least = heights[0].fast_min(heights[1]).fast_min(heights[2]);
        let most = heights[0].fast_max(heights[1]).fast_max(heights[2]);
        let mut gap = (least - top).fast_max(bottom - most);
        if within(gap, f32x8::splat(bound)) & faces.mask() == 0 {
            continue;
        }
        // Along that of the first's face.
        let n = lane_of(&own_normal, lane);
        let (own_top, own_bottom) = (a.faces.top.0[lane], a.faces.bottom.0[lane]);
        let [x, y, z] = corners.map(|corner| n.dot(&corner));
        gap = gap
            .fast_max(x.fast_min(y).fast_min(z) - f32x8::splat(own_top))
            .fast_max(f32x8::splat(own_bottom) - x.fast_max(y).fast_max(z));
        if within(gap, f32x8::splat(bound)) & faces.mask() == 0 {
            continue;
        }
        let face = [p, q, r];
        gap = gap.fast_max(seen_apart(&along_box, &face));
        if let Some(along_way) = &along_way {
            gap = gap.fast_max(seen_apart(along_way, &face));
        }
        let near = within(gap, f32x8::splat(bound)) & faces.mask();
        let gaps = gap.to_array();
        for other in lanes_of(near) {
            let reach = visit([a.faces.ids[lane], faces.ids[other]], certain(gaps[other]));
            bound = limit(reach);
        }
    }
}
