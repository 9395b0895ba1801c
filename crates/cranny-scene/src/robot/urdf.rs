//! From URDF to a [`Robot`].

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_primitives::{Ball, Capsule, Cylinder, Primitive};
use cranny_shapes::{Cuboid, Sphere};
use cranny_world::description::{BodyColor, JointKind, Mimic, Resistance, StatedMass};
use urdf_rs::{Geometry, Joint, JointType, Link, Material};

use super::cylinder::{SEGMENTS, capsule, cylinder};
use super::kinematics::roll_pitch_yaw;
use super::sift::{Sifted, sift};
use super::{Robot, RobotError, RobotJoint, RobotLink, package};
use crate::mesh_file::{UpAxis, read_mesh_with};
use crate::text_file::{read_text, without_mark};

/// Size of the smallest body that an inertia can be of, metres. Smaller: what exporters leave of 0
/// (1e-19 kg m^2 beside 1 kg) is taken for an inertia, and the solver blows up; larger: screws lose
/// theirs.
const SPECK: f64 = 1e-4;

/// Diagonal of a link's mesh above which it may be in millimetres, metres. Smaller: cranes are
/// taken for it; larger: fingers are not.
const LARGEST_LINK: f64 = 20.0;

/// Reads a robot from a URDF file.
///
/// `package://` addresses are looked for going up from the file; COLLADA meshes keep their axes as
/// filed, as other robot tools do; boxes, cylinders, spheres and capsules become inscribed meshes
/// of 32 sides, and the latter three are [primitives](RobotLink::primitive) where they are all that
/// collides of a link. Meshes scaled by a negative factor are turned, so that outside stays
/// outside.
///
/// # Errors
///
/// [`RobotError`]: the file or one of its collision meshes is missing or broken; links that do not
/// form a tree; an element or a number that cannot be meant, with its line. What is harmless is
/// mended, and a note says so.
pub fn read_robot(path: &Path) -> Result<Robot, RobotError> {
    let unreadable = |source| RobotError::Unreadable { path: path.to_owned(), source };
    let text = read_text(path).map_err(unreadable)?;
    let text = without_mark(&text);
    let sifted = sift(path, text)?;
    let urdf = urdf_rs::read_from_string(&sifted.text).map_err(|error| {
        let message = error.to_string();
        RobotError::Urdf { path: path.to_owned(), message }
    })?;
    // Packages lie above the file, wherever the working directory is.
    let absolute = fs::canonicalize(path).map_err(unreadable)?;
    let mut reader = Reader {
        path: path.to_owned(),
        absolute,
        meshes: BTreeMap::new(),
        notes: sifted.notes.clone(),
        sifted,
        installed: package::Installed::from_environment(),
        files: vec![path.to_owned()],
        undrawn: Vec::new(),
    };
    let links = urdf.links.iter().map(|link| reader.link(link)).collect::<Result<Vec<_>, _>>()?;
    reader.note_undrawn();
    let index_of = reader.unique("link", links.iter().map(|link| link.name.as_str()))?;
    reader.unique("joint", urdf.joints.iter().map(|joint| joint.name.as_str()))?;
    let mut joints = urdf
        .joints
        .iter()
        .map(|joint| reader.joint(joint, &index_of))
        .collect::<Result<Vec<_>, _>>()?;
    reader.check_mimics(&mut joints)?;
    let (root, order) = reader.tree(&links, &joints)?;
    let Reader { notes, files, .. } = reader;
    Ok(Robot { name: urdf.name, links, joints, root, notes, files, order })
}

struct Reader {
    path: PathBuf,
    absolute: PathBuf,
    /// Mesh files read, by path.
    meshes: BTreeMap<PathBuf, Arc<Mesh>>,
    notes: Vec<String>,
    files: Vec<PathBuf>,
    sifted: Sifted,
    installed: package::Installed,
    /// Links and the visual meshes of theirs that were not found.
    undrawn: Vec<(String, String)>,
}

