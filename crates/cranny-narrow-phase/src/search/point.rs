//! The faces of a body that may be nearest to a point.

use cranny_exact::DVec3;
use cranny_geometry::clusters::{Child, Cluster, WideNode};
use cranny_geometry::{ClusterTree, FaceId};
use wide::f32x8;

use super::ground::rounding;
use super::lanes::{Wide3, lanes_of, wide, within};
use crate::answer::Counters;

/// Calls `visit` with every face that may be within `reach` of a point of the body's frame; `visit`
/// returns the reach from there on. `allowance` is what the point and its distances may be off by.
/// `stack` is scratch.
pub(crate) fn for_faces_near(
    tree: &ClusterTree,
    p: DVec3,
    (mut reach, allowance): (f64, f64),
    stack: &mut Vec<(f64, u32)>,
    counters: &mut Counters,
    mut visit: impl FnMut(FaceId) -> f64,
) {
    let unit = tree.unit();
    let single = |v: DVec3| v.to_array().map(|x| x as f32);
    let at = single((p - tree.origin()) / unit);
    let scale = 1.0 + at.iter().map(|x| x.abs()).sum::<f32>();
    let error = f64::from(rounding(scale)) * unit + allowance;
    stack.clear();
    stack.push((0.0, 0));
    while let Some((gap, index)) = stack.pop() {
        if gap > reach {
            continue;
        }
        let node = &tree.nodes()[index as usize];
        counters.node_tests += 1;
        let gaps = box_gaps(node, at);
        let bound = (((reach + error) / unit) as f32).next_up();
        let near = within(gaps, f32x8::splat(bound)) & node.mask();
        let (gaps, start) = (gaps.to_array(), stack.len());
        for lane in lanes_of(near) {
            let child: Child = node.children[lane];
            if child.is_cluster() {
                let cluster = &tree.clusters()[child.index()];
                // Coordinates about its centre are as large as the point is far from it.
                let from = single((p - cluster.center) / unit);
                let scale = cluster.bounds.radius + from.iter().map(|x| x.abs()).sum::<f32>();
                let error = f64::from(rounding(scale)) * unit + allowance;
                let bound = (((reach + error) / unit) as f32).next_up();
                for face in lanes_of(faces_near(cluster, from, bound)) {
                    reach = visit(cluster.faces.ids[face]);
                }
            } else {
                let gap = f64::from(gaps[lane]) * unit - error;
                stack.push((gap, child.index() as u32));
            }
        }
        let new = &mut stack[start..];
        if new.len() > 1 {
            new.sort_unstable_by(|x, y| y.0.total_cmp(&x.0));
        }
    }
}

/// How far a point lies outside each of eight boxes.
#[inline]
fn box_gaps(node: &WideNode, at: [f32; 3]) -> f32x8 {
    let from = Wide3::all(at).minus(&Wide3::of(&node.center));
    let half = [wide(&node.half.x), wide(&node.half.y), wide(&node.half.z)];
    let zero = f32x8::splat(0.0);
    let mut squares = zero;
    for (axis, half) in node.axes.iter().zip(half) {
        let gap = (from.dot(&Wide3::of(axis)).abs() - half).fast_max(zero);
        squares += gap * gap;
    }
    squares.sqrt()
}

/// The lanes of a cluster's faces that may be within a bound of a point, about its centre.
#[inline]
fn faces_near(cluster: &Cluster, from: [f32; 3], bound: f32) -> u32 {
    let faces = &cluster.faces;
    let p = Wide3::all(from);
    let zero = f32x8::splat(0.0);
    let height = p.dot(&Wide3::of(&faces.normal));
    let above = (height - wide(&faces.top)).fast_max(wide(&faces.bottom) - height).fast_max(zero);
    let [x, y, z] =
        [0, 1, 2].map(|i: usize| p.dot(&Wide3::of(&faces.sides[i])) - wide(&faces.ends[i]));
    let beside = x.fast_max(y).fast_max(z).fast_max(zero);
    within((above * above + beside * beside).sqrt(), f32x8::splat(bound)) & faces.mask()
}
