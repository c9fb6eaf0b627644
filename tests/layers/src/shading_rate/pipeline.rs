//! Graphics pipelines: flag, rate and dynamic state are taken out, and checked.

use super::chain::{LeftOut, find, slice};
use super::findings::Findings;
use super::lower::PIPELINE_FLAG;
use super::rate::{PIPELINE_RATE, Rate};
use super::render_pass::RenderPass;
use super::state::State;
use super::{Emulator, emulator};
use ash::vk;
use std::sync::Arc;

pub(super) struct Pipeline {
    /// Whether it may be used in dynamic rendering with a rate attachment.
    pub flagged: bool,
    pub rate: Rate,
    /// Whether the rate is set by a command instead.
    pub dynamic: bool,
    /// None with dynamic rendering.
    pub render_pass: Option<(Arc<RenderPass>, u32)>,
    /// The parts that a library has; all of them where it is none.
    parts: vk::GraphicsPipelineLibraryFlagsEXT,
}

const KIND: &str = "pipeline";
const SHADING: [vk::GraphicsPipelineLibraryFlagsEXT; 2] = [
    vk::GraphicsPipelineLibraryFlagsEXT::PRE_RASTERIZATION_SHADERS,
    vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_SHADER,
];

/// Flags of 64 bits; newer extensions use the upper half.
type WideFlags<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;

/// # Safety
/// As `vkCreateGraphicsPipelines`.
pub(super) unsafe extern "system" fn create(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: the application's valid arguments, without the extension's structures; everything is read before
    // anything is left out, because structures can be in several chains, and the copies live until it is put back.
    unsafe {
        let emulator = emulator(device);
        let infos = slice(infos, count);
        let known: Vec<_> = infos.iter().map(|info| describe(&emulator.state(), info)).collect();
        let mut lowered = infos.to_vec();
        let states: Vec<Vec<_>> = infos.iter().map(|info| other_dynamic_states(info)).collect();
        let mut dynamic: Vec<_> = infos.iter().map(|info| info.p_dynamic_state.as_ref().copied()).collect();
        let mut left_out = LeftOut::new();
        let mut changed = Vec::new();
        for ((info, dynamic), states) in lowered.iter_mut().zip(&mut dynamic).zip(&states) {
            info.flags = flags(info) & !PIPELINE_FLAG;
            match find::<WideFlags<'_>>(info.p_next).filter(|wide| wide.flags.as_raw() >> 32 != 0) {
                Some(wide) => {
                    let at = std::ptr::from_ref(wide).cast_mut();
                    changed.push((at, wide.flags));
                    let without = wide.flags.as_raw() & !u64::from(PIPELINE_FLAG.as_raw());
                    (*at).flags = vk::PipelineCreateFlags2KHR::from_raw(without);
                }
                None => left_out.leave_out(info, vk::StructureType::PIPELINE_CREATE_FLAGS_2_CREATE_INFO_KHR),
            }
            let rate = vk::StructureType::PIPELINE_FRAGMENT_SHADING_RATE_STATE_CREATE_INFO_KHR;
            left_out.leave_out(info, rate);
            if let Some(dynamic) = dynamic {
                dynamic.dynamic_state_count = states.len() as u32;
                dynamic.p_dynamic_states = states.as_ptr();
                info.p_dynamic_state = dynamic;
            }
        }
        let next = emulator.v1_0().create_graphics_pipelines;
        let result = next(device, cache, count, lowered.as_ptr(), allocator, pipelines);
        drop(left_out);
        // Backwards: one structure may be in several chains.
        changed.into_iter().rev().for_each(|(at, flags)| (*at).flags = flags);
        let mut state = emulator.state();
        for ((info, known), &handle) in infos.iter().zip(known).zip(slice(pipelines.cast_const(), count)) {
            check(&emulator, &mut state, info, &known, handle);
            if handle != vk::Pipeline::null() {
                state.pipelines.insert(handle, Arc::new(known));
            }
        }
        result
    }
}

/// Effective flags: VkPipelineCreateFlags2CreateInfoKHR's if it is chained.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn flags(info: &vk::GraphicsPipelineCreateInfo<'_>) -> vk::PipelineCreateFlags {
    // SAFETY: the caller vouches for it.
    let wide = unsafe { find::<WideFlags<'_>>(info.p_next) };
    wide.map_or(info.flags, |wide| vk::PipelineCreateFlags::from_raw(wide.flags.as_raw() as u32))
}

/// # Safety
///
/// The structure is valid.
unsafe fn dynamic_states<'a>(info: &vk::GraphicsPipelineCreateInfo<'a>) -> &'a [vk::DynamicState] {
    // SAFETY: the caller vouches for it.
    unsafe {
        let state = info.p_dynamic_state.as_ref();
        state.map_or(&[], |state| slice(state.p_dynamic_states, state.dynamic_state_count))
    }
}

/// # Safety
///
/// The structure is valid.
unsafe fn other_dynamic_states(info: &vk::GraphicsPipelineCreateInfo<'_>) -> Vec<vk::DynamicState> {
    // SAFETY: the caller vouches for it.
    let all = unsafe { dynamic_states(info) };
    all.iter().copied().filter(|&state| state != vk::DynamicState::FRAGMENT_SHADING_RATE_KHR).collect()
}

/// The libraries that a pipeline is linked from.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn libraries(state: &State, info: &vk::GraphicsPipelineCreateInfo<'_>) -> Vec<Arc<Pipeline>> {
    // SAFETY: the caller vouches for it.
    let handles = unsafe {
        find::<vk::PipelineLibraryCreateInfoKHR<'_>>(info.p_next)
            .map_or(&[][..], |libraries| slice(libraries.p_libraries, libraries.library_count))
    };
    handles.iter().filter_map(|handle| state.pipelines.get(handle).cloned()).collect()
}

