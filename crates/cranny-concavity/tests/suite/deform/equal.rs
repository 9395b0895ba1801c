//! What 'equals a rebuild' means.

use std::collections::{BTreeMap, BTreeSet};

use crate::body::{Body, Change};
use cranny_concavity::envelope::{EnvelopeOptions, Pocket};
use cranny_concavity::{Concavity, Lid};
use cranny_concavity::{ConcavityId, ConvexSetId, Envelopes};
use cranny_exact::DVec3;
use cranny_geometry::hull::{FacetId, HullKind};
use cranny_geometry::{BuildOptions, EdgeId, FaceId, Flatness, PatchId, VertexId};

/// With a flatness that does not depend on which numbers the coordinates happen to be.
pub(crate) fn options() -> BuildOptions {
    BuildOptions {
        flatness: Flatness::Double,
        self_intersections: false,
        ..BuildOptions::default()
    }
}

/// Compares with the model built of the moved mesh, unless that would weld vertices.
pub(crate) fn assert_equals_rebuild(model: &Body, what: &str) {
    validate(model, what);
    let places: BTreeSet<[u64; 3]> =
        model.mesh().vertices().iter().map(|p| p.to_array().map(|x| (x + 0.0).to_bits())).collect();
    if places.len() < model.mesh().vertices().len() {
        return;
    }
    let (rebuilt, _) = Body::build(model.mesh().clone(), &options()).unwrap();
    assert_equal(model, &rebuilt, what);
}

/// Pairs of points and triangles up to which hulls are validated here, every pair of which is
/// looked at: those of the largest mesh of this crate's tests of deformation.
const LARGEST_HULL: usize = 400_000_000;

fn all_faces(model: &Body) -> impl Iterator<Item = FaceId> + use<> {
    (0..model.mesh().faces().len() as u32).map(FaceId)
}

/// Everything that a structure promises by itself.
pub(crate) fn validate(model: &Body, what: &str) {
    let (mesh, topology, hull) = (model.mesh(), model.topology(), model.hull());
    topology.validate(mesh).unwrap();
    if mesh.vertices().len() * hull.triangle_count() <= LARGEST_HULL {
        assert_eq!(hull.validate(mesh.vertices()), [], "{what}");
    }
    let faces: Vec<FaceId> = all_faces(model).collect();
    model.tree().validate(mesh, &faces).unwrap_or_else(|e| panic!("{what}: {e}"));
    model.features().validate(mesh, topology).unwrap_or_else(|e| panic!("{what}: {e}"));
    let concavities = model.concavities();
    concavities
        .validate(mesh, topology, hull, model.features())
        .unwrap_or_else(|e| panic!("{what}: {e}"));
    model
        .concavity_trees()
        .validate(mesh, concavities.iter().map(|c| c.faces))
        .unwrap_or_else(|e| panic!("{what}: {e}"));
    let openings: Vec<Vec<_>> =
        concavities.iter().map(|c| c.lids().map(|lid| lid.opening).collect()).collect();
    let pockets = || {
        let pockets = concavities.iter().zip(&openings);
        pockets.map(|(c, openings)| Pocket { faces: c.faces, openings })
    };
    model.envelopes().validate(mesh, pockets()).unwrap_or_else(|e| panic!("{what}: {e}"));
    // However many were kept: they are those that are made of these trees.
    let trees = model.concavity_trees();
    let made = Envelopes::within(mesh, pockets(), trees, &EnvelopeOptions::default());
    assert!(*model.envelopes() == made, "{what}: envelopes are not as they are made");
    model.patches().validate(mesh, topology).unwrap_or_else(|e| panic!("{what}: {e}"));
}

