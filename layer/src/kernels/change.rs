//! `change`: difference between the content of tiles and earlier pictures in the same directions.
//!
//! Recorded with [`super::compose`], whose earlier pictures it reads, and repeated with it: the tiles and their number are in memory. The host reads the results some frames later, once the submit has
//! finished, and never waits for them.

pub use parafovea_core::kernels::change::ChangeParams;

use super::compose::key::{image, pair};
use super::compose::{ComposeJob, EarlierImage, PictureDepth};
use crate::gpu::barrier::{APP_COMPARED_TO_RENDERED, APP_RENDERED_TO_COMPARED, ImageBarrier};
use crate::gpu::{
    Compare, CompareSet, Comparison, Gpu, GpuError, IndirectRing, IndirectSize, Recorder, RecordingKey,
    ResultRing, SUBMITS_IN_FLIGHT, Shared, SlotIndex, UniformRing, Uses, WordRing, serial,
};
use ash::vk;
use parafovea_core::geometry::View;
use parafovea_core::reuse::{ComparedTiles, MAX_AGES, Reuse};
use smallvec::SmallVec;
use std::sync::Arc;

const SPIRV: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/change.spv"));

/// Tiles of a workgroup. The shader has the same number.
const THREADS: u32 = 64;

/// Most regions in one submit that are compared: the eyes' views of four projection layers.
pub const MAX_COMPARED: usize = 8;

/// A rectangle of one array layer whose tiles are compared with earlier pictures.
#[derive(Clone, Copy, Debug)]
pub struct ChangeRegion<'a> {
    /// The array layer.
    pub array_layer: u32,
    /// First pixel of the rectangle.
    pub offset: [u32; 2],
    /// The picture, and the earlier ones.
    pub reuse: Reuse<'a>,
    /// Tiles to compare.
    pub tiles: &'a ComparedTiles,
    /// Locations of the earlier pictures, one for each of [`Reuse::ages`].
    pub earlier: [EarlierImage; MAX_AGES],
    /// View of the picture: given back with the results.
    pub view: View,
    /// The depth of the picture, where [`Reuse::has_moved_since`] any.
    pub depth: Option<PictureDepth<'a>>,
}

/// The pipelines.
pub(super) struct Comparisons {
    unmoved: Arc<Comparison>,
    /// For pictures between which the head has moved.
    moved: Arc<Comparison>,
}

impl Comparisons {
    /// Compiles them.
    ///
    /// # Errors
    /// A failed call.
    pub(super) fn new(shared: &Shared) -> Result<Self, GpuError> {
        Ok(Self {
            unmoved: shared.comparison(SPIRV, c"change", false)?,
            moved: shared.comparison(SPIRV, c"moved_change", true)?,
        })
    }
}

/// The pass.
pub(super) struct Change {
    comparisons: Arc<Comparisons>,
    room: Option<Room>,
    /// Comparisons under way, by slot.
    pending: [Pending; SUBMITS_IN_FLIGHT],
    /// Findings of submits whose slots were used again.
    kept: Findings,
    results: Vec<f32>,
    gpu: Arc<Gpu>,
}

/// Room for the parameters, lists and results of a submit.
struct Room {
    // First: waits before the rest is destroyed.
    uses: Uses,
    set: CompareSet,
    params: UniformRing<ChangeParams>,
    words: WordRing,
    results: ResultRing,
    /// Numbers of workgroups.
    sizes: IndirectRing,
    /// Of the objects above.
    serial: u64,
}

/// Most comparisons of a submit, each of one region with one earlier picture.
const MOST_COMPARISONS: usize = MAX_COMPARED * MAX_AGES;

/// The comparisons of a submit, as they lie in memory.
pub(super) type Placed = SmallVec<[PlacedComparison; MOST_COMPARISONS]>;

/// The comparison of a region with one earlier picture.
pub(super) struct PlacedComparison {
    /// Of its parameters.
    offset: u32,
    /// The newest picture, and the earlier one.
    textures: [vk::DescriptorSet; 2],
    /// The depth of the newest picture, if the head has moved.
    depth: Option<vk::DescriptorSet>,
    /// Number of workgroups.
    groups: IndirectSize,
}

/// The comparisons of a submit.
#[derive(Default)]
struct Pending {
    /// Its number; 0: there is none, or its results were read.
    submit: u64,
    /// Place of its first result.
    place: u32,
    /// Views of its pictures, and number of compared tiles of each.
    views: SmallVec<[(View, usize); MAX_COMPARED]>,
    /// The tiles of all.
    tiles: Vec<u32>,
}

/// Findings that nobody has taken yet.
#[derive(Default)]
struct Findings {
    /// Views of the pictures, and number of compared tiles of each.
    views: SmallVec<[(View, usize); SUBMITS_IN_FLIGHT * MAX_COMPARED]>,
    /// The tiles of all.
    tiles: Vec<u32>,
    /// The change of each tile.
    changes: Vec<f32>,
}

