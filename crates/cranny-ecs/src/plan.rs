//! The plan of a scene, read from the schedules and the world that its plugins built: what runs, in
//! which order, for which pairs, and what is absent.

use std::collections::{BTreeMap, BTreeSet};

use bevy_ecs::prelude::*;
use bevy_ecs::schedule::graph::Direction;
use bevy_ecs::schedule::{
    InternedScheduleLabel, InternedSystemSet, NodeId, ScheduleLabel, Schedules, SystemKey,
};
use cranny_world::description::Normals;
use cranny_world::{BodyId, ContactFields};
use serde::Serialize;

use crate::body::Bodies;
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep};
use crate::contacts::ContactsSystems;
use crate::continuous::ContinuousSystems;
use crate::effects::{AskedBy, EffectKind, EffectTable, Pair};
use crate::force_feedback::ForceFeedbackSystems;
use crate::kinematics::KinematicsSystems;
use crate::paths::PathSystems;
use crate::penetration::PenetrationSystems;
use crate::proximity::ProximitySystems;
use crate::readers::ContactReaders;
use crate::tracking::TrackingSystems;
use crate::trigger::TriggerSystems;

/// Pairs of a group, at most, that are named.
const EXAMPLES: usize = 6;

/// What a scene runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Effects that run, with where they come from.
    pub effects: Vec<PlannedEffect>,
    /// Schedules with their systems, in the order in which they run.
    pub schedules: Vec<PlannedSchedule>,
    /// Pairs, grouped by their effects and where these come from; the largest group first.
    pub pairs: Vec<PlannedPairs>,
    /// Elementary tests that a step may take for triggers and distances, all together; `None`: as
    /// many as they need.
    pub budget: Option<u64>,
    /// Effects of which nothing is in the app: no system, component, message or resource.
    pub absent: Vec<AbsentEffect>,
}

/// An effect that runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedEffect {
    /// Its name.
    pub name: &'static str,
    /// Where it comes from: "the scene", "body 'nut'", "1 pair".
    pub asked_by: Vec<String>,
    /// Who reads what of it, "the recording reads depth, points, regions": of `Contacts` those that
    /// subscribed, of the others what they end in.
    pub read_by: Vec<String>,
}

/// A schedule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedSchedule {
    /// Its label.
    pub name: String,
    /// In the order in which they run.
    pub systems: Vec<PlannedSystem>,
}

/// A system of a schedule.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct PlannedSystem {
    /// Module and function.
    pub name: String,
    /// Effects whose sets it is in, directly or through other sets; `core` for what every scene
    /// runs.
    pub effects: Vec<&'static str>,
    /// Sets of these effects that it is in.
    pub sets: Vec<&'static str>,
}

/// Pairs with the same effects, for the same reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedPairs {
    /// How many.
    pub count: usize,
    /// Their effects, with parameters; empty where the pairs never meet or have none.
    pub effects: Vec<String>,
    /// What is computed: the union of what is read, "solver contacts" for the solver.
    pub fields: Vec<&'static str>,
    /// Who reads which of it, "Trigger reads verdict"; of `Contacts` those that subscribed.
    pub read_by: Vec<String>,
    /// At which level `Trigger` and `Proximity` are known, "caps"; `None` where the pair has
    /// neither.
    pub accuracy: Option<String>,
    /// Who detects them: "solver", "world", "solver and world" or "nobody".
    pub detected_by: &'static str,
    /// Where the effects come from, or why there are none.
    pub why: String,
    /// Some of them by name.
    pub examples: Vec<[String; 2]>,
}

/// An effect of which nothing is in the app.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AbsentEffect {
    /// Its name.
    pub name: &'static str,
    /// Why.
    pub why: &'static str,
}

/// A set of an effect.
struct KnownSet {
    effect: &'static str,
    name: &'static str,
    set: InternedSystemSet,
}

