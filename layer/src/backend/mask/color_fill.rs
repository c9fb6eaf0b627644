//! Fills of colour: interpolated where it is light, and of the nearest texel where an interpolated value would mean nothing, as that of
//! motion or of an index.

use crate::backend::mask::MaskKernels;
use crate::gpu::{AppCommands, Gpu, GpuError, ImagePart};
use crate::kernels::fill::{FillFormat, FillTarget, SkipBuffer, fill_format};
use crate::kernels::nearest::NearestCopy;
use ash::vk;
use parafovea_core::kernels::nearest::NearestParams;
use std::sync::Arc;

/// Kind of the fill of a colour image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillKind {
    /// Interpolated.
    Interpolated(FillFormat),
    /// Copied from the nearest texel, with this size in bytes.
    Nearest(u32),
}

impl FillKind {
    /// Kind for images of this format and samples; `None` for images that are not filled: several samples are resolved to their mean before a
    /// fill, and a mean of motion or of indices means nothing.
    pub fn of(format: vk::Format, samples: vk::SampleCountFlags) -> Option<Self> {
        if let Some((kind, _)) = fill_format(format) {
            return Some(Self::Interpolated(kind));
        }
        let size = nearest_format(format)?;
        (samples == vk::SampleCountFlags::TYPE_1).then_some(Self::Nearest(size))
    }
}

/// Bytes of a texel of a format that is not interpolated; `None` for formats that no device draws to.
fn nearest_format(format: vk::Format) -> Option<u32> {
    use vk::Format as F;
    Some(match format {
        F::R8_UNORM | F::R8_SNORM | F::R8_SRGB => 1,
        F::R8_UINT | F::R8_SINT => 1,
        F::R8G8_UNORM | F::R8G8_SNORM | F::R8G8_SRGB => 2,
        F::R16_UNORM | F::R16_SNORM | F::R16_SFLOAT => 2,
        F::R5G6B5_UNORM_PACK16 | F::R5G5B5A1_UNORM_PACK16 | F::A1R5G5B5_UNORM_PACK16 => 2,
        F::R8G8_UINT | F::R8G8_SINT | F::R16_UINT | F::R16_SINT => 2,
        F::R8G8B8A8_SNORM | F::A8B8G8R8_SNORM_PACK32 | F::E5B9G9R9_UFLOAT_PACK32 => 4,
        F::R16G16_UNORM | F::R16G16_SNORM | F::R16G16_SFLOAT | F::R32_SFLOAT => 4,
        F::R8G8B8A8_UINT | F::R8G8B8A8_SINT | F::A8B8G8R8_UINT_PACK32 | F::A8B8G8R8_SINT_PACK32 => 4,
        F::A2B10G10R10_UINT_PACK32 | F::A2R10G10B10_UINT_PACK32 => 4,
        F::R16G16_UINT | F::R16G16_SINT | F::R32_UINT | F::R32_SINT => 4,
        F::R16G16B16A16_UNORM | F::R16G16B16A16_SNORM | F::R32G32_SFLOAT => 8,
        F::R16G16B16A16_UINT | F::R16G16B16A16_SINT | F::R32G32_UINT | F::R32G32_SINT => 8,
        F::R32G32B32A32_SFLOAT => 16,
        F::R32G32B32A32_UINT | F::R32G32B32A32_SINT => 16,
        _ => return None,
    })
}

/// The copy in which pictures of one size and kind are filled, by one list.
pub struct ColorFill {
    copy: Copied,
    extent: vk::Extent2D,
}

enum Copied {
    Interpolated(FillTarget),
    Nearest(NearestCopy),
}

