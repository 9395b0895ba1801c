//! Exact, incremental collision detection for bodies that are not convex.
//!
//! Rings that hang in rings, hooks, cups, threads, teeth: Cranny answers on the triangles that a
//! body really has, holes and hollows included. Nothing is replaced by a convex hull or by convex
//! pieces, and no epsilon decides what meets what.
//!
//! This crate is the façade: it re-exports the workspace's crates under one roof and adds nothing
//! but a [`prelude`]. What follows is a tour in five stops; each crate's own page has its promises.
//!
//! # 1. A body: mesh to model
//!
//! A [`geometry::Mesh`] comes from a file or a generator. [`geometry::Model::build`] prepares it
//! once (weld, adjacency, hull, trees, mass) and reports what is unusual. A model is immutable,
//! cheap to clone, and can be saved and loaded.
//!
//! ```
//! # #[cfg(feature = "shapes")] {
//! use cranny::prelude::*;
//! use cranny::shapes::ChainLink;
//!
//! let (link, report) = Model::build(ChainLink::default().build()?, &BuildOptions::default())?;
//! assert!(report.closed && report.is_sound());
//! assert!(link.mass_properties().is_some_and(|mass| mass.volume > 0.0));
//! let loaded = Model::decode(&link.encode())?;
//! assert_eq!(loaded.digest(), link.digest());
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # 2. A pair: the query
//!
//! [`narrow_phase::query`] answers about two placed models. The [`Demand`](narrow_phase::Demand)
//! limits the work: a verdict, a distance, contacts for a solver, or regions. A
//! [`PairMemory`](narrow_phase::PairMemory) belongs to the caller and makes the next query of a
//! pair that moved little cheap; it changes no answer.
//!
//! Two links of a chain, first loosely interlinked, then pulled taut:
//!
//! ```
//! # #[cfg(feature = "shapes")] {
//! use cranny::prelude::*;
//! use cranny::shapes::ChainLink;
//!
//! let (link, _) = Model::build(ChainLink::default().build()?, &BuildOptions::default())?;
//! // The long axis of a link is x; its neighbour along the chain is turned about it by 90 degrees.
//! let quarter_turn = DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt());
//! let first = Placed { model: &link, pose: Pose::IDENTITY };
//! let second = |x: f64| {
//!     let pose = Pose { rotation: quarter_turn, translation: DVec3::new(x, 0.0, 0.0) };
//!     Placed { model: &link, pose }
//! };
//! let mut memory = PairMemory::default();
//!
//! // Interlinked, and nowhere in touch: their convex hulls overlap, the links do not.
//! let apart = Query::of(Demand::Distance { below: None });
//! let answer = query(first, second(1.5), &apart, &mut memory)?;
//! assert_eq!((answer.surface, answer.solid), (Surface::None, false));
//! assert!(answer.distance.is_some_and(|d| d > 0.1));
//!
//! // Pulled too far: one region of contact, with the least translation that parts it.
//! let everything = Query::of(Demand::Regions { margin: 0.0 });
//! let answer = query(first, second(1.75), &everything, &mut memory)?;
//! assert_eq!((answer.surface, answer.solid), (Surface::Cross, true));
//! let [region] = &answer.regions[..] else { panic!("one bend lies in the other") };
//! assert!(region.depth.is_some_and(|d| (0.0..0.06).contains(&d)));
//! assert!(region.curves.iter().all(|curve| curve.closed));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Above it: [`estimate::estimate`] answers for less work, certified all the same;
//! [`impact::time_of_impact`] finds when two moving bodies first meet; [`primitives`] has contacts
//! and distances of balls, cylinders, half-spaces and the like with a model.
//!
//! # 3. Many bodies: the world
//!
//! [`world::World`] keeps bodies, and from step to step the pairs with boxes that meet
//! ([`broad_phase`]). Effects set each pair's demand; events say what began and what ended.
//!
//! ```
//! # #[cfg(feature = "shapes")] {
//! use cranny::prelude::*;
//! use cranny::shapes::{Sphere, Torus};
//! use cranny::world::description::{BodyKind, Effect};
//! use cranny::world::{BodySpec, PairEventKind};
//!
//! let model = |mesh| Model::build(mesh, &BuildOptions::default()).map(|(model, _)| model);
//! let ring = model(Torus { major_radius: 1.0, minor_radius: 0.2, ..Torus::default() }.build()?)?;
//! let ball = model(Sphere { radius: 0.5, ..Sphere::default() }.build()?)?;
//!
//! let mut world = World::new();
//! world.set_scene_effects(&[Effect::TRIGGER])?;
//! world.insert(BodySpec { kind: BodyKind::Fixed, ..BodySpec::new("ring", ring) })?;
//! let ball = world.insert(BodySpec::new("ball", ball))?; // in the hole, where nothing touches
//! assert!(world.step()?.events.is_empty());
//!
//! world.set_pose(ball, Pose::at(DVec3::new(0.5, 0.0, 0.0)))?; // into the tube
//! assert_eq!(world.step()?.events[0].kind, PairEventKind::Began);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # 4. Bodies that push: rapier
//!
//! With the feature `rapier`, `cranny::rapier::dispatcher()` and `MeshShape` put the detector into
//! a rapier world, and `cranny::rapier::Simulation` is such a world with the settings that exact
//! contacts need. `examples/rapier_chain.rs` drops three links of a chain into each other.
//!
//! # 5. Scenes, files, pictures
//!
//! `cranny::scene` reads scenes, meshes and robots from files; `cranny::record` writes MCAP;
//! `cranny::render` draws without a window; `cranny::ecs` composes all this in a bevy app, one
//! plugin for each effect. `examples/bevy_app.rs` is an app with systems of its own. The command
//! `cranny` (`tools/cranny-cli`) runs, compares, inspects and explains scenes and meshes.
//!
//! # Features
//!
//! | feature | brings | default |
//! |---|---|---|
//! | `shapes` | `cranny::shapes`: generators of closed solids | yes |
//! | `scene` | `cranny::scene`: scene files, mesh files, URDF robots (and `shapes`) | |
//! | `rapier` | `cranny::rapier`: the detector inside rapier3d | |
//! | `snapshot` | rapier's worlds to bytes and back (and `rapier`) | |
//! | `record` | `cranny::record`: MCAP recordings | |
//! | `render` | `cranny::render`: pictures without a window | |
//! | `ecs` | `cranny::ecs`: bevy plugins; composes those of the above that are turned on | |
//!
//! Exact, geometry, concavity, the two phases, primitives and the world are always there. They open
//! no files, read no clock, hold no globals and touch no GPU.
//!
//! # What exact means, and what it does not
//!
//! Verdicts (whether the surfaces touch or cross, whether the solids meet, whether one is inside
//! the other) are exact for the vertices as stored and the poses as given. Lengths, points, areas
//! and depths are `f64` with rounding. Meshes that are not closed are answered as surfaces. What a
//! pair's memory holds changes no answer, and neither does the order of A and B.

