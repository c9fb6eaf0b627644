//! Graphics pipelines: each may be used with a rate attachment, and obeys it unless it must shade every pixel.

use super::capabilities::RateCapabilities;
use crate::abi::copies::{Copies, find, slice};
use crate::vk::shaders::parts::{Parts, dynamic_states, flags, is_discarded, libraries, own_parts};
use ash::vk;

/// The rate of a pipeline, after our additions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PipelineRate {
    /// In the pipeline itself, or in the libraries that it is linked from.
    Fixed,
    /// None, as a library without shading has none; a pipeline that is linked from it must shade every pixel.
    NeedsEveryPixel,
    /// To be set when the pipeline is bound, to 1x1 with this second combiner: the parts of a linked pipeline must have
    /// the same rate, and the one that knows the fragment shader is not the only one that has a rate.
    AtBind(vk::FragmentShadingRateCombinerOpKHR),
    /// The application sets it by a command. Whether the pipeline must shade every pixel.
    Application {
        /// Whether it must.
        every_pixel: bool,
    },
}

/// The parts that have a rate.
const SHADING: Parts =
    Parts::from_raw(Parts::PRE_RASTERIZATION_SHADERS.as_raw() | Parts::FRAGMENT_SHADER.as_raw());

/// The pipeline with the additions that make it obey rate attachments, and its rate.
///
/// `every_pixel`: whether its own parts must not be coarser than 1x1. `has_own_attachment`: [`has_flag`], from before the first pipeline of the call
/// was amended, as pipelines may share a chain. `linked` returns the rate of a library. A render pass that
/// `is_left_alone` has no rate attachment of ours: the rate stays unchanged. So does the default rate in dynamic rendering, if the application sets the flag for an
/// attachment of its own.
///
/// # Safety
///
/// `info` and its chain are valid (valid usage of vkCreateGraphicsPipelines) and outlive `copies`, and the chain is not used elsewhere
/// meanwhile. The result points to memory of both.
pub unsafe fn with_rates<'c>(
    info: &vk::GraphicsPipelineCreateInfo<'c>,
    capabilities: &RateCapabilities,
    (every_pixel, has_own_attachment): (bool, bool),
    linked: impl Fn(vk::Pipeline) -> Option<PipelineRate>,
    is_left_alone: impl Fn(vk::RenderPass) -> bool,
    copies: &mut Copies<'_>,
) -> (vk::GraphicsPipelineCreateInfo<'c>, PipelineRate) {
    let is_left_alone = is_left_alone(info.render_pass);
    // SAFETY: the structure and its chain are valid, as `# Safety` demands.
    let (own, libraries, (flags, p_next)) =
        unsafe { (own_parts(info), libraries(info), with_flag(info, copies)) };
    let mut amended = vk::GraphicsPipelineCreateInfo { flags, p_next, ..*info };
    let inherited = libraries.iter().filter_map(|&library| linked(library)).reduce(more_careful);
    if !own.intersects(SHADING) {
        let rate = if every_pixel { PipelineRate::NeedsEveryPixel } else { PipelineRate::Fixed };
        return (amended, merged(inherited, rate));
    }
    // SAFETY: as above; state of its own parts is valid.
    let (sets_rates, is_fixed) = unsafe { (sets_rates(info), has_own_rate(info) || is_discarded(info, own)) };
    if sets_rates {
        return (amended, merged(inherited, PipelineRate::Application { every_pixel }));
    }
    if is_fixed {
        // The parts of a linked pipeline must have the same state, so only a whole pipeline is amended.
        if every_pixel && own.contains(SHADING) && !is_left_alone {
            // SAFETY: the chain is valid, as above.
            amended.p_next = unsafe { without_attachment_rate(amended.p_next, copies) };
        }
        return (amended, merged(inherited, PipelineRate::Fixed));
    }
    if is_left_alone {
        return (amended, merged(inherited, PipelineRate::Fixed));
    }
    let combiner =
        if every_pixel { vk::FragmentShadingRateCombinerOpKHR::KEEP } else { capabilities.combiner() };
    // A library without output interface may be linked with one that needs every pixel.
    if own.contains(SHADING | Parts::FRAGMENT_OUTPUT_INTERFACE) {
        if !every_pixel && !has_own_attachment {
            // SAFETY: the amended chain is as valid as the application's.
            amended.p_next = unsafe { with_combiner(amended.p_next, combiner, copies) };
        }
        return (amended, PipelineRate::Fixed);
    }
    // SAFETY: the dynamic state is null or valid, as above.
    amended.p_dynamic_state = unsafe { with_dynamic_rate(info, copies) };
    (amended, merged(inherited, PipelineRate::AtBind(combiner)))
}

