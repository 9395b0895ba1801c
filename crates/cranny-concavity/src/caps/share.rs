//! Facets that are covered together.
//!
//! Where the surface bends by about as little as rounding does, hull and mesh divide it
//! differently: an edge of the hull runs across a face. The face lies on one of the two facets, to
//! within its slab, and reaches into the other. The first is then covered beyond its rim, which
//! counts negative, and the second not enough; each once only together. So a facet whose caps are
//! negative or cross is joined with those that its caps reach into. The sum of their chains, in
//! which the edges between them cancel, is triangulated in one projection, and each triangle is
//! filed under the facet beneath its middle.
//!
//! What the caps bound is the same, joined or not; how far something reaches is therefore measured
//! in rounded lengths. But where caps run is not: slivers along an edge of the hull lead from one
//! side to the next, and caps over both would cut the corner between them off. So no facet joins
//! that turns far away from the largest of its group, and a group stays joined only where all its
//! caps lie near the hull and less area is negative than before. If it does not, it is tried once
//! more without its slivers.
//!
//! This way is the crate's own. Cost: nothing where all facets are covered once. Otherwise O(n log
//! n) in the chains of groups, and for each group the product of its rim and its negative caps, up
//! to [`MOST_LOOKS`].

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{DVec2, DVec3, Sign, orient2d};

use super::chain::{ChainEdge, cancel};
use super::{CapSurface, Covering, Projection, ridges_of};
use crate::features::{Assignment, RidgeOnFacet};
use crate::ids::CapId;
use cranny_geometry::hull::{ConvexHull, Facet, FacetId};
use cranny_geometry::{HalfEdgeId, Mesh, VertexId};

/// How often a group grows. A face reaches over one facet as a rule, over several where these are
/// slim; smaller, and some of those stay negative; larger, and faces that lie twice in one place,
/// which no group mends, are looked at in vain.
const ROUNDS: usize = 4;

/// Comparisons of a place with an edge that a group may cost, a millisecond or so. Smaller, and
/// large sides with many negative caps are left as they are; larger, and a soup of coincident faces
/// takes long.
const MOST_LOOKS: usize = 1 << 18;

/// The least cosine of the angle between a facet and the largest of its group. Smaller than 0, and
/// sides that bend away from each other meet in one projection; above 0.7, and the slivers that cut
/// off a right edge remain apart, and negative.
const MOST_TURNED: f64 = 0.5;

/// The same where a group is tried without slivers. Sides that are rough by rounding turn less by
/// far.
const HARDLY_TURNED: f64 = 0.99;

/// The least component of the normal of any facet of a group along the axis that is looked along.
/// Nearer to 0, and facets are seen edge-on, where rounding turns triangles over; larger, and some
/// that fit together are seen along no axis.
const LEAST_SEEN: f64 = 0.25;

/// How many slabs deep a group's caps may lie beneath the hull. Smaller than 4, and sides rough by
/// a few flatnesses are left with negative caps, at 4 a bolt that bends a little as well; larger,
/// and volumes may be off by that much more.
const DEEPEST: f64 = 16.0;

/// What is looked at.
pub(super) struct Sharing<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) hull: &'a ConvexHull,
    pub(super) assignment: &'a Assignment,
    /// By facet, ascending.
    pub(super) chains: &'a [(u32, Vec<ChainEdge>)],
    pub(super) ridges: &'a [RidgeOnFacet],
}

/// Facets, ascending, and what is left of them together.
struct FacetGroup {
    members: BTreeSet<u32>,
    projection: Projection,
    covering: Covering,
    has_grown: bool,
}

