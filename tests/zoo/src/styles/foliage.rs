//! Foliage: thin blades that a shader cuts out of quads by `discard`, straight into the swapchain.

use crate::app::{App, EYES, Frame, Recorder};
use crate::gpu::{Depth, Image, ImageSpec, Kind, Pass, PassSpec, PipelineSpec, Shader, Target};
use crate::look::{Coarsest, Look};
use crate::scene::{BOXES, Draw, VERTICES};
use crate::shader;
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "foliage",
    says: "blades that shaders cut out by discard, straight into each eye's swapchain",
    likeness: None,
    can_set_rates: true,
    can_show_look: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

/// Quads of blades, two of them crossed.
const QUADS: u32 = 640;

/// Vertices of a quad.
const QUAD: u32 = 6;

/// The bit of a draw's parameters for filters as wide as a pixel.
const PIXEL_FILTER: u32 = 4;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let spec = |color: Image| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0));
    let eyes = app.eye_passes(Kind::RenderPass, spec)?;
    let foliage = Foliage::new(app, &eyes[0][0].target)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            foliage.show(app, frame, &eyes[eye][frame.color[eye]], eye);
        }
        Ok(())
    }))
}

/// Boxes, blades and sky.
pub struct Foliage {
    boxes: vk::Pipeline,
    /// The depth of the blades, where the look has a pre-pass.
    depth: Option<vk::Pipeline>,
    blades: vk::Pipeline,
    sky: vk::Pipeline,
    set: vk::DescriptorSet,
    look: Option<(Look, Image)>,
}

impl Foliage {
    /// For passes of this target.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn new(app: &App, target: &Target) -> Result<Self> {
        let look = app.look.map(|look| anyhow::Ok((look, app.gpu.look_image(app.size)?)));
        let look: Option<(Look, Image)> = look.transpose()?;
        let spec = |vertex, [plain, with_look]: [Shader; 2], depth| {
            let fragment = if look.is_some() { with_look } else { plain };
            PipelineSpec::new(vertex, fragment, depth)
        };
        let make = |spec: &PipelineSpec| app.gpu.pipeline(spec, app.scene.layout, target);
        let boxes = [shader!("foliage", "boxes_fs"), shader!("foliage", "boxes_look_fs")];
        let blades = [shader!("foliage", "leaves_fs"), shader!("foliage", "leaves_look_fs")];
        let sky = [shader!("foliage", "sky_fs"), shader!("foliage", "sky_look_fs")];
        let set = match &look {
            Some((_, rates)) => app.scene.textured(app.gpu, &[*rates])?,
            None => app.scene.set,
        };
        let of_blades =
            |depth| PipelineSpec { discards: true, ..spec(shader!("foliage", "leaves_vs"), blades, depth) };
        let has_prepass = look.is_some_and(|(look, _)| look.prepass);
        let equal = Depth { test: Some(vk::CompareOp::EQUAL), write: false };
        let depth = PipelineSpec { color: false, ..of_blades(Depth::LESS) };
        Ok(Self {
            boxes: make(&spec(shader!("foliage", "boxes_vs"), boxes, Depth::LESS))?,
            depth: has_prepass.then(|| make(&depth)).transpose()?,
            blades: make(&of_blades(if has_prepass { equal } else { Depth::LESS }))?,
            sky: make(&spec(shader!("foliage", "sky_vs"), sky, Depth::LAST))?,
            set,
            look,
        })
    }

    /// Runs a pass with them, for a view.
    pub fn show(&self, app: &App, frame: &Frame, pass: &Pass, view: usize) {
        let gpu = app.gpu;
        if let Some((_, rates)) = &self.look {
            gpu.write_look_map(frame.commands, rates);
        }
        let draw = |most| match &self.look {
            Some((look, _)) => in_look(app, look, most),
            None => Draw::default(),
        };
        let discarding = self.look.map_or(Coarsest::Four, |(look, _)| look.discarding);
        let draws = [
            (self.depth, [QUAD, QUADS], Coarsest::One),
            (Some(self.boxes), [VERTICES, BOXES], Coarsest::Four),
            (Some(self.blades), [QUAD, QUADS], discarding),
            (Some(self.sky), [3, 1], Coarsest::Four),
        ];
        pass.begin(gpu, frame.commands);
        app.scene.bind(gpu, frame.commands, self.set, frame.slot);
        for (pipeline, [vertices, instances], most) in draws {
            let Some(pipeline) = pipeline else { continue };
            app.scene.push(gpu, frame.commands, &Draw { view: view as u32, far: 1.0, ..draw(most) });
            // SAFETY: a pass that the pipelines fit was begun, and all that they need is bound.
            unsafe {
                gpu.cmd_bind_pipeline(frame.commands, vk::PipelineBindPoint::GRAPHICS, pipeline);
                gpu.cmd_draw(frame.commands, vertices, instances, 0, 0);
            }
        }
        pass.end(gpu, frame.commands);
    }
}

/// Parameters of draws whose shaders show the look of rates.
pub fn in_look(app: &App, look: &Look, most: Coarsest) -> Draw {
    let filter = if look.pixel_filter { PIXEL_FILTER } else { 0 };
    Draw { value: app.size[0] as f32, count: most.log2() | filter, ..Draw::default() }
}
