//! Reference of the kernel `compose`.

use crate::chroma::ChromaSettings;
use crate::geometry::Fov;
use crate::layout::uniform;
use glam::Vec3;

uniform! {
    /// Parameters of one region.
    pub struct ComposeParams {
        /// First pixel of the region.
        pub rect_offset: [u32; 2],
        /// Size of the region in pixels.
        pub rect_extent: [u32; 2],
    }
}

impl ComposeParams {
    /// Parameters of one region: a rectangle of an image that shows `fov`, seen with `gaze` (a direction in that
    /// eye's view space: +x right, +y up, -z forward). `clamp_to_unit` says that the image stores 0..=1 only.
    pub fn new(
        rect_offset: [u32; 2],
        rect_extent: [u32; 2],
        _fov: Fov,
        _gaze: Vec3,
        _settings: &ChromaSettings,
        _clamp_to_unit: bool,
    ) -> Self {
        Self { rect_offset, rect_extent }
    }
}
