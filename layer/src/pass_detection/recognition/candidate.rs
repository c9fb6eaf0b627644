//! Whether a pass looks like one that draws an eye buffer.

use super::Parts;
use super::projected::Swapchains;
use crate::pass_detection::{Eyes, ImageDescription, ImageKey, Orientation, Part, Pass, Unmatched};
use ash::vk;

/// The least side of a pass that may be the scene, in sides of the picture that is shown.
pub(super) const LEAST: f32 = 0.5;
/// The same of a pass whose content is known to become that picture: upscalers render a third per axis in their fastest mode.
pub(super) const LEAST_PROVEN: f32 = 0.3;
/// The greatest.
const MOST: f32 = 2.0;

/// Greatest difference between equal aspects, pixels: sizes are often rounded to a multiple of 8.
const ROUNDING: f32 = 8.0;

/// The parts of a pass that has the aspect of an eye buffer (a single one, two beside each other, an array of two) and
/// is about as large: at least `least` times its sides.
///
/// The vertical orientation is not known from this. The eye is known only with multiview, whose views have OpenXR's order, and for pictures
/// beside each other that are also shown beside each other.
pub(super) fn looks(
    pass: &Pass,
    description: impl Fn(ImageKey) -> Option<ImageDescription>,
    swapchains: &Swapchains,
    least: f32,
) -> Result<Parts, Unmatched> {
    let first = pass.colors.first().ok_or(Unmatched::NoColour)?;
    let mut formats = pass.colors.iter().filter_map(|target| Some(description(target.image)?.format));
    if !formats.clone().any(holds_colours) {
        return Err(formats.next().map_or(Unmatched::UnknownImage, Unmatched::Format));
    }
    let layers = if pass.view_mask == 0 { first.layers } else { u32::BITS - pass.view_mask.leading_zeros() };
    let size = [pass.area[2] as f32, pass.area[3] as f32];
    let part = |eyes, layer, x, width| Part {
        eyes,
        layer,
        rect: [x, 0.0, width, 1.0],
        orientation: Orientation::Unknown,
    };
    match (arrangement(size, swapchains, least)?, layers) {
        (Arrangement::Single, 1) => Ok([part(Eyes::Finer, 0, 0.0, 1.0)].into_iter().collect()),
        (Arrangement::Single, 2) => {
            let is_multiview = pass.view_mask == 0b11;
            let eyes = if is_multiview { [Eyes::Left, Eyes::Right] } else { [Eyes::Finer; 2] };
            Ok(eyes.into_iter().zip(0..).map(|(eyes, layer)| part(eyes, layer, 0.0, 1.0)).collect())
        }
        (Arrangement::DoubleWide, 1) => {
            let eyes = if swapchains.are_beside() { [Eyes::Left, Eyes::Right] } else { [Eyes::Finer; 2] };
            Ok(eyes.into_iter().zip([0.0, 0.5]).map(|(eyes, x)| part(eyes, 0, x, 0.5)).collect())
        }
        _ => Err(Unmatched::Layers(layers)),
    }
}

/// Arrangement of eyes in a render area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arrangement {
    Single,
    /// Two beside each other.
    DoubleWide,
}

/// The arrangement in which pictures as they are shown fit `size`. Of reasons why none does, a fitting aspect counts first.
fn arrangement(size: [f32; 2], swapchains: &Swapchains, least: f32) -> Result<Arrangement, Unmatched> {
    let mut reason = Unmatched::New;
    for (picture, is_filled) in swapchains.pictures() {
        let [_, _, width, height] = picture.rect;
        for (arrangement, width) in [(Arrangement::Single, width), (Arrangement::DoubleWide, width * 2.0)] {
            match fit(size, [width, height], least) {
                Ok(()) if is_filled => return Ok(arrangement),
                Ok(()) => reason = Unmatched::Viewport,
                Err(Unmatched::Aspect) if reason != Unmatched::New => {}
                Err(_) if reason == Unmatched::Viewport => {}
                Err(why) => reason = why,
            }
        }
    }
    Err(reason)
}

