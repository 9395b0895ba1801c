//! Bodies that overlap where a scene begins, and that a solver then drives apart.

use std::collections::BTreeSet;
use std::sync::Arc;

use cranny_broad_phase::BoxIndex;
use cranny_exact::Aabb;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Answer, Containment, Demand, PairMemory, Query};
use cranny_primitives::{BodyShape, PlacedShape, query_shapes};
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, PairDescription, SceneDescription,
};
use serde::Serialize;

/// Depth up to which an overlap is not reported, as a share of the smaller body's diagonal.
/// Smaller: bodies that stand on each other by rounded coordinates are named; larger: a jerk in the
/// first step comes without a warning.
const SHALLOW: f64 = 1e-4;

/// Overlaps that are listed.
const LISTED: usize = 8;

/// Two bodies that overlap where a scene begins.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct StartOverlap {
    a: String,
    b: String,
    /// Along the normal of a contact region: another way out may be shorter. `None`: one lies
    /// wholly within the other.
    depth: Option<f64>,
    /// The body that lies wholly within the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    inner: Option<String>,
}

/// All pairs that overlap, the deepest first. Bodies are [prepared](prepare).
pub(crate) fn at_start(scene: &SceneDescription) -> Vec<StartOverlap> {
    let mut found: Vec<(f64, StartOverlap)> = pairs(scene)
        .into_iter()
        .filter_map(|(a, b)| {
            let [a, b] = [a, b].map(|body| &scene.bodies[body]);
            let FoundOverlap { depth, inner } = overlap([a, b])?;
            let inner = inner.map(|inner| [a, b][inner].name.clone());
            let [a, b] = [a, b].map(|body| body.name.clone());
            let known = Some(depth).filter(|depth| depth.is_finite());
            Some((depth, StartOverlap { a, b, depth: known, inner }))
        })
        .collect();
    found.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    found.into_iter().map(|(_, overlap)| overlap).collect()
}

/// A sentence for each overlap that is listed, and one for all others.
pub(crate) fn sentences(overlaps: &[StartOverlap]) -> Vec<String> {
    let more = overlaps.len().saturating_sub(LISTED);
    let listed = overlaps.iter().take(LISTED).map(StartOverlap::sentence);
    let rest = match more {
        0 => None,
        1 => Some("1 more pair overlaps at the start".to_owned()),
        _ => Some(format!("{more} more pairs overlap at the start")),
    };
    listed.chain(rest).collect()
}

impl StartOverlap {
    fn sentence(&self) -> String {
        let Self { a, b, depth, inner } = self;
        let what = match (depth, inner) {
            (Some(depth), _) => format!("{a:?} and {b:?} overlap by up to {depth:.6}"),
            (None, Some(inner)) => {
                let outer = if inner == a { b } else { a };
                format!("{inner:?} lies wholly within {outer:?}")
            }
            (None, None) => format!("of {a:?} and {b:?} one lies wholly within the other"),
        };
        format!(
            "{what} at the start: the solver drives them apart. Move one, or say `collide: false` for the pair"
        )
    }
}

/// Pairs that a solver keeps apart and whose boxes overlap, sorted by the later body.
fn pairs(scene: &SceneDescription) -> Vec<(usize, usize)> {
    let boxes = boxes(scene);
    let index = BoxIndex::of(boxes.iter().copied());
    let apart = Apart::of(scene);
    let mut pairs = Vec::new();
    for (b, bounds) in boxes.iter().enumerate() {
        let near = index.reached(|held| held.overlaps(bounds));
        let mut near: Vec<usize> =
            near.filter(|&a| a < b && boxes[a].overlaps(bounds) && apart.keeps(a, b)).collect();
        near.sort_unstable();
        pairs.extend(near.into_iter().map(|a| (a, b)));
    }
    pairs
}

/// Which bodies a solver keeps apart.
struct Apart<'a> {
    scene: &'a SceneDescription,
    excluded: BTreeSet<(usize, usize)>,
    /// Names of pairs that respond by themselves, in both orders.
    responding: BTreeSet<[&'a str; 2]>,
}

