//! Rates that are set by commands: the application's rates, and the rates of pipelines that are linked from parts.

use super::pipeline::{PipelineRate, is_default, without_attachment};
use crate::vk::table::Table;
use ash::vk::{self, FragmentShadingRateCombinerOpKHR as Combiner};

/// A rate as vkCmdSetFragmentShadingRateKHR sets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetRate {
    /// Size of a fragment, pixels.
    pub size: vk::Extent2D,
    /// Combiners with the rates of primitives, and of the attachment.
    pub combiners: [Combiner; 2],
}

/// The rate of a command buffer. A rate need not be forgotten when recording begins again: before it draws, the application sets its rate
/// again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Recorded {
    /// The rate that the application has set.
    rate: Option<SetRate>,
    /// The second combiner of a rate of ours, which was set after that of the application.
    bound: Option<Combiner>,
    /// Whether the bound shaders must shade every pixel.
    every_pixel: bool,
    /// Whether the pass has the application's own rate attachment, or none.
    is_left_alone: bool,
    /// Whether a pipeline with a rate of its own is bound, which no command may change (VUID-vkCmdDraw-None-08608).
    is_fixed: bool,
}

/// The rates that are set in the command buffers of a device.
pub struct SetRates {
    recorded: Table<vk::CommandBuffer, Recorded>,
    /// The second combiner of pipelines that obey the attachment.
    combiner: Combiner,
    /// Whether the application enables rates of its own, so that it sets them where it must.
    by_application: bool,
    /// Whether passes may have rate attachments of the application's own.
    has_own_attachments: bool,
}

impl SetRates {
    /// Nothing is set yet.
    pub fn new(combiner: Combiner, by_application: bool, has_own_attachments: bool) -> Self {
        Self { recorded: Table::default(), combiner, by_application, has_own_attachments }
    }

    /// Whether the rate depends on the pass, so that [`Self::recording_begins`] and [`Self::pass_begins`] have to be called.
    pub fn depend_on_pass(&self) -> bool {
        self.has_own_attachments
    }

    /// The recording of a command buffer begins: outside of passes, or in a secondary command buffer within one that may be left alone.
    pub fn recording_begins(&self, buffer: vk::CommandBuffer, is_left_alone: bool) {
        self.recorded.insert(buffer, Recorded { is_left_alone, ..Recorded::default() });
    }

    /// A command buffer is about to be freed.
    pub fn forget(&self, buffer: vk::CommandBuffer) {
        self.recorded.remove(buffer);
    }

    /// A pass begins: the rate to set for it, if that changes the one that is set. In a pass that `is_left_alone`, which has the application's
    /// own rate attachment or none, the application's own rate counts.
    pub fn pass_begins(&self, buffer: vk::CommandBuffer, is_left_alone: bool) -> Option<SetRate> {
        let was = self.recorded.get(buffer).unwrap_or_default();
        if was.is_left_alone == is_left_alone {
            return None;
        }
        let is = Recorded { is_left_alone, ..was };
        self.recorded.insert(buffer, is);
        let rate = self.in_force(is).filter(|_| !is.is_fixed)?;
        (self.in_force(was) != Some(rate)).then_some(rate)
    }

    /// The application sets a rate: the one to set instead.
    pub fn set(&self, buffer: vk::CommandBuffer, rate: SetRate) -> SetRate {
        let mut recorded = self.recorded.get(buffer).unwrap_or_default();
        recorded.rate = Some(rate);
        recorded.bound = None;
        self.recorded.insert(buffer, recorded);
        self.obeying(rate, recorded)
    }

    /// A graphics pipeline of this rate is bound: the rate to set then, if any.
    pub fn bound(&self, buffer: vk::CommandBuffer, pipeline: PipelineRate) -> Option<SetRate> {
        match pipeline {
            PipelineRate::Fixed | PipelineRate::NeedsEveryPixel => {
                self.fixed(buffer);
                None
            }
            PipelineRate::AtBind(combiner) => Some(self.full_rate_in_pass(buffer, combiner)),
            PipelineRate::Application { every_pixel } => self.pixels_needed(buffer, every_pixel),
        }
    }

