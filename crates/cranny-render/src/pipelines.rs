//! The fixed part of drawing: shaders, vertex layouts, blending and depth rules.

use std::mem::size_of;

use crate::frame::{CutFaceData, InstanceData, LineData, PatchVertex, PointData};
use crate::mesh::Vertex;

/// Colours are blended and averaged in linear light, and stored as sRGB.
pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The first where the adapter has it. The second, which all have, resolves depths less finely.
pub(crate) const DEPTH_FORMATS: [wgpu::TextureFormat; 2] =
    [wgpu::TextureFormat::Depth32FloatStencil8, wgpu::TextureFormat::Depth24PlusStencil8];
/// Samples a pixel: the one count above 1 that every adapter has.
pub(crate) const SAMPLES: u32 = 4;

/// One pipeline for each thing that is drawn.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) globals_layout: wgpu::BindGroupLayout,
    pub(crate) depths_layout: wgpu::BindGroupLayout,
    pub(crate) backdrop: wgpu::RenderPipeline,
    /// Where shadows fall, into the stencil; then their shade.
    pub(crate) shadow: [wgpu::RenderPipeline; 2],
    pub(crate) opaque: wgpu::RenderPipeline,
    /// Without what the section takes away.
    pub(crate) opened: wgpu::RenderPipeline,
    pub(crate) cut_face: CutFacePipelines,
    pub(crate) occlusion: wgpu::RenderPipeline,
    pub(crate) grid: wgpu::RenderPipeline,
    /// Far side, then near side.
    pub(crate) overlay: [wgpu::RenderPipeline; 2],
    pub(crate) xray: wgpu::RenderPipeline,
    pub(crate) patch_count: wgpu::RenderPipeline,
    /// Hidden by what is in front, then on top.
    pub(crate) patch_paint: [wgpu::RenderPipeline; 2],
    /// Hidden by what is in front, then on top.
    pub(crate) lines: [wgpu::RenderPipeline; 2],
    /// Hidden by what is in front, then on top.
    pub(crate) points: [wgpu::RenderPipeline; 2],
}

/// The steps in which a cut face is drawn, in their order.
#[derive(Debug)]
pub(crate) struct CutFacePipelines {
    /// How often the plane lies in the body, into the stencil.
    pub(crate) winding: wgpu::RenderPipeline,
    /// The face, where it does.
    pub(crate) face: wgpu::RenderPipeline,
    /// Over it, what an earlier body has too.
    pub(crate) overlap: wgpu::RenderPipeline,
    /// Notes the face for later bodies, and clears the count.
    pub(crate) mark: wgpu::RenderPipeline,
}

/// What distinguishes one pipeline from another.
struct Recipe<'a> {
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// `None` leaves the picture as it is.
    color: Option<wgpu::ColorTargetState>,
    cull: Option<wgpu::Face>,
    /// Whether nearer things hide it, and whether it hides farther ones.
    depth: Depth,
    stencil: wgpu::StencilState,
    strip: bool,
}

#[derive(Clone, Copy)]
enum Depth {
    TestAndWrite,
    Test,
    Ignore,
}

/// The stencil's bit that says that a cut face of an earlier body is here; the other bits count.
pub(crate) const COVERED: u32 = 0x80;
const COUNT: u32 = 0x7f;
/// The bit of shadows, and of patches; whoever uses it leaves it clear.
const ODD: u32 = 0x01;

const SHADERS: &str = concat!(
    include_str!("shaders/scene.wgsl"),
    include_str!("shaders/ground.wgsl"),
    include_str!("shaders/mesh.wgsl"),
    include_str!("shaders/marks.wgsl"),
    include_str!("shaders/section.wgsl"),
    include_str!("shaders/patch.wgsl"),
    include_str!("shaders/occlusion.wgsl"),
);

/// The result is the product: the fragment says how much light is left.
const LEFT: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::Src,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
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
    pub(crate) fn new(device: &wgpu::Device, depth_format: wgpu::TextureFormat) -> Self {
        let shaders = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("cranny-render"),
            source: wgpu::ShaderSource::Wgsl(SHADERS.into()),
        });
        let globals_layout = bind_layout(
            device,
            "globals",
            wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
        );
        let depths_layout = bind_layout(
            device,
            "depths",
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: true,
            },
        );
        let layout_of = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("cranny-render"),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let layout = layout_of(&[Some(&globals_layout)]);
        let with_depths = layout_of(&[Some(&globals_layout), Some(&depths_layout)]);
        let maker = Maker { device, layout: &layout, shaders: &shaders, depth: Some(depth_format) };
        let over_all = Maker { layout: &with_depths, depth: None, ..maker };
        Self {
            backdrop: maker.whole("backdrop_vertex", "backdrop_fragment", None),
            shadow: maker.shadow(),
            opaque: maker.mesh("mesh_vertex", "opaque_fragment", None, Depth::TestAndWrite),
            opened: maker.mesh("mesh_vertex", "cut_fragment", None, Depth::TestAndWrite),
            cut_face: maker.cut_face(),
            occlusion: over_all.whole("occlusion_vertex", "occlusion_fragment", Some(LEFT)),
            grid: maker.quad("grid_vertex", "grid_fragment", &[], Depth::Test),
            overlay: [wgpu::Face::Front, wgpu::Face::Back].map(|cull| maker.overlay(cull)),
            xray: maker.mesh("mesh_vertex", "xray_fragment", Some(LEFT), Depth::Test),
            patch_count: maker.patch(None, Depth::Ignore),
            patch_paint: [Depth::Test, Depth::Ignore]
                .map(|depth| maker.patch(drawn(Some(OVER)), depth)),
            lines: [Depth::TestAndWrite, Depth::Ignore].map(|depth| maker.lines(depth)),
            points: [Depth::Test, Depth::Ignore].map(|depth| maker.points(depth)),
            globals_layout,
            depths_layout,
        }
    }
}

