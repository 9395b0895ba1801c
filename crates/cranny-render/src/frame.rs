//! A draw list as the numbers that the shaders read: everything relative to the eye, in units of
//! the distance between eye and target, so that `f32` is precise wherever the scene lies and
//! whatever its unit of length.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use cranny_exact::DVec3;

use crate::camera::Camera;
use crate::draw_list::{DrawList, Ground, Instance, box_corners};
use crate::error::RenderError;
use crate::image::ImageSize;
use crate::mesh::DrawMesh;
use crate::outlines::{EdgeLine, edge_lines, section_lines};
use crate::section::Section;
use crate::style::Style;

/// The uniform block; `scene.wgsl` has its twin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Globals {
    /// Column-major; the eye is the origin.
    clip_from_scene: [[f32; 4]; 4],
    /// Unit vector towards the key light; the last number is the near plane's distance.
    key_near: [f32; 4],
    /// Unit vector towards the fill light.
    fill: [f32; 4],
    /// Width and height of the picture in pixels, and the tangents of half the view's angles.
    viewport: [f32; 4],
    /// Linear colours of the background.
    backdrop_top: [f32; 4],
    backdrop_bottom: [f32; 4],
    /// Centre of the ground, and its radius.
    ground_center: [f32; 4],
    /// A point (x, y) where two strong grid lines cross, the spacing, and how far what stands
    /// nearby holds off light.
    ground_grid: [f32; 4],
    /// Normal and offset of the section's plane; a positive value is before it.
    section: [f32; 4],
    /// Linear.
    overlap: [f32; 4],
}

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct InstanceData {
    /// Columns of the map from mesh units; the fourth number is the translation's.
    pub(crate) rows: [[f32; 4]; 3],
    /// Linear.
    pub(crate) color: [f32; 4],
    /// 1 where the section cuts the instance, else 0.
    pub(crate) cut: f32,
}

/// A square in the section's plane that holds all of a body's cut face.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CutFaceData {
    center: [f32; 3],
    /// Direction of the hatching, radians.
    hatching: f32,
    u: [f32; 4],
    v: [f32; 4],
    color: [f32; 4],
}

/// A corner of a patch's triangles.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PatchVertex {
    position: [f32; 3],
    color: [f32; 4],
}

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LineData {
    from: [f32; 3],
    from_width: f32,
    to: [f32; 3],
    to_width: f32,
    color: [f32; 4],
    /// 1 where the section takes away what is before its plane.
    cut: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PointData {
    position: [f32; 3],
    radius: f32,
    color: [f32; 4],
}

/// Instances of one mesh that are drawn together: a range of [`Frame::instances`].
#[derive(Clone, Debug)]
pub(crate) struct Batch<'a> {
    pub(crate) mesh: &'a Arc<DrawMesh>,
    pub(crate) instances: Range<u32>,
}

/// A closed body that the section's plane passes through.
#[derive(Clone, Debug)]
pub(crate) struct CutBody<'a> {
    pub(crate) body: Batch<'a>,
    /// Its place in [`Frame::cut_faces`].
    pub(crate) cut_face: u32,
    /// Where its cut face may be in the picture: left, top, width, height.
    pub(crate) pixels: [u32; 4],
}

/// A patch: a range of [`Frame::patch_vertices`].
#[derive(Clone, Debug)]
pub(crate) struct PatchRange {
    pub(crate) vertices: Range<u32>,
    pub(crate) on_top: bool,
}

