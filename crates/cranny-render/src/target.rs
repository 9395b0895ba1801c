//! The textures that are drawn to, and the way back into memory.

use crate::device::Gpu;
use crate::error::RenderError;
use crate::image::{Image, ImageSize};
use crate::pipelines::{COLOR_FORMAT, DEPTH_FORMAT, SAMPLES};

/// Everything that depends on the size of the picture; kept while the size stays.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) size: ImageSize,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
    resolved_view: wgpu::TextureView,
    readback: wgpu::Buffer,
    /// Bytes from row to row of `readback`: a multiple of 256, as copies demand.
    stride: u32,
}

impl Target {
    /// # Errors
    ///
    /// [`RenderError::ImageTooLarge`] or [`RenderError::TooMuch`] where the adapter has not the
    /// room.
    pub(crate) fn new(gpu: &Gpu, size: ImageSize) -> Result<Self, RenderError> {
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
        let resolved =
            texture("picture", COLOR_FORMAT, 1, attachment | wgpu::TextureUsages::COPY_SRC);
        Ok(Self {
            size,
            samples: view(&texture("samples", COLOR_FORMAT, SAMPLES, attachment)),
            depth: view(&texture("depth", DEPTH_FORMAT, SAMPLES, attachment)),
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

    /// Starts the only pass there is. What it begins with is covered by the backdrop.
    pub(crate) fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(&self.resolved_view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    // Depth is reversed: 0 is infinitely far.
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
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
