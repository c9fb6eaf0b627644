//! `compose`: from the image that the application rendered to the image that the runtime shows.
//!
//! A whole image is copied, with all its layers; then the tiles of each region that have work are drawn over
//! the copy, reading the application's image. Alpha, and pixels without work, stay as they were copied.

mod app_images;
mod copies;
mod depth;
mod draws;
pub(super) mod key;
mod pipelines;
mod record;
mod reuse;
mod runtime_images;
mod shape;

pub use app_images::{APP_USAGE, AppImages, ImageMemory};
pub use depth::{DEPTH_USAGE, DepthShape, DepthSource, KeptDepth, PictureDepth};
pub use parafovea_core::kernels::compose::ComposeParams;
pub use pipelines::Parameters;
pub use reuse::{EarlierImage, ReuseRegion};
pub use runtime_images::{RUNTIME_USAGE, RuntimeImages};
pub use shape::{SwapchainShape, is_color_format, stores_unit_range};

use super::change::{Change, ChangeRegion, Comparisons, MAX_COMPARED, Placed};
use crate::gpu::{Gpu, GpuError, Later, Purpose, UniformRing, UniformSet, Uses, serial};
use ash::vk;
use draws::{Draws, EarlierImages};
use key::key;
use parafovea_core::geometry::View;
use parafovea_core::reuse::MAX_AGES;
use parafovea_core::reuse::Reuse;
use pipelines::Pipelines;
use record::{Sets, record};
use reuse::ReuseBuffers;
use std::sync::Arc;

/// Most regions in one submit: the 16 layers that every OpenXR runtime takes, of up to four views each.
pub const MAX_REGIONS: usize = 64;

/// Most regions in one submit that are completed from earlier pictures: the eyes' views of four projection layers.
pub const MAX_REUSED: usize = 8;

/// One rectangle of one array layer that gets processed.
#[derive(Clone, Copy, Debug)]
pub struct ComposeRegion {
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle, in pixels; parts outside of the image, or of the rectangle in `params`, are ignored.
    pub rect: vk::Rect2D,
    /// The processing there.
    pub params: ComposeParams,
}

/// One image to copy and process. An image appears in one job of a submit only.
#[derive(Clone, Copy)]
pub struct ComposeJob<'a> {
    /// The application's images, the source.
    pub app: &'a AppImages,
    /// Index of the source image.
    pub app_index: u32,
    /// The runtime's images, the destination; of the same format, extent and layers.
    pub runtime: &'a RuntimeImages,
    /// Index of the destination image.
    pub runtime_index: u32,
    /// Processed regions; all the rest is only copied. Where regions overlap, the last one counts.
    pub regions: &'a [ComposeRegion],
    /// Regions that are completed from earlier pictures first; such rectangles do not overlap.
    pub reuse: &'a [ReuseRegion<'a>],
    /// Regions that are compared with earlier pictures, for [`Compose::changes`].
    pub changes: &'a [ChangeRegion<'a>],
}

/// The pass.
pub struct Compose {
    // First: waits before the rest is destroyed.
    uses: Uses,
    parameters: Parameters,
    pipelines: Vec<(vk::Format, Pipelines)>,
    reuse: Option<ReuseBuffers>,
    comparisons: Option<Later<Comparisons>>,
    change: Changing,
    uniforms: UniformRing<ComposeParams>,
    uniform_set: UniformSet,
    /// Of the objects above.
    serial: u64,
    gpu: Arc<Gpu>,
}

/// The comparison of pictures.
enum Changing {
    /// Nothing was to be compared yet, or the pipelines are not there yet.
    NotYet,
    There(Box<Change>),
    /// There is no room.
    Never,
}

impl Compose {
    /// Prepares the pass.
    ///
    /// # Errors
    /// [`GpuError::Call`] or [`GpuError::Unsupported`] if memory or an object cannot be created.
    pub fn new(gpu: Arc<Gpu>) -> Result<Self, GpuError> {
        let parameters = if gpu.is_software() { Parameters::OfVertices } else { Parameters::OfPixels };
        Self::with_parameters(gpu, parameters)
    }

