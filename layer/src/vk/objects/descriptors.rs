//! Descriptor sets, as far as draws may read attachments by them.
//!
//! Engines write thousands of descriptors a frame, and hardly one of them names an attachment. Filters rule out most of them without a
//! look-up.

mod allocated;
mod filter;
mod template;

use super::{Objects, View};
use crate::abi::copies::slice;
use crate::pass_detection::{ImageKey, Reads};
use crate::vk::table::Table;
use allocated::Allocated;
use ash::vk;
use ash::vk::Handle;
use filter::Filter;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use template::Template;

/// The descriptor sets of a device.
#[derive(Default)]
pub struct Descriptors {
    /// Sets with attachments, or with unknown content.
    sets: Table<vk::DescriptorSet, Held>,
    /// Number of `sets`.
    kept: AtomicUsize,
    /// Allocated sets by pool, some of them freed since.
    pools: Table<vk::DescriptorPool, Arc<Mutex<Allocated>>>,
    /// Number of sweeps of sets that went with their pool.
    sweeps: AtomicU32,
    is_sweeping: AtomicBool,
    /// Whether all sets were ever forgotten.
    is_overrun: AtomicBool,
    /// Layouts of sets that are as good as unknown: with long arrays, or written after they were bound.
    open_layouts: Table<vk::DescriptorSetLayout, ()>,
    templates: Table<vk::DescriptorUpdateTemplate, Arc<Template>>,
    /// All of `sets`, those with attachments, and views of attachments.
    set_filter: Filter,
    image_filter: Filter,
    view_filter: Filter,
}

/// The attachments of a set.
#[derive(Debug, Clone, Default)]
struct Held {
    /// Attachments by binding and element.
    images: SmallVec<[(u32, u32, ImageKey); 4]>,
    /// Whether it may hold others.
    is_open: bool,
    /// Whether it is a list of all textures: it held more attachments than one draw's reads can name, and names none from then on.
    is_global: bool,
    /// Number of sweeps before it was written.
    sweep: u32,
}

/// Most kept sets. Sets go with their pool without being named, so that beyond this number the sets of former pools are swept out; if more than
/// half of it stay, all sets are unknown from then on, and none is kept any more.
const MOST_SETS: usize = 1 << 16;

/// Least length of an array of all textures, with reads of unknown elements.
const LONG: u32 = 32;

impl Descriptors {
    /// Whether a set may have attachments.
    pub fn may_read(&self, set: vk::DescriptorSet) -> bool {
        self.set_filter.may_have(set.as_raw()) || self.is_overrun()
    }

    /// Whether a set may have known attachments.
    pub fn may_name(&self, set: vk::DescriptorSet) -> bool {
        self.image_filter.may_have(set.as_raw())
    }

    /// Adds the attachments that draws may read by a set.
    pub fn read(&self, set: vk::DescriptorSet, reads: &mut Reads) {
        if self.is_overrun() {
            reads.may_read_more = true;
            return;
        }
        let Some(held) = self.sets.get(set) else { return };
        reads.may_read_more |= held.is_open;
        held.images.iter().for_each(|(_, _, image)| reads.push(*image));
    }

    /// A view is made of an image that may hold a picture.
    pub fn add_view(&self, view: vk::ImageView) {
        self.view_filter.add(view.as_raw());
    }

    /// Such a view is destroyed.
    pub fn forget_view(&self, view: vk::ImageView) {
        self.view_filter.remove(view.as_raw());
    }

    /// A layout is made.
    pub fn add_layout(&self, layout: vk::DescriptorSetLayout, is_open: bool) {
        if is_open {
            self.open_layouts.insert(layout, ());
        } else {
            // Of one of the same handle that is gone.
            self.forget_layout(layout);
        }
    }

    /// A layout is destroyed.
    pub fn forget_layout(&self, layout: vk::DescriptorSetLayout) {
        self.open_layouts.remove(layout);
    }

