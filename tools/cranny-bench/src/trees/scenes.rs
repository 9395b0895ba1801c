//! Pairs of bodies at poses where they nearly touch, or just do.

use cranny_exact::{DQuat, DVec3, Pose, RigidMap};
use cranny_geometry::Mesh;
use cranny_shapes::{Cup, GolfBall, IsoBolt, IsoNut, ShapeError, Sphere, Torus};

/// Two meshes and some poses of the second in the frame of the first.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) meshes: [Mesh; 2],
    pub(crate) poses: Vec<RigidMap>,
}

/// Small motions about a pose: turns of at most a hundredth, shifts of at most `reach`.
fn about(rotation: DQuat, translation: DVec3, reach: f64, count: usize) -> Vec<RigidMap> {
    let mut state = 1u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut map = |_| {
        let mut vector = |size: f64| size * DVec3::new(random(), random(), random());
        let (turn, shift) = (vector(0.01), vector(reach));
        let turned = DQuat::from_xyzw(turn.x, turn.y, turn.z, 1.0).normalize() * rotation;
        Pose { rotation: turned, translation: translation + shift }.world_from_body()
    };
    (0..count).map(&mut map).collect()
}

/// A quarter turn about x.
pub(crate) fn quarter() -> DQuat {
    DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt())
}

pub(crate) fn all(quick: bool) -> Result<Vec<Scene>, ShapeError> {
    let count = if quick { 2 } else { 12 };
    let detail = if quick { 1 } else { 2 };
    let torus =
        Torus { major_segments: 64 * detail, minor_segments: 32 * detail, ..Torus::default() };
    let ball = GolfBall { triangles: 10_000 * detail, ..GolfBall::default() }.build()?;
    let cup = Cup::default();
    let inner =
        Sphere { radius: 0.6 * (cup.radius - cup.wall), segments: 64 * detail, rings: 32 * detail };
    let bolt = IsoBolt { segments: 72 * detail, ..IsoBolt::default() };
    let nut = IsoNut { segments: 72 * detail, ..IsoNut::default() };
    let cup_mesh = cup.build()?;
    let floor = cup_mesh.bounds().min.z + cup.floor;
    let landed = DVec3::new(0.0, 0.0, floor + inner.radius);
    let link = DVec3::X * 2.0 * torus.minor_radius;
    let apart = DVec3::new(0.6, 0.0, 0.8) * 1.998 * GolfBall::default().radius;
    let torus = torus.build()?;
    Ok(vec![
        Scene {
            name: "linked tori",
            poses: about(quarter(), link, 0.01, count),
            meshes: [torus.clone(), torus],
        },
        Scene {
            name: "golf balls",
            poses: about(quarter(), apart, 0.001, count),
            meshes: [ball.clone(), ball],
        },
        Scene {
            name: "nut on bolt",
            poses: about(DQuat::IDENTITY, DVec3::Z * 20.0, 0.01, count)
                .into_iter()
                .map(|map| RigidMap { linear: RigidMap::IDENTITY.linear, ..map })
                .collect(),
            meshes: [bolt.build()?, nut.build()?],
        },
        Scene {
            name: "ball in cup",
            poses: about(quarter(), landed, 0.002, count),
            meshes: [cup_mesh, inner.build()?],
        },
    ])
}