    /// The same with one of two shaders, that draw the same.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn with_parameters(gpu: Arc<Gpu>, parameters: Parameters) -> Result<Self, GpuError> {
        let uniforms = UniformRing::new(&gpu, MAX_REGIONS as u32)?;
        let uniform_set = UniformSet::new(&uniforms)?;
        Ok(Self {
            uses: Uses::new(&gpu),
            parameters,
            pipelines: Vec::new(),
            reuse: None,
            comparisons: None,
            change: Changing::NotYet,
            uniforms,
            uniform_set,
            serial: serial(),
            gpu,
        })
    }

    /// Whether swapchains of this format can be substituted.
    pub fn supports(&self, format: vk::Format) -> bool {
        is_color_format(format) && self.gpu.can_compose(format)
    }

    /// Requests the pipelines of draws to this format; [`Self::attenuates`] returns whether they are ready.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] without a queue.
    pub fn prepare(&mut self, format: vk::Format) -> Result<(), GpuError> {
        self.prepared(format).map(drop)
    }

    fn prepared(&mut self, format: vk::Format) -> Result<&mut Pipelines, GpuError> {
        let known = self.pipelines.iter().position(|(existing, _)| *existing == format);
        let index = match known {
            Some(index) => index,
            None => {
                self.pipelines.push((format, Pipelines::new(&self.gpu, format, self.parameters)?));
                self.pipelines.len() - 1
            }
        };
        Ok(&mut self.pipelines[index].1)
    }

    /// As [`Self::prepare`], where pictures may be completed from earlier ones too: [`Self::completes`].
    ///
    /// # Errors
    /// As there.
    pub fn prepare_reuse(&mut self, format: vk::Format) -> Result<(), GpuError> {
        let gpu = Arc::clone(&self.gpu);
        let parameters = self.parameters;
        self.prepared(format)?.ask_for_reuse(&gpu, format, parameters)?;
        self.prepare_change()
    }

    /// Whether colour of pictures in this format can be attenuated; asks for the pipelines. Waits for nothing.
    pub fn attenuates(&mut self, format: vk::Format) -> bool {
        self.prepared(format).is_ok_and(|pipelines| pipelines.attenuates())
    }

    /// Whether pictures in this format can be completed from earlier ones; asks for the pipelines. Waits for nothing.
    pub fn completes(&mut self, format: vk::Format) -> bool {
        self.prepare_reuse(format).is_ok()
            && self.prepared(format).is_ok_and(|pipelines| pipelines.completes())
    }

    /// Takes the comparison of pictures, once it is compiled; asks for it the first time.
    fn prepare_change(&mut self) -> Result<(), GpuError> {
        if matches!(self.change, Changing::NotYet) {
            let asked = match &self.comparisons {
                Some(asked) => asked,
                None => {
                    let otherwise = "changes in the periphery are not detected";
                    self.comparisons.insert(self.gpu.shared()?.ask(otherwise, Comparisons::new))
                }
            };
            if let Some(made) = asked.get() {
                self.change = Changing::There(Box::new(Change::new(&self.gpu, made)));
            }
        }
        Ok(())
    }

    /// Hands out the findings of comparisons since the last call, of submits that have finished: of each picture its
    /// [`ChangeRegion::view`], the compared tiles, and the change of each ([`parafovea_core::kernels::change::ChangeParams::change`]). Does
    /// not wait.
    pub fn changes(&mut self, each: impl FnMut(&View, &[u32], &[f32])) {
        if let Changing::There(change) = &mut self.change {
            change.take_findings(each);
        }
    }

    /// Records all jobs and submits them at once on the binding's queue, without waiting for them. A steady
    /// frame allocates nothing on the heap.
    ///
    /// The runtime's images are COLOR_ATTACHMENT_OPTIMAL before and after, the application's as it left them.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] when an index, a layer or a shape does not fit, an image is in two jobs, or there are more than
    /// [`MAX_REGIONS`], or something is to be done for which the pipelines are not ready; [`GpuError::Timeout`] when earlier submits hang;
    /// a failed call. Then nothing was submitted.
    pub fn submit(&mut self, jobs: &[ComposeJob]) -> Result<(), GpuError> {
        check(jobs)?;
        for job in jobs {
            let format = job.app.shape().format;
            let is_there = match (job.regions, job.reuse) {
                ([], []) => true,
                (_, []) => self.attenuates(format),
                _ => self.completes(format),
            };
            if !is_there {
                return Err(GpuError::Invalid("pipelines that are not compiled yet"));
            }
        }
        let draws = Draws::new(jobs)?;
        self.make_room(&draws)?;
        self.make_room_for_changes(jobs);
        let Self { serial, uniforms, uniform_set, pipelines, reuse, change, gpu, .. } = self;
        let next = gpu.next_submit(Purpose::Pictures)?;
        let slot = next.slot();
        for (number, draw) in (0..).zip(draws.iter()) {
            draw.offset.set(uniforms.write(slot, number, &draw.params)?);
        }
        if let Some(reuse) = reuse {
            let mut at = 0;
            let reused = draws.iter().filter_map(|draw| Some((draw, draw.reuse?)));
            for (number, found) in reused.enumerate() {
                let extent = jobs[found.0.job].app.shape().extent;
                let extent = [extent.width, extent.height];
                found.0.placed.replace(reuse.place(slot, number, found, extent, &mut at)?);
            }
        }
        let serials = [*serial, reuse.as_ref().map_or(0, ReuseBuffers::serial)];
        let mut key = key(serials, jobs, &draws);
        let compared = match change {
            Changing::There(change) => {
                change.free(slot);
                change.place(slot, jobs, key.as_mut())?
            }
            _ => Placed::new(),
        };
        let submit = next.submit(key.as_ref(), |recorder| {
            let sets = Sets { plain: uniform_set, lists: reuse.as_ref().map(ReuseBuffers::set) };
            record(recorder, jobs, &draws, &sets, pipelines);
            if let Changing::There(change) = change {
                change.record(recorder, jobs, &compared);
            }
            Ok(())
        })?;
        if let Some(reuse) = &self.reuse {
            reuse.uses().mark(submit);
        }
        if let Changing::There(change) = &mut self.change {
            change.submitted(slot, submit);
        }
        self.uses.mark(submit);
        for job in jobs {
            job.app.mark(job.app_index, submit);
            earlier(job).for_each(|image| job.app.mark(image, submit));
            job.runtime.uses().mark(submit);
            depths(job).for_each(|depth| depth.mark(submit));
        }
        Ok(())
    }

    /// Makes room for the comparisons of a submit; without room, nothing is compared any more.
    fn make_room_for_changes(&mut self, jobs: &[ComposeJob]) {
        if jobs.iter().all(|job| job.changes.is_empty()) {
            return;
        }
        if let Err(error) = self.prepare_change() {
            self.change = not_compared(error);
        }
        if let Changing::There(change) = &mut self.change
            && let Err(error) = change.make_room(jobs)
        {
            self.change = not_compared(error);
        }
    }

    /// Makes room for the lists of a submit. Buffers that are too small are replaced, after a wait for their last use.
    fn make_room(&mut self, draws: &Draws) -> Result<(), GpuError> {
        let needs_room = draws.reused().next().is_some()
            && self.reuse.as_ref().is_none_or(|reuse| !reuse.fits(draws.reused()));
        if needs_room {
            self.reuse = None;
            self.reuse = Some(ReuseBuffers::new(&self.gpu, &self.uniforms, draws.reused())?);
        }
        Ok(())
    }
}

