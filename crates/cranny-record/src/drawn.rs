//! What viewers draw of a recording, read back: bodies as they come, change and leave, contacts as
//! points, arrows and curves, and pictures.

use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_world::description::BodyColor;
use foxglove::Decode;
use foxglove::messages::{
    Color, CompressedImage, LinePrimitive, PackedElementField, PointCloud, PosesInFrame,
    SceneEntity, SceneUpdate, line_primitive, packed_element_field::NumericType,
};

use crate::error::ReadError;
use crate::recording::Recording;
use crate::topic;

/// A body as it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnBody {
    /// Its name and frame.
    pub name: String,
    /// What is drawn of it, in its frame, to the bit.
    pub mesh: Arc<Mesh>,
    /// Red, green, blue and opacity, 0 to 1.
    pub color: [f64; 4],
    /// Digest of the model that collides, hexadecimal; `None` where the recording does not say.
    pub model: Option<String>,
    /// The primitive that collides, in words; `None` where the recording does not say.
    pub primitive: Option<String>,
    /// `fixed`, `kinematic` or `dynamic`; `None` where the recording does not say.
    pub kind: Option<String>,
    /// Red, green and blue, where somebody chose them; `None` also where the recording does not
    /// say.
    pub stated_color: Option<BodyColor>,
    /// Its number in the run; `None` where the recording does not say.
    pub number: Option<u32>,
    /// Whether it is a sensor; false also where the recording does not say.
    pub sensor: bool,
}

/// What a recording says at one time of which bodies there are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyChanges {
    /// Names of bodies that leave. They leave before others come.
    pub left: Vec<String>,
    /// Bodies that come.
    pub came: Vec<DrawnBody>,
}

/// A contact as viewers draw it, in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnContact {
    /// Half-way between the bodies, in the world.
    pub point: [f32; 3],
    /// Above 0: apart.
    pub separation: f32,
    /// The pair's place in the `/contacts` message of the same time.
    pub pair: usize,
}

/// A curve in which surfaces meet, in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnCurve {
    /// Its points, rounded to single precision.
    pub points: Vec<DVec3>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

/// A camera's picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedPicture {
    /// Its name.
    pub camera: String,
    /// A PNG.
    pub png: Vec<u8>,
}

impl Recording {
    /// Log times (nanoseconds) and which bodies come and leave then. A body that changes its shape
    /// leaves and comes at once.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded or holds no mesh.
    pub fn body_changes(&self) -> Result<Vec<(u64, BodyChanges)>, ReadError> {
        self.messages(topic::BODIES, |data| {
            let update = SceneUpdate::decode(data).map_err(|e| e.to_string())?;
            let left = update.deletions.into_iter().map(|deletion| deletion.id).collect();
            let came =
                update.entities.into_iter().map(drawn_body).collect::<Result<_, String>>()?;
            Ok(BodyChanges { left, came })
        })
    }

    /// Log times (nanoseconds) and contacts, frame by frame.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded or lacks a part.
    pub fn contact_points(&self) -> Result<Vec<(u64, Vec<DrawnContact>)>, ReadError> {
        self.messages(topic::CONTACT_POINTS, |data| {
            drawn_contacts(&PointCloud::decode(data).map_err(|e| e.to_string())?)
        })
    }

    /// Log times (nanoseconds) and poses with x along the normal, one a contact that has a normal.
    ///
    /// # Errors
    ///
    /// As [`contact_points`](Self::contact_points).
    pub fn contact_normals(&self) -> Result<Vec<(u64, Vec<Pose>)>, ReadError> {
        self.messages(topic::CONTACT_NORMALS, |data| {
            let message = PosesInFrame::decode(data).map_err(|e| e.to_string())?;
            let pose = |p| crate::convert::read_pose(p).ok_or("a pose lacks a part".to_owned());
            message.poses.into_iter().map(pose).collect()
        })
    }

    /// Log times (nanoseconds) and the curves in which surfaces meet, frame by frame.
    ///
    /// # Errors
    ///
    /// As [`contact_points`](Self::contact_points).
    pub fn contact_curves(&self) -> Result<Vec<(u64, Vec<DrawnCurve>)>, ReadError> {
        self.messages(topic::CONTACT_SCENE, |data| {
            let update = SceneUpdate::decode(data).map_err(|e| e.to_string())?;
            let lines = update.entities.into_iter().flat_map(|entity| entity.lines);
            Ok(lines.map(drawn_curve).collect())
        })
    }

