//! Mistakes that the specification names an error for. The application goes on after each.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::session::{Layer, Session};
use crate::swapchain::{Shape, Swapchain, enumerate_into};
use openxr_sys as xr;
use parafovea_zoo::cases::pattern::Rect;
use std::ptr::null;

/// A swapchain is submitted that has no released image: never acquired, acquired, waited for.
pub fn end_frame_with_unreleased_swapchain(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(3, |frame| {
        let eye = &stereo.eyes[1];
        match frame.index {
            0 => {}
            1 => app.expect("acquire", eye.acquire().0, xr::Result::SUCCESS),
            _ => app.expect("wait", eye.wait(xr::Duration::INFINITE), xr::Result::SUCCESS),
        }
        stereo.eyes[0].paint(&[])?;
        app.expect(
            "end of a frame with an unreleased swapchain",
            session.end_frame(frame, &[Layer::Projection(stereo.images())]),
            xr::Result::ERROR_LAYER_INVALID,
        );
        Ok(())
    })?;
    app.expect("release", stereo.eyes[1].release(), xr::Result::SUCCESS);
    go_on(&session, &stereo)?;
    drop(stereo);
    session.finish()
}

/// A sub-image reaches over the edge of its swapchain, is negative in size, or is of a layer too many.
pub fn rectangle_outside_the_image(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(2, |frame| {
        stereo.paint(frame.index)?;
        let mut images = stereo.images();
        let Rect { width, height, .. } = images[1].rect;
        images[1].rect = match frame.index {
            0 => Rect::new(1, 0, width, height),
            _ => Rect::new(0, 1, width, height),
        };
        app.expect(
            "end of a frame with a rectangle over the edge",
            session.end_frame(frame, &[Layer::Projection(images)]),
            xr::Result::ERROR_SWAPCHAIN_RECT_INVALID,
        );
        Ok(())
    })?;
    go_on(&session, &stereo)?;
    drop(stereo);
    session.finish()
}

/// A swapchain is destroyed after its release and before xrEndFrame: not submitted, and then submitted.
pub fn destroy_before_end_frame(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(FRAMES / 2, |frame| {
        stereo.paint(frame.index)?;
        let short_lived = Stereo::create(&session)?;
        short_lived.paint(100 + frame.index)?;
        let dead = short_lived.images();
        drop(short_lived);
        if frame.index % 2 == 0 {
            session.submit(frame, &[Layer::Projection(stereo.images())])
        } else {
            app.expect(
                "end of a frame with a destroyed swapchain",
                session.end_frame(frame, &[Layer::Projection(dead)]),
                xr::Result::ERROR_HANDLE_INVALID,
            );
            Ok(())
        }
    })?;
    go_on(&session, &stereo)?;
    drop(stereo);
    session.finish()
}

/// Every swapchain function refuses the handle of a destroyed swapchain.
pub fn destroyed_handle(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    stereo.paint(0)?;
    let dead = stereo.eyes[0].handle;
    drop(stereo);
    let functions = &app.xr.functions;
    let wait = xr::SwapchainImageWaitInfo {
        ty: xr::SwapchainImageWaitInfo::TYPE,
        next: null(),
        timeout: xr::Duration::NONE,
    };
    let mut index = 0;
    // SAFETY: the pointers outlive the calls; the runtime has to detect that the handle is dead.
    let results = unsafe {
        [
            ("acquire", (functions.acquire_image)(dead, null(), &mut index)),
            ("wait", (functions.wait_image)(dead, &wait)),
            ("release", (functions.release_image)(dead, null())),
            ("enumerate", enumerate_into(&session, dead, 0).0),
            ("destroy", (functions.destroy_swapchain)(dead)),
        ]
    };
    for (what, result) in results {
        let what = format!("{what} of a destroyed swapchain");
        app.expect(&what, result, xr::Result::ERROR_HANDLE_INVALID);
    }
    let stereo = Stereo::create(&session)?;
    go_on(&session, &stereo)?;
    drop(stereo);
    session.finish()
}

/// The two calls of the buffer size idiom, with too little room, with just enough, and with more.
pub fn enumerate_images(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let swapchain = Swapchain::create(&session, &Shape::srgb(app.view_sizes[0]))?;
    let (result, count, _) = enumerate_into(&session, swapchain.handle, 0);
    app.expect("enumerate with capacity 0", result, xr::Result::SUCCESS);
    app.report().fact("count", count, swapchain.images.len());
    let (result, needed, _) = enumerate_into(&session, swapchain.handle, count - 1);
    let expected = match count {
        1 => xr::Result::SUCCESS,
        _ => xr::Result::ERROR_SIZE_INSUFFICIENT,
    };
    app.expect("enumerate with too little capacity", result, expected);
    app.report().fact("count, too little", needed, count);
    for spare in [0, 2] {
        let (result, written, images) = enumerate_into(&session, swapchain.handle, count + spare);
        app.expect("enumerate with capacity", result, xr::Result::SUCCESS);
        let mut report = app.report();
        report.fact("count written", written, count);
        let same = images[..count as usize] == swapchain.images;
        report.fact("the same images each time", same, true);
    }
    drop(swapchain);
    let stereo = Stereo::create(&session)?;
    go_on(&session, &stereo)?;
    drop(stereo);
    session.finish()
}

/// A few ordinary frames.
fn go_on(session: &Session, stereo: &Stereo) -> Outcome {
    session.frames(FRAMES / 2, |frame| {
        stereo.paint(10 + frame.index)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })
}
