//! What may happen to a mesh that deforms.

use cranny_exact::DVec3;
use cranny_geometry::{Mesh, VertexId};
use cranny_testkit::Rng;

/// The vertices within a ball about a vertex, and where they go: by `shift` times the height of a
/// bell.
pub(crate) fn bell(
    mesh: &Mesh,
    about: VertexId,
    radius: f64,
    shift: DVec3,
) -> Vec<(VertexId, DVec3)> {
    let center = mesh.position(about);
    let all = (0..mesh.vertices().len() as u32).map(VertexId);
    all.filter_map(|v| {
        let p = mesh.position(v);
        let share = (p - center).length_squared() / (radius * radius);
        (share < 1.0).then(|| (v, p + (1.0 - share) * (1.0 - share) * shift))
    })
    .collect()
}

/// One of the things that may happen to a mesh.
pub(crate) fn random_moves(mesh: &Mesh, rng: &mut Rng) -> Vec<(VertexId, DVec3)> {
    let bounds = mesh.bounds();
    let size = bounds.diagonal();
    let v = VertexId(rng.below(mesh.vertices().len()) as u32);
    let outward = (mesh.position(v) - bounds.center()).normalize_or(DVec3::X);
    let mut any = || 0.5 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
    let aside = any();
    match rng.below(7) {
        0 => bell(mesh, v, 0.15 * size, -0.06 * size * outward),
        1 => bell(mesh, v, 0.1 * size, 0.05 * size * outward + 0.02 * size * aside),
        2 => vec![(v, mesh.position(v) - 0.05 * size * outward)],
        3 => vec![(v, mesh.position(v) + 0.05 * size * aside)],
        4 => {
            // Onto the middle of an edge of a neighbouring face: faces without area.
            let face = mesh.faces().iter().find(|f| f.contains(&v.0));
            let Some(face) = face else { return vec![] };
            let others: Vec<u32> = face.iter().copied().filter(|&i| i != v.0).collect();
            let [a, b] = [others[0], others[1]].map(|i| mesh.position(VertexId(i)));
            vec![(v, 0.5 * (a + b))]
        }
        5 => (0..5)
            .map(|_| VertexId(rng.below(mesh.vertices().len()) as u32))
            .collect::<std::collections::BTreeSet<_>>()
            .into_iter()
            .map(|v| (v, mesh.position(v) + 0.01 * size * aside))
            .collect(),
        // Through the middle and out on the other side: faces cross.
        _ => vec![(v, mesh.position(v) - 0.6 * size * outward)],
    }
}
