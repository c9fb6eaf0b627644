//! Every image barrier that we record, by name, so that tests can leave out each one and expect an error.
//!
//! Outside of our work, images of both sides are COLOR_ATTACHMENT_OPTIMAL, and depth images DEPTH_STENCIL_ATTACHMENT_OPTIMAL, as OpenXR
//! requires (XR_KHR_vulkan_enable, "Swapchain Image Layout"): written by earlier commands on the same queue, read by later ones;
//! [`ImageBarrier::left_in`] and [`ImageBarrier::depth_left_in`] have other layouts. No two barriers have the same layouts and stages.

use ash::vk;
use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};

/// A layout transition of all layers of an image, with the accesses that it orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageBarrier {
    /// Name in tests and messages.
    pub name: &'static str,
    /// Layout before.
    pub old_layout: Layout,
    /// Layout after.
    pub new_layout: Layout,
    /// Stages waited for.
    pub src_stage: Stage,
    /// Stages that wait.
    pub dst_stage: Stage,
    /// Writes made available.
    pub src_access: Access,
    /// Accesses they are made visible to.
    pub dst_access: Access,
}

impl ImageBarrier {
    /// The same barrier for an image that the application leaves in `layout`, and gets back so, with all its commands before and after.
    pub fn left_in(self, layout: Layout) -> Self {
        self.with(layout, Layout::COLOR_ATTACHMENT_OPTIMAL)
    }

    /// The same for an image with depth.
    pub fn depth_left_in(self, layout: Layout) -> Self {
        // The layout of an image that is not followed, or is left so by no valid command.
        let is_unknown = layout == Layout::COLOR_ATTACHMENT_OPTIMAL;
        if is_unknown { self } else { self.with(layout, Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL) }
    }

    /// With `layout` in place of `optimal`.
    fn with(self, layout: Layout, optimal: Layout) -> Self {
        // No image can be brought to the layouts of new ones, whose content is undefined.
        let is_new = matches!(layout, Layout::UNDEFINED | Layout::PREINITIALIZED);
        match self {
            _ if layout == optimal || is_new => self,
            Self { old_layout, .. } if old_layout == optimal => Self {
                old_layout: layout,
                src_stage: Stage::ALL_COMMANDS,
                src_access: Access::MEMORY_WRITE,
                ..self
            },
            Self { new_layout, .. } if new_layout == optimal => Self {
                new_layout: layout,
                dst_stage: Stage::ALL_COMMANDS,
                dst_access: Access::MEMORY_READ | Access::MEMORY_WRITE,
                ..self
            },
            _ => self,
        }
    }
}

const COLOR_READ_WRITE: Access =
    Access::from_raw(Access::COLOR_ATTACHMENT_READ.as_raw() | Access::COLOR_ATTACHMENT_WRITE.as_raw());

/// Stages in which an application writes a swapchain image: as attachment, by copies, or as storage image.
const APP_WRITE_STAGES: Stage = Stage::from_raw(
    Stage::COLOR_ATTACHMENT_OUTPUT.as_raw()
        | Stage::TRANSFER.as_raw()
        | Stage::COMPUTE_SHADER.as_raw()
        | Stage::FRAGMENT_SHADER.as_raw(),
);

/// The writes of [`APP_WRITE_STAGES`].
const APP_WRITES: Access = Access::from_raw(
    Access::COLOR_ATTACHMENT_WRITE.as_raw() | Access::TRANSFER_WRITE.as_raw() | Access::SHADER_WRITE.as_raw(),
);

/// Stages in which depth is tested and written.
const DEPTH_TESTS: Stage =
    Stage::from_raw(Stage::EARLY_FRAGMENT_TESTS.as_raw() | Stage::LATE_FRAGMENT_TESTS.as_raw());

/// Stages in which an application writes a depth image: as attachment, resolved in a render pass, or by copies.
const DEPTH_WRITE_STAGES: Stage = Stage::from_raw(
    DEPTH_TESTS.as_raw() | Stage::COLOR_ATTACHMENT_OUTPUT.as_raw() | Stage::TRANSFER.as_raw(),
);

/// The writes of [`DEPTH_WRITE_STAGES`].
const DEPTH_WRITES: Access = Access::from_raw(
    Access::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
        | Access::COLOR_ATTACHMENT_WRITE.as_raw()
        | Access::TRANSFER_WRITE.as_raw(),
);

const DEPTH_READ_WRITE: Access = Access::from_raw(
    Access::DEPTH_STENCIL_ATTACHMENT_READ.as_raw() | Access::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
);

/// Stages in which we read our copies of depth.
const DEPTH_READ_STAGES: Stage =
    Stage::from_raw(Stage::FRAGMENT_SHADER.as_raw() | Stage::COMPUTE_SHADER.as_raw());

