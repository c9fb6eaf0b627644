//! Rendered at 0.67 of the size in each direction, then scaled up into the swapchain.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, Pass, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD, Pipelines};
use crate::shader;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "upscaled",
    says: "each eye at 0.67 of its size, then scaled up into its swapchain",
    direct: false,
    likeness: Some(14.0),
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [PassTruth::new(small(size), COLOR, eyes, "scene"), PassTruth::new(size, COLOR, eyes, "scaling")]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

/// Size of the scene.
pub fn small(size: [u32; 2]) -> [u32; 2] {
    size.map(|length| (f64::from(length) * 0.67).round() as u32)
}

/// The scene's pass, and the scaling of its target into the swapchain.
pub struct Scaled {
    /// Draws the scene.
    pub scene: Pass,
    /// Its pipelines.
    pub pipelines: Pipelines,
    /// The passes into the swapchains, by eye and image.
    pub eyes: Vec<Vec<Pass>>,
    /// Draws the whole target of the scene.
    pub scale: vk::Pipeline,
    /// The set with that target.
    pub set: vk::DescriptorSet,
}

impl Scaled {
    /// With a target of `size` pixels for the scene.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(app: &App<'_>, size: [u32; 2]) -> Result<Self> {
        let gpu = app.gpu;
        let color = gpu.image(&ImageSpec::new(COLOR, size))?;
        let depth = gpu.image(&ImageSpec::depth(size))?;
        let scene = PassSpec::new(color.overwritten().sampled(), depth.depth_cleared(1.0));
        let scene = gpu.pass(Kind::RenderPass, scene)?;
        let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
        let pipelines = app.scene.pipelines(gpu, &scene.target, &FORWARD)?;
        let scale = PipelineSpec::new(shader!("post", "screen_vs"), shader!("post", "scale_fs"), Depth::NONE);
        let scale = gpu.pipeline(&scale, app.scene.layout, &eyes[0][0].target)?;
        let set = app.scene.textured(gpu, &[color])?;
        Ok(Self { scene, pipelines, eyes, scale, set })
    }
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let Scaled { scene, pipelines, eyes, scale, set } = Scaled::new(app, small(app.size))?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &scene, &pipelines, eye);
            app.show_screen(frame, &eyes[eye][frame.color[eye]], scale, set, &Draw::default());
        }
        Ok(())
    }))
}
