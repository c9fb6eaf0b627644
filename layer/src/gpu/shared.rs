//! Shared state of sessions on one device: objects that depend on no image and no queue.
//!
//! Some drivers keep memory for each pipeline that was ever made, so the pipelines of an ended session serve the next one.

use super::commands::wait_device;
use super::compare::Comparison;
use super::descriptor::interpolating;
use super::draw::make_color_pass;
use super::pipeline::{TilePipeline, TileShader, make_tile_pipeline};
use super::{Compiler, Gpu, GpuError, Later, Owned};
use crate::link::DeviceRecord;
use ash::vk;
use std::ffi::CStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Objects of one device, each made when it is first needed, and kept until [`Shared::end`].
pub struct Shared {
    gpu: Arc<Gpu>,
    compiler: Arc<Compiler>,
    tile_pipelines: Made<TileKey, TilePipeline>,
    comparisons: Made<(&'static [u8], &'static CStr), Comparison>,
    color_passes: Made<vk::Format, Owned<vk::RenderPass>>,
    interpolating: Made<(), Owned<vk::Sampler>>,
    /// Users of these objects.
    users: Mutex<Vec<Weak<Gpu>>>,
    /// Objects that their owners could not destroy, as the GPU may have used them, in their order.
    left: Mutex<Vec<Left>>,
    is_given_up: AtomicBool,
    has_ended: AtomicBool,
}

/// Destroys something of the device, which is live and does not use it any more.
pub(super) type Left = Box<dyn FnOnce(&ash::Device) + Send>;

#[derive(Clone, Copy, PartialEq)]
struct TileKey {
    format: vk::Format,
    spirv: &'static [u8],
    shader: TileShader,
}