/// See `Model::deform`.
pub(crate) fn assert_equal(model: &Body, rebuilt: &Body, what: &str) {
    assert_eq!(model.mesh(), rebuilt.mesh(), "{what}");
    assert_eq!(model.digest(), rebuilt.digest(), "{what}");
    assert_eq!((model.bounds(), model.radius()), (rebuilt.bounds(), rebuilt.radius()), "{what}");
    let size = model.bounds().diagonal();
    hulls(model, rebuilt, what);
    classes(model, rebuilt, what);
    let (a, b) = (model.concavities(), rebuilt.concavities());
    assert_eq!((a.len(), a.lid_count()), (b.len(), b.lid_count()), "{what}");
    for (a, b) in a.iter().zip(b.iter()) {
        concavity(&a, &b, size, what);
    }
    let near = |a: f64, b: f64, dimension: i32| {
        let scale = size.powi(dimension);
        assert!((a - b).abs() <= 1e-11 * scale, "{what}: {a:?}, {b:?}");
    };
    near(a.skin().volume, b.skin().volume, 3);
    near(a.skin().area, b.skin().area, 2);
    for (a, b) in (0..a.len()).zip(0..b.len()) {
        let (a, b) = (model.envelopes().envelope(a), rebuilt.envelopes().envelope(b));
        assert_eq!(a.bounds(), b.bounds(), "{what}");
        assert_eq!(a.lids().len(), b.lids().len(), "{what}");
    }
    match (model.mass_properties(), rebuilt.mass_properties()) {
        (Some(a), Some(b)) => {
            near(a.volume, b.volume, 3);
            // The centre of a thin body is badly conditioned.
            near(a.volume * (a.center - b.center).length(), 0.0, 4);
            let inertia = (a.inertia - b.inertia).to_cols_array();
            inertia.into_iter().for_each(|i| near(i, 0.0, 5));
        }
        (a, b) => assert_eq!(a, b, "{what}"),
    }
}

fn hulls(model: &Body, rebuilt: &Body, what: &str) {
    let (a, b) = (model.hull(), rebuilt.hull());
    assert_eq!((a.kind(), a.sources()), (b.kind(), b.sources()), "{what}");
    assert_eq!(a.flatness(), b.flatness(), "{what}");
    if a.kind() == HullKind::Volume {
        assert_eq!(facets(model), facets(rebuilt), "{what}");
    }
}

/// A facet: its triangles, by the vertices of the mesh, and its plane, to the bit. Numbers of
/// triangles and facets are left out, which say nothing.
type ToldFacet = (Vec<[VertexId; 3]>, [u64; 5]);

fn facet(model: &Body, id: FacetId) -> ToldFacet {
    let hull = model.hull();
    let facet = hull.facet(id);
    let corners = |&t: &u32| hull.triangle(t as usize).map(|v| hull.source(v));
    let mut triangles: Vec<[VertexId; 3]> = facet.triangles.iter().map(corners).collect();
    triangles.sort_unstable();
    let DVec3 { x, y, z } = facet.normal;
    (triangles, [x, y, z, facet.offset, facet.thickness].map(f64::to_bits))
}

fn facets(model: &Body) -> BTreeSet<ToldFacet> {
    (0..model.hull().facet_count() as u32).map(|f| facet(model, FacetId(f))).collect()
}

fn classes(model: &Body, rebuilt: &Body, what: &str) {
    let (a, b) = (model.features(), rebuilt.features());
    for f in all_faces(model) {
        assert_eq!(a.is_convex(f), b.is_convex(f), "{what}: face {}", f.0);
        let sets: [Option<ConvexSetId>; 2] = [a.convex_set_of(f), b.convex_set_of(f)];
        assert_eq!(sets[0], sets[1], "{what}: face {}", f.0);
        let on = |model: &Body| model.features().facet_of(f).map(|id| facet(model, id));
        assert_eq!(on(model), on(rebuilt), "{what}: face {}", f.0);
    }
    for v in (0..model.mesh().vertices().len() as u32).map(VertexId) {
        assert_eq!(a.vertex(v), b.vertex(v), "{what}: vertex {}", v.0);
    }
    for e in (0..model.topology().edges().len() as u32).map(EdgeId) {
        assert_eq!(a.edge(e), b.edge(e), "{what}: edge {}", e.0);
    }
    assert_eq!(a.convex_sets(), b.convex_sets(), "{what}");
    assert_eq!(a.isolated_vertices(), b.isolated_vertices(), "{what}");
    assert_eq!(a.ridges(), b.ridges(), "{what}");
    assert_eq!(a.slab_depth(), b.slab_depth(), "{what}");
}

fn concavity(a: &Concavity<'_>, b: &Concavity<'_>, size: f64, what: &str) {
    let what = format!("{what}, concavity {}", a.id().0);
    assert_eq!((a.kind, a.parent, a.faces), (b.kind, b.parent, b.faces), "{what}");
    let loops = |c: &Concavity<'_>| c.loops().map(|l| format!("{l:?}")).collect::<Vec<_>>();
    assert_eq!(loops(a), loops(b), "{what}");
    let (p, q) = (a.measures, b.measures);
    assert!((p.pocket_volume - q.pocket_volume).abs() <= 1e-12 * size.powi(3), "{what}");
    for (p, q) in [(p.face_area, q.face_area), (p.cap_area, q.cap_area)] {
        assert!((p - q).abs() <= 1e-11 * size.powi(2), "{what}: {p}, {q}");
    }
    assert!((p.opening - q.opening).length() <= 1e-12 * size.powi(2), "{what}");
    let chains = |c: &Concavity<'_>| c.lids().map(chain).collect::<BTreeSet<_>>();
    assert_eq!(a.lids().len(), b.lids().len(), "{what}");
    assert_eq!(chains(a), chains(b), "{what}");
}

