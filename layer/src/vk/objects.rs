//! Objects of the application on an armed device, as far as the rest needs to know them.
//!
//! Handles that are not dispatchable may be given to two objects of equal content at once; the later one is kept then,
//! and after either is destroyed neither is known, so that passes which use them are left alone.

pub mod descriptors;
pub mod framebuffers;
pub mod images;
pub mod queues;
pub mod render_passes;
pub mod views;

pub use descriptors::Descriptors;
pub use framebuffers::Framebuffer;
pub use images::Image;
pub use queues::QueueId;
pub use render_passes::RenderPass;
pub use views::View;

use super::table::Table;
use crate::pass_detection::{ImageDescription, ImageKey, Pass, SwapchainKey, Target};
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// All live objects of a device.
#[derive(Default)]
pub struct Objects {
    images: Table<vk::Image, Image>,
    handles: Table<ImageKey, vk::Image>,
    /// Images that were destroyed since the end of the last frame: earlier events with them still count.
    departed: Mutex<Vec<ImageDescription>>,
    pub views: Table<vk::ImageView, View>,
    pub render_passes: Table<vk::RenderPass, Arc<RenderPass>>,
    pub framebuffers: Table<vk::Framebuffer, Arc<Framebuffer>>,
    pools: Table<vk::CommandPool, Arc<Pool>>,
    pub queues: Table<vk::Queue, QueueId>,
    /// Descriptor sets with attachments.
    pub descriptors: Descriptors,
    /// Query pools that count samples.
    pub occlusion_pools: Table<vk::QueryPool, ()>,
}

impl Objects {
    /// A live image.
    pub fn image(&self, image: vk::Image) -> Option<Image> {
        self.images.get(image)
    }

    /// The live image of that key.
    pub fn image_of(&self, key: ImageKey) -> Option<Image> {
        self.images.get(self.handles.get(key)?).filter(|image| image.description.key == key)
    }

    /// A live view.
    pub fn view(&self, view: vk::ImageView) -> Option<View> {
        self.views.get(view)
    }

    /// A live render pass.
    pub fn render_pass(&self, pass: vk::RenderPass) -> Option<Arc<RenderPass>> {
        self.render_passes.get(pass)
    }

    /// A live framebuffer.
    pub fn framebuffer(&self, framebuffer: vk::Framebuffer) -> Option<Arc<Framebuffer>> {
        self.framebuffers.get(framebuffer)
    }

    /// Family and index of a queue that the application asked for.
    pub fn queue(&self, queue: vk::Queue) -> Option<QueueId> {
        self.queues.get(queue)
    }

    /// Whether the application has asked for another queue than that one.
    pub fn has_queue_beside(&self, queue: QueueId) -> bool {
        self.queues.all().iter().any(|other| *other != queue)
    }

    /// A live command pool.
    pub fn pool(&self, pool: vk::CommandPool) -> Option<Arc<Pool>> {
        self.pools.get(pool)
    }

    /// Begins to keep a command pool.
    pub fn add_pool(&self, pool: vk::CommandPool) {
        self.pools.insert(pool, Arc::new(Pool::default()));
    }

    /// Forgets a command pool.
    pub fn remove_pool(&self, pool: vk::CommandPool) -> Option<Arc<Pool>> {
        self.pools.remove(pool)
    }

    /// Whether queries of that pool count samples.
    pub fn counts_samples(&self, pool: vk::QueryPool) -> bool {
        self.occlusion_pools.get(pool).is_some()
    }

    /// Begins to keep an image, in place of one of the same handle.
    pub fn add_image(&self, image: Image) {
        self.remove_image(image.handle);
        self.handles.insert(image.description.key, image.handle);
        self.images.insert(image.handle, image);
    }

    pub fn remove_image(&self, image: vk::Image) -> Option<Image> {
        let known = self.images.remove(image)?;
        self.handles.remove(known.description.key);
        let mut departed = self.departed();
        if departed.len() < MOST_DEPARTED {
            departed.push(known.description);
        }
        Some(known)
    }

    /// Notes that an image belongs to a swapchain. An image that was not made through this layer, such as ours, is kept from now on, as
    /// `otherwise` describes it.
    pub fn join_swapchain(
        &self,
        image: vk::Image,
        swapchain: SwapchainKey,
        otherwise: impl FnOnce() -> Image,
    ) {
        let mut is_known = false;
        self.images.change(image, |known| {
            known.description.swapchain = Some(swapchain);
            is_known = true;
        });
        if !is_known {
            self.add_image(otherwise());
        }
    }

    /// Notes that an image no longer belongs to a swapchain. An image that was not made through this layer is forgotten, and returned.
    pub fn leave_swapchain(&self, image: vk::Image) -> Option<Image> {
        let mut is_foreign = false;
        self.images.change(image, |known| {
            known.description.swapchain = None;
            is_foreign = known.is_foreign;
        });
        if is_foreign { self.remove_image(image) } else { None }
    }

    /// The first colour target of a pass, with its description, and whether the pass has depth; `None` if the image is not live.
    pub fn first_color(&self, pass: &Pass) -> Option<(Target, ImageDescription, bool)> {
        let target = *pass.colors.first()?;
        Some((target, self.image_of(target.image)?.description, pass.depth.is_some()))
    }

    /// The description of an image that is live, or was in this frame.
    pub fn describe(&self, key: ImageKey) -> Option<ImageDescription> {
        let departed = || self.departed().iter().find(|image| image.key == key).copied();
        self.image_of(key).map(|image| image.description).or_else(departed)
    }

    /// Forgets the images that were destroyed, at the end of a frame.
    pub fn forget_departed(&self) {
        self.departed().clear();
    }

    fn departed(&self) -> MutexGuard<'_, Vec<ImageDescription>> {
        self.departed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Most descriptions of destroyed images that are kept, if no frames end.
const MOST_DEPARTED: usize = 1024;

/// A live command pool.
#[derive(Debug, Default)]
pub struct Pool {
    buffers: Mutex<Vec<vk::CommandBuffer>>,
}

impl Pool {
    /// Its live command buffers.
    pub fn buffers(&self) -> MutexGuard<'_, Vec<vk::CommandBuffer>> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A key that no image had before.
fn new_key() -> ImageKey {
    static LAST: AtomicU64 = AtomicU64::new(0);
    ImageKey(LAST.fetch_add(1, Ordering::Relaxed) + 1)
}
