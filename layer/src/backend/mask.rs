//! The mask: shading rates on devices without any. Pixels that need no shading are kept from it by a depth template, and filled after the
//! pass.
//!
//! A pass is decided on when it begins to be recorded, by the recordings and the recognition of its target in earlier frames. For an
//! [`eligible`] pass, the depth buffer is filled from a [`DepthTemplate`] ahead of the pass, which then loads depth where the application
//! clears it; where the application loads depth, skipped blocks are covered in that, and where it needs depth later, they are filled (see
//! [`crate::kernels::nearest`]). In a pass without depth, or with depth that must not change, fragment shaders return early in skipped blocks
//! instead (see [`MaskMethod`]). Directly after the pass, a [`ColorFill`] fills the skipped blocks of every stored colour
//! attachment. All of it is recorded once; the content of the template and of the skip list decides the skipped blocks, and changes between submits.

mod attachments;
mod color_fill;
mod decision;
mod early_return;
mod early_return_pipeline;
mod eligibility;
mod images;
mod kernels;
mod layouts;
mod loading;
mod map;
mod method;
mod open_mask;
mod parts;
mod pass;
mod pending;
mod pipelines;
mod recipe;
mod shader_objects;
mod target;
mod template;
mod usage;
mod views;

pub(crate) use attachments::{Attachments, rendering_attachments};
pub use color_fill::{ColorFill, FillKind};
pub(crate) use decision::PassContext;
pub use early_return::{EarlyReturn, NoEarlyReturn, returning_early};
pub(crate) use early_return_pipeline::{EarlyReturnPipeline, follow_graphics, follows_graphics};
pub use eligibility::{
    ColorFacts, DepthFacts, DepthWork, Directions, DynamicStencil, Eligible, MaskFacts, PipelineFacts,
    depth_format, eligible,
};
pub use images::added_usage;
pub use kernels::MaskKernels;
pub use map::MaskMap;
pub use method::{EarlyReturnSupport, MaskMethod, method};
pub(crate) use open_mask::OpenMask;
pub(crate) use pending::{Pending, Prepasses};
pub(crate) use target::{Ended, TargetMask};
pub use template::DepthTemplate;
pub use views::{mask_views, resolve_mask};

use crate::backend::{Backend, RateMap};
use crate::gpu::{AppendedLayout, Compilation, Compiler, Gpu, GpuError, Later, ReturnLayout};
use crate::kernels::samples::{SampleKernel, SampleKind};
use crate::link::{BACKEND_MASK, CapabilitiesRecord, DeviceRecord};
use crate::pass_detection::{ImageKey, Pass, Target};
use crate::vk::objects::Image;
use crate::vk::shaders::ShaderModules;
use crate::vk::table::Table;
use ash::vk;
use parafovea_core::rate::VULKAN_RATES;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Size of a tile, pixels: four columns of blocks, as many as after which every pattern repeats.
const TEXEL: [u32; 2] = [16, 16];

/// The mask of a device.
pub struct Masks {
    record: DeviceRecord,
    /// Made when it is first needed: while a device is being created, the Vulkan loader answers no questions.
    gpu: OnceLock<Option<Arc<Gpu>>>,
    is_cpu: bool,
    /// Whether a pass has had a template.
    has_template: AtomicBool,
    /// Requested with the first mask; `None` if there is no device to compile on.
    kernels: Mutex<Option<Later<MaskKernels>>>,
    /// Kernels for images of several samples, requested with the first mask of a pass that draws to such an image.
    sample_kernels: Table<SampleKind, Arc<Later<SampleKernel>>>,
    /// Render passes that load depth where the application's clear it, by those.
    loading: Table<vk::RenderPass, vk::RenderPass>,
    modules: ShaderModules,
    pipelines: Table<vk::Pipeline, PipelineFacts>,
    /// Fragment shaders without pipelines.
    shader_objects: Table<vk::ShaderEXT, PipelineFacts>,
    /// Code of pipelines whose fragment shaders return early.
    codes: recipe::Codes,
    sets: Table<vk::DescriptorSetLayout, layouts::SetFacts>,
    layouts: Table<vk::PipelineLayout, Arc<AppendedLayout>>,
    return_layout: Mutex<Option<Arc<ReturnLayout>>>,
    compatible: Table<vk::RenderPass, loading::Compatible>,
    returning: Table<vk::Pipeline, Arc<EarlyReturnPipeline>>,
    /// Images that a pass was seen to load.
    loaded: Table<ImageKey, ()>,
    /// The depth that a pass cleared each depth image to last.
    cleared: Table<ImageKey, f32>,
    /// The colour of passes that go on with depth of several samples which an earlier pass without colour has cleared, by that depth, and how
    /// many passes of the command buffer cleared it before.
    chains: Table<(ImageKey, u32), Target>,
    /// Images of several samples that maps have fills of.
    filled: Table<ImageKey, ()>,
    /// Whether an application's pipeline has dynamic state that pipelines of ours would change and that could not be restored.
    extends_dynamic: AtomicBool,
}

