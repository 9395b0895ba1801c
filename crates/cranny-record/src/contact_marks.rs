//! Contacts as viewers draw them: as a scene, as points, as poses. All in world coordinates.

use std::collections::BTreeSet;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::{Answer, Contact, Curve};
use foxglove::bytes::Bytes;
use foxglove::messages::{
    ArrowPrimitive, KeyValuePair, LinePrimitive, PackedElementField, PointCloud, PosesInFrame,
    SceneEntity, SceneEntityDeletion, SceneUpdate, SpherePrimitive, Timestamp, line_primitive,
    packed_element_field::NumericType, scene_entity_deletion,
};

use crate::convert::{color, point3, pose, vector3};
use crate::frame::{Frame, PairContacts};
use crate::topic::WORLD_FRAME;

const OVERLAP: [f64; 4] = [0.90, 0.15, 0.12, 1.0];
const NEAR: [f64; 4] = [0.95, 0.75, 0.10, 1.0];
const NORMAL: [f64; 4] = [0.10, 0.45, 0.90, 1.0];
const CURVE: [f64; 4] = [1.0, 1.0, 1.0, 1.0];

/// Pixels. Thinner lines drown in a mesh's edges; thicker ones hide small regions.
const CURVE_THICKNESS: f64 = 3.0;

/// Length of an arrow, in diameters of the sphere at its foot.
const ARROW_LENGTH: f64 = 5.0;

/// Draws the contacts of frame after frame.
#[derive(Debug)]
pub(crate) struct ContactMarks {
    /// Diameter of the sphere at a contact, units of length.
    size: f64,
    /// Entities of the last frame: those not drawn again must be deleted.
    shown: BTreeSet<String>,
}

impl ContactMarks {
    pub(crate) fn of_size(size: f64) -> Self {
        Self { size, shown: BTreeSet::new() }
    }

    pub(crate) fn resize(&mut self, size: f64) {
        self.size = size;
    }

    /// All entities of this frame, one a pair with contacts, and the deletion of those of the last
    /// frame that are gone. Each message holds the whole picture, so that a viewer may jump.
    pub(crate) fn scene(&mut self, frame: &Frame, timestamp: Timestamp) -> SceneUpdate {
        let entities: Vec<SceneEntity> = frame
            .contacts
            .iter()
            .filter(|pair| !pair.answer.contacts.is_empty() || !pair.answer.regions.is_empty())
            .map(|pair| self.entity(pair, timestamp))
            .collect();
        let shown: BTreeSet<String> = entities.iter().map(|e| e.id.clone()).collect();
        let deletions = self
            .shown
            .difference(&shown)
            .map(|id| SceneEntityDeletion {
                timestamp: Some(timestamp),
                r#type: scene_entity_deletion::Type::MatchingId as i32,
                id: id.clone(),
            })
            .collect();
        self.shown = shown;
        SceneUpdate { deletions, entities }
    }

    fn entity(&self, pair: &PairContacts, timestamp: Timestamp) -> SceneEntity {
        let answer = pair.answer;
        let curves = answer.regions.iter().flat_map(|region| &region.curves);
        let deepest = || answer.regions.iter().map(|region| &region.deepest);
        SceneEntity {
            timestamp: Some(timestamp),
            frame_id: WORLD_FRAME.to_owned(),
            // Quoted, so that no two pairs of names share an id.
            id: format!("{:?} {:?}", pair.a, pair.b),
            spheres: deepest().map(|c| self.sphere(c)).collect(),
            arrows: deepest().filter_map(|c| self.arrow(c)).collect(),
            metadata: metadata(answer),
            lines: curves.map(line).collect(),
            ..SceneEntity::default()
        }
    }

    fn sphere(&self, contact: &Contact) -> SpherePrimitive {
        SpherePrimitive {
            pose: Some(pose(&Pose::at(middle(contact)))),
            size: Some(vector3(DVec3::splat(self.size))),
            color: Some(color(if contact.separation <= 0.0 { OVERLAP } else { NEAR })),
        }
    }

    fn arrow(&self, contact: &Contact) -> Option<ArrowPrimitive> {
        let head = 0.3 * ARROW_LENGTH;
        Some(ArrowPrimitive {
            pose: Some(pose(&normal_pose(contact)?)),
            shaft_length: self.size * (ARROW_LENGTH - head),
            shaft_diameter: self.size * 0.35,
            head_length: self.size * head,
            head_diameter: self.size * 0.9,
            color: Some(color(NORMAL)),
        })
    }
}

