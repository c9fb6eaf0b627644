//! Descriptor set layouts outlive the pipeline layouts that were made from them.

use crate::pictures::region;
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk::{self, Handle};
use glam::Vec3;
use parafovea::kernels::compose::Compose;
use parafovea_core::chroma::ChromaSettings;
use std::ffi::{CStr, c_char};
use std::sync::{Mutex, OnceLock};

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();

/// Live pipeline layouts with their set layouts, and the number of set layouts that were destroyed too early.
struct Layouts {
    live: Vec<(u64, Vec<u64>)>,
    made: usize,
    too_early: usize,
}

static LAYOUTS: Mutex<Layouts> = Mutex::new(Layouts { live: Vec::new(), made: 0, too_early: 0 });

/// Validation newer than 1.3.239 reports each bind with a pipeline layout of a destroyed set layout.
#[test]
fn set_layouts_outlive_pipeline_layouts() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.set(record.next_get_device_proc_addr).unwrap();
        record.next_get_device_proc_addr = noting_layouts;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 64, 64, 1));
    let regions = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    assert_eq!(compose.submit(&[swapchain.job(0, &regions)]), Ok(()));
    drop((compose, swapchain));
    vulkan.assert_valid();
    let layouts = LAYOUTS.lock().unwrap();
    assert!(layouts.made > 0, "no pipeline layout was made");
    assert_eq!(layouts.too_early, 0, "set layouts were destroyed before their pipeline layouts");
}

unsafe extern "system" fn noting_layouts(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    type Function = unsafe extern "system" fn();
    // SAFETY: names are C strings, the device is live, and the functions have the types of these names.
    unsafe {
        match CStr::from_ptr(name).to_bytes() {
            b"vkCreatePipelineLayout" => {
                Some(std::mem::transmute::<vk::PFN_vkCreatePipelineLayout, Function>(create))
            }
            b"vkDestroyPipelineLayout" => {
                Some(std::mem::transmute::<vk::PFN_vkDestroyPipelineLayout, Function>(destroy))
            }
            b"vkDestroyDescriptorSetLayout" => {
                Some(std::mem::transmute::<vk::PFN_vkDestroyDescriptorSetLayout, Function>(destroy_set))
            }
            _ => NEXT.get().unwrap()(device, name),
        }
    }
}

/// The next function of that name.
///
/// # Safety
///
/// `F` is the name's type, and the device is live.
unsafe fn next<F: Copy>(device: vk::Device, name: &CStr) -> F {
    // SAFETY: the caller vouches for the type, which is a function's.
    unsafe {
        let found = NEXT.get().unwrap()(device, name.as_ptr()).unwrap();
        std::mem::transmute_copy(&found)
    }
}

unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::PipelineLayoutCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::PipelineLayout,
) -> vk::Result {
    // SAFETY: the caller's own arguments, which are valid.
    unsafe {
        let create: vk::PFN_vkCreatePipelineLayout = next(device, c"vkCreatePipelineLayout");
        let result = create(device, info, allocator, made);
        let sets = std::slice::from_raw_parts((*info).p_set_layouts, (*info).set_layout_count as usize);
        let mut layouts = LAYOUTS.lock().unwrap();
        layouts.made += 1;
        layouts.live.push(((*made).as_raw(), sets.iter().map(|set| set.as_raw()).collect()));
        result
    }
}

unsafe extern "system" fn destroy(
    device: vk::Device,
    layout: vk::PipelineLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    LAYOUTS.lock().unwrap().live.retain(|(live, _)| *live != layout.as_raw());
    // SAFETY: the caller's own arguments.
    unsafe {
        let destroy: vk::PFN_vkDestroyPipelineLayout = next(device, c"vkDestroyPipelineLayout");
        destroy(device, layout, allocator);
    }
}

unsafe extern "system" fn destroy_set(
    device: vk::Device,
    set: vk::DescriptorSetLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    let mut layouts = LAYOUTS.lock().unwrap();
    let is_used = layouts.live.iter().any(|(_, sets)| sets.contains(&set.as_raw()));
    layouts.too_early += usize::from(is_used);
    drop(layouts);
    // SAFETY: the caller's own arguments.
    unsafe {
        let destroy: vk::PFN_vkDestroyDescriptorSetLayout = next(device, c"vkDestroyDescriptorSetLayout");
        destroy(device, set, allocator);
    }
}
