//! Draw list in, picture out.

use std::collections::HashMap;
use std::mem::size_of;
use std::sync::{Arc, Weak};

use bytemuck::Pod;

use crate::camera::Camera;
use crate::device::{Gpu, RendererOptions};
use crate::draw_list::DrawList;
use crate::error::RenderError;
use crate::frame::{Batch, CutBody, Frame, Globals, PatchRange};
use crate::image::{Image, ImageSize};
use crate::mesh::DrawMesh;
use crate::pipelines::{COVERED, Pipelines};
use crate::target::{Pass, Target};

/// Draws pictures on a graphics adapter, without a window.
///
/// Meshes stay on the adapter from frame to frame, for as long as someone holds their handle. One
/// renderer draws one picture at a time; it can be moved to another thread.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    pipelines: Pipelines,
    globals: wgpu::Buffer,
    globals_group: wgpu::BindGroup,
    instances: Stream,
    lines: Stream,
    points: Stream,
    cut_faces: Stream,
    patches: Stream,
    /// By the address of the mesh.
    meshes: HashMap<usize, Uploaded>,
    target: Option<Target>,
}

/// A mesh on the adapter. The weak handle keeps its address from being given to another mesh.
#[derive(Debug)]
struct Uploaded {
    handle: Weak<DrawMesh>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

/// A buffer that is filled anew for each picture, and grows when it must.
#[derive(Debug)]
struct Stream {
    what: &'static str,
    buffer: Option<wgpu::Buffer>,
}

impl Renderer {
    /// Opens an adapter: a graphics card before a software one. Nothing global is changed, and no
    /// window system is needed. (A layer of Mesa's Vulkan drivers prints a line on standard error
    /// where the environment variable `XDG_RUNTIME_DIR` names no folder; pictures come out all the
    /// same. Nothing but the environment keeps it from that, which is the caller's:
    /// `NODEVICE_SELECT=1` leaves the layer out.)
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] where there is none, saying which package brings one;
    /// [`RenderError::UnknownBackend`] where the options or the environment name none that exists;
    /// [`RenderError::Device`] where it cannot do what is needed.
    pub fn new(options: &RendererOptions) -> Result<Self, RenderError> {
        let gpu = Gpu::open(options)?;
        let pipelines = Pipelines::new(&gpu.device, gpu.depth_format);
        let globals = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let globals_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &pipelines.globals_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() }],
        });
        if let Some(reason) = gpu.take_error() {
            return Err(RenderError::Device { adapter: gpu.name, reason });
        }
        Ok(Self {
            gpu,
            pipelines,
            globals,
            globals_group,
            instances: Stream { what: "the instances", buffer: None },
            lines: Stream { what: "the lines", buffer: None },
            points: Stream { what: "the points", buffer: None },
            cut_faces: Stream { what: "the cut faces", buffer: None },
            patches: Stream { what: "the patches", buffer: None },
            meshes: HashMap::new(),
            target: None,
        })
    }

    /// The adapter's name and interface, for a log or a summary.
    #[must_use]
    pub fn adapter_name(&self) -> &str {
        &self.gpu.name
    }

    /// Whether the adapter is a program rather than a graphics card: slower, but as good.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.gpu.software
    }

    /// Number of meshes that are kept on the adapter.
    #[must_use]
    pub fn cached_meshes(&self) -> usize {
        self.meshes.len()
    }

    /// Draws a picture. Edges are smoothed by four samples a pixel; the picture is opaque.
    ///
    /// # Errors
    ///
    /// [`RenderError::NotFinite`] where an entry of the list cannot be placed,
    /// [`RenderError::ImageTooLarge`] and [`RenderError::TooMuch`] where the adapter has not the
    /// room, [`RenderError::Failed`] where it fails. The renderer stays usable.
    pub fn render(
        &mut self,
        list: &DrawList,
        camera: &Camera,
        size: ImageSize,
    ) -> Result<Image, RenderError> {
        let frame = Frame::new(list, camera, size)?;
        self.upload(&frame)?;
        let target = match self.target.take() {
            Some(target) if target.size == size => target,
            _ => Target::new(&self.gpu, &self.pipelines.depths_layout, size)?,
        };
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        if let Some(depths) = target.depths.as_ref().filter(|_| frame.occlusion) {
            self.draw_bodies(&frame, size, &mut target.begin(&mut encoder, Pass::First));
            self.draw_occlusion(depths, &mut target.begin(&mut encoder, Pass::OverDepths));
            self.draw_marks(&frame, &mut target.begin(&mut encoder, Pass::Last));
        } else {
            let mut pass = target.begin(&mut encoder, Pass::Only);
            self.draw_bodies(&frame, size, &mut pass);
            self.draw_marks(&frame, &mut pass);
        }
        let mut image = target.finish(&self.gpu, encoder)?;
        self.target = Some(target);
        for label in &list.labels {
            label.write(&mut image, camera);
        }
        Ok(image)
    }

    fn upload(&mut self, frame: &Frame<'_>) -> Result<(), RenderError> {
        self.meshes.retain(|_, uploaded| uploaded.handle.strong_count() > 0);
        for batch in frame.batches() {
            let key = address(batch.mesh);
            if !self.meshes.contains_key(&key) {
                let uploaded = Uploaded::new(&self.gpu, batch.mesh)?;
                self.meshes.insert(key, uploaded);
            }
        }
        self.gpu.queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&frame.globals));
        self.instances.fill(&self.gpu, &frame.instances)?;
        self.lines.fill(&self.gpu, &frame.lines)?;
        self.cut_faces.fill(&self.gpu, &frame.cut_faces)?;
        self.patches.fill(&self.gpu, &frame.patch_vertices)?;
        self.points.fill(&self.gpu, &frame.points)
    }

    /// What hides, in the order that [`DrawList`] promises.
    fn draw_bodies(&self, frame: &Frame<'_>, size: ImageSize, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.globals_group, &[]);
        pass.set_pipeline(&self.pipelines.backdrop);
        pass.draw(0..3, 0..1);
        if frame.shadows {
            let [falls, shade] = &self.pipelines.shadow;
            self.draw_batches(pass, falls, &frame.opaque);
            self.draw_batches(pass, falls, &frame.opened);
            pass.set_pipeline(shade);
            pass.draw(0..4, 0..1);
        }
        self.draw_batches(pass, &self.pipelines.opaque, &frame.opaque);
        self.draw_batches(pass, &self.pipelines.opened, &frame.opened);
        self.draw_cut_faces(frame, size, pass);
    }

    fn draw_cut_faces(&self, frame: &Frame<'_>, size: ImageSize, pass: &mut wgpu::RenderPass<'_>) {
        let cut_face = &self.pipelines.cut_face;
        let seen = |cut: &&CutBody<'_>| cut.pixels[2] > 0 && cut.pixels[3] > 0;
        for cut in frame.cut.iter().filter(seen) {
            let [left, top, width, height] = cut.pixels;
            pass.set_scissor_rect(left, top, width, height);
            pass.set_stencil_reference(0);
            self.draw_batches(pass, &cut_face.winding, std::slice::from_ref(&cut.body));
            pass.set_stencil_reference(COVERED);
            for step in [&cut_face.face, &cut_face.overlap, &cut_face.mark] {
                draw_quads(pass, step, &self.cut_faces, cut.cut_face..cut.cut_face + 1);
            }
        }
        pass.set_stencil_reference(0);
        pass.set_scissor_rect(0, 0, size.width(), size.height());
    }

    fn draw_occlusion(&self, depths: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.globals_group, &[]);
        pass.set_bind_group(1, depths, &[]);
        pass.set_pipeline(&self.pipelines.occlusion);
        pass.draw(0..3, 0..1);
    }

    /// What lets through what is behind it, and marks.
    fn draw_marks(&self, frame: &Frame<'_>, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.globals_group, &[]);
        if frame.ground {
            pass.set_pipeline(&self.pipelines.grid);
            pass.draw(0..4, 0..1);
        }
        for batch in frame.translucent.chunks(1) {
            for side in &self.pipelines.overlay {
                self.draw_batches(pass, side, batch);
            }
        }
        self.draw_batches(pass, &self.pipelines.xray, &frame.xrays);
        let (lines, points) = (frame.lines.len() as u32, frame.points.len() as u32);
        let layers = [
            (0..frame.lines_hidden, 0..frame.points_hidden),
            (frame.lines_hidden..lines, frame.points_hidden..points),
        ];
        for (layer, (lines, points)) in layers.into_iter().enumerate() {
            self.draw_patches(frame, layer, pass);
            draw_quads(pass, &self.pipelines.lines[layer], &self.lines, lines);
            draw_quads(pass, &self.pipelines.points[layer], &self.points, points);
        }
    }

    fn draw_patches(&self, frame: &Frame<'_>, layer: usize, pass: &mut wgpu::RenderPass<'_>) {
        let Some(vertices) = &self.patches.buffer else { return };
        let in_layer = |patch: &&PatchRange| usize::from(patch.on_top) == layer;
        for patch in frame.patches.iter().filter(in_layer).filter(|p| !p.vertices.is_empty()) {
            pass.set_vertex_buffer(0, vertices.slice(..));
            for step in [&self.pipelines.patch_count, &self.pipelines.patch_paint[layer]] {
                pass.set_pipeline(step);
                pass.draw(patch.vertices.clone(), 0..1);
            }
        }
    }

    fn draw_batches(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        batches: &[Batch<'_>],
    ) {
        let Some(instances) = &self.instances.buffer else { return };
        pass.set_pipeline(pipeline);
        pass.set_vertex_buffer(1, instances.slice(..));
        for batch in batches {
            if let Some(uploaded) = self.meshes.get(&address(batch.mesh)) {
                pass.set_vertex_buffer(0, uploaded.vertices.slice(..));
                pass.set_index_buffer(uploaded.indices.slice(..), wgpu::IndexFormat::Uint32);
                let corners = batch.mesh.indices().len() as u32;
                pass.draw_indexed(0..corners, 0, batch.instances.clone());
            }
        }
    }
}

