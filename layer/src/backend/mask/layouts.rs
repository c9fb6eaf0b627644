//! Pipeline layouts with a set of ours behind the application's, for fragment shaders that return early. They are created together with the
//! application's own, because the set layouts of those may be destroyed before one is needed.

use super::Masks;
use crate::abi::copies::slice;
use crate::gpu::{AppendedLayout, ReturnLayout};
use ash::vk;
use std::sync::{Arc, MutexGuard, PoisonError};

/// Largest number of attachments on any device; they count as resources of the fragment stage.
const MOST_ATTACHMENTS: u32 = 16;

/// The facts of a descriptor set layout that count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetFacts {
    /// Storage buffers and uniform ones, for any stage: no stage sees more.
    buffers: [u32; 2],
    /// All descriptors that fragment shaders see.
    seen: u32,
    /// Whether its descriptors are in buffers (VK_EXT_descriptor_buffer): all of a pipeline's sets must be such.
    is_in_buffer: bool,
}

impl SetFacts {
    /// # Safety
    ///
    /// Valid usage of vkCreateDescriptorSetLayout.
    unsafe fn of(info: &vk::DescriptorSetLayoutCreateInfo<'_>) -> Self {
        use vk::DescriptorType as Kind;
        // SAFETY: the array has that many valid elements, by the valid usage of vkCreateDescriptorSetLayout.
        let bindings = unsafe { slice(info.p_bindings, info.binding_count) };
        let is_seen = |binding: &&vk::DescriptorSetLayoutBinding<'_>| {
            binding.stage_flags.contains(vk::ShaderStageFlags::FRAGMENT)
        };
        let count = |binding: &vk::DescriptorSetLayoutBinding<'_>| binding.descriptor_count;
        let sum = |counts: u32, count: u32| counts.saturating_add(count);
        let of = |kinds: [Kind; 2]| {
            bindings.iter().filter(|binding| kinds.contains(&binding.descriptor_type)).map(count).fold(0, sum)
        };
        Self {
            buffers: [
                of([Kind::STORAGE_BUFFER, Kind::STORAGE_BUFFER_DYNAMIC]),
                of([Kind::UNIFORM_BUFFER, Kind::UNIFORM_BUFFER_DYNAMIC]),
            ],
            seen: bindings.iter().filter(is_seen).map(count).fold(0, sum),
            is_in_buffer: info.flags.contains(vk::DescriptorSetLayoutCreateFlags::DESCRIPTOR_BUFFER_EXT),
        }
    }
}

impl Masks {
    /// The layout of the set of ours.
    pub(super) fn return_layout(&self) -> Option<Arc<ReturnLayout>> {
        if let Some(known) = &*self.kept_return_layout() {
            return Some(Arc::clone(known));
        }
        // Made without the lock, which is not held across calls down: another thread may have been faster.
        let made = ReturnLayout::new(self.gpu()?);
        let made = made.inspect_err(|error| error.log("no fragment shader returns early")).ok()?;
        Some(Arc::clone(self.kept_return_layout().get_or_insert_with(|| Arc::new(made))))
    }

    pub(super) fn kept_return_layout(&self) -> MutexGuard<'_, Option<Arc<ReturnLayout>>> {
        self.return_layout.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A copy of a created layout with a set of ours behind its sets; `None` if the device does not support it, or part of it is not known.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreatePipelineLayout.
    unsafe fn appended(&self, info: &vk::PipelineLayoutCreateInfo<'_>) -> Option<Arc<AppendedLayout>> {
        // Parts of pipelines are linked by such, which are left alone.
        if info.flags.contains(vk::PipelineLayoutCreateFlags::INDEPENDENT_SETS_EXT) || !info.p_next.is_null()
        {
            return None;
        }
        // SAFETY: the array has that many valid elements, by the valid usage of vkCreatePipelineLayout.
        let sets = unsafe { slice(info.p_set_layouts, info.set_layout_count) };
        let mut buffers = [ReturnLayout::BUFFERS; 2];
        let mut seen = 2 * ReturnLayout::BUFFERS + MOST_ATTACHMENTS;
        for set in sets {
            let facts = self.sets.get(*set).filter(|facts| !facts.is_in_buffer)?;
            buffers = std::array::from_fn(|index| buffers[index].saturating_add(facts.buffers[index]));
            seen = seen.saturating_add(facts.seen);
        }
        let gpu = self.gpu()?;
        if !gpu.takes_sets(info.set_layout_count + 1, buffers, seen) {
            return None;
        }
        // SAFETY: the structure is valid, by the valid usage of vkCreatePipelineLayout; the device takes it.
        let made = unsafe { AppendedLayout::new(gpu, info, &*self.return_layout()?) };
        made.inspect_err(|error| error.log("fragment shaders of a layout do not return early"))
            .ok()
            .map(Arc::new)
    }

    /// Keeps the facts of a set layout of the application.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreateDescriptorSetLayout.
    pub unsafe fn add_set_layout(
        &self,
        layout: vk::DescriptorSetLayout,
        info: &vk::DescriptorSetLayoutCreateInfo<'_>,
    ) {
        // SAFETY: `info` is valid, as this function requires.
        self.sets.insert(layout, unsafe { SetFacts::of(info) });
    }

    /// A set layout of the application is about to be destroyed.
    pub fn forget_set_layout(&self, layout: vk::DescriptorSetLayout) {
        self.sets.remove(layout);
    }

    /// Creates the appended layout of a pipeline layout of the application.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreatePipelineLayout.
    pub unsafe fn add_layout(&self, layout: vk::PipelineLayout, info: &vk::PipelineLayoutCreateInfo<'_>) {
        // SAFETY: `info` is valid, as this function requires.
        match unsafe { self.appended(info) } {
            Some(appended) => self.layouts.insert(layout, appended),
            None => drop(self.layouts.remove(layout)),
        }
    }

    /// A pipeline layout of the application is about to be destroyed.
    pub fn forget_layout(&self, layout: vk::PipelineLayout) {
        drop(self.layouts.remove(layout));
    }

    /// The appended layout of one of the application's.
    pub(super) fn layout(&self, layout: vk::PipelineLayout) -> Option<Arc<AppendedLayout>> {
        self.layouts.get(layout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptors_are_counted_by_kind_and_stage() {
        let binding = |kind, count, stages| {
            vk::DescriptorSetLayoutBinding::default()
                .descriptor_type(kind)
                .descriptor_count(count)
                .stage_flags(stages)
        };
        let both = vk::ShaderStageFlags::FRAGMENT | vk::ShaderStageFlags::VERTEX;
        let bindings = [
            binding(vk::DescriptorType::STORAGE_BUFFER, 2, both),
            binding(vk::DescriptorType::STORAGE_BUFFER_DYNAMIC, 1, vk::ShaderStageFlags::ALL),
            binding(vk::DescriptorType::STORAGE_BUFFER, 8, vk::ShaderStageFlags::VERTEX),
            binding(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC, 2, vk::ShaderStageFlags::VERTEX),
            binding(vk::DescriptorType::SAMPLED_IMAGE, u32::MAX, vk::ShaderStageFlags::FRAGMENT),
        ];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: a valid structure.
        let facts = unsafe { SetFacts::of(&info) };
        assert_eq!(facts, SetFacts { buffers: [11, 2], seen: u32::MAX, is_in_buffer: false });
    }
}