impl Reader {
    fn line(&self, element: &str, name: &str) -> Option<u32> {
        self.sifted.lines[usize::from(element == "joint")].get(name).copied()
    }

    /// A sentence about a link or joint.
    fn note(&mut self, element: &str, name: &str, what: &str) {
        let line = self.line(element, name).map_or(String::new(), |line| format!("line {line}: "));
        self.notes.push(format!("{line}{element} {name:?} {what}"));
    }

    /// A sentence about all visual meshes that were not found.
    fn note_undrawn(&mut self) {
        match &std::mem::take(&mut self.undrawn)[..] {
            [] => {}
            [(link, uri)] => {
                let what = format!("is drawn without the mesh {uri:?}, which was not found");
                self.note("link", link, &what);
            }
            all @ [(link, uri), ..] => self.notes.push(format!(
                "{} visual meshes were not found, and their links are drawn without them: the first is {uri:?} of link {link:?}",
                all.len()
            )),
        }
    }

    fn error(&self, element: &'static str, name: &str, problem: String) -> RobotError {
        let line = self.line(element, name);
        RobotError::Element {
            path: self.path.clone(),
            line,
            element,
            name: name.to_owned(),
            problem,
        }
    }

    fn unique<'a>(
        &self,
        element: &'static str,
        names: impl Iterator<Item = &'a str>,
    ) -> Result<BTreeMap<String, usize>, RobotError> {
        let mut index_of = BTreeMap::new();
        for (index, name) in names.enumerate() {
            if index_of.insert(name.to_owned(), index).is_some() {
                let problem = "two of them have this name. Rename one.".to_owned();
                return Err(self.error(element, name, problem));
            }
        }
        Ok(index_of)
    }

    fn link(&mut self, link: &Link) -> Result<RobotLink, RobotError> {
        let mut collision = None;
        for element in &link.collision {
            let mesh = self.geometry(&link.name, &element.geometry)?;
            collision = Some(self.placed(link, &element.origin, mesh, collision)?);
        }
        let primitive = match &link.collision[..] {
            [only] => primitive(&only.geometry, &only.origin),
            _ => None,
        };
        let (mut visual, mut color): (Option<Arc<Mesh>>, _) = (None, None);
        let mut covered = 0.0;
        for element in &link.visual {
            let drawn = self
                .geometry(&link.name, &element.geometry)
                .and_then(|mesh| self.placed(link, &element.origin, mesh, visual.clone()));
            match drawn {
                Ok(mesh) => {
                    let surface = surface(&mesh) - visual.as_deref().map_or(0.0, surface);
                    visual = Some(mesh);
                    let own = element.material.as_ref().and_then(color_of);
                    if own.is_some() && surface > covered {
                        (color, covered) = (own, surface);
                    }
                }
                // Where it was looked for matters for what collides.
                Err(RobotError::MeshNotFound { uri, .. }) => {
                    self.undrawn.push((link.name.clone(), uri));
                }
                Err(error) => self.notes.push(format!("a visual element was left out: {error}")),
            }
        }
        let mass = self.mass(link);
        let inertial = mass.map(|mass| self.inertial(link, mass)).transpose()?.flatten();
        Ok(RobotLink {
            name: link.name.clone(),
            collision,
            primitive,
            visual,
            color,
            mass,
            inertial,
        })
    }

    /// The mass that a link states; one that no body has is noted and left out.
    fn mass(&mut self, link: &Link) -> Option<f64> {
        let mass = link.inertial.mass.value;
        let possible = (mass.is_finite() && mass > 0.0).then_some(mass);
        if possible.is_none() && self.sifted.massive.contains(&link.name) {
            let what = format!(
                "states the mass {mass}, which is not above 0: mass and inertia are those of its collision geometry at the robot's density, or of nothing where it has none"
            );
            self.note("link", &link.name, &what);
        }
        possible
    }

    /// What the link's `inertial` says, in the link's frame. A tensor that no body can have is
    /// noted and left out.
    fn inertial(&mut self, link: &Link, mass: f64) -> Result<Option<StatedMass>, RobotError> {
        if !self.sifted.weighed.contains(&link.name) {
            self.note("link", &link.name, "states a mass and no inertia");
            return Ok(None);
        }
        let origin = pose(&link.inertial.origin).map_err(|problem| {
            self.error("link", &link.name, format!("the origin of its inertial {problem}"))
        })?;
        let i = &link.inertial.inertia;
        let tensor = DMat3::from_cols(
            DVec3::new(i.ixx, i.ixy, i.ixz),
            DVec3::new(i.ixy, i.iyy, i.iyz),
            DVec3::new(i.ixz, i.iyz, i.izz),
        );
        if !is_possible(&tensor, mass) {
            let what = format!(
                "states the inertia ixx={} ixy={} ixz={} iyy={} iyz={} izz={}, which no body of {mass} kg has (it must be positive definite, and not of a point): that of its shape is used",
                i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz
            );
            self.note("link", &link.name, &what);
            return Ok(None);
        }
        let turn = DMat3::from_quat(origin.rotation);
        let inertia = turn * tensor * turn.transpose();
        Ok(Some(StatedMass { mass, center: origin.translation, inertia }))
    }

    /// An element's mesh in the link's frame, joined to those before it.
    fn placed(
        &self,
        link: &Link,
        origin: &urdf_rs::Pose,
        mesh: Arc<Mesh>,
        before: Option<Arc<Mesh>>,
    ) -> Result<Arc<Mesh>, RobotError> {
        let refuse = |problem: String| self.error("link", &link.name, problem);
        let pose = pose(origin).map_err(|problem| refuse(format!("its origin {problem}")))?;
        let posed = if pose == Pose::IDENTITY {
            mesh
        } else {
            let link_from_mesh = pose.world_from_body();
            let vertices = mesh.vertices().iter().map(|&p| link_from_mesh.apply(p)).collect();
            let posed = Mesh::new(vertices, mesh.faces().to_vec());
            Arc::new(posed.map_err(|error| refuse(format!("posed by its origin: {error}")))?)
        };
        Ok(match before {
            Some(before) => Arc::new(Mesh::clone(&before).joined(&posed)),
            None => posed,
        })
    }

    fn geometry(&mut self, link: &str, geometry: &Geometry) -> Result<Arc<Mesh>, RobotError> {
        let built = match geometry {
            Geometry::Mesh { filename, scale } => {
                let scale = scale.map_or(DVec3::ONE, |s| DVec3::from_array(s.0));
                return self.mesh(link, filename, scale);
            }
            Geometry::Box { size } => Cuboid { size: size.0 }.build().map_err(|e| e.to_string()),
            Geometry::Sphere { radius } => {
                let sphere = Sphere { radius: *radius, segments: SEGMENTS, rings: SEGMENTS / 2 };
                sphere.build().map_err(|e| e.to_string())
            }
            Geometry::Cylinder { radius, length } => round(*radius, *length, cylinder),
            Geometry::Capsule { radius, length } => round(*radius, *length, capsule),
        };
        built.map(Arc::new).map_err(|problem| self.error("link", link, problem))
    }

    fn mesh(&mut self, link: &str, uri: &str, scale: DVec3) -> Result<Arc<Mesh>, RobotError> {
        let path = package::find(&self.absolute, uri, &self.installed).map_err(|tried| {
            RobotError::MeshNotFound {
                path: self.path.clone(),
                line: self.line("link", link),
                link: link.to_owned(),
                uri: uri.to_owned(),
                tried,
            }
        })?;
        let filed = match self.meshes.get(&path) {
            Some(mesh) => Arc::clone(mesh),
            None => {
                let read =
                    read_mesh_with(&path, UpAxis::AsFiled).map_err(|source| RobotError::Mesh {
                        path: self.path.clone(),
                        line: self.line("link", link),
                        link: link.to_owned(),
                        source: Box::new(source),
                    })?;
                let mesh = Arc::new(read.mesh);
                self.files.push(path.clone());
                self.meshes.insert(path, Arc::clone(&mesh));
                mesh
            }
        };
        if scale == DVec3::ONE {
            self.note_of_size(link, uri, &filed);
            return Ok(filed);
        }
        if scale.x * scale.y * scale.z == 0.0 || !scale.is_finite() {
            let problem =
                format!("the scale {scale} of mesh {uri:?} flattens it. Use factors other than 0.");
            return Err(self.error("link", link, problem));
        }
        let scaled = filed.scaled(scale);
        scaled
            .map(Arc::new)
            .map_err(|error| self.error("link", link, format!("mesh {uri:?}, scaled: {error}")))
    }

    /// That a mesh may be in millimetres.
    fn note_of_size(&mut self, link: &str, uri: &str, mesh: &Mesh) {
        let size = mesh.bounds().diagonal();
        let what = format!(
            "has the mesh {uri:?}, whose box is {size:.0} m across. Where it is in millimetres, give it scale=\"0.001 0.001 0.001\""
        );
        let is_known = self.notes.iter().any(|note| note.contains(&what));
        if size > LARGEST_LINK && !is_known {
            self.note("link", link, &what);
        }
    }

    fn joint(
        &self,
        joint: &Joint,
        index_of: &BTreeMap<String, usize>,
    ) -> Result<RobotJoint, RobotError> {
        let refuse = |problem: String| self.error("joint", &joint.name, problem);
        let link = |name: &str| {
            let index = index_of.get(name).copied();
            index.ok_or_else(|| {
                refuse(format!("it names the link {name:?}, which is not in the file."))
            })
        };
        let parent_from_joint =
            pose(&joint.origin).map_err(|problem| refuse(format!("its origin {problem}")))?;
        let axis = || {
            let axis = DVec3::from_array(joint.axis.xyz.0);
            let unit = axis.is_finite().then(|| axis.try_normalize()).flatten();
            unit.ok_or_else(|| refuse(format!("its axis {axis} has no direction.")))
        };
        let bounded = self.sifted.bounded.contains(&joint.name);
        let limits = || {
            if !bounded {
                return Ok(None);
            }
            let [lower, upper] = [joint.limit.lower, joint.limit.upper];
            if lower <= upper {
                // Infinite limits are how URDF 1.2 says 'none'.
                Ok((lower.is_finite() || upper.is_finite()).then_some([lower, upper]))
            } else {
                Err(refuse(format!(
                    "its lower limit {lower} is not below its upper limit {upper}."
                )))
            }
        };
        let kind = match joint.joint_type {
            JointType::Fixed => JointKind::Fixed,
            JointType::Continuous => JointKind::Revolute { axis: axis()?, limits: None },
            JointType::Revolute => JointKind::Revolute { axis: axis()?, limits: limits()? },
            JointType::Prismatic => JointKind::Prismatic { axis: axis()?, limits: limits()? },
            JointType::Planar => JointKind::Planar { normal: axis()? },
            JointType::Floating => JointKind::Floating,
            JointType::Spherical => {
                return Err(refuse(
                    "its type is spherical, which URDF does not have. Use three continuous joints about x, y and z.".to_owned(),
                ));
            }
        };
        let mimic = joint.mimic.as_ref().map(|mimic| Mimic {
            joint: mimic.joint.clone(),
            multiplier: mimic.multiplier.unwrap_or(1.0),
            offset: mimic.offset.unwrap_or(0.0),
        });
        Ok(RobotJoint {
            name: joint.name.clone(),
            parent: link(&joint.parent.link)?,
            child: link(&joint.child.link)?,
            parent_from_joint,
            kind,
            mimic,
            resistance: resistance(joint),
            max_effort: most(joint.limit.effort),
            max_velocity: most(joint.limit.velocity),
        })
    }

    /// A leader moves, and follows nobody. One that does not exist leads nobody.
    fn check_mimics(&mut self, joints: &mut [RobotJoint]) -> Result<(), RobotError> {
        let names: BTreeSet<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        for joint in joints.iter_mut() {
            if let Some(mimic) = joint.mimic.take_if(|mimic| !names.contains(&mimic.joint)) {
                let what = format!(
                    "follows joint {:?}, which is not in the file: it moves by itself. Correct its element 'mimic'",
                    mimic.joint
                );
                self.note("joint", &joint.name, &what);
            }
        }
        let joints = &*joints;
        for joint in joints {
            let Some(mimic) = &joint.mimic else { continue };
            let leader = joints.iter().find(|other| other.name == mimic.joint);
            let problem = match leader {
                None => continue,
                Some(leader) if leader.mimic.is_some() => "which follows another joint itself",
                Some(leader) if !leader.has_position() => "which has no position",
                Some(_) if !(mimic.multiplier.is_finite() && mimic.offset.is_finite()) => {
                    "but its multiplier or offset is not a finite number"
                }
                Some(_) => continue,
            };
            let problem = format!(
                "it follows joint {:?}, {problem}. Correct its element 'mimic'.",
                mimic.joint
            );
            return Err(self.error("joint", &joint.name, problem));
        }
        Ok(())
    }

    /// The root, and the joints in an order that goes down from it.
    fn tree(
        &self,
        links: &[RobotLink],
        joints: &[RobotJoint],
    ) -> Result<(usize, Vec<usize>), RobotError> {
        let tree = |problem: String| RobotError::Tree { path: self.path.clone(), problem };
        let mut parent_joint = vec![None; links.len()];
        for (index, joint) in joints.iter().enumerate() {
            if let Some(other) = parent_joint[joint.child].replace(index) {
                let problem = format!(
                    "it is the child of joint {:?} and of joint {:?}. Links must form a tree: remove one of them.",
                    joints[other].name, joint.name
                );
                return Err(self.error("link", &links[joint.child].name, problem));
            }
        }
        let roots: Vec<usize> = (0..links.len()).filter(|&i| parent_joint[i].is_none()).collect();
        let root = match roots[..] {
            [root] => root,
            [] if links.is_empty() => {
                let advice = if self.sifted.xacro {
                    "It holds xacro elements: run xacro on it first."
                } else {
                    "Name a file that has some, or export this one again."
                };
                return Err(tree(format!("it has no links. {advice}")));
            }
            [] => return Err(self.cycle(0, &parent_joint, joints)),
            _ => {
                let names: Vec<_> = roots.iter().map(|&i| links[i].name.as_str()).collect();
                return Err(tree(format!(
                    "it has {} links without parent ({}); there must be one. Join the others to it.",
                    roots.len(),
                    names.join(", ")
                )));
            }
        };
        let mut reached = BTreeSet::from([root]);
        let mut order = Vec::with_capacity(joints.len());
        let mut queue = std::collections::VecDeque::from([root]);
        while let Some(link) = queue.pop_front() {
            for (index, joint) in joints.iter().enumerate().filter(|(_, j)| j.parent == link) {
                order.push(index);
                if reached.insert(joint.child) {
                    queue.push_back(joint.child);
                }
            }
        }
        match (0..links.len()).find(|link| !reached.contains(link)) {
            Some(lost) => Err(self.cycle(lost, &parent_joint, joints)),
            None => Ok((root, order)),
        }
    }

    /// The joints that lead in a circle, on the way up from a link that no root is above.
    fn cycle(
        &self,
        link: usize,
        parent_joint: &[Option<usize>],
        joints: &[RobotJoint],
    ) -> RobotError {
        let mut above: Vec<usize> = Vec::new();
        let mut at = link;
        let circle = loop {
            let Some(joint) = parent_joint[at] else { break &above[..] };
            if let Some(first) = above.iter().position(|&passed| passed == joint) {
                break &above[first..];
            }
            above.push(joint);
            at = joints[joint].parent;
        };
        let names: Vec<_> =
            circle.iter().rev().map(|&joint| format!("{:?}", joints[joint].name)).collect();
        let first = circle.last().map_or("", |&joint| joints[joint].name.as_str());
        let problem = format!(
            "the joints {} lead in a circle, but links and joints must form a tree. Take one of them out.",
            names.join(", ")
        );
        self.error("joint", first, problem)
    }
}