macro_rules! known {
    ($($effect:literal: $($set:ident::$variant:ident),+;)*) => {
        vec![$($(KnownSet {
            effect: $effect,
            name: concat!(stringify!($set), "::", stringify!($variant)),
            set: $set::$variant.intern(),
        }),+),*]
    };
}

fn known_sets() -> Vec<KnownSet> {
    #[cfg_attr(
        not(any(feature = "rapier", feature = "record", feature = "render")),
        expect(unused_mut, reason = "other effects add theirs")
    )]
    let mut sets = known! {
        "core": CoreSystems::Admit, CoreSystems::Motion, CoreSystems::Clock, CoreSystems::Failure,
            KinematicsSystems::Move, PathSystems::Lead;
        "Trigger": TriggerSystems::Detect, TriggerSystems::Report;
        "Proximity": ProximitySystems::Detect, ProximitySystems::Report;
        "Contacts": ContactsSystems::Detect, ContactsSystems::Report;
        "Penetration": PenetrationSystems::Detect, PenetrationSystems::Report;
        "ForceFeedback": ForceFeedbackSystems::Feel;
        "Tracking": TrackingSystems::Simulate, TrackingSystems::Lead, TrackingSystems::Decide,
            TrackingSystems::Compare;
        "Continuous": ContinuousSystems::Sync, ContinuousSystems::Report, ContinuousSystems::Start,
            ContinuousSystems::Hold;
    };
    #[cfg(feature = "rapier")]
    {
        use crate::deformation::DeformationSystems;
        use crate::response::ResponseSystems;
        use crate::sound::SoundSystems;
        sets.extend(known! {
            "Response": ResponseSystems::Sync, ResponseSystems::Solve, ResponseSystems::Supply,
                ResponseSystems::Tally, ResponseSystems::Advance;
            "Sound": SoundSystems::Report;
            "Deformation": DeformationSystems::Dent;
        });
    }
    #[cfg(feature = "record")]
    {
        use crate::recording::RecordingSystems;
        sets.extend(known! { "Recording": RecordingSystems::Frame; });
    }
    #[cfg(feature = "render")]
    {
        use crate::rendering::RenderingSystems;
        sets.extend(known! { "Rendering": RenderingSystems::Read, RenderingSystems::Picture; });
    }
    sets
}

/// All effects, each with why it is absent where it is.
const EFFECTS: [(&str, &str); 12] = [
    ("Trigger", "the scene, its bodies and pairs name no Trigger"),
    ("Proximity", "the scene, its bodies and pairs name no Proximity"),
    ("Contacts", "the scene, its bodies and pairs name no Contacts"),
    ("Penetration", "the scene, its bodies and pairs name no Penetration"),
    ("Response", "the scene, its bodies and pairs name no Response"),
    ("Continuous", "the scene, its bodies and pairs name no Continuous"),
    ("Sound", "the scene, its bodies and pairs name no Sound"),
    ("Deformation", "the scene, its bodies and pairs name no Deformation"),
    ("ForceFeedback", "the scene, its bodies and pairs name no ForceFeedback"),
    ("Tracking", "the scene, its bodies and pairs name no Tracking"),
    ("Recording", "no recording is asked for (--record)"),
    ("Rendering", "no pictures are asked for (--frames, --preview)"),
];

