//! Effects of submits on rate images, in their order: layouts, and whether the last write is visible to the rate stage.
//!
//! The submits of several queues are taken in the order in which they are made.

use super::findings::Findings;
use super::image::{Image, Range};
use super::lower::{RATE_READ, RATE_STAGE};
use super::recording::Recording;
use ash::vk;
use std::collections::HashMap;

/// One layer of a level of a rate image.
#[derive(Clone, Copy)]
pub(super) struct Subresource {
    layout: vk::ImageLayout,
    /// Whether a transfer command wrote it, and no barrier made that available yet.
    written: bool,
    /// Whether the rate stage can see the last write.
    readable: bool,
}

impl Subresource {
    pub fn new(layout: vk::ImageLayout) -> Self {
        Self { layout, written: false, readable: false }
    }
}

/// Effect of a recorded command on rate images.
#[derive(Clone, Copy)]
pub(super) enum Event {
    /// A barrier on an image with its layouts, or a global one.
    Barrier { image: Option<(vk::Image, Range, [vk::ImageLayout; 2])>, masks: Masks },
    /// A write by a transfer command.
    Write { image: vk::Image, range: Range },
    /// The begin of a pass, which reads a map that must be in a layout.
    Read { image: vk::Image, range: Range, layout: vk::ImageLayout, rule: &'static str },
    /// The layout that a render pass leaves behind.
    Left { image: vk::Image, range: Range, layout: vk::ImageLayout },
    /// The events of a secondary command buffer.
    Execute(vk::CommandBuffer),
}

/// The masks of a barrier.
#[derive(Clone, Copy, Default)]
pub(super) struct Masks {
    pub src: (vk::PipelineStageFlags2, vk::AccessFlags2),
    pub dst: (vk::PipelineStageFlags2, vk::AccessFlags2),
}

/// Whether a barrier's second scope has the rate stage's read of an attachment.
pub(super) fn reaches_rate_stage(stages: vk::PipelineStageFlags2, access: vk::AccessFlags2) -> bool {
    let all = vk::PipelineStageFlags2::ALL_GRAPHICS | vk::PipelineStageFlags2::ALL_COMMANDS;
    stages.intersects(RATE_STAGE | all) && access.intersects(RATE_READ | vk::AccessFlags2::MEMORY_READ)
}

const ALL_WRITES: vk::AccessFlags2 = vk::AccessFlags2::from_raw(
    vk::AccessFlags2::SHADER_WRITE.as_raw()
        | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw()
        | vk::AccessFlags2::TRANSFER_WRITE.as_raw()
        | vk::AccessFlags2::MEMORY_WRITE.as_raw(),
);

impl Masks {
    /// Whether the first scope has the writes of transfer commands.
    fn covers_transfers(&self) -> bool {
        let stages = vk::PipelineStageFlags2::ALL_COMMANDS
            | vk::PipelineStageFlags2::ALL_TRANSFER
            | vk::PipelineStageFlags2::COPY
            | vk::PipelineStageFlags2::CLEAR;
        let access = vk::AccessFlags2::TRANSFER_WRITE | vk::AccessFlags2::MEMORY_WRITE;
        self.src.0.intersects(stages) && self.src.1.intersects(access)
    }

    fn apply(&self, to: &mut Subresource, transition: bool) {
        let available = !to.written || self.covers_transfers();
        to.written &= !available;
        // Before a write other than by a transfer command, which is not seen, there is a barrier for it.
        let written = transition || self.dst.1.intersects(ALL_WRITES);
        if available && reaches_rate_stage(self.dst.0, self.dst.1) {
            to.readable = true;
        } else if written {
            to.readable = false;
        }
    }
}

fn subresources(
    images: &mut HashMap<vk::Image, Image>,
    image: vk::Image,
    range: Range,
) -> impl Iterator<Item = &mut Subresource> {
    let image = images.get_mut(&image).filter(|image| image.is_rate());
    image.into_iter().flat_map(move |image| {
        let layers = image.layers.max(1);
        image.subresources.iter_mut().enumerate().filter_map(move |(index, subresource)| {
            let (level, layer) = (index as u32 / layers, index as u32 % layers);
            let inside = (range.level..range.level.saturating_add(range.levels)).contains(&level)
                && (range.layer..range.layer.saturating_add(range.layers)).contains(&layer);
            inside.then_some(subresource)
        })
    })
}

const KIND: &str = "execution";

/// Executes the recorded commands.
pub(super) fn replay(
    recordings: &HashMap<vk::CommandBuffer, Recording>,
    images: &mut HashMap<vk::Image, Image>,
    findings: &mut Findings,
    events: &[Event],
) {
    for event in events {
        match *event {
            Event::Execute(buffer) => {
                if let Some(secondary) = recordings.get(&buffer) {
                    replay(recordings, images, findings, &secondary.events);
                }
            }
            Event::Barrier { image: None, masks } => global_barrier(images, masks),
            Event::Barrier { image: Some((image, range, [old, new])), masks } => {
                for subresource in subresources(images, image, range) {
                    let before = subresource.layout;
                    let holds = old == new || old == vk::ImageLayout::UNDEFINED || old == before;
                    let rule = "VUID-VkImageMemoryBarrier-oldLayout-01197";
                    findings.require(holds, KIND, rule, image, || format!("{old:?}, but it was {before:?}"));
                    if old != new {
                        subresource.layout = new;
                    }
                    masks.apply(subresource, old != new);
                }
            }
            Event::Write { image, range } => {
                for subresource in subresources(images, image, range) {
                    subresource.written = true;
                    subresource.readable = false;
                }
            }
            Event::Read { image, range, layout, rule } => {
                for subresource in subresources(images, image, range) {
                    let is = subresource.layout;
                    findings.require(is == layout, KIND, rule, image, || format!("{is:?}, not {layout:?}"));
                    let rule = "rate attachment is readable";
                    findings.require(subresource.readable, KIND, rule, image, || {
                        "no barrier from the last write to FRAGMENT_SHADING_RATE_ATTACHMENT_READ at its stage".to_owned()
                    });
                }
            }
            Event::Left { image, range, layout } => {
                for subresource in subresources(images, image, range) {
                    subresource.layout = layout;
                }
            }
        }
    }
}

/// A barrier on everything, such as a wait for a semaphore is too.
pub(super) fn global_barrier(images: &mut HashMap<vk::Image, Image>, masks: Masks) {
    for image in images.values_mut() {
        // Behind such a barrier, shaders do not write images without storage usage; transfers are observed themselves.
        let is_stored = image.usage.contains(vk::ImageUsageFlags::STORAGE);
        let dst = if is_stored { masks.dst } else { (masks.dst.0, masks.dst.1 & !ALL_WRITES) };
        let masks = Masks { dst, ..masks };
        image.subresources.iter_mut().for_each(|subresource| masks.apply(subresource, false));
    }
}
