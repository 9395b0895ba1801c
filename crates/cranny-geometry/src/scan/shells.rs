//! Components as shells: which way each looks, which lies in which, which faces disagree with the
//! rest.
//!
//! Source: windings are those of `winding`; what rounding may do to a volume is bounded as in
//! Higham (2002, "Accuracy and stability of numerical algorithms"). Which faces disagree needs
//! none: a walk over edges decides. Cost: O(n log n) as a rule, with questions to the tree only
//! where there are several shells.

use cranny_exact::{Aabb, DVec3, Meeting, Sign, classify_triangles};

use crate::ids::{ComponentId, FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::topology::{Edge, EdgeKind, Topology};
use crate::tree::FaceTree;
use crate::winding::{Winding, winding};

/// What is known of one component as a shell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shell {
    /// Sign of the volume, where closed: positive looks outwards. Zero where rounding leaves it
    /// open (a component folded onto itself has none).
    pub(crate) looks: Sign,
    /// Signed volume, rounded; 0 where not closed.
    pub(crate) volume: f64,
    /// Middle of its box.
    pub(crate) center: DVec3,
    /// Closed components that it lies in, ascending: those that wind around its first corner that
    /// lies on no other, and that it does not pass through.
    pub(crate) inside: Vec<ComponentId>,
}

/// All shells, by component; `volume`: of all together, rounded, if it is known. O(n log n).
pub(crate) fn shells(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    volume: Option<f64>,
) -> Vec<Shell> {
    if let (Some(volume), [component]) = (volume, topology.components())
        && component.closed
    {
        let bounds = tree.node(0).bounds;
        let at_most = largest_volume(mesh.faces().len(), bounds.max - bounds.center());
        if volume.abs() > volume_error(mesh.faces().len(), at_most) {
            let (looks, center) = (Sign::of(volume), bounds.center());
            return vec![Shell { looks, volume, center, inside: Vec::new() }]; // nearly always
        }
    }
    let faces = faces_of_components(topology, mesh.faces().len());
    let several = faces.len() > 1;
    let box_of =
        |faces: &Vec<FaceId>| Aabb::of_points(faces.iter().flat_map(|&f| mesh.triangle(f)));
    let boxes: Vec<Aabb> = match several {
        true => faces.iter().map(box_of).collect(),
        false => vec![tree.node(0).bounds],
    };
    let shell = |(component, faces): (usize, &Vec<FaceId>)| {
        let closed = topology.components()[component].closed;
        let corners = || faces.iter().flat_map(|&f| mesh.triangle(f));
        let center = boxes[component].center();
        let (looks, volume) =
            if closed { signed_volume(mesh, faces, center) } else { (Sign::Zero, 0.0) };
        let mut inside = match closed && several {
            true => containers(mesh, topology, tree, ComponentId(component as u32), corners()),
            false => Vec::new(),
        };
        inside.retain(|c| boxes[c.index()].union(&boxes[component]) == boxes[c.index()]);
        if !inside.is_empty() {
            let crossed = crossed(mesh, topology, tree, faces, &inside);
            inside.retain(|c| !crossed.contains(c));
        }
        Shell { looks, volume, center, inside }
    };
    faces.iter().enumerate().map(shell).collect()
}

fn faces_of_components(topology: &Topology, faces: usize) -> Vec<Vec<FaceId>> {
    let mut lists = vec![Vec::new(); topology.components().len()];
    for face in (0..faces as u32).map(FaceId) {
        lists[topology.component_of(face).index()].push(face);
    }
    lists
}

/// The volume of a closed component and its certain sign.
///
/// The error of a sum of n products is at most (n + 8) units of rounding times the sum of their
/// absolute values (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 3.1);
/// twice that leaves room for the differences taken first.
fn signed_volume(mesh: &Mesh, faces: &[FaceId], reference: DVec3) -> (Sign, f64) {
    let corners = |face: FaceId| mesh.triangle(face).map(|p| p - reference);
    let (mut six_volume, mut size) = (0.0, DVec3::ZERO);
    for &face in faces {
        let [a, b, c] = corners(face);
        six_volume += a.dot(b.cross(c));
        size = size.max(a.abs()).max(b.abs()).max(c.abs());
    }
    let volume = six_volume / 6.0;
    if volume.abs() > volume_error(faces.len(), largest_volume(faces.len(), size)) {
        return (Sign::of(six_volume), volume); // nearly always
    }
    let mut magnitude = 0.0;
    for &face in faces {
        let [a, b, c] = corners(face);
        let (b, c) = (b.abs(), c.abs());
        let minors =
            DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
        magnitude += a.abs().dot(minors);
    }
    let certain = six_volume.abs() > volume_error(faces.len(), magnitude);
    (if certain { Sign::of(six_volume) } else { Sign::Zero }, volume)
}

/// What rounding may do to a sum of products over so many faces whose absolute values add up to
/// `magnitude`.
fn volume_error(faces: usize, magnitude: f64) -> f64 {
    (faces + 8) as f64 * f64::EPSILON * magnitude
}

