//! Descriptor sets, as far as draws may read attachments by them.
//!
//! Engines write thousands of descriptors a frame, and hardly one of them names an attachment. Filters rule out most of them without a
//! look-up.

use super::{Objects, View};
use crate::abi::copies::slice;
use crate::pass_detection::{ImageKey, Reads};
use crate::vk::table::Table;
use ash::vk;
use ash::vk::Handle;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// The descriptor sets of a device.
#[derive(Default)]
pub struct Descriptors {
    /// Sets with attachments, or with unknown content.
    sets: Table<vk::DescriptorSet, Held>,
    /// Number of sets added and not forgotten since.
    added: AtomicUsize,
    /// Whether all sets were ever forgotten.
    is_overrun: AtomicBool,
    /// Layouts of sets that are as good as unknown: with long arrays, or written after they were bound.
    open_layouts: Table<vk::DescriptorSetLayout, ()>,
    set_filter: Filter,
    view_filter: Filter,
}

/// The attachments of a set.
#[derive(Debug, Clone, Default)]
struct Held {
    /// Attachments by binding and element.
    images: SmallVec<[(u32, u32, ImageKey); 4]>,
    /// Whether it may hold others.
    is_open: bool,
}

/// Most sets with attachments that are kept. The sets that go with their pool are not reported: if an application makes ever more, all sets
/// are unknown from then on.
const MOST_SETS: usize = 1 << 16;

/// Least length of an array of all textures, of which unknown elements are read.
const LONG: u32 = 32;

/// Handles that may be of interest: none that is, is missing.
struct Filter([AtomicU64; Filter::WORDS]);

impl Filter {
    const WORDS: usize = 1024;

    fn place(handle: u64) -> (usize, u64) {
        // Fibonacci hashing: 2^64 divided by the golden ratio (Knuth, The Art of Computer Programming 3, 6.4). Sixteen bits are left.
        let hash = handle.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48;
        ((hash >> 6) as usize, 1 << (hash & 63))
    }

    fn add(&self, handle: u64) {
        let (word, bit) = Self::place(handle);
        self.0[word].fetch_or(bit, Ordering::Relaxed);
    }

    fn may_have(&self, handle: u64) -> bool {
        let (word, bit) = Self::place(handle);
        self.0[word].load(Ordering::Relaxed) & bit != 0
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self([const { AtomicU64::new(0) }; Self::WORDS])
    }
}

impl Descriptors {
    /// Whether a set may have attachments.
    pub fn may_read(&self, set: vk::DescriptorSet) -> bool {
        self.set_filter.may_have(set.as_raw()) || self.is_overrun.load(Ordering::Relaxed)
    }

    /// Adds the attachments that draws may read by a set.
    pub fn read(&self, set: vk::DescriptorSet, reads: &mut Reads) {
        reads.may_read_more |= self.is_overrun.load(Ordering::Relaxed);
        let Some(held) = self.sets.get(set) else { return };
        reads.may_read_more |= held.is_open;
        held.images.iter().for_each(|(_, _, image)| reads.push(*image));
    }

    /// A view is made of an image that passes draw colours to.
    pub fn add_view(&self, view: vk::ImageView) {
        self.view_filter.add(view.as_raw());
    }

    /// A layout is made.
    pub fn add_layout(&self, layout: vk::DescriptorSetLayout, is_open: bool) {
        if is_open {
            self.open_layouts.insert(layout, ());
        } else {
            // Of one of the same handle that is gone.
            self.open_layouts.remove(layout);
        }
    }

    /// A set is made, in place of one of the same handle.
    pub fn add_set(&self, set: vk::DescriptorSet, layout: vk::DescriptorSetLayout) {
        let is_open = self.open_layouts.get(layout).is_some();
        if is_open {
            self.open(set);
        } else if self.may_read(set) {
            self.forget(set);
        }
    }

