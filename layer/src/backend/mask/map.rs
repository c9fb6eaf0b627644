//! The GPU objects of one masked target, and their commands.

use crate::backend::mask::{ColorFill, DepthTemplate, Eligible, FillKind, MaskKernels, resolve_mask};
use crate::gpu::{AppCommands, Gpu, GpuError, ImagePart, ReturnLayout, ReturnSet};
use crate::kernels::fill::SkipBuffer;
use crate::kernels::mask::MaskOutput;
use crate::kernels::nearest::NearestCopy;
use crate::kernels::samples::{SampleFill, SampleKernel, Skipped};
use crate::pass_detection::{ImageKey, Part, Target};
use crate::rate_map::RateImage;
use ash::vk;
use parafovea_core::kernels::nearest::NearestParams;
use parafovea_core::kernels::samples::SampleParams;
use parafovea_core::mask::{BLOCK, DepthFormat, EarlyReturnParams, Mask, TemplateDepths};
use smallvec::SmallVec;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Fills of images of several samples, by target.
type SampleFills = SmallVec<[(Target, Arc<SampleFill>); 4]>;

/// The mask of passes that draw to one target with depth of one kind: its content may change between two submits, by
/// [`MaskMap::stage`] and [`MaskMap::upload`], and everything is shaded until it first does.
pub struct MaskMap {
    // Before `list`, which their sets name.
    targets: Mutex<SmallVec<[Arc<ColorFill>; 2]>>,
    /// Of images of several samples, each made for the first pass that needs it; an image of the application's has its key once.
    samples: Mutex<SampleFills>,
    /// Made for the first pass that needs it.
    depth: OnceLock<Option<NearestCopy>>,
    list: SkipBuffer,
    /// Made for the first pass whose shaders return early, and before `template`, which it names.
    returns: OnceLock<Option<ReturnSet>>,
    template: DepthTemplate,
    gpu: Arc<Gpu>,
    kernels: Arc<MaskKernels>,
    mask: Mutex<Mask>,
    eligible: Eligible,
    extent: [u32; 2],
    layers: u32,
}

impl MaskMap {
    /// For targets of `extent` pixels and `layers` array layers.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for targets that are too large.
    pub fn new(
        gpu: &Arc<Gpu>,
        kernels: &Arc<MaskKernels>,
        eligible: Eligible,
        extent: [u32; 2],
        layers: u32,
    ) -> Result<Self, GpuError> {
        let mask = Mask::new(extent, layers);
        let [columns, rows] = extent.map(|side| u64::from(side.div_ceil(BLOCK)));
        let blocks = usize::try_from(columns * rows * u64::from(layers))
            .map_err(|_| GpuError::Unsupported("a mask of this size"))?;
        Ok(Self {
            targets: Mutex::default(),
            samples: Mutex::default(),
            list: SkipBuffer::new(gpu, blocks, mask.list())?,
            template: DepthTemplate::new(gpu, eligible, extent, layers)?,
            depth: OnceLock::new(),
            returns: OnceLock::new(),
            gpu: Arc::clone(gpu),
            kernels: Arc::clone(kernels),
            mask: Mutex::new(mask),
            eligible,
            extent,
            layers,
        })
    }

    /// The template that it was made for.
    pub fn eligible(&self) -> Eligible {
        self.eligible
    }

    /// Whether a pass can use it: another template would be another map's.
    pub fn serves(&self, eligible: Eligible) -> bool {
        Eligible { work: self.eligible.work, ..eligible } == self.eligible
    }

    /// Prepares the work on depth beside the template; false where that cannot be done.
    pub fn prepare_depth(&self) -> bool {
        let Eligible { format, depths, .. } = self.eligible;
        let make = || {
            let copy = NearestParams::of_depth(self.extent, format, depths.skipped)
                .ok_or(GpuError::Unsupported("loaded or read depth of this size"))
                .and_then(|params| {
                    let size = (self.extent[1], self.layers);
                    NearestCopy::new(&self.gpu, &self.kernels.nearest, params, size, &self.list)
                });
            copy.inspect_err(|error| error.log("no mask")).ok()
        };
        self.depth.get_or_init(make).is_some()
    }

