//! The fixed part of drawing: shaders, vertex layouts, blending and depth rules.

use std::mem::size_of;

use crate::frame::{InstanceData, LineData, PointData};
use crate::mesh::Vertex;

/// Colours are blended and averaged in linear light, and stored as sRGB.
pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples a pixel: the one count above 1 that every adapter has.
pub(crate) const SAMPLES: u32 = 4;

/// One pipeline for each thing that is drawn.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) globals_layout: wgpu::BindGroupLayout,
    pub(crate) backdrop: wgpu::RenderPipeline,
    pub(crate) shadow: wgpu::RenderPipeline,
    pub(crate) opaque: wgpu::RenderPipeline,
    pub(crate) grid: wgpu::RenderPipeline,
    /// Far side, then near side.
    pub(crate) overlay: [wgpu::RenderPipeline; 2],
    /// Hidden by what is in front, then on top.
    pub(crate) lines: [wgpu::RenderPipeline; 2],
    /// Hidden by what is in front, then on top.
    pub(crate) points: [wgpu::RenderPipeline; 2],
}

/// What distinguishes one pipeline from another.
struct Recipe<'a> {
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    blend: Option<wgpu::BlendState>,
    cull: Option<wgpu::Face>,
    /// Whether nearer things hide it, and whether it hides farther ones.
    depth: Depth,
    strip: bool,
}

#[derive(Clone, Copy)]
enum Depth {
    TestAndWrite,
    Test,
    Ignore,
}

const SHADERS: &str = concat!(
    include_str!("shaders/scene.wgsl"),
    include_str!("shaders/ground.wgsl"),
    include_str!("shaders/mesh.wgsl"),
    include_str!("shaders/marks.wgsl"),
);

/// The result is the darker of the two, channel by channel.
const DARKEST: wgpu::BlendState = {
    let component = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Min,
    };
    wgpu::BlendState { color: component, alpha: component }
};

/// Straight alpha over a picture that stays opaque.
const OVER: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendState::ALPHA_BLENDING.color,
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let shaders = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("cranny-render"),
            source: wgpu::ShaderSource::Wgsl(SHADERS.into()),
        });
        let globals_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("globals"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("cranny-render"),
            bind_group_layouts: &[Some(&globals_layout)],
            immediate_size: 0,
        });

        let vertex = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Unorm8x4];
        let instance = wgpu::vertex_attr_array![3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4];
        let line = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4];
        let point = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4];
        let each = wgpu::VertexStepMode::Instance;
        let mesh = [
            Some(buffer::<Vertex>(wgpu::VertexStepMode::Vertex, &vertex)),
            Some(buffer::<InstanceData>(each, &instance)),
        ];
        let line = [Some(buffer::<LineData>(each, &line))];
        let point = [Some(buffer::<PointData>(each, &point))];

        let make = |recipe| pipeline(device, &layout, &shaders, &recipe);
        let of_mesh = |vertex, fragment, blend, cull, depth| {
            make(Recipe { vertex, fragment, buffers: &mesh, blend, cull, depth, strip: false })
        };
        let overlay =
            |cull| of_mesh("mesh_vertex", "overlay_fragment", Some(OVER), Some(cull), Depth::Test);
        let quad = |vertex, fragment, buffers, depth| {
            make(Recipe {
                vertex,
                fragment,
                buffers,
                blend: Some(OVER),
                cull: None,
                depth,
                strip: true,
            })
        };
        Self {
            backdrop: make(Recipe {
                vertex: "backdrop_vertex",
                fragment: "backdrop_fragment",
                buffers: &[],
                blend: None,
                cull: None,
                depth: Depth::Ignore,
                strip: false,
            }),
            shadow: of_mesh("shadow_vertex", "shadow_fragment", Some(DARKEST), None, Depth::Ignore),
            opaque: of_mesh("mesh_vertex", "opaque_fragment", None, None, Depth::TestAndWrite),
            grid: quad("grid_vertex", "grid_fragment", &[], Depth::Test),
            overlay: [wgpu::Face::Front, wgpu::Face::Back].map(overlay),
            lines: [Depth::TestAndWrite, Depth::Ignore]
                .map(|depth| quad("line_vertex", "line_fragment", &line, depth)),
            points: [Depth::Test, Depth::Ignore]
                .map(|depth| quad("point_vertex", "point_fragment", &point, depth)),
            globals_layout,
        }
    }
}

fn buffer<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    shaders: &wgpu::ShaderModule,
    recipe: &Recipe<'_>,
) -> wgpu::RenderPipeline {
    let (depth_write, compare) = match recipe.depth {
        // Depth is reversed: greater is nearer.
        Depth::TestAndWrite => (true, wgpu::CompareFunction::GreaterEqual),
        Depth::Test => (false, wgpu::CompareFunction::GreaterEqual),
        Depth::Ignore => (false, wgpu::CompareFunction::Always),
    };
    let topology = match recipe.strip {
        true => wgpu::PrimitiveTopology::TriangleStrip,
        false => wgpu::PrimitiveTopology::TriangleList,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.fragment),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shaders,
            entry_point: Some(recipe.vertex),
            compilation_options: Default::default(),
            buffers: recipe.buffers,
        },
        primitive: wgpu::PrimitiveState { topology, cull_mode: recipe.cull, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(depth_write),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: shaders,
            entry_point: Some(recipe.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR_FORMAT,
                blend: recipe.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