/// A draw list, seen from a camera, ready to be uploaded.
#[derive(Clone, Debug)]
pub(crate) struct Frame<'a> {
    pub(crate) globals: Globals,
    pub(crate) instances: Vec<InstanceData>,
    /// By mesh, in the order in which the list first names each.
    pub(crate) opaque: Vec<Batch<'a>>,
    /// Those that the section cuts, likewise.
    pub(crate) opened: Vec<Batch<'a>>,
    /// Those of them that have a cut face, one instance each.
    pub(crate) cut: Vec<CutBody<'a>>,
    pub(crate) cut_faces: Vec<CutFaceData>,
    /// One instance each, far to near.
    pub(crate) translucent: Vec<Batch<'a>>,
    pub(crate) xrays: Vec<Batch<'a>>,
    pub(crate) patches: Vec<PatchRange>,
    pub(crate) patch_vertices: Vec<PatchVertex>,
    /// Those that may be hidden first.
    pub(crate) lines: Vec<LineData>,
    pub(crate) lines_hidden: u32,
    /// Those that may be hidden first.
    pub(crate) points: Vec<PointData>,
    pub(crate) points_hidden: u32,
    pub(crate) ground: bool,
    pub(crate) shadows: bool,
    pub(crate) occlusion: bool,
}

/// The near plane lies at half the distance to the nearest thing, but within these bounds (in units
/// of the distance to the target). Nearer, and depths of the scene crowd into few values; farther,
/// and the ground in front of the scene is cut off.
const NEAR: [f64; 2] = [1e-4, 0.05];

/// Direction towards the key light in the camera's axes (right, up, backward): from the upper left,
/// so that the faces of a box seen from a corner differ.
const KEY_LIGHT: DVec3 = DVec3::new(-0.6, 0.6, 0.65);

/// Direction towards the weaker fill light, in the camera's axes.
const FILL_LIGHT: DVec3 = DVec3::new(0.85, 0.1, 0.45);

impl<'a> Frame<'a> {
    /// Prepares a picture.
    ///
    /// # Errors
    ///
    /// [`RenderError::NotFinite`] naming the first entry whose numbers are not finite, or which is
    /// too far away for `f32`.
    pub(crate) fn new(
        list: &'a DrawList,
        camera: &Camera,
        size: ImageSize,
    ) -> Result<Self, RenderError> {
        let space = Space { eye: camera.eye(), unit: camera.distance() };
        let globals = globals(list, camera, size, &space);
        let mut frame = Frame {
            globals,
            instances: Vec::with_capacity(list.instances.len()),
            opaque: Vec::new(),
            opened: Vec::new(),
            cut: Vec::new(),
            cut_faces: Vec::new(),
            translucent: Vec::new(),
            xrays: Vec::new(),
            patches: Vec::new(),
            patch_vertices: Vec::new(),
            lines: Vec::with_capacity(list.lines.len()),
            lines_hidden: 0,
            points: Vec::with_capacity(list.points.len()),
            points_hidden: 0,
            ground: list.ground.is_some(),
            shadows: list.ground.is_some_and(|g| g.shadows && g.height < camera.eye().z),
            occlusion: list.shading.occlusion,
        };
        if bytemuck::cast_slice::<_, f32>(&[globals]).iter().any(|x| !x.is_finite()) {
            return Err(RenderError::NotFinite { what: "ground", index: 0 });
        }
        frame.add_instances(&list.instances, &space)?;
        let section = list.section.filter(|section| section.faces(camera));
        if let Some(section) = &section {
            frame.add_caps(&list.instances, section, (camera, size), &space)?;
        }
        frame.add_patches(list, &space)?;
        frame.add_edges(list, section.as_ref(), camera.eye(), &space)?;
        frame.add_lines(list, &space)?;
        frame.add_points(list, &space)?;
        Ok(frame)
    }

