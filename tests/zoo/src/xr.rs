//! The OpenXR side: from the loader to the end of the session.

mod churn;
mod input;
mod layers;
mod slots;
mod waiter;

use crate::WINDOW;
use crate::app::{App, Frame};
use crate::gpu::{Device, Gpu, Opened, RatesFile, RatesUse};
use crate::options::Options;
use crate::scene::{Projection, Scene, Uniforms};
use crate::simulation::Simulation;
use crate::style::{Arrangement, Style};
use crate::support::Needs;
use crate::swapchain::Swapchain;
use anyhow::{Context, Result, bail};
use ash::vk;
use openxr as xr;
use parafovea_test_layers::ShadingRateDevice;
use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::time::Duration;

pub use churn::churn;

use input::Input;
use layers::Layers;
use slots::Slots;
use waiter::Waiter;

const STEREO: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// The format of colour swapchains.
pub const COLOR: vk::Format = vk::Format::R8G8B8A8_SRGB;

/// Field of view of a window.
const WINDOW_FOV: xr::Fovf = xr::Fovf { angle_left: -0.7, angle_right: 0.7, angle_up: 0.7, angle_down: -0.7 };

/// Width and height of the quad layer's swapchain beside eyes of this size.
pub fn board_size([width, height]: [u32; 2]) -> [u32; 2] {
    [width / 2, height / 4]
}

/// End of a run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum End {
    /// The session ended.
    Shown,
    /// The device or the runtime lacks this.
    Skipped(String),
}

const APPLICATION: xr::ApplicationInfo = xr::ApplicationInfo {
    application_name: "parafovea-zoo",
    application_version: 1,
    engine_name: "none",
    engine_version: 1,
    api_version: xr::Version::new(1, 0, 0),
};

fn entry() -> Result<xr::Entry> {
    // SAFETY: the library that is installed as libopenxr_loader.so.1 is taken to be one.
    unsafe { xr::Entry::load(&()) }.context("the OpenXR loader cannot be loaded")
}

/// Devices of the instance that the runtime makes.
///
/// # Errors
/// If there is no loader, runtime, headset or GPU, or a call fails.
pub fn devices() -> Result<Vec<Device>> {
    with_gpu(Gpu::devices)
}

/// The limits of devices with VK_KHR_fragment_shading_rate.
///
/// # Errors
/// As for [`devices`].
pub fn shading_rates() -> Result<Vec<ShadingRateDevice>> {
    with_gpu(Gpu::shading_rates)
}

fn with_gpu<T>(ask: impl FnOnce(&Gpu) -> Result<T>) -> Result<T> {
    let mut enabled = xr::ExtensionSet::default();
    enabled.khr_vulkan_enable2 = true;
    let instance = entry()?.create_instance(&APPLICATION, &enabled, &[], &())?;
    let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).context("no headset")?;
    let needs = Needs { vulkan: vk::API_VERSION_1_2, ..Needs::NOTHING };
    match Gpu::open(&instance, system, &needs.demands(false), None)? {
        Opened::Gpu(gpu) => ask(&gpu),
        Opened::Lacking(what) => bail!("the device lacks {what}"),
    }
}

/// Shows the scene until the session has ended.
///
/// # Errors
/// If there is no loader, runtime, headset or GPU, or a call fails.
pub fn run(style: &Style, options: &Options) -> Result<End> {
    // SAFETY: the loader that is installed as libopenxr_loader.so.1 is taken to be one.
    let entry = unsafe { xr::Entry::load(&()) }.context("the OpenXR loader cannot be loaded")?;
    let available = entry.enumerate_extensions().context("no OpenXR runtime")?;
    let mut enabled = xr::ExtensionSet::default();
    enabled.khr_vulkan_enable2 = true;
    enabled.khr_composition_layer_depth = style.needs.openxr.depth;
    enabled.khr_visibility_mask = style.needs.openxr.hidden_area;
    let missing = enabled.difference(&available);
    if let Some(name) = missing.names().first() {
        return Ok(End::Skipped(String::from_utf8_lossy(name).into_owned()));
    }
    let instance = entry.create_instance(&APPLICATION, &enabled, &[], &())?;
    let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).context("no headset")?;
    if options.look.is_some() && !style.can_show_look {
        bail!("the shaders of {} do not show the look of rates", style.name);
    }
    let load = |path: &Option<PathBuf>| path.as_deref().map(RatesFile::load).transpose();
    let maps = match load(&options.look)? {
        Some(maps) => Some((RatesUse::Look, maps)),
        None => load(&options.native_map)?.map(|maps| (RatesUse::Attachment, maps)),
    };
    let sets_rates = options.native_map.is_some();
    let gpu = match Gpu::open(&instance, system, &style.needs.demands(sets_rates), maps)? {
        Opened::Gpu(gpu) => gpu,
        Opened::Lacking(what) => return Ok(End::Skipped(what)),
    };
    // SAFETY: instance, physical device and device came from XR_KHR_vulkan_enable2; `gpu` was made earlier, so that it
    // is dropped after the session and all that is made from it.
    let session = unsafe { instance.create_session::<xr::Vulkan>(system, &gpu.session_info()) };
    let (session, waiter, stream) = session.context("creating the session")?;
    let input = options.actions.then(|| Input::attach(&instance, &session)).transpose().context("actions")?;
    let course = Course { stream, waiter: Waiter::new(waiter, style.threads), is_running: false };
    let mut show = Show { input, ..Show::new(style, options, &session, course, &gpu)? };
    let shown = show.run(&instance, After::Exit);
    if shown.is_err() {
        // Objects that the GPU still uses are destroyed next.
        // SAFETY: the device is live, and no other thread uses its queues any more.
        let _ = unsafe { gpu.device.device_wait_idle() };
    }
    shown?;
    gpu.destroy_made()?;
    Ok(End::Shown)
}

