//! Draws without OpenXR, for stills, tests and the measurement of a frame's cost.

use anyhow::{Context, Result};
use glam::Vec3;

use crate::camera::Camera;
use crate::renderer::{FoveatedImage, Foveation, Foveator, Pass, Rect, Renderer, depth_buffer};
use crate::scene::{SceneName, time_of};

/// A renderer with an image of its own to draw into.
#[derive(Debug)]
pub struct Offscreen {
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
    image: wgpu::Texture,
    depth: wgpu::TextureView,
    foveation: Option<(Foveator, FoveatedImage)>,
    /// Name of the device and its driver.
    pub device_name: String,
}

impl Offscreen {
    /// Opens the first Vulkan device for images of `width` x `height` in an 8-bit format.
    ///
    /// # Errors
    /// If there is no Vulkan device or it cannot be opened.
    pub fn new(
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
        scene: SceneName,
        light_count: u32,
    ) -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .context("no Vulkan device")?;
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))
            .context("opening the Vulkan device")?;
        let image = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("image"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self {
            renderer: Renderer::new(&device, &queue, format, scene, light_count),
            depth: depth_buffer(&device, width, height),
            foveation: None,
            device,
            queue,
            image,
            device_name: format!("{}, {} {}", info.name, info.driver, info.driver_info),
        })
    }

    /// Draws with fixed foveation from now on, or with none.
    pub fn set_foveation(&mut self, foveation: Option<Foveation>) {
        let (device, format) = (&self.device, self.image.format());
        self.foveation = foveation.map(|foveation| {
            let foveator = Foveator::new(device, &self.queue, format, foveation);
            let image = foveator.image(device, [self.image.width(), self.image.height()], format);
            (foveator, image)
        });
    }

    /// Draws a frame as [`Self::draw_gazing`] does, with the gaze at the centre of the first camera's view.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw(&mut self, frame: u64, cameras: &[Camera]) -> Result<()> {
        let ahead = cameras.first().map_or(Vec3::NEG_Z, |camera| camera.orientation * Vec3::NEG_Z);
        self.draw_gazing(frame, cameras, ahead)
    }

    /// Draws a frame as the cameras see it, side by side, and waits until it is done. The gaze is a direction in the
    /// world; it counts only with foveation.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw_gazing(&mut self, frame: u64, cameras: &[Camera], gaze: Vec3) -> Result<()> {
        self.renderer.prepare(time_of(frame), false, cameras);
        let width = self.image.width() / cameras.len() as u32;
        let rects: Vec<_> = (0..cameras.len())
            .map(|index| Rect { x: width * index as u32, y: 0, width, height: self.image.height() })
            .collect();
        let views: Vec<_> = rects.iter().copied().enumerate().collect();
        let seen: Vec<_> = cameras.iter().copied().zip(rects).collect();
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let colour = self.image.create_view(&wgpu::TextureViewDescriptor::default());
        if let Some((foveator, image)) = &self.foveation {
            foveator.begin(&mut encoder, image, gaze, &seen);
            let pass = Pass {
                colour: &colour,
                depth: &image.depth,
                clear_depth: false,
                keep_depth: true,
                views: &views,
            };
            self.renderer.draw(&mut encoder, &pass);
            foveator.finish(&mut encoder, image, (&self.image, 0), &colour, &seen);
        } else {
            let pass = Pass {
                colour: &colour,
                depth: &self.depth,
                clear_depth: true,
                keep_depth: false,
                views: &views,
            };
            self.renderer.draw(&mut encoder, &pass);
        }
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::PollType::wait_indefinitely()).context("waiting for the frame")?;
        Ok(())
    }

    /// The image's texels, four bytes each, rows from the top.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn texels(&self) -> Result<Vec<u8>> {
        let (width, height) = (self.image.width(), self.image.height());
        let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("texels"),
            size: u64::from(stride * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.image.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride),
                    rows_per_image: None,
                },
            },
            self.image.size(),
        );
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // The receiver below outlives the callback.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).context("waiting for the copy")?;
        receiver.recv()?.context("mapping the copy")?;
        let mapped = buffer.slice(..).get_mapped_range()?;
        Ok(mapped.chunks_exact(stride as usize).flat_map(|row| &row[..width as usize * 4]).copied().collect())
    }
}