/// Area of all faces.
fn surface(mesh: &Mesh) -> f64 {
    let corners = |face: &[u32; 3]| face.map(|corner| mesh.vertices()[corner as usize]);
    let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
    mesh.faces().iter().map(|face| area(corners(face))).sum()
}

fn color_of(material: &Material) -> Option<BodyColor> {
    let [red, green, blue, _] = material.color.as_ref()?.rgba.0;
    BodyColor::of_shares([red, green, blue])
}

/// URDF says 0 where no limit is known.
fn most(limit: f64) -> Option<f64> {
    (limit > 0.0 && limit.is_finite()).then_some(limit)
}

fn resistance(joint: &Joint) -> Resistance {
    let at_least_0 = |value: f64| if value > 0.0 && value.is_finite() { value } else { 0.0 };
    joint.dynamics.as_ref().map_or(Resistance::default(), |dynamics| Resistance {
        damping: at_least_0(dynamics.damping),
        friction: at_least_0(dynamics.friction),
    })
}

/// Whether a body of a mass can have a tensor: positive definite by Sylvester's criterion, and as
/// of more than a [`SPECK`].
fn is_possible(m: &DMat3, mass: f64) -> bool {
    let (a, b, c) = (m.x_axis, m.y_axis, m.z_axis);
    let minors = [a.x * b.y - a.y * b.x, b.y * c.z - b.z * c.y, a.x * c.z - a.z * c.x];
    let determinant = a.dot(b.cross(c));
    if !(m.is_finite() && a.x > 0.0 && minors[0] > 0.0 && determinant > 0.0) {
        return false;
    }
    // At most the least moment, and at least a third of it.
    let least = determinant / minors.iter().sum::<f64>();
    least > mass * SPECK * SPECK
}

