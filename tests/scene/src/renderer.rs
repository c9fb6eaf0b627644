//! Draws the scene with wgpu, one pass for each image; knows nothing of OpenXR.

mod buffers;
mod foveation;
mod images;
mod pipelines;

use std::collections::HashMap;
use std::ops::Range;

use crate::camera::Camera;
use crate::scene::{Material, Scene, SceneName};

use self::buffers::Buffers;
pub use self::foveation::{FOVEATION_SHADER, FoveatedImage, Foveation, Foveator, Radii};
use self::pipelines::Pipelines;
pub use self::pipelines::{Output, SCENES_SHADER, SHADER};

/// The depth format of every pass.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The most cameras of a frame.
pub const MAX_CAMERAS: usize = 2;

/// A rectangle of an image in texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Width.
    pub width: u32,
    /// Height.
    pub height: u32,
}

/// One render pass: an image and its cameras.
#[derive(Debug)]
pub struct Pass<'a> {
    /// Colour attachment.
    pub colour: &'a wgpu::TextureView,
    /// A depth buffer of the same size.
    pub depth: &'a wgpu::TextureView,
    /// Whether the depth buffer is cleared at the start.
    pub clear_depth: bool,
    /// Whether the depth buffer is read after the pass.
    pub keep_depth: bool,
    /// Index of each camera in the frame, and its rectangle of the image.
    pub views: &'a [(usize, Rect)],
}

/// Everything that lives as long as the application.
#[derive(Debug)]
pub struct Renderer {
    queue: wgpu::Queue,
    scene: Scene,
    light_count: u32,
    pipelines: Pipelines,
    buffers: Buffers,
    view_group: wgpu::BindGroup,
    material_groups: HashMap<Material, wgpu::BindGroup>,
    /// The draws of the frame: a part, and the instances of it that follow one another.
    draws: Vec<(usize, Range<u32>)>,
}

impl Renderer {
    /// Uploads the scene and builds the pipelines for images of a format.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        scene: SceneName,
        light_count: u32,
    ) -> Self {
        let pipelines = Pipelines::new(device, format, scene.definition().environment.as_ref());
        let scene = Scene::new(scene);
        let buffers = Buffers::new(device, queue, &scene, light_count);
        let mut materials = scene.materials();
        // The quad layer shows it in every scene.
        if !materials.contains(&Material::Board) {
            materials.push(Material::Board);
        }
        let images = images::Images::new(device, queue, &materials);
        let view_group = pipelines.view_group(device, &buffers, &images);
        let material_groups = images
            .materials()
            .map(|(material, images)| (material, pipelines.material_group(device, images)))
            .collect();
        Self {
            queue: queue.clone(),
            scene,
            light_count,
            pipelines,
            buffers,
            view_group,
            material_groups,
            draws: Vec::new(),
        }
    }

    /// Writes a frame's parameters: its cameras, and lights, unless it is dark, and moving things as of its animation time, seconds. At
    /// most [`MAX_CAMERAS`] cameras are taken.
    pub fn prepare(&mut self, time: f64, is_dark: bool, cameras: &[Camera]) {
        let lights = self.scene.lights(time, if is_dark { 0 } else { self.light_count });
        let placements = self.scene.placements(time, &lights);
        self.buffers.write(&self.queue, time, cameras, &lights, &placements);
        self.draws.clear();
        for (instance, placement) in (0..).zip(&placements) {
            match self.draws.last_mut() {
                Some((part, instances)) if *part == placement.part => instances.end = instance + 1,
                _ => self.draws.push((placement.part, instance..instance + 1)),
            }
        }
    }

    /// Records one pass of the prepared frame.
    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, pass: &Pass) {
        let depth_store = if pass.keep_depth { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
        let depth_load = if pass.clear_depth { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
        let mut recording = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.scene.name.as_str()),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: pass.colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: pass.depth,
                depth_ops: Some(wgpu::Operations { load: depth_load, store: depth_store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        for &(camera, rect) in pass.views {
            recording.set_viewport(
                rect.x as f32,
                rect.y as f32,
                rect.width as f32,
                rect.height as f32,
                0.0,
                1.0,
            );
            recording.set_scissor_rect(rect.x, rect.y, rect.width, rect.height);
            recording.set_bind_group(0, &self.view_group, &[Buffers::view_offset(camera)]);
            self.draw_scene(&mut recording);
        }
    }

    fn draw_scene(&self, recording: &mut wgpu::RenderPass) {
        recording.set_vertex_buffer(0, self.buffers.vertices.slice(..));
        recording.set_vertex_buffer(1, self.buffers.instances.slice(..));
        recording.set_index_buffer(self.buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
        if let Some(leaves) = &self.pipelines.leaves {
            self.draw_parts(recording, leaves, Material::is_leafy);
        }
        self.draw_parts(recording, &self.pipelines.surfaces, |material| !material.is_leafy());
        if let Some(mirror) = &self.pipelines.mirror {
            self.draw_parts(recording, mirror, |material| !material.is_leafy());
        }
        // The sky comes last, where nothing else was drawn.
        recording.set_pipeline(&self.pipelines.sky);
        recording.draw(0..3, 0..1);
    }

    fn draw_parts(
        &self,
        recording: &mut wgpu::RenderPass,
        pipeline: &wgpu::RenderPipeline,
        takes: fn(Material) -> bool,
    ) {
        recording.set_pipeline(pipeline);
        for (part, instances) in &self.draws {
            let range = &self.buffers.ranges[*part];
            if takes(range.material) {
                recording.set_bind_group(1, &self.material_groups[&range.material], &[]);
                recording.draw_indexed(range.indices.clone(), range.base_vertex, instances.clone());
            }
        }
    }

    /// Records a pass that fills an image with the notice board, for a quad layer.
    pub fn draw_board(&self, encoder: &mut wgpu::CommandEncoder, colour: &wgpu::TextureView) {
        let mut recording = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("notice board"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        recording.set_pipeline(&self.pipelines.board);
        recording.set_bind_group(0, &self.view_group, &[Buffers::view_offset(0)]);
        recording.set_bind_group(1, &self.material_groups[&Material::Board], &[]);
        recording.draw(0..3, 0..1);
    }
}

/// A depth buffer for passes of a size, and a view of it.
pub fn depth_buffer(device: &wgpu::Device, width: u32, height: u32) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
