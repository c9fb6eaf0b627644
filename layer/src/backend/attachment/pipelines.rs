//! The creation of shader modules and graphics pipelines.

use super::attach::RateAttachments;
use super::full_rate::{Causes, causes};
use super::pipeline::{PipelineRate, has_flag, with_rates};
use super::refused::{Unamended, create_amended, may_be_ours};
use crate::abi::copies::{Copies, room, slice};
use crate::gpu::GpuError;
use crate::vk::shaders::Effects;
use crate::vk::shaders::parts::exchanges_binaries;
use ash::vk;
use smallvec::SmallVec;

impl RateAttachments {
    /// A pipeline is about to be destroyed.
    pub fn forget_pipeline(&self, pipeline: vk::Pipeline) {
        self.pipelines.remove(pipeline);
    }

    /// The rate to set when a pipeline is bound, or the application's for it; `None` where its rate is its own.
    pub fn pipeline_rate(&self, pipeline: vk::Pipeline) -> Option<PipelineRate> {
        self.pipelines.get(pipeline)
    }

    /// Effects of a fragment shader that forbid coarse rates, by the configuration.
    pub(super) fn counted(&self, effects: Effects) -> Effects {
        let is_allowed = self.coarse_stores && effects != Effects::UNKNOWN;
        Effects { stores: effects.stores && !is_allowed, ..effects }
    }

    /// `vkCreateGraphicsPipelines`, amended for rate attachments, unless binaries are exchanged. If that fails, for want of memory twice, the
    /// call is repeated as the application made it, for all of its pipelines: that keeps the specification's rules on early returns and
    /// pipelines derived from others in the same call.
    ///
    /// # Safety
    ///
    /// The arguments of the call; functions of the device's next layer.
    #[allow(clippy::too_many_arguments, reason = "those of the call")]
    pub unsafe fn create_pipelines(
        &self,
        device: vk::Device,
        cache: vk::PipelineCache,
        count: u32,
        infos: *const vk::GraphicsPipelineCreateInfo<'_>,
        allocator: *const vk::AllocationCallbacks<'_>,
        made: *mut vk::Pipeline,
        (next, destroy): (vk::PFN_vkCreateGraphicsPipelines, Option<vk::PFN_vkDestroyPipeline>),
    ) -> vk::Result {
        let mut room = room::<128>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: valid usage demands so many structures.
        let asked = unsafe { slice(infos, count) };
        let create_plain = |unamended| {
            // SAFETY: the application's own arguments.
            let plain = unsafe { next(device, cache, count, infos, allocator, made) };
            // SAFETY: the call has written so many handles, null for pipelines that failed.
            let pipelines = unsafe { slice(made.cast_const(), count) };
            let is_any_in_rendering = asked.iter().zip(pipelines).any(|(info, made)| {
                info.render_pass == vk::RenderPass::null() && *made != vk::Pipeline::null()
            });
            if is_any_in_rendering {
                self.leave_rendering_alone(unamended);
            }
            plain
        };
        // SAFETY: valid usage demands valid chains.
        if asked.iter().any(|info| unsafe { exchanges_binaries(info) }) {
            return create_plain(Unamended::Binaries);
        }
        // SAFETY: valid usage demands valid chains.
        let has_own_attachment: SmallVec<[bool; 16]> =
            asked.iter().map(|info| unsafe { has_flag(info) }).collect();
        let amended = asked.iter().zip(has_own_attachment).map(|(info, has_own_attachment)| {
            // SAFETY: valid usage demands valid stages.
            let effects = |stage: &vk::PipelineShaderStageCreateInfo<'_>| unsafe {
                self.counted(self.modules.effects(stage))
            };
            let linked = |library| self.pipelines.get(library);
            let is_left_alone = |pass| pass != vk::RenderPass::null() && self.leaves_alone(pass);
            // SAFETY: the structure is valid, and its chain the call's for its duration.
            unsafe {
                let causes = causes(info, &self.capabilities.limits, effects);
                let of_pipeline = (causes.are_any(), has_own_attachment);
                let (amended, rate) =
                    with_rates(info, &self.capabilities, of_pipeline, linked, is_left_alone, &mut copies);
                // Without rates of ours in the pass, they have no consequence.
                (amended, (rate, if self.may_reach(info) { causes } else { Causes::default() }))
            }
        });
        let (amended, rates): (Vec<_>, Vec<_>) = amended.unzip();
        let discard = || {
            // SAFETY: the call has written so many handles, null for pipelines that failed.
            for &pipeline in unsafe { slice(made.cast_const(), count) } {
                if let (Some(destroy), true) = (destroy, pipeline != vk::Pipeline::null()) {
                    // SAFETY: it was just made with this allocator, and no other code has its handle.
                    unsafe { destroy(device, pipeline, allocator) };
                }
            }
        };
        let first = amended.as_ptr();
        // SAFETY: the arguments are valid, as `# Safety` demands, with as many amended structures.
        let create = || unsafe { next(device, cache, count, first, allocator, made) };
        let result = create_amended(create, discard);
        if may_be_ours(result) {
            // Structures of the application that were amended in place become its own again.
            drop((amended, copies));
            GpuError::Call { call: "vkCreateGraphicsPipelines", result }
                .log("pipelines stay unchanged, at 1x1");
            return create_plain(Unamended::Refused("pipelines", result));
        }
        // SAFETY: as above.
        let pipelines = unsafe { slice(made.cast_const(), count) };
        for (&pipeline, (rate, causes)) in pipelines.iter().zip(rates) {
            if pipeline == vk::Pipeline::null() {
                continue;
            }
            causes.list();
            if rate != PipelineRate::Fixed {
                self.pipelines.insert(pipeline, rate);
            }
        }
        result
    }
}
