//! Geometry of bodies: generated, or read from files, scaled, mended and prepared, each once.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use cranny_exact::DVec3;
use cranny_geometry::{BuildError, BuildOptions, FindingKind, Mesh, Model, Repair, Report};
use cranny_primitives::{BodyShape, Primitive};
use cranny_shapes::primitive_mesh;

use super::assemble::Assembly;
use super::body_syntax::{RepairFile, ShapeFile, UnitsFile};
use super::primitive::PrimitiveFile;
use super::problem::{SceneError, SceneProblem};
use crate::mesh_file::{MeshFormat, is_saved_model, read_mesh};
use crate::text_file::remedy;

/// What collides of a body.
#[derive(Clone, Debug)]
pub(super) struct CollisionGeometry {
    pub(super) mesh: Arc<Mesh>,
    /// Prepared already: meshes of files are, since mending prepares them, and primitives.
    pub(super) shape: Option<BodyShape>,
}

impl CollisionGeometry {
    pub(super) fn model(&self) -> Option<&Model> {
        self.shape.as_ref().and_then(BodyShape::model)
    }

    pub(super) fn primitive(&self) -> Option<&Primitive> {
        self.shape.as_ref().and_then(BodyShape::primitive)
    }

    fn of_model(model: Model) -> Self {
        Self { mesh: Arc::new(model.mesh().clone()), shape: Some(model.into()) }
    }
}

impl Assembly<'_> {
    /// What collides, of a shape; made once.
    pub(super) fn geometry(
        &mut self,
        body: &str,
        shape: &ShapeFile,
    ) -> Result<CollisionGeometry, SceneError> {
        if let Some((_, known)) = self.shapes.iter().find(|(known, _)| known == shape) {
            return Ok(known.clone());
        }
        let geometry = match shape {
            ShapeFile::Primitive(primitive) => self.primitive(body, *primitive)?,
            ShapeFile::Generator(shape) => {
                let mesh = shape.build().map_err(|source| {
                    let place = self.source.find("name", body);
                    let problem = SceneProblem::Shape { body: body.to_owned(), source };
                    self.source.error(place, problem)
                })?;
                CollisionGeometry { mesh: Arc::new(mesh), shape: None }
            }
            ShapeFile::Mesh { path, units, scale, recenter, repair }
                if is_saved_model(Path::new(path)) =>
            {
                let is_as_saved = units.is_none()
                    && scale.0 == DVec3::ONE
                    && !recenter
                    && *repair == RepairFile::default();
                if !is_as_saved {
                    return Err(self.contradicted(
                        body,
                        format!(
                            "{path} is a saved model, which is as it was prepared. Leave out `units`, `scale`, `recenter` and `repair`, or name the mesh"
                        ),
                    ));
                }
                self.saved_model(body, path)?
            }
            ShapeFile::Mesh { path, units, scale, recenter, repair } => {
                let factors = self.factors(body, path, *units, scale.0)?;
                let mesh = self.mesh_file(body, path, factors, *recenter)?;
                if units.is_none() && scale.0 == DVec3::ONE {
                    self.notes.extend(note_of_size(path, &mesh));
                }
                self.mended(body, path, mesh, (*repair).into())?
            }
        };
        self.shapes.push((shape.clone(), geometry.clone()));
        Ok(geometry)
    }

    /// A primitive, and the mesh that is drawn for it.
    fn primitive(
        &mut self,
        body: &str,
        file: PrimitiveFile,
    ) -> Result<CollisionGeometry, SceneError> {
        let primitive = Primitive::from(file);
        let mesh = primitive_mesh(&primitive).map_err(|source| {
            let place = self.source.find("name", body);
            let problem = SceneProblem::Shape { body: body.to_owned(), source };
            self.source.error(place, problem)
        })?;
        Ok(CollisionGeometry { mesh: Arc::new(mesh), shape: Some(primitive.into()) })
    }

    /// What is drawn, of a shape: as filed.
    pub(super) fn drawn(&mut self, body: &str, shape: &ShapeFile) -> Result<Arc<Mesh>, SceneError> {
        let ShapeFile::Mesh { path, units, scale, recenter, .. } = shape else {
            return Ok(self.geometry(body, shape)?.mesh);
        };
        if is_saved_model(Path::new(path)) {
            return Ok(self.geometry(body, shape)?.mesh);
        }
        if let Some((_, known)) = self.drawn.iter().find(|(known, _)| known == shape) {
            return Ok(Arc::clone(known));
        }
        let factors = self.factors(body, path, *units, scale.0)?;
        let mesh = Arc::new(self.mesh_file(body, path, factors, *recenter)?);
        self.drawn.push((shape.clone(), Arc::clone(&mesh)));
        Ok(mesh)
    }

    fn saved_model(&mut self, body: &str, name: &str) -> Result<CollisionGeometry, SceneError> {
        let path = self.source.resolve(name);
        let refuse = |what: String| {
            let place = self.source.find("path", name);
            let problem = format!("body {body:?}: model file {}: {what}", path.display());
            self.source.error(place, SceneProblem::Contradiction(problem))
        };
        let bytes = fs::read(&path)
            .map_err(|error| refuse(format!("cannot be read ({error}). {}", remedy(&error))))?;
        let model = Model::decode(&bytes).map_err(|error| refuse(error.to_string()))?;
        self.add_file(path);
        Ok(CollisionGeometry::of_model(model))
    }

    /// The factors of a mesh file: those of its unit and those that its scene states.
    ///
    /// # Errors
    ///
    /// A unit of a file whose format has its own.
    fn factors(
        &self,
        body: &str,
        path: &str,
        units: Option<UnitsFile>,
        scale: DVec3,
    ) -> Result<DVec3, SceneError> {
        let Some(units) = units else { return Ok(scale) };
        let own = match MeshFormat::of_path(Path::new(path)) {
            Some(MeshFormat::Gltf) => "is in metres by its format",
            Some(MeshFormat::Collada) => "names its unit itself, and is read in metres",
            _ => return Ok(scale * units.metres()),
        };
        let what =
            format!("{path} {own}. Leave `units` out, or use `scale` where the file is wrong");
        Err(self.contradicted(body, what))
    }

    /// The mesh of a file, scaled, and moved so that the middle of its box is the origin.
    fn mesh_file(
        &mut self,
        body: &str,
        name: &str,
        scale: DVec3,
        recenter: bool,
    ) -> Result<Mesh, SceneError> {
        let path = self.source.resolve(name);
        let read = read_mesh(&path).map_err(|source| {
            let place = self.source.find("path", name);
            self.source.error(place, SceneProblem::Mesh { body: body.to_owned(), source })
        })?;
        if scale.x * scale.y * scale.z == 0.0 {
            let what = format!("the scale {scale} flattens its mesh. Use factors other than 0");
            return Err(self.contradicted(body, what));
        }
        let mut mesh = read.mesh;
        if scale != DVec3::ONE {
            let scaled = mesh.scaled(scale);
            mesh = scaled.map_err(|error| self.contradicted(body, error))?;
        }
        if recenter {
            let center = mesh.bounds().center();
            let vertices = mesh.vertices().iter().map(|&vertex| vertex - center).collect();
            mesh = Mesh::new(vertices, mesh.faces().to_vec())
                .map_err(|error| self.contradicted(body, format!("recentred: {error}")))?;
        }
        self.notes.extend(read.notes.into_iter().map(|note| format!("{}: {note}", path.display())));
        self.add_file(path);
        Ok(mesh)
    }

    /// The mesh of a file, mended and prepared; says what was mended and what remains.
    fn mended(
        &mut self,
        body: &str,
        name: &str,
        mesh: Mesh,
        repair: Repair,
    ) -> Result<CollisionGeometry, SceneError> {
        let options = BuildOptions { repair, ..BuildOptions::default() };
        let (model, report) = Model::build(mesh, &options).map_err(|error| {
            let advice = match error {
                BuildError::NotProved(_) => "`repair: None` takes the mesh as it is filed",
                _ => "Export it again from where it is whole",
            };
            self.contradicted(body, format!("{name}: {error}. {advice}"))
        })?;
        let mended = report.repairs().iter().map(|repair| format!("{name}: mended: {repair}"));
        self.notes.extend(mended);
        self.warnings.extend(limits(&report).map(|limit| {
            format!("body {body:?}: {name}: {limit} (`cranny inspect {name}` shows where)")
        }));
        let has_inner = report.findings.iter().any(|finding| INNER.contains(&finding.kind));
        if has_inner && model.is_closed() {
            self.warnings.push(format!(
                "body {body:?}: {name}: it has faces within its solid. It collides by its outer skin, and where it is Dynamic it weighs too much at its density: say `mass: Total(…)` or `Stated(…)`"
            ));
        }
        Ok(CollisionGeometry::of_model(model))
    }
}