impl Findings {
    /// Adds the findings of a submit. Without room for them, the earlier findings are dropped.
    fn add(&mut self, views: &[(View, usize)], tiles: &[u32], changes: &[f32]) {
        let room = self.tiles.capacity().min(self.changes.capacity());
        if self.tiles.len() + tiles.len() > room || self.views.len() + views.len() > self.views.inline_size()
        {
            self.clear();
        }
        self.views.extend_from_slice(views);
        self.tiles.extend_from_slice(tiles);
        self.changes.extend_from_slice(changes);
    }

    fn clear(&mut self) {
        self.views.clear();
        self.tiles.clear();
        self.changes.clear();
    }
}

impl Change {
    /// Prepares the pass.
    pub(super) fn new(gpu: &Arc<Gpu>, comparisons: &Arc<Comparisons>) -> Self {
        Self {
            comparisons: Arc::clone(comparisons),
            room: None,
            pending: Default::default(),
            kept: Findings::default(),
            results: Vec::new(),
            gpu: Arc::clone(gpu),
        }
    }

    /// Makes room for the comparisons of jobs. Buffers that are too small are replaced, after a wait for their last use, and their content
    /// is lost.
    ///
    /// # Errors
    /// A failed call.
    pub(super) fn make_room(&mut self, jobs: &[ComposeJob]) -> Result<(), GpuError> {
        let needed: usize = compared(jobs).map(|(.., region)| region.tiles.count()).sum();
        if needed == 0 || self.room.as_ref().is_some_and(|room| needed <= room.words.per_submit() as usize) {
            return Ok(());
        }
        self.pending.iter_mut().for_each(|pending| pending.submit = 0);
        self.room = None;
        // Were each tile fresh.
        let tiles = |region: &ChangeRegion| {
            let [columns, rows] = region.reuse.now().stale.tiles();
            columns as usize * rows as usize
        };
        let most: usize = compared(jobs).map(|(.., region)| tiles(region)).sum();
        let count = u32::try_from(most.next_power_of_two())
            .map_err(|_| GpuError::Unsupported("this number of tiles"))?;
        let params = UniformRing::new(&self.gpu, MOST_COMPARISONS as u32)?;
        let sizes = IndirectRing::new(&self.gpu, MOST_COMPARISONS as u32)?;
        let (words, results) = (WordRing::new(&self.gpu, count)?, ResultRing::new(&self.gpu, count)?);
        let set = CompareSet::new(&params, &words, &results)?;
        let lists = self.pending.iter_mut().map(|pending| &mut pending.tiles);
        lists.for_each(|tiles| tiles.reserve(count as usize));
        self.results.reserve(count as usize);
        let kept = SUBMITS_IN_FLIGHT * count as usize;
        self.kept.tiles.reserve(kept.saturating_sub(self.kept.tiles.len()));
        self.kept.changes.reserve(kept.saturating_sub(self.kept.changes.len()));
        let uses = Uses::new(&self.gpu);
        self.room = Some(Room { uses, set, params, words, results, sizes, serial: serial() });
        Ok(())
    }

    /// Frees a slot, whose last submit has finished; its findings are kept for [`Self::take_findings`].
    pub(super) fn free(&mut self, slot: SlotIndex) {
        let Self { room, pending, kept, results, .. } = self;
        let pending = &mut pending[slot.get()];
        if let Some(room) = room.as_ref().filter(|_| pending.submit > 0) {
            room.results.read(pending.place, pending.tiles.len(), results);
            kept.add(&pending.views, &pending.tiles, results);
        }
        pending.submit = 0;
        pending.views.clear();
        pending.tiles.clear();
    }

    /// Writes the comparisons of jobs to memory, after [`Self::free`], and adds them to the key of the submit's commands.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] where [`Self::make_room`] has not made enough.
    pub(super) fn place(
        &mut self,
        slot: SlotIndex,
        jobs: &[ComposeJob],
        mut key: Option<&mut RecordingKey>,
    ) -> Result<Placed, GpuError> {
        let mut placed = Placed::new();
        let Self { room, pending, .. } = self;
        let pending = &mut pending[slot.get()];
        let Some(room) = room.as_mut().filter(|_| compared(jobs).next().is_some()) else { return Ok(placed) };
        pending.place = room.results.place(slot, 0);
        if let Some(key) = &mut key {
            key.push(room.serial);
        }
        for (number, job, region) in compared(jobs) {
            let extent = job.app.shape().extent;
            let newest = job.app.texture(job.app_index, region.array_layer);
            let before = pending.tiles.len();
            for (index, earlier) in pictures(region) {
                let tiles = region.tiles.with_age(index + 1);
                let extent = [extent.width, extent.height];
                let params =
                    ChangeParams::new(&region.reuse, index + 1, region.offset, earlier.offset, extent);
                let texture = job.app.texture(earlier.app_index, earlier.array_layer);
                let (Some(params), Some(newest), Some(texture)) = (params, newest, texture) else { continue };
                let at = pending.tiles.len() as u32;
                let first = [room.words.write(slot, at, tiles)?, room.results.place(slot, at)];
                let params = ChangeParams { first, count: tiles.len() as u32, ..params };
                let depth = region.depth.filter(|_| region.reuse.has_moved_since(index + 1));
                let params = depth.map_or(params, |depth| params.with_depth(depth.rect));
                let place = placed.len() as u32;
                placed.push(PlacedComparison {
                    offset: room.params.write(slot, place, &params)?,
                    textures: [newest, texture],
                    depth: depth.and_then(|depth| depth.texture()),
                    groups: room.sizes.write_groups(slot, place, params.count.div_ceil(THREADS))?,
                });
                if let Some(key) = &mut key {
                    key.push(pair(number, region.array_layer));
                    key.push(image(job, earlier.app_index));
                    key.push(pair(earlier.array_layer, depth.is_some().into()));
                    key.extend(depth.into_iter().flat_map(|depth| depth.key()));
                }
                pending.tiles.extend_from_slice(tiles);
            }
            pending.views.push((region.view, pending.tiles.len() - before));
        }
        Ok(placed)
    }

