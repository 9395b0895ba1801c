//! Solids with exact dyadic coordinates as models, and how they are queried.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, query};
use cranny_shapes::Cup;
pub(crate) use cranny_testkit::bodies::{
    angle, block, block_without, cells, channel, cuboid, grooved, inverted, octahedron, prism,
    quarter_turns, rake, tetrahedron,
};
pub(crate) use cranny_testkit::{model, shape};

pub(crate) fn at(model: &Model, x: f64, y: f64, z: f64) -> Placed<'_> {
    Placed { model, pose: Pose::at(DVec3::new(x, y, z)) }
}

/// Asks cold.
pub(crate) fn ask(a: Placed, b: Placed, demand: Demand) -> Answer {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

/// Everything that the verdicts are tried on.
pub(crate) fn dyadic_solids() -> Vec<(&'static str, Model)> {
    let void = inverted(&cuboid([1.0; 3], [2.0; 3]));
    let cup = Cup { radius: 2.0, height: 2.0, wall: 0.5, floor: 0.5, segments: 4 };
    let meshes = [
        ("unit", cuboid([0.0; 3], [1.0; 3])),
        ("bar", cuboid([0.0; 3], [3.0, 1.0, 1.0])),
        ("large", cuboid([0.0; 3], [4.0; 3])),
        ("slab", cuboid([0.0; 3], [4.0, 4.0, 1.0])),
        ("cells", cells(&block([2, 2, 2]))),
        ("angle", angle()),
        ("angle of cells", cells(&[[0, 0, 0], [1, 0, 0], [0, 1, 0]])),
        ("channel", channel()),
        ("rake", rake()),
        ("grooved", grooved()),
        ("ring", block_without([3, 3, 1], &[[1, 1, 0]])),
        ("pot", block_without([3, 3, 2], &[[1, 1, 1]])),
        ("joined at an edge", cells(&[[0, 0, 0], [1, 1, 0]])),
        ("hollow", cuboid([0.0; 3], [3.0; 3]).joined(&void)),
        ("two", cuboid([0.0; 3], [1.0; 3]).joined(&cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]))),
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("cup", cup.build().unwrap()),
    ];
    let solids: Vec<_> = meshes.into_iter().map(|(name, mesh)| (name, model(mesh))).collect();
    for (name, solid) in &solids {
        assert!(solid.is_closed(), "{name}");
        let dyadic = |p: &DVec3| (64.0 * *p) == (64.0 * *p).round();
        assert!(solid.mesh().vertices().iter().all(dyadic), "{name}");
    }
    solids
}