impl Shared {
    /// Of a device on which nothing is made yet.
    ///
    /// # Safety
    /// `record` is of a live device, and [`Self::end`] is called before it dies, or the result and all that works with it are
    /// dropped before.
    ///
    /// # Errors
    /// [`GpuError::Missing`].
    pub unsafe fn new(record: &DeviceRecord) -> Result<Arc<Self>, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands; `end` ends the compiler, too.
        unsafe { Self::made_by(record, Compiler::of(record)) }
    }

    /// As [`Self::new`], with pipelines made by the thread that asks for them.
    ///
    /// # Safety
    /// As there.
    ///
    /// # Errors
    /// As there.
    pub(super) unsafe fn at_once(record: &DeviceRecord) -> Result<Arc<Self>, GpuError> {
        // SAFETY: as above.
        unsafe { Self::made_by(record, Compiler::at_once(record)) }
    }

    /// # Safety
    /// As for [`Self::new`].
    unsafe fn made_by(record: &DeviceRecord, compiler: Arc<Compiler>) -> Result<Arc<Self>, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let gpu = unsafe { Gpu::without_queue(record) }?;
        Ok(Arc::new(Self {
            gpu,
            compiler,
            tile_pipelines: Made::default(),
            comparisons: Made::default(),
            color_passes: Made::default(),
            interpolating: Made::default(),
            users: Mutex::default(),
            left: Mutex::default(),
            is_given_up: AtomicBool::new(false),
            has_ended: AtomicBool::new(false),
        }))
    }

    /// Notes that the device is about to be destroyed, while the application has no work in progress on it: destroys all shared and all
    /// left objects. If this still has users, nothing is destroyed, and no more work is done for them.
    pub fn end(&self) {
        self.has_ended.store(true, Ordering::Relaxed);
        self.compiler.end();
        let users = std::mem::take(&mut *self.users());
        let users: Vec<_> = users.iter().filter_map(Weak::upgrade).collect();
        users.iter().for_each(|user| user.abandon());
        let left = std::mem::take(&mut *self.left.lock().unwrap_or_else(PoisonError::into_inner));
        let is_stuck = self.gpu.is_abandoned() || !left.is_empty();
        // SAFETY: the device is live, and about to be destroyed by its application, which uses none of its queues meanwhile.
        if users.is_empty() && is_stuck && unsafe { wait_device(&self.gpu.device) } {
            self.gpu.abandoned.store(false, Ordering::Relaxed);
            left.into_iter().for_each(|destroy| destroy(&self.gpu.device));
        }
        self.tile_pipelines.clear();
        self.comparisons.clear();
        self.color_passes.clear();
        self.interpolating.clear();
        self.gpu.abandon();
    }

    /// Whether the device took no work of ours before.
    pub fn is_given_up(&self) -> bool {
        self.is_given_up.load(Ordering::Relaxed)
    }

    pub(super) fn give_up(&self) {
        self.is_given_up.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_used_by(&self, user: &Arc<Gpu>) {
        let mut users = self.users();
        users.retain(|known| known.strong_count() > 0);
        users.push(Arc::downgrade(user));
    }

    /// Destroys something when the device ends.
    pub(super) fn leave(&self, left: Left) {
        if !self.has_ended.load(Ordering::Relaxed) {
            self.left.lock().unwrap_or_else(PoisonError::into_inner).push(left);
        }
    }

    /// Objects that a user leaves, because the GPU may be using them, are not destroyed before the end either.
    pub(super) fn abandon(&self) {
        self.gpu.abandon();
    }

    /// Requests a shared object. If it cannot be made, the log states `otherwise`.
    pub(crate) fn ask<T: Send + Sync + 'static>(
        self: &Arc<Self>,
        otherwise: &'static str,
        make: impl FnOnce(&Self) -> Result<T, GpuError> + Send + 'static,
    ) -> Later<T> {
        let shared = Arc::clone(self);
        self.compiler.ask(otherwise, move |compilation| {
            shared.gpu.compile_with(compilation);
            make(&shared)
        })
    }

    /// Whether draws to images of this format can be blended with their content.
    pub(crate) fn can_blend(&self, format: vk::Format) -> bool {
        self.gpu.can_blend(format)
    }

    /// A pipeline that draws to attachments of `format` with entry points of a module of SPIR-V. Compiles, where it is the first.
    pub(crate) fn tile_pipeline(
        &self,
        format: vk::Format,
        spirv: &'static [u8],
        shader: &TileShader,
    ) -> Result<Arc<TilePipeline>, GpuError> {
        let key = TileKey { format, spirv, shader: *shader };
        self.tile_pipelines
            .get_or_make(key, || make_tile_pipeline(&self.gpu, &*self.color_pass(format)?, spirv, shader))
    }

    /// A pipeline of an entry point of a module of SPIR-V, as [`Comparison::make`] makes it. Compiles, where it is the first.
    pub(crate) fn comparison(
        &self,
        spirv: &'static [u8],
        entry: &'static CStr,
        has_depth: bool,
    ) -> Result<Arc<Comparison>, GpuError> {
        self.comparisons.get_or_make((spirv, entry), || Comparison::make(&self.gpu, spirv, entry, has_depth))
    }

    pub(super) fn color_pass(&self, format: vk::Format) -> Result<Arc<Owned<vk::RenderPass>>, GpuError> {
        self.color_passes.get_or_make(format, || make_color_pass(&self.gpu, format))
    }

    pub(super) fn interpolating(&self) -> Result<Arc<Owned<vk::Sampler>>, GpuError> {
        self.interpolating.get_or_make((), || interpolating(&self.gpu))
    }

    fn users(&self) -> MutexGuard<'_, Vec<Weak<Gpu>>> {
        self.users.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Objects of one kind, by their parameters; few enough for a list.
struct Made<K, V>(Mutex<Vec<(K, Arc<V>)>>);

impl<K, V> Default for Made<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: PartialEq, V> Made<K, V> {
    fn get_or_make(&self, key: K, make: impl FnOnce() -> Result<V, GpuError>) -> Result<Arc<V>, GpuError> {
        if let Some(known) = find(&self.lock(), &key) {
            return Ok(known);
        }
        // Made without the lock, which is not held across calls down: another thread may have been faster.
        let new = Arc::new(make()?);
        let mut made = self.lock();
        Ok(find(&made, &key).unwrap_or_else(|| {
            made.push((key, Arc::clone(&new)));
            Arc::clone(&new)
        }))
    }

    fn clear(&self) {
        let made = std::mem::take(&mut *self.lock());
        drop(made);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(K, Arc<V>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn find<K: PartialEq, V>(made: &[(K, Arc<V>)], key: &K) -> Option<Arc<V>> {
    made.iter().find(|(of, _)| of == key).map(|(_, known)| Arc::clone(known))
}
