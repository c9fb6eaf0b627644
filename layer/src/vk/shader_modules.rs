//! What the fragment shaders of live shader modules do.

use super::chain::extension;
use super::rates::shader::{Effects, FragmentShaders};
use super::table::Table;
use ash::vk;
use std::ffi::CStr;
use std::slice;
use std::sync::Arc;

/// The modules of a device.
#[derive(Default)]
pub struct ShaderModules(Table<vk::ShaderModule, Arc<FragmentShaders>>);

impl ShaderModules {
    /// A module was created; one that is not understood is left out.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        // SAFETY: the caller vouches for the code.
        if let Some(shaders) = unsafe { read(info) } {
            self.0.insert(module, Arc::new(shaders));
        }
    }

    /// A module is about to be destroyed.
    pub fn forget(&self, module: vk::ShaderModule) {
        self.0.remove(module);
    }

    /// What the fragment shader of a stage does; nothing is known where its code is not at hand.
    ///
    /// # Safety
    ///
    /// The stage and its chain are valid.
    pub unsafe fn effects(&self, stage: &vk::PipelineShaderStageCreateInfo<'_>) -> Effects {
        // SAFETY: the caller vouches for the name and the chain.
        unsafe {
            let Ok(name) = CStr::from_ptr(stage.p_name).to_str() else { return Effects::UNKNOWN };
            if let Some(shaders) = self.0.get(stage.module) {
                return shaders.effects(name);
            }
            let code = extension::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next);
            code.and_then(|code| read(code)).map_or(Effects::UNKNOWN, |shaders| shaders.effects(name))
        }
    }
}

/// # Safety
///
/// The structure is valid.
unsafe fn read(info: &vk::ShaderModuleCreateInfo<'_>) -> Option<FragmentShaders> {
    if info.p_code.is_null() {
        return None;
    }
    // SAFETY: the caller vouches for the code, of `code_size` bytes.
    FragmentShaders::read(unsafe { slice::from_raw_parts(info.p_code, info.code_size / size_of::<u32>()) })
}
