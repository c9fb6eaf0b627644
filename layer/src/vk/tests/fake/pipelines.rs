//! A driver that refuses pipelines and shaders with the additions for rate attachments.

use crate::abi::copies::{find, slice};
use ash::vk::{self, Handle};
use std::cell::{Cell, RefCell};
use std::ffi::CStr;

thread_local! {
    static ANSWERS: Cell<[vk::Result; 2]> = const { Cell::new([vk::Result::SUCCESS; 2]) };
    static FIRST: Cell<Option<vk::Result>> = const { Cell::new(None) };
    static COMBINERS: RefCell<Vec<Combiners>> = const { RefCell::new(Vec::new()) };
    static SEEN: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// The combiners of a pipeline's rate; `None` without a rate.
pub type Combiners = Option<[vk::FragmentShadingRateCombinerOpKHR; 2]>;

/// From now on, creation on this thread returns the first result with the additions for rate attachments, and the second without.
pub fn answer(amended: vk::Result, plain: vk::Result) {
    ANSWERS.set([amended, plain]);
}

/// The next creation on this thread with the additions for rate attachments, and no other, returns this result.
pub fn answer_first(amended: vk::Result) {
    FIRST.set(Some(amended));
}

/// The combiners of the last call's pipelines.
pub fn combiners() -> Vec<Combiners> {
    COMBINERS.with_borrow(Clone::clone)
}

/// Creations and destructions on this thread since the last call.
pub fn seen() -> Vec<String> {
    SEEN.take()
}

/// The stand-in's function of that name, if it is one of these.
pub fn function(name: &CStr) -> Option<unsafe extern "system" fn()> {
    let address = match name.to_bytes() {
        b"vkCreateGraphicsPipelines" => create_pipelines as vk::PFN_vkCreateGraphicsPipelines as *const (),
        b"vkDestroyPipeline" => destroy_pipeline as vk::PFN_vkDestroyPipeline as *const (),
        b"vkCreateShadersEXT" => create_shaders as vk::PFN_vkCreateShadersEXT as *const (),
        b"vkDestroyShaderEXT" => destroy_shader as vk::PFN_vkDestroyShaderEXT as *const (),
        b"vkCreateShaderModule" => create_module as vk::PFN_vkCreateShaderModule as *const (),
        b"vkGetShaderModuleIdentifierEXT" => {
            identify_module as vk::PFN_vkGetShaderModuleIdentifierEXT as *const ()
        }
        b"vkGetShaderModuleCreateInfoIdentifierEXT" => {
            identify as vk::PFN_vkGetShaderModuleCreateInfoIdentifierEXT as *const ()
        }
        _ => return None,
    };
    // SAFETY: the address of a function, carried as PFN_vkVoidFunction and cast back by its name.
    Some(unsafe { std::mem::transmute::<*const (), unsafe extern "system" fn()>(address) })
}

/// Writes handles: all but the last if the answer is not a success.
///
/// # Safety
///
/// There is room for that many handles.
unsafe fn create<H: Handle>(is_amended: bool, count: u32, made: *mut H) -> vk::Result {
    let [amended, plain] = ANSWERS.get();
    let answer = if is_amended { FIRST.take().unwrap_or(amended) } else { plain };
    SEEN.with_borrow_mut(|seen| {
        seen.push(format!("{} {count}", if is_amended { "amended" } else { "plain" }));
    });
    for index in 0..count {
        let is_made = answer == vk::Result::SUCCESS || index + 1 < count;
        let handle = if is_made { u64::from(index) + 1 } else { 0 };
        // SAFETY: the caller has room for so many handles.
        unsafe { made.add(index as usize).write(H::from_raw(handle)) };
    }
    answer
}

fn destroy<H: Handle>(handle: H) {
    SEEN.with_borrow_mut(|seen| seen.push(format!("destroy {}", handle.as_raw())));
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_pipelines(
    _: vk::Device,
    _: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Pipeline,
) -> vk::Result {
    let flag = vk::PipelineCreateFlags::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
    // SAFETY: valid usage, with at least one structure.
    unsafe {
        let rates = slice(infos, count)
            .iter()
            .map(|info| find::<vk::PipelineFragmentShadingRateStateCreateInfoKHR<'_>>(info.p_next));
        COMBINERS.set(rates.map(|rate| rate.map(|rate| rate.combiner_ops)).collect());
        create((*infos).flags.contains(flag), count, made)
    }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_pipeline(
    _: vk::Device,
    pipeline: vk::Pipeline,
    _: *const vk::AllocationCallbacks<'_>,
) {
    destroy(pipeline);
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_shaders(
    _: vk::Device,
    count: u32,
    infos: *const vk::ShaderCreateInfoEXT<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::ShaderEXT,
) -> vk::Result {
    let flag = vk::ShaderCreateFlagsEXT::FRAGMENT_SHADING_RATE_ATTACHMENT;
    // SAFETY: valid usage, with at least one structure.
    unsafe { create((*infos).flags.contains(flag), count, made) }
}

/// The identifier of code that comes without a module.
pub const IDENTIFIER: &[u8] = b"of the stand-in";

/// The identifier of such code of zeros, which is none.
pub const OF_ZEROS: &[u8] = b"of zeros";

/// The identifier of every module.
pub const OF_MODULE: &[u8] = b"of a module";

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_module(
    _: vk::Device,
    _: *const vk::ShaderModuleCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    module: *mut vk::ShaderModule,
) -> vk::Result {
    // SAFETY: valid usage.
    unsafe { module.write(vk::ShaderModule::from_raw(1)) };
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn identify_module(
    _: vk::Device,
    _: vk::ShaderModule,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    // SAFETY: valid usage.
    write_identifier(OF_MODULE, unsafe { &mut *identifier });
}

fn write_identifier(bytes: &[u8], identifier: &mut vk::ShaderModuleIdentifierEXT<'_>) {
    identifier.identifier_size = bytes.len() as u32;
    identifier.identifier[..bytes.len()].copy_from_slice(bytes);
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn identify(
    _: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    // SAFETY: valid usage, with at least one word of code.
    let (first, identifier) = unsafe { (*(*info).p_code, &mut *identifier) };
    write_identifier(if first == 0 { OF_ZEROS } else { IDENTIFIER }, identifier);
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_shader(
    _: vk::Device,
    shader: vk::ShaderEXT,
    _: *const vk::AllocationCallbacks<'_>,
) {
    destroy(shader);
}
