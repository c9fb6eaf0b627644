use super::*;
use std::ffi::c_void;

fn info() -> xr::SwapchainCreateInfo {
    xr::SwapchainCreateInfo {
        ty: xr::SwapchainCreateInfo::TYPE,
        next: std::ptr::null(),
        create_flags: xr::SwapchainCreateFlags::EMPTY,
        usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::SAMPLED,
        format: i64::from(vk::Format::R8G8B8A8_SRGB.as_raw()),
        sample_count: 1,
        width: 64,
        height: 32,
        face_count: 1,
        array_size: 2,
        mip_count: 1,
    }
}

fn shape_of(info: &xr::SwapchainCreateInfo) -> Result<SwapchainShape, NotSubstituted> {
    // SAFETY: the tests make valid structures.
    unsafe { shape(info, |format| format == vk::Format::R8G8B8A8_SRGB) }
}

#[test]
fn an_ordinary_swapchain_keeps_its_shape() {
    let shape = shape_of(&info()).unwrap();
    assert_eq!((shape.extent.width, shape.extent.height, shape.array_layers), (64, 32, 2));
    assert_eq!(shape.usage, vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED);
    assert!(!shape.mutable && shape.view_formats.is_empty());
}

#[test]
fn swapchains_that_cannot_be_copied_stay_unchanged() {
    let refused = |change: fn(&mut xr::SwapchainCreateInfo)| {
        let mut info = info();
        change(&mut info);
        shape_of(&info).unwrap_err()
    };
    for flags in [xr::SwapchainCreateFlags::STATIC_IMAGE, xr::SwapchainCreateFlags::PROTECTED_CONTENT] {
        let info = xr::SwapchainCreateInfo { create_flags: flags, ..info() };
        assert_eq!(shape_of(&info).unwrap_err(), NotSubstituted::CreateFlags(flags));
    }
    assert!(matches!(refused(|info| info.sample_count = 4), NotSubstituted::Kind { samples: 4, .. }));
    assert!(matches!(refused(|info| info.mip_count = 2), NotSubstituted::Kind { mips: 2, .. }));
    assert!(matches!(refused(|info| info.face_count = 6), NotSubstituted::Kind { faces: 6, .. }));
    assert!(matches!(refused(|info| info.format = 126), NotSubstituted::Format(vk::Format::D32_SFLOAT)));
    assert!(matches!(refused(|info| info.format = i64::MAX), NotSubstituted::Format(_)));
    let depth = |info: &mut xr::SwapchainCreateInfo| {
        info.usage_flags = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    };
    assert!(matches!(refused(depth), NotSubstituted::Format(_)));
}

#[test]
fn a_format_list_is_read_and_nothing_else_is_taken() {
    let formats = [vk::Format::R8G8B8A8_SRGB.as_raw() as u32, vk::Format::R8G8B8A8_UNORM.as_raw() as u32];
    let mut list = xr::VulkanSwapchainFormatListCreateInfoKHR {
        ty: xr::VulkanSwapchainFormatListCreateInfoKHR::TYPE,
        next: std::ptr::null(),
        view_format_count: 2,
        view_formats: formats.as_ptr(),
    };
    let chained = |list: &xr::VulkanSwapchainFormatListCreateInfoKHR| xr::SwapchainCreateInfo {
        next: std::ptr::from_ref(list).cast::<c_void>(),
        ..info()
    };
    let shape = shape_of(&chained(&list)).unwrap();
    assert_eq!(shape.view_formats, [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM]);
    list.ty = xr::StructureType::SWAPCHAIN_CREATE_INFO_FOVEATION_FB;
    assert!(matches!(shape_of(&chained(&list)).unwrap_err(), NotSubstituted::Chain(_)));
    list.ty = xr::VulkanSwapchainFormatListCreateInfoKHR::TYPE;
    list.next = (&raw const list).cast();
    assert!(matches!(shape_of(&chained(&list)).unwrap_err(), NotSubstituted::Chain(_)), "a cycle");
}

#[test]
fn the_runtime_is_asked_for_what_the_copy_needs_too() {
    let needed = xr::SwapchainUsageFlags::TRANSFER_DST | xr::SwapchainUsageFlags::COLOR_ATTACHMENT;
    let sampled = xr::SwapchainUsageFlags::SAMPLED;
    assert!(runtime_usage(sampled, false).contains(needed | sampled));
    let asked = xr::SwapchainUsageFlags::COLOR_ATTACHMENT;
    assert_eq!(runtime_usage(asked, false), needed);
    assert_eq!(runtime_usage(asked, true), needed | sampled, "what is analysed is sampled");
}
