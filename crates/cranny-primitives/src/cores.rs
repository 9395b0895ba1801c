//! Cores of a body: what is left of it when its surface is moved inwards.
//!
//! A body that is held where its surface meets another one is held where it slides, rolls and rests
//! as well. So what is swept is a core: it is free of what the body merely touches, and where
//! the core passes through nothing, the body passes through nothing
//! ([`let_until`](crate::let_until)).
//!
//! A body has a core for each of a series of depths, each twice the one before. That of a mesh has
//! the mesh's faces, their vertices moved so that all faces around lie as deep, and less than
//! half-way through where the body is thin. Vertices between faces that coincide stay where they
//! are, and deep cores of fine crests cross themselves: [`hold`](crate::let_until) takes another
//! then. That of a primitive is a smaller one.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model, VertexId};

use crate::primitive::{Ball, Capsule, Cone, Cylinder, Primitive};
use crate::ray::cast_ray;
use crate::shape::BodyShape;

/// Number of cores: the shallowest is two millionths as deep as the deepest. More: rounding of
/// poses is deeper than that; fewer: what touches sinks in visibly before it is held.
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

/// Steps towards the middle of the sides at a vertex. Fewer: the core of a sharp corner lies askew;
/// more: nothing.
const STEPS_TO_THE_MIDDLE: u32 = 64;

/// From how far beneath a vertex the way through the body is measured, as a share of its radius.
/// Smaller: rays meet the vertex's own faces, by rounding; larger: thin walls are missed.
const BENEATH: f64 = 1e-6;

/// The cores of one shape. Clones share them, and remember those that a sweep has needed: most
/// bodies need none, and the others two or three.
#[derive(Clone, Debug)]
pub struct Cores(Arc<Series>);

#[derive(Debug)]
struct Series {
    shape: BodyShape,
    thickness: f64,
    made: Mutex<Made>,
}

/// What sweeps have needed so far.
#[derive(Debug, Default)]
struct Made {
    /// Of a mesh's vertices.
    inwards: Option<Vec<Inwards>>,
    cores: [Option<Option<BodyShape>>; LEVELS],
}

impl Cores {
    /// Of a shape.
    #[must_use]
    pub fn of(shape: BodyShape) -> Self {
        let thickness = shape.thickness();
        Self(Arc::new(Series { shape, thickness, made: Mutex::default() }))
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
    pub(crate) fn core(&self, level: usize) -> Option<BodyShape> {
        if !self.thickness().is_finite() {
            return None;
        }
        let depth = self.depth(level);
        let Made { inwards, cores } =
            &mut *self.0.made.lock().unwrap_or_else(PoisonError::into_inner);
        let core = cores[level].get_or_insert_with(|| match self.shape() {
            BodyShape::Model(model) => {
                let inwards = inwards.get_or_insert_with(|| all_inwards(model));
                sunk(model, inwards, depth).map(BodyShape::from)
            }
            BodyShape::Primitive(primitive) => smaller(primitive, depth).map(BodyShape::from),
        });
        core.clone()
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

/// How the vertices of a model are moved inwards: depths apart, the same for all cores.
fn all_inwards(model: &Model) -> Vec<Inwards> {
    let mesh = model.mesh();
    let faces = mesh.face_ids();
    // From the middle of each face to the other side of the body.
    let through: Vec<f64> = faces
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            let inward = mesh.area_vector(face).try_normalize().map(|normal| -normal);
            let way = inward.and_then(|way| way_through(model, (a + b + c) / 3.0, way));
            way.unwrap_or(f64::INFINITY)
        })
        .collect();
    let vertices = mesh.vertex_ids();
    vertices.map(|vertex| Inwards::of(model, vertex, &through)).collect()
}

/// A model with its surface sunk by a depth.
fn sunk(model: &Model, inwards: &[Inwards], depth: f64) -> Option<Model> {
    let mesh = model.mesh();
    let vertices = mesh.vertices().iter().zip(inwards);
    let vertices = vertices.map(|(&place, inwards)| place + inwards.by(depth));
    let sunk = Mesh::new(vertices.collect(), mesh.faces().to_vec()).ok()?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Some(Model::build(sunk, &options).ok()?.0)
}

/// How a vertex is moved inwards.
#[derive(Debug)]
struct Inwards {
    way: DVec3,
    /// In multiples of the depth: all sides around lie as deep then.
    scale: f64,
    /// How far it is moved at most.
    room: f64,
}

impl Inwards {
    /// `through` is how far it is through the body from each face.
    fn of(model: &Model, vertex: VertexId, through: &[f64]) -> Self {
        let at = model.mesh().vertices()[vertex.index()];
        let normals = normals_at(model, vertex);
        let out = amid(&normals);
        let least = normals.iter().map(|normal| normal.dot(out)).fold(1.0, f64::min);
        // A saddle is behind none of its sides wholly: behind one of them is some of the body.
        let mut ways = std::iter::once(out).chain(normals.iter().copied());
        let inner = ways.find_map(|out| Some((-out, way_through(model, at, -out)?)));
        let (way, room) = inner.unwrap_or((DVec3::ZERO, 0.0));
        let around = model.topology().faces_at(vertex).iter().map(|face| through[face.index()]);
        Self {
            way,
            scale: if least > 0.0 { least.recip().min(FARTHEST) } else { 1.0 },
            room: THROUGH * around.fold(room, f64::min),
        }
    }