impl ComposeJob<'_> {
    fn layers(&self) -> u32 {
        self.app.shape().array_layers
    }

    fn app_image(&self) -> vk::Image {
        self.app.images()[self.app_index as usize]
    }

    fn runtime_image(&self) -> vk::Image {
        self.runtime.images()[self.runtime_index as usize]
    }
}

/// Refuses jobs that would be undefined behaviour to record.
fn check(jobs: &[ComposeJob]) -> Result<(), GpuError> {
    for (number, job) in jobs.iter().enumerate() {
        if job.app_index as usize >= job.app.images().len()
            || job.runtime_index as usize >= job.runtime.images().len()
        {
            return Err(GpuError::Invalid("an image index out of range"));
        }
        if !job.app.shape().fits(job.runtime.shape()) {
            return Err(GpuError::Invalid("two swapchains of different sizes"));
        }
        let twice = |other: &ComposeJob| {
            other.app_image() == job.app_image() || other.runtime_image() == job.runtime_image()
        };
        if jobs[..number].iter().any(twice) {
            return Err(GpuError::Invalid("an image in two jobs"));
        }
        check_reuse(job)?;
    }
    let reused: usize = jobs.iter().map(|job| job.reuse.len()).sum();
    let compared: usize = jobs.iter().map(|job| job.changes.len()).sum();
    if reused > MAX_REUSED || compared > MAX_COMPARED {
        return Err(GpuError::Invalid("more regions than fit in one submission"));
    }
    Ok(())
}

