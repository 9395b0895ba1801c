//! Contacts of a pair that are carried on instead of searched again.
//!
//! What rests is found to rest in each step anew, and a search costs as much as for what moves. So
//! a pair keeps the contacts of its last search, and of the search its relative pose and reach.
//! While the [drift](cranny_narrow_phase::drift) since that pose stays within [`CARRIED_WITHIN`],
//! the same features make the solver's contacts, each computed at the present pose (`refreshed`):
//!
//! - of a vertex on a face, the face's plane and the vertex, both where they are now;
//! - of two edges, the cross product of their directions and the points nearest to each other;
//! - of whatever else made a contact, both points where their bodies have taken them, along the
//!   normal that rides with the body whose feature it belongs to.
//!
//! A way out of a deep overlap that nothing else touches is carried on farther, over a share of the
//! thinner body's thickness ([`cranny_primitives::deep::lasts`]): it is one for the whole body, and
//! no feature makes it.
//!
//! # What a carried list can be wrong by
//!
//! The drift bounds how much the distance of any two points of the bodies has changed. So
//!
//! - features that are not listed come nearer than the search saw them by the drift at most: within
//!   reach of the search by that, and nearer than what stood for their patches by twice that;
//! - the gap of a listed vertex and face, or of two edges, is theirs at the present pose;
//! - a contact's point has left its feature by the drift at most: beyond, the pair is searched.
//!
//! # What is kept
//!
//! A list follows from the pose and the reach of its search alone ([`Search`]), which are what a
//! snapshot holds; the list itself only saves time.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cranny_exact::{DVec3, Pose, RigidMap};
use cranny_geometry::{EdgeId, Model};
use cranny_narrow_phase::{Contact, Feature};
use cranny_primitives::deep::eased;
use rapier3d::parry::shape::PackedFeatureId;

/// The drift within which a pair's contacts are carried on, as a part of the prediction distance.
/// Larger: features that are not listed are met later by as much; smaller: what swings and comes to
/// rest is searched again (with a tenth of this a hook on its ring takes four times as long).
pub const CARRIED_WITHIN: f64 = 0.1;

/// Squared sine of the angle below which two edges count as parallel, as in the search that finds
/// them. Larger: pairs are searched for nothing; smaller: a small turn moves the contact far.
const PARALLEL: f64 = 1e-6;

/// By how much, squared, the normal of two edges may differ from what their cross product says and
/// still be that. Larger: what is reported along another direction turns with the edges; smaller:
/// edges at a small angle are searched for their rounding.
const SAME_CROSS: f64 = 1e-12;

/// Of what a pair's list of contacts follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Search {
    /// The second body's in the first one's frame.
    pub(crate) pose: Pose,
    /// How far it looked.
    pub(crate) reach: f64,
    /// How far bodies may drift and still be led by what it found, where that is a way out.
    pub(crate) lasts: Option<f64>,
    /// The last step in which its contacts were the solver's.
    pub(crate) step: u64,
}

/// The searches whose contacts may be carried on, by tags. Shared by a dispatcher and its owner.
#[derive(Clone, Debug, Default)]
pub(crate) struct Searches(Arc<Mutex<KnownSearches>>);

#[derive(Debug, Default)]
struct KnownSearches {
    step: u64,
    last: BTreeMap<(u32, u32), Search>,
    counts: PairCounts,
}

/// How the contacts of pairs were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairCounts {
    /// Computed anew from the features of an earlier search.
    pub carried: usize,
    /// Searched.
    pub searched: usize,
}

impl Searches {
    fn known(&self) -> MutexGuard<'_, KnownSearches> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A step of rapier's begins. What is not carried through it is searched in the next.
    pub(crate) fn begin_step(&self) {
        self.known().step += 1;
    }

    /// Pairs since this was last read.
    pub(crate) fn take_counts(&self) -> PairCounts {
        std::mem::take(&mut self.known().counts)
    }

    /// The search of a pair whose contacts the solver got in the step before.
    pub(crate) fn of_step_before(&self, tags: (u32, u32)) -> Option<Search> {
        let known = self.known();
        known.last.get(&tags).copied().filter(|search| search.step + 1 == known.step)
    }

    /// Notes that a pair's contacts were carried on.
    pub(crate) fn carry(&self, tags: (u32, u32)) {
        let known = &mut *self.known();
        known.counts.carried += 1;
        if let Some(search) = known.last.get_mut(&tags) {
            search.step = known.step;
        }
    }

