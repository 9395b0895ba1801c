//! parry's triangle meshes and convex polyhedra, given the same in single precision.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Model, ModelTag};
use cranny_rapier::Detector;
use cranny_stability::{Peer, PeerAnswer};
use parry3d::math::Vector;
use parry3d::query::{distance, intersection_test};
use parry3d::shape::{Shape, SharedShape};
use parry3d::transformation::try_convex_hull;

use crate::parry::{double, quietly, single};

/// Shapes of so many models are kept.
const KEPT: usize = 16;

/// parry, and the shapes of the models of its last query.
#[derive(Default)]
pub(super) struct Parry {
    shapes: Vec<(ModelTag, SharedShape)>,
}

fn points(points: &[DVec3]) -> Vec<Vector> {
    points.iter().map(|p| Vector::new(p.x as f32, p.y as f32, p.z as f32)).collect()
}

fn ask(a: &dyn Shape, b: &dyn Shape, poses: [Pose; 2]) -> Result<PeerAnswer, String> {
    let [p, q] = poses.map(single);
    let meets = intersection_test(&p, a, &q, b).map_err(|error| error.to_string())?;
    let apart = distance(&p, a, &q, b).map_err(|error| error.to_string())?;
    Ok(PeerAnswer { meets: meets.intersecting, distance: apart.distance.into() })
}

impl Parry {
    fn shape(&mut self, model: &Model) -> Result<SharedShape, String> {
        if let Some((_, shape)) = self.shapes.iter().find(|(tag, _)| tag.is_of(model)) {
            return Ok(shape.clone());
        }
        let shape =
            quietly(|| Detector::RapierTrimesh.shape(model, 0).map_err(|error| error.to_string()))?;
        if self.shapes.len() == KEPT {
            self.shapes.remove(0);
        }
        self.shapes.push((ModelTag::of(model), shape.clone()));
        Ok(shape)
    }
}

impl Peer for Parry {
    fn name(&self) -> &'static str {
        "parry"
    }

    fn surfaces(&mut self, [a, b]: [&Model; 2], poses: [Pose; 2]) -> Result<PeerAnswer, String> {
        let (a, b) = (self.shape(a)?, self.shape(b)?);
        quietly(|| ask(&*a, &*b, poses))
    }

    fn hulls(&mut self, [a, b]: [&[DVec3]; 2], pose: Pose) -> Result<PeerAnswer, String> {
        quietly(|| {
            let hull =
                |p| SharedShape::convex_hull(&points(p)).ok_or("it makes no hull".to_owned());
            ask(&*hull(a)?, &*hull(b)?, [Pose::IDENTITY, pose])
        })
    }

    fn hull(&mut self, cloud: &[DVec3]) -> Result<(Vec<DVec3>, Vec<[DVec3; 3]>), String> {
        quietly(|| {
            let cloud = points(cloud);
            let (vertices, faces) = try_convex_hull(&cloud).map_err(|error| error.to_string())?;
            let corner = |v: u32| double(vertices[v as usize]);
            let triangles = faces.into_iter().map(|face| face.map(corner)).collect();
            Ok((cloud.into_iter().map(double).collect(), triangles))
        })
    }
}
