//! Properties of swapchain images.

use ash::vk;

/// Properties of a swapchain's images. They have one sample, one mip level and no faces.
#[derive(Clone, Debug)]
pub struct SwapchainShape {
    /// Format of the swapchain; the runtime takes the written texels as this, regardless of the views in use.
    pub format: vk::Format,
    /// Size in pixels.
    pub extent: vk::Extent2D,
    /// Number of array layers, at least 1.
    pub array_layers: u32,
    /// The usage that the application asked for.
    pub usage: vk::ImageUsageFlags,
    /// Whether the application asked for views of other formats (XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT).
    pub mutable: bool,
    /// The formats of views that it named (XrVulkanSwapchainFormatListCreateInfoKHR), if any.
    pub view_formats: Vec<vk::Format>,
}

impl SwapchainShape {
    /// Whether an image of one shape can be copied to one of the other, texel by texel.
    pub(super) fn fits(&self, other: &Self) -> bool {
        self.format == other.format && self.extent == other.extent && self.array_layers == other.array_layers
    }

    /// The formats that the application named, and that of our views; none if it named none. Without MUTABLE_FORMAT no other format than the
    /// image's own (Vulkan specification, VUID-VkImageCreateInfo-flags-04738).
    pub(super) fn listed_view_formats(&self) -> Vec<vk::Format> {
        let mut formats = self.view_formats.clone();
        if !self.mutable {
            formats.retain(|format| *format == self.format);
            return formats;
        }
        if !formats.is_empty() && !formats.contains(&self.format) {
            formats.push(self.format);
        }
        formats
    }
}

/// Formats that hold a picture that we can work on.
pub fn is_color_format(format: vk::Format) -> bool {
    stores_unit_range(format) || format == vk::Format::R16G16B16A16_SFLOAT
}

/// Whether a format stores 0..=1 only: `clamp_to_unit` of [`super::ComposeParams::new`].
pub fn stores_unit_range(format: vk::Format) -> bool {
    encoded_differently(format).is_some() || format == vk::Format::A2B10G10R10_UNORM_PACK32
}

/// UNORM for sRGB, and the reverse.
fn encoded_differently(format: vk::Format) -> Option<vk::Format> {
    match format {
        vk::Format::R8G8B8A8_SRGB => Some(vk::Format::R8G8B8A8_UNORM),
        vk::Format::R8G8B8A8_UNORM => Some(vk::Format::R8G8B8A8_SRGB),
        vk::Format::B8G8R8A8_SRGB => Some(vk::Format::B8G8R8A8_UNORM),
        vk::Format::B8G8R8A8_UNORM => Some(vk::Format::B8G8R8A8_SRGB),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_formats_are_as_listed_and_have_ours() {
        let mut shape = SwapchainShape {
            format: vk::Format::R8G8B8A8_SRGB,
            extent: vk::Extent2D { width: 8, height: 8 },
            array_layers: 1,
            usage: vk::ImageUsageFlags::COLOR_ATTACHMENT,
            mutable: false,
            view_formats: vec![],
        };
        let (srgb, unorm) = (vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM);
        assert_eq!(shape.listed_view_formats(), []);
        shape.view_formats = vec![unorm, srgb];
        assert_eq!(shape.listed_view_formats(), [srgb], "its views have one format");
        shape.view_formats = vec![unorm];
        assert_eq!(shape.listed_view_formats(), []);
        shape = SwapchainShape { mutable: true, view_formats: vec![], ..shape };
        assert_eq!(shape.listed_view_formats(), []);
        shape.view_formats = vec![unorm, srgb];
        assert_eq!(shape.listed_view_formats(), [unorm, srgb]);
        shape.view_formats = vec![unorm, vk::Format::R32_UINT];
        assert_eq!(shape.listed_view_formats(), [unorm, vk::Format::R32_UINT, srgb]);
    }
}
