//! The walk proper: from a feature pair to a closer one, over Voronoi regions.
//!
//! Two features are closest where the nearest point of each lies in the exterior Voronoi region of
//! the other (Lin and Canny 1991). Where it lies beyond a bounding plane of the region, the feature
//! on the other side of that plane is closer. The states are those of V-Clip (Mirtich 1998):
//! vertex–vertex, vertex–edge, vertex–facet, edge–edge, edge–facet. Unlike there, a vertex below a
//! facet's plane does not look at all facets: the walk goes on *inside*, over the cones from the
//! centre to the facets (pseudo-internal Voronoi regions, after Ponamgi, Manocha and Lin 1995), to
//! the one that holds it.
//!
//! All signs here are plain f64. They steer; nothing relies on them, since what the walk ends at is
//! certified or discarded.

use cranny_exact::DVec3;
use cranny_geometry::hull::{FacetId, HullVertexId};

use super::graph::{HalfEdge, HullEdgeId, HullFeature};
use super::nearest::witnesses;
use super::observer::{Trail, WalkObserver};
use super::sides::Sides;
use HullFeature::{Edge, Facet, Vertex};
use cranny_geometry::triangle_distance::closest_on_segments;

/// What one state says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// This pair is closer.
    Move([HullFeature; 2]),
    /// This pair is closest.
    Closest,
    /// One feature reaches into the other hull.
    Inside,
}

/// Looks at one pair. A pure function of the pair, so that a walk that returns to a pair is a
/// cycle.
pub(super) fn step(sides: &Sides, pair: [HullFeature; 2]) -> Step {
    match pair {
        [Vertex(v), Vertex(w)] => vertex_vertex(sides, [v, w]),
        [Vertex(v), Edge(e)] => vertex_edge(sides, 0, v, e),
        [Edge(e), Vertex(v)] => vertex_edge(sides, 1, v, e),
        [Vertex(v), Facet(f)] => vertex_facet(sides, 0, v, f),
        [Facet(f), Vertex(v)] => vertex_facet(sides, 1, v, f),
        [Edge(e), Edge(f)] => edge_edge(sides, [e, f]),
        [Edge(e), Facet(f)] => edge_facet(sides, 0, e, f),
        [Facet(f), Edge(e)] => edge_facet(sides, 1, e, f),
        [Facet(_), Facet(g)] => Step::Move([pair[0], Vertex(sides.corner_of(1, Facet(g)))]),
    }
}

/// A move of both features, given as (the feature of `side`, that of the other).
fn towards(side: usize, own: HullFeature, other: HullFeature) -> Step {
    Step::Move(if side == 0 { [own, other] } else { [other, own] })
}

/// The edge at a vertex of `side` that leads most directly along `direction` (of that side's
/// frame); none where all lead away from it.
fn edge_along(
    sides: &Sides,
    side: usize,
    vertex: HullVertexId,
    direction: DVec3,
) -> Option<HullFeature> {
    let mut best = (0.0, None);
    for (id, h) in sides.graph(side).fan(vertex) {
        let along = direction.dot(h.along);
        if along > best.0 {
            best = (along, Some(id));
        }
    }
    best.1.map(|id| Edge(sides.graph(side).edge_of(id)))
}

fn vertex_vertex(sides: &Sides, [v, w]: [HullVertexId; 2]) -> Step {
    let between = sides.vertex_in(0, 1, w) - sides.vertex_in(0, 0, v);
    if let Some(edge) = edge_along(sides, 0, v, between) {
        return Step::Move([edge, Vertex(w)]);
    }
    match edge_along(sides, 1, w, sides.vector_in(1, 0, -between)) {
        Some(edge) => Step::Move([Vertex(v), edge]),
        None => Step::Closest,
    }
}

/// Over which of the two facets beside an edge a point lies; `arm` leads from the edge to it.
fn facet_under(halves: [&HalfEdge; 2], arm: DVec3) -> Option<HullFeature> {
    let [left, right] = halves.map(|h| h.outward.dot(arm));
    let half = if left <= right { halves[0] } else { halves[1] };
    half.facet().filter(|_| left.min(right) < 0.0).map(Facet)
}

