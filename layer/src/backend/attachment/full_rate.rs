//! Causes for which draws stay at 1x1, and their lines in the log.

use super::capabilities::Limits;
use crate::abi::copies::{find, slice};
use crate::status::{Topic, decided};
use crate::vk::shaders::Effects;
use crate::vk::shaders::parts::{Parts, dynamic_states, is_discarded, own_parts};
use ash::vk;
use std::sync::atomic::{AtomicU16, Ordering};

/// A cause for which a draw stays at 1x1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A fragment shader that could not be read.
    Unknown,
    /// Writes of the fragment shader to buffers or images, or its atomics.
    Stores,
    /// Fragment shader interlock.
    Interlock,
    /// Shading per sample.
    PerSample,
    /// Integers in colour attachments.
    Integers,
    /// Discards of the fragment shader, or alpha to coverage.
    Holes,
    /// Depth or stencil from the fragment shader.
    DepthStencil,
    /// The sample mask in the fragment shader.
    ShaderMask,
    /// A sample mask of the pipeline, on a device that cannot combine it with rates.
    PipelineMask,
    /// More samples per pixel than the device shades coarsely.
    Samples,
    /// Custom sample locations, on a device that cannot combine them with rates.
    SampleLocations,
    /// Conservative rasterisation, on a device that cannot combine it with rates.
    Conservative,
}

impl Cause {
    const ALL: [Self; 12] = [
        Self::Unknown,
        Self::Stores,
        Self::Interlock,
        Self::PerSample,
        Self::Integers,
        Self::Holes,
        Self::DepthStencil,
        Self::ShaderMask,
        Self::PipelineMask,
        Self::Samples,
        Self::SampleLocations,
        Self::Conservative,
    ];

    fn bit(self) -> u16 {
        1 << self as u16
    }

    /// The draws, and the consequence of a coarse rate.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Unknown => {
                ("fragment shaders of unknown code", "as they may need an invocation for each pixel")
            }
            Self::Stores => (
                "fragment shaders that write to buffers or images, or use atomics",
                "as a coarse fragment writes once for all of its pixels; rates.coarse_stores = true allows that",
            ),
            Self::Interlock => (
                "fragment shader interlock",
                "as a coarse fragment enters its critical section once for all of its pixels",
            ),
            Self::PerSample => {
                ("shading per sample", "as a coarse fragment has one colour for all of its samples")
            }
            Self::Integers => (
                "integers in colour attachments",
                "as a coarse fragment writes one value, such as an object ID, for all of its pixels",
            ),
            Self::Holes => (
                "alpha test (discard) or alpha to coverage",
                "as one decision for a coarse fragment shows as a block",
            ),
            Self::DepthStencil => (
                "depth or stencil from the fragment shader",
                "as one depth for a coarse fragment fails later depth tests",
            ),
            Self::ShaderMask => (
                "the sample mask in the fragment shader",
                "as a mask made for one pixel covers one pixel of a coarse fragment",
            ),
            Self::PipelineMask => {
                ("a sample mask of the pipeline", "as the device does not combine it with coarse rates")
            }
            Self::Samples => ("many samples per pixel", "as the device shades only fewer samples coarsely"),
            Self::SampleLocations => {
                ("custom sample locations", "as the device does not combine them with coarse rates")
            }
            Self::Conservative => {
                ("conservative rasterisation", "as the device does not combine it with coarse rates")
            }
        }
    }
}

/// Causes for which a draw stays at 1x1, a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Causes(u16);

impl Causes {
    /// Causes in a fragment shader: its effects that count for each pixel.
    ///
    /// Devices may shade coarsely with written depth and sample masks, but no application expects the result: one depth for a block fails an
    /// EQUAL test against a pre-pass (Direct3D 12 shades such shaders at 1x1: its VRS specification, "Export of Depth and Stencil"), and a
    /// mask made for one pixel covers one pixel of a block (Vulkan specification, "Fragment Shading Rates", coverage index).
    pub fn of_shader(effects: Effects) -> Self {
        if effects == Effects::UNKNOWN {
            return Self::default().with(Cause::Unknown, true);
        }
        Self::default()
            .with(Cause::Stores, effects.stores)
            .with(Cause::Interlock, effects.interlocks)
            .with(Cause::PerSample, effects.per_sample)
            .with(Cause::Integers, effects.writes_integers)
            .with(Cause::Holes, effects.discards)
            .with(Cause::DepthStencil, effects.writes_depth_stencil)
            .with(Cause::ShaderMask, effects.uses_sample_mask)
    }

    /// The set with one more cause if it `holds`.
    pub fn with(self, cause: Cause, holds: bool) -> Self {
        Self(self.0 | if holds { cause.bit() } else { 0 })
    }

    /// The union of both sets.
    pub fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// Whether there is one.
    pub fn are_any(self) -> bool {
        self.0 != 0
    }

    /// Lists each cause once in the process.
    pub fn list(self) {
        static LISTED: AtomicU16 = AtomicU16::new(0);
        if self.0 & !LISTED.load(Ordering::Relaxed) == 0 {
            return;
        }
        for cause in Cause::ALL.into_iter().filter(|cause| self.0 & cause.bit() != 0) {
            let (draws, consequence) = cause.words();
            decided(
                Topic::FullRate(draws.to_owned()),
                &format_args!("draws with {draws}: shaded at 1x1, {consequence}"),
            );
        }
        LISTED.fetch_or(self.0, Ordering::Relaxed);
    }
}

