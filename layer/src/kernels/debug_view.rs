//! `debug_view`: decisions, drawn over pictures that are finished otherwise, when the user asks to see them.
//!
//! It is a submit of its own on the session's queue: after the submit of [`super::compose`] and all readers of the finished pictures except
//! the runtime; or, if the runtime's images are the application's, before the application releases one.

pub use parafovea_core::kernels::debug_view::{DebugView, DebugViewParams, MapShape};

use super::compose::RuntimeImages;
use crate::gpu::barrier::{ImageBarrier, RUNTIME_DRAWN_TO_BLENDED, blended_to};
use crate::gpu::{
    DeviceBuffer, Gpu, GpuError, Later, ListSet, Output, Purpose, Shared, TileDraw, TilePipeline, TileShader,
    Tiles, UniformRing, Uses,
};
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

const SPIRV: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/debug_view.spv"));

/// Most pictures in one submit: one for each eye.
pub const MOST_PICTURES: usize = 2;

/// One picture that is drawn over.
#[derive(Clone, Copy)]
pub struct DebugViewJob<'a> {
    /// Index of the picture's eye, 0 or 1: each eye has a map of its own, and there is one eye buffer of an eye at most.
    pub eye: usize,
    /// The runtime's images; the picture is one of them.
    pub runtime: &'a RuntimeImages,
    /// Index of that image.
    pub runtime_index: u32,
    /// The array layer.
    pub array_layer: u32,
    /// Layout of the image before and after.
    pub layout: vk::ImageLayout,
    /// The drawn view, if any ([`DebugViewParams::drawn`]); [`DebugViewParams::first_word`] is set by the pass.
    pub params: DebugViewParams,
    /// The map of its tiles; `None` if that was copied to [`DebugViewPass::place`] on this queue, or none is needed.
    pub map: Option<&'a [u8]>,
}

/// The pass.
pub struct DebugViewPass {
    // First: waits before the rest is destroyed.
    uses: Uses,
    pipelines: Vec<Drawn>,
    maps: Option<Maps>,
    /// Whether copies to the maps are pending, with no later submit of the layer to order them.
    has_copies: bool,
    uniforms: UniformRing<DebugViewParams>,
    gpu: Arc<Gpu>,
}

/// The pipeline of a view for images of one format, some time after it was asked for.
struct Drawn {
    format: vk::Format,
    view: DebugView,
    pipeline: Later<Arc<TilePipeline>>,
}

/// Maps of both pictures, one behind the other.
struct Maps {
    // First: waits before the rest is destroyed.
    uses: Uses,
    set: ListSet,
    buffer: DeviceBuffer,
    /// Bytes of one of them.
    bytes: u32,
    /// Columns and rows of each that was copied here, and not written since.
    copied: [Option<[u32; 2]>; MOST_PICTURES],
}

impl DebugViewPass {
    /// Prepares the pass.
    ///
    /// # Errors
    /// [`GpuError::Call`] or [`GpuError::Unsupported`] when memory or objects cannot be had.
    pub fn new(gpu: Arc<Gpu>) -> Result<Self, GpuError> {
        let uniforms = UniformRing::new(&gpu, MOST_PICTURES as u32)?;
        let (pipelines, maps) = (Vec::new(), None);
        Ok(Self { uses: Uses::new(&gpu), pipelines, maps, has_copies: false, uniforms, gpu })
    }

    /// Makes room for maps of `bytes`, if there is not enough. Returns the place of an eye's map: the buffer, which may be written by
    /// copies on this queue, and the offset in bytes.
    ///
    /// # Errors
    /// A failed call, or more than the device takes.
    pub fn place(&mut self, eye: usize, bytes: u32) -> Result<(vk::Buffer, u64), GpuError> {
        if self.maps.as_ref().is_none_or(|maps| maps.bytes < bytes) {
            let larger = Maps::new(&self.gpu, &self.uniforms, bytes)?;
            self.let_maps_go();
            self.maps = Some(larger);
        }
        let maps = self.maps.as_ref().ok_or(GpuError::Invalid("no memory for maps"))?;
        Ok((maps.buffer.handle(), eye as u64 * u64::from(maps.bytes)))
    }

