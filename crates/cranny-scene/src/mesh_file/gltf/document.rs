//! The parts of a glTF document that say where triangles are.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::{FORMAT, missing_element};
use crate::mesh_file::problem::{DecodeError, Place, Problem};

/// How the names of extensions begin that a file may require without moving a triangle: what
/// surfaces look like, and lights.
const HARMLESS: [&str; 4] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"];

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<SceneNodes>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Primitives>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

#[derive(Deserialize)]
struct SceneNodes {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    /// x, y, z, w.
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct Primitives {
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<serde_json::Value>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
}

impl Document {
    /// Refuses other versions and extensions that may change where triangles are.
    pub(super) fn check_extensions(&self) -> Result<(), DecodeError> {
        let refuse = |what, advice| {
            let problem = Problem::Unsupported { what, advice };
            Err(DecodeError { format: FORMAT, place: Place::Whole, problem })
        };
        if !self.asset.version.starts_with("2.") {
            return refuse(format!("glTF version {:?}", self.asset.version), "Export as glTF 2.0");
        }
        let harmless = |name: &&String| HARMLESS.iter().any(|start| name.starts_with(start));
        match self.extensions_required.iter().find(|name| !harmless(name)) {
            Some(extension) => refuse(
                format!("the required extension {extension:?}"),
                "Export without compression, quantisation and other geometry extensions",
            ),
            None => Ok(()),
        }
    }

    /// Roots of the default scene, else of the first; without scenes, every node that is no child.
    pub(super) fn roots(&self) -> Result<Vec<usize>, DecodeError> {
        if self.scenes.is_empty() {
            let mut is_child = vec![false; self.nodes.len()];
            for child in self.nodes.iter().flat_map(|node| &node.children) {
                if let Some(flag) = is_child.get_mut(*child) {
                    *flag = true;
                }
            }
            return Ok((0..self.nodes.len()).filter(|&i| !is_child[i]).collect());
        }
        let index = self.scene.unwrap_or(0);
        let scene = self.scenes.get(index).ok_or_else(|| DecodeError {
            format: FORMAT,
            place: Place::Element(format!("scene {index}")),
            problem: missing_element("scene"),
        })?;
        Ok(scene.nodes.clone())
    }
}
