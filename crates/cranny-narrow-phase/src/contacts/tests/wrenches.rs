//! What few contacts can press and twist, beside what all can.
//!
//! A contact presses along its normal, and so twists about any centre. Of forces that are 1 in all,
//! what a set of contacts can do along a direction (u, v) of forces and torques is the greatest u ·
//! n + v · (p − c) × n / L: the support function of its wrenches, with L the lesser body's radius,
//! so that a torque counts as the force at its rim.

use crate::answer::Counters;
use std::collections::BTreeSet;

use super::super::*;
use crate::near::near_regions;
use crate::query::Placed;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::BuildOptions;
use cranny_shapes::{Cuboid, Cup, Cylinder, Floor, IsoBolt, IsoNut, Shape, Torus};
use cranny_testkit::Rng;

/// How many directions are compared.
const DIRECTIONS: usize = 400;

fn shape(shape: impl Into<Shape>) -> Model {
    Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
}

/// Two bodies near each other, and how far the second slides and turns in a unit of time.
struct Scene {
    name: &'static str,
    models: [Model; 2],
    pose: Pose,
    slide: DVec3,
    turn: DVec3,
    margin: f64,
}

fn scenes() -> Vec<Scene> {
    let scene = |name, models, at: [f64; 3], slide: [f64; 3], turn: [f64; 3], margin| Scene {
        name,
        models,
        pose: Pose::at(DVec3::from_array(at)),
        slide: DVec3::from_array(slide),
        turn: DVec3::from_array(turn),
        margin,
    };
    let cup = || shape(Cup { radius: 0.5, height: 0.6, segments: 32, ..Cup::default() });
    let bolt = IsoBolt { segments: 48, length: Some(24.0), ..IsoBolt::default() };
    let nut = IsoNut { segments: 48, ..IsoNut::default() };
    let torus = || shape(Torus { major_segments: 48, minor_segments: 12, ..Torus::default() });
    vec![
        scene(
            "box on slab",
            [
                shape(Floor { size: [4.0, 4.0, 0.5], squares: [8, 8] }),
                shape(Cuboid { size: [1.0, 0.7, 0.4] }),
            ],
            [0.11, 0.07, 0.203],
            [1.0, 0.37, 0.0],
            [0.0, 0.0, 0.4],
            0.02,
        ),
        scene(
            "nut on bolt",
            [shape(bolt), shape(nut)],
            [0.02, 0.01, 14.0],
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            0.12,
        ),
        scene(
            "cup in cup",
            [cup(), shape(Cup { radius: 0.38, height: 0.6, segments: 32, ..Cup::default() })],
            [0.005, 0.002, 0.105],
            [0.1, 0.02, 0.0],
            [0.0, 0.0, 1.0],
            0.02,
        ),
        scene(
            "peg in hole",
            [
                shape(Cup { radius: 12.0, height: 20.0, wall: 6.95, floor: 5.0, segments: 96 }),
                shape(Cylinder { radius: 5.0, height: 25.0, chamfer: 0.5, segments: 96 }),
            ],
            [0.01, 0.0, 17.55],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, 0.1],
            0.1,
        ),
        scene(
            "torus in torus",
            [torus(), torus()],
            [0.0, 0.0, 0.0],
            [-0.3, 0.0, 0.0],
            [0.0, 0.0, 0.5],
            0.05,
        ),
    ]
}

impl Scene {
    /// After a time.
    fn at(&self, time: f64) -> Pose {
        let start = match self.name {
            // Hung into the first, a little above touching at the inner rim.
            "torus in torus" => Pose {
                rotation: DQuat::from_scaled_axis(DVec3::X * std::f64::consts::FRAC_PI_2),
                translation: DVec3::new(1.59, 0.0, 0.0),
            },
            _ => self.pose,
        };
        let turn = DQuat::from_scaled_axis(self.turn * time);
        Pose { rotation: turn * start.rotation, translation: start.translation + self.slide * time }
    }

    fn sets(&self, pose: Pose, memory: &mut [(Coherent, ContactMemory); 3]) -> Sets {
        let [a, b] = &self.models;
        let (a, b) = (Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose });
        let mut counters = Counters::default();
        let pair = Pair::of_accepted(a, b);
        let margin = self.margin;
        for (coherent, _) in memory.iter_mut() {
            coherent.begin(&pair);
        }
        let [m1, m2, m3] = memory.each_mut().map(|(coherent, kept)| (coherent, kept));
        let all = across_gaps(&pair, margin, m1, &mut counters);
        let near = near_patches(&pair, &Wanted::within(margin), m2, &mut counters);
        assert!(near.meeting.is_empty(), "{}: they overlap", self.name);
        let regions = near_regions(&pair, margin, m3, &mut counters);
        for (coherent, _) in memory.iter_mut() {
            coherent.end(&pair);
        }
        let center = all.iter().map(|c| c.point_a).sum::<DVec3>() / all.len() as f64;
        let of_patches = near.contacts.iter().map(|c| patches_of(&pair, c.id)).collect();
        Sets {
            of_patches,
            all,
            patches: near.contacts,
            regions: regions.into_iter().flat_map(|region| reduce(region.contacts)).collect(),
            center,
            length: self.models[0].radius().min(self.models[1].radius()),
        }
    }
}

struct Sets {
    all: Vec<Contact>,
    /// Which pairs of patches have contacts.
    of_patches: BTreeSet<[PatchId; 2]>,
    /// Of each pair of patches.
    patches: Vec<Contact>,
    /// Of each region.
    regions: Vec<Contact>,
    center: DVec3,
    length: f64,
}