    /// A pipeline with a rate of its own is bound.
    fn fixed(&self, buffer: vk::CommandBuffer) {
        if !self.has_own_attachments {
            return;
        }
        let was = self.recorded.get(buffer).unwrap_or_default();
        if !was.is_fixed {
            self.recorded.insert(buffer, Recorded { is_fixed: true, ..was });
        }
    }

    /// A fragment shader without a pipeline is bound: the rate to set then, if any.
    pub fn bound_shader(&self, buffer: vk::CommandBuffer, every_pixel: bool) -> Option<SetRate> {
        if self.by_application {
            return self.pixels_needed(buffer, every_pixel);
        }
        Some(self.full_rate_in_pass(buffer, if every_pixel { Combiner::KEEP } else { self.combiner }))
    }

    /// The rate of a pipeline without one of the application's, with this second combiner in passes with our attachment.
    fn full_rate_in_pass(&self, buffer: vk::CommandBuffer, combiner: Combiner) -> SetRate {
        if !self.has_own_attachments {
            return full_rate(combiner);
        }
        let was = self.recorded.get(buffer).unwrap_or_default();
        let is = Recorded { bound: Some(combiner), is_fixed: false, ..was };
        if is != was {
            self.recorded.insert(buffer, is);
        }
        bound_rate(combiner, is.is_left_alone)
    }

    /// The bound shaders must shade every pixel, or need not: the rate to set, if that changes the one that is set.
    fn pixels_needed(&self, buffer: vk::CommandBuffer, every_pixel: bool) -> Option<SetRate> {
        let mut recorded = self.recorded.get(buffer).unwrap_or_default();
        // A pass that began meanwhile has not set its rate.
        if recorded.every_pixel == every_pixel && !recorded.is_fixed {
            return None;
        }
        (recorded.every_pixel, recorded.is_fixed) = (every_pixel, false);
        recorded.bound = None;
        self.recorded.insert(buffer, recorded);
        self.in_force(recorded)
    }

    /// The rate that is set in a command buffer; `None` before the first one.
    fn in_force(&self, recorded: Recorded) -> Option<SetRate> {
        match recorded.bound {
            Some(combiner) => Some(bound_rate(combiner, recorded.is_left_alone)),
            None => recorded.rate.map(|rate| self.obeying(rate, recorded)),
        }
    }

    /// The rate to set where the application sets `rate`: if that is the default, the attachment is obeyed. If every pixel must be shaded,
    /// the attachment is ignored, even if the application's own rate combines with it: then that counts on 1x1.
    fn obeying(&self, rate: SetRate, recorded: Recorded) -> SetRate {
        if recorded.is_left_alone {
            return rate;
        }
        if recorded.every_pixel {
            let (size, combiners) = without_attachment(rate.size, rate.combiners);
            return SetRate { size, combiners };
        }
        if !is_default(rate.size, rate.combiners) {
            return rate;
        }
        SetRate { combiners: [Combiner::KEEP, self.combiner], ..rate }
    }
}

/// The rate of a pipeline without one of the application's: it obeys no attachment of the application's own.
const fn bound_rate(combiner: Combiner, is_left_alone: bool) -> SetRate {
    full_rate(if is_left_alone { Combiner::KEEP } else { combiner })
}

