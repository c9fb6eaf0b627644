//! Which frames have the same commands: those whose pictures are copied and attenuated alone, with the same images and rectangles. The
//! gaze is in memory that the commands read.

use super::ComposeJob;
use super::draws::Draws;
use crate::gpu::Content;
use ash::vk;

/// Everything that the commands of these jobs depend on; `None` where tiles come from earlier pictures or are compared with them: these
/// commands differ in every frame. `serial` is that of the pass.
pub(super) fn content(serial: u64, jobs: &[ComposeJob], draws: &Draws) -> Option<Content> {
    if jobs.iter().any(|job| !job.reuse.is_empty() || !job.changes.is_empty()) {
        return None;
    }
    let mut content = Content::new();
    content.extend([serial, jobs.len() as u64]);
    for job in jobs {
        let layout = job.app.layout(job.app_index as usize);
        content.push(job.app.serial());
        content.push(pair(job.app_index, layout.as_raw() as u32));
        content.push(job.runtime.serial());
        content.push(job.runtime_index.into());
    }
    for draw in draws.iter() {
        content.push(pair(draw.job as u32, draw.layer));
        content.push(pair(draw.offset.get(), draw.tiles));
        content.extend(rect(draw.viewport));
        content.extend(rect(draw.scissor));
    }
    Some(content)
}

fn pair(high: u32, low: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

fn rect(vk::Rect2D { offset, extent }: vk::Rect2D) -> [u64; 2] {
    [pair(offset.x as u32, offset.y as u32), pair(extent.width, extent.height)]
}
