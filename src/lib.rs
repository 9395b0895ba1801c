//! Exact, incremental collision detection for bodies that are not convex.
//!
//! Rings that hang in rings, hooks, cups, threads, teeth: Cranny answers on the triangles that a body
//! really has, holes and hollows included. Nothing is replaced by a convex hull or by convex pieces,
//! and no epsilon decides what meets what.
//!
//! This crate is the façade: it re-exports the workspace's crates under one roof and adds nothing but
//! a [`prelude`].
//!
//! # A tour
//!
//! 1. A [`geometry::Mesh`] is what a file or a generator gives; [`geometry::Model::build`] prepares it
//!    once (weld, adjacency, hull, tree, mass) and reports what is unusual about it.
//! 2. [`narrow_phase::query`] asks about one pair of placed models. The
//!    [`Demand`](narrow_phase::Demand) says how much is asked, and no more than that is computed.
//! 3. [`world::World`] keeps bodies and the pairs whose boxes meet from step to step
//!    ([`broad_phase`]), asks each pair what its effects need, and tells what began and what ended.
//! 4. `cranny::rapier` makes it the narrow phase of a rapier world, `cranny::record` writes what
//!    happened, `cranny::render` draws it, `cranny::scene` reads scenes, meshes and robots from files,
//!    and `cranny::ecs` composes all this, one plugin an effect. Each is behind a feature.
//!
//! Two links of a chain, first loosely interlinked, then pulled taut:
//!
//! ```
//! # #[cfg(feature = "shapes")] {
//! use cranny::prelude::*;
//! use cranny::shapes::ChainLink;
//!
//! let (link, report) = Model::build(ChainLink::default().build()?, &BuildOptions::default())?;
//! assert!(report.closed && report.is_sound());
//!
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
//! # Features
//!
//! | feature | brings | default |
//! |---|---|---|
//! | `shapes` | `cranny::shapes`: generators of closed solids | yes |
//! | `scene` | `cranny::scene`: scene files, seven mesh formats, URDF robots (and `shapes`) | |
//! | `rapier` | `cranny::rapier`: the detector inside rapier3d | |
//! | `record` | `cranny::record`: MCAP recordings | |
//! | `render` | `cranny::render`: pictures without a window | |
//! | `ecs` | `cranny::ecs`: bevy plugins; composes those of the above that are turned on | |
//!
//! Exact, geometry, concavity, the two phases and the world are always there. They open no files, read no clock,
//! hold no globals and touch no GPU.
//!
//! # What exact means, and what it does not
//!
//! Verdicts (do the surfaces touch or cross, do the solids meet, is one inside the other) are exact
//! for the vertices as stored and the poses as given. Lengths, points, areas and depths are `f64` with
//! rounding. Meshes that are not closed are answered as surfaces. Queries are cold so far: what a
//! pair's memory will save between frames is yet to come.

pub use cranny_broad_phase as broad_phase;
pub use cranny_concavity as concavity;
pub use cranny_exact as exact;
pub use cranny_geometry as geometry;
pub use cranny_narrow_phase as narrow_phase;
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
/// Names that several crates use for things of their own (`BodySpec`, `BodyKind`, `Detector`) are left
/// to their crates. rapier's prelude has a `Pose` of its own: beside that one, name which is meant
/// (`use cranny::exact::Pose;`).
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
