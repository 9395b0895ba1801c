//! Cores of a body: what is left of it when its surface is moved inwards.
//!
//! A body that is held where its surface meets another one is held where it slides, rolls and rests
//! as well. So what is swept is a core: it is free of whatever the body merely touches, and where
//! the core passes through nothing, the body passes through nothing
//! ([`let_until`](crate::let_until)).
//!
//! A body has a core for each of a series of depths, each twice the one before. That of a mesh has
//! the mesh's faces, their vertices moved so that all faces around lie as deep: about half-way
//! through where the body is thin, never beyond. That of a primitive is a smaller one.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model, VertexId};

use crate::primitive::{Ball, Capsule, Cone, Cylinder, Primitive};
use crate::ray::cast_ray;
use crate::shape::BodyShape;

/// Number of cores: the shallowest is a millionth of the deepest. More: rounding of poses is deeper
/// than that; fewer: what touches sinks in visibly before it is held.
pub(crate) const LEVELS: usize = 20;

/// The depth of the deepest core, as a share of the body's thickness. Larger: a plate has none;
/// smaller: what a solver fails to lead out is held no longer, and passes.
const DEEPEST: f64 = 0.4;

/// The same where a body is thinner than it is elsewhere, as a share of the way through it.
const THROUGH: f64 = 0.4;

/// How far a vertex is moved at most, in multiples of the depth. Larger: the core of a needle ends
/// far below its tip; smaller: it lies nearly in its sides.
const FARTHEST: f64 = 4.0;

/// Cosine of the angle (0.8 degrees) within which faces at a vertex are of one side. A larger
/// angle: of a finely cut edge one side is forgotten; a smaller one: rounding makes two of one.
const ONE_SIDE: f64 = 0.9999;

/// From how far beneath a vertex the way through the body is measured, as a share of its radius.
/// Smaller: rays meet the vertex's own faces, by rounding; larger: thin walls are missed.
const BENEATH: f64 = 1e-6;

/// The cores of one shape, each made when it is first read. Clones share them.
#[derive(Clone, Debug)]
pub struct Cores(Arc<Series>);

#[derive(Debug)]
struct Series {
    shape: BodyShape,
    thickness: f64,
    cores: [OnceLock<Option<BodyShape>>; LEVELS],
}

impl Cores {
    /// Of a shape.
    #[must_use]
    pub fn of(shape: BodyShape) -> Self {
        let thickness = shape.thickness();
        Self(Arc::new(Series { shape, thickness, cores: Default::default() }))
    }

    /// The shape itself.
    #[must_use]
    pub fn shape(&self) -> &BodyShape {
        &self.0.shape
    }

    /// The shape's [thickness](BodyShape::thickness): infinite where it has no cores.
    pub(crate) fn thickness(&self) -> f64 {
        self.0.thickness
    }

    /// Number of faces that a core is made of.
    pub(crate) fn faces(&self) -> usize {
        self.shape().model().map_or(0, |model| model.mesh().faces().len())
    }

    /// How deep a core lies in the body; levels are ascending.
    pub(crate) fn depth(&self, level: usize) -> f64 {
        let halves = (LEVELS - 1 - level) as i32;
        DEEPEST * self.thickness() * 0.5f64.powi(halves)
    }

    /// The core of a level; `None` where the shape bounds no volume, or too little of it is left.
    pub(crate) fn core(&self, level: usize) -> Option<&BodyShape> {
        if !self.thickness().is_finite() {
            return None;
        }
        let make = || match self.shape() {
            BodyShape::Model(model) => sunk(model, self.depth(level)).map(BodyShape::from),
            BodyShape::Primitive(primitive) => {
                smaller(primitive, self.depth(level)).map(BodyShape::from)
            }
        };
        self.0.cores[level].get_or_init(make).as_ref()
    }
}

/// The cores of several bodies, by names; bodies of one shape share them.
#[derive(Clone, Debug)]
pub struct CoresOfBodies<K>(BTreeMap<K, Cores>);