pub use cranny_broad_phase as broad_phase;
pub use cranny_concavity as concavity;
pub use cranny_estimate as estimate;
pub use cranny_exact as exact;
pub use cranny_geometry as geometry;
pub use cranny_impact as impact;
pub use cranny_narrow_phase as narrow_phase;
pub use cranny_primitives as primitives;
pub use cranny_world as world;

#[cfg(feature = "ecs")]
pub use cranny_ecs as ecs;
#[cfg(feature = "rapier")]
pub use cranny_rapier as rapier;
#[cfg(feature = "record")]
pub use cranny_record as record;
#[cfg(feature = "render")]
pub use cranny_render as render;
#[cfg(feature = "scene")]
pub use cranny_scene as scene;
#[cfg(feature = "shapes")]
pub use cranny_shapes as shapes;

/// What most programs that ask about pairs want.
///
/// Names that several crates use for things of their own (`BodySpec`, `BodyKind`, `Detector`) are
/// left to their crates. rapier's prelude has a `Pose` of its own: beside that one, name which is
/// meant (`use cranny::exact::Pose;`).
pub mod prelude {
    pub use cranny_exact::{Aabb, DQuat, DVec3, Pose};
    pub use cranny_geometry::{BuildOptions, Mesh, Model};
    pub use cranny_narrow_phase::{
        Answer, Contact, Containment, Demand, PairMemory, Placed, Query, Region, Surface, query,
    };
    pub use cranny_world::World;
}

// The page that most people see first must compile as well.
#[cfg(all(doctest, feature = "shapes"))]
#[doc = include_str!("../README.md")]
struct Readme;
