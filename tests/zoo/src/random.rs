//! Recordings without a plan: in each frame passes of all kinds, draws, clears, copies and blits, in secondary command buffers and over
//! several primary ones, in an order that a seed gives; at the end both eyes are drawn. All of it is allowed, and the same in every run.

mod canvas;

use crate::app::{App, EYES, Frame, Recorder};
use crate::gpu::{Image, Kind, Pass, PassSpec};
use crate::scene::{Draw, IN_FLIGHT, Pipelines};
use crate::style::Style;
use crate::styles::secondaries;
use crate::support::{Feature, Needs};
use anyhow::Result;
use ash::vk;
use canvas::{Canvas, Content, Draws, Variant};
use std::ops::Range;

/// Not among the styles, of which all is known beforehand.
pub const STYLE: Style = Style {
    name: "random",
    says: "passes, copies and clears in any order (--seed)",
    needs: Needs {
        vulkan: vk::API_VERSION_1_3,
        features: &[Feature::DynamicRendering, Feature::ImagelessFramebuffer],
        ..Needs::NOTHING
    },
    direct: false,
    likeness: None,
    start,
    ..Style::PLAIN
};

/// Canvases beside the eye buffers.
const CANVASES: usize = 4;

/// Things that are done in a frame before the eyes are drawn.
const STEPS: Range<u32> = 2..8;

/// Primary command buffers of a frame beside its own.
const SPLITS: usize = 3;

/// Secondary command buffers of a frame, boxes and sky of one pass.
const SECONDARIES: usize = 2;

const TARGET: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
const SAMPLED: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
const SOURCE: vk::ImageLayout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;

/// An eye's passes for each image of its swapchain: the scene, an image of a canvas, and one over the earlier content.
struct Eye {
    scene: Vec<Pass>,
    picture: Vec<Pass>,
    over: Vec<Pass>,
}

struct Random<'a> {
    app: &'a App<'a>,
    numbers: fastrand::Rng,
    canvases: Vec<Canvas>,
    eyes: Vec<Eye>,
    scene: Pipelines,
    /// Shows a canvas to an eye.
    picture: vk::Pipeline,
    primaries: Vec<vk::CommandBuffer>,
    secondaries: Vec<vk::CommandBuffer>,
}

