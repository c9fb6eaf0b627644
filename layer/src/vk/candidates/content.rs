//! The content of a candidate's map, present and wanted.

use crate::pass_detection::{Eyes, Part};
use ash::vk;
use parafovea_core::reuse::StaleTiles;
use smallvec::SmallVec;
use std::sync::Arc;

/// Most rectangles of one target that are distinguished in a frame; with more, all is 1x1.
const MOST_USES: usize = 8;

/// Parts of the target that show an eye, as fractions of `area`.
pub type Parts = SmallVec<[Part; 4]>;

/// Texels of all layers of a map, row by row.
pub type Texels = Arc<Vec<u8>>;

/// The content of a map.
#[derive(Debug, Default)]
pub struct Content {
    /// Uses of the target by passes, by render area.
    uses: SmallVec<[Use; MOST_USES]>,
    /// Whether the GPU's map has any content.
    is_initialised: bool,
    /// Whether it had any before the last upload.
    was_initialised: bool,
    /// Whether the map on the GPU is 1x1 all over.
    is_coarse: bool,
    /// Whether `uses` changed since the last upload.
    is_changed: bool,
    /// The plan that the map was last resolved from.
    plan: u64,
    /// The stale tiles that it left out of each eye buffer.
    stale: [StaleTiles; 2],
    /// The queue that it is used on.
    queue: vk::Queue,
    sharing: Sharing,
    /// The last frame with a pass, and whether nothing fills coarse tiles after one of that frame.
    unfilled: (u64, bool),
    /// Whether `source` is on the GPU, or on its way.
    is_uploaded: bool,
    /// The source of the last map on the GPU.
    source: MapSource,
}

/// Use of a map by several queues, so that it cannot be written in the order of one.
///
/// It ends with enough frames of one queue. Writes of the map are then in order with the last reads by another queue: the application orders its
/// own passes to the target, so that this queue's passes since then began after those reads, and writes of the map wait for these passes.
///
/// Each time that it begins, one write is in the order of one queue only: the map becomes 1x1, beside passes of the other queue that may still read
/// it. So each further time lasts twice as long as the one before.
#[derive(Debug, Default)]
struct Sharing {
    /// The last frame in which the map was used on another queue than before, while it lasts.
    at: Option<u64>,
    /// Number of times that it began.
    times: u32,
}

/// Frames of one queue after which the first sharing ends.
const SHARED: u64 = 120;

impl Sharing {
    /// Takes a use in a frame, on the queue of the last use or on another one. Returns whether sharing began or ended.
    fn note(&mut self, frame: u64, is_other: bool) -> bool {
        let was_shared = self.at.is_some();
        if is_other {
            self.at = Some(frame);
            self.times += u32::from(!was_shared);
        } else {
            self.at = self.at.filter(|at| frame < at.saturating_add(self.lasts()));
        }
        self.at.is_some() != was_shared
    }

    /// Frames of one queue after which it ends.
    fn lasts(&self) -> u64 {
        SHARED.saturating_mul(1 << self.times.saturating_sub(1).min(32))
    }

    fn is_on(&self) -> bool {
        self.at.is_some()
    }
}

/// The source of a map.
#[derive(Debug, Default)]
struct MapSource {
    area: [u32; 4],
    parts: Parts,
    texels: Texels,
}

/// One rectangle of a target that a pass draws.
#[derive(Debug, Clone, PartialEq)]
struct Use {
    /// Number of the frame that it was last seen in.
    frame: u64,
    /// The render area: x, y, width, height in pixels.
    area: [u32; 4],
    /// The shown parts; empty if they are unknown.
    parts: Parts,
}

/// Work to do before a submit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Nothing.
    None,
    /// The map is out of date; it may stay so for a while.
    Upload,
    /// The map has no content yet.
    Initialise,
}

impl Content {
    /// Of a map that has content, 1x1 all over.
    pub fn initialised() -> Self {
        Self { is_initialised: true, ..Self::default() }
    }

    /// Takes a pass that is submitted to `queue` in frame number `frame`, and shows these parts of the area.
    pub fn note(&mut self, queue: vk::Queue, frame: u64, area: [u32; 4], parts: &[Part]) {
        let last = std::mem::replace(&mut self.queue, queue);
        if self.sharing.note(frame, last != vk::Queue::null() && last != queue) {
            self.is_changed = true;
            if self.sharing.is_on() {
                let frames = self.sharing.lasts();
                tracing::info!(
                    "render passes on several queues draw to one target: it stays at 1x1 until one queue alone has drawn to it for {frames} frames"
                );
            }
        }
        let before = self.uses.len();
        self.uses.retain(|used| {
            let is_this = used.area == area && used.parts.as_slice() == parts;
            let is_outdated = used.frame + 1 < frame || (used.frame < frame && overlap(used.area, area));
            is_this || !is_outdated
        });
        self.is_changed |= self.uses.len() != before;
        match self.uses.iter_mut().find(|used| used.area == area && used.parts.as_slice() == parts) {
            Some(known) => known.frame = frame,
            None => {
                self.is_changed = true;
                if self.uses.len() < MOST_USES {
                    self.uses.push(Use { frame, area, parts: parts.into() });
                }
            }
        }
    }

    /// Whether passes draw to the target that get the plan's rates.
    pub fn shows_scene(&self) -> bool {
        !self.sharing.is_on() && self.uses.iter().any(|used| !used.parts.is_empty())
    }