impl ColorFill {
    /// Prepares to fill pictures of `extent` pixels and `layers` array layers, which are drawn to in `format`, by a list; that and the
    /// kernels outlive the result.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] for formats and sizes that cannot be filled; a failed call.
    pub fn new(
        gpu: &Arc<Gpu>,
        kernels: &MaskKernels,
        format: vk::Format,
        (extent, layers): ([u32; 2], u32),
        list: &SkipBuffer,
    ) -> Result<Self, GpuError> {
        let copy = match FillKind::of(format, vk::SampleCountFlags::TYPE_1) {
            Some(FillKind::Nearest(size)) => {
                let params = NearestParams::of_texels(extent, size)
                    .ok_or(GpuError::Unsupported("filling images of this size"))?;
                let size = (extent[1], layers);
                Copied::Nearest(NearestCopy::new(gpu, &kernels.nearest, params, size, list)?)
            }
            _ => Copied::Interpolated(kernels.fill.target(format, extent, layers, list)?),
        };
        let [width, height] = extent;
        Ok(Self { copy, extent: vk::Extent2D { width, height } })
    }

    /// Kind of the fill.
    pub fn kind(&self) -> FillKind {
        match &self.copy {
            Copied::Interpolated(target) => FillKind::Interpolated(target.format()),
            Copied::Nearest(copy) => FillKind::Nearest(copy.texel_size()),
        }
    }

    /// Records the fill of `picture`, whose first layer is the list's layer 0, with kernels and list of [`Self::new`]. The picture was drawn
    /// by commands recorded before, and is in `layout` before and after.
    pub fn record(
        &self,
        commands: &AppCommands,
        (kernels, list): (&MaskKernels, &SkipBuffer),
        picture: ImagePart,
        layout: vk::ImageLayout,
    ) {
        match &self.copy {
            Copied::Interpolated(target) => kernels.fill.record(commands, target, list, picture, layout),
            Copied::Nearest(copy) => {
                let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: self.extent };
                copy.fill(commands, (&kernels.nearest, list), (picture, area), layout);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_1;

    #[test]
    fn light_is_interpolated_and_the_rest_is_copied() {
        let of = |format| FillKind::of(format, ONE);
        assert_eq!(of(vk::Format::B8G8R8A8_SRGB), Some(FillKind::Interpolated(FillFormat::Srgb8)));
        assert_eq!(of(vk::Format::R16G16_SFLOAT), Some(FillKind::Nearest(4)));
        assert_eq!(of(vk::Format::R8_UNORM), Some(FillKind::Nearest(1)));
        assert_eq!(of(vk::Format::R8G8_UNORM), Some(FillKind::Nearest(2)));
        assert_eq!(of(vk::Format::R32G32_UINT), Some(FillKind::Nearest(8)));
        assert_eq!(of(vk::Format::R32G32B32A32_SFLOAT), Some(FillKind::Nearest(16)));
        for format in [vk::Format::R8G8B8_UNORM, vk::Format::D32_SFLOAT, vk::Format::UNDEFINED] {
            assert_eq!(of(format), None);
        }
    }

    #[test]
    fn only_light_of_several_samples_is_filled() {
        let of = |format| FillKind::of(format, vk::SampleCountFlags::TYPE_4);
        assert_eq!(of(vk::Format::R32_UINT), None);
        assert_eq!(of(vk::Format::R16G16_SFLOAT), None);
        assert_eq!(of(vk::Format::B8G8R8A8_SRGB), Some(FillKind::Interpolated(FillFormat::Srgb8)));
    }

    /// As in the names: bits of all components.
    #[test]
    fn sizes_of_texels_are_those_of_their_components() {
        let all = (0..200).map(vk::Format::from_raw);
        for (format, size) in all.filter_map(|f| Some((f, nearest_format(f)?))) {
            let name = format!("{format:?}");
            let bits: u32 = match name.split_once("_PACK") {
                Some((_, bits)) => bits.parse().unwrap(),
                None => name
                    .split('_')
                    .next()
                    .unwrap()
                    .split(|c: char| c.is_ascii_alphabetic())
                    .filter_map(|bits| bits.parse::<u32>().ok())
                    .sum(),
            };
            assert_eq!(size * 8, bits, "{name}");
        }
    }
}
