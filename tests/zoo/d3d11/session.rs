//! The OpenXR session, with the calls that Proton's `wineopenxr` makes for a Direct3D 11 game.

use crate::com::Object;
use crate::d3d11::{Context, Device, Format, TextureDescription, bind};
use crate::interop::Interop;
use crate::look::Look;
use crate::options::Options;
use crate::scene::Scene;
use anyhow::{Context as _, Result, bail};
use ash::vk::{self, Handle};
use glam::{Mat4, Quat, Vec3, Vec4};
use openxr as xr;
use std::time::Duration;

const STEREO: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// Distance of the nearest visible things, metres.
const NEAR: f32 = 0.05;

/// Shows the scene until the session has ended.
pub fn run(options: &Options) -> Result<()> {
    // SAFETY: the loader that is installed as libopenxr_loader.so.1 is taken to be one.
    let entry = unsafe { xr::Entry::load(&()) }.context("the OpenXR loader cannot be loaded")?;
    let mut enabled = xr::ExtensionSet::default();
    enabled.khr_vulkan_enable = true;
    let application = xr::ApplicationInfo {
        application_name: "parafovea-d3d11",
        application_version: 1,
        engine_name: "none",
        engine_version: 1,
        api_version: xr::Version::new(1, 0, 0),
    };
    let instance = entry.create_instance(&application, &enabled, &[], &())?;
    let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).context("no headset")?;
    instance.graphics_requirements::<xr::Vulkan>(system)?;
    instance.vulkan_legacy_instance_extensions(system)?;
    instance.vulkan_legacy_device_extensions(system)?;
    let (device, context) = Device::create()?;
    let interop = Interop::of(&device)?;
    let handles = interop.handles();
    // SAFETY: a live instance.
    let wanted = unsafe { instance.vulkan_graphics_device(system, handles.instance.as_raw() as _) }?;
    if wanted as u64 != handles.physical_device.as_raw() {
        bail!("the runtime wants another device than DXVK's first");
    }
    let info = xr::vulkan::SessionCreateInfo {
        instance: handles.instance.as_raw() as _,
        physical_device: handles.physical_device.as_raw() as _,
        device: handles.device.as_raw() as _,
        queue_family_index: handles.queue_family,
        queue_index: handles.queue_index,
    };
    // SAFETY: DXVK's objects, which end after the session.
    let created = unsafe { instance.create_session::<xr::Vulkan>(system, &info) };
    let (session, waiter, stream) = created.context("creating the session")?;
    let scene = Scene::new(&device, options.look, [options.size; 2])?;
    let swapchains = Swapchain::all(&session, &device, &interop, options)?;
    let space = session.create_reference_space(xr::ReferenceSpaceType::LOCAL, xr::Posef::IDENTITY)?;
    let mut show =
        Show { options, context, interop: &interop, scene, swapchains, space, session, waiter, stream };
    let shown = show.run(&instance);
    // Swapchains are destroyed next, and the GPU may still draw to their images.
    interop.wait_idle()?;
    shown
}

/// A swapchain with the runtime's images as textures.
struct Swapchain {
    handle: xr::Swapchain<xr::Vulkan>,
    /// Each with its view as a target.
    images: Vec<(Object, Object)>,
    acquired: usize,
}

impl Swapchain {
    fn all(
        session: &xr::Session<xr::Vulkan>,
        device: &Device,
        interop: &Interop,
        options: &Options,
    ) -> Result<Vec<Self>> {
        let properties = options.look.properties();
        let width = if options.look == Look::DoubleWide { 2 * options.size } else { options.size };
        let copied = if options.look == Look::Copied {
            xr::SwapchainUsageFlags::TRANSFER_DST
        } else {
            xr::SwapchainUsageFlags::EMPTY
        };
        let make = |_| -> Result<Self> {
            let handle = session.create_swapchain(&xr::SwapchainCreateInfo {
                create_flags: xr::SwapchainCreateFlags::EMPTY,
                usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT
                    | xr::SwapchainUsageFlags::SAMPLED
                    | xr::SwapchainUsageFlags::MUTABLE_FORMAT
                    | copied,
                format: vk::Format::R8G8B8A8_SRGB.as_raw() as u32,
                sample_count: 1,
                width,
                height: options.size,
                face_count: 1,
                array_size: properties.layers,
                mip_count: 1,
            })?;
            let description = TextureDescription::new(
                [width, options.size],
                properties.layers,
                Format::Rgba8Srgb,
                bind::TARGET | bind::SHADER,
            );
            let wrap = |image: u64| -> Result<(Object, Object)> {
                let texture = interop.texture(&description, vk::Image::from_raw(image))?;
                let view = device.target_view(&texture)?;
                Ok((texture, view))
            };
            let images = handle.enumerate_images()?.into_iter().map(wrap).collect::<Result<_>>()?;
            Ok(Self { handle, images, acquired: 0 })
        };
        (0..properties.swapchains).map(make).collect()
    }
}

