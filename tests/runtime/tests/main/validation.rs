//! The Vulkan validation layer listens to all cases: this shows that it would be heard.

use crate::case::{CHILD_VARIABLE, LIMIT, check_validation, environment};
use crate::gpu::{Gpu, vulkan_loader};
use ash::vk;
use libtest_mimic::{Completion, Trial};
use parafovea_trial::{Lack, watch};
use std::process::Command;

/// Name of the process that makes a mistake.
pub const MISTAKE: &str = "validation::mistake";

/// A mistake in the use of Vulkan, without consequences.
pub fn make_mistake() {
    let gpu = Gpu::new();
    let empty = vk::BufferCreateInfo::default().usage(vk::BufferUsageFlags::TRANSFER_SRC);
    // SAFETY: an empty buffer is not allowed; lavapipe and GPUs' drivers make it all the same, or refuse.
    unsafe {
        if let Ok(buffer) = gpu.device.create_buffer(&empty, None) {
            gpu.device.destroy_buffer(buffer, None);
        }
    }
}

/// A trial, ignored without the layer.
pub fn trial() -> Trial {
    Trial::ignorable_test("validation::is_heard", || {
        if !is_installed() {
            return Ok(Completion::ignored_with(Lack::setup("the Vulkan validation layer")));
        }
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.env(CHILD_VARIABLE, MISTAKE).envs(environment(folder.path(), ""));
        let ended = watch(&mut command, LIMIT).unwrap();
        assert!(check_validation(folder.path()).is_err(), "the validation layer said nothing: {ended:?}");
        Ok(Completion::Completed)
    })
}

fn is_installed() -> bool {
    // SAFETY: plain Vulkan with valid parameters.
    let layers = unsafe {
        let entry = ash::Entry::from_static_fn(ash::StaticFn { get_instance_proc_addr: vulkan_loader() });
        entry.enumerate_instance_layer_properties()
    };
    let is_it =
        |layer: &vk::LayerProperties| layer.layer_name_as_c_str() == Ok(c"VK_LAYER_KHRONOS_validation");
    layers.is_ok_and(|layers| layers.iter().any(is_it))
}
