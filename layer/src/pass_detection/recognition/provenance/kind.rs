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
        let Draws { quads, meshes, vertices, .. } = *draws;
        if quads + meshes == 0 {
            return Self::Other;
        }
        if shares_depth || (pass.facts.clears_depth && meshes > 0) {
            return Self::Camera;
        }
        let is_small = quads + meshes <= MOST_DRAWS && vertices <= MOST_VERTICES;
        let is_interface = writes_picture && quads > 0 && vertices <= MOST_INTERFACE_VERTICES;
        match meshes {
            0 => Self::Screen { reads_by_meshes: false },
            _ if is_small => Self::Screen { reads_by_meshes: true },
            _ if is_interface => Self::Screen { reads_by_meshes: false },
            _ => Self::Camera,
        }
    }
}
