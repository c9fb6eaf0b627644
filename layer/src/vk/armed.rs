//! State of an armed device.

use super::candidates::Candidates;
use super::frame::Frame;
use super::functions::ArmedTable;
use super::layouts::Layouts;
use super::objects::{Image, Objects, QueueId};
use super::perception::Perception;
use super::planned_texels::PlannedTexels;
use super::pre_submit::{PreSubmitRing, Submitter};
use super::queue_locks::QueueLocks;
use super::runtime_section;
use super::table::Table;
use super::timing::Timing;
use crate::backend::Backend;
use crate::backend::attachment::RateAttachments;
use crate::backend::mask::Masks;
use crate::gpu::Compiler;
use crate::gpu::functions::Functions;
use crate::link::{
    BACKEND_ANY, BACKEND_NONE, CapabilitiesRecord, DestroyDeviceCallback, DeviceRecord, SettingsRecord,
    SwapchainRecord,
};
use crate::pass_detection::{ImageKey, SwapchainKey};
use crate::rate_map::DeviceRates;
use ash::vk;
use parafovea_core::rate::ShadingRate;
use parafovea_manifest::options::PassRulesError;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A device of an enabled process whose loader lets layers make objects of their own.
pub struct Armed {
    /// The device, as the OpenXR half may know it.
    pub record: DeviceRecord,
    /// The next layer's functions under our hooks.
    pub next: ArmedTable,
    /// Its rate attachments; `None` without any.
    pub rate_attachments: Option<Arc<RateAttachments>>,
    /// Its masks, if there are no rate attachments.
    pub masks: Option<Arc<Masks>>,
    /// Its backend, if it has one.
    pub backend: Option<Box<dyn Backend>>,
    /// The rates that the backend offers.
    pub offered_rates: DeviceRates,
    /// The application's objects.
    pub objects: Objects,
    /// The layouts of swapchain images that the layer reads.
    pub layouts: Layouts,
    /// Targets of passes that may be the scene.
    pub candidates: Candidates,
    /// The current frame: the OpenXR half's plan, and the application's events.
    pub frame: Frame,
    /// The plan's rates as texels of maps.
    pub planned_texels: PlannedTexels,
    /// Our work ahead of the application's submits, by queue.
    pub rings: Table<vk::Queue, Arc<PreSubmitRing>>,
    /// Held during calls down on a queue.
    pub queue_locks: QueueLocks,
    /// Contrast of the pictures, and the decisions by it.
    pub perception: Perception,
    /// GPU time of its frames.
    pub timing: Timing,
    /// Whether any pipeline of the application was made with viewports of its own.
    has_static_viewports: AtomicBool,
    functions: OnceLock<Option<Functions>>,
    /// Callbacks for the end of the device.
    end_callbacks: Mutex<SmallVec<[DestroyDeviceCallback; 1]>>,
}

impl Armed {
    /// For the device of that record, with one of the backends or none.
    pub fn new(
        record: DeviceRecord,
        next: ArmedTable,
        rate_attachments: Option<Arc<RateAttachments>>,
        masks: Option<Arc<Masks>>,
    ) -> Self {
        let backend: Option<Box<dyn Backend>> = match (&rate_attachments, &masks) {
            (Some(rates), _) => Some(Box::new(Arc::clone(rates))),
            (None, Some(masks)) => Some(Box::new(Arc::clone(masks))),
            (None, None) => None,
        };
        let capabilities = backend.as_ref().map_or(NO_CAPABILITIES, |backend| backend.capabilities());
        let count = (capabilities.rate_count as usize).min(capabilities.rates.len());
        let rates = capabilities.rates[..count].iter().filter_map(|&texel| ShadingRate::from_texel(texel));
        Self {
            record,
            next,
            offered_rates: DeviceRates::new(rates),
            rate_attachments,
            masks,
            backend,
            objects: Objects::default(),
            layouts: Layouts::default(),
            candidates: Candidates::default(),
            frame: Frame::default(),
            planned_texels: PlannedTexels::default(),
            rings: Table::default(),
            queue_locks: QueueLocks::default(),
            perception: Perception::default(),
            timing: Timing::new(record.physical_device, capabilities.is_cpu != 0),
            has_static_viewports: AtomicBool::new(false),
            functions: OnceLock::new(),
            end_callbacks: Mutex::default(),
        }
    }

    /// Whether its passes are followed, because a backend may make them coarser. Without a backend, only the layouts in which passes leave
    /// images of XR swapchains count.
    pub fn follows_passes(&self) -> bool {
        self.backend.is_some()
    }

    /// Whether commands and objects of the runtime on this thread need no tracking: with rate attachments they do, because their rate images
    /// must be initialised.
    pub fn ignores_runtime(&self) -> bool {
        self.rate_attachments.is_none() && runtime_section::in_runtime_section()
    }

    /// The capabilities of the device's backend.
    pub fn capabilities(&self) -> CapabilitiesRecord {
        self.backend.as_ref().map_or(NO_CAPABILITIES, |backend| backend.capabilities())
    }

    /// The next layer's functions for our own work; `None` if a needed one is missing.
    pub fn functions(&self) -> Option<&Functions> {
        let load = || {
            // SAFETY: the record is of this device, which is live as long as calls for it come in.
            unsafe { Functions::load(&self.record) }
                .inspect_err(|error| error.log("no shading rates on this device"))
                .ok()
        };
        self.functions.get_or_init(load).as_ref()
    }

