//! Swapchains and their images.

use super::{Swapchain, World};
use ash::vk;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{null, null_mut};

/// Images that may be acquired at a time: as many as the runtime has.
const IMAGES: usize = 3;

impl World<'_> {
    pub(super) fn create_swapchain(&mut self) {
        const COLORS: [vk::Format; 3] =
            [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM, vk::Format::R16G16B16A16_SFLOAT];
        let Some(at) = self.session() else { return };
        if self.swapchains.len() >= 4 {
            return;
        }
        let session = self.handle(self.sessions[at].handle);
        let is_color = !self.numbers.once_in(6);
        let is_static = self.numbers.once_in(8);
        let size = [16 + 8 * self.numbers.below(4) as u32, 16 + 8 * self.numbers.below(4) as u32];
        let format = if is_color { COLORS[self.numbers.below(3)] } else { vk::Format::D32_SFLOAT };
        let is_odd = self.is_hostile() && self.numbers.once_in(5);
        let attachment = if is_color {
            xr::SwapchainUsageFlags::COLOR_ATTACHMENT
        } else {
            xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT
        };
        let (_chain, next) = self.chain();
        let info = xr::SwapchainCreateInfo {
            ty: xr::SwapchainCreateInfo::TYPE,
            next,
            create_flags: if is_static {
                xr::SwapchainCreateFlags::STATIC_IMAGE
            } else {
                xr::SwapchainCreateFlags::EMPTY
            },
            usage_flags: attachment | xr::SwapchainUsageFlags::SAMPLED,
            format: if is_odd { -7 } else { i64::from(format.as_raw()) },
            sample_count: if is_odd && self.numbers.once_in(2) { 3 } else { 1 },
            width: if is_odd && self.numbers.once_in(2) { 0 } else { size[0] },
            height: size[1],
            face_count: 1,
            array_size: if self.numbers.once_in(4) { 2 } else { 1 },
            mip_count: if self.numbers.once_in(8) { 2 } else { 1 },
        };
        let mut handle = xr::Swapchain::NULL;
        // SAFETY: the structures outlive the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.create_swapchain)(session, &info, &mut handle) };
        if self.told("xrCreateSwapchain", result) {
            self.swapchains.push(Swapchain {
                handle,
                session,
                size,
                is_color,
                acquired: 0,
                is_waited: false,
                is_released: false,
                is_static,
            });
        }
    }

    pub(super) fn destroy_swapchain(&mut self) {
        if !self.numbers.once_in(3) {
            return;
        }
        let Some(at) = self.swapchain() else { return };
        self.app.vulkan.wait_idle();
        let handle = self.handle(self.swapchains[at].handle);
        // SAFETY: nothing of ours uses its images; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.destroy_swapchain)(handle) };
        self.told("xrDestroySwapchain", result);
        self.gone.push(handle.into_raw());
        self.swapchains.retain(|swapchain| swapchain.handle != handle);
    }

    pub(super) fn enumerate_images(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let handle = self.handle(self.swapchains[at].handle);
        let capacity = if self.dares() { self.numbers.below(5) } else { [0, 8][self.numbers.below(2)] };
        let empty =
            xr::SwapchainImageVulkanKHR { ty: xr::SwapchainImageVulkanKHR::TYPE, next: null_mut(), image: 0 };
        let mut images = vec![empty; capacity];
        let mut count = 77;
        let first = if capacity == 0 { null_mut() } else { images.as_mut_ptr().cast() };
        let enumerate = self.app.xr.functions.enumerate_images;
        // SAFETY: there is room for as many images as is said; a handle may be invalid on purpose.
        let result = unsafe { enumerate(handle, capacity as u32, &mut count, first) };
        let filled = images.iter().filter(|image| image.image != 0).count();
        self.told(&format!("xrEnumerateSwapchainImages {capacity} {count} {filled}"), result);
    }

    pub(super) fn acquire(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let Swapchain { acquired, is_static, is_released, .. } = self.swapchains[at];
        let most = if is_static { usize::from(!is_released) } else { IMAGES };
        if acquired >= most && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        let mut index = 77;
        // SAFETY: null stands for no info, the output outlives the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.acquire_image)(handle, null(), &mut index) };
        if self.told("xrAcquireSwapchainImage", result) {
            self.trace.push(format!("image {index}"));
            self.swapchains[at].acquired += 1;
        }
    }

    pub(super) fn wait_image(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let is_legal = self.swapchains[at].acquired > 0 && !self.swapchains[at].is_waited;
        if !is_legal && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        let (_chain, next) = self.chain();
        let info = xr::SwapchainImageWaitInfo {
            ty: xr::SwapchainImageWaitInfo::TYPE,
            next,
            timeout: xr::Duration::INFINITE,
        };
        // SAFETY: the structures outlive the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.wait_image)(handle, &info) };
        if self.told("xrWaitSwapchainImage", result) {
            self.swapchains[at].is_waited = true;
        }
    }

    pub(super) fn release(&mut self) {
        let Some(at) = self.swapchain() else { return };
        if !self.swapchains[at].is_waited && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        // SAFETY: null stands for no info; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.release_image)(handle, null()) };
        if self.told("xrReleaseSwapchainImage", result) {
            let swapchain = &mut self.swapchains[at];
            (swapchain.is_waited, swapchain.is_released) = (false, true);
            swapchain.acquired = swapchain.acquired.saturating_sub(1);
        }
    }
}
