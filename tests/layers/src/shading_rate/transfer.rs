//! Transfer commands that write images: a rate image has to be made readable again after them.

use super::barrier::note;
use super::chain::slice;
use super::emulator;
use super::image::Range;
use super::replay::Event;
use ash::vk;

/// # Safety
///
/// The buffer is live.
unsafe fn written(buffer: vk::CommandBuffer, image: vk::Image, ranges: impl Iterator<Item = Range>) {
    // SAFETY: the caller vouches for it.
    let emulator = unsafe { emulator(buffer) };
    let mut state = emulator.state();
    if state.images.get(&image).is_some_and(|image| image.is_rate()) {
        for range in ranges {
            note(&mut state, buffer, Event::Write { image, range });
        }
    }
}

/// # Safety
/// As `vkCmdCopyBufferToImage`.
pub(super) unsafe extern "system" fn copy_buffer_to_image(
    buffer: vk::CommandBuffer,
    from: vk::Buffer,
    to: vk::Image,
    layout: vk::ImageLayout,
    count: u32,
    regions: *const vk::BufferImageCopy,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let ranges = slice(regions, count).iter().map(|region| Range::of_layers(&region.image_subresource));
        written(buffer, to, ranges);
        (emulator(buffer).v1_0().cmd_copy_buffer_to_image)(buffer, from, to, layout, count, regions);
    }
}

/// # Safety
/// As `vkCmdCopyBufferToImage2`.
pub(super) unsafe extern "system" fn copy_buffer_to_image2(
    buffer: vk::CommandBuffer,
    info: *const vk::CopyBufferToImageInfo2<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(next) = emulator(buffer).functions.copy_buffer_to_image2 else { return };
        let regions = slice((*info).p_regions, (*info).region_count);
        let ranges = regions.iter().map(|region| Range::of_layers(&region.image_subresource));
        written(buffer, (*info).dst_image, ranges);
        next(buffer, info);
    }
}

/// # Safety
/// As `vkCmdCopyImage`.
pub(super) unsafe extern "system" fn copy_image(
    buffer: vk::CommandBuffer,
    from: vk::Image,
    from_layout: vk::ImageLayout,
    to: vk::Image,
    to_layout: vk::ImageLayout,
    count: u32,
    regions: *const vk::ImageCopy,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let ranges = slice(regions, count).iter().map(|region| Range::of_layers(&region.dst_subresource));
        written(buffer, to, ranges);
        let next = emulator(buffer).v1_0().cmd_copy_image;
        next(buffer, from, from_layout, to, to_layout, count, regions);
    }
}

/// # Safety
/// As `vkCmdCopyImage2`.
pub(super) unsafe extern "system" fn copy_image2(
    buffer: vk::CommandBuffer,
    info: *const vk::CopyImageInfo2<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(next) = emulator(buffer).functions.copy_image2 else { return };
        let regions = slice((*info).p_regions, (*info).region_count);
        let ranges = regions.iter().map(|region| Range::of_layers(&region.dst_subresource));
        written(buffer, (*info).dst_image, ranges);
        next(buffer, info);
    }
}

/// # Safety
/// As `vkCmdClearColorImage`.
pub(super) unsafe extern "system" fn clear_color_image(
    buffer: vk::CommandBuffer,
    image: vk::Image,
    layout: vk::ImageLayout,
    colour: *const vk::ClearColorValue,
    count: u32,
    ranges: *const vk::ImageSubresourceRange,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(buffer);
        let cleared: Vec<Range> = {
            let state = emulator.state();
            let known = state.images.get(&image);
            let of = |range| known.map(|image| Range::of(range, image));
            slice(ranges, count).iter().filter_map(of).collect()
        };
        written(buffer, image, cleared.into_iter());
        (emulator.v1_0().cmd_clear_color_image)(buffer, image, layout, colour, count, ranges);
    }
}
