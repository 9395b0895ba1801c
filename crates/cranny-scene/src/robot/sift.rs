//! A URDF file's text, reduced to what is read here and looked through element by element, since
//! the URDF reader names no place: what is wrong is refused with its line, what is harmless is
//! mended and noted.
//!
//! Kept are links with `inertial`, `visual` (its colour too) and `collision`, and joints. All else
//! (textures, transmissions, sensors, extensions of simulators) goes, right or wrong.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

use roxmltree::{Document, Error, Node};

use super::RobotError;
use crate::xml::nested_beyond;

/// XML elements nest at most so deep; URDF needs five. Deeper, and the recursive readers beneath
/// could exhaust the stack.
const MAX_DEPTH: usize = 64;

/// Prefixes without a namespace that are mended; more, and the text is no URDF of people.
const MAX_PREFIXES: usize = 32;

const JOINT_TYPES: [&str; 7] =
    ["fixed", "revolute", "continuous", "prismatic", "planar", "floating", "spherical"];

/// The reduced text, and what is known of its elements.
#[derive(Debug, Default)]
pub(super) struct Sifted {
    /// URDF that holds nothing but what is read.
    pub(super) text: String,
    pub(super) notes: Vec<String>,
    /// Lines of links and of joints, by name; of several of one name that of the last.
    pub(super) lines: [BTreeMap<String, u32>; 2],
    /// Links whose `inertial` has a mass and a tensor.
    pub(super) weighed: Vec<String>,
    /// Links whose `inertial` has a mass.
    pub(super) massive: BTreeSet<String>,
    /// Joints that have a `limit` with bounds.
    pub(super) bounded: Vec<String>,
    /// Whether elements of xacro were left in it.
    pub(super) xacro: bool,
}

/// # Errors
///
/// [`RobotError::Xml`]: no well-formed XML, no robot, or an element that cannot be meant.
pub(super) fn sift(path: &Path, text: &str) -> Result<Sifted, RobotError> {
    check_depth(path, text)?;
    let mut sifted = Sifted::default();
    let bound = bind_prefixes(text, &mut sifted.notes);
    let document = Document::parse(&bound).map_err(|error| malformed(path, &error))?;
    Sifter { path, document: &document, sifted: &mut sifted }.robot()?;
    Ok(sifted)
}

fn check_depth(path: &Path, text: &str) -> Result<(), RobotError> {
    let Some(at) = nested_beyond(text, MAX_DEPTH) else { return Ok(()) };
    let before = &text[..at];
    let line = 1 + before.matches('\n').count() as u32;
    let column = 1 + before.rsplit('\n').next().unwrap_or_default().chars().count() as u32;
    let problem = format!("elements are nested deeper than {MAX_DEPTH}: this is no URDF robot.");
    Err(RobotError::Xml { path: path.to_owned(), line, column, problem })
}

fn malformed(path: &Path, error: &Error) -> RobotError {
    let at = error.pos();
    let problem = format!("not well-formed XML ({error}). Correct it or export the robot again.");
    RobotError::Xml { path: path.to_owned(), line: at.row, column: at.col, problem }
}

/// Binds prefixes that the text uses without a namespace, as xacro leaves them.
fn bind_prefixes(text: &str, notes: &mut Vec<String>) -> String {
    let mut bound = text.to_owned();
    for _ in 0..MAX_PREFIXES {
        let Err(Error::UnknownNamespace(prefix, at)) = Document::parse(&bound) else { break };
        // At the end of the root's name: its first attributes follow.
        let Some(open) = bound.find("<robot") else { break };
        let name_end = open + "<robot".len();
        bound.insert_str(name_end, &format!(" xmlns:{prefix}=\"urn:unbound:{prefix}\""));
        notes.push(format!(
            "line {}: the prefix {prefix:?} is bound to no namespace; what bears it is ignored",
            at.row
        ));
    }
    bound
}

struct Sifter<'a, 'input> {
    path: &'a Path,
    document: &'a Document<'input>,
    sifted: &'a mut Sifted,
}

/// An attribute that a URDF element may have.
#[derive(Clone, Copy)]
struct Attribute {
    name: &'static str,
    /// How many numbers it holds; 0 for text.
    numbers: usize,
    required: bool,
}

