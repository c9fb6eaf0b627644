//! Ground truth about a style's render passes, and a run's lines about them.

use ash::vk::Format;
use serde::{Deserialize, Serialize};

/// Eye buffers that a render pass draws.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Eyes {
    /// The left eye's.
    Left,
    /// The right eye's.
    Right,
    /// Both: beside each other, or one a layer.
    Both,
    /// None: a shadow map, a picture in the scene, a quad layer, a measurement.
    None,
}

impl Eyes {
    /// Of view 0 or 1.
    pub const fn of(view: usize) -> Self {
        if view == 0 { Eyes::Left } else { Eyes::Right }
    }
}

/// One render pass of a frame, as it is meant.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PassTruth {
    /// Width and height of its attachments, in texels.
    pub extent: [u32; 2],
    /// Width and height of its render area, which begins at 0, 0.
    pub area: [u32; 2],
    /// Width and height of its viewport, which begins at 0, 0.
    pub viewport: [u32; 2],
    /// Views of a multiview pass, else 1.
    pub layers: u32,
    /// Samples of its first colour attachment, or of depth where there is none.
    pub samples: u32,
    /// Format of its first colour attachment, or of depth where there is none.
    pub format: Format,
    /// Eye buffers that it draws.
    pub eyes: Eyes,
    /// Its purpose.
    pub why: &'static str,
}

impl PassTruth {
    /// A pass over the whole of single-sample attachments of one layer.
    pub const fn new(extent: [u32; 2], format: Format, eyes: Eyes, why: &'static str) -> Self {
        Self { extent, area: extent, viewport: extent, layers: 1, samples: 1, format, eyes, why }
    }

    /// The same for each eye, one after the other: left, right.
    pub fn each_eye(extent: [u32; 2], format: Format, why: &'static str) -> Vec<Self> {
        [Eyes::Left, Eyes::Right].map(|eyes| Self::new(extent, format, eyes, why)).to_vec()
    }

    /// The scene in two passes for each eye.
    pub fn halves(extent: [u32; 2], format: Format) -> Vec<Self> {
        let eye = |eyes| {
            [
                Self::new(extent, format, eyes, "scene, first half"),
                Self::new(extent, format, eyes, "scene, second half and sky"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    }

    /// With so many layers.
    pub const fn layers(self, layers: u32) -> Self {
        Self { layers, ..self }
    }

    /// With so many samples.
    pub const fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// Whether it is a full-screen pass that passes the picture on and shades nothing: it stays at 1x1.
    pub fn is_passed_on(&self) -> bool {
        PASSED_ON.contains(&self.why)
    }

    /// A run's expected line about it in this frame.
    pub fn seen(&self, frame: u64) -> PassSeen {
        PassSeen {
            frame,
            extent: self.extent,
            area: self.area,
            layers: self.layers,
            samples: self.samples,
            format: self.format.as_raw(),
        }
    }
}

/// The purposes of full-screen passes that shade nothing.
const PASSED_ON: [&str; 5] =
    ["tone mapping", "scaling", "bloom", "temporal anti-aliasing", "exposure and tone mapping"];

/// One render pass that a run began (`--passes`), with its parameters in Vulkan.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct PassSeen {
    /// Number of the frame, from 0.
    pub frame: u64,
    /// As [`PassTruth::extent`].
    pub extent: [u32; 2],
    /// As [`PassTruth::area`].
    pub area: [u32; 2],
    /// As [`PassTruth::layers`].
    pub layers: u32,
    /// As [`PassTruth::samples`].
    pub samples: u32,
    /// The number of [`PassTruth::format`].
    pub format: i32,
}
