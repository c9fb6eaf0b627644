//! The rate attachments of a device, and the calls that attach them.

use super::capabilities::RateCapabilities;
use super::commands::SetRates;
use super::create::Enabled;
use super::framebuffer::{self, Promise};
use super::image::{RateImage, RateImageKey, RateImages, USAGE};
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
use std::sync::atomic::{AtomicBool, Ordering};

/// The rate attachments of a device.
pub struct Rates {
    /// Their capabilities.
    pub capabilities: RateCapabilities,
    is_cpu: bool,
    /// The images that are attached.
    pub images: RateImages,
    /// The render passes to which rates were added.
    passes: Table<vk::RenderPass, AddedRates>,
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
    rendering_is_left_alone: AtomicBool,
    /// Whether dynamic rendering gets an attachment only where its target was recognised as the scene.
    attaches_only_matched: bool,
}

/// The rate image of a framebuffer, for a render pass with added rates.
#[derive(Clone)]
enum Attached {
    /// The image in it.
    Image(Arc<RateImage>),
    /// When a render pass begins it gets an image of the same size, for its own target if there is one, or else this one.
    Promised(Arc<RateImage>),
}

/// The first colour target of a pass, with the description of its image; `None` for an unknown image.
pub type FirstColour = Option<(Target, ImageDescription)>;