impl Sharing<'_> {
    /// The surface with those facets covered together that are the better for it.
    pub(super) fn share(&self, alone: CapSurface) -> CapSurface {
        let negative = alone.negative.iter().map(|&cap| alone.facet_of(cap).0);
        let bad: BTreeSet<u32> = negative.chain(alone.crossed.iter().map(|f| f.0)).collect();
        let mut groups: Vec<FacetGroup> =
            bad.into_iter().map(|facet| self.group(BTreeSet::from([facet]))).collect();
        for _ in 0..ROUNDS {
            groups = self.grown(groups);
        }
        let mut groups: Vec<FacetGroup> =
            groups.into_iter().filter_map(|group| self.kept(group, &alone)).collect();
        groups.sort_unstable_by_key(|group| group.members.first().copied());
        self.filed(&alone, &groups)
    }

    fn group(&self, members: BTreeSet<u32>) -> FacetGroup {
        // What is seen along no axis is never joined; of one facet all is seen.
        let largest = self.largest(&members);
        let projection =
            self.projection(members.iter(), largest).unwrap_or_else(|| Projection::along(largest));
        let of = |f: &u32| self.chains.binary_search_by_key(f, |chain| chain.0).ok();
        let rows = members.iter().filter_map(of).map(|at| &self.chains[at].1);
        let mut chain: Vec<ChainEdge> = rows.flatten().copied().collect();
        cancel(&mut chain);
        let mut ridges: Vec<RidgeOnFacet> =
            members.iter().flat_map(|&f| ridges_of(self.ridges, f)).copied().collect();
        ridges.sort_unstable_by_key(|ridge| ridge.ends);
        ridges.dedup_by_key(|ridge| ridge.ends);
        let covering = Covering::of(self.mesh, projection, &chain, &ridges);
        FacetGroup { members, projection, covering, has_grown: true }
    }

    /// Each group that is not covered once, with the facets that it reaches into.
    fn grown(&self, groups: Vec<FacetGroup>) -> Vec<FacetGroup> {
        let mut home: BTreeMap<u32, usize> = BTreeMap::new();
        for (at, group) in groups.iter().enumerate() {
            home.extend(group.members.iter().map(|&f| (f, at)));
        }
        let mut members: Vec<BTreeSet<u32>> = groups.iter().map(|g| g.members.clone()).collect();
        for group in groups.iter().filter(|g| g.has_grown && !g.covering.is_sound()) {
            let Some(first) = group.members.first() else { continue };
            let mut largest = self.largest(&members[home[first]]);
            for facet in self.reached(group) {
                let at = home[first];
                let other = home.get(&facet).copied().filter(|&other| other != at);
                let joined = match other {
                    Some(other) => members[other].clone(),
                    None => BTreeSet::from([facet]),
                };
                let of_both = larger(largest, self.largest(&joined));
                let both = || members[at].iter().chain(&joined);
                if members[at].contains(&facet)
                    || !both().all(|&f| self.is_turned_less(f, of_both, MOST_TURNED))
                    || self.projection(both(), of_both).is_none()
                {
                    continue;
                }
                if let Some(other) = other {
                    members[other].clear();
                }
                home.extend(joined.iter().map(|&f| (f, at)));
                members[at].extend(joined);
                largest = of_both;
            }
        }
        let mut all = Vec::with_capacity(groups.len());
        for (members, group) in members.into_iter().zip(groups) {
            if members.len() > group.members.len() {
                all.push(self.group(members));
            } else if !members.is_empty() {
                all.push(FacetGroup { has_grown: false, ..group });
            }
        }
        all
    }

    /// The projection along which no facet is seen from behind or nearly edge-on: as near to the
    /// normal of the largest, whose area vector is given, as there is one.
    fn projection<'f>(
        &self,
        facets: impl Iterator<Item = &'f u32> + Clone,
        largest: DVec3,
    ) -> Option<Projection> {
        let mut axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * largest.dot(axis).signum());
        axes.sort_by(|a, b| largest.dot(*b).total_cmp(&largest.dot(*a)));
        let seen = |axis: &DVec3, f: u32| self.hull.facet(FacetId(f)).normal.dot(*axis);
        let sees_all = |axis: &DVec3| facets.clone().all(|&f| seen(axis, f) >= LEAST_SEEN);
        axes.into_iter().find(sees_all).map(Projection::along)
    }

    /// The area vector, doubled, of the largest of some facets.
    fn largest(&self, facets: &BTreeSet<u32>) -> DVec3 {
        let twice = |&t: &u32| {
            let [a, b, c] = self.hull.corners(t as usize);
            (b - a).cross(c - a)
        };
        let of_facet =
            |&f: &u32| self.hull.facet(FacetId(f)).triangles.iter().map(twice).sum::<DVec3>();
        facets.iter().map(of_facet).fold(DVec3::ZERO, larger)
    }

    /// Whether the cosine of the angle between a facet and an area vector is no less than `least`.
    fn is_turned_less(&self, facet: u32, from: DVec3, least: f64) -> bool {
        self.hull.facet(FacetId(facet)).normal.dot(from) >= least * from.length()
    }

    /// Facets across the rim of a group over which its negative caps reach.
    fn reached(&self, group: &FacetGroup) -> BTreeSet<u32> {
        let rim = self.rim(group);
        let at = |v: u32| self.mesh.position(VertexId(v));
        let mut places: Vec<DVec3> = Vec::new();
        for (corners, _) in group.covering.triangles.iter().filter(|(_, is_negative)| *is_negative)
        {
            let corners = corners.map(at);
            places.extend(corners);
            places.push((corners[0] + corners[1] + corners[2]) / 3.0);
        }
        if rim.len() * places.len() > MOST_LOOKS {
            return BTreeSet::new();
        }
        let depth = self.assignment.depth();
        let reaches = |edge: &RimEdge, p: DVec3| {
            edge.inward.dot(p - edge.from) < -depth && self.assignment.is_on(edge.facet, p)
        };
        rim.iter().filter(|e| places.iter().any(|&p| reaches(e, p))).map(|e| e.across).collect()
    }

    /// The edges of the hull between members of a group and other facets.
    fn rim(&self, group: &FacetGroup) -> Vec<RimEdge> {
        let mut rim = Vec::new();
        for &facet in &group.members {
            let Facet { normal, triangles, .. } = self.hull.facet(FacetId(facet));
            for h in triangles.iter().flat_map(|&t| 3 * t..3 * t + 3) {
                let twin = self.hull.twin(HalfEdgeId(h)).index() / 3;
                let across = self.hull.facet_of_triangle(twin).0;
                if group.members.contains(&across) {
                    continue;
                }
                let corners = self.hull.corners(h as usize / 3);
                let (from, to) = (corners[h as usize % 3], corners[(h as usize + 1) % 3]);
                let inward = normal.cross((to - from).normalize_or_zero());
                rim.push(RimEdge { facet, across, from, inward });
            }
        }
        rim
    }

    /// A group, or what of it hardly turns, that is the better for being covered together.
    fn kept(&self, group: FacetGroup, alone: &CapSurface) -> Option<FacetGroup> {
        let is_kept = |group: &FacetGroup| {
            group.members.len() > 1 && self.is_better(group, alone) && self.is_near_hull(group)
        };
        if is_kept(&group) {
            return Some(group);
        }
        let largest = self.largest(&group.members);
        let count = group.members.len();
        let mut members = group.members;
        members.retain(|&f| self.is_turned_less(f, largest, HARDLY_TURNED));
        (members.len() < count).then(|| self.group(members)).filter(is_kept)
    }

    /// Whether each triangle lies beneath some member, no deeper than [`DEEPEST`] slabs. Those of a
    /// facet alone always do, since its chain lies in its slab; so volumes are right up to layers
    /// as thin.
    fn is_near_hull(&self, group: &FacetGroup) -> bool {
        let is_near = |facet: u32, corners: [DVec3; 3]| {
            let Facet { normal, offset, thickness, .. } = self.hull.facet(FacetId(facet));
            let floor = offset - DEEPEST * thickness.max(self.assignment.depth());
            corners.iter().all(|p| normal.dot(*p) >= floor)
        };
        group.covering.triangles.iter().all(|(corners, _)| {
            let corners = corners.map(|v| self.mesh.position(VertexId(v)));
            group.members.iter().any(|&f| is_near(f, corners))
        })
    }

    /// Whether less is negative than where each facet is covered alone, or as little and nothing
    /// crosses.
    fn is_better(&self, group: &FacetGroup, alone: &CapSurface) -> bool {
        let area = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|v| self.mesh.position(VertexId(v)));
            (b - a).cross(c - a).length()
        };
        let negative = group.covering.triangles.iter().filter(|(_, is_negative)| *is_negative);
        let together: f64 = negative.map(|&(corners, _)| area(corners)).sum();
        let of_group = |cap: &&CapId| group.members.contains(&alone.facet_of(**cap).0);
        let before: f64 = alone
            .negative
            .iter()
            .filter(of_group)
            .map(|cap| area(alone.triangles[cap.index()]))
            .sum();
        group.covering.is_sound() || together < before
    }

    /// The surface with the caps of groups in place of those of their members.
    fn filed(&self, alone: &CapSurface, groups: &[FacetGroup]) -> CapSurface {
        let mut of_member: BTreeMap<u32, Vec<([u32; 3], bool)>> = BTreeMap::new();
        let mut surface = CapSurface { facet_starts: vec![0], ..CapSurface::default() };
        let mut crossed = BTreeSet::new();
        for group in groups {
            let Some(&first) = group.members.first() else { continue };
            if !group.covering.exact {
                crossed.insert(first);
            }
            surface.shared.extend(group.members.iter().map(|&f| [f, first]));
            group.members.iter().for_each(|&f| _ = of_member.insert(f, Vec::new()));
            let places = Places::of(self.hull, group);
            for &(corners, is_negative) in &group.covering.triangles {
                let middle = corners.map(|v| self.mesh.position(VertexId(v))).iter().sum::<DVec3>();
                let facet = places.beneath(middle / 3.0).unwrap_or(first);
                of_member.entry(facet).or_default().push((corners, is_negative));
            }
        }
        surface.shared.sort_unstable();
        for facet in 0..self.hull.facet_count() as u32 {
            let id = FacetId(facet);
            match of_member.get(&facet) {
                Some(triangles) => {
                    triangles.iter().for_each(|&(corners, sign)| surface.push(corners, sign));
                    if crossed.contains(&facet) {
                        surface.crossed.push(id);
                    }
                }
                None => surface.copy(alone, id, id),
            }
            surface.facet_starts.push(surface.triangles.len() as u32);
        }
        surface
    }
}

