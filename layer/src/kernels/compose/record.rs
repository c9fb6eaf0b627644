//! The recording of a frame.

use super::ComposeJob;
use super::copies::copy;
use super::draws::{Draw, Draws};
use super::pipelines::{Borders, Pipelines, ReusePipelines};
use super::reuse::Age;
use crate::gpu::barrier::{
    APP_COPIED_TO_RENDERED, APP_COPIED_TO_SAMPLED, APP_RENDERED_TO_COPIED, APP_RENDERED_TO_SAMPLED,
    APP_SAMPLED_TO_RENDERED, ImageBarrier, RUNTIME_ACQUIRED_TO_COPIED, RUNTIME_COPIED_TO_DRAWN,
};
use crate::gpu::{
    DrawRecorder, IndirectSize, Later, ListSet, Recorder, TileDraw, TilePipeline, Tiles, UniformSet,
};
use ash::vk;
use parafovea_core::reuse::MAX_AGES;
use smallvec::SmallVec;

/// The descriptor sets of draws.
pub(super) struct Sets<'a> {
    /// Of draws of all tiles.
    pub(super) plain: &'a UniformSet,
    /// Of draws of listed tiles.
    pub(super) lists: Option<&'a ListSet>,
}

/// Each step for all jobs before the next step, so that no job waits for another one's.
pub(super) fn record(
    recorder: &Recorder,
    jobs: &[ComposeJob],
    draws: &Draws,
    sets: &Sets,
    pipelines: &[(vk::Format, Pipelines)],
) {
    for (number, job) in jobs.iter().enumerate() {
        app_barrier(recorder, &APP_RENDERED_TO_COPIED, job, job.app_index as usize);
        recorder.barrier(&RUNTIME_ACQUIRED_TO_COPIED, job.runtime_image(), job.layers());
        for image in draws.copied_of(number).iter() {
            app_barrier(recorder, &APP_RENDERED_TO_COPIED, job, image);
        }
    }
    for (number, job) in jobs.iter().enumerate() {
        copy(recorder, number, job, draws);
    }
    for (number, job) in jobs.iter().enumerate() {
        let app = if draws.any_of(number) { &APP_COPIED_TO_SAMPLED } else { &APP_COPIED_TO_RENDERED };
        app_barrier(recorder, app, job, job.app_index as usize);
        recorder.barrier(&RUNTIME_COPIED_TO_DRAWN, job.runtime_image(), job.layers());
        let (copied, sampled) = (draws.copied_of(number), draws.sampled_of(number));
        for image in copied.without(sampled).iter() {
            app_barrier(recorder, &APP_COPIED_TO_RENDERED, job, image);
        }
        for image in sampled.iter() {
            let barrier =
                if copied.contains(image) { &APP_COPIED_TO_SAMPLED } else { &APP_RENDERED_TO_SAMPLED };
            app_barrier(recorder, barrier, job, image);
        }
    }
    for (number, job) in jobs.iter().enumerate() {
        draw(recorder, number, job, draws, sets, pipelines);
    }
    for (number, job) in jobs.iter().enumerate().filter(|(number, _)| draws.any_of(*number)) {
        app_barrier(recorder, &APP_SAMPLED_TO_RENDERED, job, job.app_index as usize);
        for image in draws.sampled_of(number).iter() {
            app_barrier(recorder, &APP_SAMPLED_TO_RENDERED, job, image);
        }
    }
}

/// A barrier over one of the application's images, which it left in a layout of its own.
fn app_barrier(recorder: &Recorder, barrier: &ImageBarrier, job: &ComposeJob, image: usize) {
    recorder.barrier(&barrier.left_in(job.app.layout(image)), job.app.images()[image], job.layers());
}