impl<K> Default for CoresOfBodies<K> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<K: Ord> CoresOfBodies<K> {
    /// Has the cores of a body of this shape from now on.
    pub fn note(&mut self, body: K, shape: &BodyShape) {
        let is_of = |cores: &&Cores| cores.shape().is_same(shape);
        if self.0.get(&body).filter(is_of).is_none() {
            let known = self.0.values().find(is_of).cloned();
            self.0.insert(body, known.unwrap_or_else(|| Cores::of(shape.clone())));
        }
    }

    /// Those of a body that was noted.
    pub fn get(&self, body: &K) -> Option<&Cores> {
        self.0.get(body)
    }

    /// Forgets all bodies that fail a test.
    pub fn retain(&mut self, mut keep: impl FnMut(&K) -> bool) {
        self.0.retain(|body, _| keep(body));
    }
}

/// A model whose surface lies so deep in that of another one.
fn sunk(model: &Model, depth: f64) -> Option<Model> {
    let mesh = model.mesh();
    let vertices = (0..).map(VertexId).zip(mesh.vertices());
    let vertices = vertices.map(|(vertex, &place)| place + inwards(model, vertex, depth));
    let sunk = Mesh::new(vertices.collect(), mesh.faces().to_vec()).ok()?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Some(Model::build(sunk, &options).ok()?.0)
}

/// By what a vertex is moved so that the faces around it lie at a depth.
fn inwards(model: &Model, vertex: VertexId, depth: f64) -> DVec3 {
    let mesh = model.mesh();
    let around = model.topology().faces_at(vertex);
    // Each direction once: how a side is cut into triangles changes nothing.
    let mut normals: Vec<DVec3> = Vec::with_capacity(around.len());
    for normal in around.iter().filter_map(|&face| mesh.area_vector(face).try_normalize()) {
        if normals.iter().all(|known| known.dot(normal) < ONE_SIDE) {
            normals.push(normal);
        }
    }
    let Some(out) = normals.iter().sum::<DVec3>().try_normalize() else { return DVec3::ZERO };
    let least = normals.iter().map(|normal| normal.dot(out)).fold(1.0, f64::min);
    let wanted = depth * if least > 0.0 { least.recip().min(FARTHEST) } else { FARTHEST };
    let beneath = BENEATH * model.radius();
    let from = mesh.vertices()[vertex.index()] - beneath * out;
    let through = cast_ray(model, from, -out, f64::INFINITY).ok().flatten();
    let room = through.map_or(f64::INFINITY, |hit| THROUGH * (hit.distance + beneath));
    -out * wanted.min(room)
}