fn bind_layout(device: &wgpu::Device, label: &str, ty: wgpu::BindingType) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        }],
    })
}

/// A picture's pixels, written or blended.
fn drawn(blend: Option<wgpu::BlendState>) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format: COLOR_FORMAT, blend, write_mask: wgpu::ColorWrites::ALL })
}

/// What all pipelines of a pass share.
#[derive(Clone, Copy)]
struct Maker<'a> {
    device: &'a wgpu::Device,
    layout: &'a wgpu::PipelineLayout,
    shaders: &'a wgpu::ShaderModule,
    /// `None` for a pass that reads the depths, and so has none of its own.
    depth: Option<wgpu::TextureFormat>,
}

const EACH: wgpu::VertexStepMode = wgpu::VertexStepMode::Instance;

impl Maker<'_> {
    /// Covers the picture.
    fn whole(
        &self,
        vertex: &str,
        fragment: &str,
        blend: Option<wgpu::BlendState>,
    ) -> wgpu::RenderPipeline {
        self.make(&Recipe {
            vertex,
            fragment,
            buffers: &[],
            color: drawn(blend),
            cull: None,
            depth: Depth::Ignore,
            stencil: Default::default(),
            strip: false,
        })
    }

    fn mesh(
        &self,
        vertex: &str,
        fragment: &str,
        blend: Option<wgpu::BlendState>,
        depth: Depth,
    ) -> wgpu::RenderPipeline {
        let (color, stencil) = (drawn(blend), Default::default());
        self.mesh_recipe(vertex, fragment, color, None, depth, stencil)
    }

    fn shadow(&self) -> [wgpu::RenderPipeline; 2] {
        use wgpu::{CompareFunction as Compare, StencilOperation as Op};
        let falls = both_sides(Compare::Equal, Op::Invert, ODD, ODD);
        let fallen = both_sides(Compare::NotEqual, Op::Zero, ODD, ODD);
        let fragment = "shadow_fragment";
        [
            self.mesh_recipe("shadow_vertex", fragment, None, None, Depth::Ignore, falls),
            self.make(&Recipe {
                vertex: "grid_vertex",
                fragment: "shade_fragment",
                buffers: &[],
                color: drawn(Some(LEFT)),
                cull: None,
                depth: Depth::Ignore,
                stencil: fallen,
                strip: true,
            }),
        ]
    }

    fn overlay(&self, cull: wgpu::Face) -> wgpu::RenderPipeline {
        let (color, stencil) = (drawn(Some(OVER)), Default::default());
        let fragment = "overlay_fragment";
        self.mesh_recipe("mesh_vertex", fragment, color, Some(cull), Depth::Test, stencil)
    }

    fn mesh_recipe(
        &self,
        vertex: &str,
        fragment: &str,
        color: Option<wgpu::ColorTargetState>,
        cull: Option<wgpu::Face>,
        depth: Depth,
        stencil: wgpu::StencilState,
    ) -> wgpu::RenderPipeline {
        let corner = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Unorm16x4];
        let instance = wgpu::vertex_attr_array![
            3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32
        ];
        let buffers = [
            Some(buffer::<Vertex>(wgpu::VertexStepMode::Vertex, &corner)),
            Some(buffer::<InstanceData>(EACH, &instance)),
        ];
        let strip = false;
        self.make(&Recipe {
            vertex,
            fragment,
            buffers: &buffers,
            color,
            cull,
            depth,
            stencil,
            strip,
        })
    }

    fn quad(
        &self,
        vertex: &str,
        fragment: &str,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        depth: Depth,
    ) -> wgpu::RenderPipeline {
        let (color, stencil) = (drawn(Some(OVER)), Default::default());
        let (cull, strip) = (None, true);
        self.make(&Recipe { vertex, fragment, buffers, color, cull, depth, stencil, strip })
    }

    fn lines(&self, depth: Depth) -> wgpu::RenderPipeline {
        let line = wgpu::vertex_attr_array![
            0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32
        ];
        let buffers = [Some(buffer::<LineData>(EACH, &line))];
        self.quad("line_vertex", "line_fragment", &buffers, depth)
    }

    fn points(&self, depth: Depth) -> wgpu::RenderPipeline {
        let point = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4];
        let buffers = [Some(buffer::<PointData>(EACH, &point))];
        self.quad("point_vertex", "point_fragment", &buffers, depth)
    }

    /// Counts where it has no colour, else paints where the count is odd, and clears it.
    fn patch(&self, color: Option<wgpu::ColorTargetState>, depth: Depth) -> wgpu::RenderPipeline {
        let corner = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4];
        let stencil = match color {
            None => {
                both_sides(wgpu::CompareFunction::Always, wgpu::StencilOperation::Invert, ODD, ODD)
            }
            Some(_) => {
                both_sides(wgpu::CompareFunction::NotEqual, wgpu::StencilOperation::Zero, ODD, ODD)
            }
        };
        self.make(&Recipe {
            vertex: "patch_vertex",
            fragment: "patch_fragment",
            buffers: &[Some(buffer::<PatchVertex>(wgpu::VertexStepMode::Vertex, &corner))],
            color,
            cull: None,
            depth,
            stencil,
            strip: false,
        })
    }

    fn cut_face(&self) -> CutFacePipelines {
        use wgpu::{CompareFunction as Compare, StencilOperation as Op};
        let side = |op| wgpu::StencilFaceState {
            compare: Compare::Always,
            fail_op: Op::Keep,
            depth_fail_op: op,
            pass_op: op,
        };
        let winding = wgpu::StencilState {
            front: side(Op::DecrementWrap),
            back: side(Op::IncrementWrap),
            read_mask: COUNT,
            write_mask: COUNT,
        };
        let square = |fragment, color, depth, stencil| {
            let cut_face = wgpu::vertex_attr_array![
                0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32x4
            ];
            self.make(&Recipe {
                vertex: "cut_face_vertex",
                fragment,
                buffers: &[Some(buffer::<CutFaceData>(EACH, &cut_face))],
                color,
                cull: None,
                depth,
                stencil,
                strip: true,
            })
        };
        // The reference is `COVERED`: below it, masked, is nothing; above it, whole, is what is
        // covered and counted.
        let counted = both_sides(Compare::NotEqual, Op::Keep, COUNT, 0);
        let covered = both_sides(Compare::Less, Op::Keep, COVERED | COUNT, 0);
        let marked = both_sides(Compare::NotEqual, Op::Replace, COUNT, COVERED | COUNT);
        let (face, near) = (drawn(None), Depth::TestAndWrite);
        CutFacePipelines {
            winding: self.mesh_recipe(
                "mesh_vertex",
                "winding_fragment",
                None,
                None,
                Depth::Ignore,
                winding,
            ),
            face: square("cut_face_fragment", face.clone(), near, counted),
            overlap: square("overlap_fragment", face, near, covered),
            mark: square("mark_fragment", None, Depth::Ignore, marked),
        }
    }

    fn make(&self, recipe: &Recipe<'_>) -> wgpu::RenderPipeline {
        pipeline(self, recipe)
    }
}