/// Progress of a session through its states and frames.
struct Course {
    stream: xr::FrameStream<xr::Vulkan>,
    waiter: Waiter,
    is_running: bool,
}

/// Next step after the frames.
#[derive(Clone, Copy, PartialEq, Eq)]
enum After {
    /// The session is asked to end, and followed until it has.
    Exit,
    /// Other frames of the same session.
    Others,
}

/// The shown image, and its place.
struct Show<'g> {
    style: &'g Style,
    options: &'g Options,
    gpu: &'g Gpu,
    color: Vec<Swapchain>,
    depth: Vec<Swapchain>,
    quad: Option<Swapchain>,
    slots: Slots,
    space: xr::Space,
    input: Option<Input>,
    course: Course,
    session: xr::Session<xr::Vulkan>,
    /// Frames rendered so far.
    frame: u64,
    exit_requested: bool,
    simulation: Simulation,
}

impl<'g> Show<'g> {
    fn new(
        style: &'g Style,
        options: &'g Options,
        session: &xr::Session<xr::Vulkan>,
        course: Course,
        gpu: &'g Gpu,
    ) -> Result<Self> {
        let size = options.size;
        let (count, layers, extent) = match style.arrangement {
            Arrangement::Separate => (2, 1, [size, size]),
            Arrangement::Array => (1, 2, [size, size]),
            Arrangement::DoubleWide => (1, 1, [2 * size, size]),
        };
        let openxr = style.needs.openxr;
        let usage = if openxr.copied {
            xr::SwapchainUsageFlags::TRANSFER_DST
        } else {
            xr::SwapchainUsageFlags::EMPTY
        };
        let swapchains = |count, format, usage| {
            (0..count).map(|_| Swapchain::new(session, gpu, format, extent, layers, usage)).collect()
        };
        let color: Result<Vec<_>> = swapchains(count, COLOR, usage);
        let depths = if openxr.depth { count } else { 0 };
        let depth: Result<Vec<_>> =
            swapchains(depths, vk::Format::D32_SFLOAT, xr::SwapchainUsageFlags::EMPTY);
        let quad = openxr.quad.then(|| {
            Swapchain::new(session, gpu, COLOR, board_size([size, size]), 1, xr::SwapchainUsageFlags::EMPTY)
        });
        Ok(Self {
            style,
            options,
            gpu,
            color: color?,
            depth: depth?,
            quad: quad.transpose()?,
            slots: Slots::new(gpu)?,
            space: session.create_reference_space(xr::ReferenceSpaceType::LOCAL, xr::Posef::IDENTITY)?,
            input: None,
            course,
            session: session.clone(),
            frame: 0,
            exit_requested: false,
            simulation: Simulation::default(),
        })
    }

    /// Follows the session's states through all frames.
    fn run(&mut self, instance: &xr::Instance, after: After) -> Result<()> {
        let images = |swapchains: &[Swapchain]| swapchains.iter().map(|one| one.images.clone()).collect();
        let app = App {
            gpu: self.gpu,
            scene: Scene::new(self.gpu)?,
            seed: self.options.seed,
            look: self.options.rules(),
            size: [self.options.size; 2],
            color: images(&self.color),
            depth: images(&self.depth),
            quad: self.quad.iter().flat_map(|quad| quad.images.clone()).collect(),
            hidden: self.hidden_areas()?,
        };
        let mut record = (self.style.start)(&app).context("starting")?;
        let mut storage = xr::EventDataBuffer::new();
        loop {
            while let Some(event) = instance.poll_event(&mut storage)? {
                let xr::Event::SessionStateChanged(change) = event else { continue };
                match change.state() {
                    xr::SessionState::READY => {
                        self.session.begin(STEREO)?;
                        self.course.is_running = true;
                    }
                    xr::SessionState::STOPPING => {
                        self.session.end()?;
                        self.course.is_running = false;
                    }
                    xr::SessionState::EXITING => return self.show_in_window(&app, &mut record),
                    xr::SessionState::LOSS_PENDING => bail!("the session is about to be lost"),
                    _ => {}
                }
            }
            if !self.course.is_running {
                std::thread::sleep(Duration::from_millis(1));
                continue;
            }
            if self.frame >= self.options.frames && after == After::Others {
                return Ok(());
            }
            if self.frame >= self.options.frames && !self.exit_requested {
                self.session.request_exit()?;
                self.exit_requested = true;
                continue;
            }
            if let Some(input) = &self.input {
                input.synchronise(&self.session)?;
            }
            let state = self.course.waiter.wait()?;
            self.show(&app, &mut record, state).with_context(|| format!("frame {}", self.frame))?;
        }
    }

