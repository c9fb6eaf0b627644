//! Swapchains that may be substituted, and the shape of their images.

use super::super::structures::extending;
use crate::abi::pnext::{MAX_LENGTH, Structure};
use crate::kernels::compose::{DEPTH_USAGE, RUNTIME_USAGE, SwapchainShape};
use crate::kernels::{analyze, fill};
use ash::vk;
use openxr_sys as xr;
use std::fmt;

/// Reason why a swapchain is left as the application asked for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotSubstituted {
    /// Nothing in the configuration gives `compose` work.
    NoWork,
    /// A flag such as static image or protected content.
    CreateFlags(xr::SwapchainCreateFlags),
    /// More than one sample, mip level or face.
    Kind {
        /// `sampleCount`.
        samples: u32,
        /// `mipCount`.
        mips: u32,
        /// `faceCount`.
        faces: u32,
    },
    /// Width and height, pixels, unlike those of eye buffers.
    Size([u32; 2]),
    /// A depth format, or one that `compose` cannot read and draw.
    Format(vk::Format),
    /// An extending structure that this layer does not know.
    Chain(xr::StructureType),
    /// The runtime did not grant the usage that our copy needs.
    Usage(xr::Result),
}

impl fmt::Display for NotSubstituted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoWork => f.write_str("nothing to do"),
            Self::CreateFlags(flags) => write!(f, "create flags {flags:?}"),
            Self::Kind { samples, mips, faces } => {
                write!(f, "{samples} samples, {mips} mip levels, {faces} faces")
            }
            Self::Size([width, height]) => {
                write!(f, "{width}x{height} pixels is not the size of an eye buffer")
            }
            Self::Format(format) => write!(f, "format {format:?}"),
            Self::Chain(structure) => write!(f, "unknown structure {structure:?}"),
            Self::Usage(result) => write!(f, "the runtime refused additional usage flags: {result:?}"),
        }
    }
}

/// The shape of the images of a swapchain, if it may be substituted. `supports` returns whether `compose` works with a format.
///
/// # Safety
///
/// `info` is valid, and its chain is.
pub unsafe fn shape(
    info: &xr::SwapchainCreateInfo,
    supports: impl Fn(vk::Format) -> bool,
) -> Result<SwapchainShape, NotSubstituted> {
    if !info.create_flags.is_empty() {
        return Err(NotSubstituted::CreateFlags(info.create_flags));
    }
    let (samples, mips, faces) = (info.sample_count, info.mip_count, info.face_count);
    if (samples, mips, faces) != (1, 1, 1) {
        return Err(NotSubstituted::Kind { samples, mips, faces });
    }
    let format = i32::try_from(info.format).map_or(vk::Format::UNDEFINED, vk::Format::from_raw);
    if !supports(format) || info.usage_flags.contains(xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT) {
        return Err(NotSubstituted::Format(format));
    }
    // SAFETY: the chain is valid, as `# Safety` demands.
    let view_formats = unsafe { view_formats(info) }?;
    Ok(SwapchainShape {
        format,
        extent: vk::Extent2D { width: info.width, height: info.height },
        array_layers: info.array_size,
        usage: vulkan_usage(info.usage_flags),
        mutable: info.usage_flags.contains(xr::SwapchainUsageFlags::MUTABLE_FORMAT),
        view_formats,
    })
}

/// Whether the layer knows all structures in the chain.
///
/// # Safety
///
/// `info` is valid, and its chain is.
pub unsafe fn is_plain(info: &xr::SwapchainCreateInfo) -> bool {
    // SAFETY: as `# Safety` demands.
    unsafe { view_formats(info) }.is_ok()
}