fn vertex_edge(sides: &Sides, side: usize, vertex: HullVertexId, edge: HullEdgeId) -> Step {
    let other = 1 - side;
    let halves = sides.graph(other).both_halves(edge);
    let h = halves[0];
    let arm = sides.vertex_in(other, side, vertex) - h.from;
    let t = arm.dot(h.along) / h.along.length_squared();
    if t < 0.0 {
        return towards(side, Vertex(vertex), Vertex(h.ends[0]));
    }
    if t > 1.0 {
        return towards(side, Vertex(vertex), Vertex(h.ends[1]));
    }
    if let Some(facet) = facet_under(halves, arm) {
        return towards(side, Vertex(vertex), facet);
    }
    let to_foot = sides.vector_in(side, other, t * h.along - arm);
    match edge_along(sides, side, vertex, to_foot) {
        Some(own) => towards(side, own, Edge(edge)),
        None => Step::Closest,
    }
}

fn edge_edge(sides: &Sides, [first, second]: [HullEdgeId; 2]) -> Step {
    let halves = [sides.graph(0).both_halves(first), sides.graph(1).both_halves(second)];
    let [a, b] = [halves[0][0], halves[1][0]];
    let (p, q) = (a.from, sides.point_in(0, 1, b.from));
    let (u, w) = (a.along, sides.vector_in(0, 1, b.along));
    let (s, t) = closest_on_segments(&[p, p + u], &[q, q + w]);
    let end = |parameter: f64, h: &HalfEdge| match parameter {
        0.0 => Some(Vertex(h.ends[0])),
        1.0 => Some(Vertex(h.ends[1])),
        _ => None,
    };
    match (end(s, a), end(t, b)) {
        (None, None) => {}
        (v, x) => return Step::Move([v.unwrap_or(Edge(first)), x.unwrap_or(Edge(second))]),
    }
    let between = (q + t * w) - (p + s * u);
    if let Some(facet) = facet_under(halves[0], between) {
        return Step::Move([facet, Edge(second)]);
    }
    match facet_under(halves[1], sides.vector_in(1, 0, -between)) {
        Some(facet) => Step::Move([Edge(first), facet]),
        None => Step::Closest,
    }
}

fn vertex_facet(sides: &Sides, side: usize, vertex: HullVertexId, facet: FacetId) -> Step {
    let other = 1 - side;
    let graph = sides.graph(other);
    let p = sides.vertex_in(other, side, vertex);
    let mut beyond = (0.0, None);
    for (id, h) in graph.around(facet) {
        let out = h.outward.dot(p - h.from);
        if out > beyond.0 {
            beyond = (out, Some(id));
        }
    }
    if let Some(id) = beyond.1 {
        return towards(side, Vertex(vertex), Edge(graph.edge_of(id)));
    }
    let plane = &graph.facets[facet.index()];
    if plane.normal.dot(p) <= plane.offset {
        return match facet_towards(sides, other, p, facet) {
            Some(above) => towards(side, Vertex(vertex), Facet(above)),
            None => Step::Inside,
        };
    }
    match edge_along(sides, side, vertex, sides.vector_in(side, other, -plane.normal)) {
        Some(own) => towards(side, own, Facet(facet)),
        None => Step::Closest,
    }
}

/// Goes on from facet to facet to the one whose cone from the centre holds `p`, and returns it if
/// `p` lies above its plane. In that cone the height over the plane is greatest in units of the
/// centre's depth below it: the walk only ever rises, so it ends. (It seeks a vertex of the polar
/// dual polytope, where the simplex method's argument says that the highest among its neighbours is
/// the highest of all.)
fn facet_towards(sides: &Sides, side: usize, p: DVec3, start: FacetId) -> Option<FacetId> {
    let graph = sides.graph(side);
    let from_center = p - graph.center;
    let rise = |f: FacetId| {
        let plane = &graph.facets[f.index()];
        if plane.depth > 0.0 {
            plane.normal.dot(from_center) / plane.depth
        } else {
            f64::NEG_INFINITY
        }
    };
    let mut here = (rise(start), start);
    loop {
        let mut best = here;
        for (_, h) in graph.around(here.1) {
            let across = graph.half_edges[h.twin as usize].facet();
            if let Some(rising) = across.map(|f| (rise(f), f)).filter(|next| next.0 > best.0) {
                best = rising;
            }
        }
        if best.1 == here.1 {
            let plane = &graph.facets[here.1.index()];
            return (plane.normal.dot(p) > plane.offset).then_some(here.1);
        }
        here = best;
    }
}

