//! Fills of images of several samples, which wait for a reader: passes that go on with an image leave the same blocks out.
//!
//! An image in a layout for attachments alone has no other readers (Vulkan specification, "Image Layouts"): it is filled when it leaves
//! that layout, when another pass draws to it, and at the end of the command buffer. The waiting fills also identify the mask whose
//! template is in the depth image.

use super::Masks;
use super::attachments::is_written;
use crate::backend::mask::MaskMap;
use crate::gpu::{AppCommands, Compilation, ImagePart};
use crate::kernels::samples::{SampleFill, SampleKernel, SampleKind};
use crate::pass_detection::{ImageKey, Target, Unmasked};
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// A fill that waits.
#[derive(Clone)]
pub struct Pending {
    /// The mask whose skipped blocks are filled.
    pub map: Arc<MaskMap>,
    /// The image to fill.
    pub target: Target,
    pub(super) part: ImagePart,
    pub(super) format: vk::Format,
    /// The layout in which it waits.
    pub(super) layout: vk::ImageLayout,
    pub(super) fill: Arc<SampleFill>,
}

impl Pending {
    /// Whether it may wait: the image is in a layout for attachments alone.
    pub fn may_wait(&self) -> bool {
        match self.fill.is_color() {
            true => matches!(
                self.layout,
                vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL | vk::ImageLayout::ATTACHMENT_OPTIMAL
            ),
            false => is_written(self.layout),
        }
    }

    /// Whether a barrier of an image, to a layout and between queue families, ends the waiting.
    pub fn ends_with(&self, image: vk::Image, layout: vk::ImageLayout, families: [u32; 2]) -> bool {
        let [from, to] = families;
        self.part.image == image && (layout != self.layout || from != to)
    }
}

impl Masks {
    /// The kernel that fills images of a kind, once it is compiled; asks for it the first time.
    ///
    /// # Errors
    ///
    /// It is not compiled yet, or cannot be: passes that need it are left alone.
    pub(super) fn sample_kernel(&self, kind: SampleKind) -> Result<Arc<SampleKernel>, Unmasked> {
        let known = match self.sample_kernels.get(kind) {
            Some(known) => known,
            None => {
                let gpu = Arc::clone(self.gpu().ok_or(Unmasked::Failed)?);
                let make = move |compilation: &Arc<Compilation>| {
                    gpu.compile_with(compilation);
                    SampleKernel::new(&gpu, kind)
                };
                // Asked for without a lock: another thread may have been faster.
                let new = Arc::new(self.compiler().ask("no masks in multisampled passes", make));
                self.sample_kernels.get_or_insert(kind, new)
            }
        };
        match known.get() {
            Some(kernel) => Ok(Arc::clone(kernel)),
            None if known.has_failed() => Err(Unmasked::Failed),
            None => Err(Unmasked::New),
        }
    }

    /// Records a fill, which changes the bound compute and graphics state.
    ///
    /// # Safety
    ///
    /// `commands` is recording, outside of a render pass, on this thread; the image is live until it has run.
    pub unsafe fn fill(&self, pending: &Pending, commands: vk::CommandBuffer) {
        let Some(gpu) = self.gpu() else { return };
        // SAFETY: the command buffer is recording, as `# Safety` demands; the map is kept by its candidate, which the command buffer keeps.
        let commands = unsafe { AppCommands::new(gpu, commands) };
        let Pending { map, part, format, layout, fill, .. } = pending;
        map.fill_samples(&commands, fill, (*part, *format), *layout);
    }
}

/// Numbers of a command buffer's passes that cleared depth of several samples for later passes, by depth image.
#[derive(Default)]
pub struct Prepasses {
    counts: SmallVec<[(ImageKey, u32); 2]>,
}

impl Prepasses {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.counts.clear();
    }

    /// One more; returns its number, from 1.
    pub fn count(&mut self, depth: ImageKey) -> u32 {
        match self.counts.iter_mut().find(|(known, _)| *known == depth) {
            Some((_, count)) => {
                *count += 1;
                *count
            }
            None => {
                self.counts.push((depth, 1));
                1
            }
        }
    }

    /// The number of the last; 0 before the first.
    pub fn last(&self, depth: ImageKey) -> u32 {
        self.counts.iter().find(|(known, _)| *known == depth).map_or(0, |(_, count)| *count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prepasses_are_counted_by_their_depth() {
        let mut prepasses = Prepasses::default();
        let [a, b] = [ImageKey(1), ImageKey(2)];
        assert_eq!(prepasses.last(a), 0);
        assert_eq!([prepasses.count(a), prepasses.count(a), prepasses.count(b)], [1, 2, 1]);
        assert_eq!((prepasses.last(a), prepasses.last(b)), (2, 1));
        prepasses.clear();
        assert_eq!(prepasses.last(a), 0);
    }
}