impl<'a> Apart<'a> {
    fn of(scene: &'a SceneDescription) -> Self {
        let responding = scene.pairs.iter().filter(|pair| pair.effects.contains(&Effect::Response));
        let names = |pair: &'a PairDescription| [pair.a.as_str(), pair.b.as_str()];
        let both_orders = responding.map(names).flat_map(|[a, b]| [[a, b], [b, a]]);
        let excluded = scene.excluded_pairs.iter().copied().collect();
        Self { scene, excluded, responding: both_orders.collect() }
    }

    /// Of two bodies, the smaller number first.
    fn keeps(&self, a: usize, b: usize) -> bool {
        let bodies = [a, b].map(|body| &self.scene.bodies[body]);
        let [of_a, of_b] = bodies;
        let mut named = self.scene.effects.iter().chain(&of_a.effects).chain(&of_b.effects);
        bodies.iter().any(|body| body.kind == BodyKind::Dynamic)
            && bodies.iter().all(|body| !body.sensor)
            && of_a.layers.iter().any(|layer| of_b.layers.contains(layer))
            && !self.excluded.contains(&(a, b))
            && (named.any(|effect| *effect == Effect::Response)
                || self.responding.contains(&bodies.map(|body| body.name.as_str())))
    }
}

/// The box of each body.
fn boxes(scene: &SceneDescription) -> Vec<Aabb> {
    let bounds = |body: &BodyDescription| {
        let map = body.pose.world_from_body();
        let of_mesh = || map.bounds(&body.collision.bounds());
        body.shape.as_ref().map_or_else(of_mesh, |shape| shape.bounds(&map))
    };
    scene.bodies.iter().map(bounds).collect()
}

/// How deep two bodies overlap, infinite where one lies in the other, and which of them does.
struct FoundOverlap {
    depth: f64,
    inner: Option<usize>,
}

/// The overlap of two bodies, if deep enough to mention. Of a mesh that cannot be prepared nothing
/// is known: a run says why.
fn overlap([a, b]: [&BodyDescription; 2]) -> Option<FoundOverlap> {
    let question = Query::of(Demand::Regions { margin: 0.0 });
    let answer =
        query_shapes(placed(a)?, placed(b)?, &question, &mut PairMemory::default()).ok()?;
    let diagonal = |body: &BodyDescription| body.collision.bounds().diagonal();
    let depth = depth_of(&answer);
    let inner = answer.contained.filter(|_| depth.is_infinite()).map(|inner| match inner {
        Containment::AInB => 0,
        Containment::BInA => 1,
    });
    let is_deep = depth > SHALLOW * diagonal(a).min(diagonal(b));
    is_deep.then_some(FoundOverlap { depth, inner })
}

fn placed(body: &BodyDescription) -> Option<PlacedShape<'_>> {
    body.shape.as_ref().map(|shape| PlacedShape { shape, pose: body.pose })
}

fn depth_of(answer: &Answer) -> f64 {
    let of_regions = answer.regions.iter().filter_map(|region| region.depth);
    let of_contacts = answer.contacts.iter().map(|contact| -contact.separation);
    let known = of_regions.chain(of_contacts).fold(0.0, f64::max);
    if answer.contained.is_some() && known <= 0.0 { f64::INFINITY } else { known }
}

/// Prepares the meshes of bodies, each once, as a run does and then need not.
pub(crate) fn prepare(scene: &mut SceneDescription) {
    let mut known: Vec<(Arc<Mesh>, Option<BodyShape>)> = Vec::new();
    for body in scene.bodies.iter_mut().filter(|body| body.shape.is_none()) {
        let mesh = &body.collision;
        body.shape = match known.iter().find(|(other, _)| Arc::ptr_eq(other, mesh)) {
            Some((_, shape)) => shape.clone(),
            None => {
                let shape = prepared(mesh);
                known.push((Arc::clone(mesh), shape.clone()));
                shape
            }
        };
    }
}

fn prepared(mesh: &Mesh) -> Option<BodyShape> {
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let built = Model::build(mesh.clone(), &options).ok();
    built.map(|(model, _)| BodyShape::from(model))
}