/// Of triangles that are seen from either side; where the test passes, whatever the depth says.
fn both_sides(
    compare: wgpu::CompareFunction,
    op: wgpu::StencilOperation,
    read_mask: u32,
    write_mask: u32,
) -> wgpu::StencilState {
    let keep = wgpu::StencilOperation::Keep;
    let face = wgpu::StencilFaceState { compare, fail_op: keep, depth_fail_op: op, pass_op: op };
    wgpu::StencilState { front: face, back: face, read_mask, write_mask }
}

fn buffer<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}

fn pipeline(maker: &Maker<'_>, recipe: &Recipe<'_>) -> wgpu::RenderPipeline {
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
    // Every pass has the picture attached; who leaves it alone writes no channel.
    let untouched = wgpu::ColorTargetState {
        format: COLOR_FORMAT,
        blend: None,
        write_mask: wgpu::ColorWrites::empty(),
    };
    let target = Some(recipe.color.clone().unwrap_or(untouched));
    maker.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.fragment),
        layout: Some(maker.layout),
        vertex: wgpu::VertexState {
            module: maker.shaders,
            entry_point: Some(recipe.vertex),
            compilation_options: Default::default(),
            buffers: recipe.buffers,
        },
        primitive: wgpu::PrimitiveState { topology, cull_mode: recipe.cull, ..Default::default() },
        depth_stencil: maker.depth.map(|format| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(depth_write),
            depth_compare: Some(compare),
            stencil: recipe.stencil.clone(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: maker.shaders,
            entry_point: Some(recipe.fragment),
            compilation_options: Default::default(),
            targets: &[target],
        }),
        multiview_mask: None,
        cache: None,
    })
}