/// Objects of a frame, to be destroyed.
struct Used {
    commands: vk::CommandBuffer,
    splits: usize,
    has_secondaries: bool,
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let mut numbers = fastrand::Rng::with_seed(app.seed);
    let canvases: Vec<Canvas> =
        (0..CANVASES).map(|number| Canvas::new(app, &mut numbers, number)).collect::<Result<_>>()?;
    let depth = gpu.image(&crate::gpu::ImageSpec::depth(app.size))?;
    let kind = [Kind::RenderPass, Kind::Dynamic][numbers.usize(..2)];
    let passes = |spec: &dyn Fn(Image) -> PassSpec| app.eye_passes(kind, spec);
    let scene = passes(&|color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let picture = passes(&|color| PassSpec::color(color.overwritten()))?;
    let over = passes(&|color| PassSpec::color(color.overwritten().loaded()))?;
    let eyes: Vec<Eye> = scene
        .into_iter()
        .zip(picture)
        .zip(over)
        .map(|((scene, picture), over)| Eye { scene, picture, over })
        .collect();
    let pipelines = app.scene.pipelines(gpu, &eyes[0].scene[0].target, &crate::scene::FORWARD)?;
    let show = canvas::show(app, &eyes[0].picture[0].target)?;
    let mut random = Random {
        app,
        numbers,
        canvases,
        eyes,
        scene: pipelines,
        picture: show,
        primaries: gpu.command_buffers((SPLITS * IN_FLIGHT) as u32, vk::CommandBufferLevel::PRIMARY)?,
        secondaries: gpu
            .command_buffers((SECONDARIES * IN_FLIGHT) as u32, vk::CommandBufferLevel::SECONDARY)?,
    };
    Ok(Box::new(move |frame| random.frame(frame)))
}

impl Random<'_> {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        let mut used = Used { commands: frame.commands, splits: 0, has_secondaries: false };
        self.order(&used);
        if frame.index == 0 {
            let gpu = self.app.gpu;
            self.canvases.iter_mut().for_each(|canvas| canvas.begin(gpu, frame.commands));
        }
        for _ in 0..self.numbers.u32(STEPS) {
            match self.numbers.u32(..10) {
                0..=4 => self.draw(frame, &used),
                5 => self.copy(&used),
                6 => self.clear(&used),
                7 => self.draw_secondaries(frame, &mut used)?,
                8 => self.split(frame, &mut used)?,
                _ => {}
            }
            self.order(&used);
        }
        let mut eyes = EYES;
        self.numbers.shuffle(&mut eyes);
        for eye in eyes {
            self.show(frame, &used, eye);
            self.order(&used);
        }
        self.end(frame, &used)
    }

    /// Everything before comes before everything after.
    fn order(&self, used: &Used) {
        let all = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        self.app.gpu.barrier(used.commands, &[all], &[]);
    }

    /// Runs a pass over a canvas.
    fn draw(&mut self, frame: &Frame, used: &Used) {
        let at = self.numbers.usize(..CANVASES);
        let variant = self.numbers.usize(..self.canvases[at].variants.len());
        let needed = self.canvases[at].variants[variant].takes;
        if needed == Content::ColorAndDepth && !self.canvases[at].has_depth {
            return;
        }
        let from = (at + 1 + self.numbers.usize(..CANVASES - 1)) % CANVASES;
        let (gpu, commands) = (self.app.gpu, used.commands);
        let texture = self.canvases[from].color;
        if !self.canvases[at].variants[variant].leaves_depth_alone {
            self.canvases[at].has_depth = self.canvases[at].variants[variant].leaves_depth;
        }
        let Variant { pass, draws, .. } = &self.canvases[at].variants[variant];
        let is_whole = needed == Content::Nothing || self.numbers.bool();
        let area = if is_whole { pass.extent } else { pass.extent.map(|length| length / 2) };
        gpu.transition(commands, &texture, TARGET, SAMPLED);
        pass.begin_area(gpu, commands, area);
        let rounds = if needed == Content::Nothing { 1 } else { self.numbers.u32(..3) };
        for _ in 0..rounds {
            match draws {
                Draws::Scene(pipelines) => {
                    let view = self.numbers.u32(..2);
                    self.app.scene.draw(gpu, commands, pipelines, frame.slot, view);
                }
                Draws::Screen(pipeline) => {
                    let set = (self.canvases[from].set, frame.slot);
                    self.app.scene.draw_screen(gpu, commands, *pipeline, set, &Draw::default());
                }
            }
        }
        if self.numbers.bool() {
            clear_within(self.app, commands, &mut self.numbers, area);
        }
        pass.end(gpu, commands);
        gpu.transition(commands, &texture, SAMPLED, TARGET);
    }

    /// Copies a canvas to another one, or blits it where they differ.
    fn copy(&mut self, used: &Used) {
        let from = self.numbers.usize(..CANVASES);
        let to = (from + 1 + self.numbers.usize(..CANVASES - 1)) % CANVASES;
        let [from, to] = [self.canvases[from].color, self.canvases[to].color];
        let (gpu, commands) = (self.app.gpu, used.commands);
        gpu.transition(commands, &from, TARGET, SOURCE);
        if (from.format, from.extent) == (to.format, to.extent) && self.numbers.bool() {
            gpu.copy(commands, &from, &to);
        } else if from.extent == to.extent {
            gpu.blit_upside_down(commands, &from, &to);
        }
        gpu.transition(commands, &from, SOURCE, TARGET);
    }

    fn clear(&mut self, used: &Used) {
        let at = self.numbers.usize(..CANVASES);
        let color = [self.numbers.f32(), self.numbers.f32(), self.numbers.f32(), 1.0];
        canvas::clear(self.app.gpu, used.commands, &self.canvases[at].color, TARGET, color);
    }

    /// The scene over a canvas, in secondary command buffers, once a frame.
    fn draw_secondaries(&mut self, frame: &Frame, used: &mut Used) -> Result<()> {
        let at = self.numbers.usize(..CANVASES);
        let canvas = &self.canvases[at];
        let fits = |variant: &&Variant| {
            variant.is_render_pass
                && variant.takes == Content::Nothing
                && variant.pass.extent == self.app.size
        };
        let Some(Variant { pass, draws: Draws::Scene(pipelines), leaves_depth, .. }) =
            canvas.variants.iter().find(fits).filter(|_| !used.has_secondaries)
        else {
            return Ok(());
        };
        let first = SECONDARIES * frame.slot;
        let both = [self.secondaries[first], self.secondaries[first + 1]];
        secondaries::scene(self.app, frame, pass, pipelines, both, self.numbers.usize(..2))?;
        pass.begin_for_secondaries(self.app.gpu, used.commands);
        // SAFETY: the pass was begun for them; both were recorded for it.
        unsafe { self.app.gpu.cmd_execute_commands(used.commands, &both) };
        pass.end(self.app.gpu, used.commands);
        used.has_secondaries = true;
        let has_depth = *leaves_depth;
        self.canvases[at].has_depth = has_depth;
        Ok(())
    }

    /// Goes on in another command buffer.
    fn split(&mut self, frame: &Frame, used: &mut Used) -> Result<()> {
        if used.splits == SPLITS {
            return Ok(());
        }
        self.end(frame, used)?;
        used.commands = self.primaries[SPLITS * frame.slot + used.splits];
        used.splits += 1;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the fence of this slot was waited for, so that nothing uses the command buffer.
        Ok(unsafe { self.app.gpu.begin_command_buffer(used.commands, &info) }?)
    }

    /// Ends the command buffer, unless it is the frame's own, whose end comes later.
    fn end(&self, frame: &Frame, used: &Used) -> Result<()> {
        if used.splits > 0 {
            // SAFETY: it is being recorded.
            unsafe { self.app.gpu.end_command_buffer(used.commands) }?;
            frame.after.borrow_mut().push(used.commands);
        }
        Ok(())
    }

    /// Draws the picture of an eye.
    fn show(&mut self, frame: &Frame, used: &Used, eye: usize) {
        let (gpu, commands) = (self.app.gpu, used.commands);
        let image = frame.color[eye];
        if self.numbers.bool() {
            let pass = &self.eyes[eye].scene[image];
            pass.begin(gpu, commands);
            self.app.scene.draw(gpu, commands, &self.scene, frame.slot, eye as u32);
            pass.end(gpu, commands);
        } else {
            let canvas = &self.canvases[self.numbers.usize(..CANVASES)];
            gpu.transition(commands, &canvas.color, TARGET, SAMPLED);
            let pass = &self.eyes[eye].picture[image];
            pass.begin(gpu, commands);
            let set = (canvas.set, frame.slot);
            self.app.scene.draw_screen(gpu, commands, self.picture, set, &Draw::default());
            pass.end(gpu, commands);
            gpu.transition(commands, &canvas.color, SAMPLED, TARGET);
        }
        if self.numbers.bool() {
            self.order(used);
            let pass = &self.eyes[eye].over[image];
            pass.begin(gpu, commands);
            clear_within(self.app, commands, &mut self.numbers, pass.extent);
            pass.end(gpu, commands);
        }
    }
}

/// Clears a rectangle of the first attachment of the pass that was begun, within this area.
fn clear_within(app: &App, commands: vk::CommandBuffer, numbers: &mut fastrand::Rng, area: [u32; 2]) {
    let value = vk::ClearColorValue { float32: [numbers.f32(), numbers.f32(), numbers.f32(), 1.0] };
    let attachment = vk::ClearAttachment::default()
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .clear_value(vk::ClearValue { color: value });
    let [width, height] = area.map(|length| numbers.u32(1..=length));
    let offset = vk::Offset2D {
        x: numbers.u32(..=area[0] - width) as i32,
        y: numbers.u32(..=area[1] - height) as i32,
    };
    let rect = vk::Rect2D { offset, extent: vk::Extent2D { width, height } };
    let rect = vk::ClearRect { rect, base_array_layer: 0, layer_count: 1 };
    // SAFETY: a pass with one colour attachment was begun, and the rectangle is inside its area.
    unsafe { app.gpu.cmd_clear_attachments(commands, &[attachment], &[rect]) };
}