    /// All batches, so that their meshes are there.
    pub(crate) fn batches(&self) -> impl Iterator<Item = &Batch<'a>> {
        self.opaque.iter().chain(&self.opened).chain(&self.translucent).chain(&self.xrays)
    }

    fn add_instances(&mut self, all: &'a [Instance], space: &Space) -> Result<(), RenderError> {
        let drawn = |i: &&usize| all[**i].mesh.triangle_count() > 0;
        let numbers: Vec<usize> = (0..all.len()).collect();
        let of = |wanted: &dyn Fn(&Instance) -> bool| -> Vec<usize> {
            numbers.iter().filter(drawn).copied().filter(|&i| wanted(&all[i])).collect()
        };
        self.opaque = self.add_batches(all, &of(&|i| i.is_opaque() && !i.cut), space)?;
        self.opened = self.add_batches(all, &of(&|i| i.is_opaque() && i.cut), space)?;
        self.xrays = self.add_batches(all, &of(&|i| i.style == Style::XRay), space)?;
        let mut translucent = of(&|i| i.style == Style::Solid && !i.is_opaque());
        let distance = |i: &usize| {
            let center = all[*i].pose.world_from_body().apply(all[*i].mesh.center());
            (center - space.eye).length_squared()
        };
        translucent.sort_by(|a, b| distance(b).total_cmp(&distance(a)).then(a.cmp(b)));
        for i in translucent {
            let batch = self.add_batch(all, &[i], space)?;
            self.translucent.push(batch);
        }
        Ok(())
    }

    /// By mesh, in the order in which `chosen` first names each.
    fn add_batches(
        &mut self,
        all: &'a [Instance],
        chosen: &[usize],
        space: &Space,
    ) -> Result<Vec<Batch<'a>>, RenderError> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut group_of: HashMap<*const DrawMesh, usize> = HashMap::new();
        for &i in chosen {
            let group = *group_of.entry(Arc::as_ptr(&all[i].mesh)).or_insert(groups.len());
            groups.resize_with(groups.len().max(group + 1), Vec::new);
            groups[group].push(i);
        }
        groups.iter().map(|group| self.add_batch(all, group, space)).collect()
    }

    fn add_caps(
        &mut self,
        all: &'a [Instance],
        section: &Section,
        view: (&Camera, ImageSize),
        space: &Space,
    ) -> Result<(), RenderError> {
        let opened = |i: &Instance| i.cut && i.is_opaque() && i.mesh.triangle_count() > 0;
        let discs =
            all.iter().enumerate().filter(|(_, i)| opened(i)).filter_map(|(i, instance)| {
                let disc = section.disc(&instance.mesh, &instance.pose)?;
                instance.mesh.is_closed().then_some((i, disc))
            });
        let discs: Vec<(usize, (DVec3, f64))> = discs.collect();
        let reach = |&(_, (center, radius)): &(usize, (DVec3, f64))| {
            (center - view.0.target()).length() + radius
        };
        let square = section.square(view.0, discs.iter().map(reach).fold(0.0, f64::max));
        for (i, disc) in discs {
            let cut_face = cut_face_data(square, &all[i], self.cut_faces.len(), space);
            self.cut_faces.push(finite(cut_face, "instance", i)?);
            let body = self.add_batch(all, &[i], space)?;
            let pixels = pixels_of(disc, section, view);
            self.cut.push(CutBody { body, cut_face: self.cut_faces.len() as u32 - 1, pixels });
        }
        Ok(())
    }

    fn add_patches(&mut self, list: &DrawList, space: &Space) -> Result<(), RenderError> {
        for (i, patch) in list.patches.iter().enumerate() {
            let start = self.patch_vertices.len() as u32;
            let color = patch.color.to_linear();
            for position in patch.fan().flatten() {
                let vertex = PatchVertex { position: space.place(position), color };
                self.patch_vertices.push(finite(vertex, "patch", i)?);
            }
            let vertices = start..self.patch_vertices.len() as u32;
            self.patches.push(PatchRange { vertices, on_top: patch.on_top });
        }
        Ok(())
    }

    /// Wireframes, outlines, and the rims of cut faces: ahead of the list's own lines.
    fn add_edges(
        &mut self,
        list: &DrawList,
        section: Option<&Section>,
        eye: DVec3,
        space: &Space,
    ) -> Result<(), RenderError> {
        for (i, instance) in list.instances.iter().enumerate() {
            for line in edge_lines(instance, list.shading, eye) {
                self.add_edge(line, i, space)?;
            }
            if let Some(section) = section.filter(|_| instance.cut) {
                for line in section_lines(instance, section) {
                    self.add_edge(line, i, space)?;
                }
            }
        }
        Ok(())
    }

    fn add_edge(&mut self, line: EdgeLine, i: usize, space: &Space) -> Result<(), RenderError> {
        let [from, to] = line.ends.map(|p| space.place(p));
        let (from_width, to_width) = (line.width, line.width);
        let cut = f32::from(u8::from(line.cut));
        let data = LineData { from, from_width, to, to_width, color: line.color.to_linear(), cut };
        self.lines.push(finite(data, "instance", i)?);
        self.lines_hidden += 1;
        Ok(())
    }

    /// `group` is not empty, and all its instances have one mesh.
    fn add_batch(
        &mut self,
        all: &'a [Instance],
        group: &[usize],
        space: &Space,
    ) -> Result<Batch<'a>, RenderError> {
        let start = self.instances.len() as u32;
        for &i in group {
            let data = instance_data(&all[i], space);
            self.instances.push(finite(data, "instance", i)?);
        }
        Ok(Batch { mesh: &all[group[0]].mesh, instances: start..self.instances.len() as u32 })
    }

    fn add_lines(&mut self, list: &DrawList, space: &Space) -> Result<(), RenderError> {
        for on_top in [false, true] {
            for (i, line) in list.lines.iter().enumerate().filter(|(_, l)| l.on_top == on_top) {
                let data = LineData {
                    from: space.place(line.from),
                    from_width: line.width[0],
                    to: space.place(line.to),
                    to_width: line.width[1],
                    color: line.color.to_linear(),
                    cut: 0.0,
                };
                self.lines.push(finite(data, "line", i)?);
                self.lines_hidden += u32::from(!on_top);
            }
        }
        Ok(())
    }

    fn add_points(&mut self, list: &DrawList, space: &Space) -> Result<(), RenderError> {
        for on_top in [false, true] {
            for (i, point) in list.points.iter().enumerate().filter(|(_, p)| p.on_top == on_top) {
                let data = PointData {
                    position: space.place(point.position),
                    radius: point.radius,
                    color: point.color.to_linear(),
                };
                self.points.push(finite(data, "point", i)?);
                self.points_hidden += u32::from(!on_top);
            }
        }
        Ok(())
    }
}

