//! Regions followed from query to query: which of the last query's each one continues.
//!
//! A pair of faces meets in one place, so regions that share a pair of faces are the same place.
//! What has slid past whole faces since is matched by what is left: faces of one body, or where it
//! lies on either. Ids are history: no other part of an answer depends on them.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::{FaceId, ModelTag};

use crate::answer::{Region, RegionId};
use crate::query::Placed;

/// A region as the last query left it.
#[derive(Clone, Debug)]
struct Tracked {
    id: RegionId,
    /// Ascending.
    faces: Vec<[FaceId; 2]>,
    /// Its deepest point, in A's frame and in B's.
    place: [DVec3; 2],
    /// No point of it is farther from the deepest one.
    extent: f64,
}

/// By an old region and a new one, how many pairs of faces they share: at least one.
type Links = BTreeMap<(usize, usize), usize>;

/// The regions of the last query, in the caller's order of the bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct RegionTracks {
    whose: Option<[ModelTag; 2]>,
    regions: Vec<Tracked>,
    next: u32,
}

impl RegionTracks {
    pub(crate) fn bytes(&self) -> usize {
        let faces = self.regions.iter().map(|r| r.faces.capacity() * size_of::<[FaceId; 2]>());
        self.regions.capacity() * size_of::<Tracked>() + faces.sum::<usize>()
    }

    /// Names the regions of an answer, each after the one that it continues, and returns which ones
    /// it has a share of.
    ///
    /// Cost: near-linear in the faces of all regions, quadratic in the regions that share none.
    pub(crate) fn follow(&mut self, bodies: [Placed; 2], regions: &mut [Region]) {
        let back = bodies.map(|placed| placed.pose.world_from_body().inverse());
        let mut now: Vec<Tracked> = regions.iter().map(|r| Tracked::of(r, &back)).collect();
        let links = self.turned_to(bodies, &now);
        let heirs = self.heirs(&now, &links);
        let mut from: Vec<Vec<RegionId>> = vec![Vec::new(); now.len()];
        for &(i, j) in links.keys() {
            from[j].push(self.regions[i].id);
        }
        for (j, (region, mut from)) in now.iter_mut().zip(from).enumerate() {
            region.id = match heirs[j] {
                Some(i) => self.regions[i].id,
                None => self.fresh(),
            };
            from.extend(heirs[j].map(|i| self.regions[i].id));
            from.sort_unstable();
            from.dedup();
            (regions[j].id, regions[j].from) = (region.id, from);
        }
        self.regions = now;
    }

    fn fresh(&mut self) -> RegionId {
        self.next += 1;
        RegionId(self.next - 1)
    }

    /// Brings what is kept into the order of these bodies, and returns how much of it each new
    /// region shares. Of other models, nothing is kept; two bodies of one model may have changed
    /// places, if that fits better.
    fn turned_to(&mut self, [a, b]: [Placed; 2], now: &[Tracked]) -> Links {
        let [as_before, exchanged] = match &self.whose {
            Some([first, second]) => [[a, b], [b, a]]
                .map(|[a, b]: [Placed; 2]| first.is_of(a.model) && second.is_of(b.model)),
            None => [false; 2],
        };
        self.whose = Some([ModelTag::of(a.model), ModelTag::of(b.model)]);
        if !as_before && !exchanged {
            self.regions.clear();
        }
        let mut known: Vec<([FaceId; 2], usize)> = Vec::new();
        for (i, region) in self.regions.iter().enumerate() {
            known.extend(region.faces.iter().map(|&faces| (faces, i)));
        }
        known.sort_unstable();
        let kept = links(&known, now, |faces| faces);
        let others = if exchanged { links(&known, now, |[f, g]| [g, f]) } else { Links::new() };
        let shared = |links: &Links| links.values().sum::<usize>();
        if !exchanged || as_before && shared(&kept) >= shared(&others) {
            return kept;
        }
        self.exchange();
        others
    }

    fn exchange(&mut self) {
        for region in &mut self.regions {
            region.place.reverse();
            region.faces.iter_mut().for_each(|faces| faces.reverse());
            region.faces.sort_unstable();
        }
    }

    /// The old region whose name each new one bears: that with which it shares most, and where it
    /// shares pairs of faces with none, the nearest that nobody else continues.
    fn heirs(&self, now: &[Tracked], links: &Links) -> Vec<Option<usize>> {
        let mut heirs = vec![None; now.len()];
        let mut taken = vec![false; self.regions.len()];
        let mut settle = |pairs: &mut dyn Iterator<Item = (usize, usize)>| {
            for (i, j) in pairs {
                if !taken[i] && heirs[j].is_none() {
                    (taken[i], heirs[j]) = (true, Some(i));
                }
            }
        };
        let mut strong: Vec<(usize, usize)> = links.keys().copied().collect();
        strong.sort_by_key(|&(i, j)| (usize::MAX - links[&(i, j)], self.regions[i].id, j));
        settle(&mut strong.into_iter());
        let mut linked = [vec![false; self.regions.len()], vec![false; now.len()]];
        for &(i, j) in links.keys() {
            (linked[0][i], linked[1][j]) = (true, true);
        }
        let lonely = |linked: &[bool]| -> Vec<usize> {
            (0..linked.len()).filter(|&index| !linked[index]).collect()
        };
        let mut weak: Vec<(f64, usize, usize)> = Vec::new();
        let new = lonely(&linked[1]);
        for i in lonely(&linked[0]) {
            let near = new.iter().filter_map(|&j| Some((self.regions[i].apart(&now[j])?, i, j)));
            weak.extend(near);
        }
        weak.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        settle(&mut weak.into_iter().map(|(_, i, j)| (i, j)));
        heirs
    }
}

/// How many pairs of faces an old region (first) and a new one share, where any. `known`: pairs of
/// faces of old regions, ascending, each with its region. `ordered` puts a new region's pair into
/// their order.
fn links(
    known: &[([FaceId; 2], usize)],
    now: &[Tracked],
    ordered: impl Fn([FaceId; 2]) -> [FaceId; 2],
) -> Links {
    let mut links = BTreeMap::new();
    for (j, region) in now.iter().enumerate() {
        for faces in region.faces.iter().map(|&faces| ordered(faces)) {
            let at = known.partition_point(|(its, _)| *its < faces);
            for &(_, i) in known[at..].iter().take_while(|(its, _)| *its == faces) {
                *links.entry((i, j)).or_insert(0) += 1;
            }
        }
    }
    links
}

impl Tracked {
    fn of(region: &Region, back: &[RigidMap; 2]) -> Self {
        let at = region.deepest.point_a;
        let points = region.points.iter().map(|c| c.point_a);
        let curves = region.curves.iter().flat_map(|c| c.points.iter().copied());
        let extent = points.chain(curves).map(|p| (p - at).length()).fold(0.0, f64::max);
        let place = [back[0].apply(at), back[1].apply(region.deepest.point_b)];
        Self { id: region.id, faces: region.faces.clone(), place, extent }
    }

    /// How far a later region lies from this one on the body on which they lie nearer, if it may be
    /// the same: they have a face of either body in common, or reach each other.
    fn apart(&self, later: &Self) -> Option<f64> {
        let along = |side: usize| (self.place[side] - later.place[side]).length();
        let nearer = along(0).min(along(1));
        let shares = |side: usize| {
            let mine: BTreeSet<FaceId> = self.faces.iter().map(|faces| faces[side]).collect();
            later.faces.iter().any(|faces| mine.contains(&faces[side]))
        };
        (nearer <= self.extent + later.extent || shares(0) || shares(1)).then_some(nearer)
    }
}
