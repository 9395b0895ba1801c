//! COLLADA 1.4 and 1.5: the geometries that the file's visual scene shows, under its node
//! transforms, in metres by its `<unit>`, turned by its `<up_axis>`.
//!
//! Transforms compose as: axes · unit · node · … · node, applied to positions as filed. A file
//! without a visual scene yields all its geometries as filed (in metres, turned). Points and lines
//! are skipped with a note; skins are read in their bind shape.

mod geometry;
mod transform;

use std::str::FromStr;

use cranny_exact::DVec3;
use roxmltree::{Document, Node, ParsingOptions};

use super::affine::Affine;
use super::builder::Builder;
use super::problem::{DecodeError, Place, Problem, counted, excerpt};
use super::{MeshFile, MeshFormat};
use crate::xml::nested_beyond;
use geometry::Geometry;

const FORMAT: MeshFormat = MeshFormat::Collada;

/// What the numbers of other elements mean.
const NUMBER: &str = "a number of this element";

/// Nodes nest at most so deep. Deeper, and a file whose nodes instance each other would never end;
/// shallower, and exporters' bone chains are refused.
const MAX_DEPTH: usize = 256;

/// XML elements nest at most so deep: nodes, and what is in and around them.
const MAX_NESTING: usize = MAX_DEPTH + 16;

/// A file may show at most so many nodes and geometries. More, and instances of instances (a file
/// of a few lines) would fill the memory; fewer, and large assemblies are refused.
const MAX_VISITS: usize = 1 << 16;

/// How the up-axis that a COLLADA file states is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// The mesh is turned so that the stated axis becomes z.
    #[default]
    Z,
    /// The statement is ignored, as robot description tools do with meshes of URDF files.
    AsFiled,
}

pub(super) fn decode(bytes: &[u8], up_axis: UpAxis) -> Result<MeshFile, DecodeError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        let found = "bytes that are not UTF-8".to_owned();
        let problem = Problem::Malformed { found, expected: "XML in UTF-8".to_owned() };
        DecodeError { format: FORMAT, place: Place::Byte(at), problem }
    })?;
    if let Some(at) = nested_beyond(text, MAX_NESTING) {
        let problem = Problem::Malformed {
            found: format!("elements nested deeper than {MAX_NESTING}"),
            expected: "a flatter document".to_owned(),
        };
        return Err(DecodeError { format: FORMAT, place: Place::Byte(at), problem });
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 1 << 26 };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let place = Place::Line(error.pos().row as usize);
        let problem =
            Problem::Malformed { found: error.to_string(), expected: "well-formed XML".to_owned() };
        DecodeError { format: FORMAT, place, problem }
    })?;
    let root = document.root_element();
    let mut scene =
        ColladaScene { root, builder: Builder::new(FORMAT), visits: 0, skipped: 0, skinned: 0 };
    if root.tag_name().name() != "COLLADA" {
        return Err(malformed(root, excerpt(root.tag_name().name()), "the element 'COLLADA'"));
    }
    let scene_from_file = scene.axes_and_unit(up_axis)?;
    match scene.visual_scene()? {
        Some(visual) => {
            for node in elements(visual, "node") {
                scene.walk(node, &scene_from_file, 0)?;
            }
        }
        None => {
            scene
                .builder
                .note("the file has no visual scene: all its geometries were joined".to_owned());
            for library in elements(root, "library_geometries") {
                for geometry in elements(library, "geometry") {
                    scene.add_geometry(geometry, &scene_from_file)?;
                }
            }
        }
    }
    scene.finish()
}

/// Child elements of a name, whatever their namespace.
fn elements<'a, 'i>(
    parent: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i> {
    parent.children().filter(move |child| child.tag_name().name() == name)
}

fn element<'a, 'i>(parent: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    elements(parent, name).next()
}

fn line_of(node: Node<'_, '_>) -> Place {
    Place::Line(node.document().text_pos_at(node.range().start).row as usize)
}

fn malformed(node: Node<'_, '_>, found: String, expected: &str) -> DecodeError {
    let problem = Problem::Malformed { found, expected: expected.to_owned() };
    DecodeError { format: FORMAT, place: line_of(node), problem }
}

/// The numbers in an element's text; `expected` says what each means.
fn numbers<T: FromStr>(node: Node<'_, '_>, expected: &'static str) -> Result<Vec<T>, DecodeError> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    let refused = |word: &str| {
        let problem = Problem::NotANumber { text: word.chars().take(40).collect(), expected };
        DecodeError { format: FORMAT, place: line_of(node), problem }
    };
    words.map(|word| word.parse().map_err(|_| refused(word))).collect()
}

