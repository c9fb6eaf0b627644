//! The rate attachments of a device, and the calls that attach them.

use super::capabilities::RateCapabilities;
use super::commands::SetRates;
use super::create::Enabled;
use super::framebuffer::{self, CreateFramebuffer, ImagelessRateAttachment};
use super::image::{RateImage, RateImageKey, USAGE};
use super::images::RateImages;
use super::pipeline::PipelineRate;
use super::render_pass::{self, AddedRates, LeftAlone};
use super::rendering;
use crate::abi::copies::{Copies, room};
use crate::backend::{Backend, RateMap};
use crate::gpu::GpuError;
use crate::link::{BACKEND_RATE_ATTACHMENT, CapabilitiesRecord, DeviceRecord};
use crate::pass_detection::{ImageDescription, Pass, Target};
use crate::vk::objects::Image;
use crate::vk::shaders::ShaderModules;
use crate::vk::table::Table;
use ash::vk;
use parafovea_manifest::quirks::Effect;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The rate attachments of a device.
pub struct RateAttachments {
    /// Their capabilities.
    pub capabilities: RateCapabilities,
    is_cpu: bool,
    /// Whether stores of a fragment shader alone do not keep it at 1x1 (`rates.coarse_stores`).
    pub(super) coarse_stores: bool,
    /// The images that are attached.
    pub images: RateImages,
    /// The render passes to which rates were added.
    pub(super) passes: Table<vk::RenderPass, AddedRates>,
    framebuffers: Table<vk::Framebuffer, Attached>,
    /// Effects of the fragment shaders of modules.
    pub modules: ShaderModules,
    /// Pipelines and libraries whose rate is not fixed.
    pub(super) pipelines: Table<vk::Pipeline, PipelineRate>,
    /// Rates that are set by commands.
    pub set_rates: SetRates,
    /// Fragment shaders without a pipeline, and whether each must shade every pixel.
    pub(super) shader_objects: Table<vk::ShaderEXT, bool>,
    /// Whether the rate of a pipeline may have to be set when it is bound.
    pub sets_rates_at_bind: bool,
    /// Whether dynamic rendering gets no attachments any more.
    pub(super) rendering_is_left_alone: AtomicBool,
    /// Whether dynamic rendering gets an attachment only where its target was recognised as the scene and rates are on, and render passes only in
    /// subpasses with depth.
    attaches_only_matched: bool,
}

/// The rate image of a framebuffer, for a render pass with added rates.
#[derive(Clone)]
enum Attached {
    /// The image in it.
    Image(Arc<RateImage>),
    /// A render pass that begins gets an image of the same size, for its own target if there is one, or else this one.
    Promised(Arc<RateImage>),
}

/// The first colour target of a pass, with the description of its image, and whether the pass has depth; `None` for an unknown image.
pub type FirstColour = Option<(Target, ImageDescription, bool)>;

