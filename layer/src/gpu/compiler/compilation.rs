//! The pipeline cache of one device.

use super::file::CacheFile;
use crate::cache_file;
use crate::gpu::GpuError;
use crate::gpu::functions::Functions;
use crate::link::DeviceRecord;
use ash::vk;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The compilation of pipelines of ours.
#[derive(Default)]
pub(crate) struct Compilation {
    has_ended: AtomicBool,
    open: Mutex<Option<Open>>,
}

/// A cache that was made.
struct Open {
    device: ash::Device,
    handle: vk::PipelineCache,
    file: CacheFile,
    /// Size of the data that the file has, bytes: data of a cache only grows.
    written_bytes: usize,
}

impl Compilation {
    /// Makes the cache, with the data of earlier launches; nothing is kept where that fails.
    ///
    /// # Safety
    /// The record is of a live device, on which [`Self::close`] is called before it is destroyed.
    pub(super) unsafe fn open(&self, record: &DeviceRecord) {
        if self.opened().is_some() {
            return;
        }
        let Some(folder) = cache_file::folder() else { return };
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let Ok(Functions { instance, device }) = (unsafe { Functions::load(record) }) else { return };
        // SAFETY: the physical device is one of this live instance.
        let properties = unsafe { instance.get_physical_device_properties(record.physical_device) };
        let file = CacheFile::new(&folder, &properties);
        let data = file.read().unwrap_or_default();
        let make = |data: &[u8]| {
            let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
            // SAFETY: the device is live; the data is complete, and the same driver wrote it for the same device.
            unsafe { device.create_pipeline_cache(&info, None) }
        };
        match make(&data) {
            Ok(handle) => {
                tracing::debug!("pipeline cache: {} bytes from earlier launches", data.len());
                *self.opened() = Some(Open { device, handle, file, written_bytes: data.len() });
            }
            Err(error) => {
                tracing::debug!("pipelines are not cached: vkCreatePipelineCache returned {error:?}")
            }
        }
    }

    /// The cache to compile with, none if it could not be made.
    ///
    /// # Errors
    /// [`GpuError::Abandoned`] once nothing more is to be compiled.
    pub(in crate::gpu) fn cache(&self) -> Result<vk::PipelineCache, GpuError> {
        if self.has_ended() {
            return Err(GpuError::Abandoned);
        }
        Ok(self.opened().as_ref().map_or(vk::PipelineCache::null(), |open| open.handle))
    }

    /// Writes the data for the next launch, where it has grown.
    pub(super) fn save(&self) {
        let mut opened = self.opened();
        let Some(Open { device, handle, file, written_bytes }) = &mut *opened else { return };
        // SAFETY: device and cache are live until `close`.
        let data = match unsafe { device.get_pipeline_cache_data(*handle) } {
            Ok(data) => data,
            Err(error) => {
                return tracing::debug!(
                    "pipelines are not cached: vkGetPipelineCacheData returned {error:?}"
                );
            }
        };
        if data.len() == *written_bytes {
            return;
        }
        *written_bytes = data.len();
        if let Err(error) = file.write(&data) {
            tracing::debug!("pipelines are not cached: {error}");
        }
    }

    /// Nothing more is to be compiled.
    pub(super) fn end(&self) {
        self.has_ended.store(true, Ordering::Relaxed);
    }

    pub(super) fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Relaxed)
    }

    /// Destroys the cache, which no compilation uses any more.
    pub(super) fn close(&self) {
        if let Some(Open { device, handle, .. }) = self.opened().take() {
            // SAFETY: `open`'s caller vouched for the device; the cache is destroyed once.
            unsafe { device.destroy_pipeline_cache(handle, None) };
        }
    }

    fn opened(&self) -> MutexGuard<'_, Option<Open>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
