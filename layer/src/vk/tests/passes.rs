//! Passes by the commands of newer extensions.

use super::fake::{self, rates};
use super::*;
use crate::pass_detection::{Event, ImageKey};
use crate::vk::dispatch::armed_hook;
use crate::vk::newer as types;
use crate::vk::objects::{Image, View};
use crate::vk::recording::{self, Buffer, draws};
use crate::vk::timing::Timer;
use std::sync::Arc;

/// A device with rates, and a command buffer of it that is kept.
fn with_command_buffer(test: impl FnOnce(vk::CommandBuffer, &Buffer)) {
    rates::capabilities(true, false);
    let instance = new_instance(None);
    let device = create_device(instance, fake::device_chain(null(), true).0, 1).unwrap();
    // SAFETY: the device is live.
    let armed = unsafe { device::of(device) }.and_then(|device| device.armed.clone()).unwrap();
    let handle = fake::command_buffer_of(device);
    let buffer: Arc<Buffer> = recording::keep(&armed, handle);
    drop(armed);
    test(handle, &buffer);
    drop(buffer);
    destroy_device(device);
    destroy_instance(instance);
    rates::capabilities(false, false);
}

macro_rules! hook {
    ($name:literal: $pfn:ident) => {
        // SAFETY: the name gives the type.
        unsafe { transmute::<vk::PFN_vkVoidFunction, types::$pfn>(armed_hook($name)) }
    };
}

fn begin(handle: vk::CommandBuffer) {
    let info = vk::RenderingInfo::default();
    let begin = hook!(c"vkCmdBeginRenderingKHR": PFN_vkCmdBeginRendering);
    // SAFETY: the command buffer is live, and the structure valid.
    unsafe { begin(handle, &info) };
}

/// The draws of meshes in each pass; `None` for a pass that has not ended.
fn draws(buffer: &Buffer) -> Vec<Option<u32>> {
    let recorded = buffer.recorded();
    let passes = recorded.events.iter().filter_map(|event| match event {
        Event::Pass(pass) => Some(pass.draws.as_ref().map(|draws| draws.meshes)),
        Event::Transfer(_) => None,
    });
    passes.collect()
}

/// A pass whose end is missed stays open, and a mask of it is never filled.
#[test]
fn rendering_ends_by_each_of_its_commands() {
    with_command_buffer(|handle, buffer| {
        let ends = [
            hook!(c"vkCmdEndRendering2KHR": PFN_vkCmdEndRendering2),
            hook!(c"vkCmdEndRendering2EXT": PFN_vkCmdEndRendering2),
        ];
        for (ended, end) in (0..).zip(ends) {
            begin(handle);
            assert_eq!(draws(buffer)[ended], None);
            // SAFETY: the command buffer is live; the structure may be missing.
            unsafe { end(handle, null()) };
            assert_eq!(draws(buffer)[ended], Some(0));
        }
    });
}

#[test]
fn generated_commands_with_graphics_stages_draw() {
    /// The beginning of `VkGeneratedCommandsInfoEXT`.
    #[repr(C)]
    struct Info {
        s_type: i32,
        next: *const c_void,
        stages: vk::ShaderStageFlags,
        set: u64,
    }
    let execute = hook!(c"vkCmdExecuteGeneratedCommandsEXT": PFN_vkCmdExecuteGeneratedCommandsEXT);
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    for (stages, expected) in [
        (vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT, 1),
        (vk::ShaderStageFlags::MESH_EXT, 1),
        (vk::ShaderStageFlags::COMPUTE, 0),
    ] {
        with_command_buffer(|handle, buffer| {
            begin(handle);
            let info = Info { s_type: 1_000_572_004, next: null(), stages, set: 0 };
            // SAFETY: the command buffer is live, and the structure valid.
            unsafe {
                execute(handle, vk::FALSE, (&raw const info).cast());
                end(handle);
            }
            assert_eq!(draws(buffer), [Some(expected)], "{stages:?}");
        });
    }
}

