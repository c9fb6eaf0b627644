//! Shader objects: they may be used with a rate attachment, and their rate is set when they are bound.
//!
//! Without pipelines a rate must be set by a command before each draw (VUID-vkCmdDraw-None-09238), which an application
//! that enables no rates does not do. Binding a pipeline in between unbinds the shaders, so that setting it with each
//! fragment shader is enough.

use super::attach::Rates;
use super::commands::SetRate;
use super::copies::{slice, words};
use super::pipelines::may_be_ours;
use super::shader::{Effects, FragmentShaders};
use crate::abi::guard;
use crate::gpu::GpuError;
use crate::vk::{device, recording};
use ash::vk;
use std::ffi::CStr;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

impl Rates {
    /// `vkCreateShadersEXT`, with the flag that the shaders may be used with a rate attachment. If that fails, the call
    /// is repeated as the application made it.
    ///
    /// # Safety
    ///
    /// The arguments of the call; functions of the device's next layer.
    unsafe fn create_shaders(
        &self,
        device: vk::Device,
        count: u32,
        infos: *const vk::ShaderCreateInfoEXT<'_>,
        allocator: *const vk::AllocationCallbacks<'_>,
        made: *mut vk::ShaderEXT,
        (next, destroy): (vk::PFN_vkCreateShadersEXT, Option<vk::PFN_vkDestroyShaderEXT>),
    ) -> vk::Result {
        // SAFETY: the caller vouches for the arguments; what could not be made is null.
        unsafe {
            let asked = slice(infos, count);
            let amended: Vec<_> = asked.iter().map(flagged).collect();
            let result = next(device, count, amended.as_ptr(), allocator, made);
            if may_be_ours(result) {
                GpuError::Call { call: "vkCreateShadersEXT", result }.tell("shaders stay unchanged, at 1x1");
                for &shader in slice(made.cast_const(), count) {
                    if let (Some(destroy), true) = (destroy, shader != vk::ShaderEXT::null()) {
                        destroy(device, shader, allocator);
                    }
                }
                self.leave_rendering_alone();
                return next(device, count, infos, allocator, made);
            }
            for (info, &shader) in asked.iter().zip(slice(made.cast_const(), count)) {
                if info.stage == vk::ShaderStageFlags::FRAGMENT && shader != vk::ShaderEXT::null() {
                    let every_pixel = effects(info).need_every_pixel(&self.offer.limits);
                    self.shader_objects.insert(shader, every_pixel);
                }
            }
            result
        }
    }

    /// The rate to set when shaders are bound; nothing without a fragment shader among them.
    ///
    /// # Safety
    ///
    /// The arguments of vkCmdBindShadersEXT.
    unsafe fn shaders_bound(
        &self,
        buffer: vk::CommandBuffer,
        count: u32,
        stages: *const vk::ShaderStageFlags,
        shaders: *const vk::ShaderEXT,
    ) -> Option<SetRate> {
        // SAFETY: the caller vouches for the arrays; without shaders all stages are unbound.
        let (stages, shaders) = unsafe { (slice(stages, count), slice(shaders, count)) };
        let index = stages.iter().position(|&stage| stage == vk::ShaderStageFlags::FRAGMENT)?;
        let shader = shaders.get(index).copied().unwrap_or_default();
        self.set_rates.bound_shader(buffer, self.shader_objects.get(shader).unwrap_or(false))
    }
}

/// A fragment shader with the flag that it may be used with a rate attachment.
fn flagged<'c>(info: &vk::ShaderCreateInfoEXT<'c>) -> vk::ShaderCreateInfoEXT<'c> {
    let mut flagged = *info;
    if info.stage == vk::ShaderStageFlags::FRAGMENT {
        flagged.flags |= vk::ShaderCreateFlagsEXT::FRAGMENT_SHADING_RATE_ATTACHMENT;
    }
    flagged
}

/// What a fragment shader does; nothing is known of a binary.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn effects(info: &vk::ShaderCreateInfoEXT<'_>) -> Effects {
    if info.code_type != vk::ShaderCodeTypeEXT::SPIRV {
        return Effects::UNKNOWN;
    }
    // SAFETY: the caller vouches for the code, which is SPIR-V of `code_size` bytes, and the name.
    unsafe {
        let words = words(info.p_code, info.code_size);
        let name = CStr::from_ptr(info.p_name).to_str();
        let shaders = FragmentShaders::read(&words).zip(name.ok());
        shaders.map_or(Effects::UNKNOWN, |(shaders, name)| shaders.effects(name))
    }
}

