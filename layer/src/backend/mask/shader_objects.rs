//! Facts about shader objects that masks depend on (VK_EXT_shader_object).
//!
//! All their state is set by commands, so that depth tests are not known, unlike with pipelines: their direction follows from the clear
//! value.

use super::Masks;
use crate::backend::mask::{DynamicStencil, PipelineFacts};
use crate::vk::shaders::{Effects, effects_of_object as effects};
use ash::vk;

impl Masks {
    /// Notes the shaders made of `infos`; shaders that failed are null.
    ///
    /// # Safety
    ///
    /// The structures are valid (valid usage of vkCreateShadersEXT).
    pub unsafe fn add_shader_objects(
        &self,
        infos: &[vk::ShaderCreateInfoEXT<'_>],
        shaders: &[vk::ShaderEXT],
    ) {
        for (info, &shader) in infos.iter().zip(shaders) {
            if info.stage == vk::ShaderStageFlags::FRAGMENT && shader != vk::ShaderEXT::null() {
                let facts = match info.code_type {
                    // SAFETY: the structure is valid, by the valid usage of vkCreateShadersEXT.
                    vk::ShaderCodeTypeEXT::SPIRV => facts(unsafe { effects(info) }),
                    _ => PipelineFacts::UNKNOWN,
                };
                self.shader_objects.insert(shader, facts);
            }
        }
    }

    /// A shader is about to be destroyed.
    pub fn forget_shader_object(&self, shader: vk::ShaderEXT) {
        self.shader_objects.remove(shader);
    }

    /// Facts about draws with a fragment shader, or with none.
    pub fn shader_object(&self, shader: vk::ShaderEXT) -> PipelineFacts {
        match shader == vk::ShaderEXT::null() {
            true => DRAWS,
            false => self.shader_objects.get(shader).unwrap_or(PipelineFacts::UNKNOWN),
        }
    }
}

/// Draws whose state is set by commands.
const DRAWS: PipelineFacts = PipelineFacts {
    have_side_effects: false,
    are_unknown: false,
    dynamic_stencil: DynamicStencil { test: true, op: true },
    ..PipelineFacts::UNKNOWN
};

fn facts(effects: Effects) -> PipelineFacts {
    PipelineFacts { have_side_effects: effects.stores || effects.interlocks, ..DRAWS }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaders_that_write_elsewhere_keep_their_pass_from_masks() {
        assert_eq!(facts(Effects::default()), DRAWS);
        for effects in [
            Effects { stores: true, ..Effects::default() },
            Effects { interlocks: true, ..Effects::default() },
            Effects::UNKNOWN,
        ] {
            assert!(facts(effects).have_side_effects);
        }
    }
}