    /// Notes that a pair was searched: pose, reach, and how far a way out lasts. `None` where what
    /// was found is of the present pose alone.
    pub(crate) fn note(&self, tags: (u32, u32), search: Option<(Pose, f64, Option<f64>)>) {
        self.known().counts.searched += 1;
        match search {
            Some(search) => self.put_back(tags, search),
            None => {
                self.known().last.remove(&tags);
            }
        }
    }

    /// Knows a search as one of this step: a new one, or one that [lasted](Self::lasting).
    pub(crate) fn put_back(&self, tags: (u32, u32), search: (Pose, f64, Option<f64>)) {
        let known = &mut *self.known();
        let (pose, reach, lasts) = search;
        known.last.insert(tags, Search { pose, reach, lasts, step: known.step });
    }

    /// Forgets all pairs that fail a test.
    pub(crate) fn retain(&self, mut keep: impl FnMut(u32, u32) -> bool) {
        self.known().last.retain(|&(first, second), _| keep(first, second));
    }

    /// Number of pairs that it knows.
    pub(crate) fn len(&self) -> usize {
        self.known().last.len()
    }

    /// Those that the next step may carry on, by ascending tags.
    #[cfg(feature = "snapshot")]
    pub(crate) fn lasting(&self) -> Vec<((u32, u32), Search)> {
        let known = self.known();
        let last = known.last.iter().map(|(&tags, &search)| (tags, search));
        last.filter(|(_, search)| search.step == known.step).collect()
    }
}

/// A pair's contacts as they were searched.
#[derive(Clone, Debug)]
pub(crate) struct CarriedList {
    search: (Pose, f64),
    /// The lesser thickness of the bodies that these contacts lead out of each other.
    led: Option<f64>,
    contacts: Vec<Carried>,
}

/// A contact, each body's part of it in that body's frame.
#[derive(Clone, Debug)]
struct Carried {
    features: (Feature, Feature),
    ids: (PackedFeatureId, PackedFeatureId),
    points: [DVec3; 2],
    made_by: MadeBy,
}

/// What determines the normal of a contact.
#[derive(Clone, Debug)]
enum MadeBy {
    /// The first body, in its frame.
    First(DVec3),
    /// The second body, in its frame.
    Second(DVec3),
    /// An edge of each, from its beginning to its end; whether the cross product is the normal or
    /// its opposite.
    Edges([[DVec3; 2]; 2], f64),
}

impl CarriedList {
    /// Of contacts in the first body's frame, and what they are known by; `led` is the lesser
    /// thickness where they are the leads of a way out.
    pub(crate) fn of<'a>(
        models: [&Model; 2],
        search: (Pose, f64),
        led: Option<f64>,
        contacts: impl Iterator<Item = (&'a Contact, (PackedFeatureId, PackedFeatureId))>,
    ) -> Self {
        let map = search.0.world_from_body();
        let carried = |(contact, ids)| Carried::of(models, &map, contact, ids);
        Self { search, led, contacts: contacts.map(carried).collect() }
    }

    /// Whether it is what this search found.
    pub(crate) fn is_of(&self, search: &Search) -> bool {
        self.search == (search.pose, search.reach)
    }

    /// Whether its contacts lead out of a deep overlap.
    pub(crate) fn is_of_leads(&self) -> bool {
        self.led.is_some()
    }

    /// Its contacts at another pose, and what they are known by; `None` where one has left its
    /// features by more than `within`.
    pub(crate) fn refreshed(
        &self,
        map: &RigidMap,
        within: f64,
    ) -> Option<Vec<(Contact, (PackedFeatureId, PackedFeatureId))>> {
        let refreshed = |c: &Carried| {
            let contact = c.refreshed(map, within)?;
            Some((self.led.map_or(contact, |thickness| eased(contact, thickness)), c.ids))
        };
        self.contacts.iter().map(refreshed).collect()
    }
}

impl Carried {
    fn of(
        models: [&Model; 2],
        map: &RigidMap,
        contact: &Contact,
        ids: (PackedFeatureId, PackedFeatureId),
    ) -> Self {
        let back = map.inverse();
        let made_by = match contact.id {
            (Feature::Edge(e), Feature::Edge(g)) => of_edges(models, map, contact, [e, g]),
            (_, Feature::Face(_)) | (Feature::Vertex(_), Feature::Edge(_)) => None,
            _ => Some(MadeBy::First(contact.normal)),
        };
        Self {
            features: contact.id,
            ids,
            points: [contact.point_a, back.apply(contact.point_b)],
            made_by: made_by.unwrap_or_else(|| MadeBy::Second(back.apply_vector(contact.normal))),
        }
    }