impl Masks {
    /// Masks of a device without rate attachments.
    ///
    /// # Safety
    ///
    /// The record is of a live device, on which [`Self::end`] is called before it is destroyed.
    pub unsafe fn on(record: &DeviceRecord, is_cpu: bool) -> Self {
        Self {
            record: *record,
            gpu: OnceLock::new(),
            is_cpu,
            has_template: AtomicBool::new(false),
            kernels: Mutex::default(),
            sample_kernels: Table::default(),
            loading: Table::default(),
            modules: ShaderModules::default(),
            pipelines: Table::default(),
            shader_objects: Table::default(),
            codes: recipe::Codes::default(),
            sets: Table::default(),
            layouts: Table::default(),
            return_layout: Mutex::default(),
            compatible: Table::default(),
            returning: Table::default(),
            loaded: Table::default(),
            cleared: Table::default(),
            chains: Table::default(),
            filled: Table::default(),
            extends_dynamic: AtomicBool::new(false),
        }
    }

    /// The device for objects of ours; `None` where a function is missing, or a queue can draw and not compute.
    fn gpu(&self) -> Option<&Arc<Gpu>> {
        let make = || {
            // SAFETY: `on`'s caller vouched for the record, and for the device until `end`.
            let gpu = unsafe { Gpu::without_queue(&self.record) }?;
            match gpu.computes_where_it_draws() {
                true => Ok(gpu),
                false => Err(GpuError::Unsupported("a queue with graphics but without compute")),
            }
        };
        let make_or_log = || make().inspect_err(|reason| reason.log("no masks")).ok();
        self.gpu.get_or_init(make_or_log).as_ref()
    }

    /// The kernels once they are compiled; asks for them the first time.
    fn kernels(&self, gpu: &Arc<Gpu>) -> Option<Arc<MaskKernels>> {
        if let Some(kernels) = &*self.kept_kernels() {
            return kernels.get().cloned();
        }
        let gpu = Arc::clone(gpu);
        let make = move |compilation: &Arc<Compilation>| {
            gpu.compile_with(compilation);
            MaskKernels::new(&gpu)
        };
        // Asked for without the lock, which is not held across calls down: another thread may have been faster.
        let new = self.compiler().ask("no masks", make);
        self.kept_kernels().get_or_insert(new).get().cloned()
    }

    fn compiler(&self) -> Arc<Compiler> {
        // SAFETY: `on`'s caller vouched for the record; the compiler ends before the device.
        unsafe { Compiler::of(&self.record) }
    }

    fn kept_kernels(&self) -> MutexGuard<'_, Option<Later<MaskKernels>>> {
        self.kernels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An image is about to be destroyed. Returns whether maps may have fills of it, for [`TargetMask::forget_image`].
    pub fn forget_image(&self, image: ImageKey) -> bool {
        self.loaded.remove(image);
        self.cleared.remove(image);
        drop(self.chains.remove_where(|(depth, _), color| *depth == image || color.image == image));
        self.filled.remove(image).is_some()
    }

    /// Destroys all objects of ours: the device is about to be destroyed. Objects that are still referenced are never destroyed.
    ///
    /// # Safety
    ///
    /// The device is live, and nothing of the application's is under way or recorded any more.
    pub unsafe fn end(&self, destroy_render_pass: Option<vk::PFN_vkDestroyRenderPass>, device: vk::Device) {
        for (_, pass) in self.loading.remove_where(|_, _| true) {
            if let Some(destroy) = destroy_render_pass {
                // SAFETY: a render pass of ours on the live device, which no command buffer needs any more.
                unsafe { destroy(device, pass, std::ptr::null()) };
            }
        }
        let kernels = self.kept_kernels().take();
        drop(kernels);
        drop(self.sample_kernels.remove_where(|_, _| true));
        drop(self.returning.remove_where(|_, _| true));
        drop(self.compatible.remove_where(|_, _| true));
        drop(self.layouts.remove_where(|_, _| true));
        let layout = self.kept_return_layout().take();
        drop(layout);
        if let Some(gpu) = self.gpu.get().and_then(Option::as_ref) {
            gpu.abandon();
        }
    }
}

impl Backend for Arc<Masks> {
    fn capabilities(&self) -> CapabilitiesRecord {
        let mut rates = [0; 16];
        for (texel, rate) in rates.iter_mut().zip(VULKAN_RATES) {
            *texel = rate.texel();
        }
        CapabilitiesRecord {
            backend: BACKEND_MASK,
            texel: TEXEL,
            rate_count: VULKAN_RATES.len() as u32,
            rates,
            is_cpu: self.is_cpu.into(),
        }
    }

    fn map(&self, pass: &Pass, image: &Image) -> Option<Box<dyn RateMap>> {
        let target = *pass.colors.first()?;
        Some(Box::new(TargetMask::new(self, target, &image.description)))
    }
}