    /// Records placed comparisons, after all other work of the jobs; all images are before and after as the application left them.
    pub(super) fn record(&self, recorder: &Recorder, jobs: &[ComposeJob], placed: &Placed) {
        let Comparisons { unmoved, moved } = &*self.comparisons;
        let Some(room) = self.room.as_ref().filter(|_| !placed.is_empty()) else { return };
        let barriers = |barrier: &ImageBarrier| {
            for job in jobs {
                for image in images(job) {
                    let barrier = barrier.left_in(job.app.layout(image));
                    recorder.barrier(&barrier, job.app.images()[image], job.app.shape().array_layers);
                }
            }
        };
        barriers(&APP_RENDERED_TO_COMPARED);
        for comparison in placed {
            recorder.compare(&Compare {
                comparison: if comparison.depth.is_some() { moved } else { unmoved },
                parameters: room.set.handle(),
                offset: comparison.offset,
                textures: comparison.textures,
                depth: comparison.depth,
                groups: comparison.groups,
            });
        }
        barriers(&APP_COMPARED_TO_RENDERED);
        recorder.computed_to_host();
    }

    /// The last recording was submitted.
    pub(super) fn submitted(&mut self, slot: SlotIndex, submit: u64) {
        let pending = &mut self.pending[slot.get()];
        if let Some(room) = self.room.as_ref().filter(|_| !pending.tiles.is_empty()) {
            room.uses.mark(submit);
            pending.submit = submit;
        }
    }

    /// Hands out the findings since the last call: of each picture its view, the tiles, and the change of each. Does not wait.
    pub(super) fn take_findings(&mut self, mut each: impl FnMut(&View, &[u32], &[f32])) {
        let Self { room, pending, kept, results, gpu, .. } = self;
        hand_out(&kept.views, &kept.tiles, &kept.changes, &mut each);
        kept.clear();
        let Some(room) = room else { return };
        for pending in pending.iter_mut().filter(|pending| pending.submit > 0) {
            if !gpu.is_finished(pending.submit) {
                continue;
            }
            pending.submit = 0;
            room.results.read(pending.place, pending.tiles.len(), results);
            hand_out(&pending.views, &pending.tiles, results, &mut each);
        }
    }
}

/// Hands out the part of each view.
fn hand_out(
    views: &[(View, usize)],
    mut tiles: &[u32],
    mut changes: &[f32],
    each: &mut impl FnMut(&View, &[u32], &[f32]),
) {
    for (view, count) in views {
        let of_view = (tiles.split_at_checked(*count), changes.split_at_checked(*count));
        let (Some((here, others)), Some((changed, later))) = of_view else { break };
        each(view, here, changed);
        (tiles, changes) = (others, later);
    }
}

/// The comparisons, each with its job and the job's number.
fn compared<'a, 'b>(
    jobs: &'b [ComposeJob<'a>],
) -> impl Iterator<Item = (u32, &'b ComposeJob<'a>, &'a ChangeRegion<'a>)> {
    (0..)
        .zip(jobs)
        .flat_map(|(number, job)| job.changes.iter().map(move |region| (number, job, region)))
        .filter(|(.., region)| region.tiles.count() > 0)
}

/// The earlier pictures of a region's comparisons: all up to the oldest, even without tiles, so that frames repeat commands.
fn pictures<'a>(region: &'a ChangeRegion) -> impl Iterator<Item = (usize, &'a EarlierImage)> {
    region.earlier.iter().enumerate().take(region.reuse.ages().min(region.tiles.oldest()))
}

/// The images that a job compares, by their numbers.
fn images(job: &ComposeJob) -> impl Iterator<Item = usize> {
    let bit = |index: u32| 1u64.checked_shl(index).unwrap_or(0);
    let regions = job.changes.iter().filter(|region| region.tiles.count() > 0);
    let bits = regions.fold(0u64, |bits, region| {
        pictures(region).fold(bits | bit(job.app_index), |bits, (_, image)| bits | bit(image.app_index))
    });
    (0..job.app.images().len()).filter(move |index| bits & bit(*index as u32) != 0)
}