/// The longer of two vectors. Of those equal to the bit neither the first nor the last, which would
/// depend on how facets are numbered; sums over the triangles of equal facets may still differ by
/// rounding.
fn larger(a: DVec3, b: DVec3) -> DVec3 {
    let by_place = || b.to_array().partial_cmp(&a.to_array()).unwrap_or(Ordering::Equal);
    let by_length = b.length_squared().total_cmp(&a.length_squared());
    if by_length.then_with(by_place).is_gt() { b } else { a }
}

/// An edge of the hull on the rim of a group.
struct RimEdge {
    facet: u32,
    across: u32,
    from: DVec3,
    /// In the facet's plane, across the edge, of length 1.
    inward: DVec3,
}

/// The triangles of a group's facets, in its projection.
struct Places {
    projection: Projection,
    triangles: Vec<(u32, [DVec2; 3])>,
}

impl Places {
    fn of(hull: &ConvexHull, group: &FacetGroup) -> Self {
        let projection = group.projection;
        let placed = |t: u32| hull.corners(t as usize).map(|p| projection.apply(p));
        let of_facet =
            |&f: &u32| hull.facet(FacetId(f)).triangles.iter().map(move |&t| (f, placed(t)));
        Self { projection, triangles: group.members.iter().flat_map(of_facet).collect() }
    }

    /// The first facet that has a point in it or on its rim.
    fn beneath(&self, p: DVec3) -> Option<u32> {
        let p = self.projection.apply(p);
        let holds = |corners: &[DVec2; 3]| {
            (0..3).all(|k| orient2d(corners[k], corners[(k + 1) % 3], p) != Sign::Negative)
        };
        self.triangles.iter().find(|(_, corners)| holds(corners)).map(|&(facet, _)| facet)
    }
}