impl Plan {
    /// Reads the plan of an app to which [`CrannyPlugins`](crate::CrannyPlugins) were added.
    ///
    /// Schedules that were never run are initialised; nothing runs.
    ///
    /// # Errors
    ///
    /// The text of bevy's error where systems contradict each other's order, as only systems that
    /// were added to ours can.
    pub fn of(world: &mut World) -> Result<Self, String> {
        let labels = [("CrannyStep", CrannyStep.intern()), ("CrannyEnd", CrannyEnd.intern())];
        let mut schedules = Vec::new();
        for (name, label) in labels {
            let systems = systems(world, label)?;
            schedules.push(PlannedSchedule { name: name.to_owned(), systems });
        }
        let table = world.get_resource::<EffectTable>().cloned().unwrap_or_default();
        let bodies = world.get_resource::<Bodies>().cloned().unwrap_or_default();
        let readers = world.get_resource::<ContactReaders>().cloned().unwrap_or_default();
        let runs = |effect: &str| {
            schedules.iter().flat_map(|s| &s.systems).any(|s| s.effects.contains(&effect))
        };
        let effects =
            EFFECTS.iter().filter(|(name, _)| runs(name)).map(|&(name, _)| PlannedEffect {
                name,
                asked_by: asked_by(name, &table, &bodies),
                read_by: effect_read_by(name, &table, &readers),
            });
        let absent = EFFECTS.iter().filter(|(name, _)| !runs(name));
        Ok(Self {
            effects: effects.collect(),
            absent: absent.map(|&(name, why)| AbsentEffect { name, why }).collect(),
            budget: table.budget(),
            pairs: pairs(&table, &bodies, &readers, exact_solver(world)),
            schedules,
        })
    }
}

#[cfg(feature = "rapier")]
fn exact_solver(world: &World) -> bool {
    world.get_resource::<crate::solved::RigidBodies>().is_some_and(|bodies| bodies.hands_over())
}

#[cfg(not(feature = "rapier"))]
fn exact_solver(_: &World) -> bool {
    false
}

/// Systems of a schedule in the order in which they run.
fn systems(world: &mut World, label: InternedScheduleLabel) -> Result<Vec<PlannedSystem>, String> {
    let Some(mut schedule) =
        world.get_resource_mut::<Schedules>().and_then(|mut schedules| schedules.remove(label))
    else {
        return Err(format!("the app has no schedule {label:?}: add CrannyPlugins first"));
    };
    let initialized = schedule
        .initialize(world)
        .map(drop)
        .map_err(|error| error.to_string(schedule.graph(), world));
    let known = known_sets();
    let planned = schedule.systems().map(|systems| {
        systems
            // bevy's own points of synchronisation are no effect's.
            .filter(|(_, system)| system.name().as_string() != "bevy_ecs::apply_deferred")
            .map(|(key, system)| {
                let name = system.name().as_string();
                // Hooks of an app are a parameter of the system's type.
                planned(&schedule, key, name.split('<').next().unwrap_or_default(), &known)
            })
            .collect()
    });
    let planned = planned.map_err(|error| error.to_string());
    world.get_resource_or_init::<Schedules>().insert(schedule);
    initialized.and(planned)
}

fn planned(schedule: &Schedule, key: SystemKey, name: &str, known: &[KnownSet]) -> PlannedSystem {
    let graph = schedule.graph();
    let mut ancestors = vec![NodeId::System(key)];
    let mut at = 0;
    while let Some(&node) = ancestors.get(at) {
        for parent in graph.hierarchy().neighbors_directed(node, Direction::Incoming) {
            if !ancestors.contains(&parent) {
                ancestors.push(parent);
            }
        }
        at += 1;
    }
    let is_in = |set: &KnownSet| {
        graph.system_sets.get_key(set.set).is_some_and(|key| ancestors.contains(&NodeId::Set(key)))
    };
    let sets: Vec<&KnownSet> = known.iter().filter(|set| is_in(set)).collect();
    let mut effects: Vec<&'static str> = sets.iter().map(|set| set.effect).collect();
    effects.dedup();
    PlannedSystem {
        name: name.strip_prefix("cranny_ecs::").unwrap_or(name).to_owned(),
        effects,
        sets: sets.iter().map(|set| set.name).collect(),
    }
}