    fn by(&self, depth: f64) -> DVec3 {
        self.way * (self.scale * depth).min(self.room)
    }
}

/// The directions of the sides at a vertex.
fn normals_at(model: &Model, vertex: VertexId) -> Vec<DVec3> {
    let mut normals: Vec<DVec3> = Vec::new();
    for &face in model.topology().faces_at(vertex) {
        let normal = model.mesh().area_vector(face).try_normalize();
        normals.extend(normal.filter(|n| normals.iter().all(|known| known.dot(*n) < ONE_SIDE)));
    }
    normals
}

/// The direction from which the farthest of some directions is nearest: the middle of the least
/// ball around them, by steps towards the farthest (Badoiu and Clarkson 2003).
fn amid(directions: &[DVec3]) -> DVec3 {
    let mut middle = directions.iter().sum::<DVec3>() / directions.len().max(1) as f64;
    for step in 1..=STEPS_TO_THE_MIDDLE {
        let away = |n: &DVec3| n.distance_squared(middle);
        let farthest = directions.iter().max_by(|p, q| away(p).total_cmp(&away(q)));
        middle += (farthest.copied().unwrap_or(middle) - middle) / f64::from(step + 1);
    }
    middle.normalize_or_zero()
}

/// How far it is through a body from a place on its surface; `None` where a direction leads out.
fn way_through(model: &Model, at: DVec3, inward: DVec3) -> Option<f64> {
    let beneath = BENEATH * model.radius();
    let hit = cast_ray(model, at + beneath * inward, inward, f64::INFINITY).ok()??;
    hit.from_behind.then_some(hit.distance + beneath)
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
            let side = (cone.radius * cone.radius + height * height).sqrt();
            let sine = cone.radius / side;
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
    use cranny_shapes::{Boxes, Cuboid, Cup, Hook, IsoNut, LPrism, Shape, Torus};
    use cranny_testkit::Rng;

    use crate::between::{PlacedShape, query_shapes};
    use crate::separation::Separation;
    use crate::shape_ray::separation_of_point;

    fn built(shape: impl Into<Shape>) -> BodyShape {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0.into()
    }

    /// Of all shapes that are generated: no vertex of a shallow core leaves the body.
    #[test]
    fn cores_of_all_generators_lie_within() {
        let mut shapes = 0;
        for shape in Shape::defaults() {
            let name = shape.name();
            let Ok(mesh) = shape.build() else { continue };
            let model = Model::build(mesh, &BuildOptions::default()).unwrap().0;
            if model.mass_properties().is_none() {
                continue;
            }
            shapes += 1;
            let cores = Cores::of(model.into());
            let level = LEVELS - 6;
            let core = cores.core(level).expect("something is left");
            let [a, b] =
                [cores.shape(), &core].map(|s| PlacedShape { shape: s, pose: Pose::IDENTITY });
            let verdict = Query::of(Demand::Intersects);
            let answer = query_shapes(a, b, &verdict, &mut PairMemory::default()).unwrap();
            assert!(answer.contained.is_some() && answer.solid, "{name}");
            for &p in core.model().unwrap().mesh().vertices().iter().step_by(7) {
                let found = separation_of_point(cores.shape(), p, 0.0);
                assert_eq!(found, Ok(Separation::Meeting), "{name}: {p}");
            }
        }
        assert!(shapes > 30, "{shapes}");
    }

    /// Flat below, with a ridge above: the sum of the sides at its tip looks up.
    fn arrow() -> BodyShape {
        let vertices = [[0.0, 0.3, 0.0], [0.0, -0.3, 0.0], [0.0, 0.0, 0.4], [2.0, 0.0, 0.0]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mesh = Mesh::new(vertices.map(DVec3::from_array).to_vec(), faces).unwrap();
        let arrow = Model::build(mesh, &BuildOptions::default()).unwrap().0;
        assert!(arrow.mass_properties().is_some_and(|mass| mass.volume > 0.0));
        arrow.into()
    }

    /// Each core of a mesh lies within the body, as deep as it says, or less where that is thin.
    #[test]
    fn a_core_of_a_mesh_lies_as_deep_as_it_says() {
        // Far thinner than the block that it stands on.
        let (block, fin) =
            ([[-2.0, -2.0, -2.0], [2.0, 2.0, 0.0]], [[0.0, -2.0, 0.0], [0.02, 2.0, 1.0]]);
        let meshes = [
            built(Cuboid { size: [1.0, 2.0, 0.1] }),
            built(LPrism::default()),
            built(Cup::default()),
            built(Hook::default()),
            built(Torus::default()),
            built(IsoNut::default()),
            arrow(),
            built(Boxes { add: vec![block, fin], cut: vec![] }),
        ];
        for (index, shape) in meshes.into_iter().enumerate() {
            let cores = Cores::of(shape);
            // Deeper ones come together in the crests of the nut's thread.
            for level in LEVELS - 8..LEVELS - 3 {
                let core = cores.core(level).expect("something is left");
                let [a, b] =
                    [cores.shape(), &core].map(|shape| PlacedShape { shape, pose: Pose::IDENTITY });
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
                    if holds(&core, p) {
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