    /// Log times (nanoseconds) and pictures, camera by camera.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded.
    pub fn pictures(&self) -> Result<Vec<(u64, RecordedPicture)>, ReadError> {
        let mut pictures = Vec::new();
        for name in self.topics().keys() {
            let Some(camera) = name.strip_prefix(topic::CAMERAS) else { continue };
            pictures.extend(self.messages(name, |data| {
                let image = CompressedImage::decode(data).map_err(|e| e.to_string())?;
                Ok(RecordedPicture { camera: camera.to_owned(), png: image.data.to_vec() })
            })?);
        }
        Ok(pictures)
    }
}

fn drawn_body(entity: SceneEntity) -> Result<DrawnBody, String> {
    let name = entity.id;
    let [triangles] = <[_; 1]>::try_from(entity.triangles)
        .map_err(|all| format!("body '{name}' has {} meshes in place of one", all.len()))?;
    let vertices = triangles.points.iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect();
    let faces = triangles.indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]]).collect();
    let mesh = Mesh::new(vertices, faces).map_err(|e| format!("body '{name}': {e}"))?;
    let Color { r, g, b, a } =
        triangles.color.ok_or_else(|| format!("body '{name}' has no colour"))?;
    let fact = |key: &str| {
        let found = entity.metadata.iter().find(|pair| pair.key == key);
        found.map(|pair| pair.value.clone())
    };
    let (model, primitive) = (fact(topic::MODEL_KEY), fact(topic::PRIMITIVE_KEY));
    let kind = fact(topic::KIND_KEY);
    let stated_color = fact(topic::COLOR_KEY).and_then(|text| stated_color(&text));
    let number = fact(topic::NUMBER_KEY).and_then(|text| text.parse().ok());
    let sensor = fact(topic::SENSOR_KEY).is_some_and(|text| text == true.to_string());
    let color = [r, g, b, a];
    Ok(DrawnBody {
        name,
        mesh: Arc::new(mesh),
        color,
        model,
        primitive,
        kind,
        stated_color,
        number,
        sensor,
    })
}

/// Of `#rrggbb`.
fn stated_color(text: &str) -> Option<BodyColor> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    let value = u32::from_str_radix(digits, 16).ok()?;
    let [_, red, green, blue] = value.to_be_bytes();
    Some(BodyColor([red, green, blue]))
}

fn drawn_contacts(cloud: &PointCloud) -> Result<Vec<DrawnContact>, String> {
    let [x, y, z, separation] = ["x", "y", "z", "separation"];
    let offset = |name: &str, kind: NumericType| {
        let is_it = |f: &&PackedElementField| f.name == name && f.r#type == kind as i32;
        let field = cloud.fields.iter().find(is_it).ok_or(format!("points have no '{name}'"))?;
        Ok::<_, String>(field.offset as usize)
    };
    let float = |name: &str| offset(name, NumericType::Float32);
    let at = [float(x)?, float(y)?, float(z)?, float(separation)?];
    let at_pair = offset("pair", NumericType::Uint32)?;
    let stride = cloud.point_stride as usize;
    if stride == 0 || !cloud.data.len().is_multiple_of(stride) {
        return Err(format!("{} bytes are no points of {stride}", cloud.data.len()));
    }
    let contact = |bytes: &[u8]| {
        let word = |at: usize| Some(*bytes.get(at..)?.first_chunk::<4>()?);
        let number = |at: usize| word(at).map(f32::from_le_bytes);
        let point = [number(at[0])?, number(at[1])?, number(at[2])?];
        let pair = u32::from_le_bytes(word(at_pair)?) as usize;
        Some(DrawnContact { point, separation: number(at[3])?, pair })
    };
    let contacts = cloud.data.chunks_exact(stride).map(contact);
    contacts.collect::<Option<_>>().ok_or_else(|| format!("a point ends after {stride} bytes"))
}

fn drawn_curve(line: LinePrimitive) -> DrawnCurve {
    let points = line.points.iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect();
    DrawnCurve { points, closed: line.r#type == line_primitive::Type::LineLoop as i32 }
}