impl Rates {
    /// Those of a device on which nothing is attached yet; nothing where it lacks a function that they need.
    ///
    /// # Safety
    ///
    /// The record is of a live device, which has what is enabled.
    pub unsafe fn on(record: &DeviceRecord, enabled: Enabled, is_cpu: bool) -> Option<Self> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let images = unsafe { RateImages::of_device(record, &enabled) };
        let images = images.inspect_err(|reason| tracing::info!("no rate attachments: {reason}")).ok()?;
        let Enabled { capabilities, quirks, application_sets_rates, links_pipelines, .. } = enabled;
        let combiner = capabilities.combiner();
        Some(Self {
            capabilities,
            is_cpu,
            images,
            passes: Table::default(),
            framebuffers: Table::default(),
            modules: ShaderModules::default(),
            pipelines: Table::default(),
            set_rates: SetRates::new(combiner, application_sets_rates),
            shader_objects: Table::default(),
            sets_rates_at_bind: application_sets_rates || links_pipelines,
            rendering_is_left_alone: AtomicBool::new(false),
            attaches_only_matched: quirks.has(Effect::AttachOnlyMatched),
        })
    }

    /// From now on dynamic rendering gets no attachments: there are pipelines or shaders that may not be used with them
    /// (VUID-vkCmdDraw-imageView-06183).
    pub(super) fn leave_rendering_alone(&self) {
        self.rendering_is_left_alone.store(true, Ordering::Relaxed);
    }

    /// Whether dynamic rendering gets attachments.
    pub fn attaches_to_rendering(&self) -> bool {
        !self.rendering_is_left_alone.load(Ordering::Relaxed)
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
        // SAFETY: the arguments are valid, as `# Safety` demands.
        unsafe {
            let mut room = room::<256>();
            let mut copies = Copies::new(&mut room);
            if self.images.stand_in().is_none() {
                return next(device, info, allocator, pass);
            }
            let converted = render_pass::convert(&*info, &mut copies);
            let amended =
                converted.and_then(|info| render_pass::with_rates(&info, &self.capabilities, &mut copies));
            if let (Ok((amended, added)), Some(next2)) = (&amended, next2) {
                let result = next2(device, amended, allocator, pass);
                if self.is_added(result, pass, *added) {
                    return result;
                }
            }
            self.left_alone(amended.map(|_| ()));
            // Structures of the application that were amended in place become its own again.
            drop(copies);
            next(device, info, allocator, pass)
        }
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
        // SAFETY: the arguments are valid, as `# Safety` demands.
        unsafe {
            let mut room = room::<256>();
            let mut copies = Copies::new(&mut room);
            if self.images.stand_in().is_none() {
                return next(device, info, allocator, pass);
            }
            let amended = render_pass::with_rates(&*info, &self.capabilities, &mut copies);
            if let Ok((amended, added)) = &amended {
                let result = next(device, amended, allocator, pass);
                if self.is_added(result, pass, *added) {
                    return result;
                }
            }
            self.left_alone(amended.map(|_| ()));
            drop(copies);
            next(device, info, allocator, pass)
        }
    }

    /// # Safety
    ///
    /// `pass` is written where the result is success.
    unsafe fn is_added(&self, result: vk::Result, pass: *mut vk::RenderPass, added: AddedRates) -> bool {
        if result != vk::Result::SUCCESS {
            GpuError::Call { call: "vkCreateRenderPass2", result }.log("no rates for a render pass");
            return false;
        }
        // SAFETY: the caller vouches for it.
        self.passes.insert(unsafe { *pass }, added);
        true
    }

    fn left_alone(&self, result: Result<(), LeftAlone>) {
        if let Err(reason) = result {
            tracing::debug!("no rates for a render pass: {reason}");
        }
    }

    /// A render pass is about to be destroyed.
    pub fn forget_render_pass(&self, pass: vk::RenderPass) {
        self.passes.remove(pass);
    }

    /// `vkCreateFramebuffer`, with a rate image where the render pass has a rate attachment of ours. `colour` is the
    /// index of the first colour attachment, `target` what is there, of a framebuffer that is not imageless.
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
        // SAFETY: the arguments are valid, as `# Safety` demands.
        unsafe {
            let Some(added) = self.passes.get((*info).render_pass) else {
                return next(device, info, allocator, made);
            };
            let mut room = room::<64>();
            let mut copies = Copies::new(&mut room);
            let (amended, attached) = if framebuffer::is_imageless(&*info) {
                let [width, height, layers] = framebuffer::promised_size(&*info, colour);
                let (texels, layers) =
                    (self.capabilities.texels([width, height]), self.capabilities.layers(layers));
                let Some(image) = self.images.fitting(RateImageKey::shared(texels, layers)) else {
                    return Self::too_large(&*info);
                };
                let RateImageKey { texels, layers, .. } = image.key;
                let promise = Promise { texels, layers, usage: USAGE };
                let amended = framebuffer::with_promise(&*info, &promise, &mut copies);
                (amended, Attached::Promised(image))
            } else {
                let layers = if added.views == 0 { (*info).layers } else { added.views };
                let unknown = || {
                    let texels = self.capabilities.texels([(*info).width, (*info).height]);
                    RateImageKey::shared(texels, self.capabilities.layers(layers))
                };
                let key = self.key(target).unwrap_or_else(unknown);
                // Without a view the framebuffer would not fit its render pass.
                let Some(image) = self.images.fitting(key) else {
                    return Self::too_large(&*info);
                };
                (framebuffer::with_view(&*info, image.view, &mut copies), Attached::Image(image))
            };
            let result = next(device, &amended, allocator, made);
            if result == vk::Result::SUCCESS {
                self.framebuffers.insert(*made, attached);
            }
            result
        }
    }

    /// No image goes with a framebuffer, which is larger than the device says that it can be.
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
        // SAFETY: the caller vouches for it.
        unsafe { self.images.end() };
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
        // SAFETY: the structure is valid, by the valid usage of vkCmdBeginRenderPass.
        unsafe {
            match self.framebuffers.get((*info).framebuffer) {
                None => {
                    begin(info);
                    None
                }
                Some(Attached::Image(image)) => {
                    begin(info);
                    Some(image)
                }
                Some(Attached::Promised(promised)) => {
                    let (texels, layers) = (promised.key.texels, promised.key.layers);
                    let key = self.key(target).filter(|key| (key.texels, key.layers) == (texels, layers));
                    let image = key.and_then(|key| self.images.of(key)).unwrap_or(promised);
                    let mut room = room::<64>();
                    let mut copies = Copies::new(&mut room);
                    begin(&framebuffer::begin_with_view(&*info, image.view, &mut copies));
                    Some(image)
                }
            }
        }
    }

    /// Calls `begin` with the amended dynamic rendering, and returns the rate image that it reads, or would read
    /// once its target is recognised. `target` is the first colour target; passes without one that is known are left alone.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCmdBeginRendering).
    pub unsafe fn begin_rendering(
        &self,
        info: *const vk::RenderingInfo<'_>,
        target: FirstColour,
        begin: impl FnOnce(*const vk::RenderingInfo<'_>),
    ) -> Option<Arc<RateImage>> {
        // SAFETY: the structure is valid, by the valid usage of vkCmdBeginRendering.
        unsafe {
            let wants = self.attaches_to_rendering() && rendering::wants_rates(&*info).is_ok();
            let key = self.key(target).filter(|_| wants);
            let Some(image) = key.and_then(|key| self.images.of(key)) else {
                begin(info);
                return None;
            };
            // Pipelines with the flag for attachments may be used without one. A pass that is suspended and
            // resumed must have the same attachments throughout (vkCmdBeginRendering).
            let is_matched = image.is_matched() && !rendering::is_suspended(&*info);
            if self.attaches_only_matched && !is_matched {
                begin(info);
                return Some(image);
            }
            let mut room = room::<64>();
            let mut copies = Copies::new(&mut room);
            begin(&rendering::with_view(&*info, image.view, &self.capabilities, &mut copies));
            Some(image)
        }
    }

    fn key(&self, target: FirstColour) -> Option<RateImageKey> {
        target.map(|(target, image)| RateImageKey::of(target, &image, &self.capabilities))
    }
}

impl Backend for Arc<Rates> {
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
        let key = RateImageKey::of(*pass.colors.first()?, &image.description, &self.capabilities);
        Some(Box::new(self.images.of(key)?))
    }
}

/// The arguments of vkCreateFramebuffer.
pub type CreateFramebuffer<'a> = (
    vk::Device,
    *const vk::FramebufferCreateInfo<'a>,
    *const vk::AllocationCallbacks<'a>,
    *mut vk::Framebuffer,
);

/// The arguments of vkCreateRenderPass and vkCreateRenderPass2.
pub type CreateRenderPass<'a, I> =
    (vk::Device, *const I, *const vk::AllocationCallbacks<'a>, *mut vk::RenderPass);
