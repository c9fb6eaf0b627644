//! Temporal feedback within a frame's events; its later events stand for the same events of the last frame.

use super::{Kind, Known, Node, Provenance, Role, Sources, writes};
use crate::pass_detection::recognition::candidate;
use crate::pass_detection::recognition::feedback::{images_read, is_picture};
use crate::pass_detection::{Event, ImageKey};

impl Provenance {
    /// Whether a pass on the way to the displayed image reads its own output of the last frame; or, with a swapchain as its direct target, the image
    /// so far.
    pub(super) fn has_feedback(&mut self, events: &[Event], known: &Known<'_>) -> bool {
        let is_on_the_way = |node: &Node| matches!(node.role, Role::Eye | Role::FullScreen);
        if self.nodes.iter().any(|node| is_on_the_way(node) && node.reads_itself) {
            return true;
        }
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else { continue };
            if !is_on_the_way(&self.nodes[index]) {
                continue;
            }
            let is_camera = self.nodes[index].kind == Kind::Camera;
            let own = self.nodes[index].group;
            let is_own = |image: ImageKey| pass.colors.iter().any(|target| target.image == image);
            for image in images_read(pass).filter(|image| !is_own(*image) && known.is_large_colour(*image)) {
                let is_made_before = events[..index].iter().any(|earlier| makes(earlier, image));
                let mut sources = Sources::new();
                self.sources_of(image, index, events, known, 0, &mut sources);
                let is_last = |group: &usize| is_camera && *group == own && !is_made_before;
                let is_direct = |group: &usize| is_made_before && self.groups.all[*group].is_direct;
                if sources.iter().any(|group| is_last(group) || is_direct(group)) {
                    return true;
                }
            }
        }
        false
    }
}

/// Whether an event writes to an image.
fn makes(event: &Event, image: ImageKey) -> bool {
    match event {
        Event::Pass(pass) => writes(pass, image),
        Event::Transfer(transfer) => transfer.to.image == image,
    }
}

impl Known<'_> {
    /// Whether an image holds colours, of a picture's size.
    fn is_large_colour(&self, image: ImageKey) -> bool {
        let least = self.swapchains.least_picture();
        self.memory
            .description(image)
            .is_some_and(|image| candidate::holds_colours(image.format) && is_picture(image.extent, least))
    }
}
