//! Solids of revolution, with a polygon in place of the circle.

use cranny_exact::DVec2;
use cranny_geometry::Mesh;

use crate::{builder::MeshBuilder, error::ShapeError};

/// Whether the profile runs from the axis to the axis or closes upon itself away from it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Profile {
    /// First and last point lie on the axis, the others do not.
    Open,
    /// No point lies on the axis; the last is joined to the first.
    Closed,
}

/// Sweeps a profile of points (radius, z) through the directions, joined by straight lines.
///
/// The profile runs counter-clockwise about the section of the solid (radius to the right, z up).
/// Between two directions `d` and `d'` the sweep maps (radius, z, t) to `radius ((1 - t) d + t d')`
/// at height `z`, injectively off the axis; so a profile that does not cross itself gives a surface
/// that does not either, whatever the number of directions (at least 3).
pub(crate) fn lathe(
    shape: &'static str,
    directions: &[DVec2],
    profile: &[DVec2],
    kind: Profile,
) -> Result<Mesh, ShapeError> {
    let mut builder = MeshBuilder::default();
    let rings: Vec<_> = profile.iter().map(|p| builder.ring(directions, p.x, p.y)).collect();
    for pair in rings.windows(2) {
        builder.band(&pair[0], &pair[1]);
    }
    if kind == Profile::Closed {
        builder.band(&rings[rings.len() - 1], &rings[0]);
    }
    builder.finish(shape)
}