/// The frame of the shaders: the eye is the origin, the axes are the world's.
struct Space {
    eye: DVec3,
    unit: f64,
}

impl Space {
    fn place(&self, p: DVec3) -> [f32; 3] {
        ((p - self.eye) / self.unit).as_vec3().to_array()
    }
}

fn finite<T: Pod>(data: T, what: &'static str, index: usize) -> Result<T, RenderError> {
    let numbers: &[f32] = bytemuck::cast_slice(std::slice::from_ref(&data));
    if numbers.iter().all(|x| x.is_finite()) {
        Ok(data)
    } else {
        Err(RenderError::NotFinite { what, index })
    }
}

fn instance_data(instance: &Instance, space: &Space) -> InstanceData {
    let world_from_body = instance.pose.world_from_body();
    let at = space.place(world_from_body.apply(instance.mesh.center()));
    let linear = world_from_body.linear * (instance.mesh.radius() / space.unit);
    let row = |i: usize| {
        let [x, y, z] = linear.row(i).as_vec3().to_array();
        [x, y, z, at[i]]
    };
    let cut = f32::from(u8::from(instance.cut));
    InstanceData { rows: [row(0), row(1), row(2)], color: instance.color.to_linear(), cut }
}

/// The pixels of a disc in the section's plane; all, where a part of it is not before the camera.
fn pixels_of(
    (center, radius): (DVec3, f64),
    section: &Section,
    (camera, size): (&Camera, ImageSize),
) -> [u32; 4] {
    let u = radius * section.normal.any_orthonormal_vector();
    let v = section.normal.cross(u);
    let corners = [u + v, u - v, -u + v, -u - v].map(|side| camera.project(center + side, size));
    let all = [0, 0, size.width(), size.height()];
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return all };
    let range = |axis: usize, end: u32| {
        let along = [a, b, c, d].map(|corner| corner[axis]);
        let least = along.into_iter().fold(f64::INFINITY, f64::min) - 2.0;
        let most = along.into_iter().fold(f64::NEG_INFINITY, f64::max) + 2.0;
        [least, most].map(|x| x.clamp(0.0, f64::from(end)) as u32)
    };
    let ([left, right], [top, bottom]) = (range(0, size.width()), range(1, size.height()));
    [left, top, right - left, bottom - top]
}