impl Sets {
    fn support(&self, contacts: &[Contact], [force, torque]: [DVec3; 2], center: DVec3) -> f64 {
        let of = |c: &Contact| {
            force.dot(c.normal) + torque.dot((c.point_a - center).cross(c.normal)) / self.length
        };
        contacts.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The most that a set loses against all, over directions.
    fn lost(&self, few: &[Contact], directions: &[[DVec3; 2]]) -> f64 {
        let at = |contacts, way| self.support(contacts, way, self.center);
        directions.iter().map(|&way| at(&self.all, way) - at(few, way)).fold(0.0, f64::max)
    }
}

/// Unit vectors of six components.
fn directions() -> Vec<[DVec3; 2]> {
    let mut rng = Rng::new(5);
    let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
    (0..DIRECTIONS)
        .map(|_| {
            let (u, v) = (vector(), vector());
            let length = (u.length_squared() + v.length_squared()).sqrt();
            [u / length, v / length]
        })
        .collect()
}

/// What a slide through a scene showed, of contacts by patches and by regions.
#[derive(Debug, Default)]
struct Seen {
    /// The most that either set lost against all.
    lost: [f64; 2],
    /// The most that what either set can do along a direction changed by from one step to the next,
    /// while all contacts, or pairs of patches that have any, were those of the step before.
    quiet: [f64; 2],
    /// Quiet steps.
    steps: [usize; 2],
    /// How many were there, and of these in the next step had gone: pairs of patches; contacts of
    /// regions that all still held.
    stayed: [usize; 2],
    gone: [usize; 2],
    /// All contacts at most, and those of either set.
    most: [usize; 3],
}

const STEPS: u32 = 100;

impl Seen {
    fn of(scene: &Scene) -> Self {
        let directions = directions();
        let mut memory = <[(Coherent, ContactMemory); 3]>::default();
        let mut seen = Self::default();
        let mut before: Option<Sets> = None;
        for k in 0..STEPS {
            // Steps of 1/4000: much less than a patch is long.
            let sets = scene.sets(scene.at(0.025 * f64::from(k) / f64::from(STEPS)), &mut memory);
            let lost = [&sets.patches, &sets.regions].map(|few| sets.lost(few, &directions));
            let most = [&sets.all, &sets.patches, &sets.regions].map(Vec::len);
            seen.lost = [0, 1].map(|i| seen.lost[i].max(lost[i]));
            seen.most = [0, 1, 2].map(|i| seen.most[i].max(most[i]));
            if let Some(before) = &before {
                seen.step(before, &sets, &directions);
            }
            before = Some(sets);
        }
        seen
    }

    fn step(&mut self, before: &Sets, after: &Sets, directions: &[[DVec3; 2]]) {
        let ids = |c: &[Contact]| c.iter().map(|c| c.id).collect::<BTreeSet<_>>();
        let all = [ids(&before.all), ids(&after.all)];
        let kept = [ids(&before.regions), ids(&after.regions)];
        self.stayed[0] += before.of_patches.len();
        self.gone[0] += before.of_patches.difference(&after.of_patches).count();
        self.stayed[1] += kept[0].len();
        self.gone[1] += kept[0].difference(&kept[1]).filter(|id| all[1].contains(id)).count();
        let quiet = [before.of_patches == after.of_patches, all[0] == all[1]];
        let sets = [[&before.patches, &after.patches], [&before.regions, &after.regions]];
        for i in (0..2).filter(|&i| quiet[i]) {
            let at = |set: usize, way| after.support(sets[i][set], way, after.center);
            let changes = directions.iter().map(|&way| (at(1, way) - at(0, way)).abs());
            self.quiet[i] = self.quiet[i].max(changes.fold(0.0, f64::max));
            self.steps[i] += 1;
        }
    }
}

/// What patches may lose: of each pair of patches, which are up to a quarter of a body long, the
/// nearest contact stays, and two tubes that cross have two contacts.
const LOST_BY_PATCHES: f64 = 0.35;

/// What regions may lose: of one direction, contacts that bear alike lose up to 0.21 of their
/// extent (`reduce`), which is a part of the lesser body's radius, along torques, which are a part
/// of a direction.
const LOST_BY_REGIONS: f64 = 0.1;

/// By how much what either can do along a direction may change in a step in which no region
/// changes.
const QUIET: [f64; 2] = [0.15, 0.05];

#[test]
fn few_contacts_do_what_all_can_and_stay_the_same_as_bodies_slide() {
    for scene in scenes() {
        let seen = Seen::of(&scene);
        let shown = format!("{}: {seen:.4?}", scene.name);
        assert!(seen.lost[0] < LOST_BY_PATCHES && seen.lost[1] < LOST_BY_REGIONS, "{shown}");
        assert!((0..2).all(|i| seen.steps[i] > 10 && seen.quiet[i] < QUIET[i]), "{shown}");
        // Of pairs of patches one in 200 goes from step to step; of contacts that regions keep, one
        // in 25.
        assert!(200 * seen.gone[0] < seen.stayed[0], "{shown}");
        assert!(25 * seen.gone[1] < seen.stayed[1], "{shown}");
        assert!(seen.most[0] >= seen.most[1].max(seen.most[2]) && seen.most[0] >= 6, "{shown}");
    }
}
