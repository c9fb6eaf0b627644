//! Churn: sessions one after the other on one device, each of which shows many styles at many sizes. The objects of each are made for
//! it, and destroyed after it: swapchains, targets, render passes, framebuffers, pipelines.

use super::{APPLICATION, After, Course, End, Show, Waiter};
use crate::gpu::{Gpu, Opened};
use crate::options::Options;
use crate::style::Style;
use crate::styles::{STYLES, new_targets};
use crate::support::{Demands, Feature, Queues};
use anyhow::{Context, Result, ensure};
use ash::vk;
use openxr as xr;
use std::ffi::c_int;
use std::time::{Duration, Instant};

/// Names of the styles: swapchains of all arrangements, passes of all kinds, targets off-screen, and depth that is submitted.
const NAMES: [&str; 15] = [
    "render-pass",
    "dynamic-rendering",
    "imageless",
    "multiview",
    "double-wide",
    "offscreen-tonemap",
    "upscaled",
    "msaa-resolve",
    "deferred",
    "subpasses",
    "new-views",
    "dynamic-resolution",
    "prerecorded",
    "submitted-depth",
    "taa",
];

/// Sizes of an eye buffer: multiples of 16 pixels, in these.
const SIZES: std::ops::RangeInclusive<u32> = 4..=12;

/// Styles that a session shows.
const PLACES: u32 = 4;

/// Frames of each.
const FRAMES: std::ops::RangeInclusive<u64> = 8..=40;

/// One session in so many is destroyed without being asked to end.
const ABANDONED: u32 = 4;

unsafe extern "C" {
    /// glibc: returns free memory to the system.
    fn malloc_trim(pad: usize) -> c_int;
}

/// Shows sessions for so long, in an order that `seed` gives. After each there is nothing left but the device, which then idles.
///
/// # Errors
/// If there is no loader, runtime, headset or GPU, or a call fails.
pub fn churn(options: &Options, time: Duration) -> Result<End> {
    let entry = super::entry()?;
    let mut enabled = xr::ExtensionSet::default();
    enabled.khr_vulkan_enable2 = true;
    enabled.khr_composition_layer_depth = true;
    let instance = entry.create_instance(&APPLICATION, &enabled, &[], &())?;
    let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).context("no headset")?;
    let demands = Demands {
        vulkan: vk::API_VERSION_1_3,
        extensions: Vec::new(),
        features: vec![Feature::Multiview, Feature::DynamicRendering, Feature::ImagelessFramebuffer],
        queues: Queues::One,
    };
    let gpu = match Gpu::open(&instance, system, &demands, None)? {
        Opened::Gpu(gpu) => gpu,
        Opened::Lacking(what) => return Ok(End::Skipped(what)),
    };
    let mut styles: Vec<&Style> =
        STYLES.iter().copied().filter(|style| NAMES.contains(&style.name)).collect();
    // More often than the others.
    styles.extend([&new_targets::STYLE; 3]);
    if let Some(name) = &options.style {
        styles.retain(|style| style.name == name);
        ensure!(!styles.is_empty(), "{name} is not part of the churn");
    }
    let mut world = World { options, styles, numbers: fastrand::Rng::with_seed(options.seed) };
    let start = Instant::now();
    while start.elapsed() < time {
        world.session(&instance, system, &gpu)?;
        // SAFETY: callable at any time; no other thread uses the device.
        unsafe {
            malloc_trim(0);
            gpu.device_wait_idle()?;
        }
    }
    Ok(End::Shown)
}

struct World<'o> {
    options: &'o Options,
    styles: Vec<&'static Style>,
    numbers: fastrand::Rng,
}

impl World<'_> {
    fn session(&mut self, instance: &xr::Instance, system: xr::SystemId, gpu: &Gpu) -> Result<()> {
        // SAFETY: instance, physical device and device came from XR_KHR_vulkan_enable2; the device outlives the session.
        let session = unsafe { instance.create_session::<xr::Vulkan>(system, &gpu.session_info()) };
        let (session, waiter, stream) = session.context("creating the session")?;
        let mut course = Course { stream, waiter: Waiter::Here(waiter), is_running: false };
        let is_abandoned = self.numbers.u32(..ABANDONED) == 0;
        for place in 0..PLACES {
            let style = self.styles[self.numbers.usize(..self.styles.len())];
            let options = Options {
                size: 16 * self.numbers.u32(SIZES),
                frames: self.numbers.u64(FRAMES),
                seed: self.numbers.u64(..),
                ..self.options.clone()
            };
            let after = if place + 1 < PLACES || is_abandoned { After::Others } else { After::Exit };
            let mut show = Show::new(style, &options, &session, course, gpu)?;
            show.run(instance, after).with_context(|| format!("{} at {}", style.name, options.size))?;
            // The swapchains live as long as the objects that were made of their images.
            gpu.destroy_made()?;
            course = show.course;
        }
        Ok(())
    }
}
