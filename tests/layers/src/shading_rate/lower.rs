//! Translation of the extension's own flags and layouts for the next layer.
//!
//! The rate stage becomes the fragment shader, the rate layout becomes GENERAL: a pass's read of its rate image
//! is then a read that this layer adds ahead of it (`capture`), ordered with the fragment shader stage, and
//! validation below reports the application's missing barriers.

use ash::vk;

pub(super) const RATE_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
pub(super) const RATE_LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
pub(super) const RATE_STAGE: vk::PipelineStageFlags2 =
    vk::PipelineStageFlags2::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
pub(super) const RATE_READ: vk::AccessFlags2 = vk::AccessFlags2::FRAGMENT_SHADING_RATE_ATTACHMENT_READ_KHR;
pub(super) const PIPELINE_FLAG: vk::PipelineCreateFlags =
    vk::PipelineCreateFlags::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;

/// An image of these keeps a usage that allows views, and can be read by the layer.
pub(super) fn usage(usage: vk::ImageUsageFlags) -> vk::ImageUsageFlags {
    if usage.contains(RATE_USAGE) {
        (usage & !RATE_USAGE) | vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC
    } else {
        usage
    }
}

pub(super) fn layout(layout: vk::ImageLayout) -> vk::ImageLayout {
    if layout == RATE_LAYOUT { vk::ImageLayout::GENERAL } else { layout }
}

pub(super) fn stages(stages: vk::PipelineStageFlags) -> vk::PipelineStageFlags {
    let rate = vk::PipelineStageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
    if stages.contains(rate) { (stages & !rate) | vk::PipelineStageFlags::FRAGMENT_SHADER } else { stages }
}

pub(super) fn stages2(stages: vk::PipelineStageFlags2) -> vk::PipelineStageFlags2 {
    if stages.contains(RATE_STAGE) {
        (stages & !RATE_STAGE) | vk::PipelineStageFlags2::FRAGMENT_SHADER
    } else {
        stages
    }
}

pub(super) fn access(access: vk::AccessFlags) -> vk::AccessFlags {
    let rate = vk::AccessFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_READ_KHR;
    if access.contains(rate) { (access & !rate) | vk::AccessFlags::SHADER_READ } else { access }
}

pub(super) fn access2(access: vk::AccessFlags2) -> vk::AccessFlags2 {
    if access.contains(RATE_READ) { (access & !RATE_READ) | vk::AccessFlags2::SHADER_READ } else { access }
}