    /// A template of updates is made of these entries; one of pushes is for that bind point.
    pub fn add_template(
        &self,
        template: vk::DescriptorUpdateTemplate,
        entries: &[vk::DescriptorUpdateTemplateEntry],
        point: vk::PipelineBindPoint,
    ) {
        self.templates.insert(template, Arc::new(Template::new(entries, point)));
    }

    /// A template is destroyed.
    pub fn forget_template(&self, template: vk::DescriptorUpdateTemplate) {
        self.templates.remove(template);
    }

    /// A live template.
    pub fn template(&self, template: vk::DescriptorUpdateTemplate) -> Option<Arc<Template>> {
        self.templates.get(template)
    }

    /// Sets are made of layouts, in place of sets of the same handles.
    pub fn add_sets(
        &self,
        pool: vk::DescriptorPool,
        sets: &[vk::DescriptorSet],
        layouts: &[vk::DescriptorSetLayout],
    ) {
        if self.is_overrun() {
            return;
        }
        let of_pool = self.pools.get(pool).unwrap_or_else(|| self.pools.get_or_insert(pool, Arc::default()));
        of_pool.lock().unwrap_or_else(PoisonError::into_inner).add(sets);
        for (set, layout) in sets.iter().zip(layouts) {
            let is_open = self.open_layouts.get(*layout).is_some();
            if is_open {
                self.keep_open(*set);
            } else if self.may_read(*set) {
                self.forget(*set);
            }
        }
    }

    /// Sets of a pool are freed.
    pub fn free_sets(&self, pool: vk::DescriptorPool, sets: &[vk::DescriptorSet]) {
        if self.is_overrun() {
            return;
        }
        if let Some(of_pool) = self.pools.get(pool) {
            of_pool.lock().unwrap_or_else(PoisonError::into_inner).freed.extend_from_slice(sets);
        }
        sets.iter().filter(|set| self.may_read(**set)).for_each(|set| self.forget(*set));
    }

    /// All sets of a pool are gone.
    pub fn clear_pool(&self, pool: vk::DescriptorPool) {
        if let Some(of_pool) = self.pools.get(pool) {
            of_pool.lock().unwrap_or_else(PoisonError::into_inner).clear();
        }
    }

    /// A pool is gone, with all of its sets.
    pub fn forget_pool(&self, pool: vk::DescriptorPool) {
        self.pools.remove(pool);
    }

    /// Whether all sets are unknown.
    fn is_overrun(&self) -> bool {
        self.is_overrun.load(Ordering::Relaxed)
    }

    /// A set has no content any more.
    pub fn forget(&self, set: vk::DescriptorSet) {
        if let Some(held) = self.sets.remove(set) {
            self.forgot(set, &held);
        }
    }

    /// A set is among `sets` no longer.
    fn forgot(&self, set: vk::DescriptorSet, held: &Held) {
        self.kept.fetch_sub(1, Ordering::Relaxed);
        self.set_filter.remove(set.as_raw());
        if !held.images.is_empty() {
            self.image_filter.remove(set.as_raw());
        }
    }

    /// A set gets unknown content.
    pub fn open(&self, set: vk::DescriptorSet) {
        if self.is_overrun() {
            return;
        }
        if !self.set_filter.may_have(set.as_raw()) || !self.sets.is(set, Held::is_nothing_but_open) {
            self.keep_open(set);
        }
    }

    fn keep_open(&self, set: vk::DescriptorSet) {
        self.keep(set, Held { is_open: true, ..Held::default() }, self.sets.get(set));
    }

    fn keep(&self, set: vk::DescriptorSet, held: Held, known: Option<Held>) {
        if known.is_none() {
            self.set_filter.add(set.as_raw());
            if self.kept.fetch_add(1, Ordering::Relaxed) >= MOST_SETS {
                self.sweep();
                if self.is_overrun() {
                    return;
                }
            }
        }
        match (known.is_some_and(|known| !known.images.is_empty()), !held.images.is_empty()) {
            (false, true) => self.image_filter.add(set.as_raw()),
            (true, false) => self.image_filter.remove(set.as_raw()),
            _ => {}
        }
        self.sets.insert(set, Held { sweep: self.sweeps.load(Ordering::Acquire), ..held });
    }