/// Draws the regions of one job, one render pass for each layer that has any.
fn draw(
    recorder: &Recorder,
    number: usize,
    job: &ComposeJob,
    draws: &Draws,
    sets: &Sets,
    pipelines: &[(vk::Format, Pipelines)],
) {
    let format = job.app.shape().format;
    let Some((_, pipelines)) = pipelines.iter().find(|(existing, _)| *existing == format) else { return };
    let Some(chroma) = pipelines.chroma.get() else { return };
    let reuse = pipelines.reuse.as_ref().and_then(Later::get);
    for layer in 0..job.layers() {
        let of_layer = |draw: &&Draw| draw.job == number && draw.layer == layer && draw.draws();
        let mut of_layer = draws.iter().filter(of_layer).peekable();
        let target = job.runtime.target(job.runtime_index, layer);
        let texture = job.app.texture(job.app_index, layer);
        let (Some(_), Some(target), Some(texture)) = (of_layer.peek(), target, texture) else { continue };
        recorder.draw_to(target, |pass| {
            for draw in of_layer {
                match (draw.reuse, &reuse, sets.lists) {
                    (None, ..) => pass.draw_tiles(&TileDraw {
                        pipeline: chroma,
                        parameters: sets.plain.handle(),
                        offsets: &[draw.offset.get()],
                        texture: Some(texture),
                        depth: None,
                        viewport: draw.viewport,
                        scissor: draw.scissor,
                        tiles: Tiles::Number(draw.tiles),
                    }),
                    (Some(_), Some(pipelines), Some(lists)) => {
                        Completion { pass, job, draw, pipelines, lists, texture }.draw();
                    }
                    (Some(_), ..) => {}
                }
            }
        });
    }
}

/// A region that is completed from earlier pictures.
struct Completion<'a> {
    pass: &'a DrawRecorder<'a>,
    job: &'a ComposeJob<'a>,
    draw: &'a Draw<'a>,
    pipelines: &'a ReusePipelines,
    lists: &'a ListSet,
    texture: vk::DescriptorSet,
}

impl Completion<'_> {
    /// Parts of tiles over whole ones, the oldest first; borders last: they are blended with fresh tiles whose colour is
    /// attenuated already.
    fn draw(&self) {
        let placed = self.draw.placed.borrow();
        let variant = usize::from(self.draw.attenuates);
        self.tiles(&self.pipelines.fresh, placed.offset, (self.texture, None), placed.fresh);
        let texture = |image: &super::EarlierImage| self.job.app.texture(image.app_index, image.array_layer);
        let ages: SmallVec<[(&Age, vk::DescriptorSet); MAX_AGES]> = self
            .draw
            .sampled()
            .filter_map(|(index, image)| Some((&placed.ages[index], texture(image)?)))
            .collect();
        for (age, texture) in &ages {
            let whole = if age.is_still { &self.pipelines.still } else { &self.pipelines.whole[variant] };
            self.tiles(whole, age.offset, (*texture, None), age.whole);
        }
        let ReusePipelines { mixed, moved, borders, .. } = self.pipelines;
        for (age, texture) in ages.iter().rev() {
            let mixed = if age.depth.is_some() { moved } else { mixed };
            self.tiles(&mixed[variant], age.offset, (*texture, age.depth), age.mixed);
        }
        let Some(Borders { unmoved, moved }) = borders else { return };
        for (age, texture) in &ages {
            let border = if age.depth.is_some() { moved } else { unmoved };
            self.tiles(&border[variant], age.offset, (*texture, age.depth), age.border);
        }
    }

    fn tiles(
        &self,
        pipeline: &TilePipeline,
        offset: u32,
        (texture, depth): (vk::DescriptorSet, Option<[vk::DescriptorSet; 2]>),
        size: Option<IndirectSize>,
    ) {
        let Some(size) = size else { return };
        self.pass.draw_tiles(&TileDraw {
            pipeline,
            parameters: self.lists.handle(),
            offsets: &[self.draw.offset.get(), offset],
            texture: Some(texture),
            depth,
            viewport: self.draw.viewport,
            scissor: self.draw.scissor,
            tiles: Tiles::Indirect(size),
        });
    }
}
