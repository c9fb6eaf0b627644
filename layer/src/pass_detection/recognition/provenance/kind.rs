//! Passes that draw many things, and passes that draw one thing over all of their target.

use crate::pass_detection::{Draws, Pass};

/// The kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Draws many things, with depth or into nothing but colours.
    Camera,
    /// Draws over its target, from images that it reads.
    Screen {
        /// Whether its meshes count: a visible-area mesh in place of a triangle.
        reads_by_meshes: bool,
    },
    Transfer,
    /// Draws nothing.
    Other,
}

/// Most draws of a full-screen pass: one for each eye, with a visible-area mesh and a border.
const MOST_DRAWS: u32 = 4;

/// Most vertices of a full-screen pass. Visible-area meshes have some hundred (XR_KHR_visibility_mask; SteamVR's have up to 400).
const MOST_VERTICES: u32 = 2048;

/// Most vertices of an interface that is drawn over the picture in the pass that maps tones.
const MOST_INTERFACE_VERTICES: u32 = 1 << 14;

impl Kind {
    /// `shares_depth`: it goes on with the depth of a camera.
    pub(super) fn new(pass: &Pass, shares_depth: bool, writes_picture: bool) -> Self {
        let Some(draws) = &pass.draws else {
            let is_camera = pass.depth.is_some();
            return if is_camera { Self::Camera } else { Self::Screen { reads_by_meshes: false } };
        };
        let DrawsClass { has_quads, has_meshes, is_small, is_interface } = DrawsClass::new(draws);
        match () {
            () if !has_quads && !has_meshes => Self::Other,
            () if shares_depth || (pass.facts.clears_depth && has_meshes) => Self::Camera,
            () if !has_meshes => Self::Screen { reads_by_meshes: false },
            () if is_small => Self::Screen { reads_by_meshes: true },
            () if writes_picture && is_interface => Self::Screen { reads_by_meshes: false },
            () => Self::Camera,
        }
    }
}

/// The facts about a pass's draws that its kind depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in super::super) struct DrawsClass {
    has_quads: bool,
    has_meshes: bool,
    /// Whether their number and size allow a full-screen pass.
    is_small: bool,
    /// Whether their size allows a picture and an interface over it.
    is_interface: bool,
}

impl DrawsClass {
    /// The class of some draws.
    pub(in super::super) fn new(draws: &Draws) -> Self {
        let Draws { quads, meshes, vertices, .. } = *draws;
        Self {
            has_quads: quads > 0,
            has_meshes: meshes > 0,
            is_small: quads.saturating_add(meshes) <= MOST_DRAWS && vertices <= MOST_VERTICES,
            is_interface: quads > 0 && vertices <= MOST_INTERFACE_VERTICES,
        }
    }

    /// The part of it that the kind of `pass` depends on.
    pub(in super::super) fn within(self, pass: &Pass) -> Self {
        match pass.facts.clears_depth && self.has_meshes {
            true => Self { has_quads: false, has_meshes: true, is_small: false, is_interface: false },
            false => self,
        }
    }
}