    fn show(
        &mut self,
        app: &App,
        record: &mut dyn FnMut(&Frame) -> Result<()>,
        state: xr::FrameState,
    ) -> Result<()> {
        self.course.stream.begin()?;
        let time = state.predicted_display_time;
        let opaque = xr::EnvironmentBlendMode::OPAQUE;
        if !state.should_render || self.exit_requested {
            return Ok(self.course.stream.end(time, opaque, &[])?);
        }
        let (_, views) = self.session.locate_views(STEREO, time, &self.space)?;
        let views: [xr::View; 2] = views.try_into().ok().context("two views")?;
        self.simulation.run(Duration::from_micros(self.options.work));
        let acquire = |swapchains: &mut Vec<Swapchain>| {
            swapchains.iter_mut().map(Swapchain::acquire).collect::<Result<Vec<_>>>()
        };
        let slot = self.slots.next(self.gpu)?;
        let frame = Frame {
            index: self.frame,
            animated: self.options.first_frame + self.frame,
            slot: slot.index,
            commands: slot.commands,
            uniforms: Uniforms::new(self.options.first_frame + self.frame, &views, Projection::default()),
            views: &views,
            color: acquire(&mut self.color)?,
            depth: acquire(&mut self.depth)?,
            quad: self.quad.as_mut().map_or(Ok(0), Swapchain::acquire)?,
            after: RefCell::default(),
            waits: RefCell::default(),
            shown: Cell::new(app.size),
            window: None,
        };
        app.scene.write(slot.index, &frame.uniforms);
        let once = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
        self.gpu.record(slot.commands, once, |_| record(&frame))?;
        self.slots.submit(self.gpu, &slot, &frame)?;
        for swapchain in self.color.iter_mut().chain(&mut self.depth).chain(&mut self.quad) {
            swapchain.handle.release_image()?;
        }
        let layers = Layers {
            arrangement: self.style.arrangement,
            color: &self.color,
            depth: &self.depth,
            quad: self.quad.as_ref(),
            space: &self.space,
            shown: frame.shown.get(),
            size: app.size,
        };
        layers.submit(&mut self.course.stream, time, &views)?;
        self.print_passes()?;
        self.frame += 1;
        Ok(())
    }

    /// Draws on after the session has ended.
    fn show_in_window(&mut self, app: &App, record: &mut dyn FnMut(&Frame) -> Result<()>) -> Result<()> {
        if self.options.window_frames == 0 {
            return Ok(());
        }
        let [width, height] = app.size.map(|side| side as usize);
        let texel = 8;
        let buffer = self.gpu.buffer(width * height * texel, vk::BufferUsageFlags::TRANSFER_DST)?;
        let views = [xr::View { pose: xr::Posef::IDENTITY, fov: WINDOW_FOV }; 2];
        for index in self.frame..self.frame + self.options.window_frames {
            let slot = self.slots.next(self.gpu)?;
            let frame = Frame {
                index,
                animated: index,
                slot: slot.index,
                commands: slot.commands,
                uniforms: Uniforms::new(index, &views, Projection::default()),
                views: &views,
                color: Vec::new(),
                depth: Vec::new(),
                quad: 0,
                after: RefCell::default(),
                waits: RefCell::default(),
                shown: Cell::new(app.size),
                window: Some(buffer),
            };
            app.scene.write(slot.index, &frame.uniforms);
            let once = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
            self.gpu.record(slot.commands, once, |_| record(&frame))?;
            self.slots.submit(self.gpu, &slot, &frame)?;
        }
        // SAFETY: this thread is the only one that uses the device.
        unsafe { self.gpu.device.device_wait_idle() }?;
        println!("{WINDOW}{:016x}", buffer.checksum());
        Ok(())
    }

    fn print_passes(&self) -> Result<()> {
        for seen in self.gpu.take_begun() {
            if self.options.passes {
                let seen = crate::PassSeen { frame: self.frame, ..seen };
                println!("{}", serde_json::to_string(&seen)?);
            }
        }
        Ok(())
    }

    /// The hidden area of each view, if the style asks for it.
    fn hidden_areas(&self) -> Result<[Vec<[f32; 2]>; 2]> {
        if !self.style.needs.openxr.hidden_area {
            return Ok(Default::default());
        }
        let area = |view| -> Result<Vec<[f32; 2]>> {
            let ty = xr::VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH;
            let mask = self.session.get_visibility_mask_khr(STEREO, view, ty)?;
            let corner = |index: &u32| mask.vertices.get(*index as usize).map(|at| [at.x, at.y]);
            mask.indices.iter().map(corner).collect::<Option<_>>().context("an index outside the mask")
        };
        Ok([area(0)?, area(1)?])
    }
}