fn edge_facet(sides: &Sides, side: usize, edge: HullEdgeId, facet: FacetId) -> Step {
    let other = 1 - side;
    let graph = sides.graph(other);
    let h = &sides.graph(side).half_edges[edge.index()];
    let from = sides.point_in(other, side, h.from);
    let along = sides.vector_in(other, side, h.along);
    // The part of the edge over the facet, and what cuts it off there: Cyrus and Beck (1978).
    let (mut low, mut high) = ((0.0, None), (1.0, None));
    for (id, rim) in graph.around(facet) {
        let (start, slope) = (rim.outward.dot(from - rim.from), rim.outward.dot(along));
        let at = -start / slope;
        if slope < 0.0 && at > low.0 {
            low = (at, Some(id));
        } else if slope > 0.0 && at < high.0 {
            high = (at, Some(id));
        } else if slope == 0.0 && start > 0.0 {
            (low, high) = ((1.0, Some(id)), (0.0, Some(id)));
        }
    }
    if low.0 > high.0 {
        return towards(side, Edge(edge), Edge(nearest_rim(sides, other, facet, [from, along])));
    }
    let plane = &graph.facets[facet.index()];
    let height = |t: f64| plane.normal.dot(from + t * along) - plane.offset;
    let (at_low, at_high) = (height(low.0), height(high.0));
    if (at_low <= 0.0) != (at_high <= 0.0) {
        return Step::Inside;
    }
    let (nearer, vertex) =
        if at_low.abs() <= at_high.abs() { (low, h.ends[0]) } else { (high, h.ends[1]) };
    match nearer.1 {
        Some(id) => towards(side, Edge(edge), Edge(graph.edge_of(id))),
        None => towards(side, Vertex(vertex), Facet(facet)),
    }
}

/// The edge of a facet's outline nearest to a segment, given by its start and its direction.
fn nearest_rim(sides: &Sides, side: usize, facet: FacetId, [q, w]: [DVec3; 2]) -> HullEdgeId {
    let graph = sides.graph(side);
    let mut nearest = (f64::INFINITY, HullEdgeId(0));
    for (id, h) in graph.around(facet) {
        let (s, t) = closest_on_segments(&[h.from, h.from + h.along], &[q, q + w]);
        let squared = (h.from + s * h.along - q - t * w).length_squared();
        if squared < nearest.0 {
            nearest = (squared, graph.edge_of(id));
        }
    }
    nearest.1
}

/// How a walk ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// At a pair that is closest as far as f64 can say.
    Closest([HullFeature; 2]),
    /// At a pair one of which reaches into the other hull.
    Inside([HullFeature; 2]),
    /// It came back to a pair that it had left.
    Cycle([HullFeature; 2]),
}

/// Walks until a pair is closest or reaches inside, or until a pair comes back. Steps depend on the
/// pair alone and there are finitely many pairs, so one of the three happens. Returns are found by
/// comparing with a pair that is kept for twice as long each time (Brent 1980): no memory, and no
/// cycle escapes.
pub(super) fn walk(
    sides: &Sides,
    start: [HullFeature; 2],
    trail: &mut Trail<impl WalkObserver>,
) -> End {
    let mut here = start;
    let (mut kept, mut age, mut lifetime) = (start, 0u64, 1u64);
    loop {
        trail.pair(here);
        let next = match step(sides, here) {
            Step::Move(next) => next,
            Step::Closest => return End::Closest(here),
            Step::Inside => return End::Inside(here),
        };
        if next == kept {
            return End::Cycle(nearest_of_cycle(sides, next, trail));
        }
        here = next;
        age += 1;
        if age == lifetime {
            (kept, age, lifetime) = (here, 0, 2 * lifetime);
        }
    }
}

/// Of the pairs on a cycle the one whose witnesses are nearest: rounding alone keeps a walk from
/// ending, among pairs that are equally near.
fn nearest_of_cycle(
    sides: &Sides,
    start: [HullFeature; 2],
    trail: &mut Trail<impl WalkObserver>,
) -> [HullFeature; 2] {
    let distance = |pair| {
        witnesses(sides, pair)
            .map_or(f64::INFINITY, |w| (w.points[1] - w.points[0]).length_squared())
    };
    let (mut here, mut best) = (start, (distance(start), start));
    while let Step::Move(next) = step(sides, here) {
        trail.pair(here);
        if next == start {
            break;
        }
        here = next;
        if distance(here) < best.0 {
            best = (distance(here), here);
        }
    }
    best.1
}