const fn number(name: &'static str) -> Attribute {
    Attribute { name, numbers: 1, required: true }
}

const fn optional(name: &'static str, numbers: usize) -> Attribute {
    Attribute { name, numbers, required: false }
}

const fn text_of(name: &'static str) -> Attribute {
    Attribute { name, numbers: 0, required: true }
}

const INERTIA: [Attribute; 6] =
    [number("ixx"), number("ixy"), number("ixz"), number("iyy"), number("iyz"), number("izz")];

impl<'a, 'input> Sifter<'a, 'input> {
    fn line(&self, node: Node<'a, 'input>) -> u32 {
        self.document.text_pos_at(node.range().start).row
    }

    fn refuse(&self, node: Node<'a, 'input>, problem: String) -> RobotError {
        let at = self.document.text_pos_at(node.range().start);
        RobotError::Xml { path: self.path.to_owned(), line: at.row, column: at.col, problem }
    }

    fn note(&mut self, node: Node<'a, 'input>, what: String) {
        let line = self.line(node);
        self.sifted.notes.push(format!("line {line}: {what}"));
    }

    fn robot(&mut self) -> Result<(), RobotError> {
        let root = self.document.root_element();
        if root.tag_name().name() != "robot" {
            let problem = format!(
                "found the element {:?}, expected 'robot': this is no URDF file.",
                root.tag_name().name()
            );
            return Err(self.refuse(root, problem));
        }
        let name = root.attribute("name").unwrap_or("robot");
        // Writing to a string cannot fail.
        let _ = write!(self.sifted.text, "<robot name=\"{}\">", escaped(name));
        let elements: Vec<_> = root.children().filter(Node::is_element).collect();
        if let Some(left) = elements.iter().find(|node| is_xacro(**node)) {
            let what = format!(
                "the element {:?} is xacro's and is ignored: run xacro if it should make links or joints",
                left.tag_name().name()
            );
            self.note(*left, what);
            self.sifted.xacro = true;
        }
        for node in elements.into_iter().filter(|node| !is_xacro(*node)) {
            match node.tag_name().name() {
                "link" => self.link(node)?,
                "joint" => self.joint(node)?,
                _ => {}
            }
        }
        self.sifted.text.push_str("</robot>");
        Ok(())
    }

    fn link(&mut self, node: Node<'a, 'input>) -> Result<(), RobotError> {
        let name = self.name(node, "link")?;
        let line = self.line(node);
        self.sifted.lines[0].insert(name.to_owned(), line);
        let _ = write!(self.sifted.text, "<link name=\"{}\">", escaped(name));
        for child in node.children().filter(Node::is_element) {
            let what = format!("link {name:?}");
            match child.tag_name().name() {
                "inertial" => self.inertial(child, name)?,
                "collision" => self.shape(child, &what, true)?,
                "visual" => self.shape(child, &what, false)?,
                _ => {}
            }
        }
        self.sifted.text.push_str("</link>");
        Ok(())
    }

    fn inertial(&mut self, node: Node<'a, 'input>, link: &str) -> Result<(), RobotError> {
        let what = format!("link {link:?}");
        let Some(mass) = child(node, "mass") else {
            self.note(node, format!("{what} has an element 'inertial' without a mass: ignored"));
            return Ok(());
        };
        self.sifted.massive.insert(link.to_owned());
        self.sifted.text.push_str("<inertial>");
        self.origin(node, &what)?;
        self.element(mass, &what, &[number("value")])?;
        match child(node, "inertia") {
            Some(inertia) => {
                self.element(inertia, &what, &INERTIA)?;
                self.sifted.weighed.push(link.to_owned());
            }
            None => {
                let zeros =
                    "<inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>";
                self.sifted.text.push_str(zeros);
            }
        }
        self.sifted.text.push_str("</inertial>");
        Ok(())
    }

