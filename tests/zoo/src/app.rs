//! Resources of a style, and its input for each frame.

use crate::gpu::{Attachment, Buffer, Gpu, Image, Kind, Pass, PassSpec, passes};
use crate::look::Look;
use crate::scene::{Draw, Pipelines, Scene, Uniforms};
use anyhow::Result;
use ash::vk;
use openxr as xr;
use std::cell::{Cell, RefCell};

/// Both eyes.
pub const EYES: [usize; 2] = [0, 1];

/// Records a frame into its command buffer.
pub type Recorder<'a> = Box<dyn FnMut(&Frame) -> Result<()> + 'a>;

/// Resources that live as long as the session.
pub struct App<'g> {
    pub gpu: &'g Gpu,
    pub scene: Scene,
    /// Seed of random recordings.
    pub seed: u64,
    /// Rules of the look of rates, where that is shown.
    pub look: Option<Look>,
    /// Width and height of an eye buffer.
    pub size: [u32; 2],
    /// Images of each colour swapchain.
    pub color: Vec<Vec<Image>>,
    /// Images of each depth swapchain; none where depth is not submitted.
    pub depth: Vec<Vec<Image>>,
    /// Images of the quad layer's swapchain; none without.
    pub quad: Vec<Image>,
    /// The hidden area of each view: triangles in the plane one metre ahead.
    pub hidden: [Vec<[f32; 2]>; 2],
}

/// A frame that is being rendered.
pub struct Frame<'f> {
    /// Its number, from 0.
    pub index: u64,
    /// Its number in the animation.
    pub animated: u64,
    /// Index among the frames in flight: its part of the uniforms.
    pub slot: usize,
    /// Being recorded; submitted afterwards.
    pub commands: vk::CommandBuffer,
    pub views: &'f [xr::View; 2],
    /// The uniforms written for this frame; a style may write others.
    pub uniforms: Uniforms,
    /// Number of the acquired image of each colour swapchain.
    pub color: Vec<usize>,
    /// Number of the acquired image of each depth swapchain.
    pub depth: Vec<usize>,
    /// Number of the acquired image of the quad layer's swapchain.
    pub quad: usize,
    /// Submitted with `commands`, after them.
    pub after: RefCell<Vec<vk::CommandBuffer>>,
    /// Semaphores that the submission waits for.
    pub waits: RefCell<Vec<vk::Semaphore>>,
    /// Width and height of the part of an eye buffer that is shown.
    pub shown: Cell<[u32; 2]>,
    /// Destination of the picture of a frame for a window, which has no images of swapchains.
    pub window: Option<Buffer>,
}

impl App<'_> {
    /// For each eye a pass for each of its swapchain's images, or of the one swapchain's.
    ///
    /// # Errors
    /// Errors of [`Gpu::pass`].
    pub fn eye_passes(&self, kind: Kind, spec: impl Fn(Image) -> PassSpec) -> Result<Vec<Vec<Pass>>> {
        self.color.iter().map(|images| passes(self.gpu, kind, images, &spec)).collect()
    }

    /// Passes for the two halves of a scene: the first clears colour and this depth and stores both, and the second loads them.
    ///
    /// # Errors
    /// Errors of [`Gpu::pass`].
    pub fn halves(&self, kind: Kind, cleared: Attachment) -> Result<[Vec<Vec<Pass>>; 2]> {
        let stored = cleared.stored();
        Ok([
            self.eye_passes(kind, |color| PassSpec::new(color.cleared([0.0; 4]), stored))?,
            self.eye_passes(kind, |color| {
                PassSpec::new(color.overwritten().loaded(), stored.loaded().discarded())
            })?,
        ])
    }

    /// Runs a pass that shows the scene to a view.
    pub fn show(&self, frame: &Frame, pass: &Pass, pipelines: &Pipelines, view: usize) {
        pass.begin(self.gpu, frame.commands);
        self.draw(frame, pipelines, view);
        pass.end(self.gpu, frame.commands);
    }

    /// Draws the scene for a view, in the pass that was begun.
    pub fn draw(&self, frame: &Frame, pipelines: &Pipelines, view: usize) {
        self.scene.draw(self.gpu, frame.commands, pipelines, frame.slot, view as u32);
    }

    /// Runs a pass with one triangle over all of it.
    pub fn show_screen(
        &self,
        frame: &Frame,
        pass: &Pass,
        pipeline: vk::Pipeline,
        set: vk::DescriptorSet,
        draw: &Draw,
    ) {
        pass.begin(self.gpu, frame.commands);
        self.scene.draw_screen(self.gpu, frame.commands, pipeline, (set, frame.slot), draw);
        pass.end(self.gpu, frame.commands);
    }
}

/// Two eye buffers beside each other.
pub const fn wide([width, height]: [u32; 2]) -> [u32; 2] {
    [2 * width, height]
}