/// The id that an address within the file names.
fn id_of(address: &str) -> &str {
    address.strip_prefix('#').unwrap_or(address)
}

struct ColladaScene<'a, 'i> {
    root: Node<'a, 'i>,
    builder: Builder,
    visits: usize,
    skipped: usize,
    skinned: usize,
}

impl<'a, 'i> ColladaScene<'a, 'i> {
    /// `scene_from_file`: metres by `<unit>`, z up by `<up_axis>` (y where it is not stated).
    fn axes_and_unit(&mut self, up_axis: UpAxis) -> Result<Affine, DecodeError> {
        let asset = element(self.root, "asset");
        let mut map = Affine::IDENTITY;
        if let Some(unit) = asset.and_then(|a| element(a, "unit")) {
            let text = unit.attribute("meter").unwrap_or("1");
            let metres: f64 = text.trim().parse().unwrap_or(f64::NAN);
            if !metres.is_normal() || metres < 0.0 {
                return Err(malformed(unit, excerpt(text), "a length of the unit in metres"));
            }
            if metres.to_bits() != 1f64.to_bits() {
                self.builder.note(format!(
                    "lengths were multiplied by {metres}, the file's unit in metres"
                ));
                map = Affine::scale(DVec3::splat(metres));
            }
        }
        let stated = asset.and_then(|a| element(a, "up_axis"));
        let axis = stated.and_then(|node| node.text()).map_or("Y_UP", str::trim);
        let turn = match axis {
            "Z_UP" => return Ok(map),
            "Y_UP" => Affine::columns(DVec3::X, DVec3::Z, DVec3::NEG_Y),
            "X_UP" => Affine::columns(DVec3::Z, DVec3::Y, DVec3::NEG_X),
            other => {
                let node = stated.unwrap_or(self.root);
                return Err(malformed(node, excerpt(other), "'X_UP', 'Y_UP' or 'Z_UP'"));
            }
        };
        if up_axis == UpAxis::AsFiled {
            return Ok(map);
        }
        self.builder.note(format!("the mesh was turned: the file says {axis}, here z is up"));
        Ok(turn.compose(&map))
    }

    /// The scene that the file instances, else its first.
    fn visual_scene(&self) -> Result<Option<Node<'a, 'i>>, DecodeError> {
        let instance =
            element(self.root, "scene").and_then(|s| element(s, "instance_visual_scene"));
        if let Some(instance) = instance {
            return self.target(instance, "library_visual_scenes", "visual_scene").map(Some);
        }
        let library = element(self.root, "library_visual_scenes");
        Ok(library.and_then(|library| element(library, "visual_scene")))
    }

    /// The element that an instance's `url` names.
    fn target(
        &self,
        instance: Node<'a, 'i>,
        library: &'static str,
        kind: &'static str,
    ) -> Result<Node<'a, 'i>, DecodeError> {
        let url = instance.attribute("url").unwrap_or_default();
        self.find(url, library, kind)
            .ok_or_else(|| malformed(instance, format!("the url {}", excerpt(url)), kind))
    }

    /// The element of a kind, anywhere in the libraries of a name, that an address names.
    fn find(
        &self,
        address: &str,
        library: &'static str,
        kind: &'static str,
    ) -> Option<Node<'a, 'i>> {
        let id = id_of(address);
        elements(self.root, library)
            .flat_map(|library| library.descendants())
            .find(|node| node.tag_name().name() == kind && node.attribute("id") == Some(id))
    }