/// The boundary of a lid: directed edges, opposite ones cancelled, with their multiplicities.
fn chain(lid: Lid<'_>) -> Vec<([u32; 2], i32)> {
    let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for (_, outline) in lid.outlines() {
        for (i, &from) in outline.iter().enumerate() {
            let to = outline[(i + 1) % outline.len()];
            let (low, high) = (from.0.min(to.0), from.0.max(to.0));
            *edges.entry([low, high]).or_default() += if from.0 == low { 1 } else { -1 };
        }
    }
    edges.into_iter().filter(|e| e.1 != 0).collect()
}

/// A triangle, from its lowest vertex on.
fn lowest_first(mut corners: [VertexId; 3]) -> [VertexId; 3] {
    let lowest = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
    corners.rotate_left(lowest);
    corners
}

/// Whether the change set says what has changed.
pub(crate) fn assert_tells_changes(before: &Body, after: &Body, change: &Change, what: &str) {
    for v in (0..before.mesh().vertices().len() as u32).map(VertexId) {
        let moved = before.mesh().position(v) != after.mesh().position(v);
        assert_eq!(moved, change.vertices.binary_search(&v).is_ok(), "{what}");
    }
    for f in all_faces(before) {
        let moved = before.mesh().triangle(f) != after.mesh().triangle(f);
        assert!(!moved || change.faces.binary_search(&f).is_ok(), "{what}");
        let turned = before.features().is_convex(f) != after.features().is_convex(f);
        assert_eq!(turned, change.beneath.reclassified.binary_search(&f).is_ok(), "{what}");
    }
    if !change.hull {
        assert_eq!(before.hull(), after.hull(), "{what}");
    }
    assert_eq!(change.beneath.concavities.len(), before.concavities().len(), "{what}");
    for (old, new) in (0..).map(ConcavityId).zip(&change.beneath.concavities) {
        let old = before.concavities().get(old);
        // Those without faces are named by their caps.
        let caps = |model: &Body, c: &Concavity<'_>| -> BTreeSet<[VertexId; 3]> {
            let caps = c.caps.iter().map(|&cap| model.concavities().cap(cap).corners);
            caps.map(lowest_first).collect()
        };
        let is_same = |c: &Concavity<'_>| {
            c.faces == old.faces && (!c.faces.is_empty() || caps(before, &old) == caps(after, c))
        };
        let same = after.concavities().iter().find(is_same);
        assert_eq!(*new, same.map(|c| c.id()), "{what}");
    }
    for new in after.concavities().iter() {
        let old = change.beneath.concavities.iter().position(|c| *c == Some(new.id()));
        let old = old.map(|i| before.concavities().get(ConcavityId(i as u32)));
        let is_same = old.is_some_and(|old| {
            let places = |model: &Body, c: &Concavity<'_>| {
                let faces = c.faces.iter().map(|&f| model.mesh().triangle(f));
                // Caps of other corners are others, even in the same places: where a vertex comes
                // to lie on a corner of the hull, the lesser number stands for both.
                let caps = c.caps.iter().map(|&cap| {
                    let corners = model.concavities().cap(cap).corners;
                    (corners, corners.map(|v| model.mesh().position(v)))
                });
                (faces.collect::<Vec<_>>(), caps.collect::<Vec<_>>())
            };
            places(before, &old) == places(after, &new)
        });
        let found = change.beneath.reshaped.binary_search(&new.id()).is_ok();
        assert_eq!(!is_same, found, "{what}: concavity {}", new.id().0);
    }
    for (old, new) in (0..).map(PatchId).zip(&change.patches) {
        if let Some(new) = new {
            assert_eq!(before.patches().faces(old), after.patches().faces(*new), "{what}");
        }
    }
    for (nodes, old, new) in [
        (&change.tree, before.tree(), after.tree()),
        (&change.beneath.trees, before.concavity_trees().arena(), after.concavity_trees().arena()),
    ] {
        for n in 0..new.nodes().len() as u32 {
            let is_same = !nodes.renumbered
                && old.node(n).bounds == new.node(n).bounds
                && old.content(n) == new.content(n)
                && old.leaf_faces(n) == new.leaf_faces(n);
            assert!(is_same || !nodes.is_unchanged(n), "{what}: node {n}");
        }
    }
}