    /// A collision or visual element. What is wrong with a drawn one leaves it out.
    fn shape(
        &mut self,
        node: Node<'a, 'input>,
        what: &str,
        collides: bool,
    ) -> Result<(), RobotError> {
        let before = self.sifted.text.len();
        match self.shape_of(node, what) {
            Ok(()) => Ok(()),
            Err(error) if collides => Err(error),
            Err(error) => {
                self.sifted.text.truncate(before);
                self.sifted.notes.push(format!("a visual element was left out: {error}"));
                Ok(())
            }
        }
    }

    fn shape_of(&mut self, node: Node<'a, 'input>, what: &str) -> Result<(), RobotError> {
        let element = node.tag_name().name();
        let _ = write!(self.sifted.text, "<{element}>");
        self.origin(node, what)?;
        let geometry = child(node, "geometry").ok_or_else(|| {
            let problem = format!(
                "{what} has an element {element:?} without a geometry. Add one, or remove it."
            );
            self.refuse(node, problem)
        })?;
        self.sifted.text.push_str("<geometry>");
        let kinds: [(&str, &[Attribute]); 5] = [
            ("box", &[Attribute { name: "size", numbers: 3, required: true }]),
            ("sphere", &[number("radius")]),
            ("cylinder", &[number("radius"), number("length")]),
            ("capsule", &[number("radius"), number("length")]),
            ("mesh", &[text_of("filename"), optional("scale", 3)]),
        ];
        let known = geometry.children().filter(Node::is_element).find_map(|shape| {
            let kind = kinds.iter().find(|(kind, _)| *kind == shape.tag_name().name())?;
            Some((shape, kind.1))
        });
        let Some((shape, attributes)) = known else {
            let found: Vec<_> = geometry
                .children()
                .filter(Node::is_element)
                .map(|node| node.tag_name().name())
                .collect();
            let problem = format!(
                "{what} has a geometry of {}. Use a box, sphere, cylinder, capsule or mesh.",
                if found.is_empty() { "nothing".to_owned() } else { format!("{found:?}") }
            );
            return Err(self.refuse(geometry, problem));
        };
        self.element(shape, what, attributes)?;
        self.sifted.text.push_str("</geometry>");
        if element == "visual" {
            self.material(node, what);
        }
        let _ = write!(self.sifted.text, "</{element}>");
        Ok(())
    }

