//! A picture beside the eyes' own, and the passes over it.

use crate::app::App;
use crate::gpu::{Attachment, Depth, Gpu, Image, ImageSpec, Kind, Pass, PassSpec, PipelineSpec, Target};
use crate::scene::{FORWARD, Pipelines};
use crate::shader;
use anyhow::Result;
use ash::vk;

/// Formats of canvases.
const FORMATS: [vk::Format; 3] =
    [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM, vk::Format::R16G16B16A16_SFLOAT];

/// Attachments of a pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Content {
    Nothing,
    Color,
    ColorAndDepth,
}

/// Draws of a pass.
pub enum Draws {
    Scene(Pipelines),
    /// A triangle with another canvas on it.
    Screen(vk::Pipeline),
}

/// A pass over a canvas.
pub struct Variant {
    pub pass: Pass,
    pub draws: Draws,
    pub takes: Content,
    /// Whether its depth can be loaded after it.
    pub leaves_depth: bool,
    /// Whether depth is as before.
    pub leaves_depth_alone: bool,
    /// Whether it is a VkRenderPass with a whole framebuffer.
    pub is_render_pass: bool,
}

/// An image with its depth, in the layouts of targets between commands.
pub struct Canvas {
    pub color: Image,
    depth: Image,
    pub variants: Vec<Variant>,
    /// With the colour to be sampled.
    pub set: vk::DescriptorSet,
    /// Whether there is depth that can be loaded.
    pub has_depth: bool,
}

impl Canvas {
    /// The first two are as large as an eye buffer.
    pub fn new(app: &App, numbers: &mut fastrand::Rng, number: usize) -> Result<Self> {
        let gpu = app.gpu;
        let sizes = [app.size, app.size.map(|length| length / 2), [2 * app.size[0], app.size[1]]];
        let size = if number < 2 { app.size } else { sizes[numbers.usize(..sizes.len())] };
        let transfers = vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST;
        let color = ImageSpec::new(FORMATS[numbers.usize(..FORMATS.len())], size);
        let usage = color.usage | transfers | vk::ImageUsageFlags::SAMPLED;
        let color = gpu.image(&color.usage(usage))?;
        let depth = gpu.image(&ImageSpec::depth(size))?;
        let set = app.scene.textured(gpu, &[color])?;
        let mut canvas = Self { color, depth, variants: Vec::new(), set, has_depth: false };
        let cleared = color.cleared([numbers.f32(), numbers.f32(), numbers.f32(), 1.0]);
        let far = depth.depth_cleared(1.0);
        let specs = [
            (color.overwritten(), Some(far), Content::Nothing),
            (cleared, Some(far.stored()), Content::Nothing),
            (cleared.loaded(), Some(far), Content::Color),
            (cleared.loaded(), Some(far.stored().loaded()), Content::ColorAndDepth),
            (cleared, None, Content::Color),
            (cleared.loaded(), None, Content::Color),
        ];
        for (color, depth, takes) in specs {
            canvas.variants.push(variant(app, numbers, color, depth, takes)?);
        }
        Ok(canvas)
    }

    /// Fills the colour for the first time.
    pub fn begin(&mut self, gpu: &Gpu, commands: vk::CommandBuffer) {
        clear(gpu, commands, &self.color, vk::ImageLayout::UNDEFINED, [0.2, 0.4, 0.6, 1.0]);
        let target = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        gpu.transition(commands, &self.depth, vk::ImageLayout::UNDEFINED, target);
    }
}

fn variant(
    app: &App,
    numbers: &mut fastrand::Rng,
    color: Attachment,
    depth: Option<Attachment>,
    takes: Content,
) -> Result<Variant> {
    let kind = [Kind::RenderPass, Kind::RenderPass, Kind::Dynamic, Kind::Imageless][numbers.usize(..4)];
    let spec = PassSpec { depth, ..PassSpec::color(color) };
    let pass = app.gpu.pass(kind, spec)?;
    let draws = match depth {
        Some(_) => Draws::Scene(app.scene.pipelines(app.gpu, &pass.target, &FORWARD)?),
        None => Draws::Screen(show(app, &pass.target)?),
    };
    Ok(Variant {
        pass,
        draws,
        takes,
        leaves_depth: depth.is_some_and(|depth| depth.store == vk::AttachmentStoreOp::STORE),
        leaves_depth_alone: depth.is_none(),
        is_render_pass: kind == Kind::RenderPass,
    })
}

/// A pipeline that covers a target with a canvas.
pub fn show(app: &App, target: &Target) -> Result<vk::Pipeline> {
    let spec = PipelineSpec::new(shader!("post", "screen_vs"), shader!("post", "scale_fs"), Depth::NONE);
    app.gpu.pipeline(&spec, app.scene.layout, target)
}

/// Clears an image that is in this layout, and leaves it in that of a target.
pub fn clear(
    gpu: &Gpu,
    commands: vk::CommandBuffer,
    image: &Image,
    layout: vk::ImageLayout,
    color: [f32; 4],
) {
    let cleared = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
    gpu.transition(commands, image, layout, cleared);
    let value = vk::ClearColorValue { float32: color };
    // SAFETY: the command buffer is being recorded, outside of a render pass; the layout is that.
    unsafe { gpu.cmd_clear_color_image(commands, image.handle, cleared, &value, &[image.range()]) };
    gpu.transition(commands, image, cleared, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
}
