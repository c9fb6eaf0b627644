//! Vulkan objects that are destroyed when dropped.

use super::Gpu;
use std::sync::Arc;

/// A Vulkan object of ours with what destroys it.
pub(crate) struct Owned<H: Copy> {
    gpu: Arc<Gpu>,
    handle: H,
    destroy: unsafe fn(&ash::Device, H),
}

impl<H: Copy> Owned<H> {
    /// Takes ownership.
    ///
    /// # Safety
    /// `handle` was created on the device of `gpu`, is nobody else's to destroy, and `destroy` destroys objects
    /// of its type. Whoever keeps the result drops it only when no command buffer uses it any more.
    pub(super) unsafe fn new(gpu: &Arc<Gpu>, handle: H, destroy: unsafe fn(&ash::Device, H)) -> Self {
        Self { gpu: Arc::clone(gpu), handle, destroy }
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> H {
        self.handle
    }

    pub(super) fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }
}

impl<H: Copy> Drop for Owned<H> {
    fn drop(&mut self) {
        if !self.gpu.is_abandoned() {
            // SAFETY: the device is live, as it was not abandoned; the rest is what `new` asks for.
            unsafe { (self.destroy)(&self.gpu.device, self.handle) };
        }
    }
}