#[test]
fn draws_by_addresses_count() {
    let draws_by = [
        hook!(c"vkCmdDrawIndirect2KHR": PFN_vkCmdWithInfo),
        hook!(c"vkCmdDrawIndexedIndirect2KHR": PFN_vkCmdWithInfo),
        hook!(c"vkCmdDrawIndirectCount2KHR": PFN_vkCmdWithInfo),
        hook!(c"vkCmdDrawIndexedIndirectCount2KHR": PFN_vkCmdWithInfo),
        hook!(c"vkCmdDrawMeshTasksIndirect2EXT": PFN_vkCmdWithInfo),
        hook!(c"vkCmdDrawMeshTasksIndirectCount2EXT": PFN_vkCmdWithInfo),
    ];
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    with_command_buffer(|handle, buffer| {
        begin(handle);
        for draw in draws_by {
            // SAFETY: the command buffer is live; the stand-in does not read the structure.
            unsafe { draw(handle, null()) };
        }
        // SAFETY: the command buffer is live.
        unsafe { end(handle) };
        assert_eq!(draws(buffer), [Some(draws_by.len() as u32)]);
    });
}

/// VK_AMD_draw_indirect_count came before the extension of the same commands, and drivers still have it.
#[test]
fn draws_of_the_first_extension_with_a_count_count() {
    let draws_by = [
        hook!(c"vkCmdDrawIndirectCountAMD": PFN_vkCmdDrawIndirectCount),
        hook!(c"vkCmdDrawIndexedIndirectCountAMD": PFN_vkCmdDrawIndexedIndirectCount),
        hook!(c"vkCmdDrawIndirectCountKHR": PFN_vkCmdDrawIndirectCount),
        hook!(c"vkCmdDrawIndexedIndirectCountKHR": PFN_vkCmdDrawIndexedIndirectCount),
    ];
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    with_command_buffer(|handle, buffer| {
        begin(handle);
        for draw in draws_by {
            let none = vk::Buffer::null();
            // SAFETY: the command buffer is live; the stand-in does not read the buffers.
            unsafe { draw(handle, none, 0, none, 0, 1, 16) };
        }
        // SAFETY: the command buffer is live.
        unsafe { end(handle) };
        assert_eq!(draws(buffer), [Some(draws_by.len() as u32)]);
    });
}

/// The images that meshes read in the last pass, and whether they may read more.
fn read_by_meshes(buffer: &Buffer) -> (Vec<u64>, bool) {
    let recorded = buffer.recorded();
    let Some(Event::Pass(pass)) = recorded.events.last() else { panic!("no pass") };
    let reads = &pass.draws.as_ref().unwrap().read_by_meshes;
    (reads.images.iter().map(|image| image.0).collect(), reads.may_read_more)
}

/// A view of a picture, in a device's tables.
fn view_of_picture(buffer: &Buffer, number: u64) -> (vk::ImageView, u64) {
    let objects = &buffer.armed.objects;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    let image =
        Image::created(vk::Image::from_raw(number), &vk::ImageCreateInfo::default().usage(usage), usage);
    objects.add_image(image);
    let info = vk::ImageViewCreateInfo::default().image(image.handle).view_type(vk::ImageViewType::TYPE_2D);
    let view = vk::ImageView::from_raw(number);
    objects.views.insert(view, View::created(objects, &info).unwrap());
    objects.descriptors.add_view(view);
    (view, image.description.key.0)
}

