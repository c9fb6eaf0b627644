//! The OpenXR side: from the loader to the end of the session.

mod graphics;
mod input;
mod projection;
mod swapchain;

use std::collections::VecDeque;
use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail};
use glam::{Quat, Vec3};
use openxr as xr;

use self::graphics::Graphics;
use self::input::Input;
use self::projection::Projection;
use self::swapchain::{BOARD_POSE, BOARD_SIZE, Swapchain};
use crate::camera::Camera;
use crate::options::Options;
use crate::renderer::Renderer;
use crate::scene::{FRAMES_PER_SECOND, text};

const VIEW_TYPE: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;
/// Frames whose work the device may have at a time: more would only be older when they are seen.
const IN_FLIGHT: usize = 2;
/// Height of a standing visitor's eyes in metres, for runtimes without a stage.
const EYE_HEIGHT: f32 = 1.6;

/// Runs the application until its session has ended; gives the number of rendered frames.
///
/// # Errors
/// If there is no loader, runtime, headset or GPU, if the runtime lacks a feature that the options require, or if a
/// call fails; the text names the cause.
pub fn run(options: &Options) -> Result<u64> {
    let instance = create_instance(options)?;
    let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).context("no headset")?;
    let graphics = Graphics::new(&instance, system)?;
    let mut frames = 0;
    for _ in 0..options.sessions {
        let mut app = App::new(options, &instance, system, &graphics)?;
        app.run_session(&instance)?;
        frames += app.frame;
    }
    Ok(frames)
}

/// The options from the change of swapchains on, where eyes had `size` before.
fn changed(options: &Options, size: [u32; 2]) -> Options {
    Options {
        swapchain: options.change_to.unwrap_or(options.swapchain),
        size: Some(options.change_size.unwrap_or(size)),
        ..options.clone()
    }
}

fn create_instance(options: &Options) -> Result<xr::Instance> {
    // SAFETY: the loader that is installed as libopenxr_loader.so.1 is taken to be one.
    let entry = unsafe { xr::Entry::load(&()) }
        .context("the OpenXR loader, libopenxr_loader.so.1, cannot be loaded; is it installed?")?;
    const NO_RUNTIME: &str = "no OpenXR runtime; is one installed and active, or XR_RUNTIME_JSON set?";
    let available = entry.enumerate_extensions().context(NO_RUNTIME)?;
    let mut enabled = xr::ExtensionSet::default();
    if !available.khr_vulkan_enable2 {
        bail!("the OpenXR runtime lacks XR_KHR_vulkan_enable2");
    }
    enabled.khr_vulkan_enable2 = true;
    if options.depth_layer && !available.khr_composition_layer_depth {
        bail!("--depth-layer: the OpenXR runtime lacks XR_KHR_composition_layer_depth");
    }
    enabled.khr_composition_layer_depth = options.depth_layer;
    enabled.ext_eye_gaze_interaction = options.foveation.is_some() && available.ext_eye_gaze_interaction;
    let application = xr::ApplicationInfo {
        application_name: "parafovea-scene",
        application_version: 1,
        engine_name: "wgpu",
        engine_version: 30,
        api_version: xr::Version::new(1, 0, 0),
    };
    entry.create_instance(&application, &enabled, &[], &()).context(NO_RUNTIME)
}

/// Everything that lives as long as the session. Fields are dropped from the top: the drawing objects go before the
/// session, which keeps the device alive.
struct App {
    renderer: Renderer,
    projection: Projection,
    board: Option<Swapchain>,
    input: Option<Input>,
    space: xr::Space,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    session: xr::Session<xr::Vulkan>,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Work of the last frames, at most [`IN_FLIGHT`], the oldest first.
    submitted: VecDeque<wgpu::SubmissionIndex>,
    blend_mode: xr::EnvironmentBlendMode,
    /// Frames rendered so far.
    frame: u64,
    /// Offset of the animation's clock.
    first_frame: u64,
    /// Speed of that clock; 0: it stands still.
    pace: f64,
    /// The frame from which on no light is lit.
    lights_out: Option<u64>,
    /// Frame at which the swapchains are made again, their options, and their format.
    change: Option<(u64, Options, wgpu::TextureFormat)>,
    /// Number of the last frame; the end is requested after it.
    last_frame: Option<u64>,
    exit_requested: bool,
}

