//! Releases and submissions of applications, frame by frame.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::session::{Layer, Session};
use crate::swapchain::{Shape, Swapchain};
use ash::vk;
use openxr_sys as xr;
use parafovea_zoo::cases::pattern::{Figure, Rect};

/// Every second frame is released but not submitted.
pub fn release_without_submit(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        stereo.paint(frame.index)?;
        if frame.index % 2 == 0 {
            session.submit(frame, &[Layer::Projection(stereo.images())])
        } else {
            session.submit(frame, &[])
        }
    })?;
    drop(stereo);
    session.finish()
}

/// Two images are released before one xrEndFrame, which shows the second.
pub fn two_releases_before_end_frame(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        stereo.paint(2 * frame.index)?;
        stereo.paint(2 * frame.index + 1)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A new image every third frame; the others submit the last one again.
pub fn resubmit_without_acquire(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        if frame.index % 3 == 0 {
            stereo.paint(frame.index)?;
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// While nothing is shown, every second frame submits nothing, and the others render all the same.
pub fn should_render_false(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    let mut hidden = 0;
    session.frames(FRAMES, |frame| {
        stereo.paint(frame.index)?;
        hidden += u32::from(!frame.should_render);
        if frame.should_render || frame.index % 2 == 1 {
            session.submit(frame, &[Layer::Projection(stereo.images())])
        } else {
            session.submit(frame, &[])
        }
    })?;
    app.report().note("frames with shouldRender false", hidden);
    drop(stereo);
    session.finish()
}

/// Another thread than the one that acquired releases the images.
pub fn release_on_another_thread(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            let image = swapchain.next_image()?;
            swapchain.draw(image, 0, 0, &[figure])?;
            let result = swapchain.release_on_another_thread()?;
            app.expect("release on another thread", result, xr::Result::SUCCESS);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// Each eye has two swapchains and uses them in turn.
pub fn two_swapchains_a_view(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let turns = [Stereo::create(&session)?, Stereo::create(&session)?];
    session.frames(FRAMES, |frame| {
        let stereo = &turns[frame.index as usize % 2];
        stereo.paint(frame.index)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(turns);
    session.finish()
}

/// The application creates its swapchains again, in other sizes, while the session runs.
pub fn resolution_change(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let [width, height] = app.view_sizes[0];
    let sizes = [[width, height], [width / 2, height / 2 + 1], [width + 13, height + 6]];
    for (turn, size) in (0..).zip(sizes) {
        let shape = Shape::srgb(size);
        let stereo = Stereo::with_shapes(&session, [&shape, &shape])?;
        session.frames(FRAMES / 2, |frame| {
            stereo.paint(turn * FRAMES + frame.index)?;
            session.submit(frame, &[Layer::Projection(stereo.images())])
        })?;
    }
    session.finish()
}

/// One swapchain feeds the projection layer and a quad in front of it.
pub fn projection_and_quad(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let [width, height] = app.view_sizes[0];
    let swapchain = Swapchain::create(&session, &Shape::srgb([2 * width + 32, height]))?;
    let eyes = [0, width].map(|x| Rect::new(x, 0, width, height));
    let panel = Rect::new(2 * width, 0, 32, 24);
    session.frames(FRAMES, |frame| {
        swapchain.paint(&[
            Figure::new(frame.index, 0, eyes[0]),
            Figure::new(frame.index, 1, eyes[1]),
            Figure::new(frame.index, 2, panel).translucent(),
        ])?;
        let images = eyes.map(|rect| swapchain.sub_image(rect));
        session.submit(frame, &[Layer::Projection(images), Layer::Quad(swapchain.sub_image(panel))])
    })?;
    drop(swapchain);
    session.finish()
}

/// No projection layer at all.
pub fn quad_only(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let swapchain = Swapchain::create(&session, &Shape::srgb([64, 48]))?;
    session.frames(FRAMES, |frame| {
        swapchain.paint(&[Figure::new(frame.index, 2, swapchain.whole())])?;
        let image = swapchain.sub_image(swapchain.whole());
        session.submit(frame, &[Layer::Quad(image)])
    })?;
    drop(swapchain);
    session.finish()
}

/// Small swapchains for quads, which are created before those of the eyes, as overlays are.
pub fn overlays_before_the_eyes(app: &App) -> Outcome {
    const OVERLAYS: usize = 8;
    let session = Session::start(app)?;
    let overlay = || Swapchain::create(&session, &Shape::srgb([24, 24]));
    let overlays: Vec<_> = std::iter::repeat_with(overlay).take(OVERLAYS).collect::<Result<_, _>>()?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        stereo.paint(frame.index)?;
        let mut layers = vec![Layer::Projection(stereo.images())];
        for overlay in &overlays {
            overlay.paint(&[Figure::new(frame.index, 2, overlay.whole())])?;
            layers.push(Layer::Quad(overlay.sub_image(overlay.whole())));
        }
        session.submit(frame, &layers)
    })?;
    drop((overlays, stereo));
    session.finish()
}

/// A projection layer that is blended by an alpha from 0 to 255.
pub fn alpha_patterns(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            swapchain.paint(&[figure.translucent()])?;
        }
        session.submit(frame, &[Layer::Blended(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// Each view comes with its depth: XR_KHR_composition_layer_depth.
pub fn depth_layer(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let colour = Stereo::create(&session)?;
    let [left, right] = app.view_sizes.map(|size| Shape {
        usage: xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        ..Shape::srgb(size).format(vk::Format::D32_SFLOAT)
    });
    let depth = Stereo::with_shapes(&session, [&left, &right])?;
    session.frames(FRAMES, |frame| {
        colour.paint(frame.index)?;
        depth.paint(frame.index)?;
        let layer = Layer::WithDepth(colour.images(), depth.images());
        session.submit(frame, &[layer])
    })?;
    drop((colour, depth));
    session.finish()
}
