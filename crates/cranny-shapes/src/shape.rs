//! All generators under one name.

use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    Boxes, CPrism, CarBody, ChainLink, Chair, Comb, Cuboid, Cup, Cylinder, Floor, Gear, GolfBall,
    Hook, IsoBolt, IsoNut, LPrism, Lamp, Lathe, LockPlug, NestedShells, Propeller, Pyramid,
    PyramidInCavity, ShapeError, Shelf, Sphere, SpokedWheel, Stairs, SubmarineHull, Table,
    Tetrahedron, Torus, Tub, UPrism, Wall,
};

macro_rules! shapes {
    ($($name:ident: $what:literal),* $(,)?) => {
        /// Any generator, as a scene file names it: `IsoNut(diameter: 16, pitch: 2)`. In RON this
        /// reads with the extension `unwrap_variant_newtypes`; without it, parentheses are doubled.
        /// Parameters that are left out take their defaults; unknown ones are refused.
        #[derive(Clone, Debug, PartialEq, Deserialize)]
        #[non_exhaustive]
        pub enum Shape {
            $(#[doc = $what] $name($name),)*
        }

        impl Shape {
            /// Every generator with its default parameters.
            #[must_use]
            pub fn defaults() -> Vec<Self> {
                vec![$(Self::$name($name::default())),*]
            }

            /// The generator's name in scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => stringify!($name),)*
                }
            }

            /// The mesh, in the frame that the generator documents.
            ///
            /// # Errors
            ///
            /// Those of the generator.
            pub fn build(&self) -> Result<Mesh, ShapeError> {
                match self {
                    $(Self::$name(shape) => shape.build(),)*
                }
            }
        }

        $(impl From<$name> for Shape {
            fn from(shape: $name) -> Self {
                Self::$name(shape)
            }
        })*
    };
}

shapes! {
    Cuboid: "A box.",
    Sphere: "A sphere of meridians and parallels.",
    Torus: "A torus.",
    IsoBolt: "A metric bolt.",
    IsoNut: "The nut to a metric bolt.",
    GolfBall: "A geodesic sphere, with dimples or without.",
    Cup: "A cup without a handle.",
    Gear: "A spur gear.",
    LPrism: "A prism over an L.",
    UPrism: "A prism over a U.",
    CPrism: "A prism over a C.",
    ChainLink: "A link of a chain.",
    NestedShells: "Concentric shells on one floor.",
    Pyramid: "A square pyramid.",
    PyramidInCavity: "A block with a well, in which a pyramid stands.",
    Comb: "A bar with prongs.",
    Tetrahedron: "A regular tetrahedron.",
    Cylinder: "A cylinder, its rims chamfered or not.",
    Floor: "A slab cut into squares.",
    Hook: "A hook.",
    Stairs: "A flight of stairs.",
    LockPlug: "A lock's plug, with a keyway for an L.",
    Boxes: "Boxes put together, less others.",
    Lathe: "A profile turned about an axis.",
    Wall: "A wall with doorways and windows.",
    Chair: "A chair.",
    Table: "A table.",
    Shelf: "A shelf of compartments.",
    Tub: "A bathtub, a sink or a tray.",
    Lamp: "A standing lamp.",
    CarBody: "The shell of an automobile.",
    SpokedWheel: "A wheel with spokes.",
    Propeller: "A ship's propeller.",
    SubmarineHull: "A submarine's hull.",
}