/// Diagonal of a mesh above which it may be in millimetres, in a scene in metres. Smaller: rooms
/// are taken for it; larger: tools are not.
const LARGEST_ROOM: f64 = 20.0;

/// That a mesh may be in millimetres. A scene may be in any unit, so it is no warning.
fn note_of_size(name: &str, mesh: &Mesh) -> Option<String> {
    let has_no_unit = !matches!(
        MeshFormat::of_path(Path::new(name)),
        Some(MeshFormat::Gltf | MeshFormat::Collada)
    );
    let size = mesh.bounds().diagonal();
    (has_no_unit && size > LARGEST_ROOM).then(|| {
        format!(
            "{name}: its box is {size:.0} across. Where the file is in millimetres and the scene in metres, say `units: Millimetres`"
        )
    })
}

/// Findings that mean faces within the solid, which enclose a part of it twice.
const INNER: [FindingKind; 2] = [FindingKind::SelfIntersection, FindingKind::NestedSolid];

/// What remains in a mesh and limits answers, a sentence a kind.
fn limits(report: &Report) -> impl Iterator<Item = String> {
    let mut kinds: Vec<FindingKind> = report.findings.iter().map(|finding| finding.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds.into_iter().filter(|kind| !kind.limits().is_empty()).map(|kind| {
        let of_kind = report.findings.iter().filter(|finding| finding.kind == kind);
        let count: usize = of_kind.map(|finding| finding.count).sum();
        format!("{count} x {}: {}", kind.name().replace('_', " "), kind.limits().join("; "))
    })
}
