//! What covers facets, edges and vertices of hulls: counted by hand, and against whoever measures
//! each piece.

use std::collections::{BTreeMap, BTreeSet};

use crate::body::Body;
use cranny_concavity::ConcavityId;
use cranny_concavity::FeatureCover;
use cranny_exact::DVec3;
use cranny_geometry::hull::{FacetId, HullVertexId};
use cranny_geometry::{BuildOptions, FaceId, Flatness, HalfEdgeId, Mesh, VertexId};
use cranny_shapes::{Comb, Cuboid, Cup, Gear, GolfBall, IsoNut, NestedShells, Torus, UPrism};
use cranny_testkit::Rng;

use super::bodies;
use super::rounding::prism_cut_anyhow;
use super::ways::four_ways;

/// Whose something is: a concavity's, or the solid's.
type Owner = Option<ConcavityId>;

fn owners(cover: FeatureCover<'_>) -> BTreeSet<Owner> {
    cover.lids().map(Some).chain(cover.is_solid().then_some(None)).collect()
}

/// Every face on the hull and every cap, measured against every edge and vertex of the hull near
/// it.
struct Judge<'a> {
    model: &'a Body,
    /// By facet, those of the facets that it is covered together with among them.
    pieces: Vec<Vec<([DVec3; 3], Owner)>>,
    group: Vec<FacetId>,
}

impl<'a> Judge<'a> {
    fn of(model: &'a Body) -> Self {
        let all = model.concavities();
        let facets = || (0..model.hull().facet_count() as u32).map(FacetId);
        let mut group: Vec<FacetId> = facets().collect();
        for [facet, first] in all.shared_facets() {
            group[facet.index()] = first;
        }
        let mut own = vec![Vec::new(); group.len()];
        for f in (0..model.mesh().faces().len() as u32).map(FaceId) {
            if let Some(facet) = model.features().facet_of(f) {
                own[group[facet.index()].index()].push((model.mesh().triangle(f), None));
            }
        }
        for cap in all.caps() {
            let corners = cap.corners.map(|v| model.mesh().position(v));
            own[group[cap.facet.index()].index()].push((corners, cap.concavity));
        }
        let pieces = facets().map(|f| own[group[f.index()].index()].clone()).collect();
        Self { model, pieces, group }
    }

    /// Needles belong to one or the other by rounding.
    fn is_wide(&self, &[a, b, c]: &[DVec3; 3]) -> bool {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        (b - a).cross(c - a).length() > self.model.features().slab_depth() * longest
    }

    fn on_facet(&self, facet: FacetId) -> BTreeSet<Owner> {
        self.pieces[facet.index()].iter().map(|piece| piece.1).collect()
    }

    /// Owners of the pieces one of whose edges runs along a segment for a while.
    fn along(&self, facet: FacetId, [p, q]: [DVec3; 2]) -> BTreeSet<Owner> {
        let (direction, length) = ((q - p).normalize(), p.distance(q));
        let near = 4.0 * self.model.features().slab_depth();
        let share = |a: DVec3| {
            let along = direction.dot(a - p);
            ((a - p - along * direction).length() <= near).then_some(along.clamp(0.0, length))
        };
        let runs_along = |corners: &[DVec3; 3]| {
            self.is_wide(corners)
                && (0..3).any(|k| {
                    let ends = [corners[k], corners[(k + 1) % 3]].map(share);
                    matches!(ends, [Some(a), Some(b)] if (a - b).abs() > near)
                })
        };
        let pieces = self.pieces[facet.index()].iter();
        pieces.filter(|(corners, _)| runs_along(corners)).map(|piece| piece.1).collect()
    }

    fn edge(&self, h: HalfEdgeId) -> BTreeSet<Owner> {
        let hull = self.model.hull();
        let sides = [h, hull.twin(h)].map(|h| hull.facet_of_triangle(h.index() / 3));
        if self.group[sides[0].index()] == self.group[sides[1].index()] {
            return self.on_facet(sides[0]);
        }
        let corners = hull.triangle(h.index() / 3).map(|v| hull.position(v));
        let ends = [corners[h.index() % 3], corners[(h.index() + 1) % 3]];
        sides.into_iter().flat_map(|side| self.along(side, ends)).collect()
    }

