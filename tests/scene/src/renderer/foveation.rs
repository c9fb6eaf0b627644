//! Fixed foveation by the application itself, for devices without shading rates: a depth template keeps texels from
//! being shaded, and they are filled from their neighbours after the pass.

use std::cell::Cell;
use std::mem::size_of;

use crate::openxr_toolkit::ScreenEllipses;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::{DEPTH_FORMAT, MAX_CAMERAS, Rect};
use crate::camera::Camera;

/// The shader of templates and fills.
pub const FOVEATION_SHADER: &str = include_str!("../foveation.wgsl");
/// A gaze that has moved less than this, degrees, keeps its template, so that most frames only copy it.
const KEEP_DEG: f32 = 0.25;
/// Distance between two cameras' uniforms.
const STRIDE: u64 = 256;

/// Share of the shaded texels over the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Foveation {
    /// By the angle to the gaze.
    Radii(Radii),
    /// By the place on the screen, wherever the eyes look.
    Ellipses(ScreenEllipses),
}

/// All texels are shaded up to `foveal_deg` from the gaze, falling linearly to `peripheral` at `transitional_deg`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Degrees.
    pub foveal_deg: f32,
    /// Degrees.
    pub transitional_deg: f32,
    /// 1/16 or more.
    pub peripheral: f32,
    /// In between 1, 1/4, 1/8 or 1/16 are shaded, the next that is not less, as by the rates of paper A's device.
    pub stepped: bool,
}

/// The layout of `Fovea` in `foveation.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct FoveaUniform {
    tangents: [f32; 4],
    rect: [f32; 4],
    gaze: [f32; 3],
    foveal: f32,
    transitional: f32,
    peripheral: f32,
    stepped: f32,
    padding: f32,
    ellipses: [f32; 4],
}

impl FoveaUniform {
    fn new(foveation: &Foveation, camera: &Camera, rect: &Rect, gaze: Vec3) -> Self {
        let (radii, ellipses) = match foveation {
            Foveation::Radii(radii) => (*radii, [0.0; 4]),
            Foveation::Ellipses(map) => (
                Radii {
                    foveal_deg: 0.0,
                    transitional_deg: 0.0,
                    peripheral: map.periphery.fraction(),
                    stepped: false,
                },
                [map.inner, map.outer, map.horizontal_scale, map.middle.fraction()],
            ),
        };
        Self {
            tangents: camera.tangents,
            rect: [rect.x, rect.y, rect.width, rect.height].map(|side| side as f32),
            gaze: gaze.into(),
            foveal: radii.foveal_deg.to_radians(),
            transitional: radii.transitional_deg.to_radians(),
            peripheral: radii.peripheral,
            stepped: f32::from(u8::from(radii.stepped)),
            padding: 0.0,
            ellipses,
        }
    }
}

/// Pipelines of templates and fills, for all images of a format.
#[derive(Debug)]
pub struct Foveator {
    queue: wgpu::Queue,
    foveation: Foveation,
    template: wgpu::RenderPipeline,
    fill: wgpu::RenderPipeline,
    template_layout: wgpu::BindGroupLayout,
    fill_layout: wgpu::BindGroupLayout,
}

/// Resources of one image: its depth buffer, the template of it, and a copy of its shaded texels.
#[derive(Debug)]
pub struct FoveatedImage {
    /// The depth buffer to draw the scene with; its content is loaded.
    pub depth: wgpu::TextureView,
    depth_texture: wgpu::Texture,
    template: wgpu::Texture,
    template_view: wgpu::TextureView,
    drawn: wgpu::Texture,
    uniforms: wgpu::Buffer,
    template_group: wgpu::BindGroup,
    fill_group: wgpu::BindGroup,
    /// The gazes that the template is for.
    gazes: Cell<Option<[Vec3; MAX_CAMERAS]>>,
}

