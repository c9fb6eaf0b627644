//! A swapchain and the application's views of its images.

mod targets;

use crate::failure::{Failure, succeeded};
use crate::paint::{Target, Texels};
use crate::session::{Session, SubImage};
use ash::vk;
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_zoo::cases::pattern::{Figure, Rect};
use std::cell::{Cell, RefCell};
use std::collections::{HashMap, VecDeque};
use std::ptr::{from_ref, null};

pub use targets::Targets;

/// Arguments of xrCreateSwapchain.
#[derive(Clone)]
pub struct Shape {
    pub size: [u32; 2],
    pub format: vk::Format,
    /// The format of the application's own views: the swapchain's unless it is MUTABLE_FORMAT.
    pub view_format: vk::Format,
    /// Formats to list with XrVulkanSwapchainFormatListCreateInfoKHR; none without.
    pub listed_formats: Vec<vk::Format>,
    pub usage: xr::SwapchainUsageFlags,
    pub flags: xr::SwapchainCreateFlags,
    pub array_layers: u32,
    pub mip_levels: u32,
}

impl Shape {
    /// A plain colour swapchain, as most applications make it.
    pub fn srgb(size: [u32; 2]) -> Self {
        Self {
            size,
            format: vk::Format::R8G8B8A8_SRGB,
            view_format: vk::Format::R8G8B8A8_SRGB,
            listed_formats: Vec::new(),
            usage: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::SAMPLED,
            flags: xr::SwapchainCreateFlags::EMPTY,
            array_layers: 1,
            mip_levels: 1,
        }
    }

    /// The same in another format.
    pub fn format(self, format: vk::Format) -> Self {
        Self { format, view_format: format, ..self }
    }
}

/// A live swapchain.
pub struct Swapchain<'s> {
    pub session: &'s Session<'s>,
    pub handle: xr::Swapchain,
    pub shape: Shape,
    pub images: Vec<vk::Image>,
    targets: Targets,
    acquired: RefCell<VecDeque<u32>>,
    released: Cell<Option<u32>>,
    /// The last drawn pattern, by image index and array layer (mip level 0).
    figures: RefCell<HashMap<(u32, u32), Vec<Figure>>>,
}

impl<'s> Swapchain<'s> {
    /// Creates a swapchain and views of all its images.
    pub fn create(session: &'s Session<'s>, shape: &Shape) -> Result<Self, Failure> {
        let handle = create(session, shape)?;
        let images = enumerate(session, handle)?;
        session.app.report().image_counts.push(images.len() as u32);
        let targets = Targets::create(&session.app.vulkan.device, shape, &images)?;
        Ok(Self {
            session,
            handle,
            shape: shape.clone(),
            images,
            targets,
            acquired: RefCell::default(),
            released: Cell::new(None),
            figures: RefCell::default(),
        })
    }

    /// xrAcquireSwapchainImage: its result and the index.
    pub fn acquire(&self) -> (xr::Result, u32) {
        let mut index = u32::MAX;
        // SAFETY: the swapchain is live, null stands for no acquire info, the output outlives the call.
        let result =
            unsafe { (self.session.app.xr.functions.acquire_image)(self.handle, null(), &mut index) };
        if result == xr::Result::SUCCESS {
            self.acquired.borrow_mut().push_back(index);
        }
        (result, index)
    }

    /// xrWaitSwapchainImage.
    pub fn wait(&self, timeout: xr::Duration) -> xr::Result {
        let info = xr::SwapchainImageWaitInfo { ty: xr::SwapchainImageWaitInfo::TYPE, next: null(), timeout };
        // SAFETY: the swapchain is live and the structure outlives the call.
        unsafe { (self.session.app.xr.functions.wait_image)(self.handle, &info) }
    }

    /// xrReleaseSwapchainImage.
    pub fn release(&self) -> xr::Result {
        let release = self.session.app.xr.functions.release_image;
        // SAFETY: the swapchain is live and null stands for no release info.
        let result = unsafe { release(self.handle, null()) };
        self.note_release(result);
        result
    }

    /// xrReleaseSwapchainImage, on a thread of its own.
    pub fn release_on_another_thread(&self) -> Result<xr::Result, Failure> {
        let release = self.session.app.xr.functions.release_image;
        let handle = self.handle;
        // SAFETY: as in `release`; this thread waits, so that access stays externally synchronised.
        let result = std::thread::spawn(move || unsafe { release(handle, null()) })
            .join()
            .map_err(|_| Failure::Unsupported("the releasing thread panicked".to_owned()))?;
        self.note_release(result);
        Ok(result)
    }

    /// Acquires an image and waits for it; its index.
    pub fn next_image(&self) -> Result<u32, Failure> {
        let (result, index) = self.acquire();
        succeeded("xrAcquireSwapchainImage", result)?;
        succeeded("xrWaitSwapchainImage", self.wait(xr::Duration::INFINITE))?;
        Ok(index)
    }

    /// A whole turn: acquire, wait, draw into array layer 0, release.
    pub fn paint(&self, figures: &[Figure]) -> Result<(), Failure> {
        self.paint_layers(&[figures])
    }

    /// A whole turn, with figures for each array layer.
    pub fn paint_layers(&self, layers: &[&[Figure]]) -> Result<(), Failure> {
        let index = self.next_image()?;
        for (layer, figures) in layers.iter().enumerate() {
            self.draw(index, layer as u32, 0, figures)?;
        }
        succeeded("xrReleaseSwapchainImage", self.release()).map(drop)
    }

