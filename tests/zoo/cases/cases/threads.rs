//! Other threads of the application, which make and destroy things while frames are shown.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::failure::{Failure, name};
use crate::session::{Layer, Session};
use crate::vulkan::Vulkan;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{null, null_mut};

/// Threads beside the one that shows frames.
const THREADS: usize = 2;

/// Things that each makes.
const MADE: u32 = 20;

/// Swapchains are made, asked for their images, and destroyed, none of which uses the queue of the session.
pub fn swapchains_on_threads(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let functions = &app.xr.functions;
    let calls = (functions.create_swapchain, functions.enumerate_images, functions.destroy_swapchain);
    let handle = session.handle;
    let make = move |number: u32| -> Vec<xr::Result> {
        let (create, enumerate, destroy) = calls;
        let is_color = !number.is_multiple_of(3);
        let attachment = match is_color {
            true => xr::SwapchainUsageFlags::COLOR_ATTACHMENT,
            false => xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        };
        let format = if is_color { ash::vk::Format::R8G8B8A8_SRGB } else { ash::vk::Format::D32_SFLOAT };
        let info = xr::SwapchainCreateInfo {
            ty: xr::SwapchainCreateInfo::TYPE,
            next: null(),
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: attachment,
            format: i64::from(format.as_raw()),
            sample_count: 1,
            width: 48 + 8 * (number % 4),
            height: 40,
            face_count: 1,
            array_size: 1 + number % 2,
            mip_count: 1,
        };
        let image =
            xr::SwapchainImageVulkanKHR { ty: xr::SwapchainImageVulkanKHR::TYPE, next: null_mut(), image: 0 };
        let mut images = [image; 8];
        let (mut swapchain, mut count) = (xr::Swapchain::NULL, 0);
        // SAFETY: the session lives until the threads have ended; there is room for as many images as is said.
        unsafe {
            let created = create(handle, &info, &mut swapchain);
            let enumerated = enumerate(swapchain, 8, &mut count, images.as_mut_ptr().cast());
            vec![created, enumerated, destroy(swapchain)]
        }
    };
    beside(&session, make)?;
    session.finish()
}

/// Instances and devices of Vulkan that have nothing to do with the session are made and destroyed.
pub fn devices_on_threads(app: &App) -> Outcome {
    let session = Session::start(app)?;
    beside(&session, |_| {
        let made = Vulkan::apart();
        vec![if made.is_ok() { xr::Result::SUCCESS } else { xr::Result::ERROR_RUNTIME_FAILURE }]
    })?;
    session.finish()
}

/// Shows frames while other threads do something, over and over; all of that has to succeed.
fn beside(session: &Session, work: impl Fn(u32) -> Vec<xr::Result> + Sync) -> Outcome {
    let app = session.app;
    let stereo = Stereo::create(session)?;
    let (shown, results) = std::thread::scope(|scope| {
        let threads: Vec<_> =
            (0..THREADS).map(|_| scope.spawn(|| (0..MADE).flat_map(&work).collect::<Vec<_>>())).collect();
        let shown = session.frames(4 * FRAMES, |frame| {
            stereo.paint(frame.index)?;
            session.submit(frame, &[Layer::Projection(stereo.images())])
        });
        (shown, threads.into_iter().map(|thread| thread.join().ok()).collect::<Option<Vec<_>>>())
    });
    shown?;
    let results = results.ok_or_else(|| Failure::Unsupported("a thread panicked".to_owned()))?;
    let failed = results.into_iter().flatten().find(|result| *result != xr::Result::SUCCESS);
    app.report().fact("what fails on other threads", failed.map_or("nothing".to_owned(), name), "nothing");
    Ok(())
}