fn address(mesh: &Arc<DrawMesh>) -> usize {
    Arc::as_ptr(mesh).addr()
}

fn draw_quads(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    stream: &Stream,
    range: std::ops::Range<u32>,
) {
    if let Some(buffer) = &stream.buffer
        && !range.is_empty()
    {
        pass.set_pipeline(pipeline);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..4, range);
    }
}

impl Uploaded {
    fn new(gpu: &Gpu, mesh: &Arc<DrawMesh>) -> Result<Self, RenderError> {
        let upload = |bytes: &[u8], usage| {
            let buffer = new_buffer(gpu, "a mesh's triangles", bytes.len(), usage)?;
            gpu.queue.write_buffer(&buffer, 0, bytes);
            Ok(buffer)
        };
        let vertices = bytemuck::cast_slice(mesh.vertices());
        let mut indices = mesh.indices().to_vec();
        if gpu.last_provokes {
            indices.chunks_exact_mut(3).for_each(|face| face.rotate_left(1));
        }
        let indices = bytemuck::cast_slice(&indices);
        Ok(Self {
            handle: Arc::downgrade(mesh),
            vertices: upload(vertices, wgpu::BufferUsages::VERTEX)?,
            indices: upload(indices, wgpu::BufferUsages::INDEX)?,
        })
    }
}

impl Stream {
    fn fill<T: Pod>(&mut self, gpu: &Gpu, data: &[T]) -> Result<(), RenderError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        if bytes.is_empty() {
            return Ok(());
        }
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() >= bytes.len() as u64 => buffer,
            _ => new_buffer(gpu, self.what, bytes.len(), wgpu::BufferUsages::VERTEX)?,
        };
        gpu.queue.write_buffer(&buffer, 0, bytes);
        self.buffer = Some(buffer);
        Ok(())
    }
}

fn new_buffer(
    gpu: &Gpu,
    what: &'static str,
    bytes: usize,
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, RenderError> {
    let (bytes, limit) = (bytes as u64, gpu.device.limits().max_buffer_size);
    if bytes > limit {
        return Err(RenderError::TooMuch { what, bytes, limit });
    }
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: bytes,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_renderer_can_be_kept_by_another_thread() {
        fn assert_send_and_sync<T: Send + Sync>() {}
        assert_send_and_sync::<super::Renderer>();
    }
}