/// The running session.
struct Show<'a> {
    options: &'a Options,
    context: Context,
    interop: &'a Interop,
    scene: Scene,
    swapchains: Vec<Swapchain>,
    space: xr::Space,
    session: xr::Session<xr::Vulkan>,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
}

impl Show<'_> {
    /// Follows the session's states through all frames.
    fn run(&mut self, instance: &xr::Instance) -> Result<()> {
        let mut storage = xr::EventDataBuffer::new();
        let (mut is_running, mut frame) = (false, 0);
        loop {
            while let Some(event) = instance.poll_event(&mut storage)? {
                let xr::Event::SessionStateChanged(change) = event else { continue };
                match change.state() {
                    xr::SessionState::READY => {
                        self.session.begin(STEREO)?;
                        is_running = true;
                    }
                    xr::SessionState::STOPPING => {
                        self.session.end()?;
                        is_running = false;
                    }
                    xr::SessionState::EXITING => return Ok(()),
                    _ => {}
                }
            }
            if !is_running {
                std::thread::sleep(Duration::from_millis(1));
                continue;
            }
            if frame == self.options.frames {
                self.session.request_exit()?;
            }
            self.show(frame).with_context(|| format!("frame {frame}"))?;
            frame += 1;
        }
    }

    fn show(&mut self, frame: u64) -> Result<()> {
        let Self { interop, context, scene, swapchains, stream, .. } = self;
        let state = self.waiter.wait()?;
        interop.locked(|| stream.begin())?;
        let time = state.predicted_display_time;
        let opaque = xr::EnvironmentBlendMode::OPAQUE;
        if !state.should_render || frame >= self.options.frames {
            return Ok(interop.locked(|| stream.end(time, opaque, &[]))?);
        }
        let (_, views) = self.session.locate_views(STEREO, time, &self.space)?;
        let views: [xr::View; 2] = views.try_into().ok().context("two views")?;
        for swapchain in swapchains.iter_mut() {
            swapchain.acquired = interop.locked(|| swapchain.handle.acquire_image())? as usize;
            swapchain.handle.wait_image(xr::Duration::INFINITE)?;
        }
        let images: Vec<(&Object, &Object)> = swapchains
            .iter()
            .filter_map(|swapchain| swapchain.images.get(swapchain.acquired))
            .map(|(texture, view)| (texture, view))
            .collect();
        scene.draw(context, frame, [view_projection(&views[0]), view_projection(&views[1])], &images)?;
        for swapchain in swapchains.iter_mut() {
            if !self.options.flushes_late {
                interop.flush();
            }
            interop.locked(|| swapchain.handle.release_image())?;
        }
        if self.options.flushes_late {
            interop.flush();
        }
        let shown = projection_views(self.options, swapchains, &views)?;
        let layer = xr::CompositionLayerProjection::new().space(&self.space).views(&shown);
        Ok(interop.locked(|| stream.end(time, opaque, &[&layer]))?)
    }
}

/// The views as the runtime shows them.
fn projection_views<'a>(
    options: &Options,
    swapchains: &'a [Swapchain],
    views: &[xr::View; 2],
) -> Result<Vec<xr::CompositionLayerProjectionView<'a, xr::Vulkan>>> {
    let side = i32::try_from(options.size)?;
    let extent = xr::Extent2Di { width: side, height: side };
    let make = |(eye, view): (usize, &xr::View)| {
        let swapchain = swapchains.get(eye).or(swapchains.first()).context("no swapchain")?;
        let left = if options.look == Look::DoubleWide { side * eye as i32 } else { 0 };
        let layer = if options.look == Look::Instanced { eye as u32 } else { 0 };
        let rect = xr::Rect2Di { offset: xr::Offset2Di { x: left, y: 0 }, extent };
        let image = xr::SwapchainSubImage::new()
            .swapchain(&swapchain.handle)
            .image_array_index(layer)
            .image_rect(rect);
        Ok(xr::CompositionLayerProjectionView::new().pose(view.pose).fov(view.fov).sub_image(image))
    };
    views.iter().enumerate().map(make).collect()
}

/// From the world to clip space, with reversed depth that ends at infinity.
fn view_projection(view: &xr::View) -> Mat4 {
    let [left, right] = [view.fov.angle_left, view.fov.angle_right].map(f32::tan);
    let [down, up] = [view.fov.angle_down, view.fov.angle_up].map(f32::tan);
    let (width, height) = (right - left, up - down);
    let projection = Mat4::from_cols(
        Vec4::new(2.0 / width, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 2.0 / height, 0.0, 0.0),
        Vec4::new((right + left) / width, (up + down) / height, 0.0, -1.0),
        Vec4::new(0.0, 0.0, NEAR, 0.0),
    );
    let (q, p) = (view.pose.orientation, view.pose.position);
    let pose = Mat4::from_rotation_translation(Quat::from_xyzw(q.x, q.y, q.z, q.w), Vec3::new(p.x, p.y, p.z));
    projection * pose.inverse()
}
