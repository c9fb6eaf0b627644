//! A swapchain whose images are wgpu textures.

use anyhow::{Context, Result, bail};
use ash::vk::{self, Handle};
use openxr as xr;
use wgpu::hal::{self, api::Vulkan};

use crate::options::ColourFormat;
use crate::renderer::DEPTH_FORMAT;

/// Pose of the quad layer: to the left, over the dark corner.
pub const BOARD_POSE: xr::Posef = xr::Posef {
    // 30 degrees to the right about +y, so that it faces the visitor.
    orientation: xr::Quaternionf { x: 0.0, y: 0.258_819_05, z: 0.0, w: 0.965_925_8 },
    position: xr::Vector3f { x: -1.2, y: 1.9, z: -2.0 },
};
/// Its size in metres.
pub const BOARD_SIZE: xr::Extent2Df = xr::Extent2Df { width: 1.0, height: 0.5 };

/// The formats that the application can draw to, by wgpu's and Vulkan's names.
const FORMATS: [(wgpu::TextureFormat, vk::Format); 6] = [
    (wgpu::TextureFormat::Rgba8UnormSrgb, vk::Format::R8G8B8A8_SRGB),
    (wgpu::TextureFormat::Bgra8UnormSrgb, vk::Format::B8G8R8A8_SRGB),
    (wgpu::TextureFormat::Rgba8Unorm, vk::Format::R8G8B8A8_UNORM),
    (wgpu::TextureFormat::Bgra8Unorm, vk::Format::B8G8R8A8_UNORM),
    (wgpu::TextureFormat::Rgba16Float, vk::Format::R16G16B16A16_SFLOAT),
    (DEPTH_FORMAT, vk::Format::D32_SFLOAT),
];

/// The runtime's favourite among the formats of a kind.
///
/// # Errors
/// If the runtime has none of them.
pub fn choose_format(session: &xr::Session<xr::Vulkan>, wanted: ColourFormat) -> Result<wgpu::TextureFormat> {
    let suits = |format: wgpu::TextureFormat| match wanted {
        ColourFormat::Srgb => format.is_srgb(),
        ColourFormat::Unorm => {
            matches!(format, wgpu::TextureFormat::Rgba8Unorm | wgpu::TextureFormat::Bgra8Unorm)
        }
        ColourFormat::Hdr => format == wgpu::TextureFormat::Rgba16Float,
    };
    let offered = session.enumerate_swapchain_formats()?;
    let named = |raw: &u32| FORMATS.iter().find(|(_, format)| format.as_raw() as u32 == *raw);
    match offered.iter().filter_map(named).find(|(format, _)| suits(*format)) {
        Some((format, _)) => Ok(*format),
        None => bail!("the runtime offers no {wanted:?} swapchain, only the VkFormats {offered:?}"),
    }
}

/// A swapchain and views of its images.
pub struct Swapchain {
    /// One view for each image and array layer. Dropped before the swapchain that owns the images.
    views: Vec<Vec<wgpu::TextureView>>,
    textures: Vec<wgpu::Texture>,
    handle: xr::Swapchain<xr::Vulkan>,
    size: [u32; 2],
    acquired: usize,
}