/// `vkCreateShadersEXT`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    count: u32,
    infos: *const vk::ShaderCreateInfoEXT<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::ShaderEXT,
) -> vk::Result {
    guard(
        "vkCreateShadersEXT",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_shaders(device, count, infos, allocator, made), FAILED)
        },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_shaders) else {
                    return FAILED;
                };
                let result = answer.record(match known.rates() {
                    Some(rates) => {
                        let functions = (next, known.hooked.destroy_shader);
                        rates.create_shaders(device, count, infos, allocator, made, functions)
                    }
                    None => next(device, count, infos, allocator, made),
                });
                if let Some(masks) = known.masks() {
                    // What could not be made is null.
                    masks.add_shader_objects(slice(infos, count), slice(made.cast_const(), count));
                }
                result
            }
        },
    )
}

/// `vkDestroyShaderEXT`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    shader: vk::ShaderEXT,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyShaderEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_shader(device, shader, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_shader) else { return };
                if let Some(rates) = known.rates() {
                    rates.shader_objects.remove(shader);
                }
                if let Some(masks) = known.masks() {
                    masks.forget_shader_object(shader);
                }
                next(device, shader, allocator);
                answer.made();
            }
        },
    );
}

/// `vkCmdBindShadersEXT`.
pub unsafe extern "system" fn bind(
    buffer: vk::CommandBuffer,
    count: u32,
    stages: *const vk::ShaderStageFlags,
    shaders: *const vk::ShaderEXT,
) {
    guard(
        "vkCmdBindShadersEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: buffer, cmd_bind_shaders(buffer, count, stages, shaders), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(buffer, |next| next.cmd_bind_shaders) else { return };
                let masked = known.masks().zip(recording::buffer(buffer));
                if let Some((_, recording)) = &masked {
                    recording::drawing::leave(recording, buffer);
                    recording::stencil::changes(recording, buffer);
                }
                next(buffer, count, stages, shaders);
                answer.made();
                if let Some(rates) = known.rates()
                    && let Some(rate) = rates.shaders_bound(buffer, count, stages, shaders)
                    && let Some(set) = known.hooked.cmd_set_fragment_shading_rate
                {
                    set(buffer, &rate.size, &rate.combiners);
                }
                if let Some((masks, recording)) = masked {
                    let stages = slice(stages, count);
                    let shader = |index| slice(shaders, count).get(index).copied().unwrap_or_default();
                    let mut recorded = recording.recorded();
                    for (index, &stage) in stages.iter().enumerate() {
                        match stage {
                            vk::ShaderStageFlags::COMPUTE => recorded.compute.bind_shader(shader(index)),
                            vk::ShaderStageFlags::FRAGMENT => {
                                recorded.use_pipeline(masks.shader_object(shader(index)));
                                recorded.drawing.bind_more();
                            }
                            // Other stages alone draw no colour, but replace the graphics pipeline as well.
                            _ => recorded.drawing.bind_more(),
                        }
                    }
                }
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::super::shader::tests::plain_shader;
    use super::*;

    /// Applications include compiled shaders as bytes, at any address.
    #[test]
    fn code_at_an_odd_address_is_read() {
        let code: Vec<u8> = plain_shader().iter().flat_map(|word| word.to_ne_bytes()).collect();
        for offset in 0..4 {
            let mut aligned = vec![0u32; code.len() / 4 + 1];
            let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut aligned);
            bytes[offset..offset + code.len()].copy_from_slice(&code);
            let info = vk::ShaderCreateInfoEXT::default()
                .stage(vk::ShaderStageFlags::FRAGMENT)
                .code_type(vk::ShaderCodeTypeEXT::SPIRV)
                .code(&bytes[offset..offset + code.len()])
                .name(c"main");
            // SAFETY: the structure is valid but for the alignment of its code.
            let effects = unsafe { effects(&info) };
            assert_eq!(effects, Effects::default(), "at an offset of {offset} bytes");
        }
    }

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
