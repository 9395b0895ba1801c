//! One body in several ways: turned, moved, rounded; and what its concavities are.

use crate::body::Body;
use cranny_concavity::ConcavityKind;
use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::Mesh;

/// An arbitrary rotation; applying it rounds.
pub(crate) fn turned(mesh: &Mesh) -> Mesh {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    moved(mesh, |p| turn * p)
}

pub(crate) fn rounded_to_single(mesh: &Mesh) -> Mesh {
    moved(mesh, |p| p.as_vec3().as_dvec3())
}

pub(crate) fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
    Mesh::new(mesh.vertices().iter().map(|&p| to(p)).collect(), mesh.faces().to_vec()).unwrap()
}

/// As generated, turned, rounded to single precision, and both.
pub(crate) fn four_ways(mesh: &Mesh) -> [Mesh; 4] {
    [mesh.clone(), turned(mesh), rounded_to_single(mesh), rounded_to_single(&turned(mesh))]
}

/// As a file keeps it that writes so many decimals.
pub(crate) fn rounded_to_decimals(mesh: &Mesh, decimals: usize) -> Mesh {
    let written = |x: f64| format!("{x:.decimals$}").parse::<f64>().unwrap();
    moved(mesh, |p| DVec3::from_array(p.to_array().map(written)))
}

/// As a file keeps it that writes so many significant digits.
pub(crate) fn rounded_to_digits(mesh: &Mesh, digits: usize) -> Mesh {
    let places = digits - 1;
    let written = |x: f64| format!("{x:.places$e}").parse::<f64>().unwrap();
    moved(mesh, |p| DVec3::from_array(p.to_array().map(written)))
}

/// Of each concavity: kind, lids, loops; sorted.
pub(crate) fn census(model: &Body) -> Vec<(ConcavityKind, usize, usize)> {
    let mut all: Vec<_> =
        model.concavities().iter().map(|c| (c.kind, c.lids().len(), c.loops().len())).collect();
    all.sort_unstable();
    all
}