    fn vertex(&self, v: HullVertexId) -> BTreeSet<Owner> {
        let hull = self.model.hull();
        let place = hull.position(v);
        let around = (0..hull.triangle_count()).filter(|&t| hull.triangle(t).contains(&v));
        let facets: BTreeSet<FacetId> = around.map(|t| hull.facet_of_triangle(t)).collect();
        let all = self.pieces.iter().flatten();
        let is_there = |corners: &[DVec3; 3]| corners.contains(&place) && self.is_wide(corners);
        let own = all.filter(|(corners, _)| is_there(corners)).map(|piece| piece.1);
        let own: BTreeSet<Owner> = own.collect();
        match own.is_empty() {
            true => facets.into_iter().flat_map(|f| self.on_facet(f)).collect(),
            false => own,
        }
    }
}

fn edges(model: &Body) -> impl Iterator<Item = HalfEdgeId> + '_ {
    let all = (0..3 * model.hull().triangle_count() as u32).map(HalfEdgeId);
    all.filter(|&h| h < model.hull().twin(h))
}

/// Edges between facets, not those within one.
fn creases(model: &Body) -> impl Iterator<Item = HalfEdgeId> + '_ {
    let facet = |h: HalfEdgeId| model.hull().facet_of_triangle(h.index() / 3);
    edges(model).filter(move |&h| facet(h) != facet(model.hull().twin(h)))
}

fn vertices(model: &Body) -> impl Iterator<Item = HullVertexId> {
    (0..model.hull().vertex_count() as u32).map(HullVertexId)
}

fn facets(model: &Body) -> impl Iterator<Item = FacetId> {
    (0..model.hull().facet_count() as u32).map(FacetId)
}

fn assert_judged_alike(model: &Body, what: &str) {
    let (judge, covers) = (Judge::of(model), model.hull_covers());
    for f in facets(model) {
        assert_eq!(owners(covers.facet(f)), judge.on_facet(f), "{what}: facet {}", f.0);
    }
    for h in edges(model) {
        assert_eq!(owners(covers.edge(h)), judge.edge(h), "{what}: edge {}", h.0);
        assert_eq!(covers.edge(h), covers.edge(model.hull().twin(h)), "{what}: edge {}", h.0);
    }
    for v in vertices(model) {
        assert_eq!(owners(covers.vertex(v)), judge.vertex(v), "{what}: vertex {}", v.0);
    }
}

fn built(mesh: &Mesh) -> Body {
    Body::build(mesh.clone(), &BuildOptions::default()).unwrap().0
}

/// How many of some features are covered in which way.
fn counted<'a>(covers: impl Iterator<Item = FeatureCover<'a>>) -> BTreeMap<(bool, usize), usize> {
    let mut counts = BTreeMap::new();
    for cover in covers {
        *counts.entry((cover.is_solid(), cover.lids().count())).or_default() += 1;
    }
    counts
}

fn of_creases(model: &Body) -> BTreeMap<(bool, usize), usize> {
    counted(creases(model).map(|h| model.hull_covers().edge(h)))
}

fn of_vertices(model: &Body) -> BTreeMap<(bool, usize), usize> {
    counted(vertices(model).map(|v| model.hull_covers().vertex(v)))
}

#[test]
fn generators_are_judged_alike() {
    let nut = IsoNut { segments: 36, ..IsoNut::default() };
    let nested = NestedShells { shells: 3, wall: 0.05, gap: 0.1, ..NestedShells::default() };
    let ball = GolfBall { triangles: 5000, ..GolfBall::default() };
    for (name, mesh) in [
        ("torus", Torus::default().build()),
        ("golf ball", ball.build()),
        ("cup", Cup::default().build()),
        ("gear", Gear::default().build()),
        ("comb", Comb::default().build()),
        ("U", UPrism::default().build()),
        ("nut", nut.build()),
        ("nested shells", nested.build()),
    ] {
        for mesh in four_ways(&mesh.unwrap()) {
            assert_judged_alike(&built(&mesh), name);
        }
    }
    for mesh in [
        bodies::star_prism(5),
        bodies::small_stellated_dodecahedron(),
        bodies::knife_block(),
        bodies::grooved_block(),
        bodies::bottle(24),
        bodies::gridded_cuboid([4, 4, 1], |x, y| (x, y) == (1, 1) || (x, y) == (2, 2)),
    ] {
        assert_judged_alike(&built(&mesh), "body");
    }
}