impl Swapchain {
    /// Makes a swapchain in a format from the list of [`choose_format`], or in [`DEPTH_FORMAT`]; if `is_copied`, its
    /// images can be copied from.
    ///
    /// # Errors
    /// Errors of xrCreateSwapchain.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        layers: u32,
        is_copied: bool,
    ) -> Result<Self> {
        let (_, raw_format) =
            FORMATS.iter().find(|(name, _)| *name == format).context("a format that is not in the list")?;
        let attachment = if format == DEPTH_FORMAT {
            xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT
        } else {
            xr::SwapchainUsageFlags::COLOR_ATTACHMENT
        };
        let copied =
            if is_copied { xr::SwapchainUsageFlags::TRANSFER_SRC } else { xr::SwapchainUsageFlags::EMPTY };
        let handle = session.create_swapchain(&xr::SwapchainCreateInfo {
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: attachment | xr::SwapchainUsageFlags::SAMPLED | copied,
            format: raw_format.as_raw() as u32,
            sample_count: 1,
            width: size[0],
            height: size[1],
            face_count: 1,
            array_size: layers,
            mip_count: 1,
        })?;
        let textures: Vec<_> = handle
            .enumerate_images()?
            .into_iter()
            .map(|image| wrap(device, vk::Image::from_raw(image), format, size, layers, is_copied))
            .collect::<Result<_>>()?;
        let views = textures.iter().map(layer_views).collect();
        Ok(Self { views, textures, handle, size, acquired: 0 })
    }

    /// Takes the next image and waits until it may be drawn to.
    ///
    /// # Errors
    /// Errors of xrAcquireSwapchainImage and xrWaitSwapchainImage.
    pub fn acquire(&mut self) -> Result<()> {
        self.acquired = self.handle.acquire_image()? as usize;
        self.handle.wait_image(xr::Duration::INFINITE)?;
        Ok(())
    }

    /// Gives the image back.
    ///
    /// # Errors
    /// Errors of xrReleaseSwapchainImage.
    pub fn release(&mut self) -> Result<()> {
        Ok(self.handle.release_image()?)
    }

    /// A layer of the acquired image.
    pub fn view(&self, layer: u32) -> &wgpu::TextureView {
        &self.views[self.acquired][layer as usize]
    }

    /// The acquired image.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.textures[self.acquired]
    }

    /// The OpenXR handle.
    pub fn handle(&self) -> &xr::Swapchain<xr::Vulkan> {
        &self.handle
    }

    /// All of the first layer.
    pub fn sub_image(&self) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let extent = xr::Extent2Di { width: self.size[0] as i32, height: self.size[1] as i32 };
        xr::SwapchainSubImage::new()
            .swapchain(&self.handle)
            .image_array_index(0)
            .image_rect(xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent })
    }
}

/// An image as a wgpu texture.
fn wrap(
    device: &wgpu::Device,
    image: vk::Image,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    layers: u32,
    is_copied: bool,
) -> Result<wgpu::Texture> {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
    let state = if format == DEPTH_FORMAT {
        wgpu::TextureUses::DEPTH_STENCIL_WRITE
    } else {
        wgpu::TextureUses::COLOR_TARGET
    };
    let (copy_use, copy_usage) = if is_copied {
        (wgpu::TextureUses::COPY_SRC, wgpu::TextureUsages::COPY_SRC)
    } else {
        (wgpu::TextureUses::empty(), wgpu::TextureUsages::empty())
    };
    let hal_descriptor = hal::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: state | copy_use,
        memory_flags: hal::MemoryFlags::empty(),
        view_formats: Vec::new(),
    };
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | copy_usage,
        view_formats: &[],
    };
    // SAFETY: the guard is dropped before the device.
    let hal_device = unsafe { device.as_hal::<Vulkan>() }.context("the device is not a Vulkan device")?;
    // SAFETY: OpenXR made the image like this and owns it and its memory: the callback that does nothing and
    // `External` specify this. Its swapchain outlives the views.
    let hal_texture = unsafe {
        hal_device.texture_from_raw(
            image,
            &hal_descriptor,
            Some(Box::new(|| {})),
            hal::vulkan::TextureMemory::External,
        )
    };
    // SAFETY: of this device and as described. An acquired image is in the layout of `state`
    // (XR_KHR_vulkan_enable2), and wgpu leaves it there, as a render pass is the last that it is used in.
    Ok(unsafe { device.create_texture_from_hal::<Vulkan>(hal_texture, &descriptor, state) })
}

/// Views of an image's layers.
fn layer_views(texture: &wgpu::Texture) -> Vec<wgpu::TextureView> {
    (0..texture.depth_or_array_layers())
        .map(|layer| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        })
        .collect()
}