fn not_compared(error: GpuError) -> Changing {
    error.log("changes in the periphery are not detected");
    Changing::Never
}

/// Refuses earlier images that are not at the given places.
fn check_reuse(job: &ComposeJob) -> Result<(), GpuError> {
    job.reuse.iter().try_for_each(|region| check_earlier(job, &region.reuse, &region.earlier))?;
    job.changes.iter().try_for_each(|region| check_earlier(job, &region.reuse, &region.earlier))?;
    let has_depth = |region: &ReuseRegion, age: usize| region.depth_at_age(age).is_some();
    let mut moved = job.reuse.iter().flat_map(|region| (1..=MAX_AGES).map(move |age| (region, age)));
    let lacks = moved.any(|(region, age)| region.reuse.has_moved_since(age) && !has_depth(region, age));
    let has_moved = |region: &ChangeRegion| (1..=MAX_AGES).any(|age| region.reuse.has_moved_since(age));
    if lacks || job.changes.iter().any(|region| has_moved(region) && region.depth.is_none()) {
        return Err(GpuError::Invalid("head movement without depth"));
    }
    depths(job).try_for_each(PictureDepth::check)
}

/// The application's images with earlier pictures that a job reads.
fn earlier<'a>(job: &ComposeJob<'a>) -> impl Iterator<Item = u32> + use<'a> {
    let completed = job.reuse.iter().map(|region| (&region.reuse, &region.earlier));
    let compared = job.changes.iter().map(|region| (&region.reuse, &region.earlier));
    let all = completed.chain(compared);
    all.flat_map(|(reuse, earlier)| reuse.pictures().zip(earlier).map(|(_, earlier)| earlier.app_index))
}

/// The depth that a job reads.
fn depths<'a>(job: &ComposeJob<'a>) -> impl Iterator<Item = &'a PictureDepth<'a>> + use<'a> {
    let reused =
        job.reuse.iter().flat_map(|region| region.depth.iter().chain(region.earlier_depth.iter().flatten()));
    reused.chain(job.changes.iter().filter_map(|region| region.depth.as_ref()))
}

fn check_earlier(
    job: &ComposeJob,
    reuse: &Reuse,
    earlier: &[EarlierImage; MAX_AGES],
) -> Result<(), GpuError> {
    let shape = job.app.shape();
    for (picture, earlier) in reuse.pictures().zip(earlier) {
        let fits = |axis: usize, limit: u32| {
            earlier.offset[axis].checked_add(picture.extent[axis]).is_some_and(|end| end <= limit)
        };
        let is_there = earlier.app_index != job.app_index
            && (earlier.app_index as usize) < job.app.images().len().min(EarlierImages::MOST)
            && earlier.array_layer < shape.array_layers
            && fits(0, shape.extent.width)
            && fits(1, shape.extent.height);
        if !is_there {
            return Err(GpuError::Invalid("a missing history image"));
        }
    }
    Ok(())
}