    /// Whether the map has to be written, from plan number `plan`.
    pub fn need(&self, plan: u64) -> Need {
        if !self.is_initialised {
            return Need::Initialise;
        }
        let has_parts = self.uses.iter().any(|used| !used.parts.is_empty());
        let is_outdated = self.is_changed || (has_parts && self.plan < plan);
        let is_needed = match self.sharing.is_on() {
            // A map for the last gaze would stay.
            true => self.is_coarse,
            false => is_outdated && (has_parts || self.is_coarse),
        };
        if is_needed { Need::Upload } else { Need::None }
    }

    /// Takes an upload of the map of [`Self::whole`], which is `parts`, from plan number `plan`, with the stale tiles of both eyes in that.
    pub fn uploaded(&mut self, plan: u64, parts: &[Part], stale: [&StaleTiles; 2]) {
        let shows = |eye| parts.iter().any(|part| part.eyes == eye || part.eyes == Eyes::Finer);
        let are_shown = [shows(Eyes::Left), shows(Eyes::Right)];
        for ((held, stale), is_shown) in self.stale.iter_mut().zip(stale).zip(are_shown) {
            match is_shown {
                true => held.clone_from(stale),
                false => held.clear(),
            }
        }
        self.was_initialised = std::mem::replace(&mut self.is_initialised, true);
        self.is_changed = false;
        self.is_coarse = !self.sharing.is_on() && self.uses.iter().any(|used| !used.parts.is_empty());
        self.plan = plan;
    }

    /// The last upload failed: the map on the GPU is as it was before, and has to be written again.
    pub fn upload_failed(&mut self) {
        self.lose();
        self.is_initialised = self.was_initialised;
        self.is_changed = true;
        // It may be, by the upload before.
        self.is_coarse = true;
    }

    /// Whether the map on the GPU has stale tiles, so that no other picture may be drawn with it.
    pub fn has_stale_tiles(&self) -> bool {
        self.stale.iter().any(|stale| !stale.is_empty())
    }

    /// The stale tiles of the left and of the right eye in the map on the GPU.
    pub fn stale(&self) -> &[StaleTiles; 2] {
        &self.stale
    }

    /// Takes of a pass in frame number `frame` whether nothing fills coarse tiles after it.
    pub fn note_fill(&mut self, frame: u64, is_unfilled: bool) {
        let (last, was_unfilled) = self.unfilled;
        self.unfilled = (frame, is_unfilled || (last == frame && was_unfilled));
        self.is_changed |= self.is_unfilled() != was_unfilled;
    }

    /// Whether nothing may be coarse, though tiles may be left out.
    pub fn is_unfilled(&self) -> bool {
        self.unfilled.1
    }

    /// Takes the source of the next map on the GPU: these texels, resolved over `parts` of `area`. Returns whether it changed; otherwise the map
    /// has this content already.
    pub fn resolve(&mut self, area: [u32; 4], parts: &[Part], texels: &Texels) -> bool {
        let source = &mut self.source;
        let is_same = source.area == area && source.parts.as_slice() == parts && source.texels == *texels;
        if !is_same {
            source.area = area;
            source.parts = parts.into();
        }
        source.texels = Arc::clone(texels);
        !(std::mem::replace(&mut self.is_uploaded, true) && is_same)
    }

    /// Whether the map on the GPU, or on its way, is 1x1 because nothing known is shown.
    pub fn is_of_nothing(&self) -> bool {
        self.is_uploaded && self.source.parts.is_empty()
    }

    /// The resolved texels did not get to the GPU.
    pub fn lose(&mut self) {
        self.is_uploaded = false;
    }

    /// The texels that the map on the GPU was made of.
    pub fn texels(&self) -> &[u8] {
        &self.source.texels
    }

    /// All uses as one: the area around all render areas, and the parts as fractions of it. Where a pass draws that shows
    /// nothing known, nothing is shown.
    pub fn whole(&self) -> ([u32; 4], Parts) {
        let is_known = self.is_known() && !self.sharing.is_on();
        let (Some(area), true) = (self.uses.iter().map(|used| used.area).reduce(around), is_known) else {
            return ([0; 4], Parts::new());
        };
        let parts =
            self.uses.iter().flat_map(|used| used.parts.iter().map(|part| within(*part, used.area, area)));
        (area, parts.collect())
    }

    /// Whether every use is of something that is known, or beside all that are.
    fn is_known(&self) -> bool {
        let (known, unknown): (SmallVec<[&Use; MOST_USES]>, SmallVec<[&Use; MOST_USES]>) =
            self.uses.iter().partition(|used| !used.parts.is_empty());
        self.uses.len() < MOST_USES
            && !known.iter().any(|used| unknown.iter().any(|other| overlap(used.area, other.area)))
    }
}

/// A part, given as fractions of an area, as fractions of another.
fn within(part: Part, area: [u32; 4], whole: [u32; 4]) -> Part {
    if area == whole {
        return part;
    }
    let rect = std::array::from_fn(|index| {
        let axis = index % 2;
        let size = area[axis + 2] as f32;
        let pixels = part.rect[index] * size;
        let offset = if index < 2 { area[axis] as f32 - whole[axis] as f32 } else { 0.0 };
        (pixels + offset) / (whole[axis + 2] as f32).max(1.0)
    });
    Part { rect, ..part }
}

fn end(area: [u32; 4], axis: usize) -> u32 {
    area[axis].saturating_add(area[axis + 2])
}

fn overlap(a: [u32; 4], b: [u32; 4]) -> bool {
    (0..2).all(|axis| a[axis] < end(b, axis) && b[axis] < end(a, axis))
}

fn around(a: [u32; 4], b: [u32; 4]) -> [u32; 4] {
    let [x, y] = [0, 1].map(|axis| a[axis].min(b[axis]));
    let [right, bottom] = [0, 1].map(|axis| end(a, axis).max(end(b, axis)));
    [x, y, right - x, bottom - y]
}

#[cfg(test)]
mod tests;