    /// Forgets sets that went with their pool.
    fn sweep(&self) {
        if self.is_sweeping.swap(true, Ordering::Acquire) {
            return;
        }
        // Sets that are written from now on stay, whether or not their pool was seen here.
        let sweep = self.sweeps.fetch_add(1, Ordering::AcqRel);
        let mut live = FxHashSet::default();
        for pool in self.pools.all() {
            live.extend(pool.lock().unwrap_or_else(PoisonError::into_inner).sets.iter().copied());
        }
        let is_gone = |set: &vk::DescriptorSet, held: &Held| held.sweep <= sweep && !live.contains(set);
        for (set, held) in self.sets.remove_where(is_gone) {
            self.forgot(set, &held);
        }
        if self.kept.load(Ordering::Relaxed) > MOST_SETS / 2 {
            self.is_overrun.store(true, Ordering::Relaxed);
            for (set, held) in self.sets.remove_where(|_, _| true) {
                self.forgot(set, &held);
            }
            drop(self.pools.remove_where(|_, _| true));
        }
        self.is_sweeping.store(false, Ordering::Release);
    }

    /// One element of a binding is written. Returns whether that changed the attachments of the set.
    pub fn write(&self, set: vk::DescriptorSet, at: (u32, u32), image: Option<ImageKey>) -> bool {
        if self.is_overrun()
            || (image.is_none() && !self.may_read(set))
            || self.sets.is(set, |held| held.is_global || held.has(at, image))
        {
            return false;
        }
        let known = self.sets.get(set);
        if image.is_none() && known.is_none() {
            return false;
        }
        let mut held = known.clone().unwrap_or_default();
        held.images.retain(|(binding, element, _)| (*binding, *element) != at);
        held.images.extend(image.map(|image| (at.0, at.1, image)));
        if held.is_open && held.images.len() > Reads::MOST {
            held.images.clear();
            held.is_global = true;
        }
        if held.images.is_empty() && !held.is_open {
            self.forget(set);
        } else {
            self.keep(set, held, known);
        }
        true
    }

    /// The attachment that a view is of, if it is of one.
    pub fn attachment(&self, objects: &Objects, view: vk::ImageView) -> Option<ImageKey> {
        if !self.view_filter.may_have(view.as_raw()) {
            return None;
        }
        objects.view(view).filter(|view| view.may_hold_picture).map(|View { target, .. }| target.image)
    }
}

impl Held {
    /// Whether an element of a binding is this attachment, or none.
    fn has(&self, at: (u32, u32), image: Option<ImageKey>) -> bool {
        let held = self.images.iter().find(|(binding, element, _)| (*binding, *element) == at);
        held.map(|(.., image)| *image) == image
    }

    fn is_nothing_but_open(&self) -> bool {
        self.is_open && self.images.is_empty()
    }
}

/// Whether descriptors of a kind name images that shaders read.
fn reads_image(kind: vk::DescriptorType) -> bool {
    use vk::DescriptorType as Kind;
    matches!(kind, Kind::COMBINED_IMAGE_SAMPLER | Kind::SAMPLED_IMAGE | Kind::STORAGE_IMAGE)
}

/// The views that shaders read images by, each with its binding and array element.
///
/// # Safety
///
/// Valid usage of the write.
pub unsafe fn written_views<'a>(
    write: &vk::WriteDescriptorSet<'a>,
) -> impl Iterator<Item = ((u32, u32), vk::ImageView)> + use<'a> {
    let binding = write.dst_binding;
    let count = if reads_image(write.descriptor_type) { write.descriptor_count } else { 0 };
    // SAFETY: writes of these types have so many images, by valid usage.
    let images: &'a [vk::DescriptorImageInfo] = unsafe { slice(write.p_image_info, count) };
    (write.dst_array_element..)
        .zip(images)
        .map(move |(element, image)| ((binding, element), image.image_view))
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
mod tests;