    fn forget(&self, set: vk::DescriptorSet) {
        if self.sets.remove(set).is_some() {
            self.added.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// A set gets unknown content.
    pub fn open(&self, set: vk::DescriptorSet) {
        self.keep(set, Held { images: SmallVec::new(), is_open: true });
    }

    fn keep(&self, set: vk::DescriptorSet, held: Held) {
        self.set_filter.add(set.as_raw());
        let is_new = !self.sets.has(set);
        if is_new && self.added.fetch_add(1, Ordering::Relaxed) >= MOST_SETS {
            self.is_overrun.store(true, Ordering::Relaxed);
            drop(self.sets.remove_where(|_, _| true));
            self.added.store(0, Ordering::Relaxed);
        }
        self.sets.insert(set, held);
    }

    /// One element of a binding is written.
    pub fn write(&self, set: vk::DescriptorSet, at: (u32, u32), image: Option<ImageKey>) {
        if image.is_none() && !self.may_read(set) {
            return;
        }
        let known = self.sets.get(set);
        if image.is_none() && known.is_none() {
            return;
        }
        let mut held = known.unwrap_or_default();
        held.images.retain(|(binding, element, _)| (*binding, *element) != at);
        held.images.extend(image.map(|image| (at.0, at.1, image)));
        self.keep(set, held);
    }

    /// The attachment that a view is of, if it is of one.
    pub fn attachment(&self, objects: &Objects, view: vk::ImageView) -> Option<ImageKey> {
        if !self.view_filter.may_have(view.as_raw()) {
            return None;
        }
        objects.view(view).filter(|view| view.is_colour_target).map(|View { target, .. }| target.image)
    }
}

/// Whether descriptors of a kind name images that shaders read.
pub fn reads_image(kind: vk::DescriptorType) -> bool {
    use vk::DescriptorType as Kind;
    matches!(kind, Kind::COMBINED_IMAGE_SAMPLER | Kind::SAMPLED_IMAGE | Kind::STORAGE_IMAGE)
}

/// Whether the content of a layout's sets is unknown.
///
/// # Safety
///
/// Valid usage of vkCreateDescriptorSetLayout.
pub unsafe fn is_open(info: &vk::DescriptorSetLayoutCreateInfo<'_>) -> bool {
    use vk::DescriptorSetLayoutCreateFlags as Flags;
    // SAFETY: the array has that many valid elements, by the valid usage of vkCreateDescriptorSetLayout.
    let bindings = unsafe { slice(info.p_bindings, info.binding_count) };
    let is_long = |binding: &vk::DescriptorSetLayoutBinding<'_>| {
        let is_mutable = binding.descriptor_type == vk::DescriptorType::MUTABLE_EXT;
        is_mutable || (reads_image(binding.descriptor_type) && binding.descriptor_count >= LONG)
    };
    info.flags.intersects(Flags::UPDATE_AFTER_BIND_POOL | Flags::DESCRIPTOR_BUFFER_EXT)
        || bindings.iter().any(is_long)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(number: u64) -> vk::DescriptorSet {
        vk::DescriptorSet::from_raw(number)
    }

    fn read(descriptors: &Descriptors, of: vk::DescriptorSet) -> (Vec<u64>, bool) {
        let mut reads = Reads::default();
        descriptors.read(of, &mut reads);
        (reads.images.iter().map(|image| image.0).collect(), reads.may_read_more)
    }

    #[test]
    fn a_set_holds_what_was_written_last() {
        let descriptors = Descriptors::default();
        descriptors.write(set(1), (0, 0), None);
        assert!(!descriptors.may_read(set(1)), "it has no attachment");
        descriptors.write(set(1), (0, 0), Some(ImageKey(7)));
        descriptors.write(set(1), (3, 1), Some(ImageKey(8)));
        assert_eq!(read(&descriptors, set(1)), (vec![7, 8], false));
        descriptors.write(set(1), (0, 0), None);
        assert_eq!(read(&descriptors, set(1)), (vec![8], false));
        descriptors.write(set(1), (3, 1), Some(ImageKey(9)));
        assert_eq!(read(&descriptors, set(1)), (vec![9], false));
        // Another set of the same handle.
        descriptors.add_set(set(1), vk::DescriptorSetLayout::null());
        assert_eq!(read(&descriptors, set(1)), (vec![], false));
    }

    #[test]
    fn sets_of_open_layouts_may_hold_anything() {
        let descriptors = Descriptors::default();
        let layout = vk::DescriptorSetLayout::from_raw(1);
        descriptors.add_layout(layout, true);
        descriptors.add_set(set(1), layout);
        assert!(descriptors.may_read(set(1)));
        assert_eq!(read(&descriptors, set(1)), (vec![], true));
        descriptors.write(set(1), (0, 5), Some(ImageKey(7)));
        assert_eq!(read(&descriptors, set(1)), (vec![7], true));
        descriptors.add_layout(layout, false);
        descriptors.add_set(set(1), layout);
        assert_eq!(read(&descriptors, set(1)), (vec![], false));
    }

    #[test]
    fn long_arrays_and_late_writes_are_open() {
        let binding = vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER);
        let of = |count: u32, flags| {
            let bindings = [binding.descriptor_count(count)];
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings).flags(flags);
            // SAFETY: a valid structure.
            unsafe { is_open(&info) }
        };
        let none = vk::DescriptorSetLayoutCreateFlags::empty();
        assert!(!of(16, none) && of(LONG, none));
        assert!(of(1, vk::DescriptorSetLayoutCreateFlags::UPDATE_AFTER_BIND_POOL));
    }
}