/// Any use by the application: it may draw to its image, copy to it or write it in a shader, after a barrier of its own that waits for
/// nothing, as the image is free to be written (OpenXR specification, xrWaitSwapchainImage).
const ANY_USE: Access = Access::from_raw(Access::MEMORY_READ.as_raw() | Access::MEMORY_WRITE.as_raw());

/// A new image of ours, before the application first gets it.
pub const APP_CREATED: ImageBarrier = ImageBarrier {
    name: "app_created",
    old_layout: Layout::UNDEFINED,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::TOP_OF_PIPE,
    dst_stage: Stage::ALL_COMMANDS,
    src_access: Access::empty(),
    dst_access: ANY_USE,
};

/// From the application's rendering to our copy of it.
pub const APP_RENDERED_TO_COPIED: ImageBarrier = ImageBarrier {
    name: "app_rendered_to_copied",
    old_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    new_layout: Layout::TRANSFER_SRC_OPTIMAL,
    src_stage: APP_WRITE_STAGES,
    dst_stage: Stage::TRANSFER,
    src_access: APP_WRITES,
    dst_access: Access::TRANSFER_READ,
};

/// Between copying and sampling the application's image.
pub const APP_COPIED_TO_SAMPLED: ImageBarrier = ImageBarrier {
    name: "app_copied_to_sampled",
    old_layout: Layout::TRANSFER_SRC_OPTIMAL,
    new_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    src_stage: Stage::TRANSFER,
    dst_stage: Stage::FRAGMENT_SHADER,
    src_access: Access::empty(),
    dst_access: Access::SHADER_READ,
};

/// From the application's rendering for an earlier frame to our sampling of it.
pub const APP_RENDERED_TO_SAMPLED: ImageBarrier = ImageBarrier {
    name: "app_rendered_to_sampled",
    old_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    new_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    src_stage: APP_WRITE_STAGES,
    dst_stage: Stage::FRAGMENT_SHADER,
    src_access: APP_WRITES,
    dst_access: Access::SHADER_READ,
};

/// From the application's rendering to our comparison with its rendering for other frames.
pub const APP_RENDERED_TO_COMPARED: ImageBarrier = ImageBarrier {
    name: "app_rendered_to_compared",
    old_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    new_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    src_stage: APP_WRITE_STAGES,
    dst_stage: Stage::COMPUTE_SHADER,
    src_access: APP_WRITES,
    dst_access: Access::SHADER_READ,
};

/// Our last read of an image that was compared, before the application writes it again.
pub const APP_COMPARED_TO_RENDERED: ImageBarrier = ImageBarrier {
    name: "app_compared_to_rendered",
    old_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::COMPUTE_SHADER,
    dst_stage: Stage::ALL_COMMANDS,
    src_access: Access::empty(),
    dst_access: ANY_USE,
};

/// Our last read of an image that was sampled, before the application writes it again.
pub const APP_SAMPLED_TO_RENDERED: ImageBarrier = ImageBarrier {
    name: "app_sampled_to_rendered",
    old_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::FRAGMENT_SHADER,
    dst_stage: Stage::ALL_COMMANDS,
    src_access: Access::empty(),
    dst_access: ANY_USE,
};

/// Our last read of an image that was only copied, before the application writes it again.
pub const APP_COPIED_TO_RENDERED: ImageBarrier = ImageBarrier {
    name: "app_copied_to_rendered",
    old_layout: Layout::TRANSFER_SRC_OPTIMAL,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::TRANSFER,
    dst_stage: Stage::ALL_COMMANDS,
    src_access: Access::empty(),
    dst_access: ANY_USE,
};

/// The runtime's image, whose old content is not needed, before we copy to it. The runtime hands it over for
/// use as a colour attachment; our own last draw to it may not have been made available by anybody.
pub const RUNTIME_ACQUIRED_TO_COPIED: ImageBarrier = ImageBarrier {
    name: "runtime_acquired_to_copied",
    old_layout: Layout::UNDEFINED,
    new_layout: Layout::TRANSFER_DST_OPTIMAL,
    src_stage: Stage::COLOR_ATTACHMENT_OUTPUT,
    dst_stage: Stage::TRANSFER,
    src_access: Access::COLOR_ATTACHMENT_WRITE,
    dst_access: Access::TRANSFER_WRITE,
};

/// The copy, before we draw over it, or before the runtime takes the image as it would the application's.
pub const RUNTIME_COPIED_TO_DRAWN: ImageBarrier = ImageBarrier {
    name: "runtime_copied_to_drawn",
    old_layout: Layout::TRANSFER_DST_OPTIMAL,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::TRANSFER,
    dst_stage: Stage::COLOR_ATTACHMENT_OUTPUT,
    src_access: Access::TRANSFER_WRITE,
    dst_access: COLOR_READ_WRITE,
};