#[test]
fn pushed_descriptors_are_read_until_others_take_their_place() {
    let push = hook!(c"vkCmdPushDescriptorSetKHR": PFN_vkCmdPushDescriptorSetKHR);
    let push_by = hook!(c"vkCmdPushDescriptorSetWithTemplateKHR": PFN_vkCmdPushDescriptorSetWithTemplateKHR);
    let draw = hook!(c"vkCmdDraw": PFN_vkCmdDraw);
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    let (layout, template) = (vk::PipelineLayout::null(), vk::DescriptorUpdateTemplate::from_raw(1));
    let [graphics, compute] = [vk::PipelineBindPoint::GRAPHICS, vk::PipelineBindPoint::COMPUTE];
    with_command_buffer(|handle, buffer| {
        let (one, of_one) = view_of_picture(buffer, 7);
        let (other, of_other) = view_of_picture(buffer, 8);
        let image = |view| vk::DescriptorImageInfo::default().image_view(view);
        let push_to = |point, number: u32, binding: u32, view| {
            let images = [image(view)];
            let write = vk::WriteDescriptorSet::default()
                .dst_binding(binding)
                .descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER)
                .image_info(&images);
            // SAFETY: the command buffer is live, and the write is valid.
            unsafe { push(handle, point, layout, number, 1, &write) };
        };
        let drawn = || {
            begin(handle);
            // SAFETY: the command buffer is live.
            unsafe {
                draw(handle, 30, 1, 0, 0);
                end(handle);
            }
            read_by_meshes(buffer)
        };
        draws::recording_begins(buffer, handle);
        push_to(graphics, 0, 0, one);
        assert_eq!(drawn(), (vec![of_one], false));
        push_to(graphics, 0, 1, other);
        assert_eq!(drawn(), (vec![of_one, of_other], false), "the first binding stays");
        push_to(graphics, 0, 0, vk::ImageView::from_raw(9));
        assert_eq!(drawn(), (vec![of_other], false), "an image that no pass draws to");
        push_to(compute, 0, 1, one);
        assert_eq!(drawn(), (vec![of_other], false));
        draws::recording_begins(buffer, handle);
        assert_eq!(drawn(), (vec![], false));
        push_to(graphics, 0, 0, one);
        assert_eq!(drawn(), (vec![of_one], false), "nothing is left of the last recording");

        let entry = vk::DescriptorUpdateTemplateEntry {
            descriptor_count: 1,
            descriptor_type: vk::DescriptorType::SAMPLED_IMAGE,
            ..vk::DescriptorUpdateTemplateEntry::default()
        };
        let data = image(other);
        // SAFETY: the command buffer is live, and the data as the template describes it.
        let push_by_template = || unsafe { push_by(handle, template, layout, 0, (&raw const data).cast()) };
        buffer.armed.objects.descriptors.add_template(template, &[entry], compute);
        push_by_template();
        assert_eq!(drawn(), (vec![of_one], false));
        buffer.armed.objects.descriptors.add_template(template, &[entry], graphics);
        push_by_template();
        assert_eq!(drawn(), (vec![of_other], false));
        push_to(graphics, 99, 0, one);
        assert!(drawn().1, "beyond the numbers that are followed");
    });
}

/// An upload is recorded beside a frame.
#[test]
fn reads_are_known_while_the_thread_begins_another_command_buffer() {
    let draw = hook!(c"vkCmdDraw": PFN_vkCmdDraw);
    let end = hook!(c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering);
    with_command_buffer(|handle, buffer| {
        let other_handle = fake::command_buffer_of(buffer.armed.record.device);
        let other = recording::keep(&buffer.armed, other_handle);
        let sets = [7, 8].map(vk::DescriptorSet::from_raw);
        for set in sets {
            buffer.armed.objects.descriptors.write(set, (0, 0), Some(ImageKey(set.as_raw())));
        }
        let bind = |set: usize| {
            // SAFETY: the command buffer is live.
            unsafe { draws::bind(handle, 0, &sets[set..=set]) };
        };
        let begin_other = || draws::recording_begins(&other, other_handle);
        // SAFETY: the command buffer is live.
        let draw_and_end = || unsafe {
            draw(handle, 30, 1, 0, 0);
            end(handle);
        };
        draws::recording_begins(buffer, handle);
        begin_other();
        bind(0);
        begin(handle);
        draw_and_end();
        assert_eq!(read_by_meshes(buffer), (vec![7], false));
        begin(handle);
        begin_other();
        draw_and_end();
        assert_eq!(read_by_meshes(buffer), (vec![7], false), "still bound");
        begin_other();
        std::thread::scope(|threads| {
            let record = || {
                draws::recording_begins(buffer, vk::CommandBuffer::from_raw(handle.as_raw()));
                bind(1);
            };
            threads.spawn(record);
        });
        begin(handle);
        draw_and_end();
        assert!(read_by_meshes(buffer).1, "another thread may have bound others");
    });
}