/// A sphere, cylinder or capsule as what it is, in the link's frame; `None` of other geometry. What
/// is wrong with its numbers was said as its mesh was made.
fn primitive(geometry: &Geometry, origin: &urdf_rs::Pose) -> Option<Primitive> {
    let (center, axis) = (DVec3::ZERO, DVec3::Z);
    let here: Primitive = match *geometry {
        Geometry::Sphere { radius } => Ball { center, radius }.into(),
        Geometry::Cylinder { radius, length } => {
            Cylinder { center, axis, half_height: 0.5 * length, radius, border: 0.0 }.into()
        }
        Geometry::Capsule { radius, length } => {
            let end = 0.5 * length * axis;
            Capsule { ends: [-end, end], radius }.into()
        }
        Geometry::Box { .. } | Geometry::Mesh { .. } => return None,
    };
    Some(here.moved(&pose(origin).ok()?.world_from_body()))
}

fn round(
    radius: f64,
    length: f64,
    build: fn(f64, f64) -> Result<Mesh, cranny_geometry::MeshError>,
) -> Result<Mesh, String> {
    if radius > 0.0 && length > 0.0 {
        return build(radius, length).map_err(|error| error.to_string());
    }
    Err(format!(
        "a round body of radius {radius} and length {length}: both must be greater than 0."
    ))
}

/// The pose that an `<origin>` says; where it says none, what is wrong with it.
fn pose(origin: &urdf_rs::Pose) -> Result<Pose, String> {
    let rpy = origin.rpy.0;
    if rpy.iter().any(|angle| !angle.is_finite()) {
        return Err(format!("has the rotation {rpy:?}, which is not finite. Correct it."));
    }
    // An untouched rotation stays the identity to the bit.
    let rotation = if rpy == [0.0; 3] { Pose::IDENTITY.rotation } else { roll_pitch_yaw(rpy) };
    Pose::checked(rotation, DVec3::from_array(origin.xyz.0))
        .map_err(|error| format!("is no pose: {error}. Correct it."))
}
