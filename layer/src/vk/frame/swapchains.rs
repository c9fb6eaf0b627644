//! The images of XR swapchains.

use crate::pass_detection::SwapchainKey;
use ash::vk;

/// The images of every live swapchain, by their index.
#[derive(Debug, Default)]
pub struct Swapchains {
    live: Vec<(SwapchainKey, Vec<vk::Image>)>,
}

impl Swapchains {
    /// Takes the images of a swapchain, or, without any, forgets it; returns its former images.
    pub fn take(&mut self, swapchain: SwapchainKey, images: &[vk::Image]) -> Vec<vk::Image> {
        let known = self.live.iter().position(|(known, _)| *known == swapchain);
        let former = known.map(|index| self.live.swap_remove(index).1);
        if !images.is_empty() {
            self.live.push((swapchain, images.to_vec()));
        }
        former.unwrap_or_default()
    }

    /// An image of a swapchain.
    pub fn image(&self, swapchain: SwapchainKey, index: u32) -> Option<vk::Image> {
        let (_, images) = self.live.iter().find(|(known, _)| *known == swapchain)?;
        images.get(index as usize).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    #[test]
    fn images_are_those_told_last() {
        let (a, b) = (SwapchainKey(1), SwapchainKey(2));
        let images = [1, 2, 3].map(vk::Image::from_raw);
        let mut swapchains = Swapchains::default();
        swapchains.take(a, &images);
        swapchains.take(b, &images[..1]);
        assert_eq!(swapchains.image(a, 2), Some(images[2]));
        assert_eq!((swapchains.image(b, 1), swapchains.image(SwapchainKey(3), 0)), (None, None));
        assert_eq!(swapchains.take(a, &images[1..]), images);
        assert_eq!(swapchains.image(a, 0), Some(images[1]));
        swapchains.take(a, &[]);
        assert_eq!((swapchains.image(a, 0), swapchains.image(b, 0)), (None, Some(images[0])));
    }
}
