//! The scene's buffers: shapes, written once, and parameters that change each frame.

use std::mem::size_of;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::MAX_CAMERAS;
use crate::camera::{Camera, ViewUniform};
use crate::scene::environment::Environment;
use crate::scene::lights::{self, Light};
use crate::scene::mesh::Vertex;
use crate::scene::{Material, Placement, Scene};

/// Distance between two cameras' uniforms: wgpu's largest required alignment of dynamic offsets.
const VIEW_STRIDE: u64 = 256;

/// Range of a part in the shared vertex and index buffers.
#[derive(Debug)]
pub struct PartRange {
    pub material: Material,
    pub indices: Range<u32>,
    pub base_vertex: i32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct LightUniform {
    position: [f32; 3],
    inverse_range_2: f32,
    colour: [f32; 3],
    padding: f32,
}

/// One instance, as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Instance {
    transform: [f32; 16],
    emission: [f32; 3],
    tint: [f32; 3],
}

#[derive(Debug)]
pub struct Buffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub instances: wgpu::Buffer,
    pub views: wgpu::Buffer,
    pub lights: wgpu::Buffer,
    pub environment: wgpu::Buffer,
    pub ranges: Vec<PartRange>,
}

impl Buffers {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene, light_count: u32) -> Self {
        let (mut vertices, mut indices, mut ranges) = (Vec::<Vertex>::new(), Vec::<u32>::new(), Vec::new());
        for part in &scene.parts {
            let first = indices.len() as u32;
            let base_vertex = vertices.len() as i32;
            vertices.extend(&part.mesh.vertices);
            indices.extend(&part.mesh.indices);
            ranges.push(PartRange {
                material: part.material,
                indices: first..indices.len() as u32,
                base_vertex,
            });
        }
        let buffer = |label, size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        // As many at all times.
        let instances = scene.placements(0.0, &scene.lights(0.0, light_count)).len();
        let this = Self {
            vertices: buffer("vertices", size_of::<Vertex>() * vertices.len(), wgpu::BufferUsages::VERTEX),
            indices: buffer("indices", size_of::<u32>() * indices.len(), wgpu::BufferUsages::INDEX),
            instances: buffer("instances", size_of::<Instance>() * instances, wgpu::BufferUsages::VERTEX),
            views: buffer("views", VIEW_STRIDE as usize * MAX_CAMERAS, wgpu::BufferUsages::UNIFORM),
            lights: buffer(
                "lights",
                size_of::<LightUniform>() * lights::MAX as usize,
                wgpu::BufferUsages::UNIFORM,
            ),
            environment: buffer("environment", size_of::<Environment>(), wgpu::BufferUsages::UNIFORM),
            ranges,
        };
        queue.write_buffer(&this.vertices, 0, bytemuck::cast_slice(&vertices));
        queue.write_buffer(&this.indices, 0, bytemuck::cast_slice(&indices));
        // The courtyard's shader does not read it.
        let environment = scene.name.definition().environment.unwrap_or(Environment::DAY);
        queue.write_buffer(&this.environment, 0, bytemuck::bytes_of(&environment));
        this
    }

    /// Offset of a camera in the buffer of views.
    pub fn view_offset(camera: usize) -> u32 {
        (VIEW_STRIDE * camera as u64) as u32
    }

    /// The part of the buffer of views that one camera takes.
    pub fn view_binding(&self) -> wgpu::BufferBinding<'_> {
        wgpu::BufferBinding {
            buffer: &self.views,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<ViewUniform>() as u64),
        }
    }

    /// Uploads a frame's cameras, lights and placements.
    pub fn write(
        &self,
        queue: &wgpu::Queue,
        time: f64,
        cameras: &[Camera],
        lights: &[Light],
        placements: &[Placement],
    ) {
        for (index, camera) in cameras.iter().take(MAX_CAMERAS).enumerate() {
            let uniform = camera.uniform(time, lights.len() as u32);
            queue.write_buffer(&self.views, VIEW_STRIDE * index as u64, bytemuck::bytes_of(&uniform));
        }
        let lights: Vec<_> = lights
            .iter()
            .map(|light| LightUniform {
                position: light.position.into(),
                inverse_range_2: 1.0 / (light.range * light.range),
                colour: light.colour.into(),
                padding: 0.0,
            })
            .collect();
        queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&lights));
        let instances: Vec<_> = placements
            .iter()
            .map(|placement| Instance {
                transform: placement.transform.to_cols_array(),
                emission: placement.emission.into(),
                tint: placement.tint.into(),
            })
            .collect();
        queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&instances));
    }
}
