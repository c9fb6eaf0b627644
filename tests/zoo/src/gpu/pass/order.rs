//! Dependencies of a render pass, before and after.

use ash::vk;

/// Stages of work on targets, textures and copies, before and after a pass.
const OUTSIDE: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    TARGETS.as_raw()
        | vk::PipelineStageFlags::FRAGMENT_SHADER.as_raw()
        | vk::PipelineStageFlags::TRANSFER.as_raw(),
);

/// Stages that read and write attachments.
pub const TARGETS: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT.as_raw()
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS.as_raw()
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS.as_raw(),
);

const TARGET_WRITES: vk::AccessFlags = vk::AccessFlags::from_raw(
    vk::AccessFlags::COLOR_ATTACHMENT_WRITE.as_raw()
        | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
);

const TARGET_ACCESSES: vk::AccessFlags = vk::AccessFlags::from_raw(
    TARGET_WRITES.as_raw()
        | vk::AccessFlags::COLOR_ATTACHMENT_READ.as_raw()
        | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ.as_raw(),
);

const OUTSIDE_ACCESSES: vk::AccessFlags = vk::AccessFlags::from_raw(
    TARGET_ACCESSES.as_raw()
        | vk::AccessFlags::SHADER_READ.as_raw()
        | vk::AccessFlags::TRANSFER_READ.as_raw()
        | vk::AccessFlags::TRANSFER_WRITE.as_raw(),
);

/// The order of a render pass among others: earlier work is done, and later work waits.
pub fn dependencies(last_subpass: u32) -> [vk::SubpassDependency; 2] {
    [
        vk::SubpassDependency {
            src_subpass: vk::SUBPASS_EXTERNAL,
            dst_subpass: 0,
            src_stage_mask: OUTSIDE,
            dst_stage_mask: TARGETS,
            src_access_mask: TARGET_WRITES | vk::AccessFlags::TRANSFER_WRITE,
            dst_access_mask: TARGET_ACCESSES,
            dependency_flags: vk::DependencyFlags::empty(),
        },
        vk::SubpassDependency {
            src_subpass: last_subpass,
            dst_subpass: vk::SUBPASS_EXTERNAL,
            src_stage_mask: TARGETS,
            dst_stage_mask: OUTSIDE,
            src_access_mask: TARGET_WRITES,
            dst_access_mask: OUTSIDE_ACCESSES,
            dependency_flags: vk::DependencyFlags::empty(),
        },
    ]
}
