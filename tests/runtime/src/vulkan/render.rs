//! Rendering for the compositor: passes over the application's images, and pixels read back.

mod pipelines;
mod resources;

use super::{Gpu, Shape};
use crate::compositor::Params;
use crate::fault::Fault;
use ash::vk;
use pipelines::{Pipelines, Purpose};
use resources::{Buffer, Descriptors, Target, View};
use std::sync::Arc;

/// An image of the application to sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    image: vk::Image,
    format: vk::Format,
    layout: vk::ImageLayout,
    range: vk::ImageSubresourceRange,
}

impl Source {
    pub fn new(image: vk::Image, shape: &Shape) -> Self {
        Self { image, format: shape.format, layout: shape.layout(), range: shape.range() }
    }
}

/// Work for one picture.
pub(crate) enum Job {
    /// A sub-image as a picture.
    Picture { source: Source, extent: vk::Extent2D, params: Params },
    /// An eye: draws over each other, and a picture where parameters for it are given.
    Eye { eye: usize, extent: vk::Extent2D, draws: Vec<(Source, Params)>, save: Option<Params> },
}

/// A picture: rows from the top, RGBA, 8 bits each.
pub(crate) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<u8>,
}

/// Renders for a session.
pub(crate) struct Renderer {
    /// Linear light of each eye.
    eyes: Vec<Target>,
    pipelines: Pipelines,
    gpu: Arc<Gpu>,
}

/// A pass: one target, draws over each other.
struct Pass<'a> {
    target: &'a Target,
    purpose: Purpose,
    sets: Vec<vk::DescriptorSet>,
    readback: Option<&'a Buffer>,
}

impl Renderer {
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, Fault> {
        Ok(Self { eyes: Vec::new(), pipelines: Pipelines::new(gpu)?, gpu: gpu.clone() })
    }

    /// Does the jobs in one submission, and returns the picture of each that has one.
    pub fn run(&mut self, jobs: &[Job]) -> Result<Vec<Option<Pixels>>, Fault> {
        self.prepare_eyes(jobs)?;
        let pictures = jobs.iter().map(|job| self.picture(job)).collect::<Result<Vec<_>, _>>()?;
        let mut draws = Draws::new(&self.gpu, &self.pipelines, jobs)?;
        let mut passes = Vec::new();
        for (job, picture) in jobs.iter().zip(&pictures) {
            let readback = picture.as_ref().map(|(target, buffer)| (target, buffer));
            match job {
                Job::Picture { source, params, .. } => {
                    let sets = vec![draws.of_source(source, params)?];
                    passes.extend(readback.map(|(target, buffer)| Pass {
                        target,
                        purpose: Purpose::Picture,
                        sets,
                        readback: Some(buffer),
                    }));
                }
                Job::Eye { eye, draws: layers, save, .. } => {
                    let target = &self.eyes[*eye];
                    let sets = layers.iter().map(|(source, params)| draws.of_source(source, params));
                    let sets = sets.collect::<Result<_, _>>()?;
                    passes.push(Pass { target, purpose: Purpose::Layer, sets, readback: None });
                    if let (Some(params), Some((picture, buffer))) = (save, readback) {
                        let sets = vec![draws.of_view(target.view(), params)];
                        let (purpose, readback) = (Purpose::Picture, Some(buffer));
                        passes.push(Pass { target: picture, purpose, sets, readback });
                    }
                }
            }
        }
        self.gpu.run(|device, commands| {
            borrow_images(device, commands, &draws.sources, Direction::ToUs);
            passes.iter().for_each(|pass| self.pipelines.record(device, commands, pass));
            borrow_images(device, commands, &draws.sources, Direction::ToApplication);
        })?;
        let read = |picture: &Option<(Target, Buffer)>| {
            picture.as_ref().map(|(target, buffer)| pixels(target, buffer))
        };
        Ok(pictures.iter().map(read).collect())
    }

    fn prepare_eyes(&mut self, jobs: &[Job]) -> Result<(), Fault> {
        for job in jobs {
            if let Job::Eye { eye, extent, .. } = job
                && *eye == self.eyes.len()
            {
                self.eyes.push(Target::new(
                    &self.gpu,
                    self.pipelines.pass(Purpose::Layer),
                    Purpose::Layer,
                    *extent,
                )?);
            }
        }
        Ok(())
    }