    fn refreshed(&self, map: &RigidMap, within: f64) -> Option<Contact> {
        let [mut point_a, mut point_b] = [self.points[0], map.apply(self.points[1])];
        let normal = match self.made_by {
            MadeBy::First(normal) => normal,
            MadeBy::Second(normal) => map.apply_vector(normal),
            MadeBy::Edges([e, g], sign) => {
                let (points, cross) = crossing(e, g.map(|p| map.apply(p)), within)?;
                [point_a, point_b] = points;
                sign * cross
            }
        };
        let separation = normal.dot(point_b - point_a);
        // A vertex is where it is; what lies before it on a face moves along.
        match self.features {
            (Feature::Vertex(_), Feature::Face(_)) => point_b = point_a + normal * separation,
            (Feature::Face(_), Feature::Vertex(_)) => point_a = point_b - normal * separation,
            _ => {}
        }
        Some(Contact { id: self.features, point_a, point_b, normal, separation })
    }
}

/// Two edges as what makes a contact, if its normal is their cross product.
fn of_edges(
    models: [&Model; 2],
    map: &RigidMap,
    contact: &Contact,
    [e, g]: [EdgeId; 2],
) -> Option<MadeBy> {
    let ends = |model: &Model, edge: EdgeId| {
        let edge = model.topology().edges()[edge.index()];
        [edge.from, edge.to].map(|v| model.mesh().vertices()[v.index()])
    };
    let [e, g] = [ends(models[0], e), ends(models[1], g)];
    let ([point_a, _], cross) = crossing(e, g.map(|p| map.apply(p)), f64::INFINITY)?;
    let sign = cross.dot(contact.normal).signum();
    let off = (sign * cross - contact.normal).length_squared();
    let beside = (point_a - contact.point_a).length_squared();
    let length = (e[1] - e[0]).length_squared();
    (off <= SAME_CROSS && beside <= SAME_CROSS * length).then_some(MadeBy::Edges([e, g], sign))
}