fn merged(inherited: Option<PipelineRate>, own: PipelineRate) -> PipelineRate {
    inherited.map_or(own, |inherited| more_careful(inherited, own))
}

/// The rate of a pipeline from two parts: KEEP wins over other combiners, and a dynamic rate over a fixed one.
fn more_careful(some: PipelineRate, other: PipelineRate) -> PipelineRate {
    use PipelineRate::{Application, AtBind, Fixed, NeedsEveryPixel};
    match (some, other) {
        (NeedsEveryPixel, NeedsEveryPixel | Fixed) | (Fixed, NeedsEveryPixel) => NeedsEveryPixel,
        (NeedsEveryPixel, AtBind(_)) | (AtBind(_), NeedsEveryPixel) => {
            AtBind(vk::FragmentShadingRateCombinerOpKHR::KEEP)
        }
        (NeedsEveryPixel, Application { .. }) | (Application { .. }, NeedsEveryPixel) => {
            Application { every_pixel: true }
        }
        (Application { every_pixel: a }, Application { every_pixel: b }) => {
            Application { every_pixel: a || b }
        }
        (Application { every_pixel }, AtBind(combiner)) | (AtBind(combiner), Application { every_pixel }) => {
            let keeps = combiner == vk::FragmentShadingRateCombinerOpKHR::KEEP;
            Application { every_pixel: every_pixel || keeps }
        }
        (AtBind(a), AtBind(b)) => AtBind(if a == vk::FragmentShadingRateCombinerOpKHR::KEEP { a } else { b }),
        (Fixed, set) | (set, Fixed) => set,
    }
}

/// For passes with a rate attachment.
const FLAG: vk::PipelineCreateFlags = vk::PipelineCreateFlags::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;

/// [`FLAG`] in the second kind of flags.
const FLAG2: vk::PipelineCreateFlags2KHR = vk::PipelineCreateFlags2KHR::from_raw(FLAG.as_raw() as u64);

/// Whether the application itself gives the pipeline [`FLAG`].
///
/// # Safety
///
/// As for [`with_rates`].
pub unsafe fn has_flag(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe { flags(info) }.contains(FLAG2)
}

/// The flags and the chain with `VK_PIPELINE_CREATE_RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_BIT_KHR`: a chained
/// `VkPipelineCreateFlags2CreateInfo` replaces the flags.
///
/// # Safety
///
/// As for [`with_rates`].
unsafe fn with_flag(
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    copies: &mut Copies<'_>,
) -> (vk::PipelineCreateFlags, *const std::ffi::c_void) {
    type Flags2<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        if find::<Flags2<'_>>(info.p_next).is_some() {
            return (info.flags, copies.amend::<Flags2<'_>>(info.p_next, |flags| flags.flags |= FLAG2));
        }
    }
    (info.flags | FLAG, info.p_next)
}

/// The chain with a rate of 1x1 that the attachment's is combined with.
///
/// # Safety
///
/// As for [`with_rates`].
unsafe fn with_combiner(
    p_next: *const std::ffi::c_void,
    combiner: vk::FragmentShadingRateCombinerOpKHR,
    copies: &mut Copies<'_>,
) -> *const std::ffi::c_void {
    type Rate<'a> = vk::PipelineFragmentShadingRateStateCreateInfoKHR<'a>;
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        if find::<Rate<'_>>(p_next).is_some() {
            return copies.amend::<Rate<'_>>(p_next, |rate| rate.combiner_ops[1] = combiner);
        }
        let rate = Rate {
            p_next,
            fragment_size: vk::Extent2D { width: 1, height: 1 },
            combiner_ops: [vk::FragmentShadingRateCombinerOpKHR::KEEP, combiner],
            ..Default::default()
        };
        copies.one(rate).cast_const().cast()
    }
}