    /// Notes that a copy of `tiles` columns and rows to the [`Self::place`] of an eye was submitted: it ends before the next submit.
    pub fn copied(&mut self, eye: usize, tiles: [u32; 2]) {
        self.has_copies = true;
        if let Some(maps) = &mut self.maps {
            maps.copied[eye] = Some(tiles);
        }
    }

    /// Whether an eye has a copy of `tiles` columns and rows, so that its map need not be written.
    pub fn has_copy(&self, eye: usize, tiles: [u32; 2]) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.copied[eye] == Some(tiles))
    }

    /// Drops the maps. The end of copies without a later submit is unknown: then the buffer is leaked.
    fn let_maps_go(&mut self) {
        let maps = self.maps.take();
        if std::mem::take(&mut self.has_copies) {
            std::mem::forget(maps);
        }
    }

    /// Draws over the pictures, at most [`MOST_PICTURES`], without waiting; false where the pipeline is not there yet. A steady frame
    /// allocates nothing on the heap.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] where the format cannot be blended; [`GpuError::Invalid`] when something is not there or too
    /// large; [`GpuError::Timeout`] when earlier submits hang; a failed call. Then nothing was submitted.
    pub fn submit(&mut self, jobs: &[DebugViewJob]) -> Result<bool, GpuError> {
        let mut jobs: SmallVec<[&DebugViewJob; MOST_PICTURES]> = jobs.iter().collect();
        if let Some(error) = jobs.iter().find_map(|job| rect_of(job).err()) {
            return Err(error);
        }
        let is_second = |number: usize| jobs[..number].iter().any(|earlier| earlier.eye == jobs[number].eye);
        if jobs.iter().any(|job| job.eye >= MOST_PICTURES) || (0..jobs.len()).any(is_second) {
            return Err(GpuError::Invalid("two images for one eye, or an image for no eye"));
        }
        jobs.retain(|job| job.params.drawn().is_some());
        if jobs.is_empty() {
            return Ok(true);
        }
        let mut is_there = true;
        for job in &jobs {
            is_there &= self.prepare(job)?;
        }
        if !is_there {
            return Ok(false);
        }
        let bytes = jobs.iter().filter_map(|job| Some(job.map?.len())).max().unwrap_or(0);
        // Also where there are none: the set has to be there.
        self.place(0, bytes as u32)?;
        let Self { pipelines, maps: Some(maps), uniforms, gpu, .. } = self else {
            return Err(GpuError::Invalid("no memory for maps"));
        };
        let mut draws: SmallVec<[(&DebugViewJob, u32); MOST_PICTURES]> = SmallVec::new();
        let next = gpu.next_submit(Purpose::DebugView)?;
        let slot = next.slot();
        let submit = next.submit(None, |recorder| {
            recorder.reads_to_updates();
            for job in &jobs {
                let first_byte = job.eye as u32 * maps.bytes;
                if let Some(map) = job.map {
                    maps.copied[job.eye] = None;
                    recorder.update_buffer(maps.buffer.handle(), first_byte.into(), map);
                }
                let params = DebugViewParams { first_word: first_byte / 4, ..job.params };
                draws.push((*job, uniforms.write(slot, job.eye as u32, &params)?));
            }
            recorder.updates_to_reads();
            let mut images: SmallVec<[(vk::Image, u32, vk::ImageLayout); MOST_PICTURES]> = SmallVec::new();
            for job in &jobs {
                let image = job.runtime.images().get(job.runtime_index as usize).copied();
                let image = image.ok_or(GpuError::Invalid("an image index out of range"))?;
                if !images.iter().any(|(earlier, ..)| *earlier == image) {
                    images.push((image, job.runtime.shape().array_layers, job.layout));
                }
            }
            for (image, layers, layout) in &images {
                let from = ImageBarrier { old_layout: *layout, ..RUNTIME_DRAWN_TO_BLENDED };
                recorder.barrier(&from, *image, *layers);
            }
            for (job, offset) in &draws {
                let format = job.runtime.shape().format;
                let is_its =
                    |drawn: &&Drawn| drawn.format == format && Some(drawn.view) == job.params.drawn();
                let pipeline = pipelines.iter().find(is_its).and_then(|drawn| drawn.pipeline.get());
                let target = job.runtime.target(job.runtime_index, job.array_layer);
                let (Some(pipeline), Some(target)) = (pipeline, target) else {
                    return Err(GpuError::Invalid("an array layer out of range"));
                };
                let rect = rect_of(job)?;
                recorder.draw_to(target, |pass| {
                    pass.draw_tiles(&TileDraw {
                        pipeline,
                        parameters: maps.set.handle(),
                        offsets: &[*offset, *offset],
                        texture: None,
                        depth: None,
                        viewport: rect,
                        scissor: rect,
                        tiles: Tiles::Number(1),
                    });
                });
            }
            let is_elsewhere = |(.., layout): &&(vk::Image, u32, vk::ImageLayout)| {
                *layout != RUNTIME_DRAWN_TO_BLENDED.new_layout
            };
            for (image, layers, layout) in images.iter().filter(is_elsewhere) {
                recorder.barrier(&blended_to(*layout), *image, *layers);
            }
            Ok(())
        })?;
        maps.uses.mark(submit);
        self.has_copies = false;
        self.uses.mark(submit);
        for job in &jobs {
            job.runtime.uses().mark(submit);
        }
        Ok(true)
    }

    /// Whether the pipeline of a picture is ready; requests it the first time.
    fn prepare(&mut self, job: &DebugViewJob) -> Result<bool, GpuError> {
        let format = job.runtime.shape().format;
        let Some(view) = job.params.drawn() else { return Ok(true) };
        let known = self.pipelines.iter().find(|drawn| (drawn.format, drawn.view) == (format, view));
        if let Some(known) = known {
            return Ok(known.pipeline.get().is_some());
        }
        if !self.gpu.can_blend(format) {
            return Err(GpuError::Unsupported("blending in this format"));
        }
        let fragment = match view {
            DebugView::Rates => c"rates",
            DebugView::Eccentricity => c"eccentricity",
            DebugView::Age => c"age",
            DebugView::Gaze | DebugView::Ahead => c"gaze",
        };
        let shader = TileShader {
            vertex: c"corner",
            fragment,
            has_lists: true,
            has_depth: false,
            output: Output::Blended,
        };
        let make = move |shared: &Shared| shared.tile_pipeline(format, SPIRV, &shader);
        let pipeline = self.gpu.shared()?.ask("debug views are off", make);
        let is_there = pipeline.get().is_some();
        self.pipelines.push(Drawn { format, view, pipeline });
        Ok(is_there)
    }
}

