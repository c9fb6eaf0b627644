//! Programs of the started processes. They are ignored tests, so that `cargo test` by itself leaves them out.

pub mod rates;
pub mod triangle;

use crate::device::{Asks, Device, whole};
use ash::vk;
use parafovea::link::{DeviceRecord, GET_LINK_NAME, GetLink};
use std::mem::MaybeUninit;
use triangle::{Drawing, draw};

#[test]
#[ignore = "started by other tests"]
fn triangle_with_own_query() {
    let invocations = draw(Drawing { own_query: true, ..Drawing::default() });
    println!("result {}", invocations.unwrap());
}

#[test]
#[ignore = "started by other tests"]
fn triangle_once() {
    draw(Drawing::default());
}

#[test]
#[ignore = "started by other tests"]
fn triangle_thrice_with_chained_features() {
    draw(Drawing { asks: Asks::Chained, submits: 3, ..Drawing::default() });
}

#[test]
#[ignore = "started by other tests"]
fn half_a_triangle() {
    draw(Drawing { hidden: true, submits: 2, ..Drawing::default() });
}

#[test]
#[ignore = "started by other tests"]
fn half_a_triangle_with_own_query() {
    let invocations = draw(Drawing { hidden: true, own_query: true, ..Drawing::default() });
    println!("result {}", invocations.unwrap());
}

#[test]
#[ignore = "started by other tests"]
fn triangle_with_own_occlusion_query() {
    draw(Drawing { own_occlusion: true, ..Drawing::default() });
}

/// One write and one read of a buffer, each in a submit of its own, with nothing that orders them.
#[test]
#[ignore = "started by other tests"]
fn hazard_across_submits() {
    let device = Device::new(vk::API_VERSION_1_0, Default::default(), Asks::Directly);
    let (from, from_memory) = device.buffer();
    let (to, to_memory) = device.buffer();
    // SAFETY: plain use of Vulkan, but for the missing barrier, which is the point.
    unsafe {
        let fill = device.record(|buffer| device.device.cmd_fill_buffer(buffer, from, 0, 1024, 7));
        let region = [vk::BufferCopy::default().size(1024)];
        let copy = device.record(|buffer| device.device.cmd_copy_buffer(buffer, from, to, &region));
        device.submit(&[fill], false);
        device.submit(&[copy], false);
        device.wait();
        for (buffer, memory) in [(from, from_memory), (to, to_memory)] {
            device.device.destroy_buffer(buffer, None);
            device.device.free_memory(memory, None);
        }
    }
}

/// A clear, and a second one, each behind a barrier: the first by vkCmdPipelineBarrier, the second by
/// vkCmdPipelineBarrier2.
#[test]
#[ignore = "started by other tests"]
fn two_clears_with_barriers() {
    let device = Device::new(vk::API_VERSION_1_3, Default::default(), Asks::Chained);
    let (image, memory) = device.image();
    let (undefined, dst, general) =
        (vk::ImageLayout::UNDEFINED, vk::ImageLayout::TRANSFER_DST_OPTIMAL, vk::ImageLayout::GENERAL);
    // SAFETY: plain use of Vulkan.
    unsafe {
        let vk = &device.device;
        let colour = vk::ClearColorValue::default();
        let commands = device.record(|buffer| {
            let first = vk::ImageMemoryBarrier::default()
                .old_layout(undefined)
                .new_layout(dst)
                .dst_access_mask(vk::AccessFlags::TRANSFER_WRITE)
                .image(image)
                .subresource_range(whole());
            let (top, transfer) = (vk::PipelineStageFlags::TOP_OF_PIPE, vk::PipelineStageFlags::TRANSFER);
            vk.cmd_pipeline_barrier(buffer, top, transfer, Default::default(), &[], &[], &[first]);
            vk.cmd_clear_color_image(buffer, image, dst, &colour, &[whole()]);
            let second = [vk::ImageMemoryBarrier2::default()
                .old_layout(dst)
                .new_layout(general)
                .src_stage_mask(vk::PipelineStageFlags2::TRANSFER)
                .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
                .dst_stage_mask(vk::PipelineStageFlags2::TRANSFER)
                .dst_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
                .image(image)
                .subresource_range(whole())];
            vk.cmd_pipeline_barrier2(buffer, &vk::DependencyInfo::default().image_memory_barriers(&second));
            vk.cmd_clear_color_image(buffer, image, general, &colour, &[whole()]);
        });
        device.submit(&[commands], true);
        device.wait();
        vk.destroy_image(image, None);
        vk.free_memory(memory, None);
    }
}

/// Asks for the link of two devices, as the OpenXR half does.
#[test]
#[ignore = "started by other tests"]
fn ask_for_link() {
    let devices = [vk::API_VERSION_1_0, vk::API_VERSION_1_1]
        .map(|version| Device::new(version, Default::default(), Asks::Directly));
    let answers = devices.each_ref().map(|device| match record(device) {
        None => "none".to_owned(),
        Some(record) => {
            assert_eq!(record.device, device.device.handle());
            assert_eq!(record.instance, device.instance.handle());
            let version = record.api_version;
            format!("{}.{}", vk::api_version_major(version), vk::api_version_minor(version))
        }
    });
    println!("result {}", answers.join(" "));
}

fn record(device: &Device) -> Option<DeviceRecord> {
    let handle = device.device.handle();
    let mut record = MaybeUninit::uninit();
    // SAFETY: the device is live; the name gives the type; a result of 1 means that the record is written.
    unsafe {
        let get = device.instance.get_device_proc_addr(handle, GET_LINK_NAME.as_ptr())?;
        let table = &*std::mem::transmute::<unsafe extern "system" fn(), GetLink>(get)();
        (table.set_active)(handle, 1);
        ((table.device)(handle, record.as_mut_ptr()) == 1).then(|| record.assume_init())
    }
}
