//! A rapier world as an app has it, z up, with our dispatcher; and the bodies that the tests use.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, MassSource, MeshShape, Normals, StepHooks, dispatcher,
};
use cranny_shapes::{Cuboid, Shape};
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{
    ColliderBuilder, ContactManifold, NarrowPhase, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle,
};

pub(crate) fn built(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).expect("a mesh of the tests").0
}

pub(crate) fn model(shape: impl Into<Shape>) -> Model {
    built(shape.into().build().expect("parameters of the tests"))
}

pub(crate) fn cuboid(x: f64, y: f64, z: f64) -> Model {
    model(Cuboid { size: [x, y, z] })
}

pub(crate) fn ours(model: &Model) -> SharedShape {
    MeshShape::shared(model, 0).expect("parry takes it")
}

/// A closed slab with its top at z = 0, its top tessellated into `n` by `n` squares of unequal
/// diagonals.
pub(crate) fn tessellated_slab(n: u32, half: f64) -> Model {
    let at = |i: u32| -half + 2.0 * half * f64::from(i) / f64::from(n);
    let top = |i: u32, j: u32| i * (n + 1) + j;
    let mut vertices: Vec<DVec3> =
        (0..=n).flat_map(|i| (0..=n).map(move |j| DVec3::new(at(i), at(j), 0.0))).collect();
    let mut faces = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [top(i, j), top(i + 1, j), top(i + 1, j + 1), top(i, j + 1)];
        if (i + j) % 2 == 0 {
            faces.extend([[a, b, c], [a, c, d]]);
        } else {
            faces.extend([[a, b, d], [b, c, d]]);
        }
    }
    // Sides and bottom: a fan from one point far below to the rim.
    let apex = vertices.len() as u32;
    vertices.push(DVec3::new(0.0, 0.0, -half));
    let rim: Vec<u32> = (0..n)
        .map(|i| top(i, 0))
        .chain((0..n).map(|j| top(n, j)))
        .chain((0..n).map(|i| top(n - i, n)))
        .chain((0..n).map(|j| top(0, n - j)))
        .collect();
    for (k, &v) in rim.iter().enumerate() {
        faces.push([rim[(k + 1) % rim.len()], v, apex]);
    }
    built(Mesh::new(vertices, faces).expect("indices are in range"))
}

/// An open, flat square of two triangles at z = 0, looking up.
pub(crate) fn sheet(half: f64) -> Model {
    let corner = |x: f64, y: f64| DVec3::new(x * half, y * half, 0.0);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    built(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("indices are in range"))
}

/// A dynamic body of density 1 at rest.
pub(crate) fn spec(model: &Model, kind: BodyKind, at: DVec3) -> BodySpec {
    BodySpec {
        shape: model.into(),
        kind,
        pose: Pose::at(at),
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::ZERO,
        mass: MassSource::Density(1.0),
        friction: 0.5,
        restitution: 0.0,
        normals: Normals::Flat,
        groups: 1,
    }
}

/// Two bodies that do not respond to each other, the lower number first.
pub(crate) struct Apart(pub(crate) BodyIndex, pub(crate) BodyIndex);

impl StepHooks for Apart {
    fn responds(&self, a: BodyIndex, b: BodyIndex) -> bool {
        (a, b) != (self.0, self.1)
    }
}

/// rapier at its defaults but for gravity along −z and our dispatcher.
pub(crate) struct World(pub(crate) PhysicsWorld);

impl World {
    pub(crate) fn new() -> Self {
        Self(PhysicsWorld {
            gravity: Vector::new(0.0, 0.0, -9.81),
            narrow_phase: NarrowPhase::with_query_dispatcher(dispatcher()),
            ..PhysicsWorld::default()
        })
    }

    pub(crate) fn fixed(&mut self, shape: &SharedShape, pose: RapierPose) -> RigidBodyHandle {
        self.insert(RigidBodyBuilder::fixed().pose(pose), shape)
    }

    pub(crate) fn dynamic(&mut self, shape: &SharedShape, pose: RapierPose) -> RigidBodyHandle {
        self.insert(RigidBodyBuilder::dynamic().pose(pose), shape)
    }

    /// Inserts a fixed lower body and a moving upper one, in either order: rapier's order of a pair
    /// follows it. Returns the upper one.
    pub(crate) fn one_on_another(
        &mut self,
        lower: (&SharedShape, RapierPose),
        upper: (&SharedShape, RapierPose),
        upper_first: bool,
    ) -> RigidBodyHandle {
        if upper_first {
            let body = self.dynamic(upper.0, upper.1);
            self.fixed(lower.0, lower.1);
            body
        } else {
            self.fixed(lower.0, lower.1);
            self.dynamic(upper.0, upper.1)
        }
    }

    pub(crate) fn insert(
        &mut self,
        body: RigidBodyBuilder,
        shape: &SharedShape,
    ) -> RigidBodyHandle {
        self.0.insert(body, ColliderBuilder::new(shape.clone())).0
    }

    pub(crate) fn run(&mut self, steps: usize) {
        for _ in 0..steps {
            self.0.step();
        }
    }

    pub(crate) fn at(&self, body: RigidBodyHandle) -> Vector {
        let at = self.0.bodies[body].translation();
        assert!(at.is_finite(), "the body is at {at}");
        at
    }

    pub(crate) fn manifolds(&self) -> impl Iterator<Item = &ContactManifold> {
        self.0.narrow_phase.contact_pairs().flat_map(|pair| pair.manifolds())
    }
}

pub(crate) fn up(z: Real) -> RapierPose {
    RapierPose::translation(0.0, 0.0, z)
}