impl RateAttachments {
    /// Rates of a device on which nothing is attached yet; `None` if it lacks a function that they need.
    ///
    /// # Safety
    ///
    /// The record is of a live device, which has the extensions and features in `enabled`.
    pub unsafe fn on(
        record: &DeviceRecord,
        enabled: Enabled,
        is_cpu: bool,
        coarse_stores: bool,
    ) -> Option<Self> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let images = unsafe { RateImages::of_device(record, &enabled) };
        let images = images.inspect_err(|reason| tracing::info!("no rate attachments: {reason}")).ok()?;
        let Enabled {
            capabilities,
            quirks,
            application_enables_rates,
            application_sets_rates,
            application_attaches_rates,
            links_pipelines,
            ..
        } = enabled;
        let combiner = capabilities.combiner();
        Some(Self {
            capabilities,
            is_cpu,
            coarse_stores,
            images,
            passes: Table::default(),
            framebuffers: Table::default(),
            modules: ShaderModules::default(),
            pipelines: Table::default(),
            set_rates: SetRates::new(combiner, application_sets_rates, application_attaches_rates),
            shader_objects: Table::default(),
            sets_rates_at_bind: application_enables_rates || links_pipelines,
            rendering_is_left_alone: AtomicBool::new(false),
            attaches_only_matched: quirks.has(Effect::AttachOnlyMatched),
        })
    }

    /// `vkCreateRenderPass`: as one of the second version with rates, or else as the application asks.
    ///
    /// # Safety
    ///
    /// The arguments of the call; the functions are those of the device's next layer.
    pub unsafe fn create_render_pass(
        &self,
        (device, info, allocator, pass): CreateRenderPass<'_, vk::RenderPassCreateInfo<'_>>,
        next: vk::PFN_vkCreateRenderPass,
        next2: Option<vk::PFN_vkCreateRenderPass2>,
    ) -> vk::Result {
        if self.images.stand_in().is_some() {
            let mut room = room::<256>();
            let mut copies = Copies::new(&mut room);
            // SAFETY: the structure is valid, as `# Safety` demands, and amended structures of its chain are the call's for its duration.
            let amended = unsafe {
                render_pass::convert(&*info, &mut copies).and_then(|info| {
                    render_pass::with_rates(
                        &info,
                        &self.capabilities,
                        self.attaches_only_matched,
                        &mut copies,
                    )
                })
            };
            // SAFETY: the arguments are valid, as `# Safety` demands.
            if let Some(result) = unsafe { self.create_amended((device, allocator, pass), amended, next2) } {
                return result;
            }
        }
        // SAFETY: the application's own arguments; structures that were amended in place are its own again.
        unsafe { next(device, info, allocator, pass) }
    }

    /// `vkCreateRenderPass2`, as [`Self::create_render_pass`].
    ///
    /// # Safety
    ///
    /// As for [`Self::create_render_pass`].
    pub unsafe fn create_render_pass2(
        &self,
        (device, info, allocator, pass): CreateRenderPass<'_, vk::RenderPassCreateInfo2<'_>>,
        next: vk::PFN_vkCreateRenderPass2,
    ) -> vk::Result {
        if self.images.stand_in().is_some() {
            let mut room = room::<256>();
            let mut copies = Copies::new(&mut room);
            // SAFETY: as in `create_render_pass`.
            let amended = unsafe {
                render_pass::with_rates(&*info, &self.capabilities, self.attaches_only_matched, &mut copies)
            };
            // SAFETY: as in `create_render_pass`.
            let result = unsafe { self.create_amended((device, allocator, pass), amended, Some(next)) };
            if let Some(result) = result {
                return result;
            }
        }
        // SAFETY: as in `create_render_pass`.
        unsafe { next(device, info, allocator, pass) }
    }

    /// Creates a render pass with rates; `None` if it is to be left alone, or that fails.
    ///
    /// # Safety
    ///
    /// Arguments of `vkCreateRenderPass2`, with the amended structure of a valid one; `next` is that function of the device's next layer.
    unsafe fn create_amended(
        &self,
        (device, allocator, pass): (vk::Device, *const vk::AllocationCallbacks<'_>, *mut vk::RenderPass),
        amended: Result<(vk::RenderPassCreateInfo2<'_>, AddedRates), LeftAlone>,
        next: Option<vk::PFN_vkCreateRenderPass2>,
    ) -> Option<vk::Result> {
        let (amended, added) =
            amended.inspect_err(|reason| tracing::debug!("no rates for a render pass: {reason}")).ok()?;
        // SAFETY: the arguments are valid, as `# Safety` demands.
        let result = unsafe { next?(device, &amended, allocator, pass) };
        if result != vk::Result::SUCCESS {
            GpuError::Call { call: "vkCreateRenderPass2", result }.log("no rates for a render pass");
            return None;
        }
        // SAFETY: the call has written the render pass.
        self.passes.insert(unsafe { *pass }, added);
        Some(result)
    }

    /// A render pass is about to be destroyed.
    pub fn forget_render_pass(&self, pass: vk::RenderPass) {
        self.passes.remove(pass);
    }

    /// `vkCreateFramebuffer`, with a rate image if the render pass has a rate attachment of ours. `colour` is the index of the first colour
    /// attachment, `target` its image, if the framebuffer is not imageless.
    ///
    /// # Safety
    ///
    /// The arguments of the call; the function is that of the device's next layer.
    pub unsafe fn create_framebuffer(
        &self,
        (device, info, allocator, made): CreateFramebuffer<'_>,
        colour: u32,
        target: FirstColour,
        next: vk::PFN_vkCreateFramebuffer,
    ) -> vk::Result {
        // SAFETY: the structure is valid, as `# Safety` demands, for the time of the call.
        let asked = unsafe { &*info };
        // SAFETY: the arguments are valid, as `# Safety` demands, with the application's structure or an amended copy of it.
        let create = |info: *const _| unsafe { next(device, info, allocator, made) };
        let Some(added) = self.passes.get(asked.render_pass) else { return create(info) };
        let mut room = room::<64>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: the structure is valid, as above.
        let amended = unsafe { self.with_rate_image(asked, added, (colour, target), &mut copies) };
        // Without a view the framebuffer would not fit its render pass.
        let Some((amended, attached)) = amended else { return Self::too_large(asked) };
        let result = create(&amended);
        if result == vk::Result::SUCCESS {
            // SAFETY: the call has written the framebuffer.
            self.framebuffers.insert(unsafe { *made }, attached);
        }
        result
    }

    /// A framebuffer with a rate image, or where it is imageless with the promise of one. `None` if no image is as large.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateFramebuffer). The result points to memory of `info` and of `copies`.
    unsafe fn with_rate_image<'c>(
        &self,
        info: &vk::FramebufferCreateInfo<'c>,
        added: AddedRates,
        (colour, target): (u32, FirstColour),
        copies: &mut Copies<'_>,
    ) -> Option<(vk::FramebufferCreateInfo<'c>, Attached)> {
        let shared = |size, layers| {
            RateImageKey::shared(self.capabilities.texels(size), self.capabilities.layers(layers))
        };
        if framebuffer::is_imageless(info) {
            // SAFETY: the structure is valid, as `# Safety` demands.
            let [width, height, layers] = unsafe { framebuffer::promised_size(info, colour) };
            let image = self.images.fitting(shared([width, height], layers))?;
            let RateImageKey { texels, layers, .. } = image.key;
            let promise = ImagelessRateAttachment { texels, layers, usage: USAGE };
            // SAFETY: as above.
            let amended = unsafe { framebuffer::with_promise(info, &promise, copies) };
            return Some((amended, Attached::Promised(image)));
        }
        let layers = if added.views == 0 { info.layers } else { added.views };
        let key = self.key(target).unwrap_or_else(|| shared([info.width, info.height], layers));
        let image = self.images.fitting(key)?;
        // SAFETY: as above.
        let amended = unsafe { framebuffer::with_view(info, image.view, copies) };
        Some((amended, Attached::Image(image)))
    }

    /// Logs, and returns, the error for a framebuffer beyond the device's limits for rate images.
    fn too_large(info: &vk::FramebufferCreateInfo<'_>) -> vk::Result {
        tracing::warn!("a framebuffer of {}x{} exceeds the device's limits", info.width, info.height);
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY
    }

    /// A framebuffer is about to be destroyed.
    pub fn forget_framebuffer(&self, framebuffer: vk::Framebuffer) {
        self.framebuffers.remove(framebuffer);
    }

    /// Destroys all rate images: the device is about to be destroyed.
    ///
    /// # Safety
    ///
    /// The device is live, and nothing of the application's is under way or recorded any more.
    pub unsafe fn end(&self) {
        drop(self.framebuffers.remove_where(|_, _| true));
        // SAFETY: the device is live and idle, as `# Safety` demands.
        unsafe { self.images.end() };
    }

    /// Whether a render pass has no attachment of ours, so that the application's own rates count in it.
    pub fn leaves_alone(&self, pass: vk::RenderPass) -> bool {
        !self.passes.has(pass)
    }

    /// Calls `begin` with the render pass instance as it is to begin, and returns the rate image that it reads.
    /// `target` is the first colour target.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCmdBeginRenderPass).
    pub unsafe fn begin_render_pass(
        &self,
        info: *const vk::RenderPassBeginInfo<'_>,
        target: FirstColour,
        begin: impl FnOnce(*const vk::RenderPassBeginInfo<'_>),
    ) -> Option<Arc<RateImage>> {
        // SAFETY: the pointer is valid, by the valid usage of vkCmdBeginRenderPass, for the time of the call.
        let asked = unsafe { &*info };
        let promised = match self.framebuffers.get(asked.framebuffer) {
            Some(Attached::Promised(promised)) => promised,
            Some(Attached::Image(image)) => {
                begin(info);
                return Some(image);
            }
            None => {
                begin(info);
                return None;
            }
        };
        let (texels, layers) = (promised.key.texels, promised.key.layers);
        let key = self.key(target).filter(|key| (key.texels, key.layers) == (texels, layers));
        let image = key.and_then(|key| self.images.of(key)).unwrap_or(promised);
        let mut room = room::<64>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: the structure is that of vkCmdBeginRenderPass, for an imageless framebuffer.
        begin(&unsafe { framebuffer::begin_with_view(asked, image.view, &mut copies) });
        Some(image)
    }

    /// Calls `begin` with the amended dynamic rendering, and returns the rate image that it reads, or would read
    /// once its target is recognised, and whether it is attached. `target` is the first colour target; passes without one that is known are left alone.
    /// `is_on`: whether recognised passes get rates now.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCmdBeginRendering).
    pub unsafe fn begin_rendering(
        &self,
        info: *const vk::RenderingInfo<'_>,
        (target, is_on): (FirstColour, bool),
        begin: impl FnOnce(*const vk::RenderingInfo<'_>),
    ) -> Option<(Arc<RateImage>, bool)> {
        // SAFETY: the pointer is valid, by the valid usage of vkCmdBeginRendering, for the time of the call.
        let asked = unsafe { &*info };
        // SAFETY: the structure is that of vkCmdBeginRendering.
        let wants = self.attaches_to_rendering() && unsafe { rendering::wants_rates(asked) }.is_ok();
        let key = self.key(target).filter(|_| wants);
        let Some(image) = key.and_then(|key| self.images.of(key)) else {
            begin(info);
            return None;
        };
        // Pipelines with the flag for attachments may be used without one. A pass that is suspended and
        // resumed must have the same attachments throughout (vkCmdBeginRendering).
        // SAFETY: the pointer is null or valid, by the valid usage of vkCmdBeginRendering.
        let depth = unsafe { asked.p_depth_attachment.as_ref() };
        let has_depth = depth.is_some_and(|depth| depth.image_view != vk::ImageView::null());
        let is_matched = image.is_matched(has_depth) && !rendering::is_suspended(asked);
        if self.attaches_only_matched && !(is_matched && is_on) {
            begin(info);
            return Some((image, false));
        }
        let mut room = room::<64>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: as above.
        begin(&unsafe { rendering::with_view(asked, image.view, &self.capabilities, &mut copies) });
        Some((image, true))
    }

    fn key(&self, target: FirstColour) -> Option<RateImageKey> {
        target.map(|(target, image, has_depth)| {
            RateImageKey::of((target, &image, has_depth), &self.capabilities)
        })
    }
}

impl Backend for Arc<RateAttachments> {
    fn capabilities(&self) -> CapabilitiesRecord {
        let mut rates = [0; 16];
        for (texel, rate) in rates.iter_mut().zip(&self.capabilities.rates) {
            *texel = rate.texel();
        }
        CapabilitiesRecord {
            backend: BACKEND_RATE_ATTACHMENT,
            texel: self.capabilities.texel,
            rate_count: self.capabilities.rates.len() as u32,
            rates,
            is_cpu: self.is_cpu.into(),
        }
    }

    fn map(&self, pass: &Pass, image: &Image) -> Option<Box<dyn RateMap>> {
        let of = (*pass.colors.first()?, &image.description, pass.depth.is_some());
        let key = RateImageKey::of(of, &self.capabilities);
        Some(Box::new(self.images.of(key)?))
    }
}

/// The arguments of vkCreateRenderPass and vkCreateRenderPass2.
pub type CreateRenderPass<'a, I> =
    (vk::Device, *const I, *const vk::AllocationCallbacks<'a>, *mut vk::RenderPass);