    /// The template, of any kind, in a set for fragment shaders that return early, valid as long as `self`. `None` if they cannot read it.
    pub(crate) fn return_set(&self, layout: &Arc<ReturnLayout>) -> Option<vk::DescriptorSet> {
        let make = || {
            let Eligible { format, depths, .. } = self.eligible;
            if !EarlyReturnParams::agree_in_quads(self.extent, format) {
                return None;
            }
            let params = EarlyReturnParams::new(self.extent, format, depths)?;
            let set = ReturnSet::new(&self.gpu, layout, self.template()?, params);
            set.inspect_err(|error| error.log("no mask")).ok()
        };
        self.returns.get_or_init(make).as_ref().map(ReturnSet::handle)
    }

    /// Records the commands ahead of a pass that loads `depth`, which is in `layout`, see [`NearestCopy::cover`]; nothing before
    /// [`Self::prepare_depth`].
    pub fn cover(&self, commands: &AppCommands, depth: ImagePart, area: vk::Rect2D, layout: vk::ImageLayout) {
        if let Some(copy) = self.depth.get().and_then(Option::as_ref) {
            copy.cover(commands, (&self.kernels.nearest, &self.list), (depth, area), layout);
        }
    }

    /// Records the commands after a pass whose `depth`, which is in `layout`, is needed, see [`NearestCopy::fill`]; nothing before
    /// [`Self::prepare_depth`].
    pub fn fill_depth(
        &self,
        commands: &AppCommands,
        depth: ImagePart,
        area: vk::Rect2D,
        layout: vk::ImageLayout,
    ) {
        if let Some(copy) = self.depth.get().and_then(Option::as_ref) {
            copy.fill(commands, (&self.kernels.nearest, &self.list), (depth, area), layout);
        }
    }

    /// Size of the targets, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// Number of array layers.
    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// The list of skipped blocks, which compute shaders may write, valid as long as `self`.
    pub fn list(&self) -> vk::Buffer {
        self.list.handle()
    }

    /// The template, if compute shaders may write it, valid as long as `self`.
    pub fn template(&self) -> Option<vk::Buffer> {
        self.template.is_storage().then(|| self.template.handle())
    }

    /// Whether passes may have it, see [`DepthTemplate::is_ready`].
    pub fn is_ready(&self) -> bool {
        self.template.is_ready()
    }

    /// Records the commands after each change of template and list on the GPU, see [`DepthTemplate::redraw`].
    pub fn redraw(&self, commands: &AppCommands) {
        self.template.redraw(commands);
    }

    /// Number of bytes that [`Self::stage`] writes, a multiple of four.
    pub fn staging_len(&self) -> usize {
        self.list.capacity_words() * 4 + self.template.size() as usize
    }

    /// Resolves `rates`, which [`crate::rate_map::resolve`] wrote for `image`, over the pictures of `parts`, and writes the upload to
    /// `staging`; nothing into a slice that is too short. Allocates nothing.
    pub fn stage(&self, parts: &[Part], image: &RateImage, rates: &[u8], staging: &mut [u8]) {
        let Some((list, template)) = staging.split_at_mut_checked(self.list.capacity_words() * 4) else {
            return;
        };
        let mut mask = self.mask.lock().unwrap_or_else(PoisonError::into_inner);
        resolve_mask(&mut mask, parts, image, rates);
        for (bytes, word) in list.chunks_exact_mut(4).zip(mask.list().words()) {
            bytes.copy_from_slice(&word.to_ne_bytes());
        }
        self.template.write(&mask, template);
    }

    /// Records the copy of the bytes of [`Self::stage`] at `offset`, a multiple of four, of `staging`, in order with earlier and later
    /// passes on this queue.
    pub fn upload(&self, commands: &AppCommands, staging: vk::Buffer, offset: u64) {
        commands.reads_to_copies();
        let list = self.list.capacity_words() as u64 * 4;
        commands.copy_buffer((staging, offset), (self.list.handle(), 0), list);
        commands.copy_buffer((staging, offset + list), (self.template.handle(), 0), self.template.size());
        commands.copies_to_reads();
        self.redraw(commands);
    }

    /// Whether a pass with this render area can have the mask.
    pub fn takes(&self, area: vk::Rect2D) -> bool {
        self.template.takes(area)
    }

    /// Records the commands ahead of a pass, see [`DepthTemplate::record`].
    pub fn begin(
        &self,
        commands: &AppCommands,
        depth: ImagePart,
        area: vk::Rect2D,
        layouts: [vk::ImageLayout; 2],
    ) {
        self.template.record(commands, depth, area, layouts);
    }