/// Causes for which a pipeline must not be coarser than 1x1, in its own parts: its fragment shader has effects that count for each pixel, or
/// the device does not shade coarsely with its state. `effects` returns the effects of a stage's fragment shader.
///
/// # Safety
///
/// The structure is valid (valid usage of vkCreateGraphicsPipelines).
pub unsafe fn causes(
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    limits: &Limits,
    effects: impl Fn(&vk::PipelineShaderStageCreateInfo<'_>) -> Effects,
) -> Causes {
    // SAFETY: the structure is valid, as `# Safety` demands.
    let (own, is_discarded) = unsafe {
        let own = own_parts(info);
        (own, is_discarded(info, own))
    };
    if is_discarded || !own.intersects(Parts::FRAGMENT_SHADER | Parts::FRAGMENT_OUTPUT_INTERFACE) {
        return Causes::default();
    }
    // SAFETY: as above: multisample state is of these parts, and not ignored, as the pipeline rasterises.
    let of_samples = unsafe { of_samples(info, limits) };
    if !own.contains(Parts::FRAGMENT_SHADER) {
        return of_samples;
    }
    // SAFETY: as above: stages are of the part with the fragment shader, rasterisation state of another part.
    let (stages, rasterization) = unsafe {
        let rasterizes = own.contains(Parts::PRE_RASTERIZATION_SHADERS);
        let rasterization = if rasterizes { info.p_rasterization_state.as_ref() } else { None };
        (slice(info.p_stages, info.stage_count), rasterization)
    };
    let fragment = stages.iter().find(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT);
    // SAFETY: rasterisation state is valid, as above.
    let is_conservative = rasterization.is_some_and(|state| unsafe { is_conservative(state) });
    Causes::of_shader(fragment.map_or(Effects::default(), effects))
        .and(of_samples)
        .with(Cause::Conservative, is_conservative && !limits.conservative_rasterization)
}

/// Causes in the samples of a pipeline. Commands may turn alpha to coverage on.
///
/// # Safety
///
/// The structure is valid, with multisample state that is not ignored.
unsafe fn of_samples(info: &vk::GraphicsPipelineCreateInfo<'_>, limits: &Limits) -> Causes {
    // SAFETY: the structure is valid, as `# Safety` demands.
    let (states, state) = unsafe { (dynamic_states(info), info.p_multisample_state.as_ref()) };
    let cuts_by_command = states.contains(&vk::DynamicState::ALPHA_TO_COVERAGE_ENABLE_EXT);
    let causes = Causes::default().with(Cause::Holes, cuts_by_command);
    let Some(state) = state else { return causes };
    let samples = state.rasterization_samples.as_raw();
    // SAFETY: as above; a mask has a bit for each sample, in words of 32.
    let (mask, locations) = unsafe {
        let mask = slice(state.p_sample_mask, samples.div_ceil(32));
        (mask, find::<vk::PipelineSampleLocationsStateCreateInfoEXT<'_>>(state.p_next))
    };
    let all = if samples >= 32 { u32::MAX } else { (1 << samples) - 1 };
    let is_masked = mask.iter().any(|word| word & all != all);
    let has_locations = locations.is_some_and(|locations| locations.sample_locations_enable == vk::TRUE);
    causes
        .with(Cause::PerSample, state.sample_shading_enable == vk::TRUE)
        .with(Cause::Holes, state.alpha_to_coverage_enable == vk::TRUE)
        .with(Cause::Samples, state.rasterization_samples > limits.samples)
        .with(Cause::PipelineMask, is_masked && !limits.sample_mask)
        .with(Cause::SampleLocations, has_locations && !limits.custom_sample_locations)
}

/// # Safety
///
/// The structure is valid.
unsafe fn is_conservative(state: &vk::PipelineRasterizationStateCreateInfo<'_>) -> bool {
    // SAFETY: a valid structure has a valid chain.
    let chained =
        unsafe { find::<vk::PipelineRasterizationConservativeStateCreateInfoEXT<'_>>(state.p_next) };
    chained.is_some_and(|state| {
        state.conservative_rasterization_mode != vk::ConservativeRasterizationModeEXT::DISABLED
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::all_decisions;

    /// A line for each effect, with its cause as the reason.
    #[test]
    fn each_cause_is_listed_once() {
        let none = Effects::default();
        let each = [
            (Effects::UNKNOWN, "unknown code"),
            (Effects { stores: true, ..none }, "write to buffers or images"),
            (Effects { interlocks: true, ..none }, "interlock"),
            (Effects { per_sample: true, ..none }, "per sample"),
            (Effects { writes_integers: true, ..none }, "integers"),
            (Effects { discards: true, ..none }, "alpha test (discard)"),
            (Effects { writes_depth_stencil: true, ..none }, "depth or stencil"),
            (Effects { uses_sample_mask: true, ..none }, "sample mask in the fragment shader"),
        ];
        assert!(!Causes::of_shader(none).are_any());
        for (effects, named) in each {
            for _ in 0..2 {
                Causes::of_shader(effects).list();
            }
            let lines: Vec<_> =
                all_decisions().into_iter().filter(|decision| decision.line.contains(named)).collect();
            let [line] = &lines[..] else { panic!("{named}: {lines:?}") };
            assert!(line.topic.reason().contains(named), "{line:?}");
            assert!(line.line.contains("shaded at 1x1"), "{line:?}");
        }
    }

    #[test]
    fn causes_differ_by_their_bits_and_words() {
        let bits = Cause::ALL.map(Cause::bit);
        assert_eq!(bits.iter().fold(0, |all, bit| all | bit).count_ones() as usize, Cause::ALL.len());
        for (index, cause) in Cause::ALL.into_iter().enumerate() {
            assert!(Cause::ALL[..index].iter().all(|other| other.words().0 != cause.words().0), "{cause:?}");
        }
    }
}
