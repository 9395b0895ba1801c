//! Which way faces look: consistently, outwards, and by parity where shells lie in each other.
//!
//! No source: this crate's own; the parity of what encloses a shell says whether solid lies within
//! it. Cost: that of `shells`; for each pair of opposite faces in one place that of `winding`.

use cranny_exact::{DVec3, Sign};

use super::WorkingMesh;
use crate::ids::FaceId;
use crate::report::{RepairKind, RepairRecord};
use crate::scan::faces::coincident;
use crate::scan::shells::{Shell, disagreement, shells};
use crate::topology::Topology;
use crate::tree::FaceTree;
use crate::winding::{Winding, winding};

/// Turns what looks the wrong way; with `full`, also nested components, and drops inner sheets.
/// Returns the filed faces of those.
pub(super) fn orient(
    work: &mut WorkingMesh,
    full: bool,
    records: &mut Vec<RepairRecord>,
) -> Vec<FaceId> {
    turn_back_faces(work, records);
    let topology = Topology::of(&work.mesh);
    if !topology.components().iter().any(|c| c.closed) {
        return Vec::new();
    }
    let tree = FaceTree::of(&work.mesh, 1);
    let mut shells = shells(&work.mesh, &topology, &tree, None);
    let inside_out = inside_out(&shells);
    turn_components(
        work,
        &topology,
        &mut shells,
        &inside_out,
        RepairKind::TurnedComponents,
        records,
    );
    if !full {
        return Vec::new();
    }
    let misplaced: Vec<bool> = shells.iter().map(is_misplaced).collect();
    let kind = RepairKind::TurnedNestedComponents;
    turn_components(work, &topology, &mut shells, &misplaced, kind, records);
    drop_inner_sheets(work, &topology, &tree, records)
}

fn turn_back_faces(work: &mut WorkingMesh, records: &mut Vec<RepairRecord>) {
    let found = disagreement(work.mesh.faces().len(), &Topology::of(&work.mesh));
    let turned: Vec<FaceId> = found.turned.into_iter().flatten().collect();
    if turned.is_empty() {
        return;
    }
    let mut turn = vec![false; work.mesh.faces().len()];
    for face in &turned {
        turn[face.index()] = true;
    }
    let faces = work.filed_ids(&turned);
    let record = RepairRecord::new(RepairKind::TurnedBackFaces, turned.len());
    records.push(RepairRecord { faces, ..record });
    work.turn(&turn);
}

/// Outermost components that look inwards, and what lies only in such.
fn inside_out(shells: &[Shell]) -> Vec<bool> {
    let outermost: Vec<bool> =
        shells.iter().map(|s| s.inside.is_empty() && s.looks == Sign::Negative).collect();
    let enclosed = |shell: &Shell| {
        let mut outer =
            shell.inside.iter().filter(|c| shells[c.index()].inside.is_empty()).peekable();
        outer.peek().is_some() && outer.all(|c| outermost[c.index()])
    };
    shells.iter().zip(&outermost).map(|(shell, &outer)| outer || enclosed(shell)).collect()
}

/// A nested component that does not look as the number of those around it demands: inwards in one,
/// outwards in two.
fn is_misplaced(shell: &Shell) -> bool {
    let expected = if shell.inside.len() % 2 == 1 { Sign::Negative } else { Sign::Positive };
    shell.looks == expected.flipped()
}

fn turn_components(
    work: &mut WorkingMesh,
    topology: &Topology,
    shells: &mut [Shell],
    turn: &[bool],
    kind: RepairKind,
    records: &mut Vec<RepairRecord>,
) {
    let count = turn.iter().filter(|&&turn| turn).count();
    if count == 0 {
        return;
    }
    for (shell, _) in shells.iter_mut().zip(turn).filter(|&(_, &turn)| turn) {
        shell.looks = shell.looks.flipped();
        shell.volume = -shell.volume;
    }
    let faces = work.mesh.face_ids();
    let of_faces: Vec<bool> = faces.map(|f| turn[topology.component_of(f).index()]).collect();
    records.push(match of_faces.contains(&false) {
        false => RepairRecord::new(RepairKind::TurnedRightSideOut, of_faces.len()),
        true => {
            let turned = (0..of_faces.len() as u32).map(FaceId).filter(|f| of_faces[f.index()]);
            let faces = work.filed_ids(&turned.collect::<Vec<_>>());
            RepairRecord { faces, ..RepairRecord::new(kind, count) }
        }
    });
    work.turn(&of_faces);
}

/// Drops pairs of opposite faces in one place that have solid on both sides: the rest of the mesh
/// winds around the middle of the face. What such a pair adds to its edges cancels, so all closes
/// as before, and the winding number of no point changes.
fn drop_inner_sheets(
    work: &mut WorkingMesh,
    topology: &Topology,
    tree: &FaceTree,
    records: &mut Vec<RepairRecord>,
) -> Vec<FaceId> {
    let mesh = &work.mesh;
    let mut inner = Vec::new();
    for pair in coincident(mesh, topology).into_iter().filter(|group| group.len() == 2) {
        let [f, g] = [pair[0], pair[1]].map(|f| mesh.area_vector(f));
        if f.dot(g) >= 0.0 {
            continue;
        }
        let middle = mesh.triangle(pair[0]).iter().sum::<DVec3>() / 3.0;
        let others = |face: FaceId| !pair.contains(&face);
        if let Winding::Around(around) = winding(mesh, topology, tree, middle, others)
            && around.iter().map(|c| c.1).sum::<i64>() != 0
        {
            inner.extend(pair);
        }
    }
    inner.sort_unstable();
    let filed = work.filed_ids(&inner).into_iter().map(FaceId).collect();
    work.without(&inner, RepairKind::DroppedInnerSheets, records);
    filed
}