fn line(curve: &Curve) -> LinePrimitive {
    let kind =
        if curve.closed { line_primitive::Type::LineLoop } else { line_primitive::Type::LineStrip };
    LinePrimitive {
        r#type: kind as i32,
        pose: Some(pose(&Pose::IDENTITY)),
        thickness: CURVE_THICKNESS,
        scale_invariant: true,
        points: curve.points.iter().map(|&p| point3(for_the_eye(p))).collect(),
        color: Some(color(CURVE)),
        ..LinePrimitive::default()
    }
}

/// All contacts of a frame with the number of their pair.
fn contacts<'a>(frame: &'a Frame) -> impl Iterator<Item = (u32, &'a Contact)> {
    let pairs = (0u32..).zip(&frame.contacts);
    pairs.flat_map(|(number, pair)| pair.answer.contacts.iter().map(move |c| (number, c)))
}

/// Points half-way between the bodies, with `separation` and `pair`, the pair's place in the
/// `/contacts` message of the same time. Single precision: for the eye.
pub(crate) fn point_cloud(frame: &Frame, timestamp: Timestamp) -> PointCloud {
    let mut data = Vec::new();
    for (pair, contact) in contacts(frame) {
        let [x, y, z] = middle(contact).to_array();
        for value in [x, y, z, contact.separation] {
            #[expect(clippy::cast_possible_truncation, reason = "rounded on purpose")]
            data.extend_from_slice(&(value as f32).to_le_bytes());
        }
        data.extend_from_slice(&pair.to_le_bytes());
    }
    let float = NumericType::Float32;
    let kinds = [
        ("x", float),
        ("y", float),
        ("z", float),
        ("separation", float),
        ("pair", NumericType::Uint32),
    ];
    let fields: Vec<PackedElementField> = (0u32..)
        .zip(kinds)
        .map(|(i, (name, kind))| PackedElementField {
            name: name.to_owned(),
            offset: 4 * i,
            r#type: kind as i32,
        })
        .collect();
    PointCloud {
        timestamp: Some(timestamp),
        frame_id: WORLD_FRAME.to_owned(),
        pose: Some(pose(&Pose::IDENTITY)),
        point_stride: 20,
        fields,
        data: Bytes::from(data),
    }
}

/// A pose a contact that has a normal, its x axis along it.
pub(crate) fn normal_poses(frame: &Frame, timestamp: Timestamp) -> PosesInFrame {
    let poses = contacts(frame).filter_map(|(_, contact)| normal_pose(contact));
    PosesInFrame {
        timestamp: Some(timestamp),
        frame_id: WORLD_FRAME.to_owned(),
        poses: poses.map(|p| pose(&short(p))).collect(),
    }
}

/// Rounded to single precision: what a recording need not hold compresses away.
fn for_the_eye(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

fn short(pose: Pose) -> Pose {
    let rotation = pose.rotation.as_quat().as_dquat();
    Pose { rotation, translation: for_the_eye(pose.translation) }
}

/// What viewers list beside a pair's picture.
fn metadata(answer: &Answer) -> Vec<KeyValuePair> {
    let entry = |key: &str, value: String| KeyValuePair { key: key.to_owned(), value };
    let sum = answer.regions.iter().filter_map(|r| r.area).reduce(|a, b| a + b);
    let depth = answer.regions.iter().filter_map(|r| r.depth).reduce(f64::max);
    let depth = depth.map(|d| entry("depth", d.to_string()));
    let area = sum.map(|a| entry("area", a.to_string()));
    let count = entry("regions", answer.regions.len().to_string());
    depth.into_iter().chain(area).chain([count]).collect()
}

fn middle(contact: &Contact) -> DVec3 {
    0.5 * (contact.point_a + contact.point_b)
}

/// `None` where the contact has no normal: its length is 0 or no number.
fn normal_pose(contact: &Contact) -> Option<Pose> {
    let normal = contact.normal.try_normalize()?;
    let rotation = DQuat::from_rotation_arc(DVec3::X, normal);
    Some(Pose { rotation, translation: middle(contact) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::VertexId;
    use cranny_narrow_phase::Feature;

    fn contact(normal: DVec3) -> Contact {
        let vertex = Feature::Vertex(VertexId(0));
        let point_a = DVec3::new(1.0, 2.0, 3.0);
        let point_b = point_a + 0.5 * normal;
        Contact { id: (vertex, vertex), point_a, point_b, normal, separation: 0.5 }
    }

    #[test]
    fn the_x_axis_of_a_contact_pose_is_the_normal() {
        let oblique = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        for normal in [DVec3::X, -DVec3::X, DVec3::Z, oblique] {
            let pose = normal_pose(&contact(normal)).unwrap();
            assert!((pose.world_from_body().apply_vector(DVec3::X) - normal).length() < 1e-12);
            assert_eq!(pose.translation, middle(&contact(normal)));
        }
        assert_eq!(normal_pose(&contact(DVec3::ZERO)), None);
    }
}
