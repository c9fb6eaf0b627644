//! Images are created so that they can be filled, or take a template.

use super::Masks;
use crate::abi::pnext::chain;
use crate::backend::mask::added_usage;
use ash::vk;

/// Structures that may extend the creation of an image to whose usage something is added. A usage of stencil apart from depth's is none: views
/// would need either or both, by their aspects.
const HARMLESS: [vk::StructureType; 1] = [vk::StructureType::IMAGE_FORMAT_LIST_CREATE_INFO];

impl Masks {
    /// The usage to create an image with, if that is more than the application asks for and the device allows it. It is the same for equal
    /// images: applications may use the memory requirements of one for another.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateImage).
    pub unsafe fn usage(&self, info: &vk::ImageCreateInfo<'_>) -> Option<vk::ImageUsageFlags> {
        let added = added_usage(info);
        if added.is_empty() {
            return None;
        }
        // SAFETY: the chain is valid, by the valid usage of vkCreateImage.
        let mut extending = unsafe { chain(info.p_next) };
        if extending.any(|found| !HARMLESS.contains(&vk::StructureType::from_raw(found.ty))) {
            return None;
        }
        let usage = info.usage | added;
        self.gpu()?.takes_image(info, usage).then_some(usage)
    }
}
