//! The layouts of virtual swapchains' images, as the application leaves them.
//!
//! By OpenXR an image is COLOR_ATTACHMENT_OPTIMAL when it is released (XR_KHR_vulkan_enable, "Swapchain Image Layout"). Engines exist that
//! leave it as they last used it, and runtimes that do not mind.

use ash::vk;
use smallvec::SmallVec;
use std::sync::{PoisonError, RwLock};

/// Layouts of the images of a device's virtual swapchains, by submitted commands.
#[derive(Default)]
pub struct Layouts(RwLock<SmallVec<[(vk::Image, vk::ImageLayout); 16]>>);

impl Layouts {
    /// Begins to follow an image, which is COLOR_ATTACHMENT_OPTIMAL.
    pub fn follow(&self, image: vk::Image) {
        self.forget(image);
        self.write(|images| images.push((image, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)));
    }

    /// An image is none of a swapchain's any more.
    pub fn forget(&self, image: vk::Image) {
        self.write(|images| images.retain(|(known, _)| *known != image));
    }

    /// Whether no image is followed.
    pub fn is_empty(&self) -> bool {
        self.read(|images| images.is_empty())
    }

    /// The layout of an image by all that was submitted; `None` if it is not followed.
    pub fn of(&self, image: vk::Image) -> Option<vk::ImageLayout> {
        self.read(|images| images.iter().find(|(known, _)| *known == image).map(|(_, layout)| *layout))
    }

    /// An image that may be followed is in this layout after the submitted commands.
    pub fn set(&self, image: vk::Image, layout: vk::ImageLayout) {
        self.write(|images| {
            if let Some((_, known)) = images.iter_mut().find(|(known, _)| *known == image) {
                *known = layout;
            }
        });
    }

    fn read<T>(&self, act: impl FnOnce(&[(vk::Image, vk::ImageLayout)]) -> T) -> T {
        act(&self.0.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn write(&self, act: impl FnOnce(&mut SmallVec<[(vk::Image, vk::ImageLayout); 16]>)) {
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
        layouts.follow(ours);
        assert_eq!(layouts.of(ours), Some(Layout::COLOR_ATTACHMENT_OPTIMAL));
        layouts.set(ours, Layout::SHADER_READ_ONLY_OPTIMAL);
        layouts.set(other, Layout::GENERAL);
        assert_eq!(
            [ours, other].map(|image| layouts.of(image)),
            [Some(Layout::SHADER_READ_ONLY_OPTIMAL), None]
        );
        // Another image of the same handle.
        layouts.follow(ours);
        assert_eq!(layouts.of(ours), Some(Layout::COLOR_ATTACHMENT_OPTIMAL));
        layouts.forget(ours);
        assert!(layouts.is_empty());
    }
}
