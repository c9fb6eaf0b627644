//! Transfers that recognition may need: an application that streams textures copies thousands of regions in a frame.

use crate::pass_detection::{Event, Transfer};
use crate::vk::objects::Image;
use ash::vk;

/// Least number of pixels of a region that may be a picture: a quarter of one of 362 x 362, which is a third of the sides of small eye buffers.
const LEAST_PIXELS: u64 = 1 << 15;

/// Whether the format of an image is compressed by blocks: it is neither drawn nor shown, and a read of it is never followed.
pub fn never_holds_picture(image: &Image) -> bool {
    let format = image.description.format;
    let is_core = (vk::Format::BC1_RGB_UNORM_BLOCK..=vk::Format::ASTC_12X12_SRGB_BLOCK).contains(&format);
    let is_hdr = (vk::Format::ASTC_4X4_SFLOAT_BLOCK..=vk::Format::ASTC_12X12_SFLOAT_BLOCK).contains(&format);
    is_core || is_hdr
}

/// Whether no command but a transfer writes an image, and no swapchain shows it.
pub fn is_texture(image: &Image) -> bool {
    let written = vk::ImageUsageFlags::COLOR_ATTACHMENT
        | vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT
        | vk::ImageUsageFlags::STORAGE;
    !image.usage.intersects(written) && image.description.swapchain.is_none() && !image.is_foreign
}

/// Adds a transfer to the events of a command buffer, unless recognition learns nothing from it.
///
/// Left out are levels other than 0, which hold no whole picture; small regions between two textures; and further small regions between the images of
/// the last event, which already has the way of the content, while they are too small to place a picture. The same region of the next layers
/// is one event with the last.
pub fn add(events: &mut Vec<Event>, transfer: Transfer, are_textures: bool) {
    let last = match events.last_mut() {
        Some(Event::Transfer(last)) => Some(last),
        Some(Event::Pass(_)) | None => None,
    };
    let are_same = last.as_ref().is_some_and(|last| images(last) == images(&transfer));
    let is_small = pixels(&transfer) < LEAST_PIXELS;
    if (transfer.from.level > 0 && transfer.to.level > 0) || (is_small && (are_textures || are_same)) {
        return;
    }
    if let Some(last) = last
        && continues(last, &transfer)
    {
        last.from.layers += transfer.from.layers;
        last.to.layers += transfer.to.layers;
        return;
    }
    events.push(Event::Transfer(transfer));
}

fn images(transfer: &Transfer) -> [crate::pass_detection::ImageKey; 2] {
    [transfer.from.image, transfer.to.image]
}

/// Pixels that a transfer writes in one layer.
fn pixels(transfer: &Transfer) -> u64 {
    let [_, _, width, height] = transfer.to_rect.map(|side| u64::from(side.unsigned_abs()));
    width * height
}

