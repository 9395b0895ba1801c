//! Triangulates what a closed chain of directed edges bounds in the plane, by exact signs alone.
//!
//! The chain says what the boundary of the triangles must be, edge for edge; that this holds never
//! depends on geometry. Geometry decides which triangles: a region that the chain winds around `w`
//! times gets `|w|` layers of triangles, clockwise ones where `w` is negative, nothing where it is
//! zero. Outer loops run counter-clockwise and holes clockwise, so `w` is 1 inside and 0 outside.
//!
//! # Method
//!
//! 1. Edges are netted: opposite ones cancel, repeated ones are counted.
//! 2. Vertices at one place become one *site*. A triangle of zero area leads from an edge's own
//!    vertex to the one that stands for its place (the lowest).
//! 3. One pass of a sweep line (`sweep`; Hertel and Mehlhorn 1983) triangulates between the edges.
//!    An edge that passes through a site is split there; a triangle of zero area keeps the chain's
//!    edge whole.
//! 4. Of two edges that cross properly, the longer is left out. It takes a detour along edges of
//!    the triangulation beside it (`detour`), and the strip between edge and detour is triangulated
//!    for itself. These triangles overlap others, with signs such that the winding numbers stay
//!    right.
//!
//! Cost: `O(m log m)` for `m` edges that do not cross, however many loops. Where edges cross, two
//! more sweeps at most, and the detours, whose search is bounded.

mod detour;
mod front;
mod outlines;
mod sites;
mod status;
mod sweep;
#[cfg(test)]
mod tests;

use cranny_exact::DVec2;

use crate::each_once::each_once;
use crate::topology::DisjointSets;
use detour::Detours;
pub use outlines::outlines;
use sites::Sites;
use sweep::{Segment, Swept, sweep};

/// Triangles whose signed boundary is a given chain.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Triangulation {
    /// Indices of points. Clockwise triangles count negative; some may have zero area.
    pub triangles: Vec<[u32; 3]>,
    /// Whether triangles overlap only as the winding numbers demand: no two edges of the chain
    /// cross.
    pub exact: bool,
    /// Whether some forced edge is none, because it crosses another edge.
    pub missed: bool,
}

/// Triangulates what `chain` bounds.
///
/// `chain` holds directed edges between indices of `points`, in any order; at each vertex as many
/// must end as start. `forced` edges become edges of triangles wherever they run through a region
/// (in pieces, where they pass through vertices). No vertex is added, and points that neither list
/// names play no part. The result does not depend on the order of either list.
///
/// Degenerate input is answered, not refused: vertices at one place, collinear ones, and vertices
/// on an edge give triangles of zero area. Where edges of the chain cross, triangles overlap and
/// `exact` is false; a forced edge that crosses another is left out, and `missed` true. Where
/// coordinates are missing or outside the [`domain`](cranny_exact::domain), or crossings so many
/// that detours would outgrow the chain by far, each connected part is a fan about its lowest
/// vertex. A chain that is not closed bounds nothing: its fan has extra edges at that vertex.
pub fn triangulate(points: &[DVec2], chain: &[[u32; 2]], forced: &[[u32; 2]]) -> Triangulation {
    let chain = net(chain);
    exact_or_detoured(points, &chain, forced).unwrap_or_else(|| Triangulation {
        triangles: fans(&chain),
        exact: false,
        missed: !forced.is_empty(),
    })
}

/// A directed edge and how often it occurs.
type Counted = ([u32; 2], u32);

/// The chain with opposite edges cancelled, sorted.
fn net(chain: &[[u32; 2]]) -> Vec<Counted> {
    let mut edges: Vec<([u32; 2], i64)> = chain
        .iter()
        .filter(|[a, b]| a != b)
        .map(|&[a, b]| if a < b { ([a, b], 1) } else { ([b, a], -1) })
        .collect();
    edges.sort_unstable();
    let mut netted = Vec::with_capacity(edges.len());
    for same in edges.chunk_by(|e, f| e.0 == f.0) {
        let [a, b] = same[0].0;
        let count: i64 = same.iter().map(|e| e.1).sum();
        if count != 0 {
            netted.push((if count > 0 { [a, b] } else { [b, a] }, count.unsigned_abs() as u32));
        }
    }
    netted
}

