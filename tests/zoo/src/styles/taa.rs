//! Temporal anti-aliasing of foliage: a jittered scene, blended into a history that is kept over frames, and tone-mapped into the swapchain.

use super::foliage::{Foliage, in_look};
use super::offscreen_tonemap::HDR;
use super::taa_exposure::jitter;
use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, Image, ImageSpec, Kind, Pass, PassSpec, PipelineSpec};
use crate::look::Look;
use crate::scene::{Draw, Projection, Uniforms};
use crate::shader;
use crate::style::{History, Style};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "taa",
    says: "foliage, with temporal anti-aliasing and tone mapping between the scene and the swapchain",
    direct: false,
    likeness: None,
    can_set_rates: true,
    can_show_look: true,
    history: History::Blended,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, HDR, eyes, "scene"),
                PassTruth::new(size, HDR, eyes, "temporal anti-aliasing"),
                PassTruth::new(size, COLOR, eyes, "tone mapping"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

/// Histories of an eye, new and old in turn.
struct Eye {
    histories: [Image; 2],
    accumulate: [Pass; 2],
    /// With the scene, the old history and, where there is a look, its map.
    blended: [vk::DescriptorSet; 2],
    /// With the new history.
    shown: [vk::DescriptorSet; 2],
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let light = gpu.image(&ImageSpec::new(HDR, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let spec = PassSpec::new(light.overwritten().sampled(), depth.depth_cleared(1.0));
    let scene = gpu.pass(Kind::RenderPass, spec)?;
    let foliage = Foliage::new(app, &scene.target)?;
    // The history's pass has no map of its own, as it is not a scene: where it obeys one, that is the scene's.
    let look = app.look.map(|look| anyhow::Ok((look, gpu.look_image(app.size)?)));
    let look: Option<(Look, Image)> = look.transpose()?;
    let eyes = [eye(app, &light, look.map(|(_, map)| map))?, eye(app, &light, look.map(|(_, map)| map))?];
    let shown = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let fragment =
        if look.is_some() { shader!("taa", "accumulate_look_fs") } else { shader!("taa", "accumulate_fs") };
    let accumulate = PipelineSpec::new(shader!("taa", "screen_vs"), fragment, Depth::NONE);
    let accumulate = gpu.pipeline(&accumulate, app.scene.layout, &eyes[0].accumulate[0].target)?;
    let tone_map =
        PipelineSpec::new(shader!("post", "screen_vs"), shader!("post", "tonemap_fs"), Depth::NONE);
    let tone_map = gpu.pipeline(&tone_map, app.scene.layout, &shown[0][0].target)?;
    Ok(Box::new(move |frame| {
        let projection = Projection { jitter: jitter(frame.index, app.size), ..Projection::default() };
        app.scene.write(frame.slot, &Uniforms::new(frame.animated, frame.views, projection));
        let new = (frame.index % 2) as usize;
        for index in EYES {
            let eye = &eyes[index];
            if frame.index == 0 {
                let [_, old] = eye.histories;
                let sampled = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
                gpu.transition(frame.commands, &old, vk::ImageLayout::UNDEFINED, sampled);
            }
            if let Some((_, map)) = &look {
                gpu.write_look_map(frame.commands, map);
            }
            foliage.show(app, frame, &scene, index);
            let draw = look.map_or(Draw::default(), |(look, _)| in_look(app, &look, look.history));
            let first = if frame.index == 0 { 1.0 } else { 0.0 };
            let draw = Draw { far: first, value: if look.is_some() { draw.value } else { first }, ..draw };
            app.show_screen(frame, &eye.accumulate[new], accumulate, eye.blended[new], &draw);
            let to = &shown[index][frame.color[index]];
            app.show_screen(frame, to, tone_map, eye.shown[new], &Draw::default());
        }
        Ok(())
    }))
}

fn eye(app: &App, light: &Image, map: Option<Image>) -> Result<Eye> {
    let history = || app.gpu.image(&ImageSpec::new(HDR, app.size));
    let histories = [history()?, history()?];
    let pass = |image: Image| app.gpu.pass(Kind::RenderPass, PassSpec::color(image.overwritten().sampled()));
    // The map takes the place of the luminance.
    let blended = |old: Image| {
        let textures: Vec<Image> = [*light, old].into_iter().chain(map).collect();
        app.scene.textured(app.gpu, &textures)
    };
    let shown = |new: Image| app.scene.textured(app.gpu, &[new]);
    Ok(Eye {
        histories,
        accumulate: [pass(histories[0])?, pass(histories[1])?],
        blended: [blended(histories[1])?, blended(histories[0])?],
        shown: [shown(histories[0])?, shown(histories[1])?],
    })
}
