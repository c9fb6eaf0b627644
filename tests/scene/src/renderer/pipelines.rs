//! Pipelines and their bind groups.

use std::mem::size_of;

use super::DEPTH_FORMAT;
use super::buffers::{Buffers, Instance};
use super::images::{Images, MaterialImages};
use crate::scene::environment::Environment;
use crate::scene::mesh::Vertex;

/// The shader of the courtyard, and the first part of every other scene's.
pub const SHADER: &str = include_str!("../scene.wgsl");
/// The rest of the shader of the other scenes.
pub const SCENES_SHADER: &str = include_str!("../scenes.wgsl");

/// Output of the fragment shaders; the values of `OUTPUT` in `scene.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Tone-mapped; the format encodes sRGB.
    Linear = 0,
    /// Tone-mapped and sRGB-encoded by the shader.
    Encoded = 1,
    /// Linear light without an upper end.
    Unbounded = 2,
}

impl Output {
    /// Pipelines of an image format.
    pub fn of(format: wgpu::TextureFormat) -> Self {
        match format {
            wgpu::TextureFormat::Rgba16Float => Self::Unbounded,
            format if format.is_srgb() => Self::Linear,
            _ => Self::Encoded,
        }
    }
}

#[derive(Debug)]
pub struct Pipelines {
    pub surfaces: wgpu::RenderPipeline,
    /// Of materials that alpha cuts out; the courtyard has none.
    pub leaves: Option<wgpu::RenderPipeline>,
    /// The world in a mirror, where the scene has one.
    pub mirror: Option<wgpu::RenderPipeline>,
    pub sky: wgpu::RenderPipeline,
    pub board: wgpu::RenderPipeline,
    view_layout: wgpu::BindGroupLayout,
    material_layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
}

impl Pipelines {
    /// The pipelines of the courtyard, or of a scene with this environment.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        environment: Option<&Environment>,
    ) -> Self {
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view"),
            entries: &[
                uniform(0, wgpu::ShaderStages::VERTEX_FRAGMENT, true),
                uniform(1, wgpu::ShaderStages::FRAGMENT, false),
                texture(2),
                wgpu::BindGroupLayoutEntry {
                    binding: 3,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
                uniform(4, wgpu::ShaderStages::VERTEX_FRAGMENT, false),
            ],
        });
        let material_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("material"),
            entries: &[texture(0), texture(1)],
        });
        let source = match environment {
            None => SHADER.into(),
            Some(_) => format!("{SHADER}\n{SCENES_SHADER}").into(),
        };
        let builder = Builder {
            device,
            module: device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("scene.wgsl"),
                source: wgpu::ShaderSource::Wgsl(source),
            }),
            layout: device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &[Some(&view_layout), Some(&material_layout)],
                immediate_size: 0,
            }),
            format,
        };
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("repeating"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let behind = wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let (surface, sky) =
            if environment.is_some() { ("lit", "weather_fragment") } else { ("surface", "sky_fragment") };
        let has_mirror = environment.is_some_and(|environment| environment.has_mirror > 0.0);
        Self {
            surfaces: builder.surfaces(surface, Some(wgpu::Face::Back)),
            leaves: environment.map(|_| builder.surfaces("leaf", None)),
            // In a mirror, triangles turn the other way round.
            mirror: has_mirror.then(|| builder.surfaces("mirror", Some(wgpu::Face::Front))),
            sky: builder.screen("sky_vertex", sky, Some(behind)),
            board: builder.screen("board_vertex", "board_fragment", None),
            view_layout,
            material_layout,
            sampler,
        }
    }

    pub fn view_group(&self, device: &wgpu::Device, buffers: &Buffers, images: &Images) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &self.view_layout,
            entries: &[
                entry(0, wgpu::BindingResource::Buffer(buffers.view_binding())),
                entry(1, buffers.lights.as_entire_binding()),
                entry(2, wgpu::BindingResource::TextureView(&images.detail)),
                entry(3, wgpu::BindingResource::Sampler(&self.sampler)),
                entry(4, buffers.environment.as_entire_binding()),
            ],
        })
    }

    pub fn material_group(&self, device: &wgpu::Device, images: &MaterialImages) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("material"),
            layout: &self.material_layout,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&images.albedo)),
                entry(1, wgpu::BindingResource::TextureView(&images.relief)),
            ],
        })
    }
}

struct Builder<'a> {
    device: &'a wgpu::Device,
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
}

impl Builder<'_> {
    fn surfaces(&self, stem: &str, cull_mode: Option<wgpu::Face>) -> wgpu::RenderPipeline {
        let vertex = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![
                0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x2, 4 => Float32
            ],
        };
        let instance = wgpu::VertexBufferLayout {
            array_stride: size_of::<Instance>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![
                5 => Float32x4, 6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x3,
                10 => Float32x3
            ],
        };
        let depth = wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let entries = [format!("{stem}_vertex"), format!("{stem}_fragment")];
        self.build([&entries[0], &entries[1]], &[Some(vertex), Some(instance)], cull_mode, Some(depth))
    }

    /// A pipeline that draws one triangle over the whole target.
    fn screen(
        &self,
        vertex: &str,
        fragment: &str,
        depth: Option<wgpu::DepthStencilState>,
    ) -> wgpu::RenderPipeline {
        self.build([vertex, fragment], &[], None, depth)
    }

    fn build(
        &self,
        [vertex, fragment]: [&str; 2],
        buffers: &[Option<wgpu::VertexBufferLayout>],
        cull_mode: Option<wgpu::Face>,
        depth_stencil: Option<wgpu::DepthStencilState>,
    ) -> wgpu::RenderPipeline {
        let constants = [("OUTPUT", f64::from(Output::of(self.format) as u32))];
        let fragment_options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
            depth_stencil,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(fragment),
                compilation_options: fragment_options,
                targets: &[Some(self.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn uniform(
    binding: u32,
    visibility: wgpu::ShaderStages,
    has_dynamic_offset: bool,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        },
        count: None,
    }
}

fn texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

fn entry(binding: u32, resource: wgpu::BindingResource) -> wgpu::BindGroupEntry {
    wgpu::BindGroupEntry { binding, resource }
}