fn asked_by(effect: &str, table: &EffectTable, bodies: &Bodies) -> Vec<String> {
    let Some(kind) = EffectKind::ALL.into_iter().find(|kind| kind.name() == effect) else {
        return vec!["the run".to_owned()];
    };
    let names = |effects: &[_]| effects.iter().any(|e| EffectKind::of(e) == Some(kind));
    let mut asked = Vec::new();
    if names(table.of_scene()) {
        asked.push("the scene".to_owned());
    }
    let of_bodies = bodies.iter().filter(|(id, _)| names(table.of_body(*id)));
    asked.extend(of_bodies.map(|(_, record)| format!("body '{}'", record.name)));
    match table.of_pairs().filter(|(_, effects)| names(effects)).count() {
        0 => {}
        1 => asked.push("1 pair".to_owned()),
        n => asked.push(format!("{n} pairs")),
    }
    asked
}

fn read_by(readers: &ContactReaders) -> Vec<String> {
    readers.iter().map(|(name, fields)| reads_of(name, fields.names())).collect()
}

/// What is computed of a pair for an effect other than `Contacts`, whose readers say.
fn fields_of(kind: EffectKind) -> &'static [&'static str] {
    match kind {
        EffectKind::Contacts => &[],
        EffectKind::Trigger => &["verdict"],
        EffectKind::Proximity => &["distance", "witnesses"],
        EffectKind::Response => &["solver contacts"],
        EffectKind::Continuous => &["time of impact"],
        EffectKind::Penetration => &["depth and way out"],
        EffectKind::Sound => &["impulse and slip"],
        EffectKind::Deformation => &["impulse and dent"],
        EffectKind::ForceFeedback => &["force and torque"],
        EffectKind::Tracking => &["depth and gap"],
    }
}

/// In what an effect ends: who reads what is computed for it.
fn effect_read_by(name: &str, table: &EffectTable, readers: &ContactReaders) -> Vec<String> {
    let Some(kind) = EffectKind::ALL.into_iter().find(|kind| kind.name() == name) else {
        return Vec::new();
    };
    let ends = match kind {
        EffectKind::Contacts => return read_by(readers),
        EffectKind::Trigger => "CollisionStart, CollisionEnd and TouchingBodies",
        EffectKind::Proximity => "ProximityReport",
        EffectKind::Response => "the solver",
        EffectKind::Continuous => "the solver, kinematic bodies and HeldBack",
        EffectKind::Penetration => "PenetrationReport",
        EffectKind::Sound => "SoundEvent and OngoingSounds",
        EffectKind::Deformation => "Dented and the body's mesh",
        EffectKind::ForceFeedback => "ForceFeedbackReport",
        EffectKind::Tracking => "Trigger",
    };
    let verb = if ends.contains(" and ") { "read" } else { "reads" };
    let mut all = vec![format!("{ends} {verb} {}", fields_of(kind).join(", "))];
    if kind == EffectKind::Trigger && table.has_plugin(EffectKind::Response) {
        all.push("CollisionStart reads point, normal, depth and impulse of the solver".to_owned());
    }
    all
}

/// "A reads b, c".
fn reads_of(reader: &str, fields: impl Iterator<Item = &'static str>) -> String {
    format!("{reader} reads {}", fields.collect::<Vec<_>>().join(", "))
}

/// What the pairs of a group have in common.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Asked {
    effects: Vec<String>,
    fields: Vec<&'static str>,
    read_by: Vec<String>,
    accuracy: Option<String>,
    detected_by: &'static str,
    why: String,
}

