//! Bodies that families share.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_testkit::bodies::{
    angle, block_without, channel, cuboid, grooved, octahedron, prism, rake,
};
use cranny_testkit::{Q, Q3};

use crate::trial::Trial;

/// Bodies with concavities, whole coordinates up to 5.
pub(crate) fn hollows() -> Vec<(&'static str, Mesh)> {
    vec![
        ("angle", angle()),
        ("channel", channel()),
        ("rake", rake()),
        ("grooved box", grooved()),
        ("ring", block_without([3, 3, 1], &[[1, 1, 0]])),
        ("pot", block_without([3, 3, 2], &[[1, 1, 1]])),
        ("ridges", ridges()),
    ]
}

/// Convex bodies, their coordinates multiples of a quarter, at most half as large as a pocket of
/// those above.
pub(crate) fn small_bodies(trial: &mut Trial<'_>) -> Vec<(&'static str, Mesh)> {
    let whole = [
        ("cube", cuboid([0.0; 3], [2.0; 3])),
        ("octahedron", octahedron()),
        ("roof", prism(&[[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[[0, 1, 2]], 2.0)),
    ];
    let quarter = |(name, mesh)| Some((name, trial.mapped(name, &mesh, |p| 0.25 * p)?));
    whole.into_iter().filter_map(quarter).collect()
}

/// Two ridges along z at y = 2, x = 1 and 3, and a groove between them.
pub(crate) fn ridges() -> Mesh {
    let outline =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [3.0, 2.0], [2.0, 1.0], [1.0, 2.0], [0.0, 1.0]];
    prism(&outline, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 6], [4, 5, 6]], 4.0)
}

/// The tetrahedron over four points, outward; `None` where they lie in a plane, exactly.
pub(crate) fn tetrahedron_over(p: [DVec3; 4]) -> Option<Mesh> {
    let [o, a, b, c] = p.map(Q3::exactly);
    let volume = (&a - &o).cross(&(&b - &o)).dot(&(&c - &o));
    let faces = match volume.cmp(&Q::ZERO) {
        std::cmp::Ordering::Equal => return None,
        std::cmp::Ordering::Greater => vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        std::cmp::Ordering::Less => vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]],
    };
    Mesh::new(p.to_vec(), faces).ok()
}

/// 2 to the power of `-k`.
pub(crate) fn two_to_minus(k: u32) -> f64 {
    1.0 / (1u64 << k) as f64
}
