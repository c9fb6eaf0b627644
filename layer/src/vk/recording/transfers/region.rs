//! One region of a copy, blit or resolve.

use crate::scene::{ImageDescription, Target};
use ash::vk;

/// Where a region is read and written.
pub struct Ends {
    pub from: End,
    pub to: End,
}

/// One side of a region.
pub struct End {
    subresource: vk::ImageSubresourceLayers,
    /// x, y, width, height.
    pub rect: [i32; 4],
}

impl End {
    fn of_extent(subresource: vk::ImageSubresourceLayers, at: vk::Offset3D, extent: vk::Extent3D) -> Self {
        Self { subresource, rect: [at.x, at.y, extent.width.cast_signed(), extent.height.cast_signed()] }
    }

    fn of_corners(subresource: vk::ImageSubresourceLayers, [from, to]: [vk::Offset3D; 2]) -> Self {
        let rect = [from.x, from.y, to.x.saturating_sub(from.x), to.y.saturating_sub(from.y)];
        Self { subresource, rect }
    }

    /// The level and layers of that image.
    pub fn target(&self, image: &ImageDescription) -> Target {
        let layers = self.subresource;
        let rest = image.layers.saturating_sub(layers.base_array_layer);
        Target {
            image: image.key,
            level: layers.mip_level,
            base_layer: layers.base_array_layer,
            layers: if layers.layer_count == vk::REMAINING_ARRAY_LAYERS { rest } else { layers.layer_count },
        }
    }
}

/// A region of any of Vulkan's structures.
pub trait Region {
    fn ends(&self) -> Ends;
}

macro_rules! regions_with_extent {
    ($($region:ty),*) => {
        $(impl Region for $region {
            fn ends(&self) -> Ends {
                Ends {
                    from: End::of_extent(self.src_subresource, self.src_offset, self.extent),
                    to: End::of_extent(self.dst_subresource, self.dst_offset, self.extent),
                }
            }
        })*
    };
}

macro_rules! regions_with_corners {
    ($($region:ty),*) => {
        $(impl Region for $region {
            fn ends(&self) -> Ends {
                Ends {
                    from: End::of_corners(self.src_subresource, self.src_offsets),
                    to: End::of_corners(self.dst_subresource, self.dst_offsets),
                }
            }
        })*
    };
}

regions_with_extent!(vk::ImageCopy, vk::ImageCopy2<'_>, vk::ImageResolve, vk::ImageResolve2<'_>);
regions_with_corners!(vk::ImageBlit, vk::ImageBlit2<'_>);
