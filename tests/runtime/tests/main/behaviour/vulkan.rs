//! Swapchains, and the device that the runtime makes.

use super::SUCCESS;
use crate::application::{
    Application, ENABLE, V1_0, call, header, projection, structure, swapchain_info, views,
};
use crate::case::Output;
use crate::gpu::{Gpu, vulkan_loader};
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use parafovea_mock_runtime::record::Line;

pub fn wait_timeouts() {
    let app = Application::ready();
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    assert_eq!(app.acquire(swapchain), Ok(1));
    assert_eq!(app.wait(swapchain), xr::Result::TIMEOUT_EXPIRED);
    assert_eq!(app.wait(swapchain), SUCCESS);
    assert_eq!(app.release(swapchain), SUCCESS);
    assert_eq!(app.acquire(swapchain), Ok(0));
}

pub fn swapchains() {
    let app = Application::ready_with(V1_0, &[ENABLE, "XR_KHR_vulkan_swapchain_format_list"]);
    let mut count = 0;
    let mut formats = [0; 16];
    let result = call!(app, EnumerateSwapchainFormats(app.session, 16, &mut count, formats.as_mut_ptr()));
    assert_eq!(result, SUCCESS);
    for &format in &formats[..count as usize] {
        let depth = [126, 129, 130].contains(&format);
        let usage = match depth {
            true => xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            false => xr::SwapchainUsageFlags::COLOR_ATTACHMENT,
        };
        let info = xr::SwapchainCreateInfo { format, usage_flags: usage, ..swapchain_info() };
        let shapes = [
            info,
            xr::SwapchainCreateInfo { array_size: 2, ..info },
            xr::SwapchainCreateInfo { mip_count: 7, ..info },
            xr::SwapchainCreateInfo { sample_count: 4, ..info },
            xr::SwapchainCreateInfo { face_count: 6, ..info },
            xr::SwapchainCreateInfo { create_flags: xr::SwapchainCreateFlags::STATIC_IMAGE, ..info },
        ];
        for shape in shapes {
            let swapchain = app.create_swapchain(&shape).unwrap();
            assert_eq!(call!(app, DestroySwapchain(swapchain)), SUCCESS);
        }
    }
    let views = [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM].map(|format| format.as_raw() as u32);
    let list = structure!(VulkanSwapchainFormatListCreateInfoKHR {
        view_format_count: 2,
        view_formats: views.as_ptr()
    });
    let mut info = swapchain_info();
    info.next = std::ptr::from_ref(&list).cast();
    info.usage_flags |= xr::SwapchainUsageFlags::MUTABLE_FORMAT;
    app.create_swapchain(&info).unwrap();
}

pub fn swapchains_recorded(output: &Output) {
    let created = output.record.iter().filter_map(|line| match line {
        Line::SwapchainCreated(created) => Some(created),
        _ => None,
    });
    let created: Vec<_> = created.collect();
    let names: std::collections::BTreeSet<_> =
        created.iter().map(|created| created.format.as_str()).collect();
    for name in [
        "R8G8B8A8_SRGB",
        "B8G8R8A8_SRGB",
        "R8G8B8A8_UNORM",
        "B8G8R8A8_UNORM",
        "R16G16B16A16_SFLOAT",
        "D32_SFLOAT",
    ] {
        assert!(names.contains(name), "{name}: {names:?}");
    }
    let last = created.last().unwrap();
    assert_eq!(last.view_formats, ["R8G8B8A8_SRGB", "R8G8B8A8_UNORM"]);
    assert_eq!((last.images, last.usage_flags), (3, 0x51));
}

pub fn enable2() {
    let mut app = Application::with_instance(V1_0, &["XR_KHR_vulkan_enable2"]);
    let mut requirements = structure!(GraphicsRequirementsVulkanKHR {});
    let result = call!(app, GetVulkanGraphicsRequirements2KHR(app.instance, app.system, &mut requirements));
    assert_eq!(result, SUCCESS);
    // SAFETY: the same function type, which both crates declare for themselves.
    let loader = unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::platform::VkGetInstanceProcAddr>(
            vulkan_loader(),
        )
    };
    let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_1);
    let parameters = vk::InstanceCreateInfo::default().application_info(&application);
    let info = structure!(VulkanInstanceCreateInfoKHR {
        system_id: app.system,
        pfn_get_instance_proc_addr: Some(loader),
        vulkan_create_info: std::ptr::from_ref(&parameters).cast(),
    });
    let (mut instance, mut vk_result) = (std::ptr::null(), -1);
    assert_eq!(
        call!(app, CreateVulkanInstanceKHR(app.instance, &info, &mut instance, &mut vk_result)),
        SUCCESS
    );
    assert_eq!(vk_result, 0);
    let info =
        structure!(VulkanGraphicsDeviceGetInfoKHR { system_id: app.system, vulkan_instance: instance });
    let mut physical_device = std::ptr::null();
    assert_eq!(call!(app, GetVulkanGraphicsDevice2KHR(app.instance, &info, &mut physical_device)), SUCCESS);
    let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
    let parameters = vk::DeviceCreateInfo::default().queue_create_infos(&queues);
    let info = structure!(VulkanDeviceCreateInfoKHR {
        system_id: app.system,
        pfn_get_instance_proc_addr: Some(loader),
        vulkan_physical_device: physical_device,
        vulkan_create_info: std::ptr::from_ref(&parameters).cast(),
    });
    let mut device = std::ptr::null();
    assert_eq!(call!(app, CreateVulkanDeviceKHR(app.instance, &info, &mut device, &mut vk_result)), SUCCESS);
    assert_eq!(vk_result, 0);
    // SAFETY: the runtime made instance and device, with this loader.
    app.gpu = Some(unsafe {
        let static_fn = ash::StaticFn { get_instance_proc_addr: vulkan_loader() };
        let entry = ash::Entry::from_static_fn(static_fn.clone());
        let instance = ash::Instance::load(&static_fn, vk::Instance::from_raw(instance as u64));
        let device = ash::Device::load(instance.fp_v1_0(), vk::Device::from_raw(device as u64));
        Gpu::of(entry, instance, vk::PhysicalDevice::from_raw(physical_device as u64), device)
    });
    assert_eq!(app.create_session(), SUCCESS);
    assert_eq!(app.begin_session(), SUCCESS);
    let swapchain = app.swapchain();
    app.show(swapchain, 0, &[]);
    let time = app.begin_frame().predicted_display_time;
    let views = views(swapchain);
    let layer = projection(app.space(xr::ReferenceSpaceType::LOCAL), &views);
    assert_eq!(app.end_frame(time, &[header(&layer)]), SUCCESS);
}
