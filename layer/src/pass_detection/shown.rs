//! The submission of the application at xrEndFrame.

use super::ImageKey;
use smallvec::SmallVec;

/// An XR swapchain: its handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SwapchainKey(pub u64);

/// One of the two views of stereo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Eye {
    /// View 0 of primary stereo.
    Left,
    /// View 1 of primary stereo.
    Right,
}

/// The submission of one frame.
#[derive(Clone, Debug, PartialEq, Hash, Default)]
pub struct Shown {
    /// The views of projection layers, of all such layers.
    pub views: SmallVec<[ShownView; 4]>,
    /// Swapchains that are shown otherwise: quads, cylinders, cubes, ...
    pub flat: SmallVec<[SwapchainKey; 4]>,
    /// Swapchains submitted as depth (XR_KHR_composition_layer_depth).
    pub depth: SmallVec<[SwapchainKey; 4]>,
}

/// One view of a projection layer.
#[derive(Clone, Copy, Debug, PartialEq, Hash)]
pub struct ShownView {
    /// Eye of the view; `None` for the insets of quad views, which stay at 1x1.
    pub eye: Option<Eye>,
    /// The swapchain.
    pub swapchain: SwapchainKey,
    /// The image of it that was released last, where that is known.
    pub image: Option<ImageKey>,
    /// `imageArrayIndex`.
    pub layer: u32,
    /// `imageRect`: x, y, width, height; an extent can be negative nowhere.
    pub rect: [u32; 4],
    /// Whether `fov` is upside-down (angleUp < angleDown), as some applications mirror their pictures.
    pub is_upside_down: bool,
}
