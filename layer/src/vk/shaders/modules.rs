//! Effects of the fragment shaders of live shader modules.

use crate::abi::copies::{slice, words};
use crate::vk::chain::extension;
use crate::vk::shaders::effects::{Effects, FragmentShaders};
use crate::vk::shaders::flow::Flow;
use crate::vk::shaders::known::KnownShaders;
use crate::vk::shaders::parts::{flags, fragment_stage};
use crate::vk::shaders::specialization::Specialization;
use crate::vk::table::Table;
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The modules of a device.
#[derive(Default)]
pub struct ShaderModules {
    modules: Table<vk::ShaderModule, Arc<Module>>,
    /// Whether the application had to come with the code of a shader that it named by its identifier alone.
    is_code_requested: AtomicBool,
}

/// The facts of a module's shaders.
struct Module {
    shaders: Arc<FragmentShaders>,
    /// Control flow of shaders that may discard, by specialisation constants. `None` if no shader discards, or if [`Flow::read`] gives none.
    flow: Option<Flow>,
}

impl Module {
    /// `None` if its code is not understood.
    fn read(words: &[u32]) -> Option<Self> {
        let shaders = FragmentShaders::read(words)?;
        let discards = shaders.iter().any(|(_, effects)| effects.discards);
        let flow = discards.then(|| Flow::read(words)).flatten();
        Some(Self { shaders: Arc::new(shaders), flow })
    }

    /// Effects of the shader of that name in a pipeline that sets these constants.
    fn effects(&self, name: &str, constants: &Specialization) -> Effects {
        let effects = self.shaders.effects(name);
        let may_discard = || self.flow.as_ref().is_none_or(|flow| flow.discards(name, constants));
        Effects { discards: effects.discards && may_discard(), ..effects }
    }
}

impl ShaderModules {
    /// A module was created; one that is not understood is left out.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        // SAFETY: the code is valid, by the valid usage of vkCreateShaderModule.
        if let Some(facts) = Module::read(&unsafe { words(info.p_code.cast(), info.code_size) }) {
            self.modules.insert(module, Arc::new(facts));
        }
    }

    /// A module is about to be destroyed.
    pub fn forget(&self, module: vk::ShaderModule) {
        self.modules.remove(module);
    }

    /// The facts of a live module's shaders; `None` if its code is not understood.
    pub fn get(&self, module: vk::ShaderModule) -> Option<Arc<FragmentShaders>> {
        self.modules.get(module).map(|module| Arc::clone(&module.shaders))
    }

    /// The application has to come with code that it has not shown.
    pub fn request_code(&self) {
        if !self.is_code_requested.swap(true, Ordering::Relaxed) {
            tracing::info!(
                "pipelines by shader identifiers: code requested, as their fragment shaders are unknown; this start may take longer"
            );
        }
    }

    /// Whether code was requested, so that identifiers of code are of interest.
    pub fn is_code_requested(&self) -> bool {
        self.is_code_requested.load(Ordering::Relaxed)
    }

    /// The facts of a stage's fragment shader; unknown for code that neither this call nor an earlier launch has shown.
    ///
    /// # Safety
    ///
    /// The stage and its chain are valid.
    pub unsafe fn effects(&self, stage: &vk::PipelineShaderStageCreateInfo<'_>) -> Effects {
        // SAFETY: a valid stage has a name, and constants if the pointer is not null.
        let (name, constants) = unsafe {
            (CStr::from_ptr(stage.p_name).to_str(), Specialization::read(stage.p_specialization_info))
        };
        let Ok(name) = name else { return Effects::UNKNOWN };
        if let Some(module) = self.modules.get(stage.module) {
            return module.effects(name, &constants);
        }
        // SAFETY: the chain is valid, as `# Safety` demands, and its structures have as many bytes as they state.
        unsafe {
            let code = extension::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next);
            let module = code.and_then(|code| Module::read(&words(code.p_code.cast(), code.code_size)));
            if let Some(module) = module {
                return module.effects(name, &constants);
            }
            let identified =
                identifier(stage).and_then(|identifier| KnownShaders::of_process().get(identifier));
            identified.map_or(Effects::UNKNOWN, |shaders| shaders.effects(name))
        }
    }
}

/// A stage without code, by an identifier that an earlier launch got.
type ByIdentifier<'a> = vk::PipelineShaderStageModuleIdentifierCreateInfoEXT<'a>;

