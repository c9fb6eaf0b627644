//! `change`: difference between the content of tiles and earlier pictures in the same directions.
//!
//! Recorded with [`super::compose`], whose earlier pictures it reads. The host reads the results some frames later, once the submit has
//! finished, and never waits for them.

pub use parafovea_core::kernels::change::ChangeParams;

use super::compose::{ComposeJob, EarlierImage, PictureDepth};
use crate::gpu::barrier::{APP_COMPARED_TO_RENDERED, APP_RENDERED_TO_COMPARED};
use crate::gpu::{
    Compare, CompareSet, Comparison, Gpu, GpuError, Recorder, ResultRing, SUBMITS_IN_FLIGHT, Shared,
    SlotIndex, UniformRing, Uses, WordRing,
};
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
        let needed: usize = compared(jobs).map(|(_, region)| region.tiles.count()).sum();
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
        let most: usize = compared(jobs).map(|(_, region)| tiles(region)).sum();
        let count = u32::try_from(most.next_power_of_two())
            .map_err(|_| GpuError::Unsupported("this number of tiles"))?;
        let params = UniformRing::new(&self.gpu, (MAX_COMPARED * MAX_AGES) as u32)?;
        let (words, results) = (WordRing::new(&self.gpu, count)?, ResultRing::new(&self.gpu, count)?);
        let set = CompareSet::new(&params, &words, &results)?;
        let lists = self.pending.iter_mut().map(|pending| &mut pending.tiles);
        lists.for_each(|tiles| tiles.reserve(count as usize));
        self.results.reserve(count as usize);
        let kept = SUBMITS_IN_FLIGHT * count as usize;
        self.kept.tiles.reserve(kept.saturating_sub(self.kept.tiles.len()));
        self.kept.changes.reserve(kept.saturating_sub(self.kept.changes.len()));
        self.room = Some(Room { uses: Uses::new(&self.gpu), set, params, words, results });
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

    /// Records the comparisons of jobs, after [`Self::free`] and after all their other work; all images are before and after as the
    /// application left them.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] where [`Self::make_room`] has not made enough.
    pub(super) fn record(
        &mut self,
        recorder: &Recorder,
        slot: SlotIndex,
        jobs: &[ComposeJob],
    ) -> Result<(), GpuError> {
        let Self { comparisons, room, pending, .. } = self;
        let Comparisons { unmoved, moved } = &**comparisons;
        let pending = &mut pending[slot.get()];
        let Some(room) = room.as_mut().filter(|_| compared(jobs).next().is_some()) else { return Ok(()) };
        pending.place = room.results.place(slot, 0);
        for job in jobs {
            for image in images(job) {
                let barrier = APP_RENDERED_TO_COMPARED.left_in(job.app.layout(image));
                recorder.barrier(&barrier, job.app.images()[image], job.app.shape().array_layers);
            }
        }
        let mut number = 0;
        for (job, region) in compared(jobs) {
            let extent = job.app.shape().extent;
            let newest = job.app.texture(job.app_index, region.array_layer);
            let before = pending.tiles.len();
            for (index, image) in region.earlier.iter().enumerate().take(region.reuse.ages()) {
                let tiles = region.tiles.with_age(index + 1);
                let extent = [extent.width, extent.height];
                let params = ChangeParams::new(&region.reuse, index + 1, region.offset, image.offset, extent);
                let earlier = job.app.texture(image.app_index, image.array_layer);
                let (Some(params), Some(newest), Some(earlier)) = (params, newest, earlier) else { continue };
                if tiles.is_empty() {
                    continue;
                }
                let at = pending.tiles.len() as u32;
                let first = [room.words.write(slot, at, tiles)?, room.results.place(slot, at)];
                let params = ChangeParams { first, count: tiles.len() as u32, ..params };
                let depth = region.depth.filter(|_| region.reuse.has_moved_since(index + 1));
                let params = depth.map_or(params, |depth| params.with_depth(depth.rect));
                let depth = depth.and_then(|depth| depth.texture());
                recorder.compare(&Compare {
                    comparison: if depth.is_some() { moved } else { unmoved },
                    parameters: room.set.handle(),
                    offset: room.params.write(slot, number, &params)?,
                    textures: [newest, earlier],
                    depth,
                    groups: params.count.div_ceil(THREADS),
                });
                pending.tiles.extend_from_slice(tiles);
                number += 1;
            }
            pending.views.push((region.view, pending.tiles.len() - before));
        }
        for job in jobs {
            for image in images(job) {
                let barrier = APP_COMPARED_TO_RENDERED.left_in(job.app.layout(image));
                recorder.barrier(&barrier, job.app.images()[image], job.app.shape().array_layers);
            }
        }
        recorder.computed_to_host();
        Ok(())
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

/// The comparisons, each with its job.
fn compared<'a, 'b>(
    jobs: &'b [ComposeJob<'a>],
) -> impl Iterator<Item = (&'b ComposeJob<'a>, &'a ChangeRegion<'a>)> {
    jobs.iter()
        .flat_map(|job| job.changes.iter().map(move |region| (job, region)))
        .filter(|(_, region)| region.tiles.count() > 0)
}

/// The images that a job compares, by their numbers.
fn images(job: &ComposeJob) -> impl Iterator<Item = usize> {
    let bit = |index: u32| 1u64.checked_shl(index).unwrap_or(0);
    let regions = job.changes.iter().filter(|region| region.tiles.count() > 0);
    let bits = regions.fold(0u64, |bits, region| {
        let earlier = region.earlier.iter().take(region.reuse.ages()).enumerate();
        let used = earlier.filter(|(index, _)| !region.tiles.with_age(index + 1).is_empty());
        used.fold(bits | bit(job.app_index), |bits, (_, image)| bits | bit(image.app_index))
    });
    (0..job.app.images().len()).filter(move |index| bits & bit(*index as u32) != 0)
}