impl App {
    fn new(
        options: &Options,
        instance: &xr::Instance,
        system: xr::SystemId,
        graphics: &Graphics,
    ) -> Result<Self> {
        let blend_modes = instance.enumerate_environment_blend_modes(system, VIEW_TYPE)?;
        let (session, waiter, stream) = graphics.create_session(instance, system)?;
        let input = if options.no_actions {
            None
        } else {
            let with_eyes = instance.exts().ext_eye_gaze_interaction.is_some();
            Some(Input::attach(instance, &session, with_eyes).context("actions")?)
        };
        let recommended = instance.enumerate_view_configuration_views(system, VIEW_TYPE)?;
        let view = recommended.first().context("the runtime has no stereo view")?;
        let size =
            options.size.unwrap_or([view.recommended_image_rect_width, view.recommended_image_rect_height]);
        let format = swapchain::choose_format(&session, options.format)?;
        let (device, queue) = (graphics.device.clone(), graphics.queue.clone());
        Ok(Self {
            renderer: Renderer::new(&device, &queue, format, options.scene(), options.light_count()),
            projection: Projection::new(&session, (&device, &queue), options, format, size)?,
            board: options
                .quad
                .then(|| Swapchain::new(&session, &device, format, text::SIZE, 1, false))
                .transpose()
                .context("the quad layer's swapchain")?,
            input,
            space: create_space(&session)?,
            waiter,
            stream,
            session,
            device,
            queue,
            submitted: VecDeque::new(),
            blend_mode: blend_modes.first().copied().unwrap_or(xr::EnvironmentBlendMode::OPAQUE),
            frame: 0,
            first_frame: options.first_frame,
            pace: if options.still { 0.0 } else { options.pace },
            lights_out: options.lights_out,
            change: options.change_at.map(|at| (at, changed(options, size), format)),
            last_frame: options.frames,
            exit_requested: false,
        })
    }