/// How much the hatching turns from one body to the next: the golden angle, so that many differ.
const HATCHING: f32 = 2.399_963;

fn cut_face_data(
    [center, u, v]: [DVec3; 3],
    instance: &Instance,
    number: usize,
    space: &Space,
) -> CutFaceData {
    let along = |side: DVec3| (side / space.unit).as_vec3().extend(0.0).to_array();
    CutFaceData {
        center: space.place(center),
        hatching: std::f32::consts::FRAC_PI_4 + number as f32 * HATCHING,
        u: along(u),
        v: along(v),
        color: instance.color.to_linear(),
    }
}

/// How far what stands nearby holds off light, in parts of the distance between eye and target.
/// Smaller: narrow gaps alone are dark; larger: bodies darken each other from afar.
const OCCLUSION_REACH: f32 = 0.035;

/// In the shaders' frame. Without a section everything lies behind.
fn section_plane(section: Option<Section>, space: &Space) -> [f32; 4] {
    let Some(section) = section else { return [0.0, 0.0, 0.0, -1.0] };
    let offset = section.before(space.eye) / space.unit;
    section.normal.as_vec3().extend(offset as f32).to_array()
}

fn globals(list: &DrawList, camera: &Camera, size: ImageSize, space: &Space) -> Globals {
    let [right, up, backward] = camera.axes();
    let in_world = |v: DVec3| (v.x * right + v.y * up + v.z * backward).normalize().as_vec3();
    let depth = |p: DVec3| (space.eye - p).dot(backward) / space.unit;
    let nearest = box_corners(&list.bounds()).map(depth).fold(1.0, f64::min);
    let near = (0.5 * nearest).clamp(NEAR[0], NEAR[1]) as f32;
    let [top, bottom] = list.backdrop.map(|c| c.to_linear());
    let (center, mut grid) = list.ground.map_or_else(Default::default, |g| ground(&g, space));
    grid[3] = OCCLUSION_REACH;
    let tangent = (0.5 * camera.field_of_view()).tan();
    let [across, upright] = [tangent * size.aspect(), tangent].map(|x| x as f32);
    let section = list.section.filter(|section| section.faces(camera));
    Globals {
        clip_from_scene: clip_from_scene(camera, size, near),
        key_near: in_world(KEY_LIGHT).extend(near).to_array(),
        fill: in_world(FILL_LIGHT).extend(0.0).to_array(),
        viewport: [size.width() as f32, size.height() as f32, across, upright],
        backdrop_top: top,
        backdrop_bottom: bottom,
        ground_center: center,
        ground_grid: grid,
        section: section_plane(section, space),
        overlap: section.map_or([0.0; 4], |section| section.overlap.to_linear()),
    }
}

/// Perspective with reversed, infinite depth: 1 at the near plane, 0 at infinity, which spreads the
/// precision of `f32` evenly over the distances.
fn clip_from_scene(camera: &Camera, size: ImageSize, near: f32) -> [[f32; 4]; 4] {
    let [right, up, backward] = camera.axes();
    let focal = 1.0 / (0.5 * camera.field_of_view()).tan();
    let x = (right * (focal / size.aspect())).as_vec3();
    let y = (up * focal).as_vec3();
    let w = (-backward).as_vec3();
    [[x.x, y.x, 0.0, w.x], [x.y, y.y, 0.0, w.y], [x.z, y.z, 0.0, w.z], [0.0, 0.0, near, 0.0]]
}