/// The formats of views that the application names in the chain, which may hold nothing else.
///
/// # Safety
///
/// `info` is valid, and its chain is.
unsafe fn view_formats(info: &xr::SwapchainCreateInfo) -> Result<Vec<vk::Format>, NotSubstituted> {
    type FormatList = xr::VulkanSwapchainFormatListCreateInfoKHR;
    // SAFETY: the chain is valid, as `# Safety` demands.
    let chain = || unsafe { extending(info.next) };
    let unknown = chain().find_map(|header| (header.ty != FormatList::number()).then_some(header.ty));
    if let Some(ty) = unknown.or((chain().count() == MAX_LENGTH).then_some(0)) {
        return Err(NotSubstituted::Chain(xr::StructureType::from_raw(ty)));
    }
    let Some(list) = chain().find::<FormatList>().filter(|list| !list.view_formats.is_null()) else {
        return Ok(Vec::new());
    };
    // SAFETY: the structure's valid usage: an array of that many formats.
    let formats = unsafe { std::slice::from_raw_parts(list.view_formats, list.view_format_count as usize) };
    Ok(formats.iter().map(|&format| vk::Format::from_raw(format as i32)).collect())
}

const USAGES: [(xr::SwapchainUsageFlags, vk::ImageUsageFlags); 7] = [
    (xr::SwapchainUsageFlags::COLOR_ATTACHMENT, vk::ImageUsageFlags::COLOR_ATTACHMENT),
    (xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT),
    (xr::SwapchainUsageFlags::UNORDERED_ACCESS, vk::ImageUsageFlags::STORAGE),
    (xr::SwapchainUsageFlags::TRANSFER_SRC, vk::ImageUsageFlags::TRANSFER_SRC),
    (xr::SwapchainUsageFlags::TRANSFER_DST, vk::ImageUsageFlags::TRANSFER_DST),
    (xr::SwapchainUsageFlags::SAMPLED, vk::ImageUsageFlags::SAMPLED),
    (xr::SwapchainUsageFlags::INPUT_ATTACHMENT, vk::ImageUsageFlags::INPUT_ATTACHMENT),
];

/// Usage in Vulkan's terms ("XR_KHR_vulkan_enable", table of usage flags).
pub fn vulkan_usage(usage: xr::SwapchainUsageFlags) -> vk::ImageUsageFlags {
    let pairs = USAGES.into_iter().filter(|(openxr, _)| usage.contains(*openxr));
    pairs.fold(vk::ImageUsageFlags::empty(), |all, (_, vulkan)| all | vulkan)
}

/// The usage of the runtime's swapchain: the application's, that of our copy, and, where its pictures are `analyzed`, that of the analysis.
pub fn runtime_usage(asked: xr::SwapchainUsageFlags, analyzed: bool) -> xr::SwapchainUsageFlags {
    let more = if analyzed { analyze::USAGE } else { vk::ImageUsageFlags::empty() };
    with(asked, RUNTIME_USAGE | more)
}

/// As [`runtime_usage`], where the depth that the application draws to the runtime's images is copied.
pub fn kept_depth_usage(asked: xr::SwapchainUsageFlags) -> xr::SwapchainUsageFlags {
    with(asked, DEPTH_USAGE)
}

/// As [`runtime_usage`], where the pictures in the runtime's images are analysed as the application draws them.
pub fn analyzed_usage(asked: xr::SwapchainUsageFlags) -> xr::SwapchainUsageFlags {
    with(asked, analyze::RELEASED_USAGE)
}

/// As [`runtime_usage`], where passes that draw to the runtime's images may have masks.
pub fn filled_usage(asked: xr::SwapchainUsageFlags) -> xr::SwapchainUsageFlags {
    with(asked, fill::USAGE)
}

fn with(asked: xr::SwapchainUsageFlags, more: vk::ImageUsageFlags) -> xr::SwapchainUsageFlags {
    let pairs = USAGES.into_iter().filter(|(_, vulkan)| more.contains(*vulkan));
    pairs.fold(asked, |all, (openxr, _)| all | openxr)
}

#[cfg(test)]
mod tests;