impl Drop for DebugViewPass {
    fn drop(&mut self) {
        self.let_maps_go();
    }
}

impl Maps {
    fn new(gpu: &Arc<Gpu>, uniforms: &UniformRing<DebugViewParams>, bytes: u32) -> Result<Self, GpuError> {
        // Offsets of copies are multiples of four.
        let bytes = bytes.max(4).next_multiple_of(4);
        let size = u64::from(bytes) * MOST_PICTURES as u64;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let buffer = DeviceBuffer::without_content(gpu, usage, size)?;
        // The shader has one uniform.
        let set = ListSet::over(uniforms, uniforms, buffer.handle())?;
        Ok(Self { uses: Uses::new(gpu), set, buffer, bytes, copied: [None; MOST_PICTURES] })
    }
}

/// The rectangle of a picture, where it is within its image and has a size that is counted without overflow.
fn rect_of(job: &DebugViewJob) -> Result<vk::Rect2D, GpuError> {
    let DebugViewParams { rect_offset, rect_extent, map_extent, texel, tiles, .. } = job.params;
    let needed = MapShape { extent: map_extent, texel, tiles }.bytes() as usize;
    let shows_tiles = job.params.drawn().is_some_and(DebugView::shows_tiles);
    if shows_tiles && job.map.is_some_and(|map| map.len() != needed) {
        return Err(GpuError::Invalid("a map of another size"));
    }
    let vk::Extent2D { width, height } = job.runtime.shape().extent;
    let fits = |axis: usize, limit: u32| {
        let is_counted = rect_extent[axis].checked_mul(map_extent[axis]).is_some();
        let end = rect_offset[axis].checked_add(rect_extent[axis]);
        is_counted && rect_extent[axis] > 0 && end.is_some_and(|end| end <= limit)
    };
    if !fits(0, width) || !fits(1, height) {
        return Err(GpuError::Invalid("a rectangle beyond its image"));
    }
    Ok(vk::Rect2D {
        offset: vk::Offset2D { x: rect_offset[0] as i32, y: rect_offset[1] as i32 },
        extent: vk::Extent2D { width: rect_extent[0], height: rect_extent[1] },
    })
}