    /// The colour of a visual element, its own or that of the material that it names.
    fn material(&mut self, node: Node<'a, 'input>, what: &str) {
        let Some(material) = child(node, "material") else { return };
        let name = material.attribute("name").unwrap_or_default();
        let named = || {
            let all = self.document.descendants().filter(|node| node.has_tag_name("material"));
            let of_name = all.filter(|node| node.attribute("name") == Some(name));
            of_name.filter_map(|node| child(node, "color")).next()
        };
        let Some(color) = child(material, "color").or_else(named) else { return };
        let rgba = color.attribute("rgba").unwrap_or_default();
        let channels: Vec<f64> = rgba.split_whitespace().flat_map(str::parse).collect();
        if channels.len() == 4 && channels.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            let name = escaped(name);
            let _ = write!(
                self.sifted.text,
                "<material name=\"{name}\"><color rgba=\"{rgba}\"/></material>"
            );
        } else {
            self.note(color, format!("{what} has the color {rgba:?}, which is not four numbers from 0 to 1: it is drawn without"));
        }
    }

    fn joint(&mut self, node: Node<'a, 'input>) -> Result<(), RobotError> {
        let name = self.name(node, "joint")?;
        let line = self.line(node);
        self.sifted.lines[1].insert(name.to_owned(), line);
        let what = format!("joint {name:?}");
        let kind = node.attribute("type").unwrap_or_default();
        if !JOINT_TYPES.contains(&kind) {
            let problem = format!(
                "{what} has the type {kind:?}. Use one of {}.",
                JOINT_TYPES[..6].join(", ")
            );
            return Err(self.refuse(node, problem));
        }
        let _ = write!(self.sifted.text, "<joint name=\"{}\" type=\"{kind}\">", escaped(name));
        self.origin(node, &what)?;
        for end in ["parent", "child"] {
            let Some(found) = child(node, end) else {
                let problem = format!("{what} has no element {end:?}. Add <{end} link=\"…\"/>.");
                return Err(self.refuse(node, problem));
            };
            self.element(found, &what, &[text_of("link")])?;
        }
        if let Some(axis) = child(node, "axis") {
            self.element(axis, &what, &[optional("xyz", 3)])?;
        }
        if let Some(limit) = child(node, "limit") {
            self.limit(limit, name)?;
        }
        if let Some(dynamics) = child(node, "dynamics") {
            self.element(dynamics, &what, &[optional("damping", 1), optional("friction", 1)])?;
        }
        if let Some(mimic) = child(node, "mimic") {
            let attributes = [text_of("joint"), optional("multiplier", 1), optional("offset", 1)];
            self.element(mimic, &what, &attributes)?;
        }
        self.sifted.text.push_str("</joint>");
        Ok(())
    }

    /// A limit without bounds bounds nothing.
    fn limit(&mut self, node: Node<'a, 'input>, joint: &str) -> Result<(), RobotError> {
        let what = format!("joint {joint:?}");
        let has = |name| node.attribute(name).is_some_and(|value| !value.trim().is_empty());
        if has("lower") || has("upper") {
            self.sifted.bounded.push(joint.to_owned());
        }
        let _ = write!(self.sifted.text, "<limit");
        for name in ["lower", "upper", "effort"] {
            self.attribute(node, &what, optional(name, 1))?;
        }
        if has("velocity") {
            self.attribute(node, &what, number("velocity"))?;
        } else {
            self.sifted.text.push_str(" velocity=\"inf\"");
        }
        self.sifted.text.push_str("/>");
        Ok(())
    }

    fn origin(&mut self, node: Node<'a, 'input>, what: &str) -> Result<(), RobotError> {
        let Some(origin) = child(node, "origin") else { return Ok(()) };
        self.element(origin, what, &[optional("xyz", 3), optional("rpy", 3)])
    }

    fn name(&self, node: Node<'a, 'input>, element: &str) -> Result<&'a str, RobotError> {
        node.attribute("name").ok_or_else(|| {
            self.refuse(node, format!("a {element} has no name. Add the attribute 'name'."))
        })
    }

    /// Copies an element with the attributes that it may have.
    fn element(
        &mut self,
        node: Node<'a, 'input>,
        what: &str,
        attributes: &[Attribute],
    ) -> Result<(), RobotError> {
        let _ = write!(self.sifted.text, "<{}", node.tag_name().name());
        for &attribute in attributes {
            self.attribute(node, what, attribute)?;
        }
        self.sifted.text.push_str("/>");
        Ok(())
    }

    fn attribute(
        &mut self,
        node: Node<'a, 'input>,
        what: &str,
        Attribute { name, numbers, required }: Attribute,
    ) -> Result<(), RobotError> {
        let element = node.tag_name().name();
        let value = node.attribute(name).map(str::trim).filter(|value| !value.is_empty());
        let Some(value) = value else {
            if required {
                let problem = format!(
                    "{what}: its element {element:?} has no attribute {name:?}. Add it, or remove the element."
                );
                return Err(self.refuse(node, problem));
            }
            if node.attribute(name).is_some() {
                self.note(node, format!("{what}: the attribute {name:?} is empty and ignored"));
            }
            return Ok(());
        };
        if numbers > 0 {
            let parts: Vec<_> = value.split_whitespace().collect();
            let wrong = parts.len() != numbers || parts.iter().any(|p| p.parse::<f64>().is_err());
            if wrong {
                let advice = if value.contains("${") {
                    "This is xacro, not URDF: run xacro on the file first"
                } else {
                    "Correct it"
                };
                let expected =
                    if numbers == 1 { "a number".to_owned() } else { format!("{numbers} numbers") };
                let problem = format!(
                    "{what}: the attribute {name:?} of its element {element:?} is {value:?}, expected {expected}. {advice}."
                );
                return Err(self.refuse(node, problem));
            }
        }
        let _ = write!(self.sifted.text, " {name}=\"{}\"", escaped(value));
        Ok(())
    }
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == name)
}

fn is_xacro(node: Node<'_, '_>) -> bool {
    node.tag_name().namespace().is_some_and(|namespace| namespace.contains("xacro"))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