impl Foveator {
    /// Builds the pipelines for images of a format.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        foveation: Foveation,
    ) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("foveation.wgsl"),
            source: wgpu::ShaderSource::Wgsl(FOVEATION_SHADER.into()),
        });
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: None,
            },
            count: None,
        };
        let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let layout = |label, entries: &[_]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let template_layout = layout("template", &[uniform]);
        let colour = wgpu::TextureSampleType::Float { filterable: false };
        let fill_layout =
            layout("fill", &[uniform, texture(1, wgpu::TextureSampleType::Depth), texture(2, colour)]);
        let pipeline = |stem: &str, layout, targets: &[_], depth_write_enabled, depth_compare| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(stem),
                layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(stem),
                    bind_group_layouts: &[Some(layout)],
                    immediate_size: 0,
                })),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("screen_vertex"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(depth_write_enabled),
                    depth_compare: Some(depth_compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(&format!("{stem}_fragment")),
                    compilation_options: Default::default(),
                    targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            queue: queue.clone(),
            foveation,
            template: pipeline("template", &template_layout, &[], true, wgpu::CompareFunction::Always),
            // The triangle is at depth 0: only where the template skipped.
            fill: pipeline("fill", &fill_layout, &[Some(format.into())], false, wgpu::CompareFunction::Equal),
            template_layout,
            fill_layout,
        }
    }

    /// Resources of an image of a size and format.
    pub fn image(
        &self,
        device: &wgpu::Device,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> FoveatedImage {
        let texture = |label, format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let [attached, sampled] =
            [wgpu::TextureUsages::RENDER_ATTACHMENT, wgpu::TextureUsages::TEXTURE_BINDING];
        let [source, target] = [wgpu::TextureUsages::COPY_SRC, wgpu::TextureUsages::COPY_DST];
        let depth_texture = texture("depth", DEPTH_FORMAT, attached | target);
        let template = texture("template", DEPTH_FORMAT, attached | sampled | source);
        let drawn = texture("drawn", format, sampled | target);
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("foveas"),
            size: STRIDE * MAX_CAMERAS as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let fovea = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &uniforms,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<FoveaUniform>() as u64),
        });
        let [template_view, drawn_view] =
            [&template, &drawn].map(|texture| texture.create_view(&Default::default()));
        let group = |layout, resources: &[wgpu::BindingResource]| {
            let entries: Vec<_> = (0..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let template_group = group(&self.template_layout, std::slice::from_ref(&fovea));
        let fill_group = group(
            &self.fill_layout,
            &[
                fovea,
                wgpu::BindingResource::TextureView(&template_view),
                wgpu::BindingResource::TextureView(&drawn_view),
            ],
        );
        FoveatedImage {
            depth: depth_texture.create_view(&Default::default()),
            depth_texture,
            template,
            template_view,
            drawn,
            uniforms,
            template_group,
            fill_group,
            gazes: Cell::new(None),
        }
    }

    /// Records the commands before the scene: the template, drawn again if the gaze has moved, into the depth buffer. `gaze` is a direction
    /// in the world; `views` are cameras and their rectangles of the image.
    pub fn begin(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &FoveatedImage,
        gaze: Vec3,
        views: &[(Camera, Rect)],
    ) {
        let mut gazes = [Vec3::NEG_Z; MAX_CAMERAS];
        if let Foveation::Radii(_) = self.foveation {
            for (local, (camera, _)) in gazes.iter_mut().zip(views) {
                *local = (camera.orientation.inverse() * gaze).normalize_or(Vec3::NEG_Z);
            }
        }
        let has_moved = image.gazes.get().is_none_or(|old| {
            old.iter().zip(&gazes).any(|(old, new)| old.angle_between(*new).to_degrees() > KEEP_DEG)
        });
        if has_moved {
            self.draw_template(encoder, image, &gazes, views);
            image.gazes.set(Some(gazes));
        }
        encoder.copy_texture_to_texture(
            image.template.as_image_copy(),
            image.depth_texture.as_image_copy(),
            image.template.size(),
        );
    }

    fn draw_template(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &FoveatedImage,
        gazes: &[Vec3],
        views: &[(Camera, Rect)],
    ) {
        for (index, ((camera, rect), gaze)) in (0..).zip(views.iter().zip(gazes)) {
            let uniform = FoveaUniform::new(&self.foveation, camera, rect, *gaze);
            self.queue.write_buffer(&image.uniforms, STRIDE * index, bytemuck::bytes_of(&uniform));
        }
        let mut recording = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("template"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &image.template_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        recording.set_pipeline(&self.template);
        draw_views(&mut recording, &image.template_group, views.iter().map(|(_, rect)| *rect));
    }

    /// Records the commands after the scene: fills skipped texels. `colour` is a view of `texture` and its `layer`.
    pub fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &FoveatedImage,
        (texture, layer): (&wgpu::Texture, u32),
        colour: &wgpu::TextureView,
        views: &[(Camera, Rect)],
    ) {
        let mut source = texture.as_image_copy();
        source.origin.z = layer;
        encoder.copy_texture_to_texture(source, image.drawn.as_image_copy(), image.drawn.size());
        let mut recording = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("fill"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &image.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        recording.set_pipeline(&self.fill);
        draw_views(&mut recording, &image.fill_group, views.iter().map(|(_, rect)| *rect));
    }
}

/// Draws a triangle over each view's rectangle, with its own uniform.
fn draw_views(recording: &mut wgpu::RenderPass, group: &wgpu::BindGroup, rects: impl Iterator<Item = Rect>) {
    for (index, rect) in (0..).zip(rects) {
        let [x, y, width, height] = [rect.x, rect.y, rect.width, rect.height].map(|side| side as f32);
        recording.set_viewport(x, y, width, height, 0.0, 1.0);
        recording.set_scissor_rect(rect.x, rect.y, rect.width, rect.height);
        recording.set_bind_group(0, group, &[STRIDE as u32 * index]);
        recording.draw(0..3, 0..1);
    }
}
