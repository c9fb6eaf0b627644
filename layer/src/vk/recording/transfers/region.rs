//! One region of a copy, blit or resolve.

use crate::pass_detection::{ImageDescription, Target};
use ash::vk;

/// Source and destination of a region.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::ImageKey;

    const IMAGE: ImageDescription = ImageDescription {
        key: ImageKey(7),
        extent: [64, 64],
        layers: 6,
        format: vk::Format::R8G8B8A8_SRGB,
        samples: 1,
        is_cube: false,
        swapchain: None,
    };

    fn layers(level: u32, base: u32, count: u32) -> vk::ImageSubresourceLayers {
        vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            mip_level: level,
            base_array_layer: base,
            layer_count: count,
        }
    }

    #[test]
    fn a_copy_reads_and_writes_rectangles_of_one_size() {
        let copy = vk::ImageCopy::default()
            .src_subresource(layers(1, 0, 1))
            .src_offset(vk::Offset3D { x: 3, y: 4, z: 0 })
            .dst_subresource(layers(0, 2, vk::REMAINING_ARRAY_LAYERS))
            .dst_offset(vk::Offset3D { x: 5, y: 6, z: 0 })
            .extent(vk::Extent3D { width: 10, height: 20, depth: 1 });
        let ends = copy.ends();
        assert_eq!((ends.from.rect, ends.to.rect), ([3, 4, 10, 20], [5, 6, 10, 20]));
        let target = |level, base_layer, layers| Target { image: ImageKey(7), level, base_layer, layers };
        assert_eq!(ends.from.target(&IMAGE), target(1, 0, 1));
        assert_eq!(ends.to.target(&IMAGE), target(0, 2, 4));
    }

    #[test]
    fn a_mirrored_blit_has_a_negative_extent() {
        let corner = |x, y| vk::Offset3D { x, y, z: 0 };
        let blit = vk::ImageBlit2::default()
            .src_subresource(layers(0, 0, 1))
            .src_offsets([corner(0, 64), corner(32, 0)])
            .dst_subresource(layers(0, 1, 1))
            .dst_offsets([corner(8, 8), corner(24, 40)]);
        let ends = blit.ends();
        assert_eq!((ends.from.rect, ends.to.rect), ([0, 64, 32, -64], [8, 8, 16, 32]));
    }
}