/// All pairs, grouped. One pair stands for all pairs of bodies that are alike; each pair that is
/// named is looked at by itself.
fn pairs(
    table: &EffectTable,
    bodies: &Bodies,
    readers: &ContactReaders,
    exact_solver: bool,
) -> Vec<PlannedPairs> {
    let mut groups: BTreeMap<Asked, (usize, Vec<Pair>)> = BTreeMap::new();
    let mut put = |pairs: &[Pair], count: usize| {
        let Some(&(a, b)) = pairs.first() else { return };
        let key = group_of(table, bodies, [a, b], readers, exact_solver);
        let (all, examples) = groups.entry(key).or_default();
        *all += count;
        examples.extend(pairs);
    };
    let is_present = |&(a, b): &Pair| table.body(a).is_some() && table.body(b).is_some();
    let named = table.named_pairs().chain(readers.named_pairs());
    let named: BTreeSet<Pair> = named.filter(is_present).collect();
    named.iter().for_each(|&pair| put(&[pair], 1));
    let alike = alike(table, bodies);
    let class_of: BTreeMap<BodyId, usize> = alike
        .iter()
        .enumerate()
        .flat_map(|(class, ids)| ids.iter().map(move |&id| (id, class)))
        .collect();
    let mut named_between: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for pair in &named {
        if let [Some(&i), Some(&j)] = [pair.0, pair.1].map(|id| class_of.get(&id)) {
            *named_between.entry((i.min(j), i.max(j))).or_default() += 1;
        }
    }
    for (i, first) in alike.iter().enumerate() {
        for (j, second) in alike.iter().enumerate().skip(i) {
            let unnamed = between(first, second).filter(|pair| !named.contains(pair));
            let examples: Vec<Pair> = unnamed.take(EXAMPLES).collect();
            let all = if i == j {
                first.len() * (first.len() - 1) / 2
            } else {
                first.len() * second.len()
            };
            put(&examples, all - named_between.get(&(i, j)).unwrap_or(&0));
        }
    }
    let mut pairs: Vec<PlannedPairs> = groups
        .into_iter()
        .map(|(asked, (count, mut examples))| {
            let Asked { effects, fields, read_by, accuracy, detected_by, why } = asked;
            examples.sort_unstable();
            let names = |(a, b): Pair| [a, b].map(|id| bodies.name(id).to_owned());
            let examples = examples.into_iter().take(EXAMPLES).map(names).collect();
            PlannedPairs { count, effects, fields, read_by, accuracy, detected_by, why, examples }
        })
        .collect();
    pairs.sort_by_key(|group| std::cmp::Reverse(group.count));
    pairs
}

/// Bodies that are alike, in groups. A body with effects of its own is alone, since its name stands
/// for them.
fn alike(table: &EffectTable, bodies: &Bodies) -> Vec<Vec<BodyId>> {
    let mut groups: Vec<Vec<BodyId>> = Vec::new();
    for id in table.bodies() {
        let is_like = |other: &BodyId| {
            table.of_body(id).is_empty()
                && table.body(id) == table.body(*other)
                && is_smooth(bodies, [id; 2]) == is_smooth(bodies, [*other; 2])
        };
        match groups.iter_mut().find(|group| is_like(&group[0])) {
            Some(group) => group.push(id),
            None => groups.push(vec![id]),
        }
    }
    groups
}

/// The pairs of one group with another one, or of a group in itself.
fn between<'a>(first: &'a [BodyId], second: &'a [BodyId]) -> impl Iterator<Item = Pair> + 'a {
    let is_same = std::ptr::eq(first, second);
    first.iter().enumerate().flat_map(move |(i, &a)| {
        let others = if is_same { &second[i + 1..] } else { second };
        others.iter().map(move |&b| (a.min(b), a.max(b)))
    })
}

/// Whether one of two bodies has other normals for the solver than its facets'.
fn is_smooth(bodies: &Bodies, pair: [BodyId; 2]) -> bool {
    let mut records = pair.into_iter().filter_map(|id| bodies.get(id));
    records.any(|record| record.normals != Normals::Flat)
}

