//! `compose`: from the image that the application rendered to the image that the runtime shows.
//!
//! A whole image is copied, with all its layers; then the tiles of each region that have work are drawn over
//! the copy, reading the application's image. Alpha, and pixels without work, stay as they were copied.

mod app_images;
mod draws;
mod runtime_images;
mod shape;

pub use app_images::{APP_USAGE, AppImages};
pub use parafovea_core::kernels::compose::ComposeParams;
pub use runtime_images::{RUNTIME_USAGE, RuntimeImages};
pub use shape::{SwapchainShape, stores_unit_range};

use crate::gpu::barrier::{
    APP_COPIED_TO_RENDERED, APP_COPIED_TO_SAMPLED, APP_RENDERED_TO_COPIED, APP_SAMPLED_TO_RENDERED,
    RUNTIME_ACQUIRED_TO_COPIED, RUNTIME_COPIED_TO_DRAWN,
};
use crate::gpu::{Gpu, GpuError, Recorder, TilePipeline, UniformRing, UniformSet, Uses, tile_pipeline};
use ash::vk;
use draws::Draws;
use std::sync::Arc;

/// Most regions in one submit: the 16 layers that every OpenXR runtime takes, of up to four views each.
pub const MAX_REGIONS: usize = 64;

/// One rectangle of one array layer that gets processed.
#[derive(Clone, Copy, Debug)]
pub struct ComposeRegion {
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle, in pixels; what lies outside of the image, or of the rectangle in `params`, is ignored.
    pub rect: vk::Rect2D,
    /// What is done there.
    pub params: ComposeParams,
}

/// One image to copy and process. An image appears in one job of a submit only.
#[derive(Clone, Copy)]
pub struct ComposeJob<'a> {
    /// Where the picture comes from.
    pub app: &'a AppImages,
    /// Which of those images.
    pub app_index: u32,
    /// Where it goes; of the same format, extent and layers.
    pub runtime: &'a RuntimeImages,
    /// Which of those images.
    pub runtime_index: u32,
    /// What is processed; all the rest is only copied. Where regions overlap, the last one counts.
    pub regions: &'a [ComposeRegion],
}

/// The pass.
pub struct Compose {
    // First: waits before the rest is destroyed.
    uses: Uses,
    pipelines: Vec<(vk::Format, TilePipeline)>,
    uniforms: UniformRing<ComposeParams>,
    uniform_set: UniformSet,
    gpu: Arc<Gpu>,
}

impl Compose {
    /// Prepares the pass.
    ///
    /// # Errors
    /// [`GpuError::Call`] or [`GpuError::Unsupported`] when memory or objects cannot be had.
    pub fn new(gpu: Arc<Gpu>) -> Result<Self, GpuError> {
        let uniforms = UniformRing::new(&gpu, MAX_REGIONS as u32)?;
        let uniform_set = UniformSet::new(&uniforms)?;
        Ok(Self { uses: Uses::new(&gpu), pipelines: Vec::new(), uniforms, uniform_set, gpu })
    }

    /// Whether swapchains of this format can be substituted.
    pub fn supports(&self, format: vk::Format) -> bool {
        shape::is_color_format(format) && self.gpu.can_compose(format)
    }

    /// Makes what drawing to this format needs. Otherwise the first frame does, which takes longer then.
    ///
    /// # Errors
    /// [`GpuError::Call`] when the pipeline cannot be made.
    pub fn prepare(&mut self, format: vk::Format) -> Result<(), GpuError> {
        if self.pipelines.iter().any(|(existing, _)| *existing == format) {
            return Ok(());
        }
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/compose.spv"));
        let pipeline = tile_pipeline(&self.gpu, format, spirv, c"tile", c"pixel")?;
        self.pipelines.push((format, pipeline));
        Ok(())
    }