/// The method proper; nothing if only a fan is left.
fn exact_or_detoured(
    points: &[DVec2],
    chain: &[Counted],
    forced: &[[u32; 2]],
) -> Option<Triangulation> {
    let used = chain.iter().map(|e| e.0).chain(forced.iter().copied()).flatten().collect();
    let sites = Sites::new(points, used)?;
    if !is_closed(chain, &sites) {
        return None;
    }
    let mut made = Triangulation { triangles: Vec::new(), exact: true, missed: false };
    let mut segments = Vec::with_capacity(chain.len() + forced.len());
    for &(edge, count) in chain {
        let [a, b] = edge.map(|v| sites.vertex_at(v));
        // [u, v] = [u, a] + [a, b] + [b, v] plus these boundaries; the chain being closed, the
        // edges between vertices of one place cancel.
        layers(&mut made.triangles, [edge[0], edge[1], a], i64::from(count));
        layers(&mut made.triangles, [edge[1], b, a], i64::from(count));
        segments.extend(Segment::new(edge.map(|v| sites.site_of(v)), i64::from(count), false));
    }
    for edge in forced {
        segments.extend(Segment::new(edge.map(|v| sites.site_of(v)), 0, true));
    }

    let mut swept = sweep(sites.positions(), &segments)?;
    if !swept.dropped.is_empty() {
        swept = split_where_crossings_are_sites(sites.positions(), swept)?;
    }
    made.exact = swept.dropped.iter().all(|segment| segment.count == 0);
    made.missed = swept.dropped.iter().any(|segment| segment.forced);
    let mut layers_without_place = std::mem::take(&mut swept.flat);
    if swept.dropped.iter().any(|segment| segment.count != 0) {
        let detours = Detours::new(sites.positions(), &swept);
        for segment in swept.dropped.iter().filter(|s| s.count != 0) {
            let path = detours.along(*segment)?;
            swept.kept.extend(path.segments());
            layers_without_place.extend(path.filling(sites.positions())?);
        }
        swept = sweep(sites.positions(), &swept.kept)?;
        if !swept.dropped.is_empty() || !swept.flat.is_empty() {
            return None;
        }
    }
    for layer in layers_without_place.iter().chain(&swept.triangles) {
        layers(&mut made.triangles, layer.corners.map(|s| sites.vertex(s)), layer.winding);
    }
    Some(made)
}

/// Splits dropped segments at the sites on them and sweeps once more: pieces that meet others only
/// there are kept.
fn split_where_crossings_are_sites(positions: &[DVec2], first: Swept) -> Option<Swept> {
    let detours = Detours::new(positions, &first);
    let Swept { mut kept, mut flat, dropped, .. } = first;
    for mut rest in dropped {
        for site in detours.sites_on(rest) {
            let (piece, behind, layer) = rest.split(site);
            kept.push(piece);
            flat.push(layer);
            rest = behind;
        }
        kept.push(rest);
    }
    let mut second = sweep(positions, &kept)?;
    second.flat.extend(flat);
    Some(second)
}

/// Adds a triangle as often as its winding number says, reversed where that is negative; a triangle
/// with a repeated corner has no boundary and is left out.
fn layers(triangles: &mut Vec<[u32; 3]>, [a, b, c]: [u32; 3], winding: i64) {
    if a != b && b != c && c != a {
        let corners = if winding > 0 { [a, b, c] } else { [a, c, b] };
        triangles.extend((0..winding.unsigned_abs()).map(|_| corners));
    }
}

/// Whether as many edges end at each vertex as start there.
fn is_closed(chain: &[Counted], sites: &Sites) -> bool {
    let mut surplus = vec![0i64; sites.vertex_count()];
    for &([from, to], count) in chain {
        surplus[sites.rank(from)] += i64::from(count);
        surplus[sites.rank(to)] -= i64::from(count);
    }
    surplus.iter().all(|&s| s == 0)
}

/// A fan for each connected part of the chain, about its lowest vertex.
fn fans(chain: &[Counted]) -> Vec<[u32; 3]> {
    let vertices = each_once(chain.iter().flat_map(|e| e.0));
    let rank = |v: u32| vertices.partition_point(|&u| u < v);
    let mut parts = DisjointSets::new(vertices.len());
    for &([from, to], _) in chain {
        parts.union(rank(from), rank(to));
    }
    let mut triangles = Vec::new();
    for &([from, to], count) in chain {
        let apex = vertices[parts.find(rank(from))];
        layers(&mut triangles, [apex, from, to], i64::from(count));
    }
    triangles
}
