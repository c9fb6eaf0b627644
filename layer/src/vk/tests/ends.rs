//! State that goes when a swapchain or a device ends.

use super::*;
use crate::pass_detection::Target;
use crate::vk::candidates::tests::NoMap;
use std::cell::RefCell;

thread_local! {
    static ENDED: RefCell<Vec<(u64, bool)>> = const { RefCell::new(Vec::new()) };
}

/// Notes the device, and whether that is still there.
///
/// # Safety
///
/// As the call.
unsafe extern "C" fn ended(device: vk::Device) {
    let is_there = !fake::calls().iter().any(|call| call.starts_with("vkDestroyDevice"));
    ENDED.with_borrow_mut(|ended| ended.push((device.as_raw(), is_there)));
}

#[test]
fn callbacks_run_before_the_device_is_destroyed() {
    let instance = new_instance(None);
    let [asked, other] = [new_device(instance), new_device(instance)];
    fake::calls();
    // SAFETY: the device is live.
    assert_eq!(unsafe { (link(asked).unwrap().on_device_destroyed)(asked, ended) }, 1);
    destroy_device(other);
    assert!(ENDED.take().is_empty());
    fake::calls();
    destroy_device(asked);
    assert_eq!(ENDED.take(), [(asked.as_raw(), true)]);
    destroy_instance(instance);
}

#[test]
fn images_known_by_their_swapchain_are_forgotten_with_it() {
    let instance = new_instance(None);
    let handle = new_device(instance);
    // SAFETY: the device is live.
    let known = unsafe { device::of(handle) }.unwrap();
    let armed = known.armed.as_ref().unwrap();
    let images = [vk::Image::from_raw(77)];
    let record = crate::link::SwapchainRecord {
        swapchain: 5,
        images: images.as_ptr(),
        image_count: 1,
        extent: [16, 16],
        layers: 1,
        format: vk::Format::R8G8B8A8_SRGB,
        samples: 1,
        usage: vk::ImageUsageFlags::COLOR_ATTACHMENT,
        granted: vk::ImageUsageFlags::COLOR_ATTACHMENT,
        is_virtual: 0,
        is_read: 0,
    };
    armed.notify_swapchain(&record, &images);
    let image = armed.objects.image(images[0]).unwrap().description.key;
    let target = Target { image, level: 0, base_layer: 0, layers: 1 };
    armed.candidates.with_map(target, NoMap);
    assert!(armed.candidates.known(target).is_some());
    assert_eq!(armed.layouts.of(images[0]), None);
    let has_depth = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let read = crate::link::SwapchainRecord { is_read: 1, ..record };
    for (record, layout) in [
        (read, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL),
        (
            crate::link::SwapchainRecord { usage: has_depth, granted: has_depth, ..read },
            vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        ),
    ] {
        armed.notify_swapchain(&record, &images);
        assert_eq!(armed.layouts.of(images[0]), Some(layout));
    }
    armed.notify_swapchain(&record, &[]);
    assert!(armed.candidates.known(target).is_none() && armed.objects.image(images[0]).is_none());
    destroy_device(handle);
    destroy_instance(instance);
}
