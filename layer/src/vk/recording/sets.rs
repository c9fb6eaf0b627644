//! Descriptor sets that are bound in a command buffer, so that they can be bound again.

use crate::vk::functions::ArmedTable;
use ash::vk;
use smallvec::SmallVec;

/// The sets of one bind point.
#[derive(Debug, Clone, Default)]
pub struct BoundSets {
    /// In their order: sets that are bound with another layout disturb others, or do not, as they did.
    calls: SmallVec<[Call; 8]>,
    /// Whether something is bound that is not kept here.
    has_more: bool,
}

/// One call that bound sets.
#[derive(Debug, Clone, PartialEq)]
struct Call {
    layout: vk::PipelineLayout,
    first: u32,
    sets: SmallVec<[vk::DescriptorSet; 4]>,
    offsets: SmallVec<[u32; 4]>,
}

impl Call {
    /// Whether another call binds all that this one does.
    fn is_within(&self, first: u32, count: usize) -> bool {
        let end = |first: u32, count: usize| u64::from(first) + count as u64;
        self.first >= first && end(self.first, self.sets.len()) <= end(first, count)
    }
}

impl BoundSets {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.calls.clear();
        self.has_more = false;
    }

    /// Whether [`Self::restore`] binds everything again.
    pub fn is_complete(&self) -> bool {
        !self.has_more
    }

    /// Something is bound that is not kept.
    pub fn bind_more(&mut self) {
        self.has_more = true;
    }

    /// Sets are bound from number `first` on.
    pub fn bind(
        &mut self,
        layout: vk::PipelineLayout,
        first: u32,
        sets: &[vk::DescriptorSet],
        offsets: &[u32],
    ) {
        self.calls.retain(|call| !call.is_within(first, sets.len()));
        self.calls.push(Call { layout, first, sets: sets.into(), offsets: offsets.into() });
    }

    /// Binds them again, with the next layer's functions, as they were bound: sets that a call shares with a later one are valid
    /// too, as long as the command buffer is.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and these were its bound sets at that point.
    pub unsafe fn restore(
        &self,
        next: &ArmedTable,
        commands: vk::CommandBuffer,
        point: vk::PipelineBindPoint,
    ) {
        let Some(bind) = next.cmd_bind_descriptor_sets else { return };
        for Call { layout, first, sets, offsets } in &self.calls {
            let (count, offset_count) = (sets.len() as u32, offsets.len() as u32);
            // SAFETY: the command buffer is recording, as `# Safety` demands; the bound objects stay valid as long as it does.
            unsafe {
                bind(commands, point, *layout, *first, count, sets.as_ptr(), offset_count, offsets.as_ptr());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    fn sets(numbers: &[u64]) -> Vec<vk::DescriptorSet> {
        numbers.iter().map(|&number| vk::DescriptorSet::from_raw(number)).collect()
    }

    fn calls(bound: &BoundSets) -> Vec<(u64, u32, Vec<u64>, usize)> {
        let numbers = |call: &Call| call.sets.iter().map(|set| set.as_raw()).collect();
        let call = |call: &Call| (call.layout.as_raw(), call.first, numbers(call), call.offsets.len());
        bound.calls.iter().map(call).collect()
    }

    #[test]
    fn calls_are_kept_in_their_order_until_all_their_sets_are_bound_anew() {
        let layout = vk::PipelineLayout::from_raw;
        let mut bound = BoundSets::default();
        bound.bind(layout(1), 1, &sets(&[10, 11]), &[]);
        bound.bind(layout(2), 2, &sets(&[20]), &[64]);
        assert_eq!(calls(&bound), [(1, 1, vec![10, 11], 0), (2, 2, vec![20], 1)]);
        bound.bind(layout(3), 0, &sets(&[30, 31]), &[1, 2]);
        bound.bind(layout(3), 0, &sets(&[40, 41]), &[1, 2]);
        assert_eq!(calls(&bound), [(1, 1, vec![10, 11], 0), (2, 2, vec![20], 1), (3, 0, vec![40, 41], 2)]);
        bound.bind(layout(4), 0, &sets(&[50, 51, 52]), &[]);
        assert_eq!(calls(&bound), [(4, 0, vec![50, 51, 52], 0)]);
        assert!(bound.is_complete());
        bound.bind_more();
        assert!(!bound.is_complete());
        bound.clear();
        assert!(bound.is_complete() && calls(&bound).is_empty());
    }
}
