//! Follows transfers back: from submitted images to the images of which their pictures are made.

use super::memory::Memory;
use super::placement::Placements;
use super::projected::Swapchains;
use crate::pass_detection::{Event, Target, Transfer, TransferKind};

/// Notes the images that become eye buffers, or flat layers, by the transfers of a frame. Last to first, so that
/// chains of them are followed in one go.
pub(super) fn transfers(frame: u64, events: &[Event], swapchains: &Swapchains, memory: &mut Memory) {
    for event in events.iter().rev() {
        match event {
            Event::Transfer(transfer) => follow(frame, transfer, swapchains, memory),
            Event::Pass(pass) => {
                let all = pass.colors.len() == pass.resolves.len();
                for (index, resolve) in pass.resolves.iter().enumerate() {
                    // Where not all attachments are resolved, each of them may be the one.
                    let colors = if all { &pass.colors[index..=index] } else { &pass.colors };
                    for color in colors.iter().filter(|color| color.image != resolve.image) {
                        follow(frame, &resolving(color, resolve, pass.area), swapchains, memory);
                    }
                }
            }
        }
    }
    memory.compare(frame);
}

fn follow(frame: u64, transfer: &Transfer, swapchains: &Swapchains, memory: &mut Memory) {
    let (from, to) = (transfer.from.image, transfer.to.image);
    let shown_of = |image| swapchains.shown_of(memory.description(image));
    if shown_of(from).is_some() || from == to {
        return;
    }
    let (placements, is_flat): (Placements, bool) = match shown_of(to) {
        Some(key) => (swapchains.placements(key).into(), swapchains.is_flat(frame, key)),
        None => (memory.placements(to).into(), memory.is_flat(frame, to)),
    };
    if is_flat {
        memory.set_flat(frame, from);
    }
    for placement in placements.iter().filter_map(|placement| placement.before(transfer)) {
        memory.place(frame, from, placement);
    }
}

/// The resolve at the end of a pass: pixel for pixel, within the render area.
fn resolving(color: &Target, resolve: &Target, area: [u32; 4]) -> Transfer {
    let rect = area.map(|pixels| i32::try_from(pixels).unwrap_or(i32::MAX));
    Transfer { kind: TransferKind::Resolve, from: *color, from_rect: rect, to: *resolve, to_rect: rect }
}
