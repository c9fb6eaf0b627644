//! Templates of updates of descriptor sets.

use super::reads_image;
use ash::vk;
use smallvec::SmallVec;
use std::ffi::c_void;

/// The images in the data of an update.
#[derive(Debug, PartialEq, Eq)]
pub struct Template {
    images: SmallVec<[Images; 4]>,
    /// The bind point of pushes.
    point: vk::PipelineBindPoint,
}

/// Images of one binding (`VkDescriptorUpdateTemplateEntry`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Images {
    binding: u32,
    /// The first array element.
    element: u32,
    count: u32,
    /// Offset of the first `VkDescriptorImageInfo`, and the distance to the next one, bytes.
    offset: usize,
    stride: usize,
}

impl Template {
    /// Of these entries; `point` counts where it is a template of pushes.
    pub fn new(entries: &[vk::DescriptorUpdateTemplateEntry], point: vk::PipelineBindPoint) -> Self {
        let images = entries.iter().filter(|entry| reads_image(entry.descriptor_type));
        let images = images.map(|entry| Images {
            binding: entry.dst_binding,
            element: entry.dst_array_element,
            count: entry.descriptor_count,
            offset: entry.offset,
            stride: entry.stride,
        });
        Self { images: images.collect(), point }
    }

    /// Whether pushes by it are for drawing.
    pub fn draws(&self) -> bool {
        self.point == vk::PipelineBindPoint::GRAPHICS
    }

    /// The views that shaders read images by, each with its binding and array element.
    ///
    /// # Safety
    ///
    /// `data` holds valid descriptors at the places of the entries.
    pub unsafe fn views(
        &self,
        data: *const c_void,
    ) -> impl Iterator<Item = ((u32, u32), vk::ImageView)> + use<'_> {
        self.images.iter().flat_map(move |images| {
            (0..images.count).map(move |number| {
                let offset = images.offset.wrapping_add(images.stride.wrapping_mul(number as usize));
                let info = data.cast::<u8>().wrapping_add(offset).cast::<vk::DescriptorImageInfo>();
                // SAFETY: a descriptor lies there, as `# Safety` demands; no alignment of the data is demanded.
                let view = unsafe { info.read_unaligned() }.image_view;
                ((images.binding, images.element + number), view)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    fn entry(
        binding: u32,
        [element, count]: [u32; 2],
        kind: vk::DescriptorType,
        [offset, stride]: [usize; 2],
    ) -> vk::DescriptorUpdateTemplateEntry {
        vk::DescriptorUpdateTemplateEntry {
            dst_binding: binding,
            dst_array_element: element,
            descriptor_count: count,
            descriptor_type: kind,
            offset,
            stride,
        }
    }

    #[test]
    fn views_are_read_at_the_places_of_the_entries() {
        use vk::DescriptorType as Kind;
        let size = size_of::<vk::DescriptorImageInfo>();
        let mut data = vec![0_u8; 6 * size + 1];
        let mut put = |offset: usize, view: u64| {
            let view = vk::ImageView::from_raw(view);
            let info = vk::DescriptorImageInfo::default().image_view(view);
            // SAFETY: the data is long enough.
            unsafe { data.as_mut_ptr().add(offset).cast::<vk::DescriptorImageInfo>().write_unaligned(info) };
        };
        put(1, 7);
        put(1 + size, 8);
        put(1 + 3 * size, 9);
        put(1 + 5 * size, 10);
        let entries = [
            entry(4, [0, 1], Kind::SAMPLED_IMAGE, [1, 0]),
            entry(2, [0, 3], Kind::UNIFORM_BUFFER, [0, 8]),
            entry(5, [0, 1], Kind::SAMPLER, [1, 0]),
            entry(6, [3, 3], Kind::COMBINED_IMAGE_SAMPLER, [1 + size, 2 * size]),
            entry(7, [0, 0], Kind::STORAGE_IMAGE, [usize::MAX, usize::MAX]),
        ];
        let template = Template::new(&entries, vk::PipelineBindPoint::GRAPHICS);
        // SAFETY: the data holds descriptors at these places.
        let views: Vec<_> =
            unsafe { template.views(data.as_ptr().cast()) }.map(|(at, view)| (at, view.as_raw())).collect();
        assert_eq!(views, [((4, 0), 7), ((6, 3), 8), ((6, 4), 9), ((6, 5), 10)]);
    }
}