/// Where two lines are nearest to each other, on each, and the unit cross product of their
/// directions; `None` where they are parallel, or that is off an edge by more than `within`.
fn crossing(e: [DVec3; 2], g: [DVec3; 2], within: f64) -> Option<([DVec3; 2], DVec3)> {
    let (d, f, between) = (e[1] - e[0], g[1] - g[0], g[0] - e[0]);
    let cross = d.cross(f);
    let (squared, lengths) = (cross.length_squared(), [d.length_squared(), f.length_squared()]);
    if squared <= PARALLEL * lengths[0] * lengths[1] {
        return None;
    }
    let (s, t) = (between.cross(f).dot(cross) / squared, between.cross(d).dot(cross) / squared);
    let off = |x: f64, length: f64| (x - x.clamp(0.0, 1.0)).powi(2) * length > within * within;
    let is_off = off(s, lengths[0]) || off(t, lengths[1]);
    (!is_off).then(|| ([e[0] + d * s, g[0] + f * t], cross / squared.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::{PairWorkspace, Reach};
    use crate::shape::MeshShape;
    use cranny_exact::DQuat;
    use cranny_geometry::BuildOptions;
    use cranny_narrow_phase::drift;
    use cranny_shapes::{Cuboid, Cup, LPrism, Shape};

    const REACH: f64 = 0.02;

    fn built(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    fn deepest(contacts: &[crate::manifolds::SolverContact]) -> f64 {
        contacts.iter().map(|c| c.separation).fold(f64::INFINITY, f64::min)
    }

    /// One body slides and rocks on another: as long as it is carried on, a new search finds the
    /// same depth but for the drift; and it is carried on until the drift is spent.
    #[test]
    fn a_carried_list_is_a_new_search_but_for_the_drift() {
        let (slab, cup) = (built(Cuboid { size: [4.0, 4.0, 1.0] }), built(Cup::default()));
        let l = built(LPrism::default());
        let shape = |model: &Model| MeshShape::new(model, 0).unwrap();
        for (lower, upper, at) in [
            (&slab, &cup, DVec3::new(0.1, 0.2, 0.5)),
            (&slab, &l, DVec3::new(0.1, 0.2, 0.5)),
            (&cup, &cup, DVec3::new(0.0, 0.0, cup.bounds().max.z)),
        ] {
            let bottom = DVec3::Z * (upper.bounds().min.z + 1e-3);
            // Of what is carried on, so many parts a step.
            let part = CARRIED_WITHIN * REACH / 2e-3;
            let pose = |k: f64| Pose {
                rotation: DQuat::from_scaled_axis(DVec3::new(2e-4, 3e-4, 5e-4) * (part * k.sin())),
                translation: at - bottom + DVec3::new(2e-4, 1e-4, -5e-5) * (part * k),
            };
            let (g1, g2) = (shape(lower), shape(upper));
            let mut pair = PairWorkspace::for_solver(&g1, &g2);
            let search = Search { pose: pose(0.0), reach: REACH, lasts: None, step: 0 };
            let found = pair.found(&search.pose, &g1, &g2, Reach::all(REACH)).unwrap();
            assert!(pair.keep(&found, (search.pose, REACH)) && !found.contacts.is_empty());
            let (mut carried_on, mut spent) = (0, 0);
            for k in 0..60 {
                let now = pose(0.3 * f64::from(k));
                let moved =
                    drift([lower, upper], &search.pose.world_from_body(), &now.world_from_body());
                let within = CARRIED_WITHIN * REACH;
                let Some(carried) = pair.carried(&search, &now, within) else {
                    assert!(moved > within, "step {k}: given up after {moved}");
                    spent += 1;
                    continue;
                };
                assert!(moved <= within, "step {k}: carried on over {moved}");
                carried_on += 1;
                let anew = PairWorkspace::for_solver(&g1, &g2);
                let anew = { anew }.found(&now, &g1, &g2, Reach::all(REACH)).unwrap().contacts;
                let off = deepest(&carried) - deepest(&anew);
                assert!(off.abs() <= 2.0 * moved + 1e-9, "step {k}: off by {off}, moved {moved}");
                for contact in &carried {
                    let gap = contact.normal.dot(contact.on_second - contact.on_first);
                    assert!((gap - contact.separation).abs() < 1e-12);
                    assert!((contact.normal.length() - 1.0).abs() < 1e-12);
                }
            }
            assert!(carried_on > 10 && spent > 10, "{carried_on} carried on, {spent} not");
        }
    }

    /// A crossing of edges is reported where they cross now, with the normal that they have now.
    #[test]
    fn edges_are_told_where_they_cross() {
        let e = [DVec3::new(-1.0, 0.0, 0.0), DVec3::X];
        let g = |x: f64, turn: f64| [-1.0, 1.0].map(|y| DVec3::new(x - turn * y, y, 0.25));
        let ([p, q], cross) = crossing(e, g(0.5, 0.0), 0.0).unwrap();
        assert_eq!((p, q), (DVec3::X * 0.5, DVec3::new(0.5, 0.0, 0.25)));
        assert_eq!(cross, DVec3::Z);
        let ([p, _], _) = crossing(e, g(0.6, 0.1), 0.0).unwrap();
        assert!((p.x - 0.6).abs() < 1e-12, "{p}");
        assert!(crossing(e, g(1.1, 0.0), 0.05).is_none(), "beyond its end");
        assert!(crossing(e, g(1.1, 0.0), 0.11).is_some(), "by no more than it may");
        assert!(crossing(e, e.map(|p| p + DVec3::Z), 1.0).is_none(), "parallel");
    }

    /// Only what the solver got in the step before goes on.
    #[test]
    fn a_step_without_a_pair_ends_its_search() {
        let searches = Searches::default();
        searches.begin_step();
        searches.note((1, 2), Some((Pose::IDENTITY, REACH, None)));
        searches.begin_step();
        assert!(searches.of_step_before((1, 2)).is_some());
        searches.carry((1, 2));
        searches.begin_step();
        assert!(searches.of_step_before((1, 2)).is_some());
        searches.begin_step();
        assert!(searches.of_step_before((1, 2)).is_none(), "it slept, or was elsewhere");
        assert_eq!(searches.take_counts(), PairCounts { carried: 1, searched: 1 });
        assert_eq!(searches.take_counts(), PairCounts::default());
        searches.note((1, 2), None);
        assert_eq!(searches.len(), 0);
    }
}