/// An effect of a pair as a scene would name it.
fn with_parameters(
    kind: EffectKind,
    table: &EffectTable,
    [a, b]: [BodyId; 2],
    smooth: bool,
) -> String {
    let one = |name: &str, value: Option<f64>| value.map(|value| format!("{name}: {value}"));
    let parameters = match kind {
        EffectKind::Proximity => one("within", table.proximity(a, b)),
        EffectKind::Contacts => one("margin", table.contact_margin(a, b)),
        EffectKind::Tracking => one("tolerance", table.tracked(a, b)),
        EffectKind::Response => smooth.then(|| "normals: smooth".to_owned()),
        EffectKind::Sound => one("above", table.heard_above(a, b)),
        EffectKind::ForceFeedback => {
            let felt = [(a, b), (b, a)].map(|(body, other)| table.felt_stiffness(body, other));
            one("stiffness", felt.into_iter().flatten().reduce(f64::max))
        }
        EffectKind::Deformation => {
            let yields = [(a, b), (b, a)].into_iter().find_map(|(x, y)| table.yielding(x, y));
            yields.map(|d| format!("hardness: {}, radius: {}", d.hardness, d.radius))
        }
        EffectKind::Trigger | EffectKind::Penetration | EffectKind::Continuous => None,
    };
    parameters.map_or(kind.name().to_owned(), |all| format!("{}({all})", kind.name()))
}

fn group_of(
    table: &EffectTable,
    bodies: &Bodies,
    [a, b]: [BodyId; 2],
    readers: &ContactReaders,
    exact_solver: bool,
) -> Asked {
    if !table.may_meet(a, b) {
        return Asked {
            effects: Vec::new(),
            fields: Vec::new(),
            read_by: Vec::new(),
            accuracy: None,
            detected_by: "nobody",
            why: table.why_apart(a, b).to_owned(),
        };
    }
    let (mut effects, mut fields, mut reads) = (Vec::new(), Vec::new(), Vec::new());
    let mut reasons: Vec<String> = Vec::new();
    for kind in EffectKind::ALL {
        let asked: Vec<AskedBy> = table
            .of_pair(a, b)
            .filter(|(effect, _)| EffectKind::of(effect) == Some(kind))
            .map(|(_, by)| by)
            .collect();
        let is_unread = kind == EffectKind::Tracking && table.tracked(a, b).is_none();
        if asked.is_empty() || is_unread {
            continue;
        }
        if kind == EffectKind::Contacts {
            let all = readers.iter_of_pair(a, b);
            fields.extend(all.fold(ContactFields::NONE, |all, (_, read)| all.join(read)).names());
            reads.extend(
                readers.iter_of_pair(a, b).map(|(name, read)| reads_of(name, read.names())),
            );
        } else {
            fields.extend(fields_of(kind));
            reads.push(reads_of(kind.name(), fields_of(kind).iter().copied()));
        }
        let smooth = exact_solver && is_smooth(bodies, [a, b]);
        effects.push(with_parameters(kind, table, [a, b], smooth));
        let by = asked.iter().map(|by| match by {
            AskedBy::Scene => "the scene".to_owned(),
            AskedBy::Body(id) => format!("body '{}'", bodies.name(*id)),
            AskedBy::Pair => "the pair".to_owned(),
        });
        for by in by {
            let reason = format!("{by} asks for {}", kind.name());
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
    }
    let asks = |kind: EffectKind| table.asks(kind, a, b);
    let solver = asks(EffectKind::Response);
    // The world answers these, unless the solver's answer holds what they read.
    let [near, overlap] = [EffectKind::Proximity, EffectKind::Penetration].map(asks);
    let more = near || overlap || table.tracked(a, b).is_some();
    let reported = near || overlap || asks(EffectKind::Trigger) || asks(EffectKind::Contacts);
    let detected_by = match (solver, reported) {
        (true, true) if !exact_solver || more => "solver and world",
        (true, _) => "solver",
        (false, true) => "world",
        (false, false) => "nobody",
    };
    let why =
        if reasons.is_empty() { "nobody asks for anything".to_owned() } else { reasons.join("; ") };
    let accuracy = table.accuracy_of(a, b).map(|level| level.to_string());
    Asked { effects, fields, read_by: reads, accuracy, detected_by, why }
}
