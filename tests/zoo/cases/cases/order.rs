//! The order of acquire, wait and release.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::session::{Layer, Session};
use crate::swapchain::Swapchain;
use openxr_sys as xr;
use parafovea_zoo::cases::pattern::Figure;

/// Calls of xrWaitSwapchainImage before a runtime counts as stuck.
const RETRIES: u32 = 1000;

/// All images are acquired before the first is waited for; then each is drawn and released in turn.
pub fn acquire_all(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            let indices = acquire_every_image(app, swapchain);
            for index in indices {
                wait(app, swapchain, xr::Result::SUCCESS);
                swapchain.draw(index, 0, 0, &[figure])?;
                release(app, swapchain, xr::Result::SUCCESS);
            }
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// One image more than there are is acquired: an error, after which everything goes on.
pub fn acquire_beyond_the_count(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            let indices = acquire_every_image(app, swapchain);
            app.expect(
                "acquire with all images acquired",
                swapchain.acquire().0,
                xr::Result::ERROR_CALL_ORDER_INVALID,
            );
            for index in indices {
                wait(app, swapchain, xr::Result::SUCCESS);
                swapchain.draw(index, 0, 0, &[figure])?;
                release(app, swapchain, xr::Result::SUCCESS);
            }
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A wait without an acquired image is an error, at first and after a whole turn.
pub fn wait_without_acquire(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        wait(app, &stereo.eyes[0], xr::Result::ERROR_CALL_ORDER_INVALID);
        stereo.paint(frame.index)?;
        wait(app, &stereo.eyes[1], xr::Result::ERROR_CALL_ORDER_INVALID);
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A release without an image that was waited for is an error, and does not use up the image.
pub fn release_without_wait(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            release(app, swapchain, xr::Result::ERROR_CALL_ORDER_INVALID);
            let (result, index) = swapchain.acquire();
            app.expect("acquire", result, xr::Result::SUCCESS);
            release(app, swapchain, xr::Result::ERROR_CALL_ORDER_INVALID);
            wait(app, swapchain, xr::Result::SUCCESS);
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            swapchain.draw(index, 0, 0, &[figure])?;
            release(app, swapchain, xr::Result::SUCCESS);
            release(app, swapchain, xr::Result::ERROR_CALL_ORDER_INVALID);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// Waits do not block, and are called again until one succeeds.
pub fn wait_with_timeout(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES, |frame| {
        for (eye, swapchain) in (0..).zip(&stereo.eyes) {
            let (result, index) = swapchain.acquire();
            app.expect("acquire", result, xr::Result::SUCCESS);
            let last = (0..RETRIES)
                .map(|_| swapchain.wait(xr::Duration::NONE))
                .find(|result| *result != xr::Result::TIMEOUT_EXPIRED)
                .unwrap_or(xr::Result::TIMEOUT_EXPIRED);
            app.expect("wait, until it ends", last, xr::Result::SUCCESS);
            let figure = Figure::new(frame.index, eye, swapchain.whole());
            swapchain.draw(index, 0, 0, &[figure])?;
            release(app, swapchain, xr::Result::SUCCESS);
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

fn acquire_every_image(app: &App, swapchain: &Swapchain) -> Vec<u32> {
    let mut indices: Vec<u32> = Vec::new();
    for _ in &swapchain.images {
        let (result, index) = swapchain.acquire();
        app.expect("acquire", result, xr::Result::SUCCESS);
        indices.push(index);
    }
    let mut sorted = indices.clone();
    sorted.sort_unstable();
    let all: Vec<u32> = (0..swapchain.images.len() as u32).collect();
    app.report().fact("every image has its own index", format!("{sorted:?}"), format!("{all:?}"));
    indices
}

fn wait(app: &App, swapchain: &Swapchain, expected: xr::Result) {
    app.expect("wait", swapchain.wait(xr::Duration::INFINITE), expected);
}

fn release(app: &App, swapchain: &Swapchain, expected: xr::Result) {
    app.expect("release", swapchain.release(), expected);
}
