//! The layouts of swapchain images that the layer reads, as the application leaves them, and the queues that it uses them on.
//!
//! By OpenXR an image is COLOR_ATTACHMENT_OPTIMAL when it is released, and one with depth DEPTH_STENCIL_ATTACHMENT_OPTIMAL
//! (XR_KHR_vulkan_enable, "Swapchain Image Layout"). Engines exist that leave it as they last used it, and runtimes that do not mind.

use super::objects::QueueId;
use ash::vk;
use smallvec::SmallVec;
use std::sync::{PoisonError, RwLock};

/// State of the images that the layer reads, by submitted commands.
#[derive(Default)]
pub struct Layouts(RwLock<SmallVec<[Followed; 16]>>);

/// An image that is followed.
struct Followed {
    image: vk::Image,
    is_virtual: bool,
    layout: vk::ImageLayout,
    /// Queues of submits that used it.
    queues: SmallVec<[QueueId; 2]>,
    /// Whether an unknown queue used it.
    is_used_elsewhere: bool,
}

impl Followed {
    fn new(image: vk::Image, is_virtual: bool, layout: vk::ImageLayout) -> Self {
        Self { image, is_virtual, layout, queues: SmallVec::new(), is_used_elsewhere: false }
    }
}

impl Layouts {
    /// Begins to follow an image, of a virtual swapchain or not, which is in that layout.
    pub fn follow(&self, image: vk::Image, is_virtual: bool, layout: vk::ImageLayout) {
        self.forget(image);
        self.write(|images| images.push(Followed::new(image, is_virtual, layout)));
    }

    /// Whether images of virtual swapchains are followed: these are read in each frame.
    pub fn has_virtual(&self) -> bool {
        self.read(|images| images.iter().any(|known| known.is_virtual))
    }

    /// Forgets an image that no longer belongs to a swapchain.
    pub fn forget(&self, image: vk::Image) {
        self.write(|images| images.retain(|known| known.image != image));
    }

    /// Whether no image is followed.
    pub fn is_empty(&self) -> bool {
        self.read(|images| images.is_empty())
    }

    /// The layout of an image by all that was submitted; `None` if it is not followed.
    pub fn of(&self, image: vk::Image) -> Option<vk::ImageLayout> {
        self.read(|images| images.iter().find(|known| known.image == image).map(|known| known.layout))
    }

    /// The layout in which submits left an image; the one that OpenXR demands for colour if an image is not followed.
    pub fn left_in(&self, image: vk::Image) -> vk::ImageLayout {
        self.of(image).unwrap_or(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
    }

    /// Whether submits to queues other than `queue` have used an image; `None` before any submit with it.
    pub fn is_used_on_other_queues(&self, image: vk::Image, queue: QueueId) -> Option<bool> {
        self.read(|images| {
            let Followed { queues, is_used_elsewhere, .. } =
                images.iter().find(|known| known.image == image)?;
            let is_beside = *is_used_elsewhere || queues.iter().any(|other| *other != queue);
            (is_beside || !queues.is_empty()).then_some(is_beside)
        })
    }

    /// Commands were submitted to a queue that leave images, which may be followed, in these layouts; `None`: as they were.
    pub fn submitted(&self, queue: Option<QueueId>, layouts: &[(vk::Image, Option<vk::ImageLayout>)]) {
        self.write(|images| {
            for (image, layout) in layouts {
                let Some(known) = images.iter_mut().find(|known| known.image == *image) else { continue };
                known.layout = layout.unwrap_or(known.layout);
                match queue {
                    Some(queue) if known.queues.contains(&queue) => {}
                    Some(queue) => known.queues.push(queue),
                    None => known.is_used_elsewhere = true,
                }
            }
        });
    }

    fn read<T>(&self, act: impl FnOnce(&[Followed]) -> T) -> T {
        act(&self.0.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn write(&self, act: impl FnOnce(&mut SmallVec<[Followed; 16]>)) {
        act(&mut self.0.write().unwrap_or_else(PoisonError::into_inner));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;
    use vk::ImageLayout as Layout;

    #[test]
    fn only_images_of_swapchains_are_followed() {
        let layouts = Layouts::default();
        let [ours, other] = [1, 2].map(vk::Image::from_raw);
        assert!(layouts.is_empty());
        layouts.follow(ours, false, Layout::COLOR_ATTACHMENT_OPTIMAL);
        assert!(!layouts.is_empty() && !layouts.has_virtual());
        layouts.follow(ours, true, Layout::COLOR_ATTACHMENT_OPTIMAL);
        assert!(layouts.has_virtual());
        assert_eq!(layouts.of(ours), Some(Layout::COLOR_ATTACHMENT_OPTIMAL));
        layouts.submitted(
            None,
            &[(ours, Some(Layout::SHADER_READ_ONLY_OPTIMAL)), (other, Some(Layout::GENERAL))],
        );
        layouts.submitted(None, &[(ours, None)]);
        assert_eq!(
            [ours, other].map(|image| layouts.of(image)),
            [Some(Layout::SHADER_READ_ONLY_OPTIMAL), None]
        );
        // Another image of the same handle.
        layouts.follow(ours, true, Layout::COLOR_ATTACHMENT_OPTIMAL);
        assert_eq!(layouts.of(ours), Some(Layout::COLOR_ATTACHMENT_OPTIMAL));
        layouts.forget(ours);
        assert!(layouts.is_empty());
    }

    #[test]
    fn a_queue_beside_the_sessions_is_noticed() {
        let layouts = Layouts::default();
        let [one, two, three] = [1, 2, 3].map(vk::Image::from_raw);
        let [session, second, family] =
            [(0, 0), (0, 1), (1, 0)].map(|(family, index)| QueueId { family, index });
        let follow = |image| layouts.follow(image, true, Layout::COLOR_ATTACHMENT_OPTIMAL);
        [one, two, three].into_iter().for_each(follow);
        let submit = |queue, image| layouts.submitted(queue, &[(image, None)]);
        let beside = || [one, two, three].map(|image| layouts.is_used_on_other_queues(image, session));
        assert_eq!(beside(), [None; 3]);
        [one, two, three].into_iter().for_each(|image| submit(Some(session), image));
        assert_eq!(beside(), [Some(false); 3]);
        submit(Some(second), one);
        submit(Some(family), two);
        submit(None, three);
        assert_eq!(beside(), [Some(true); 3]);
        // Permanent: a frame that uses one queue alone does not show that the next will.
        submit(Some(session), one);
        assert_eq!(beside(), [Some(true); 3]);
        follow(one);
        assert_eq!(beside(), [None, Some(true), Some(true)]);
    }
}
