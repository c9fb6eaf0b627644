//! Vulkan objects that are destroyed when dropped.

use super::Gpu;
use std::sync::Arc;

/// The handle of a Vulkan object.
pub(crate) trait Handle: Copy + Send + 'static {}

impl<H: Copy + Send + 'static> Handle for H {}

/// A Vulkan object of ours with the function that destroys it.
pub(crate) struct Owned<H: Handle> {
    gpu: Arc<Gpu>,
    handle: H,
    destroy: unsafe fn(&ash::Device, H),
}

impl<H: Handle> Owned<H> {
    /// Takes ownership.
    ///
    /// # Safety
    /// `handle` was created on the device of `gpu`, is not destroyed elsewhere, and `destroy` destroys objects of its type. The owner of
    /// the result drops it only when no command buffer uses it any more.
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

impl<H: Handle> Drop for Owned<H> {
    fn drop(&mut self) {
        let (handle, destroy) = (self.handle, self.destroy);
        if self.gpu.is_abandoned() {
            // SAFETY: the caller of the closure guarantees that the device is live, and that nothing uses the object; it is called once.
            self.gpu.leave(Box::new(move |device| unsafe { destroy(device, handle) }));
        } else {
            // SAFETY: the device is live, as it was not abandoned; `new` demands the other conditions.
            unsafe { destroy(&self.gpu.device, handle) };
        }
    }
}