/// The identifier of a stage without code; `None` for a stage with code.
///
/// # Safety
///
/// The stage and its chain are valid.
unsafe fn identifier<'c>(stage: &vk::PipelineShaderStageCreateInfo<'c>) -> Option<&'c [u8]> {
    // SAFETY: the chain is valid, as `# Safety` demands, with so many bytes.
    unsafe {
        let has_code = stage.module != vk::ShaderModule::null()
            || extension::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next).is_some();
        let by = extension::<ByIdentifier<'_>>(stage.p_next).filter(|_| !has_code)?;
        Some(slice(by.p_identifier, by.identifier_size)).filter(|identifier| !identifier.is_empty())
    }
}

/// Whether a pipeline may be refused until the application comes with the code of its fragment shader, see
/// [`KnownShaders::is_worth_a_request`].
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn lacks_code(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the structure is valid, as `# Safety` demands.
    unsafe {
        flags(info).contains(vk::PipelineCreateFlags2KHR::FAIL_ON_PIPELINE_COMPILE_REQUIRED)
            && fragment_stage(info)
                .and_then(|stage| identifier(stage))
                .is_some_and(|identifier| KnownShaders::of_process().is_worth_a_request(identifier))
    }
}

/// The facts of a module's shaders; `None` if its code is not understood.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn read(info: &vk::ShaderModuleCreateInfo<'_>) -> Option<FragmentShaders> {
    // SAFETY: a valid structure has `code_size` bytes of code.
    FragmentShaders::read(&unsafe { words(info.p_code.cast(), info.code_size) })
}

/// Effects of a fragment shader; unknown for a binary.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn effects_of_object(info: &vk::ShaderCreateInfoEXT<'_>) -> Effects {
    if info.code_type != vk::ShaderCodeTypeEXT::SPIRV {
        return Effects::UNKNOWN;
    }
    // SAFETY: a valid structure has `code_size` bytes of code, here of SPIR-V, and a name.
    unsafe {
        let words = words(info.p_code, info.code_size);
        let name = CStr::from_ptr(info.p_name).to_str();
        let constants = Specialization::read(info.p_specialization_info);
        let module = Module::read(&words).zip(name.ok());
        module.map_or(Effects::UNKNOWN, |(module, name)| module.effects(name, &constants))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vk::shaders::effects::tests::plain_shader;

    /// As in the second launch of a game of DXVK.
    #[test]
    fn a_stage_by_identifier_is_known_once_its_code_was_seen() {
        let effects = |identifier: &[u8]| {
            let mut by = ByIdentifier::default().identifier(identifier);
            let stage = vk::PipelineShaderStageCreateInfo::default().name(c"main").push_next(&mut by);
            // SAFETY: a valid stage without a module.
            unsafe { ShaderModules::default().effects(&stage) }
        };
        assert_eq!(effects(b"of shader_modules.rs"), Effects::UNKNOWN);
        let shaders = Arc::new(FragmentShaders::read(&plain_shader()).unwrap());
        KnownShaders::of_process().note(b"of shader_modules.rs", &shaders);
        assert_eq!(effects(b"of shader_modules.rs"), Effects::default());
        assert_eq!((effects(b""), effects(b"another")), (Effects::UNKNOWN, Effects::UNKNOWN));
    }

    #[test]
    fn code_at_an_odd_address_is_read() {
        let code = plain_shader();
        let mut memory = vec![0u32; code.len() + 1];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut memory);
        for offset in 0..4 {
            bytes[offset..offset + code.len() * 4].copy_from_slice(bytemuck::cast_slice(&code));
            let info = vk::ShaderModuleCreateInfo {
                p_code: bytes[offset..].as_ptr().cast(),
                code_size: code.len() * 4,
                ..Default::default()
            };
            // SAFETY: the structure is valid but for the alignment of its code.
            let shaders = unsafe { read(&info) }.unwrap();
            assert_eq!(shaders.effects("main"), Effects::default(), "at an offset of {offset} bytes");
        }
    }

    /// Applications include compiled shaders as bytes, at any address.
    #[test]
    fn code_of_a_shader_object_at_an_odd_address_is_read() {
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
            let effects = unsafe { effects_of_object(&info) };
            assert_eq!(effects, Effects::default(), "at an offset of {offset} bytes");
        }
    }
}
