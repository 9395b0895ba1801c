//! A vertex is pushed within a flat side, so that a face folds over, while the hull changes
//! elsewhere.
use crate::body::Body;
use cranny_exact::DVec3;
use cranny_geometry::VertexId;
use cranny_shapes::{Cuboid, Shape};

use super::equal::assert_equals_rebuild;
use super::{model, split_edges};

#[test]
fn a_face_that_folds_over_within_its_side_is_judged_again() {
    let cube = Shape::from(Cuboid::default()).build().unwrap();
    let mut model: Body = model(split_edges(&split_edges(&split_edges(&cube))));
    let find = |model: &Body, p: DVec3| {
        let all = (0..model.mesh().vertices().len() as u32).map(VertexId);
        all.min_by(|&v, &w| {
            let d = |v| (model.mesh().position(v) - p).length();
            d(v).total_cmp(&d(w))
        })
        .unwrap()
    };
    let (min, max) = (model.bounds().min, model.bounds().max);
    let (size, middle) = (max.x - min.x, 0.5 * (min + max));
    // A dome on the side at x = max: its top, and four around it.
    let cell = 0.125 * size;
    let around = [DVec3::Y, DVec3::Z, -DVec3::Y, -DVec3::Z].map(|d| 2.0 * cell * d);
    let base = DVec3::new(max.x, middle.y, middle.z);
    let top = find(&model, base);
    let ring = around.map(|d| find(&model, base + d));
    let mut moves = vec![(top, base + cell * DVec3::X)];
    moves.extend(ring.iter().zip(around).map(|(&v, d)| (v, base + d + 0.75 * cell * DVec3::X)));
    model.deform(&moves).unwrap();
    let mut model = self::model(model.mesh().clone());
    // In the middle of the side at x = min: within it by two and a bit cells, onto no other vertex.
    let v = find(&model, DVec3::new(min.x, middle.y, middle.z));
    let to = model.mesh().position(v) + cell * DVec3::new(0.0, 2.3, 0.3);
    // One of the dome's goes out a little.
    let lower = (ring[0], model.mesh().position(ring[0]) + 0.03125 * cell * DVec3::X);
    let change = model.deform(&[(v, to), lower]).unwrap();
    assert!(change.hull && !change.work.is_anew);
    assert_equals_rebuild(&model, "folded");
}