/// Whether a render area fits both eyes beside each other, and no eye alone.
pub(super) fn is_double_wide(size: [f32; 2], swapchains: &Swapchains) -> bool {
    arrangement(size, swapchains, LEAST_PROVEN) == Ok(Arrangement::DoubleWide)
}

/// Whether a render area has the aspect of an eye, or of both beside each other, and any size that the scene may have.
pub(super) fn fits(area: [u32; 2], swapchains: &Swapchains) -> bool {
    arrangement(area.map(|side| side as f32), swapchains, LEAST_PROVEN).is_ok()
}

fn fit(size: [f32; 2], picture: [f32; 2], least: f32) -> Result<(), Unmatched> {
    let scale = [size[0] / picture[0], size[1] / picture[1]];
    let same_aspect = (scale[0] / scale[1] - 1.0).abs() * size[0].min(size[1]) <= ROUNDING;
    if !same_aspect {
        return Err(Unmatched::Aspect);
    }
    if (0..2).any(|axis: usize| size[axis] + ROUNDING <= least * picture[axis]) {
        return Err(Unmatched::Small);
    }
    if scale[0] > MOST || scale[1] > MOST { Err(Unmatched::Large) } else { Ok(()) }
}

/// Whether a format has integers of 32 bits or more, as the numbers of triangles have in a visibility buffer. Smaller ones number objects, for outlines.
pub(super) fn holds_identities(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::R32_UINT
            | vk::Format::R32G32_UINT
            | vk::Format::R32G32B32_UINT
            | vk::Format::R32G32B32A32_UINT
            | vk::Format::R64_UINT
    )
}

/// Whether a format has red, green and blue that are not integers. Fewer components hold depths, masks, velocities;
/// integers hold identities.
pub fn holds_colours(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::R5G6B5_UNORM_PACK16
            | vk::Format::B5G6R5_UNORM_PACK16
            | vk::Format::R5G5B5A1_UNORM_PACK16
            | vk::Format::B5G5R5A1_UNORM_PACK16
            | vk::Format::A1R5G5B5_UNORM_PACK16
            | vk::Format::R8G8B8_UNORM
            | vk::Format::R8G8B8_SNORM
            | vk::Format::R8G8B8_SRGB
            | vk::Format::B8G8R8_UNORM
            | vk::Format::B8G8R8_SNORM
            | vk::Format::B8G8R8_SRGB
            | vk::Format::R8G8B8A8_UNORM
            | vk::Format::R8G8B8A8_SNORM
            | vk::Format::R8G8B8A8_SRGB
            | vk::Format::B8G8R8A8_UNORM
            | vk::Format::B8G8R8A8_SNORM
            | vk::Format::B8G8R8A8_SRGB
            | vk::Format::A8B8G8R8_UNORM_PACK32
            | vk::Format::A8B8G8R8_SNORM_PACK32
            | vk::Format::A8B8G8R8_SRGB_PACK32
            | vk::Format::A2R10G10B10_UNORM_PACK32
            | vk::Format::A2R10G10B10_SNORM_PACK32
            | vk::Format::A2B10G10R10_UNORM_PACK32
            | vk::Format::A2B10G10R10_SNORM_PACK32
            | vk::Format::R16G16B16_UNORM
            | vk::Format::R16G16B16_SNORM
            | vk::Format::R16G16B16_SFLOAT
            | vk::Format::R16G16B16A16_UNORM
            | vk::Format::R16G16B16A16_SNORM
            | vk::Format::R16G16B16A16_SFLOAT
            | vk::Format::R32G32B32_SFLOAT
            | vk::Format::R32G32B32A32_SFLOAT
            | vk::Format::B10G11R11_UFLOAT_PACK32
            | vk::Format::E5B9G9R9_UFLOAT_PACK32
    )
}
