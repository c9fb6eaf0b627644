//! Shows frames: draws the layers as each eye sees them, and saves pictures.

mod pictures;
mod plan;

use crate::fault::Fault;
use crate::layers::{Layer, SubImage};
use crate::runtime::Runtime;
use crate::scenario::Picture;
use crate::system::VIEWS;
use crate::vulkan::render::{Job, Renderer, Source};
use ash::vk;
use openxr_sys as xr;
use plan::Draw;
pub(crate) use plan::Params;

/// The picture of an eye, or of a sub-image, that a frame asks for.
struct Wanted {
    name: String,
    job: usize,
}

/// Shows the layers of a frame: composites where the scenario wants it, and saves the pictures that it names.
pub(crate) fn show(
    runtime: &mut Runtime,
    session: xr::Session,
    display_time: i64,
    layers: &[Layer],
) -> Result<(), Fault> {
    let output = &runtime.scenario.output;
    let index = runtime.frames;
    let saves = |picture| output.save_frames.contains(&index) && output.save.contains(&picture);
    let (save_eyes, save_submitted) = (saves(Picture::Eye), saves(Picture::Submitted));
    if !(output.composite || save_eyes || save_submitted) {
        return Ok(());
    }
    let (mut jobs, mut wanted) = (Vec::new(), Vec::new());
    if save_submitted {
        for (name, image) in submitted(layers) {
            let Some(source) = source(runtime, image)? else { continue };
            wanted.push(Wanted { name: format!("submitted_{name}_{index}.png"), job: jobs.len() });
            let extent = vk::Extent2D {
                width: image.rect.extent.width as u32,
                height: image.rect.extent.height as u32,
            };
            jobs.push(Job::Picture { source, extent, params: Params::picture(image) });
        }
    }
    if output.composite || save_eyes {
        for eye in 0..VIEWS {
            let draws = plan::draws(runtime, eye, display_time, layers)?;
            if save_eyes {
                wanted.push(Wanted { name: format!("eye{eye}_{index}.png"), job: jobs.len() });
            }
            jobs.push(eye_job(runtime, eye, &draws, save_eyes)?);
        }
    }
    let dir = runtime.scenario.output.dir.clone();
    let session = runtime.sessions.get_mut(session)?;
    let renderer = match &mut session.renderer {
        Some(renderer) => renderer,
        none => none.insert(Renderer::new(&session.gpu)?),
    };
    let pixels = renderer.run(&jobs)?;
    wanted.iter().try_for_each(|wanted| match &pixels[wanted.job] {
        Some(pixels) => pictures::save(&dir.join(&wanted.name), pixels),
        None => Ok(()),
    })
}

fn eye_job(runtime: &Runtime, eye: usize, draws: &[Draw<'_>], save: bool) -> Result<Job, Fault> {
    let view = &runtime.scenario.views[eye];
    let mut drawn = Vec::new();
    for draw in draws {
        if let Some(source) = source(runtime, draw.image)? {
            drawn.push((source, draw.params));
        }
    }
    let extent = vk::Extent2D { width: view.width, height: view.height };
    Ok(Job::Eye { eye, extent, draws: drawn, save: save.then(|| Params::eye(extent)) })
}

/// The sub-images of a frame, and the names of their image files.
fn submitted(layers: &[Layer]) -> Vec<(String, &SubImage)> {
    let mut parts = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        match layer {
            Layer::Projection { views, .. } => {
                parts.extend(
                    (0..).zip(views.iter()).map(|(view, part)| (format!("{index}_{view}"), &part.image)),
                );
            }
            Layer::Quad(quad) => parts.push((format!("{index}_0"), &quad.image)),
        }
    }
    parts
}

/// The image to sample; none of multisampled swapchains, which are not composited.
fn source(runtime: &Runtime, part: &SubImage) -> Result<Option<Source>, Fault> {
    let swapchain = runtime.swapchains.get(part.swapchain)?;
    let image = swapchain.images.handles().get(part.index as usize).copied();
    let single = swapchain.shape.samples == vk::SampleCountFlags::TYPE_1;
    Ok(image.filter(|_| single).map(|image| Source::new(image, &swapchain.shape)))
}