/// A primitive that is smaller by a depth on all sides.
fn smaller(primitive: &Primitive, depth: f64) -> Option<Primitive> {
    let less = |length: f64| Some(length - depth).filter(|&left| left > 0.0);
    Some(match *primitive {
        Primitive::Ball(ball) => Ball { radius: less(ball.radius)?, ..ball }.into(),
        Primitive::Capsule(capsule) => Capsule { radius: less(capsule.radius)?, ..capsule }.into(),
        Primitive::Cylinder(cylinder) => {
            let (radius, half_height) = (less(cylinder.radius)?, less(cylinder.half_height)?);
            Cylinder { radius, half_height, ..cylinder }.into()
        }
        Primitive::Cone(cone) => {
            let height = 2.0 * cone.half_height;
            // Of the angle between the axis and the side.
            let sine = cone.radius / cone.radius.hypot(height);
            let (base, apex) = (depth, height - depth / sine);
            let left = Some(apex - base).filter(|&left| left > 0.0)?;
            let up = cone.axis.try_normalize()?;
            Cone {
                center: cone.center + up * (0.5 * (base + apex) - cone.half_height),
                half_height: 0.5 * left,
                radius: cone.radius * left / height,
                ..cone
            }
            .into()
        }
        Primitive::Segment(_) | Primitive::HalfSpace(_) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::Pose;
    use cranny_narrow_phase::{Demand, PairMemory, Query};
    use cranny_shapes::{Cuboid, Cup, Hook, IsoNut, LPrism, Shape, Torus};
    use cranny_testkit::Rng;

    use crate::between::{PlacedShape, query_shapes};
    use crate::separation::Separation;
    use crate::shape_ray::separation_of_point;

    fn built(shape: impl Into<Shape>) -> BodyShape {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0.into()
    }

    /// Each core of a mesh lies within the body, as deep as it says, or less where that is thin.
    #[test]
    fn a_core_of_a_mesh_lies_as_deep_as_it_says() {
        let meshes = [
            built(Cuboid { size: [1.0, 2.0, 0.1] }),
            built(LPrism::default()),
            built(Cup::default()),
            built(Hook::default()),
            built(Torus::default()),
            built(IsoNut::default()),
        ];
        for (index, shape) in meshes.into_iter().enumerate() {
            let cores = Cores::of(shape);
            // Deeper ones come together in the crests of the nut's thread.
            for level in LEVELS - 8..LEVELS - 3 {
                let core = cores.core(level).expect("something is left");
                let [a, b] =
                    [cores.shape(), core].map(|shape| PlacedShape { shape, pose: Pose::IDENTITY });
                let demand = Query::of(Demand::Distance { below: None });
                let answer = query_shapes(a, b, &demand, &mut PairMemory::default()).unwrap();
                let gap = answer.distance.unwrap();
                let expected = cores.depth(level);
                assert!(gap > 0.0 && gap <= 1.01 * expected, "{index} at level {level}: {gap}");
                assert!(answer.solid && answer.contained.is_some(), "{index} at level {level}");
            }
        }
    }

    /// All around a point of a core, up to its depth, is the body; and what is far deeper in the
    /// body than that is in the core.
    #[test]
    fn a_core_of_a_primitive_lies_as_deep_as_it_says() {
        let (center, axis) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.0, 2.0, -1.0));
        let (half_height, radius, border) = (0.4, 0.3, 0.0);
        let primitives: [Primitive; 5] = [
            Ball { center, radius }.into(),
            Capsule { ends: [center, center + axis], radius }.into(),
            Cylinder { center, axis, half_height, radius, border }.into(),
            Cylinder { center, axis, half_height, radius, border: 0.1 }.into(),
            Cone { center, axis, half_height, radius, border }.into(),
        ];
        let mut rng = Rng::new(8);
        for primitive in primitives {
            let cores = Cores::of(primitive.into());
            let holds = |shape: &BodyShape, p: DVec3| {
                matches!(separation_of_point(shape, p, 0.0), Ok(Separation::Meeting))
            };
            let (mut within, mut beyond) = (0, 0);
            for level in [LEVELS - 1, LEVELS - 2, LEVELS - 4] {
                let (core, depth) = (cores.core(level).expect("it is left"), cores.depth(level));
                for _ in 0..3_000 {
                    let mut vector =
                        |size: f64| DVec3::from_array([(); 3].map(|()| size * rng.unit()));
                    let p = center + vector(0.5);
                    let around = [(); 40].map(|()| vector(1.0).normalize_or_zero());
                    let all = |far: f64| {
                        around.iter().all(|way| holds(cores.shape(), p + way * (far * depth)))
                    };
                    if holds(core, p) {
                        within += 1;
                        assert!(all(0.999), "{primitive:?} at level {level}: {p}");
                    } else {
                        beyond += 1;
                        assert!(!all(1.5), "{primitive:?} at level {level}: {p}");
                    }
                }
            }
            assert!(within > 100 && beyond > 100, "{primitive:?}: {within}, {beyond}");
        }
    }

    #[test]
    fn what_bounds_no_volume_has_none() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let sheet = Mesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let sheet = Model::build(sheet, &BuildOptions::default()).unwrap().0;
        assert!(sheet.mass_properties().is_none() && Cores::of(sheet.into()).core(3).is_none());
    }
}
