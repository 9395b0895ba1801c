//! The textures that are drawn to, and the way back into memory.

use crate::device::Gpu;
use crate::error::RenderError;
use crate::image::{Image, ImageSize};
use crate::pipelines::{COLOR_FORMAT, SAMPLES};

/// Everything that depends on the size of the picture; kept while the size stays.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) size: ImageSize,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// To read the depths, where the adapter can.
    pub(crate) depths: Option<wgpu::BindGroup>,
    resolved: wgpu::Texture,
    resolved_view: wgpu::TextureView,
    readback: wgpu::Buffer,
    /// Bytes from row to row of `readback`: a multiple of 256, as copies demand.
    stride: u32,
}

/// What a pass does with what was drawn before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Covers it, and averages the samples into the picture.
    Only,
    /// Covers it.
    First,
    /// Draws over it, and reads the depths.
    OverDepths,
    /// Draws over it, and averages the samples into the picture.
    Last,
}

impl Target {
    /// # Errors
    ///
    /// [`RenderError::ImageTooLarge`] or [`RenderError::TooMuch`] where the adapter has not the
    /// room.
    pub(crate) fn new(
        gpu: &Gpu,
        depths_layout: &wgpu::BindGroupLayout,
        size: ImageSize,
    ) -> Result<Self, RenderError> {
        let limits = gpu.device.limits();
        let (width, height) = (size.width(), size.height());
        let limit = limits.max_texture_dimension_2d;
        if width.max(height) > limit {
            return Err(RenderError::ImageTooLarge { width, height, limit });
        }
        let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(stride) * u64::from(height);
        if bytes > limits.max_buffer_size {
            let limit = limits.max_buffer_size;
            return Err(RenderError::TooMuch { what: "the picture's pixels", bytes, limit });
        }
        let texture = |label, format, sample_count, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let read = wgpu::TextureUsages::TEXTURE_BINDING;
        let depth_usage = if gpu.reads_depths { attachment | read } else { attachment };
        let depth = texture("depth", gpu.depth_format, SAMPLES, depth_usage);
        let resolved =
            texture("picture", COLOR_FORMAT, 1, attachment | wgpu::TextureUsages::COPY_SRC);
        Ok(Self {
            size,
            samples: view(&texture("samples", COLOR_FORMAT, SAMPLES, attachment)),
            depth: view(&depth),
            depths: gpu.reads_depths.then(|| readable(gpu, depths_layout, &depth)),
            resolved_view: view(&resolved),
            resolved,
            readback: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size: bytes,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
            stride,
        })
    }

    /// Starts a pass: the first and the only one begin with nothing, which the backdrop covers.
    pub(crate) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        pass: Pass,
    ) -> wgpu::RenderPass<'e> {
        let begins = matches!(pass, Pass::Only | Pass::First);
        let ends = matches!(pass, Pass::Only | Pass::Last);
        let store = if ends { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
        let black = wgpu::LoadOp::Clear(wgpu::Color::BLACK);
        let depth_stencil = wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations {
                // Depth is reversed: 0 is infinitely far.
                load: if begins { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load },
                store,
            }),
            stencil_ops: Some(wgpu::Operations {
                load: if begins { wgpu::LoadOp::Clear(0) } else { wgpu::LoadOp::Load },
                store,
            }),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: ends.then_some(&self.resolved_view),
                ops: wgpu::Operations {
                    load: if begins { black } else { wgpu::LoadOp::Load },
                    store,
                },
            })],
            depth_stencil_attachment: (pass != Pass::OverDepths).then_some(depth_stencil),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Submits what was drawn, waits for it and reads the picture.
    ///
    /// # Errors
    ///
    /// [`RenderError::Failed`] with the first error that the graphics library reported.
    pub(crate) fn finish(
        &self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
    ) -> Result<Image, RenderError> {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.stride),
            rows_per_image: Some(self.size.height()),
        };
        encoder.copy_texture_to_buffer(
            self.resolved.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &self.readback, layout },
            self.resolved.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        if let Some(reason) = gpu.take_error() {
            return Err(gpu.failed(reason));
        }
        let (sender, receiver) = std::sync::mpsc::channel();
        self.readback.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver outlives the poll below; were it gone, nobody would want the result.
            let _ = sender.send(result);
        });
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| gpu.failed(e))?;
        let mapped = receiver.try_recv().map_err(|_| gpu.failed("the picture never arrived"))?;
        mapped.map_err(|e| gpu.failed(e))?;
        let pixels = self.read_rows(gpu);
        self.readback.unmap();
        if let Some(reason) = gpu.take_error() {
            return Err(gpu.failed(reason));
        }
        Image::from_pixels(self.size, pixels?).map_err(|e| gpu.failed(e))
    }

    fn read_rows(&self, gpu: &Gpu) -> Result<Vec<u8>, RenderError> {
        let mapped = self.readback.get_mapped_range(..).map_err(|e| gpu.failed(e))?;
        let row = 4 * self.size.width() as usize;
        Ok(mapped
            .chunks_exact(self.stride as usize)
            .flat_map(|padded| &padded[..row])
            .copied()
            .collect())
    }
}

fn readable(gpu: &Gpu, layout: &wgpu::BindGroupLayout, depth: &wgpu::Texture) -> wgpu::BindGroup {
    let view = depth.create_view(&wgpu::TextureViewDescriptor {
        aspect: wgpu::TextureAspect::DepthOnly,
        ..Default::default()
    });
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("depths"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&view),
        }],
    })
}