    /// Records the commands after a pass: the fill of a colour image that it has stored, drawn to in `format`, which is in `layout`;
    /// nothing before [`Self::prepare`] for the format.
    pub fn end(&self, commands: &AppCommands, color: ImagePart, format: vk::Format, layout: vk::ImageLayout) {
        if let Some(target) = self.target(format) {
            target.record(commands, (&self.kernels, &self.list), color, layout);
        }
    }

    /// Prepares the fill of an image of several samples, whose layers `part` are `target`, by the kernel for its kind.
    ///
    /// # Errors
    /// As for [`SampleFill::new`] and [`Self::prepare`]; or the template cannot be read by shaders.
    pub fn prepare_samples(
        &self,
        target: Target,
        part: ImagePart,
        (kernel, format): (&Arc<SampleKernel>, vk::Format),
    ) -> Result<Arc<SampleFill>, GpuError> {
        let known =
            self.kept_samples().iter().find(|(known, _)| *known == target).map(|(_, fill)| Arc::clone(fill));
        if let Some(known) = known {
            return Ok(known);
        }
        if part.aspects == vk::ImageAspectFlags::COLOR {
            self.prepare(format)?;
        }
        let Eligible { format: template, depths, .. } = self.eligible;
        let params = SampleParams::new(self.extent, template, depths);
        let (Some(words), Some(params)) = (self.template(), params) else {
            return Err(GpuError::Unsupported("a multisampled template of this size"));
        };
        let skipped = Skipped { params, words };
        // Made without the lock, as above.
        let new = Arc::new(SampleFill::new(&self.gpu, kernel, part, skipped)?);
        self.kept_samples().push((target, Arc::clone(&new)));
        Ok(new)
    }

    /// Records the fill of an image of several samples, which is in `layout` before and after, with the objects of
    /// [`Self::prepare_samples`]. The bound graphics state changes, too.
    pub fn fill_samples(
        &self,
        commands: &AppCommands,
        fill: &SampleFill,
        (part, format): (ImagePart, vk::Format),
        layout: vk::ImageLayout,
    ) {
        if !fill.is_color() {
            fill.record_depth(commands, part, layout);
        } else if let Some(target) = self.target(format) {
            fill.record_color(commands, part, layout, |copy, layout| {
                target.record(commands, (&self.kernels, &self.list), copy, layout);
            });
        }
    }

    /// Drops the fills of an image that is about to be destroyed.
    pub fn forget_image(&self, image: ImageKey) {
        let gone: SampleFills = {
            let mut kept = self.kept_samples();
            let fills = std::mem::take(&mut *kept).into_iter();
            let (gone, left) = fills.partition(|(target, _)| target.image == image);
            *kept = left;
            gone
        };
        // Without the lock.
        drop(gone);
    }

    fn kept_samples(&self) -> MutexGuard<'_, SampleFills> {
        self.samples.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prepares the fill of pictures that are drawn to in `format`.
    ///
    /// # Errors
    /// As for [`ColorFill::new`].
    pub fn prepare(&self, format: vk::Format) -> Result<(), GpuError> {
        if self.target(format).is_none() {
            // Made without the lock, which is not held across calls down: another thread may have been faster.
            let size = (self.extent, self.layers);
            let target = ColorFill::new(&self.gpu, &self.kernels, format, size, &self.list)?;
            self.targets().push(Arc::new(target));
        }
        Ok(())
    }

    fn target(&self, format: vk::Format) -> Option<Arc<ColorFill>> {
        let kind = FillKind::of(format, vk::SampleCountFlags::TYPE_1)?;
        self.targets().iter().find(|target| target.kind() == kind).map(Arc::clone)
    }

    fn targets(&self) -> MutexGuard<'_, SmallVec<[Arc<ColorFill>; 2]>> {
        self.targets.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl MaskOutput for MaskMap {
    fn list(&self) -> vk::Buffer {
        self.list()
    }

    fn template(&self) -> Option<vk::Buffer> {
        self.template()
    }

    fn kind(&self) -> (DepthFormat, TemplateDepths) {
        (self.eligible.format, self.eligible.depths)
    }

    fn extent(&self) -> [u32; 2] {
        self.extent()
    }

    fn layers(&self) -> u32 {
        self.layers()
    }

    fn redraw(&self, commands: &AppCommands) {
        self.redraw(commands);
    }
}
