//! Statistics of our kernels from the first Vulkan device's compiler (`VK_KHR_pipeline_executable_properties`), a line of JSON for each
//! compiled stage: `cargo dev drivers --kernels` reads it.

#![allow(clippy::unwrap_used, reason = "a failed step ends the program")]

use ash::{khr, vk};
use parafovea::gpu::{Gpu, GpuError};
use parafovea::kernels::analyze::Analyze;
use parafovea::kernels::compose::Compose;
use parafovea::kernels::decide::Decide;
use parafovea::kernels::fill::Fill;
use parafovea::kernels::mask::MaskPass;
use parafovea::kernels::resolve::Resolve;
use parafovea::link::DeviceRecord;
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, OnceLock};

/// The format that pictures are composed in.
const FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;

/// The functions below ours.
struct Next {
    get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    compute: vk::PFN_vkCreateComputePipelines,
    graphics: vk::PFN_vkCreateGraphicsPipelines,
    executables: khr::pipeline_executable_properties::Device,
}

static NEXT: OnceLock<Next> = OnceLock::new();

/// The kernel whose pipelines are being made.
static KERNEL: Mutex<&str> = Mutex::new("");

fn main() -> ExitCode {
    // SAFETY: plain use of Vulkan; all handles stay live for the rest of the process.
    match unsafe { device() } {
        Ok(record) => {
            // SAFETY: the device has this queue, which no other code uses.
            let gpu = unsafe { Gpu::new(&record, 0, 0) }.unwrap();
            kernels(&gpu).unwrap();
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// Makes the pipelines of all kernels.
fn kernels(gpu: &Arc<Gpu>) -> Result<(), GpuError> {
    let begin = |kernel| *KERNEL.lock().unwrap() = kernel;
    begin("analyze");
    Analyze::new(gpu)?;
    begin("decide");
    Decide::new(gpu)?;
    begin("resolve");
    Resolve::new(gpu)?;
    begin("mask");
    MaskPass::new(gpu)?;
    begin("fill");
    Fill::new(gpu)?;
    begin("compose");
    let mut compose = Compose::new(Arc::clone(gpu))?;
    // With the kernel `change`, which its entry points distinguish from compose.
    compose.prepare_reuse(FORMAT)
}

/// # Safety
/// Nothing that was made here is destroyed.
unsafe fn device() -> Result<DeviceRecord, String> {
    // SAFETY: structures and handles are valid; the caller vouches for the rest.
    unsafe {
        let entry = ash::Entry::load().map_err(|error| error.to_string())?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_1);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        let instance = entry.create_instance(&info, None).map_err(|error| error.to_string())?;
        let devices = instance.enumerate_physical_devices().map_err(|error| error.to_string())?;
        let physical_device = *devices.first().ok_or("no Vulkan device")?;
        let name = khr::pipeline_executable_properties::NAME;
        let extensions = instance.enumerate_device_extension_properties(physical_device).unwrap_or_default();
        if !extensions.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name)) {
            return Err(format!("the device has no {name:?}"));
        }
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&priorities)];
        let names = [name.as_ptr()];
        let mut feature = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
            .pipeline_executable_info(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&names)
            .push_next(&mut feature);
        let device =
            instance.create_device(physical_device, &info, None).map_err(|error| error.to_string())?;
        let next = Next {
            get_device_proc_addr: instance.fp_v1_0().get_device_proc_addr,
            compute: device.fp_v1_0().create_compute_pipelines,
            graphics: device.fp_v1_0().create_graphics_pipelines,
            executables: khr::pipeline_executable_properties::Device::new(&instance, &device),
        };
        let _ = NEXT.set(next);
        let record = DeviceRecord {
            instance: instance.handle(),
            physical_device,
            device: device.handle(),
            api_version: vk::API_VERSION_1_0,
            next_get_instance_proc_addr: entry.static_fn().get_instance_proc_addr,
            next_get_device_proc_addr: asking,
            set_device_loader_data,
            queue_submit: None,
            arming: parafovea::config::Arming::Rates as u32,
            submits_late: 0,
        };
        // The loader library must outlive the device.
        std::mem::forget(entry);
        Ok(record)
    }
}

/// A loader initialises queues that come through it, as ours do here.
unsafe extern "system" fn set_device_loader_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

unsafe extern "system" fn asking(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    type Function = unsafe extern "system" fn();
    // SAFETY: names are C strings, and give the functions' types; the device is live.
    unsafe {
        let next = (NEXT.get()?.get_device_proc_addr)(device, name)?;
        Some(match CStr::from_ptr(name).to_bytes() {
            b"vkCreateComputePipelines" => transmute::<vk::PFN_vkCreateComputePipelines, Function>(compute),
            b"vkCreateGraphicsPipelines" => {
                transmute::<vk::PFN_vkCreateGraphicsPipelines, Function>(graphics)
            }
            _ => next,
        })
    }
}

unsafe extern "system" fn compute(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    let next = NEXT.get().unwrap();
    // SAFETY: the caller's own arguments, one pipeline at a time, with a flag more.
    unsafe {
        let mut info = *infos;
        info.flags |= vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR;
        let result = (next.compute)(device, cache, count.min(1), &info, allocator, pipelines);
        tell(&[info.stage], *pipelines);
        result
    }
}

unsafe extern "system" fn graphics(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    let next = NEXT.get().unwrap();
    // SAFETY: as above.
    unsafe {
        let mut info = *infos;
        info.flags |= vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR;
        let result = (next.graphics)(device, cache, count.min(1), &info, allocator, pipelines);
        tell(std::slice::from_raw_parts(info.p_stages, info.stage_count as usize), *pipelines);
        result
    }
}

/// Prints the compiler's statistics of a pipeline with these stages.
///
/// # Safety
/// The stages are valid, and the pipeline is live.
unsafe fn tell(stages: &[vk::PipelineShaderStageCreateInfo<'_>], pipeline: vk::Pipeline) {
    let next = &NEXT.get().unwrap().executables;
    let kernel = *KERNEL.lock().unwrap();
    // SAFETY: the caller vouches for both; unions are read by their tag.
    unsafe {
        let info = vk::PipelineInfoKHR::default().pipeline(pipeline);
        for (index, properties) in next.get_pipeline_executable_properties(&info).unwrap().iter().enumerate()
        {
            // An executable of no stage is the driver's own.
            let Some(stage) = stages.iter().find(|stage| properties.stages.contains(stage.stage)) else {
                continue;
            };
            let entry = CStr::from_ptr(stage.p_name).to_str().unwrap();
            let info =
                vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(index as u32);
            let statistics = next.get_pipeline_executable_statistics(&info).unwrap();
            let statistics: Vec<String> = statistics
                .iter()
                .filter_map(|statistic| {
                    let name = statistic.name_as_c_str().ok()?.to_str().ok()?;
                    let value = match statistic.format {
                        vk::PipelineExecutableStatisticFormatKHR::UINT64 => statistic.value.u64 as f64,
                        vk::PipelineExecutableStatisticFormatKHR::INT64 => statistic.value.i64 as f64,
                        vk::PipelineExecutableStatisticFormatKHR::FLOAT64 => statistic.value.f64,
                        _ => return None,
                    };
                    Some(format!("{name:?}:{value}"))
                })
                .collect();
            println!(
                "{{\"kernel\":{kernel:?},\"entry\":{entry:?},\"stage\":\"{:?}\",\"subgroup_size\":{},\"statistics\":{{{}}}}}",
                stage.stage,
                properties.subgroup_size,
                statistics.join(",")
            );
        }
    }
}
