//! Least distance between two surfaces: branch and bound over both trees.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::answer::{Counters, Feature};
use crate::descent::{BoxTest, Opened, opened};
use crate::pair::{Pair, Side};
use crate::triangle_distance::triangle_distance;

/// The nearest points of two surfaces that do not meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    pub(crate) distance: f64,
    /// In the pair's frame: on the first, on the second.
    pub(crate) points: [DVec3; 2],
    pub(crate) features: [Feature; 2],
}

/// Finds the nearest points, if they are less than `below` apart. Ties go to the lowest faces.
pub(crate) fn closest(pair: &Pair, below: f64, counters: &mut Counters) -> Option<Closest> {
    let boxes = BoxTest::of(pair);
    let (first, second) = (pair.model(Side::First).tree(), pair.model(Side::Second).tree());
    let bound =
        |a: u32, b: u32| boxes.distance_lower(&first.node(a).bounds, &second.node(b).bounds);
    let mut best: Option<((FaceId, FaceId), crate::triangle_distance::Nearest)> = None;
    let mut least = below;
    let mut stack = vec![(bound(0, 0), 0u32, 0u32)];
    while let Some((lower, a, b)) = stack.pop() {
        if lower > least {
            continue;
        }
        counters.node_tests += 1;
        let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
        let children = match opened(first.content(a), second.content(b), box_a, box_b) {
            Opened::First(left, right) => [(left, b), (right, b)],
            Opened::Second(left, right) => [(a, left), (a, right)],
            Opened::Neither => {
                for &f in first.leaf_faces(a) {
                    let triangle = pair.triangle(Side::First, f);
                    for &g in second.leaf_faces(b) {
                        counters.triangle_tests += 1;
                        let nearest = triangle_distance(&triangle, &pair.triangle(Side::Second, g));
                        let distance = nearest.squared.sqrt();
                        let wins = match &best {
                            None => distance < below,
                            Some((faces, n)) => {
                                nearest.squared < n.squared
                                    || (nearest.squared <= n.squared && (f, g) < *faces)
                            }
                        };
                        if wins {
                            least = distance;
                            best = Some(((f, g), nearest));
                        }
                    }
                }
                continue;
            }
        };
        let mut children = children.map(|(a, b)| (bound(a, b), a, b));
        if children[0].0 < children[1].0 {
            children.swap(0, 1); // the nearer one is popped first
        }
        stack.extend(children.into_iter().filter(|child| child.0 <= least));
    }
    best.map(|((f, g), nearest)| Closest {
        distance: nearest.squared.sqrt(),
        points: nearest.points,
        features: [
            nearest.parts[0].feature(pair.model(Side::First), f),
            nearest.parts[1].feature(pair.model(Side::Second), g),
        ],
    })
}
