//! Bound descriptor buffers, and their bind after work of ours.

use crate::abi::copies::find;
use crate::abi::pnext::chain;
use crate::vk::functions::ArmedTable;
use ash::vk;
use smallvec::SmallVec;

/// A bound descriptor buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BoundBuffer {
    pub(super) address: vk::DeviceAddress,
    pub(super) usage: vk::BufferUsageFlags,
    /// Replaces `usage`, if there is one (`VkBufferUsageFlags2CreateInfo`).
    pub(super) usage2: Option<vk::BufferUsageFlags2KHR>,
    /// The buffer itself, for push descriptors of some devices.
    pub(super) push: Option<vk::Buffer>,
}

/// `VkBufferUsageFlags2CreateInfo`.
pub(super) type Usage2<'a> = vk::BufferUsageFlags2CreateInfoKHR<'a>;

/// `VkDescriptorBufferBindingPushDescriptorBufferHandleEXT`.
pub(super) type PushBuffer<'a> = vk::DescriptorBufferBindingPushDescriptorBufferHandleEXT<'a>;

impl BoundBuffer {
    /// Of the application's structure; `None` if its chain has structures of another kind.
    ///
    /// # Safety
    ///
    /// The chain is valid.
    pub(super) unsafe fn read(info: &vk::DescriptorBufferBindingInfoEXT<'_>) -> Option<Self> {
        // SAFETY: the chain is valid, as `# Safety` demands.
        let (usage2, push, all) = unsafe {
            (find::<Usage2<'_>>(info.p_next), find::<PushBuffer<'_>>(info.p_next), chain(info.p_next).count())
        };
        let is_whole = all == usize::from(usage2.is_some()) + usize::from(push.is_some());
        is_whole.then_some(Self {
            address: info.address,
            usage: info.usage,
            usage2: usage2.map(|found| found.usage),
            push: push.map(|found| found.buffer),
        })
    }
}

/// Binds buffers again, with the next layer's functions.
///
/// # Safety
///
/// `commands` is recording, and they were bound in it.
pub(super) unsafe fn restore(buffers: &[BoundBuffer], next: &ArmedTable, commands: vk::CommandBuffer) {
    let Some(bind) = next.cmd_bind_descriptor_buffers.filter(|_| !buffers.is_empty()) else {
        return;
    };
    let usages = buffers.iter().map(|of| Usage2::default().usage(of.usage2.unwrap_or_default()));
    let mut usages: SmallVec<[Usage2<'_>; 2]> = usages.collect();
    let pushed = buffers.iter().map(|of| PushBuffer::default().buffer(of.push.unwrap_or_default()));
    let mut pushed: SmallVec<[PushBuffer<'_>; 2]> = pushed.collect();
    let mut infos: SmallVec<[vk::DescriptorBufferBindingInfoEXT<'_>; 2]> = SmallVec::new();
    for (of, (usage2, push)) in buffers.iter().zip(usages.iter_mut().zip(&mut pushed)) {
        let mut info = vk::DescriptorBufferBindingInfoEXT::default().address(of.address).usage(of.usage);
        if of.usage2.is_some() {
            usage2.p_next = info.p_next;
            info.p_next = std::ptr::from_mut(usage2).cast();
        }
        if of.push.is_some() {
            push.p_next = info.p_next;
            info.p_next = std::ptr::from_mut(push).cast();
        }
        infos.push(info);
    }
    // SAFETY: the command buffer is recording, as `# Safety` demands; buffers of its earlier calls stay valid while it records.
    unsafe { bind(commands, infos.len() as u32, infos.as_ptr()) };
}