/// The finished picture, before something is blended over it: ours, which another half of ours may have read in between, or the application's,
/// however it was written.
pub const RUNTIME_DRAWN_TO_BLENDED: ImageBarrier = ImageBarrier {
    name: "runtime_drawn_to_blended",
    old_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    new_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
    src_stage: Stage::ALL_COMMANDS,
    dst_stage: Stage::COLOR_ATTACHMENT_OUTPUT,
    src_access: Access::MEMORY_WRITE,
    dst_access: COLOR_READ_WRITE,
};

/// A picture that something was blended over, before anything that comes after, in the layout that the application left it in.
pub fn blended_to(layout: Layout) -> ImageBarrier {
    ImageBarrier {
        name: "runtime_blended_to_left",
        old_layout: Layout::COLOR_ATTACHMENT_OPTIMAL,
        new_layout: layout,
        src_stage: Stage::COLOR_ATTACHMENT_OUTPUT,
        dst_stage: Stage::ALL_COMMANDS,
        src_access: COLOR_READ_WRITE,
        dst_access: Access::MEMORY_READ | Access::MEMORY_WRITE,
    }
}

/// The application's depth, which is written as an attachment and by copies, before we copy it.
pub const DEPTH_WRITTEN_TO_COPIED: ImageBarrier = ImageBarrier {
    name: "depth_written_to_copied",
    old_layout: Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    new_layout: Layout::TRANSFER_SRC_OPTIMAL,
    src_stage: DEPTH_WRITE_STAGES,
    dst_stage: Stage::TRANSFER,
    src_access: DEPTH_WRITES,
    dst_access: Access::TRANSFER_READ,
};

/// The same after the copy, before the runtime takes it as it would the application's.
pub const DEPTH_COPIED_TO_WRITTEN: ImageBarrier = ImageBarrier {
    name: "depth_copied_to_written",
    old_layout: Layout::TRANSFER_SRC_OPTIMAL,
    new_layout: Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    src_stage: Stage::TRANSFER,
    dst_stage: DEPTH_TESTS,
    src_access: Access::empty(),
    dst_access: DEPTH_READ_WRITE,
};

/// Our copy of earlier depth, whose content is not needed any more, before we copy to it.
pub const KEPT_DEPTH_READ_TO_COPIED: ImageBarrier = ImageBarrier {
    name: "kept_depth_read_to_copied",
    old_layout: Layout::UNDEFINED,
    new_layout: Layout::TRANSFER_DST_OPTIMAL,
    src_stage: DEPTH_READ_STAGES,
    dst_stage: Stage::TRANSFER,
    src_access: Access::empty(),
    dst_access: Access::TRANSFER_WRITE,
};

/// Our copy of depth, before we read it.
pub const KEPT_DEPTH_COPIED_TO_READ: ImageBarrier = ImageBarrier {
    name: "kept_depth_copied_to_read",
    old_layout: Layout::TRANSFER_DST_OPTIMAL,
    new_layout: Layout::SHADER_READ_ONLY_OPTIMAL,
    src_stage: Stage::TRANSFER,
    dst_stage: DEPTH_READ_STAGES,
    src_access: Access::TRANSFER_WRITE,
    dst_access: Access::SHADER_READ,
};

/// All of them.
pub const ALL: [ImageBarrier; 15] = [
    APP_CREATED,
    APP_RENDERED_TO_COPIED,
    APP_RENDERED_TO_SAMPLED,
    APP_COPIED_TO_SAMPLED,
    APP_SAMPLED_TO_RENDERED,
    APP_RENDERED_TO_COMPARED,
    APP_COMPARED_TO_RENDERED,
    APP_COPIED_TO_RENDERED,
    RUNTIME_ACQUIRED_TO_COPIED,
    RUNTIME_COPIED_TO_DRAWN,
    RUNTIME_DRAWN_TO_BLENDED,
    DEPTH_WRITTEN_TO_COPIED,
    DEPTH_COPIED_TO_WRITTEN,
    KEPT_DEPTH_READ_TO_COPIED,
    KEPT_DEPTH_COPIED_TO_READ,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_signatures_are_distinct() {
        for (index, a) in ALL.iter().enumerate() {
            for b in &ALL[..index] {
                let signature = |x: &ImageBarrier| (x.old_layout, x.new_layout, x.src_stage, x.dst_stage);
                assert!(signature(a) != signature(b), "{} and {}", a.name, b.name);
                assert_ne!(a.name, b.name);
            }
        }
    }
}