    /// Records all jobs and submits them at once on the binding's queue, without waiting for them. A steady
    /// frame allocates nothing on the heap.
    ///
    /// All images are COLOR_ATTACHMENT_OPTIMAL before and after.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] when an index, a layer or a shape does not fit, an image is in two jobs, or there
    /// are more than [`MAX_REGIONS`]; [`GpuError::Timeout`] when earlier submits hang; a failed call. Then
    /// nothing was submitted.
    pub fn submit(&mut self, jobs: &[ComposeJob]) -> Result<(), GpuError> {
        check(jobs)?;
        for job in jobs {
            self.prepare(job.app.shape().format)?;
        }
        let draws = Draws::new(jobs)?;
        let Self { uniforms, uniform_set, pipelines, gpu, .. } = self;
        let submit = gpu.submit(|recorder| {
            for (number, draw) in (0..).zip(draws.iter()) {
                draw.offset.set(uniforms.write(recorder, number, &draw.params)?);
            }
            record(recorder, jobs, &draws, uniform_set, pipelines);
            Ok(())
        })?;
        self.uses.mark(submit);
        for job in jobs {
            job.app.uses().mark(submit);
            job.runtime.uses().mark(submit);
        }
        Ok(())
    }
}

/// Each step for all jobs before the next step, so that no job waits for another one's.
fn record(
    recorder: &Recorder,
    jobs: &[ComposeJob],
    draws: &Draws,
    uniform_set: &UniformSet,
    pipelines: &[(vk::Format, TilePipeline)],
) {
    for job in jobs {
        recorder.barrier(&APP_RENDERED_TO_COPIED, job.app_image(), job.layers());
        recorder.barrier(&RUNTIME_ACQUIRED_TO_COPIED, job.runtime_image(), job.layers());
    }
    for job in jobs {
        recorder.copy_image(job.app_image(), job.runtime_image(), job.app.shape().extent, job.layers());
    }
    for (number, job) in jobs.iter().enumerate() {
        let app = if draws.any_of(number) { &APP_COPIED_TO_SAMPLED } else { &APP_COPIED_TO_RENDERED };
        recorder.barrier(app, job.app_image(), job.layers());
        recorder.barrier(&RUNTIME_COPIED_TO_DRAWN, job.runtime_image(), job.layers());
    }
    for (number, job) in jobs.iter().enumerate() {
        draw(recorder, number, job, draws, uniform_set, pipelines);
    }
    for (_, job) in jobs.iter().enumerate().filter(|(number, _)| draws.any_of(*number)) {
        recorder.barrier(&APP_SAMPLED_TO_RENDERED, job.app_image(), job.layers());
    }
}

/// Draws the regions of one job, one render pass for each layer that has any.
fn draw(
    recorder: &Recorder,
    number: usize,
    job: &ComposeJob,
    draws: &Draws,
    uniform_set: &UniformSet,
    pipelines: &[(vk::Format, TilePipeline)],
) {
    let format = job.app.shape().format;
    let Some((_, pipeline)) = pipelines.iter().find(|(existing, _)| *existing == format) else { return };
    for layer in 0..job.layers() {
        let mut of_layer = draws.iter().filter(|draw| draw.job == number && draw.layer == layer).peekable();
        let target = job.runtime.target(job.runtime_index, layer);
        let texture = job.app.texture(job.app_index, layer);
        let (Some(_), Some(target), Some(texture)) = (of_layer.peek(), target, texture) else { continue };
        recorder.draw_to(target, |pass| {
            for draw in of_layer {
                let uniforms = (uniform_set, draw.offset.get());
                pass.draw_tiles(pipeline, uniforms, texture, draw.viewport, draw.scissor, draw.tiles);
            }
        });
    }
}

impl ComposeJob<'_> {
    fn layers(&self) -> u32 {
        self.app.shape().array_layers
    }

    fn app_image(&self) -> vk::Image {
        self.app.images()[self.app_index as usize]
    }

    fn runtime_image(&self) -> vk::Image {
        self.runtime.images()[self.runtime_index as usize]
    }
}

/// Refuses jobs that would be undefined behaviour to record.
fn check(jobs: &[ComposeJob]) -> Result<(), GpuError> {
    for (number, job) in jobs.iter().enumerate() {
        if job.app_index as usize >= job.app.images().len()
            || job.runtime_index as usize >= job.runtime.images().len()
        {
            return Err(GpuError::Invalid("an image index out of range"));
        }
        if !job.app.shape().fits(job.runtime.shape()) {
            return Err(GpuError::Invalid("two swapchains of different shape"));
        }
        let twice = |other: &ComposeJob| {
            other.app_image() == job.app_image() || other.runtime_image() == job.runtime_image()
        };
        if jobs[..number].iter().any(twice) {
            return Err(GpuError::Invalid("an image in two jobs"));
        }
    }
    Ok(())
}