fn ground(ground: &Ground, space: &Space) -> ([f32; 4], [f32; 4]) {
    let center = space.place(ground.center.extend(ground.height));
    let strong = 10.0 * ground.spacing;
    let crossing = (ground.center / strong).round() * strong;
    let crossing = space.place(crossing.extend(ground.height));
    let [radius, spacing] = [ground.radius, ground.spacing].map(|x| (x / space.unit) as f32);
    ([center[0], center[1], center[2], radius], [crossing[0], crossing[1], spacing, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Color;
    use crate::draw_list::Line;
    use cranny_exact::Pose;

    fn triangle() -> Arc<DrawMesh> {
        Arc::new(DrawMesh::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]).unwrap())
    }

    fn at(mesh: &Arc<DrawMesh>, x: f64, color: Color) -> Instance {
        Instance::solid(mesh.clone(), Pose::at(DVec3::new(x, 0.0, 0.0)), color)
    }

    fn prepare(list: &DrawList) -> Result<Frame<'_>, RenderError> {
        let camera = Camera::look_at(DVec3::new(10.0, 0.0, 0.0), DVec3::ZERO).unwrap();
        Frame::new(list, &camera, ImageSize::new(16, 9).unwrap())
    }

    #[test]
    fn instances_are_batched_by_mesh_and_overlays_sorted_far_to_near() {
        let (a, b) = (triangle(), triangle());
        let glass = Color::WHITE.with_alpha(100);
        let mut list = DrawList::new();
        list.instances = vec![
            at(&a, 1.0, Color::WHITE),
            at(&a, 5.0, glass),
            at(&b, 2.0, Color::WHITE),
            at(&b, -5.0, glass),
            at(&a, 3.0, Color::WHITE),
        ];
        let frame = prepare(&list).unwrap();
        let opaque: Vec<_> = frame.opaque.iter().map(|b| b.instances.clone()).collect();
        assert_eq!(opaque, [0..2, 2..3]);
        assert!(Arc::ptr_eq(frame.opaque[1].mesh, &b));
        let first = &frame.translucent[0];
        assert!(Arc::ptr_eq(first.mesh, &b), "the far one is drawn first");
        // The eye is at x = 10, the unit is 10, and the mesh's centre at 0.5 of its body.
        let data = &frame.instances[first.instances.start as usize];
        assert!((data.rows[0][3] - (-5.0 + 0.5 - 10.0) / 10.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_on_top_comes_last() {
        let line = |on_top| Line {
            from: DVec3::ZERO,
            to: DVec3::X,
            color: Color::BLACK,
            width: [if on_top { 2.0 } else { 1.0 }; 2],
            on_top,
        };
        let mut list = DrawList::new();
        list.lines = vec![line(true), line(false), line(true)];
        let frame = prepare(&list).unwrap();
        assert_eq!(frame.lines_hidden, 1);
        let widths: Vec<f32> = frame.lines.iter().map(|l| l.from_width).collect();
        assert_eq!(widths, [1.0, 2.0, 2.0]);
    }

    #[test]
    fn entries_that_are_not_finite_are_named() {
        let mut list = DrawList::new();
        list.push_line(DVec3::ZERO, DVec3::X, Color::BLACK, 1.0);
        list.push_line(DVec3::ZERO, DVec3::NAN, Color::BLACK, 1.0);
        let error = prepare(&list).unwrap_err();
        assert!(matches!(error, RenderError::NotFinite { what: "line", index: 1 }), "{error}");
        let mut list = DrawList::new();
        list.instances.push(at(&triangle(), 1e200, Color::WHITE));
        let error = prepare(&list).unwrap_err();
        assert!(matches!(error, RenderError::NotFinite { what: "instance", index: 0 }), "{error}");
    }
}