    fn walk(
        &mut self,
        node: Node<'a, 'i>,
        outer: &Affine,
        depth: usize,
    ) -> Result<(), DecodeError> {
        self.count_visit(node)?;
        if depth > MAX_DEPTH {
            let found = format!("nodes nested deeper than {MAX_DEPTH}");
            return Err(malformed(node, found, "a tree of nodes without cycles"));
        }
        let mut scene_from_node = *outer;
        for child in node.children().filter(Node::is_element) {
            if let Some(step) = transform::read(child)? {
                scene_from_node = scene_from_node.compose(&step);
            }
        }
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "node" => self.walk(child, &scene_from_node, depth + 1)?,
                "instance_node" => {
                    // The target may lie in a library or elsewhere in the scene.
                    let target = self
                        .target(child, "library_nodes", "node")
                        .or_else(|_| self.target(child, "library_visual_scenes", "node"))?;
                    self.walk(target, &scene_from_node, depth + 1)?;
                }
                "instance_geometry" => {
                    let geometry = self.target(child, "library_geometries", "geometry")?;
                    self.add_geometry(geometry, &scene_from_node)?;
                }
                "instance_controller" => self.add_skin(child, &scene_from_node)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Nodes that instance nodes multiply: a short file must not keep a reader for ever.
    fn count_visit(&mut self, node: Node<'a, 'i>) -> Result<(), DecodeError> {
        self.visits += 1;
        if self.visits <= MAX_VISITS {
            return Ok(());
        }
        let found = format!("more than {MAX_VISITS} nodes and geometries to show");
        Err(malformed(node, found, "fewer"))
    }

    /// The geometry under a skin, in its bind shape.
    fn add_skin(&mut self, instance: Node<'a, 'i>, outer: &Affine) -> Result<(), DecodeError> {
        let controller = self.target(instance, "library_controllers", "controller")?;
        let Some(skin) = element(controller, "skin") else { return Ok(()) };
        let source = skin.attribute("source").unwrap_or_default();
        let geometry = self.find(source, "library_geometries", "geometry").ok_or_else(|| {
            malformed(skin, format!("the source {}", excerpt(source)), "a geometry")
        })?;
        let bind = match element(skin, "bind_shape_matrix") {
            Some(matrix) => transform::matrix(matrix)?,
            None => Affine::IDENTITY,
        };
        self.skinned += 1;
        self.add_geometry(geometry, &outer.compose(&bind))
    }

    fn add_geometry(
        &mut self,
        node: Node<'a, 'i>,
        scene_from_mesh: &Affine,
    ) -> Result<(), DecodeError> {
        self.count_visit(node)?;
        let Some(mesh) = element(node, "mesh") else {
            self.skipped += 1;
            return Ok(());
        };
        let geometry = Geometry::read(mesh)?;
        self.skipped += geometry.skipped;
        let first = self.builder.vertex_count() as u32;
        for (vertex, &p) in geometry.positions.iter().enumerate() {
            let place = || {
                let id = node.attribute("id").unwrap_or_default();
                Place::Element(format!("geometry {id:?}, vertex {vertex} (numbered from 0)"))
            };
            self.builder.vertex(scene_from_mesh.apply(p), place)?;
        }
        for (polygon, mut corners) in geometry.polygons.into_iter().enumerate() {
            if scene_from_mesh.mirrors() {
                corners[1..].reverse();
            }
            corners.iter_mut().for_each(|corner| *corner += first);
            // Finding its line costs a pass over the file.
            self.builder.polygon(&corners, || {
                let id = node.attribute("id").unwrap_or_default();
                Place::Element(format!("geometry {id:?}, polygon {polygon} (numbered from 0)"))
            });
        }
        Ok(())
    }

    fn finish(mut self) -> Result<MeshFile, DecodeError> {
        if self.skipped > 0 {
            let groups = counted(self.skipped, "group");
            let were = if self.skipped == 1 { "was" } else { "were" };
            let note =
                format!("{groups} of points, lines, splines or holed polygons {were} skipped");
            self.builder.remark(note.clone());
            self.builder.note(note);
        }
        if self.skinned > 0 {
            self.builder.note(match self.skinned {
                1 => "one skin was read in its bind shape".to_owned(),
                n => format!("{n} skins were read in their bind shape"),
            });
        }
        self.builder.finish()
    }
}
