//! The OpenXR side, where the program is an OpenXR application: a session on its device, and an image for each eye.

use crate::device::{Device, Wishes};
use crate::pipeline::FORMAT;
use anyhow::{Context, Result, bail};
use ash::vk::{self, Handle};
use openxr as xr;
use std::ffi::c_void;
use std::time::Duration;

const VIEWS: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// An OpenXR instance with a headset.
pub struct Headset {
    instance: xr::Instance,
    system: xr::SystemId,
}

impl Headset {
    /// Finds the headset.
    pub fn new() -> Result<Self> {
        // SAFETY: the library that is installed as libopenxr_loader.so.1 is taken to be one.
        let entry = unsafe { xr::Entry::load(&()) }.context("no OpenXR loader")?;
        let mut extensions = xr::ExtensionSet::default();
        extensions.khr_vulkan_enable = true;
        let application = xr::ApplicationInfo {
            application_name: "parafovea-overhead",
            application_version: 1,
            engine_name: "",
            engine_version: 0,
            api_version: xr::Version::new(1, 0, 0),
        };
        let instance =
            entry.create_instance(&application, &extensions, &[], &()).context("no OpenXR runtime")?;
        let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY)?;
        Ok(Self { instance, system })
    }

    /// Requirements of the runtime on instance and device.
    pub fn wishes(&self) -> Result<Wishes> {
        self.instance.graphics_requirements::<xr::Vulkan>(self.system)?;
        Ok(Wishes {
            instance_extensions: self.instance.vulkan_legacy_instance_extensions(self.system)?,
            device_extensions: self.instance.vulkan_legacy_device_extensions(self.system)?,
        })
    }

    /// The device that the headset is at.
    pub fn physical_device(&self, instance: vk::Instance) -> Result<vk::PhysicalDevice> {
        let instance = instance.as_raw() as *const c_void;
        // SAFETY: the instance is live.
        let device = unsafe { self.instance.vulkan_graphics_device(self.system, instance)? };
        Ok(vk::PhysicalDevice::from_raw(device as u64))
    }

    /// Begins a session on `device`, which must outlive it, with images of that size for the eyes.
    pub fn begin_session(self, device: &Device, extent: vk::Extent2D) -> Result<Session> {
        let info = xr::vulkan::SessionCreateInfo {
            instance: device.instance.handle().as_raw() as *const c_void,
            physical_device: device.physical_device.as_raw() as *const c_void,
            device: device.functions.handle().as_raw() as *const c_void,
            queue_family_index: device.family,
            queue_index: 0,
        };
        // SAFETY: instance and device meet the requirements of the runtime, and outlive the session.
        let (session, waiter, stream) =
            unsafe { self.instance.create_session::<xr::Vulkan>(self.system, &info)? };
        let space = session.create_reference_space(xr::ReferenceSpaceType::LOCAL, xr::Posef::IDENTITY)?;
        let eye = |_| -> Result<Eye> {
            let swapchain = session.create_swapchain(&xr::SwapchainCreateInfo {
                create_flags: xr::SwapchainCreateFlags::EMPTY,
                usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT,
                format: FORMAT.as_raw() as u32,
                sample_count: 1,
                width: extent.width,
                height: extent.height,
                face_count: 1,
                array_size: 1,
                mip_count: 1,
            })?;
            let images = swapchain.enumerate_images()?.into_iter().map(vk::Image::from_raw).collect();
            Ok(Eye { swapchain, images })
        };
        let eyes = [eye(0)?, eye(1)?];
        let mut session = Session { eyes, extent, space, waiter, stream, session, instance: self.instance };
        session.wait_until_ready()?;
        Ok(session)
    }
}

/// A running session.
pub struct Session {
    /// The images of the left and the right eye.
    pub eyes: [Eye; 2],
    extent: vk::Extent2D,
    space: xr::Space,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    session: xr::Session<xr::Vulkan>,
    instance: xr::Instance,
}

/// An eye's images.
pub struct Eye {
    swapchain: xr::Swapchain<xr::Vulkan>,
    /// All of them.
    pub images: Vec<vk::Image>,
}

/// A frame that was begun.
pub struct Frame {
    time: xr::Time,
    /// Index of the acquired image of each eye.
    pub images: [usize; 2],
}

impl Session {
    fn wait_until_ready(&mut self) -> Result<()> {
        let mut storage = xr::EventDataBuffer::new();
        for _ in 0..2000 {
            while let Some(event) = self.instance.poll_event(&mut storage)? {
                if let xr::Event::SessionStateChanged(change) = event
                    && change.state() == xr::SessionState::READY
                {
                    self.session.begin(VIEWS)?;
                    return Ok(());
                }
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        bail!("the session does not become ready")
    }

    /// Begins a frame and takes an image for each eye.
    pub fn begin_frame(&mut self) -> Result<Frame> {
        let mut storage = xr::EventDataBuffer::new();
        while self.instance.poll_event(&mut storage)?.is_some() {}
        let state = self.waiter.wait()?;
        self.stream.begin()?;
        let mut images = [0; 2];
        for (eye, image) in self.eyes.iter_mut().zip(&mut images) {
            *image = eye.swapchain.acquire_image()? as usize;
            eye.swapchain.wait_image(xr::Duration::INFINITE)?;
        }
        Ok(Frame { time: state.predicted_display_time, images })
    }

    /// Gives the images back and shows them.
    pub fn end_frame(&mut self, frame: &Frame) -> Result<()> {
        for eye in &mut self.eyes {
            eye.swapchain.release_image()?;
        }
        let (_, views) = self.session.locate_views(VIEWS, frame.time, &self.space)?;
        let extent = xr::Extent2Di { width: self.extent.width as i32, height: self.extent.height as i32 };
        let views: Vec<_> = views
            .iter()
            .zip(&self.eyes)
            .map(|(view, eye)| {
                let image = xr::SwapchainSubImage::new()
                    .swapchain(&eye.swapchain)
                    .image_rect(xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent });
                xr::CompositionLayerProjectionView::new().pose(view.pose).fov(view.fov).sub_image(image)
            })
            .collect();
        let layer = xr::CompositionLayerProjection::new().space(&self.space).views(&views);
        Ok(self.stream.end(frame.time, xr::EnvironmentBlendMode::OPAQUE, &[&layer])?)
    }
}