/// The parts that the structure itself has.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn own_parts(info: &vk::GraphicsPipelineCreateInfo<'_>) -> vk::GraphicsPipelineLibraryFlagsEXT {
    // SAFETY: the caller vouches for it.
    unsafe {
        if let Some(library) = find::<vk::GraphicsPipelineLibraryCreateInfoEXT<'_>>(info.p_next) {
            library.flags
        } else if find::<vk::PipelineLibraryCreateInfoKHR<'_>>(info.p_next)
            .is_some_and(|libraries| libraries.library_count != 0)
        {
            vk::GraphicsPipelineLibraryFlagsEXT::empty()
        } else {
            SHADING[0] | SHADING[1]
        }
    }
}

/// # Safety
///
/// The structure's chain is valid.
unsafe fn rate_of(info: &vk::GraphicsPipelineCreateInfo<'_>) -> Option<Rate> {
    // SAFETY: the caller vouches for it.
    let state = unsafe { find::<vk::PipelineFragmentShadingRateStateCreateInfoKHR<'_>>(info.p_next) };
    state.map(|state| Rate { size: state.fragment_size, combiners: state.combiner_ops })
}

/// # Safety
///
/// The structure's chain is valid.
unsafe fn describe(state: &State, info: &vk::GraphicsPipelineCreateInfo<'_>) -> Pipeline {
    // SAFETY: the caller vouches for it.
    unsafe {
        let libraries = libraries(state, info);
        let own = own_parts(info);
        let shading = |parts: vk::GraphicsPipelineLibraryFlagsEXT| parts.intersects(SHADING[0] | SHADING[1]);
        let inherited = libraries.iter().find(|library| shading(library.parts));
        let own_rate = rate_of(info).filter(|_| shading(own));
        let render_pass = state.render_passes.get(&info.render_pass);
        Pipeline {
            flagged: flags(info).contains(PIPELINE_FLAG),
            rate: own_rate.or(inherited.map(|library| library.rate)).unwrap_or_default(),
            dynamic: dynamic_states(info).contains(&vk::DynamicState::FRAGMENT_SHADING_RATE_KHR)
                || libraries.iter().any(|library| library.dynamic),
            render_pass: render_pass
                .map(|render_pass| (render_pass.clone(), info.subpass))
                .or_else(|| libraries.iter().find_map(|library| library.render_pass.clone())),
            parts: libraries.iter().fold(own, |parts, library| parts | library.parts),
        }
    }
}

/// # Safety
///
/// The structure's chain is valid.
unsafe fn check(
    emulator: &Emulator,
    state: &mut State,
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    known: &Pipeline,
    pipeline: vk::Pipeline,
) {
    // SAFETY: the caller vouches for it.
    unsafe {
        let libraries = libraries(state, info);
        let findings = &mut state.findings;
        if let Some(rate) = rate_of(info) {
            let rule = "VUID-VkGraphicsPipelineCreateInfo-pNext-pNext";
            findings.require(emulator.enabled.extension, KIND, rule, pipeline, || {
                "VkPipelineFragmentShadingRateStateCreateInfoKHR without the extension".to_owned()
            });
            let used = own_parts(info).intersects(SHADING[0] | SHADING[1]);
            if used && !known.dynamic {
                PIPELINE_RATE.check(emulator, findings, rate, pipeline);
            }
        }
        for (used, what) in [
            (flags(info).contains(PIPELINE_FLAG), "flag"),
            (dynamic_states(info).contains(&vk::DynamicState::FRAGMENT_SHADING_RATE_KHR), "dynamic state"),
        ] {
            let holds = !used || emulator.enabled.extension;
            let rule = "VK_KHR_fragment_shading_rate";
            findings.require(holds, KIND, rule, pipeline, || format!("{what} without the extension"));
        }
        check_libraries(findings, info, &libraries, known, pipeline);
    }
}

/// Both shading parts must have the same rate, and the same flag as the whole.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn check_libraries(
    findings: &mut Findings,
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    libraries: &[Arc<Pipeline>],
    known: &Pipeline,
    pipeline: vk::Pipeline,
) {
    // SAFETY: the caller vouches for it.
    let (own, own_rate) = unsafe { (own_parts(info), rate_of(info).unwrap_or_default()) };
    let shading: Vec<_> =
        libraries.iter().filter(|library| library.parts.intersects(SHADING[0] | SHADING[1])).collect();
    let rates: Vec<Rate> = shading.iter().map(|library| library.rate).collect();
    if own.intersects(SHADING[0] | SHADING[1]) {
        let rule = "VUID-VkGraphicsPipelineCreateInfo-flags-06638";
        let same = rates.iter().all(|rate| *rate == own_rate);
        findings.require(known.dynamic || same, KIND, rule, pipeline, || {
            format!("{own_rate:?}, and in libraries {rates:?}")
        });
    } else {
        let rule = "VUID-VkGraphicsPipelineCreateInfo-pLibraries-06639";
        let same = rates.windows(2).all(|pair| pair[0] == pair[1]);
        findings.require(known.dynamic || same, KIND, rule, pipeline, || format!("{rates:?}"));
    }
    let same = shading.iter().all(|library| library.flagged == known.flagged);
    findings.require(same, KIND, "libraries have the flag of the pipeline", pipeline, || {
        format!("{} in the pipeline, not so in a library", known.flagged)
    });
}

/// # Safety
/// As `vkDestroyPipeline`.
pub(super) unsafe extern "system" fn destroy(
    device: vk::Device,
    pipeline: vk::Pipeline,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        emulator.state().pipelines.remove(&pipeline);
        (emulator.v1_0().destroy_pipeline)(device, pipeline, allocator);
    }
}
