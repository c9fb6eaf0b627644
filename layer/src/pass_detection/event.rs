//! Accesses of submitted command buffers to images, in submission order.

use super::{SwapchainKey, Unmasked};
use ash::vk;
use smallvec::SmallVec;

/// An image of the application. A key is never given twice, so it cannot be mistaken for an image that was destroyed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageKey(pub u64);

/// Properties of an image that recognition needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageDescription {
    /// Key of the image.
    pub key: ImageKey,
    /// Size of level 0, pixels.
    pub extent: [u32; 2],
    /// Array layers.
    pub layers: u32,
    /// Its format.
    pub format: vk::Format,
    /// Samples of a pixel: 1, 2, 4, ...
    pub samples: u32,
    /// Whether views may be cubes (`VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT`).
    pub is_cube: bool,
    /// Whether it is one of an XR swapchain's.
    pub swapchain: Option<SwapchainKey>,
}

/// One level and some layers of an image, as an attachment or one end of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Target {
    /// The image.
    pub image: ImageKey,
    /// Mip level.
    pub level: u32,
    /// First array layer.
    pub base_layer: u32,
    /// Number of array layers.
    pub layers: u32,
}

/// An action of a command buffer that matters for the origin of a picture.
#[allow(clippy::large_enum_variant, reason = "steady recording allocates nothing, so nothing is boxed")]
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A render pass or an instance of dynamic rendering, from its begin to its end.
    Pass(Pass),
    /// A copy, blit or resolve outside of render passes.
    Transfer(Transfer),
}

/// One render pass instance.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Colour attachments of all subpasses, each once, input attachments that are also written among them.
    pub colors: SmallVec<[Target; 8]>,
    /// Targets to which colour attachments are resolved at the end, in the order of `colors`.
    pub resolves: SmallVec<[Target; 4]>,
    /// Depth attachment, if any.
    pub depth: Option<Target>,
    /// The render area: x, y, width, height in pixels.
    pub area: [u32; 4],
    /// The part of the render area within the viewports of its draws; the render area if these are unknown.
    pub region: [u32; 4],
    /// Multiview's mask; 0 without.
    pub view_mask: u32,
    /// Facts that limit a backend.
    pub facts: PassFacts,
    /// Reason for recording it without a mask; `None` if it has one, or if the device masks nothing.
    pub unmasked: Option<Unmasked>,
    /// Its draws; `None` where they are not followed.
    pub draws: Option<Draws>,
}

impl Pass {
    /// The area of the picture that a pass over all of a picture draws: a part of the render area with the same aspect, as with dynamic
    /// resolution in a target of a fixed size; else the render area.
    pub fn picture_area(&self) -> [u32; 4] {
        let [width, height, whole_width, whole_height] =
            [self.region[2], self.region[3], self.area[2], self.area[3]].map(|side| side as f32);
        let scale = [width / whole_width, height / whole_height];
        let same_aspect = (scale[0] / scale[1] - 1.0).abs() * width.min(height) <= ROUNDING;
        let is_large = scale.iter().all(|scale| *scale >= LEAST_SCALE);
        if same_aspect && is_large { self.region } else { self.area }
    }
}

/// Greatest difference between equal aspects, pixels: sizes are often rounded to a multiple of 8.
const ROUNDING: f32 = 8.0;

/// Least scale of the picture in a target of a fixed size: upscalers render a third per axis in their fastest mode.
const LEAST_SCALE: f32 = 0.3;

/// The draws of a pass.
///
/// The reads of a draw come from its descriptor sets: colour targets, and storage images as large as a picture. Other images are left out, as
/// hardly any of them holds a picture of the scene.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Draws {
    /// Draws of one triangle or two, of one instance or one for each eye: at most [`Draws::QUAD_VERTICES`] vertices, known to the CPU.
    pub quads: u32,
    /// All other draws.
    pub meshes: u32,
    /// Vertices of all instances of all draws; saturates. Each draw that only the GPU knows counts [`Draws::INDIRECT_VERTICES`].
    pub vertices: u32,
    /// Images that quads may read.
    pub read_by_quads: Reads,
    /// Images that other draws may read.
    pub read_by_meshes: Reads,
}