    /// Draws into one array layer and mip level of an image that was waited for.
    pub fn draw(
        &self,
        index: u32,
        array_layer: u32,
        mip_level: u32,
        figures: &[Figure],
    ) -> Result<(), Failure> {
        let target = self.target(index, array_layer, mip_level);
        let mut painter = self.session.app.painter.borrow_mut();
        painter.draw(&[(target, figures.to_vec())])?;
        if mip_level == 0 {
            let key = (index, array_layer);
            self.figures.borrow_mut().insert(key, figures.to_vec());
        }
        Ok(())
    }

    /// A rectangle of array layer 0, as it was released last.
    pub fn sub_image(&self, rect: Rect) -> SubImage {
        self.layer_sub_image(rect, 0)
    }

    /// A rectangle of an array layer, as it was released last.
    pub fn layer_sub_image(&self, rect: Rect, array_layer: u32) -> SubImage {
        let figures = self.figures.borrow();
        let figure = self
            .released
            .get()
            .and_then(|index| figures.get(&(index, array_layer)))
            .and_then(|figures| figures.iter().find(|figure| figure.rect == rect));
        SubImage { swapchain: self.handle, rect, array_layer, figure: figure.copied() }
    }

    /// The rectangle of the whole image.
    pub fn whole(&self) -> Rect {
        let [width, height] = self.shape.size;
        Rect::new(0, 0, width, height)
    }

    fn note_release(&self, result: xr::Result) {
        if result == xr::Result::SUCCESS {
            self.released.set(self.acquired.borrow_mut().pop_front());
        }
    }

    fn target(&self, index: u32, array_layer: u32, mip_level: u32) -> Target {
        let [width, height] = self.shape.size;
        Target {
            render_pass: self.targets.render_pass,
            framebuffer: self.targets.framebuffers[&(index, array_layer, mip_level)],
            extent: vk::Extent2D { width: (width >> mip_level).max(1), height: (height >> mip_level).max(1) },
            texels: texels(self.shape.view_format),
        }
    }
}

impl Drop for Swapchain<'_> {
    fn drop(&mut self) {
        let app = self.session.app;
        app.vulkan.wait_idle();
        self.targets.destroy(&app.vulkan.device);
        // SAFETY: the swapchain is live, and the work that refers to it is complete.
        unsafe { (app.xr.functions.destroy_swapchain)(self.handle) };
    }
}

/// Encoding of colours in a format.
pub fn texels(format: vk::Format) -> Texels {
    match format {
        vk::Format::D16_UNORM | vk::Format::D32_SFLOAT => Texels::Depth,
        vk::Format::R8G8B8A8_SRGB | vk::Format::B8G8R8A8_SRGB => Texels::Srgb,
        _ => Texels::Unorm,
    }
}

fn create(session: &Session, shape: &Shape) -> Result<xr::Swapchain, Failure> {
    let formats: Vec<u32> = shape.listed_formats.iter().map(|format| format.as_raw() as u32).collect();
    let list = xr::VulkanSwapchainFormatListCreateInfoKHR {
        ty: xr::VulkanSwapchainFormatListCreateInfoKHR::TYPE,
        next: null(),
        view_format_count: formats.len() as u32,
        view_formats: formats.as_ptr(),
    };
    let info = xr::SwapchainCreateInfo {
        ty: xr::SwapchainCreateInfo::TYPE,
        next: if formats.is_empty() { null() } else { from_ref(&list).cast() },
        create_flags: shape.flags,
        usage_flags: shape.usage,
        format: i64::from(shape.format.as_raw()),
        sample_count: 1,
        width: shape.size[0],
        height: shape.size[1],
        face_count: 1,
        array_size: shape.array_layers,
        mip_count: shape.mip_levels,
    };
    let mut handle = xr::Swapchain::NULL;
    // SAFETY: the session is live; the structures outlive the call.
    let result = unsafe { (session.app.xr.functions.create_swapchain)(session.handle, &info, &mut handle) };
    succeeded("xrCreateSwapchain", result)?;
    Ok(handle)
}

fn enumerate(session: &Session, handle: xr::Swapchain) -> Result<Vec<vk::Image>, Failure> {
    const CALL: &str = "xrEnumerateSwapchainImages";
    let capacity = match session.app.image_capacity {
        Some(capacity) => capacity,
        None => {
            let (result, count, _) = enumerate_into(session, handle, 0);
            succeeded(CALL, result)?;
            count
        }
    };
    let (result, count, mut images) = enumerate_into(session, handle, capacity);
    succeeded(CALL, result)?;
    images.truncate(count as usize);
    Ok(images)
}

/// One xrEnumerateSwapchainImages with an array of `capacity` (null if that is 0): its result, the count, and the array afterwards.
pub fn enumerate_into(
    session: &Session,
    handle: xr::Swapchain,
    capacity: u32,
) -> (xr::Result, u32, Vec<vk::Image>) {
    use ash::vk::Handle as _;
    let mut images = vec![session.app.blank_image; capacity as usize];
    let array = if capacity == 0 { std::ptr::null_mut() } else { images.as_mut_ptr() };
    let mut count = 0;
    // SAFETY: the array has the capacity that is passed, and outlives the call.
    let result =
        unsafe { (session.app.xr.functions.enumerate_images)(handle, capacity, &mut count, array.cast()) };
    let images = images.into_iter().map(|image| vk::Image::from_raw(image.image)).collect();
    (result, count, images)
}
