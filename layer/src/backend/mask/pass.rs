//! The commands of a pass with a mask, from its begin to its end.

use super::open_mask::OpenMethod;
use super::{Attachments, Masks, OpenMask, PassContext, TargetMask};
use crate::backend::mask::{DepthWork, MaskMap};
use crate::gpu::AppCommands;
use crate::pass_detection::{ImageKey, Pass, Target, Unmasked};
use ash::vk;
use std::sync::Arc;

impl Masks {
    /// Keeps the facts of a pass that matter to others.
    fn note(&self, attachments: &Attachments) {
        if let Some(depth) = attachments.depth.filter(|depth| depth.is_cleared)
            && self.cleared.get(depth.target.image) != Some(depth.clear)
        {
            self.cleared.insert(depth.target.image, depth.clear);
        }
        let depth = attachments.depth.iter().filter(|depth| depth.is_loaded).map(|depth| depth.target);
        let colors = attachments.colors.iter().filter(|color| color.is_loaded).map(|color| color.target);
        for target in depth.chain(colors) {
            if self.loaded.get(target.image).is_none() {
                self.loaded.insert(target.image, ());
            }
        }
    }

    /// Records the commands ahead of a pass that may have a mask. Returns the mask, with the begin of the pass from `loading`, which is
    /// `None` if the pass begins unchanged; `None` without a mask, and then `pass` has the reason. `settle` is called before, with the mask
    /// if it has a template: fills that wait in the pass's attachments are recorded, or go on waiting.
    ///
    /// # Safety
    ///
    /// `commands` is recording, outside of a render pass, on this thread; the attachments of the pass are live until it has run.
    #[allow(clippy::too_many_arguments, reason = "what is known of a pass comes from four sides")]
    pub unsafe fn begin_pass<T>(
        &self,
        commands: vk::CommandBuffer,
        candidate: Option<(Target, Option<&TargetMask>)>,
        pass: &mut Pass,
        attachments: &Attachments,
        context: PassContext<'_>,
        (loading, settle): (
            impl FnOnce(DepthWork) -> Result<T, Unmasked>,
            impl FnOnce(Option<&Arc<MaskMap>>),
        ),
    ) -> Option<(OpenMask, Option<T>)> {
        self.note(attachments);
        let open = candidate
            .ok_or(Unmasked::New)
            .and_then(|candidate| self.open(candidate, pass, attachments, context))
            .and_then(|open| {
                let loading = match &open.method {
                    OpenMethod::Template(depth) => Some(loading(depth.work)?),
                    OpenMethod::Return(_) => None,
                };
                Ok((open, loading))
            });
        let open = open.and_then(|(open, loading)| Ok((self.gpu().ok_or(Unmasked::Failed)?, open, loading)));
        if attachments.colors.is_empty()
            && let Some(target) = candidate.and_then(|(_, mask)| mask)
        {
            target.note_prepass(open.as_ref().map(drop).map_err(|reason| *reason));
        }
        settle(open.as_ref().ok().and_then(|(_, open, _)| open.template()));
        match open {
            Ok((gpu, open, loading)) => {
                // SAFETY: the command buffer is recording, as `# Safety` demands; the map is kept by the candidate, which the command
                // buffer keeps.
                let commands = unsafe { AppCommands::new(gpu, commands) };
                pass.facts.is_unfilled = open.is_unfilled;
                open.record_ahead(&commands);
                Some((open, loading))
            }
            Err(reason) => {
                pass.unmasked = Some(reason);
                None
            }
        }
    }

    /// Records the commands after a pass, which change the bound compute state.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin_pass`].
    pub unsafe fn end_pass(&self, open: &OpenMask, commands: vk::CommandBuffer) {
        let Some(gpu) = self.gpu() else { return };
        // SAFETY: as above.
        let commands = unsafe { AppCommands::new(gpu, commands) };
        open.record_after(&commands);
    }

    /// The colour of the passes that are to go on with the depth of a pre-pass, if earlier frames have shown one: by the depth that it
    /// clears, and the number of the command buffer's passes that have cleared that, including this one.
    pub fn chained(&self, depth: ImageKey, prepasses: u32) -> Option<Target> {
        self.chains.get((depth, prepasses))
    }

    /// The begin of a render pass that loads depth.
    ///
    /// # Errors
    ///
    /// There is no render pass for that.
    pub fn loading_begin<'a>(
        &self,
        info: &vk::RenderPassBeginInfo<'a>,
    ) -> Result<vk::RenderPassBeginInfo<'a>, Unmasked> {
        let render_pass = self.loading(info.render_pass).ok_or(Unmasked::RenderPass)?;
        Ok(vk::RenderPassBeginInfo { render_pass, ..*info })
    }
}