    /// Whether any pipeline of the application was made with viewports of its own, so that no command tells where it draws.
    pub fn has_static_viewports(&self) -> bool {
        self.has_static_viewports.load(Ordering::Relaxed)
    }

    /// The application makes a pipeline with viewports of its own.
    pub fn note_static_viewports(&self) {
        if !self.has_static_viewports.swap(true, Ordering::Relaxed) {
            tracing::info!(
                "a pipeline has static viewports: the layer assumes that each pass draws to its whole render area"
            );
        }
    }

    /// The parts with which work of ours is submitted; `None` if a needed function is missing.
    pub fn submitter(&self) -> Option<Submitter<'_>> {
        Some(Submitter {
            record: &self.record,
            functions: self.functions()?,
            submit: self.next.queue_submit?,
            locks: &self.queue_locks,
            timing: &self.timing,
            frame: &self.frame,
            rings: &self.rings,
        })
    }

    /// Takes the images of a swapchain, or, without any, forgets it.
    pub fn notify_swapchain(&self, record: &SwapchainRecord, images: &[vk::Image]) {
        let swapchain = SwapchainKey(record.swapchain);
        for former in self.frame.set_swapchain(swapchain, images) {
            self.layouts.forget(former);
            if let Some(gone) = self.objects.leave_swapchain(former) {
                self.forget_drawn(gone.description.key);
            }
        }
        if images.is_empty() {
            let reader = self.perception.forget_swapchain(record.swapchain);
            if let (Some(ring), Some(functions)) =
                (reader.and_then(|queue| self.rings.get(queue)), self.functions())
            {
                ring.wait(functions);
            }
        }
        let has_depth = record.usage.contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
        let layout = if has_depth {
            vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL
        } else {
            vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL
        };
        for &image in images {
            if record.is_read != 0 {
                self.layouts.follow(image, record.is_virtual != 0, layout);
            }
            self.objects.join_swapchain(image, swapchain, || Image::of_swapchain(image, record));
        }
    }

    /// No session is bound to the device any more.
    pub fn sessions_ended(&self) {
        // Passes of the application get no rates from now on, and maps become 1x1 with the next pass to their images.
        self.frame.set_on(false);
        self.frame.end_unlearned(&self.objects);
        self.perception.forget();
        if let Some(functions) = self.functions() {
            self.rings.all().iter().for_each(|ring| ring.poll(functions));
            self.planned_texels.forget(functions);
        }
    }

    /// Whether the application uses a swapchain's image on queues other than that one; before any submit with the image, whether it could.
    pub fn is_used_on_other_queues(&self, image: vk::Image, queue: QueueId) -> bool {
        self.layouts
            .is_used_on_other_queues(image, queue)
            .unwrap_or_else(|| self.objects.has_queue_beside(queue))
    }

    /// Forgets the passes that drew to an image that is about to be destroyed: the GPU is done with it.
    pub fn forget_drawn(&self, image: ImageKey) {
        self.candidates.forget(image);
        if self.masks.as_ref().is_some_and(|masks| masks.forget_image(image)) {
            self.candidates.forget_fills(image);
        }
    }

    /// Takes the settings of the configuration; `passes` are its rules on passes.
    pub fn notify_settings(&self, record: &SettingsRecord, passes: &[u8]) {
        let is_allowed = [BACKEND_ANY, self.capabilities().backend].contains(&record.backend);
        self.frame.set_on(record.is_on != 0 && is_allowed);
        self.timing.set_wanted(record.times_frames != 0 && is_allowed);
        self.frame.set_resting(record.is_on == 0 && record.times_frames == 0);
        if !self.frame.is_on() {
            self.perception.rest();
        }
        let rules = str::from_utf8(passes).map_err(|error| error.to_string());
        match rules.and_then(|rules| rules.parse().map_err(|error: PassRulesError| error.to_string())) {
            Ok(rules) => self.frame.log().set_rules(rules),
            Err(error) => tracing::warn!("rates.passes ignored: {error}"),
        }
    }

    /// Has `call` called when the application destroys the device.
    pub fn on_device_destroyed(&self, call: DestroyDeviceCallback) {
        self.end_callbacks.lock().unwrap_or_else(PoisonError::into_inner).push(call);
    }

    /// Waits for work of ours, and destroys our objects, before the device is destroyed.
    pub fn destroy_own(&self) {
        let callbacks =
            std::mem::take(&mut *self.end_callbacks.lock().unwrap_or_else(PoisonError::into_inner));
        Compiler::end_on(self.record.device);
        for callback in callbacks {
            // SAFETY: a function of the other half, which is never unloaded; the device is live.
            unsafe { callback(self.record.device) };
        }
        for (_, ring) in self.rings.remove_where(|_, _| true) {
            if let Some(functions) = self.functions() {
                ring.destroy(functions);
            }
        }
        if let Some(functions) = self.functions() {
            self.planned_texels.forget(functions);
        }
        self.candidates.clear();
        self.timing.clear();
        self.perception.end();
        if let Some(rates) = &self.rate_attachments {
            // SAFETY: the device is live until the call down, and the application does nothing on it any more.
            unsafe { rates.end() };
        }
        if let Some(masks) = &self.masks {
            // SAFETY: as above.
            unsafe { masks.end(self.next.destroy_render_pass, self.record.device) };
        }
    }
}

/// The capabilities of a device without a backend.
const NO_CAPABILITIES: CapabilitiesRecord =
    CapabilitiesRecord { backend: BACKEND_NONE, texel: [1, 1], rate_count: 0, rates: [0; 16], is_cpu: 0 };