/// A bound of the sum of absolute volumes of the tetrahedra over so many faces, of which no corner
/// is farther from the common tip than `size` along any axis: of six products a face none is
/// greater than that of the sizes, a sixth of them is the volume, and twice as many leave room for
/// the roundings of this bound.
fn largest_volume(faces: usize, size: DVec3) -> f64 {
    2.0 * faces as f64 * size.element_product()
}

/// The other closed components around a component.
fn containers(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    component: ComponentId,
    corners: impl Iterator<Item = DVec3>,
) -> Vec<ComponentId> {
    /// Corners tried. A shell that lies on another with all of these is not called nested.
    const CORNERS: usize = 64;
    for p in corners.step_by(3).take(CORNERS) {
        let others = |face: FaceId| topology.component_of(face) != component;
        if let Winding::Around(around) = winding(mesh, topology, tree, p, others) {
            return around.into_iter().map(|(id, _)| id).collect();
        }
    }
    Vec::new()
}

/// Which of some components the faces pass through. O(log n) a face, but for faces that do.
fn crossed(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    faces: &[FaceId],
    of: &[ComponentId],
) -> Vec<ComponentId> {
    let mut crossed: Vec<ComponentId> = Vec::new();
    for &face in faces {
        let triangle = mesh.triangle(face);
        let bounds = Aabb::of_points(triangle);
        let visit = |other: FaceId| {
            let component = topology.component_of(other);
            if of.contains(&component)
                && !crossed.contains(&component)
                && classify_triangles(&triangle, &mesh.triangle(other)) == Meeting::Cross
            {
                crossed.push(component);
            }
        };
        tree.visit(|b| b.overlaps(&bounds), visit);
    }
    crossed
}

/// What must be turned to make a component consistent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Disagreement {
    /// Groups of faces that hang together and look the wrong way, each ascending: in every patch of
    /// faces joined by edges of two, the fewer of those that disagree (on a tie, those without the
    /// least face).
    pub(crate) turned: Vec<Vec<FaceId>>,
    /// The least face of each patch that has no consistent orientation.
    pub(crate) twisted: Vec<FaceId>,
}

/// Walks every patch over its edges of two faces. O(n).
pub(crate) fn disagreement(faces: usize, topology: &Topology) -> Disagreement {
    let mut found = Disagreement::default();
    let agrees = |e: &Edge| e.kind != EdgeKind::Contradictory;
    if topology.pairs().is_some() || topology.edges().iter().all(agrees) {
        return found;
    }
    let mut side: Vec<Option<bool>> = vec![None; faces];
    for seed in (0..faces as u32).map(FaceId) {
        if side[seed.index()].is_some() {
            continue;
        }
        side[seed.index()] = Some(false);
        let (mut patch, mut next, mut twisted) = (vec![seed], 0, false);
        while next < patch.len() {
            let face = patch[next];
            next += 1;
            for (neighbour, agrees) in neighbours(topology, face) {
                let expected = side[face.index()].map(|s| s == agrees);
                match side[neighbour.index()] {
                    None => {
                        side[neighbour.index()] = expected;
                        patch.push(neighbour);
                    }
                    known => twisted |= known != expected,
                }
            }
        }
        let turned = patch.iter().filter(|f| side[f.index()] == Some(true)).count();
        if twisted {
            found.twisted.push(seed);
        } else if turned > 0 {
            let wrong = 2 * turned <= patch.len();
            let mut wrong: Vec<FaceId> =
                patch.into_iter().filter(|f| side[f.index()] == Some(wrong)).collect();
            wrong.sort_unstable();
            found.turned.extend(groups(&wrong, topology));
        }
    }
    found
}

/// Faces over edges of exactly two, and whether both run opposite ways along it.
fn neighbours(topology: &Topology, face: FaceId) -> impl Iterator<Item = (FaceId, bool)> + use<'_> {
    (0..3).filter_map(move |corner| {
        let edge = topology.edge_of(HalfEdgeId::of(face, corner));
        let ends = topology.edges()[edge.index()];
        let agrees = match ends.kind {
            _ if ends.from == ends.to => return None, // the short side of a collapsed face
            EdgeKind::Manifold => true,
            EdgeKind::Contradictory => false,
            _ => return None,
        };
        let other = topology.half_edges(edge).iter().map(|h| h.face()).find(|&f| f != face)?;
        Some((other, agrees))
    })
}

/// The faces of an ascending list, parted where they do not hang together.
fn groups(faces: &[FaceId], topology: &Topology) -> Vec<Vec<FaceId>> {
    let mut seen = vec![false; faces.len()];
    let mut groups = Vec::new();
    for start in 0..faces.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let (mut group, mut next) = (vec![faces[start]], 0);
        while next < group.len() {
            for (neighbour, _) in neighbours(topology, group[next]) {
                if let Ok(at) = faces.binary_search(&neighbour)
                    && !seen[at]
                {
                    seen[at] = true;
                    group.push(neighbour);
                }
            }
            next += 1;
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}