    /// Follows the session's states until it has ended.
    fn run_session(&mut self, instance: &xr::Instance) -> Result<()> {
        let mut storage = xr::EventDataBuffer::new();
        let mut running = false;
        loop {
            while let Some(event) = instance.poll_event(&mut storage)? {
                match event {
                    xr::Event::SessionStateChanged(change) => match change.state() {
                        xr::SessionState::READY => {
                            self.session.begin(VIEW_TYPE)?;
                            running = true;
                        }
                        xr::SessionState::STOPPING => {
                            self.session.end()?;
                            running = false;
                        }
                        xr::SessionState::EXITING => return self.finish(),
                        xr::SessionState::LOSS_PENDING => bail!("the session is about to be lost"),
                        _ => {}
                    },
                    xr::Event::InstanceLossPending(_) => bail!("the OpenXR runtime is about to go away"),
                    _ => {}
                }
            }
            if running {
                self.run_frame().with_context(|| format!("frame {}", self.frame))?;
            } else {
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }

    fn run_frame(&mut self) -> Result<()> {
        let state = self.waiter.wait()?;
        self.stream.begin()?;
        let quit = match &self.input {
            Some(input) => input.wants_to_quit(&self.session)?,
            None => false,
        };
        let done = quit || self.last_frame.is_some_and(|last| self.frame >= last);
        if done && !self.exit_requested {
            self.session.request_exit()?;
            self.exit_requested = true;
        }
        let time = state.predicted_display_time;
        let views = if state.should_render && !self.exit_requested { self.locate(time)? } else { None };
        match views {
            Some(views) => self.render(time, &views),
            None => Ok(self.stream.end(time, self.blend_mode, &[])?),
        }
    }

    /// Predicted views of the eyes; None if the runtime does not know them.
    fn locate(&self, time: xr::Time) -> Result<Option<Vec<xr::View>>> {
        let (flags, views) = self.session.locate_views(VIEW_TYPE, time, &self.space)?;
        let known = xr::ViewStateFlags::POSITION_VALID | xr::ViewStateFlags::ORIENTATION_VALID;
        Ok(flags.contains(known).then_some(views))
    }

    fn render(&mut self, time: xr::Time, views: &[xr::View]) -> Result<()> {
        self.wait_for_device()?;
        self.change_swapchains()?;
        let cameras: Vec<_> = views.iter().map(camera).collect();
        let animation_time = (self.first_frame as f64 + self.pace * self.frame as f64) / FRAMES_PER_SECOND;
        let is_dark = self.lights_out.is_some_and(|from| self.frame >= from);
        self.renderer.prepare(animation_time, is_dark, &cameras);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.projection.acquire()?;
        let gaze = match &mut self.input {
            Some(input) => input.gaze(&self.session, &self.space, time)?,
            None => None,
        };
        // The left eye's forward direction if the gaze is unknown.
        let gaze = gaze.unwrap_or(cameras[0].orientation * Vec3::NEG_Z);
        self.projection.draw(&self.renderer, &mut encoder, &cameras, gaze);
        if let Some(board) = &mut self.board {
            board.acquire()?;
            self.renderer.draw_board(&mut encoder, board.view(0));
        }
        self.submitted.push_back(self.queue.submit([encoder.finish()]));
        self.device.poll(wgpu::PollType::Poll)?;
        self.projection.release()?;
        if let Some(board) = &mut self.board {
            board.release()?;
        }
        self.submit(time, views)?;
        self.frame += 1;
        Ok(())
    }

    /// Waits until the device has room for another frame's work.
    fn wait_for_device(&mut self) -> Result<()> {
        while self.submitted.len() >= IN_FLIGHT {
            let submission_index = self.submitted.pop_front();
            self.device.poll(wgpu::PollType::Wait { submission_index, timeout: None })?;
        }
        Ok(())
    }

    /// Makes the swapchains again before the frame that is to begin with new ones.
    fn change_swapchains(&mut self) -> Result<()> {
        let Some((_, options, format)) = self.change.take_if(|(at, ..)| *at <= self.frame) else {
            return Ok(());
        };
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        let size = options.size.context("a size")?;
        let devices = (&self.device, &self.queue);
        self.projection = Projection::new(&self.session, devices, &options, format, size)?;
        Ok(())
    }

    fn submit(&mut self, time: xr::Time, views: &[xr::View]) -> Result<()> {
        let depths = self.projection.depth_infos();
        let projection_views = self.projection.layer_views(views, &depths);
        let projection = xr::CompositionLayerProjection::new().space(&self.space).views(&projection_views);
        let quad = self.board.as_ref().map(|board| {
            xr::CompositionLayerQuad::new()
                .layer_flags(xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA)
                .space(&self.space)
                .eye_visibility(xr::EyeVisibility::BOTH)
                .sub_image(board.sub_image())
                .pose(BOARD_POSE)
                .size(BOARD_SIZE)
        });
        let mut layers: Vec<&xr::CompositionLayerBase<xr::Vulkan>> = vec![&projection];
        if let Some(quad) = &quad {
            layers.push(quad);
        }
        Ok(self.stream.end(time, self.blend_mode, &layers)?)
    }

    /// The session has ended; waits until the device is done with the images.
    fn finish(&self) -> Result<()> {
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(())
    }
}

/// The stage where there is one, else a floor under the place where the visitor started.
fn create_space(session: &xr::Session<xr::Vulkan>) -> Result<xr::Space> {
    let spaces = session.enumerate_reference_spaces()?;
    if spaces.contains(&xr::ReferenceSpaceType::STAGE) {
        return Ok(session.create_reference_space(xr::ReferenceSpaceType::STAGE, xr::Posef::IDENTITY)?);
    }
    let floor =
        xr::Posef { position: xr::Vector3f { x: 0.0, y: -EYE_HEIGHT, z: 0.0 }, ..xr::Posef::IDENTITY };
    session
        .create_reference_space(xr::ReferenceSpaceType::LOCAL, floor)
        .map_err(|error| anyhow!(error).context("neither a stage nor a local space"))
}

fn camera(view: &xr::View) -> Camera {
    let (position, orientation, fov) = (view.pose.position, view.pose.orientation, view.fov);
    Camera::new(
        Vec3::new(position.x, position.y, position.z),
        Quat::from_xyzw(orientation.x, orientation.y, orientation.z, orientation.w),
        [fov.angle_left, fov.angle_right, fov.angle_down, fov.angle_up],
    )
}