/// Frame graphs end with split barriers: the last layout of a swapchain's image is that of a wait.
#[test]
fn waits_for_events_leave_layouts_as_barriers_do() {
    use vk::ImageLayout as Layout;
    let wait = hook!(c"vkCmdWaitEvents": PFN_vkCmdWaitEvents);
    let wait2 = hook!(c"vkCmdWaitEvents2KHR": PFN_vkCmdWaitEvents2);
    with_command_buffer(|handle, buffer| {
        let [image, other] = [1, 2].map(vk::Image::from_raw);
        buffer.armed.layouts.follow(image, true, Layout::COLOR_ATTACHMENT_OPTIMAL);
        let stages = vk::PipelineStageFlags::ALL_COMMANDS;
        let range =
            |aspect_mask| vk::ImageSubresourceRange { aspect_mask, ..vk::ImageSubresourceRange::default() };
        let (depth, stencil) = (vk::ImageAspectFlags::DEPTH, vk::ImageAspectFlags::STENCIL);
        let barriers = [
            (image, Layout::GENERAL, depth),
            (other, Layout::GENERAL, depth),
            (image, Layout::STENCIL_READ_ONLY_OPTIMAL, stencil),
        ]
        .map(|(image, layout, aspects)| {
            vk::ImageMemoryBarrier::default()
                .image(image)
                .new_layout(layout)
                .subresource_range(range(aspects))
        });
        let event = vk::Event::from_raw(1);
        // SAFETY: the command buffer is live, and the arrays have so many elements.
        unsafe {
            wait(handle, 1, &event, stages, stages, 0, null(), 0, null(), 3, barriers.as_ptr());
        }
        let same = vk::ImageMemoryBarrier2::default().image(image).old_layout(Layout::GENERAL);
        let barriers = [same.new_layout(Layout::COLOR_ATTACHMENT_OPTIMAL), same.new_layout(Layout::GENERAL)];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barriers);
        // SAFETY: as above.
        unsafe { wait2(handle, 1, &event, &info) };
        let expected = [Some(Layout::GENERAL), Some(Layout::COLOR_ATTACHMENT_OPTIMAL), None];
        let expected = expected.map(|layout| (image, layout));
        assert_eq!(buffer.recorded().layouts[..], expected);
    });
}

/// A device that takes any call and does nothing.
fn idle_device() -> ash::Device {
    /// # Safety
    ///
    /// None.
    unsafe extern "system" fn nothing() -> vk::Result {
        vk::Result::SUCCESS
    }
    // SAFETY: called with any arguments, the function ignores them, and returns success.
    unsafe { ash::Device::load_with(|_| nothing as *const c_void, vk::Device::null()) }
}

/// Command buffers of compute alone have no passes, and the GPU's time in them counts all the same.
#[test]
fn dispatches_and_waits_begin_the_time_of_a_command_buffer() {
    let idle = idle_device();
    let dispatch = hook!(c"vkCmdDispatch": PFN_vkCmdDispatch);
    let base = hook!(c"vkCmdDispatchBase": PFN_vkCmdDispatchBase);
    let indirect = hook!(c"vkCmdDispatchIndirect": PFN_vkCmdDispatchIndirect);
    let wait = hook!(c"vkCmdWaitEvents2": PFN_vkCmdWaitEvents2);
    let event = vk::Event::from_raw(1);
    let info = vk::DependencyInfo::default();
    // SAFETY: the command buffer is live, and the arguments are valid or not read.
    let works: [&dyn Fn(vk::CommandBuffer); 4] = unsafe {
        [
            &move |handle| dispatch(handle, 1, 1, 1),
            &move |handle| base(handle, 0, 0, 0, 1, 1, 1),
            &move |handle| indirect(handle, vk::Buffer::null(), 0),
            &move |handle| wait(handle, 1, &event, &info),
        ]
    };
    for work in works {
        with_command_buffer(|handle, buffer| {
            // SAFETY: the device is never destroyed.
            buffer.recorded().timer = unsafe { Timer::of_tests(&idle, &buffer.armed.timing) };
            for is_wanted in [false, true] {
                buffer.armed.timing.set_wanted(is_wanted);
                work(handle);
                assert_eq!(buffer.recorded().timer.is_open(), is_wanted);
            }
        });
    }
}
