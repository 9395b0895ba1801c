//! A stateless paired descent of two trees, counted.

use cranny_exact::{DMat3, DVec3, Meeting, RigidMap, classify_triangles};
use cranny_geometry::Mesh;

use super::variant::{Tree, Volume};

/// What a descent did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) box_tests: usize,
    pub(crate) triangle_tests: usize,
    pub(crate) meetings: usize,
}

/// Counts what it takes to find all pairs of faces that meet. `second` are the second mesh's faces,
/// posed.
pub(crate) fn descend(
    trees: [&Tree; 2],
    first: &Mesh,
    second: &[[DVec3; 3]],
    first_from_second: &RigidMap,
    slack: f64,
) -> Counts {
    let mut counts = Counts::default();
    let mut stack = vec![(0u32, 0u32)];
    // Where boxes stand along the axes of their bodies, one rotation serves all pairs.
    let fixed = (!trees[0].kind.oriented).then_some(first_from_second.linear);
    while let Some((a, b)) = stack.pop() {
        let (node, other) = (&trees[0].nodes[a as usize], &trees[1].nodes[b as usize]);
        counts.box_tests += 1;
        if apart(&node.volume, &other.volume, first_from_second, fixed.as_ref(), slack) {
            continue;
        }
        let larger = node.volume.half.length_squared() >= other.volume.half.length_squared();
        if node.children.is_empty() && other.children.is_empty() {
            for f in &trees[0].faces[node.faces[0]..node.faces[1]] {
                for g in &trees[1].faces[other.faces[0]..other.faces[1]] {
                    counts.triangle_tests += 1;
                    let meeting = classify_triangles(&first.triangle(*f), &second[g.index()]);
                    counts.meetings += usize::from(meeting != Meeting::None);
                }
            }
        } else if other.children.is_empty() || (larger && !node.children.is_empty()) {
            stack.extend(node.children.iter().map(|&child| (child, b)));
        } else {
            stack.extend(other.children.iter().map(|&child| (a, child)));
        }
    }
    counts
}

/// The six face axes (Gottschalk, Lin and Manocha 1996, without the nine of edges).
fn apart(a: &Volume, b: &Volume, map: &RigidMap, fixed: Option<&DMat3>, slack: f64) -> bool {
    let offset = map.linear * b.center + map.translation - a.center;
    let (rotation, d) = match fixed {
        Some(&rotation) => (rotation, offset),
        None => (a.axes.transpose() * map.linear * b.axes, a.axes.transpose() * offset),
    };
    let abs = |m: DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    let reach = abs(rotation);
    if (d.abs() - a.half - reach * b.half).max_element() > slack {
        return true;
    }
    let along = rotation.transpose() * d;
    (along.abs() - b.half - reach.transpose() * a.half).max_element() > slack
}