#[test]
fn blocks_of_cells_are_judged_alike() {
    let mut rng = Rng::new(77);
    for round in 0..60 {
        assert_judged_alike(&built(&bodies::random_blocks(&mut rng)), &format!("blocks {round}"));
    }
}

#[test]
fn a_block_without_concavities_is_solid_all_over() {
    let model = built(&Cuboid::default().build().unwrap());
    let covers = model.hull_covers();
    assert!(facets(&model).all(|f| covers.facet(f) == FeatureCover::Solid));
    assert!(edges(&model).all(|h| covers.edge(h) == FeatureCover::Solid));
    assert!(vertices(&model).all(|v| covers.vertex(v) == FeatureCover::Solid));
}

#[test]
fn edges_and_vertices_are_counted_by_hand() {
    // A slot through a block crosses two of its twelve edges.
    let model = built(&UPrism::default().build().unwrap());
    assert_eq!(of_creases(&model), BTreeMap::from([((true, 0), 10), ((true, 1), 2)]));
    assert_eq!(of_vertices(&model), BTreeMap::from([((true, 0), 8)]));

    // Seven slots cross the same two edges.
    let model = built(&Comb::default().build().unwrap());
    assert_eq!(of_creases(&model), BTreeMap::from([((true, 0), 10), ((true, 7), 2)]));

    // Between two points of a star lies a notch: a side of the hull, and an edge of its top and
    // bottom. Five crests part the sides.
    let model = built(&bodies::star_prism(5));
    assert_eq!(of_creases(&model), BTreeMap::from([((false, 1), 10), ((false, 2), 5)]));
    assert_eq!(of_vertices(&model), BTreeMap::from([((true, 2), 10)]));

    // No face of it lies on its hull.
    let model = built(&bodies::small_stellated_dodecahedron());
    assert_eq!(of_creases(&model), BTreeMap::from([((false, 1), 30)]));
    assert_eq!(of_vertices(&model), BTreeMap::from([((false, 1), 12)]));

    // The lid of a well lies within the top of a cup.
    let model = built(&Cup::default().build().unwrap());
    assert_eq!(of_creases(&model).keys().collect::<Vec<_>>(), [&(true, 0)]);
    let lid = facets(&model).filter(|&f| model.hull_covers().facet(f) != FeatureCover::Solid);
    assert_eq!(lid.count(), 1);

    // Each of the 16 gaps between teeth is a side of the hull and an edge above and below.
    let model = built(&Gear::default().build().unwrap());
    assert_eq!(of_creases(&model)[&(false, 1)], 32);
}

#[test]
fn facets_that_share_their_caps_leave_nothing_out() {
    let flatness = Flatness::Relative(1e-3);
    let options = BuildOptions { flatness, ..BuildOptions::default() };
    let mut rng = Rng::new(17);
    let mut shared = 0;
    for round in 0..200 {
        let depth = |rng: &mut Rng| 1e-5 * f64::from(rng.between(0, 300));
        let mesh = prism_cut_anyhow(4 + round % 9, &mut rng, depth);
        let (model, _) = Body::build(mesh, &options).unwrap();
        let covers = model.hull_covers();
        let judge = Judge::of(&model);
        for [facet, _] in model.concavities().shared_facets() {
            shared += 1;
            assert_eq!(owners(covers.facet(facet)), judge.on_facet(facet), "round {round}");
        }
        for v in vertices(&model) {
            assert_eq!(owners(covers.vertex(v)), judge.vertex(v), "round {round}");
        }
        for h in edges(&model) {
            assert!(owners(covers.edge(h)).is_superset(&judge.edge(h)), "round {round}");
        }
    }
    assert!(shared > 40, "{shared}");
}

#[test]
fn what_covers_a_hull_follows_a_deformation() {
    let mut model = built(&Cuboid::default().build().unwrap());
    assert_eq!(of_vertices(&model), BTreeMap::from([((true, 0), 8)]));
    // A corner is pushed in: what it leaves is covered by a lid.
    let corner = VertexId(0);
    let to = 0.2 * model.mesh().position(corner);
    model.deform(&[(corner, to)]).unwrap();
    assert_judged_alike(&model, "dented");
    assert_eq!(model.concavities().len(), 1);
    assert!(of_vertices(&model).contains_key(&(true, 1)));
}
