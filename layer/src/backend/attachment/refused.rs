//! Creations that fail with the additions for rate attachments.

use super::attach::RateAttachments;
use crate::abi::copies::find;
use crate::status::{Topic, decided};
use crate::vk::shaders::parts::{Parts, own_parts};
use ash::vk;
use std::fmt::{self, Display};
use std::sync::atomic::Ordering;

/// Objects of the application without the additions, and the cause.
#[derive(Clone, Copy, Debug)]
pub(super) enum Unamended {
    /// The driver refuses such objects, by their name, with the additions.
    Refused(&'static str, vk::Result),
    /// The application exchanges pipelines as binaries.
    Binaries,
}

impl Unamended {
    fn objects(self) -> String {
        match self {
            Self::Refused(objects, _) => {
                format!("{objects} that the driver creates only without shading rates")
            }
            Self::Binaries => "pipelines from and for binaries".to_owned(),
        }
    }
}

impl Display for Unamended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(objects, refused) => {
                write!(f, "the driver creates {objects} only without shading rates: {refused:?}")
            }
            Self::Binaries => {
                f.write_str("the application keeps pipelines as binaries (VK_KHR_pipeline_binary), which must be valid without the layer")
            }
        }
    }
}

impl RateAttachments {
    /// From now on dynamic rendering gets no attachments: there are objects of the application without the additions, which may not be
    /// used with attachments (VUID-vkCmdDraw-imageView-06183).
    pub(super) fn leave_rendering_alone(&self, unamended: Unamended) {
        if !self.rendering_is_left_alone.swap(true, Ordering::Relaxed) {
            decided(
                Topic::FullRate(unamended.objects()),
                &format_args!(
                    "dynamic rendering: shaded at 1x1 until a restart of the application, as {unamended}"
                ),
            );
        }
    }

    /// Whether dynamic rendering gets attachments.
    pub fn attaches_to_rendering(&self) -> bool {
        !self.rendering_is_left_alone.load(Ordering::Relaxed)
    }

    /// Whether passes of a pipeline may have rates of ours: in dynamic rendering, if they have colours. A library without the output part
    /// tells nothing of colours.
    ///
    /// # Safety
    ///
    /// The structure is valid.
    pub unsafe fn may_reach(&self, info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
        if info.render_pass != vk::RenderPass::null() {
            return !self.leaves_alone(info.render_pass);
        }
        // SAFETY: the chain is valid, as `# Safety` demands.
        let has_no_colours = unsafe {
            let formats = find::<vk::PipelineRenderingCreateInfo<'_>>(info.p_next);
            own_parts(info).contains(Parts::FRAGMENT_OUTPUT_INTERFACE)
                && formats.is_some_and(|formats| formats.color_attachment_count == 0)
        };
        self.attaches_to_rendering() && !has_no_colours
    }
}

/// The result of a creation with our additions, which is repeated once for want of memory: as the consequence of a refusal lasts, a passing
/// lack must not count as one. `discard` destroys the objects of a failed attempt.
pub(super) fn create_amended(create: impl Fn() -> vk::Result, discard: impl Fn()) -> vk::Result {
    let mut result = create();
    if [vk::Result::ERROR_OUT_OF_HOST_MEMORY, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY].contains(&result) {
        discard();
        result = create();
    }
    if may_be_ours(result) {
        discard();
    }
    result
}

/// Whether a creation may have failed because of our additions, so that it is worth repeating without them. Positive
/// codes are not failures: `PIPELINE_COMPILE_REQUIRED` is the answer to a question of the application's.
pub(super) fn may_be_ours(result: vk::Result) -> bool {
    result.as_raw() < 0 && result != vk::Result::ERROR_DEVICE_LOST
}