impl Draws {
    /// Most vertices of a quad: two triangles.
    pub const QUAD_VERTICES: u32 = 6;

    /// Vertices that an indirect draw counts for: more than a full-screen pass has.
    pub const INDIRECT_VERTICES: u32 = 1 << 16;

    /// Adds the draws of a secondary command buffer, or of the next subpass.
    pub fn add(&mut self, more: &Self) {
        self.quads = self.quads.saturating_add(more.quads);
        self.meshes = self.meshes.saturating_add(more.meshes);
        self.vertices = self.vertices.saturating_add(more.vertices);
        self.read_by_quads.add(&more.read_by_quads);
        self.read_by_meshes.add(&more.read_by_meshes);
    }
}

/// Images that shaders may read.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Reads {
    /// Each once.
    pub images: SmallVec<[ImageKey; Reads::MOST]>,
    /// Whether more may be read than is known: descriptor buffers, arrays without end, or more than [`Reads::MOST`].
    pub may_read_more: bool,
}

impl Reads {
    /// Most images that are listed one by one.
    pub const MOST: usize = 8;

    /// Adds an image.
    pub fn push(&mut self, image: ImageKey) {
        if self.images.contains(&image) {
            return;
        }
        match self.images.len() < Self::MOST {
            true => self.images.push(image),
            false => self.may_read_more = true,
        }
    }

    /// Adds all of `more`.
    pub fn add(&mut self, more: &Self) {
        self.may_read_more |= more.may_read_more;
        more.images.iter().for_each(|image| self.push(*image));
    }
}

/// Facts of a pass that limit a backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct PassFacts {
    /// Depth is cleared at the begin (`loadOp` CLEAR).
    pub clears_depth: bool,
    /// The first colour attachment is loaded at the begin.
    pub loads_color: bool,
    /// Depth is stored at the end, or stays as it is (`storeOp` NONE).
    pub stores_depth: bool,
    /// Depth or stencil is resolved at the end.
    pub resolves_depth: bool,
    /// Stencil is loaded at the begin.
    pub loads_stencil: bool,
    /// vkCmdClearAttachments clears depth in it.
    pub clears_depth_later: bool,
    /// An occlusion query or conditional rendering is active in it.
    pub is_queried: bool,
    /// It has a shading-rate attachment of the application's own.
    pub has_own_rates: bool,
    /// Part of suspended and resumed rendering.
    pub is_suspended: bool,
    /// It has a mask that may leave tiles out, but no fill of coarse tiles follows it.
    pub is_unfilled: bool,
}

/// A copy, blit or resolve.
#[derive(Clone, Copy, Debug, PartialEq, Hash)]
pub struct Transfer {
    /// Copy, blit or resolve.
    pub kind: TransferKind,
    /// Read.
    pub from: Target,
    /// The read rectangle: x, y, width, height in pixels; a negative extent is mirrored (blits only).
    pub from_rect: [i32; 4],
    /// Written.
    pub to: Target,
    /// The written rectangle, as `from_rect`.
    pub to_rect: [i32; 4],
}

/// Kinds of transfers between images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TransferKind {
    /// vkCmdCopyImage.
    Copy,
    /// vkCmdBlitImage.
    Blit,
    /// vkCmdResolveImage.
    Resolve,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_in_regions_of_the_same_aspect() {
        let of = |region: [u32; 4]| {
            let pass = Pass {
                colors: SmallVec::new(),
                resolves: SmallVec::new(),
                depth: None,
                area: [0, 0, 1000, 1100],
                region,
                view_mask: 0,
                facts: PassFacts::default(),
                unmasked: None,
                draws: None,
            };
            pass.picture_area()
        };
        for scaled in [
            [0, 0, 1000, 1100],
            [0, 0, 800, 880],
            [200, 220, 800, 880],
            [0, 0, 504, 552],
            [0, 0, 496, 544],
            [0, 0, 328, 360],
        ] {
            assert_eq!(of(scaled), scaled);
        }
        // An interface, an inset, one of two eyes, a thumbnail, nothing.
        for other in [[0, 0, 1000, 550], [100, 100, 500, 900], [0, 0, 500, 1100], [0, 0, 100, 110], [0; 4]] {
            assert_eq!(of(other), [0, 0, 1000, 1100], "{other:?}");
        }
    }
}