/// Whether a transfer is the last one for the layers after its layers.
fn continues(last: &Transfer, transfer: &Transfer) -> bool {
    let follows = |layer: u32, layers: u32, next: u32| layer.checked_add(layers) == Some(next);
    let are_next = follows(last.from.base_layer, last.from.layers, transfer.from.base_layer)
        && follows(last.to.base_layer, last.to.layers, transfer.to.base_layer);
    let are_matched = [last, transfer].iter().all(|one| one.from.layers == one.to.layers);
    let has_room = last.to.layers.checked_add(transfer.to.layers).is_some();
    let as_last = Transfer { from: last.from, to: last.to, ..*transfer };
    let levels = |one: &Transfer| [one.from.level, one.to.level];
    images(last) == images(transfer)
        && levels(last) == levels(transfer)
        && are_next
        && are_matched
        && has_room
        && as_last == *last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{ImageDescription, ImageKey, Target, TransferKind};

    const PICTURE: [i32; 4] = [0, 0, 400, 400];
    const PAGE: [i32; 4] = [128, 256, 128, 128];

    fn image(format: vk::Format, usage: vk::ImageUsageFlags) -> Image {
        let description = ImageDescription {
            key: ImageKey(1),
            extent: [4096, 4096],
            layers: 1,
            format,
            samples: 1,
            is_cube: false,
            swapchain: None,
        };
        Image { handle: vk::Image::null(), description, usage, granted: usage, is_foreign: false }
    }

    fn copy([from, to]: [u64; 2], level: u32, layer: u32, rect: [i32; 4]) -> Transfer {
        let target = |image, base_layer| Target { image: ImageKey(image), level, base_layer, layers: 1 };
        let (from, to) = (target(from, layer), target(to, layer + 2));
        Transfer { kind: TransferKind::Copy, from, from_rect: rect, to, to_rect: rect }
    }

    fn logged(transfers: impl IntoIterator<Item = Transfer>, are_textures: bool) -> Vec<Event> {
        let mut events = Vec::new();
        transfers.into_iter().for_each(|transfer| add(&mut events, transfer, are_textures));
        events
    }

    #[test]
    fn compressed_images_hold_no_picture() {
        let sampled = vk::ImageUsageFlags::SAMPLED;
        for format in [
            vk::Format::BC1_RGB_UNORM_BLOCK,
            vk::Format::BC7_SRGB_BLOCK,
            vk::Format::ETC2_R8G8B8_UNORM_BLOCK,
            vk::Format::ASTC_12X12_SRGB_BLOCK,
            vk::Format::ASTC_6X6_SFLOAT_BLOCK,
        ] {
            assert!(never_holds_picture(&image(format, sampled)), "{format:?}");
        }
        for format in [
            vk::Format::R8G8B8A8_SRGB,
            vk::Format::D32_SFLOAT_S8_UINT,
            vk::Format::E5B9G9R9_UFLOAT_PACK32,
            vk::Format::G8B8G8R8_422_UNORM,
        ] {
            assert!(!never_holds_picture(&image(format, sampled)), "{format:?}");
        }
    }

    #[test]
    fn images_of_passes_compute_or_swapchains_are_no_textures() {
        let format = vk::Format::R8G8B8A8_SRGB;
        let only = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        assert!(is_texture(&image(format, only)));
        for usage in [
            vk::ImageUsageFlags::COLOR_ATTACHMENT,
            vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            vk::ImageUsageFlags::STORAGE,
        ] {
            assert!(!is_texture(&image(format, only | usage)), "{usage:?}");
        }
        let shown = crate::pass_detection::SwapchainKey(1);
        let mut image = image(format, only);
        image.description.swapchain = Some(shown);
        assert!(!is_texture(&image));
    }

    /// The levels and pages of ten thousand textures, and the picture between them.
    #[test]
    fn streamed_textures_are_left_out() {
        let pages = || (0..10_000).map(|_| copy([1, 2], 0, 0, PAGE));
        assert!(logged(pages(), true).is_empty());
        let levels = (1..12).map(|level| copy([1, 2], level, 0, [0, 0, 4096 >> level, 4096 >> level]));
        assert!(logged(levels, false).is_empty());
        let picture = copy([3, 4], 0, 0, PICTURE);
        let all = pages().chain([picture]).chain(pages());
        assert_eq!(logged(all, true), [Event::Transfer(picture)]);
    }

    /// Pages of an atlas that passes draw to: the first one has the way of the content.
    #[test]
    fn pages_between_two_images_are_one_event() {
        let page = copy([1, 2], 0, 0, PAGE);
        let other = copy([1, 3], 0, 0, PAGE);
        let picture = copy([1, 2], 0, 0, PICTURE);
        let all = [page, page, picture, page, other, other, page];
        assert_eq!(logged(all, false), [page, picture, other, page].map(Event::Transfer));
    }

    #[test]
    fn layers_one_after_the_other_are_one_event() {
        let whole = |layers| {
            let transfer = copy([1, 2], 0, 0, PICTURE);
            let [from, to] = [transfer.from, transfer.to].map(|target| Target { layers, ..target });
            Event::Transfer(Transfer { from, to, ..transfer })
        };
        let layers = |layers: &[u32]| {
            let copies = layers.iter().map(|layer| copy([1, 2], 0, *layer, PICTURE));
            logged(copies.collect::<Vec<_>>(), false)
        };
        assert_eq!(layers(&[0, 1, 2]), [whole(3)]);
        let apart = copy([1, 2], 0, 2, PICTURE);
        assert_eq!(layers(&[0, 2]), [whole(1), Event::Transfer(apart)]);
        let elsewhere = copy([1, 2], 0, 1, [8, 0, 400, 400]);
        let both = logged([copy([1, 2], 0, 0, PICTURE), elsewhere], false);
        assert_eq!(both, [whole(1), Event::Transfer(elsewhere)]);
    }
}