/// 1x1, combined so with the attachment's rate.
const fn full_rate(combiner: Combiner) -> SetRate {
    SetRate { size: vk::Extent2D { width: 1, height: 1 }, combiners: [Combiner::KEEP, combiner] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    const OBEYS: SetRate = full_rate(Combiner::MAX);
    const KEEPS: SetRate = full_rate(Combiner::KEEP);

    fn buffer(number: u64) -> vk::CommandBuffer {
        vk::CommandBuffer::from_raw(number)
    }

    fn by_application() -> SetRates {
        SetRates::new(Combiner::MAX, true, true)
    }

    #[test]
    fn the_default_obeys_and_an_applications_own_rate_stays() {
        let rates = by_application();
        assert_eq!(rates.set(buffer(1), KEEPS), OBEYS);
        let coarse = SetRate { size: vk::Extent2D { width: 2, height: 1 }, ..KEEPS };
        let replaced = SetRate { combiners: [Combiner::KEEP, Combiner::REPLACE], ..KEEPS };
        for own in [coarse, replaced] {
            assert_eq!(rates.set(buffer(1), own), own);
        }
    }

    /// With the rate or the pipeline first, in each of two command buffers.
    #[test]
    fn per_pixel_shaders_keep_the_default_rate() {
        let rates = by_application();
        let (careful, other) = (
            PipelineRate::Application { every_pixel: true },
            PipelineRate::Application { every_pixel: false },
        );
        assert_eq!(rates.bound(buffer(1), careful), None, "nothing is set that could be changed");
        assert_eq!(rates.set(buffer(1), KEEPS), KEEPS);
        assert_eq!(rates.set(buffer(2), KEEPS), OBEYS);
        assert_eq!(rates.bound(buffer(1), other), Some(OBEYS));
        assert_eq!(rates.bound(buffer(1), other), None);
        assert_eq!(rates.bound(buffer(1), careful), Some(KEEPS));
        assert_eq!(rates.bound(buffer(2), other), None);
    }

    #[test]
    fn every_pixel_is_shaded_whatever_the_application_combines() {
        let size = vk::Extent2D { width: 4, height: 4 };
        let own = |combiner| SetRate { size, combiners: [Combiner::KEEP, combiner] };
        for (combiner, expected) in [
            (Combiner::REPLACE, KEEPS),
            (Combiner::MIN, KEEPS),
            (Combiner::MAX, own(Combiner::KEEP)),
            (Combiner::KEEP, own(Combiner::KEEP)),
        ] {
            let rates = by_application();
            assert_eq!(rates.set(buffer(1), own(combiner)), own(combiner));
            assert_eq!(
                rates.bound(buffer(1), PipelineRate::Application { every_pixel: true }),
                Some(expected)
            );
            assert_eq!(rates.set(buffer(1), own(combiner)), expected);
            assert_eq!(
                rates.bound(buffer(1), PipelineRate::Application { every_pixel: false }),
                Some(own(combiner))
            );
        }
    }

    #[test]
    fn linked_pipelines_are_set_each_time() {
        let rates = SetRates::new(Combiner::MAX, false, false);
        assert_eq!(rates.bound(buffer(1), PipelineRate::Fixed), None);
        for _ in 0..2 {
            assert_eq!(rates.bound(buffer(1), PipelineRate::AtBind(Combiner::MAX)), Some(OBEYS));
        }
        assert_eq!(rates.bound(buffer(1), PipelineRate::AtBind(Combiner::KEEP)), Some(KEEPS));
    }

    #[test]
    fn shader_objects_are_set_where_the_application_does_not() {
        let rates = SetRates::new(Combiner::REPLACE, false, false);
        assert_eq!(rates.bound_shader(buffer(1), false), Some(full_rate(Combiner::REPLACE)));
        assert_eq!(rates.bound_shader(buffer(1), true), Some(KEEPS));
        let rates = by_application();
        assert_eq!(rates.bound_shader(buffer(1), false), None);
        assert_eq!(rates.set(buffer(1), KEEPS), OBEYS);
        assert_eq!(rates.bound_shader(buffer(1), true), Some(KEEPS));
    }

    /// vkd3d-proton sets all rates by commands, in passes with the attachment of the game and in passes without.
    #[test]
    fn a_pass_with_the_applications_attachment_has_the_applications_rates() {
        let rates = by_application();
        let own = SetRate { combiners: [Combiner::KEEP, Combiner::REPLACE], ..KEEPS };
        let careful = PipelineRate::Application { every_pixel: true };
        assert_eq!(rates.pass_begins(buffer(1), true), None, "nothing is set yet");
        assert_eq!(rates.set(buffer(1), own), own);
        assert_eq!(
            rates.bound(buffer(1), careful),
            Some(own),
            "alpha test obeys the application's attachment"
        );
        assert_eq!(rates.set(buffer(1), KEEPS), KEEPS, "and a rate that ignores it stays");
        assert_eq!(rates.set(buffer(1), own), own);
        assert_eq!(rates.pass_begins(buffer(1), false), Some(KEEPS), "ours is ignored by alpha test");
        assert_eq!(rates.bound(buffer(1), PipelineRate::Application { every_pixel: false }), Some(own));
        assert_eq!(rates.set(buffer(1), KEEPS), OBEYS);
        assert_eq!(rates.pass_begins(buffer(1), false), None, "as before");
        assert_eq!(rates.pass_begins(buffer(1), true), Some(KEEPS));
    }

    #[test]
    fn a_secondary_command_buffer_is_within_its_pass() {
        let rates = by_application();
        let careful = PipelineRate::Application { every_pixel: true };
        let own = SetRate { combiners: [Combiner::KEEP, Combiner::REPLACE], ..KEEPS };
        for (is_left_alone, expected) in [(true, own), (false, KEEPS)] {
            rates.recording_begins(buffer(1), is_left_alone);
            assert_eq!(rates.bound(buffer(1), careful), None);
            assert_eq!(rates.set(buffer(1), own), expected);
        }
    }

    /// Another command buffer may get the handle.
    #[test]
    fn a_freed_command_buffer_has_no_rate() {
        let rates = by_application();
        let own = SetRate { combiners: [Combiner::KEEP, Combiner::REPLACE], ..KEEPS };
        rates.set(buffer(1), own);
        rates.set(buffer(2), own);
        rates.forget(buffer(1));
        let careful = PipelineRate::Application { every_pixel: true };
        assert_eq!(rates.bound(buffer(1), careful), None, "nothing is set yet");
        assert_eq!(rates.bound(buffer(2), careful), Some(KEEPS));
        assert_eq!(rates.recorded.all().len(), 2);
        [1, 2].map(buffer).into_iter().for_each(|freed| rates.forget(freed));
        assert!(rates.recorded.all().is_empty());
    }

    #[test]
    fn pipelines_without_a_rate_ignore_the_applications_attachment() {
        for rates in [SetRates::new(Combiner::MAX, false, true), by_application()] {
            let linked = PipelineRate::AtBind(Combiner::MAX);
            assert_eq!(rates.bound(buffer(1), linked), Some(OBEYS));
            assert_eq!(rates.pass_begins(buffer(1), true), Some(KEEPS));
            assert_eq!(rates.bound(buffer(1), linked), Some(KEEPS));
            assert_eq!(rates.pass_begins(buffer(1), false), Some(OBEYS));
        }
    }

    /// A command that sets a rate under a pipeline with a rate of its own breaks that rate, or the rules.
    #[test]
    fn no_rate_is_set_for_a_pass_under_a_pipeline_with_a_rate_of_its_own() {
        let linked = PipelineRate::AtBind(Combiner::MAX);
        for rates in [SetRates::new(Combiner::MAX, false, true), by_application()] {
            rates.bound(buffer(1), linked);
            assert_eq!(rates.pass_begins(buffer(1), true), Some(KEEPS));
            assert_eq!(rates.bound(buffer(1), PipelineRate::Fixed), None);
            assert_eq!(rates.pass_begins(buffer(1), false), None);
            assert_eq!(rates.bound(buffer(1), linked), Some(OBEYS));
            assert_eq!(rates.pass_begins(buffer(1), true), Some(KEEPS), "as before");
        }
        let rates = by_application();
        let plain = PipelineRate::Application { every_pixel: false };
        assert_eq!(rates.set(buffer(1), KEEPS), OBEYS);
        rates.bound(buffer(1), PipelineRate::Fixed);
        assert_eq!(rates.set(buffer(1), KEEPS), OBEYS);
        assert_eq!(rates.pass_begins(buffer(1), true), None);
        assert_eq!(rates.bound(buffer(1), plain), Some(KEEPS), "the rate of this pass");
        assert_eq!(rates.bound(buffer(1), plain), None);
    }
}