    fn picture(&self, job: &Job) -> Result<Option<(Target, Buffer)>, Fault> {
        let extent = match job {
            Job::Picture { extent, .. } | Job::Eye { extent, save: Some(_), .. } => *extent,
            Job::Eye { save: None, .. } => return Ok(None),
        };
        let target = Target::new(&self.gpu, self.pipelines.pass(Purpose::Picture), Purpose::Picture, extent)?;
        let size = u64::from(extent.width) * u64::from(extent.height) * 4;
        let buffer = Buffer::new(&self.gpu, size, vk::BufferUsageFlags::TRANSFER_DST)?;
        Ok(Some((target, buffer)))
    }
}

fn pixels(target: &Target, buffer: &Buffer) -> Pixels {
    let vk::Extent2D { width, height } = target.extent();
    Pixels { width, height, rgba: buffer.bytes().to_vec() }
}

/// Parameters and images of the draws of a frame.
struct Draws<'a> {
    gpu: &'a Arc<Gpu>,
    descriptors: Descriptors,
    params: Buffer,
    used: u64,
    views: Vec<View>,
    /// The application's images, each once.
    sources: Vec<Source>,
}

/// Distance of parameters in their buffer: every device allows multiples of 256 (`minUniformBufferOffsetAlignment`).
const STRIDE: u64 = 256;

impl<'a> Draws<'a> {
    fn new(gpu: &'a Arc<Gpu>, pipelines: &Pipelines, jobs: &[Job]) -> Result<Self, Fault> {
        let count = |job: &Job| match job {
            Job::Picture { .. } => 1,
            Job::Eye { draws, save, .. } => draws.len() + usize::from(save.is_some()),
        };
        // A frame without layers draws nothing, but pools and buffers are not empty.
        let count = jobs.iter().map(count).sum::<usize>().max(1);
        Ok(Self {
            gpu,
            descriptors: Descriptors::new(gpu, pipelines, count as u32)?,
            params: Buffer::new(gpu, count as u64 * STRIDE, vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            used: 0,
            views: Vec::new(),
            sources: Vec::new(),
        })
    }

    fn of_source(&mut self, source: &Source, params: &Params) -> Result<vk::DescriptorSet, Fault> {
        if !self.sources.iter().any(|known| known.image == source.image) {
            self.sources.push(*source);
        }
        let view = View::new(self.gpu, source.image, source.format, source.range.layer_count)?;
        let set = self.of_view(view.handle(), params);
        self.views.push(view);
        Ok(set)
    }

    fn of_view(&mut self, view: vk::ImageView, params: &Params) -> vk::DescriptorSet {
        let offset = self.used * STRIDE;
        self.params.write(offset as usize, bytemuck::bytes_of(params));
        let set = self.descriptors.set(self.used as usize, view, self.params.handle(), offset);
        self.used += 1;
        set
    }
}

/// New owner of the application's images.
#[derive(Clone, Copy, PartialEq)]
enum Direction {
    ToUs,
    ToApplication,
}

/// Brings the application's images into the layout for sampling, and back. The application's own work on them comes
/// before in submission order, or after: both sides name all stages.
fn borrow_images(
    device: &ash::Device,
    commands: vk::CommandBuffer,
    sources: &[Source],
    direction: Direction,
) {
    let everything =
        (vk::PipelineStageFlags::ALL_COMMANDS, vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
    let sampling = (vk::PipelineStageFlags::FRAGMENT_SHADER, vk::AccessFlags::SHADER_READ);
    let (from, to) = match direction {
        Direction::ToUs => (everything, sampling),
        Direction::ToApplication => (sampling, everything),
    };
    let barrier = |source: &Source| {
        let layouts = [source.layout, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL];
        let (old, new) = match direction {
            Direction::ToUs => (layouts[0], layouts[1]),
            Direction::ToApplication => (layouts[1], layouts[0]),
        };
        vk::ImageMemoryBarrier::default()
            .src_access_mask(from.1)
            .dst_access_mask(to.1)
            .old_layout(old)
            .new_layout(new)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(source.image)
            .subresource_range(source.range)
    };
    let barriers: Vec<_> = sources.iter().map(barrier).collect();
    if barriers.is_empty() {
        return;
    }
    // SAFETY: the command buffer is being recorded, outside a render pass; the images live as long as their swapchains.
    unsafe {
        let flags = vk::DependencyFlags::empty();
        device.cmd_pipeline_barrier(commands, from.0, to.0, flags, &[], &[], &barriers);
    }
}
