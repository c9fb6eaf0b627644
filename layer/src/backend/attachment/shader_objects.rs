//! Shader objects: they may be used with a rate attachment, and their rate is set when they are bound.
//!
//! Without pipelines a rate must be set by a command before each draw (VUID-vkCmdDraw-None-09238), which an application
//! that enables no rates does not do. Binding a pipeline in between unbinds the shaders, so that setting it with each
//! fragment shader is enough.

use super::attach::RateAttachments;
use super::commands::SetRate;
use super::full_rate::Causes;
use super::refused::{Unamended, create_amended, may_be_ours};
use crate::abi::copies::slice;
use crate::gpu::GpuError;
use crate::vk::shaders::effects_of_object as effects;
use ash::vk;

impl RateAttachments {
    /// A fragment shader is about to be destroyed.
    pub fn forget_shader_object(&self, shader: vk::ShaderEXT) {
        self.shader_objects.remove(shader);
    }

    /// `vkCreateShadersEXT`, with the flag that the shaders may be used with a rate attachment. If that fails, for want of
    /// memory twice, the call is repeated as the application made it.
    ///
    /// # Safety
    ///
    /// The arguments of the call; functions of the device's next layer.
    pub unsafe fn create_shaders(
        &self,
        device: vk::Device,
        count: u32,
        infos: *const vk::ShaderCreateInfoEXT<'_>,
        allocator: *const vk::AllocationCallbacks<'_>,
        made: *mut vk::ShaderEXT,
        (next, destroy): (vk::PFN_vkCreateShadersEXT, Option<vk::PFN_vkDestroyShaderEXT>),
    ) -> vk::Result {
        // SAFETY: valid usage demands so many structures.
        let asked = unsafe { slice(infos, count) };
        if !asked.iter().any(is_fragment) {
            // SAFETY: the application's own arguments.
            return unsafe { next(device, count, infos, allocator, made) };
        }
        let amended: Vec<_> = asked.iter().map(flagged).collect();
        let discard = || {
            // SAFETY: the call has written so many handles, null for shaders that failed.
            for &shader in unsafe { slice(made.cast_const(), count) } {
                if let (Some(destroy), true) = (destroy, shader != vk::ShaderEXT::null()) {
                    // SAFETY: it was just made with this allocator, and no other code has its handle.
                    unsafe { destroy(device, shader, allocator) };
                }
            }
        };
        // SAFETY: the arguments are valid, as `# Safety` demands, with as many amended structures.
        let create = || unsafe { next(device, count, amended.as_ptr(), allocator, made) };
        let result = create_amended(create, discard);
        let is_made = |info: &_, shader: vk::ShaderEXT| is_fragment(info) && shader != vk::ShaderEXT::null();
        if may_be_ours(result) {
            GpuError::Call { call: "vkCreateShadersEXT", result }.log("shaders stay unchanged, at 1x1");
            // SAFETY: the application's own arguments.
            let plain = unsafe { next(device, count, infos, allocator, made) };
            // SAFETY: as above, the call has written so many handles.
            let shaders = unsafe { slice(made.cast_const(), count) };
            if asked.iter().zip(shaders).any(|(info, shader)| is_made(info, *shader)) {
                self.leave_rendering_alone(Unamended::Refused("shaders", result));
            }
            return plain;
        }
        // SAFETY: as above.
        let shaders = unsafe { slice(made.cast_const(), count) };
        for (info, &shader) in asked.iter().zip(shaders) {
            if is_made(info, shader) {
                // SAFETY: valid usage demands valid structures.
                let causes = Causes::of_shader(self.counted(unsafe { effects(info) }));
                causes.list();
                self.shader_objects.insert(shader, causes.are_any());
            }
        }
        result
    }

    /// The rate to set when shaders are bound; nothing without a fragment shader among them.
    ///
    /// # Safety
    ///
    /// The arguments of vkCmdBindShadersEXT.
    pub unsafe fn shaders_bound(
        &self,
        buffer: vk::CommandBuffer,
        count: u32,
        stages: *const vk::ShaderStageFlags,
        shaders: *const vk::ShaderEXT,
    ) -> Option<SetRate> {
        // SAFETY: valid usage demands so many stages, and as many shaders or null: then all stages are unbound.
        let (stages, shaders) = unsafe { (slice(stages, count), slice(shaders, count)) };
        let index = stages.iter().position(|&stage| stage == vk::ShaderStageFlags::FRAGMENT)?;
        let shader = shaders.get(index).copied().unwrap_or_default();
        self.set_rates.bound_shader(buffer, self.shader_objects.get(shader).unwrap_or(false))
    }
}

fn is_fragment(info: &vk::ShaderCreateInfoEXT<'_>) -> bool {
    info.stage == vk::ShaderStageFlags::FRAGMENT
}

/// A fragment shader with the flag that it may be used with a rate attachment.
fn flagged<'c>(info: &vk::ShaderCreateInfoEXT<'c>) -> vk::ShaderCreateInfoEXT<'c> {
    let mut flagged = *info;
    if is_fragment(info) {
        flagged.flags |= vk::ShaderCreateFlagsEXT::FRAGMENT_SHADING_RATE_ATTACHMENT;
    }
    flagged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_fragment_shaders_get_the_flag() {
        let flag = vk::ShaderCreateFlagsEXT::FRAGMENT_SHADING_RATE_ATTACHMENT;
        let linked = vk::ShaderCreateFlagsEXT::LINK_STAGE;
        for (stage, flags) in
            [(vk::ShaderStageFlags::FRAGMENT, linked | flag), (vk::ShaderStageFlags::VERTEX, linked)]
        {
            let info = vk::ShaderCreateInfoEXT::default().stage(stage).flags(linked);
            assert_eq!(flagged(&info).flags, flags);
        }
    }
}