/// The chain with the application's rate, except for the attachment's: see [`without_attachment`].
///
/// # Safety
///
/// As for [`with_rates`].
unsafe fn without_attachment_rate(
    p_next: *const std::ffi::c_void,
    copies: &mut Copies<'_>,
) -> *const std::ffi::c_void {
    type Rate<'a> = vk::PipelineFragmentShadingRateStateCreateInfoKHR<'a>;
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        match find::<Rate<'_>>(p_next) {
            None => p_next,
            Some(_) => copies.amend::<Rate<'_>>(p_next, |rate| {
                (rate.fragment_size, rate.combiner_ops) =
                    without_attachment(rate.fragment_size, rate.combiner_ops);
            }),
        }
    }
}

/// The rate with the same effect in passes without attachment, where the attachment's rate counts as 1x1, and with that effect in all other passes.
///
/// Source: Vulkan specification, "Combining the Fragment Shading Rates".
pub fn without_attachment(
    size: vk::Extent2D,
    combiners: [vk::FragmentShadingRateCombinerOpKHR; 2],
) -> (vk::Extent2D, [vk::FragmentShadingRateCombinerOpKHR; 2]) {
    use vk::FragmentShadingRateCombinerOpKHR as Combiner;
    match combiners[1] {
        Combiner::REPLACE | Combiner::MIN => (vk::Extent2D { width: 1, height: 1 }, [Combiner::KEEP; 2]),
        _ => (size, [combiners[0], Combiner::KEEP]),
    }
}

/// The dynamic state with the rate added.
///
/// # Safety
///
/// As for [`with_rates`].
unsafe fn with_dynamic_rate<'c>(
    info: &vk::GraphicsPipelineCreateInfo<'c>,
    copies: &mut Copies<'_>,
) -> *const vk::PipelineDynamicStateCreateInfo<'c> {
    // SAFETY: the structure is valid, as `# Safety` demands.
    unsafe {
        let was = info.p_dynamic_state.as_ref().copied().unwrap_or_default();
        let states = slice(was.p_dynamic_states, was.dynamic_state_count).iter().copied();
        let all: Vec<_> = states.chain([vk::DynamicState::FRAGMENT_SHADING_RATE_KHR]).collect();
        let amended = vk::PipelineDynamicStateCreateInfo {
            dynamic_state_count: all.len() as u32,
            p_dynamic_states: copies.many(all.iter().copied()),
            ..was
        };
        copies.one(amended)
    }
}

/// Whether the application sets the pipeline's rate by a command.
///
/// # Safety
///
/// The structure is valid.
unsafe fn sets_rates(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the structure is valid, as `# Safety` demands.
    unsafe { dynamic_states(info) }.contains(&vk::DynamicState::FRAGMENT_SHADING_RATE_KHR)
}

/// Whether the application gives the pipeline a rate that is not the default, 1x1 without attachment.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn has_own_rate(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        let rate = find::<vk::PipelineFragmentShadingRateStateCreateInfoKHR<'_>>(info.p_next);
        rate.is_some_and(|rate| !is_default(rate.fragment_size, rate.combiner_ops))
            || find::<vk::PipelineFragmentShadingRateEnumStateCreateInfoNV<'_>>(info.p_next).is_some()
    }
}

/// Whether a rate is the default, that of a pipeline without a rate.
pub fn is_default(size: vk::Extent2D, combiners: [vk::FragmentShadingRateCombinerOpKHR; 2]) -> bool {
    (size.width, size.height) == (1, 1) && combiners == [vk::FragmentShadingRateCombinerOpKHR::KEEP; 2]
}

#[cfg(test)]
mod tests;
