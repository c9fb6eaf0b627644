//! Layouts and formats of the swapchains of applications.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::session::{Layer, Session};
use crate::swapchain::{Shape, Swapchain};
use ash::vk;
use openxr_sys as xr;
use parafovea_zoo::cases::pattern::{Figure, Rect};

/// The most usual application: one swapchain an eye.
pub fn separate_swapchains(app: &App) -> Outcome {
    let [left, right] = app.view_sizes;
    stereo(app, [&Shape::srgb(left), &Shape::srgb(right)])
}

/// Linear code values, which the runtime takes as they are.
pub fn unorm(app: &App) -> Outcome {
    let shapes = app.view_sizes.map(|size| Shape::srgb(size).format(vk::Format::R8G8B8A8_UNORM));
    stereo(app, shapes.each_ref())
}

/// An sRGB swapchain that the application writes code values to, through UNORM views.
pub fn srgb_viewed_as_unorm(app: &App) -> Outcome {
    let shapes = app.view_sizes.map(|size| {
        let srgb = Shape::srgb(size);
        Shape {
            usage: srgb.usage | xr::SwapchainUsageFlags::MUTABLE_FORMAT,
            view_format: vk::Format::R8G8B8A8_UNORM,
            listed_formats: vec![vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM],
            ..srgb
        }
    });
    stereo(app, shapes.each_ref())
}

/// Images with a chain of levels, of which the runtime may sample any.
pub fn mip_levels(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let [left, right] = app.view_sizes.map(|size| Shape { mip_levels: 3, ..Shape::srgb(size) });
    let stereo = Stereo::with_shapes(&session, [&left, &right])?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let image = swapchain.next_image()?;
            for level in 0..swapchain.shape.mip_levels {
                let [width, height] = swapchain.shape.size;
                let rect = Rect::new(0, 0, width >> level, height >> level);
                let figure = Figure::new(frame.index, eye, rect);
                swapchain.draw(image, 0, level, &[figure])?;
            }
            app.expect("release", swapchain.release(), xr::Result::SUCCESS);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// Both eyes side by side in one image.
pub fn double_wide(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let [width, height] = app.view_sizes[0];
    let swapchain = Swapchain::create(&session, &Shape::srgb([2 * width, height]))?;
    let eyes = [0, width].map(|x| Rect::new(x, 0, width, height));
    session.frames(FRAMES, |frame| {
        swapchain.paint(&[Figure::new(frame.index, 0, eyes[0]), Figure::new(frame.index, 1, eyes[1])])?;
        let images = eyes.map(|rect| swapchain.sub_image(rect));
        session.submit(frame, &[Layer::Projection(images)])
    })?;
    drop(swapchain);
    session.finish()
}

/// Each eye a layer of an array image.
pub fn array_swapchain(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let shape = Shape { array_layers: 2, ..Shape::srgb(app.view_sizes[0]) };
    let swapchain = Swapchain::create(&session, &shape)?;
    session.frames(FRAMES, |frame| {
        let figures = [0, 1].map(|eye| Figure::new(frame.index, eye, swapchain.whole()));
        swapchain.paint_layers(&[&figures[..1], &figures[1..]])?;
        let images = [0, 1].map(|eye| swapchain.layer_sub_image(swapchain.whole(), eye));
        session.submit(frame, &[Layer::Projection(images)])
    })?;
    drop(swapchain);
    session.finish()
}

/// Two eyes of different sizes at odd offsets, and a small panel between them, all in one image.
pub fn several_rectangles(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let swapchain = Swapchain::create(&session, &Shape::srgb([173, 111]))?;
    let [left, right, panel] =
        [Rect::new(3, 5, 80, 96), Rect::new(101, 7, 64, 64), Rect::new(87, 80, 30, 17)];
    session.frames(FRAMES, |frame| {
        swapchain.paint(&[
            Figure::new(frame.index, 0, left),
            Figure::new(frame.index, 1, right),
            Figure::new(frame.index, 2, panel),
        ])?;
        let images = [left, right].map(|rect| swapchain.sub_image(rect));
        session.submit(frame, &[Layer::Projection(images), Layer::Quad(swapchain.sub_image(panel))])
    })?;
    drop(swapchain);
    session.finish()
}

/// Images that are drawn once: XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT.
pub fn static_image(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let [left, right] = app
        .view_sizes
        .map(|size| Shape { flags: xr::SwapchainCreateFlags::STATIC_IMAGE, ..Shape::srgb(size) });
    let stereo = Stereo::with_shapes(&session, [&left, &right])?;
    let count = stereo.eyes[0].images.len();
    app.report().fact("images of a static swapchain", count, 1);
    stereo.paint(0)?;
    app.expect(
        "acquire of a static swapchain, the second time",
        stereo.eyes[0].acquire().0,
        xr::Result::ERROR_CALL_ORDER_INVALID,
    );
    session.frames(FRAMES, |frame| session.submit(frame, &[Layer::Projection(stereo.images())]))?;
    drop(stereo);
    session.finish()
}

fn stereo(app: &App, shapes: [&Shape; 2]) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::with_shapes(&session, shapes)?;
    session.frames(FRAMES, |frame| {
        stereo.paint(frame.index)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}
