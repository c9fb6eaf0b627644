//! The ways of drawing, each as a common kind of Direct3D 11 game does it.

use crate::d3d11::Format;
use clap::ValueEnum;

/// A way of drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Look {
    /// Straight into the swapchain's texture, with depth
    Forward,
    /// Into a target in high dynamic range, then tone mapped into the swapchain
    ToneMapped,
    /// The same with 4 samples, resolved before tone mapping
    Multisampled,
    /// Both eyes at once, as instances in the layers of an array
    Instanced,
    /// Both eyes beside each other in one texture
    DoubleWide,
    /// As tone-mapped, with the scene recorded on a deferred context
    DeferredContext,
    /// In an off-screen texture, copied into the swapchain
    Copied,
}

/// Its properties.
pub struct Properties {
    /// Format of the scene's target; `None`: the swapchain itself.
    pub target: Option<Format>,
    /// Format of its depth buffer.
    pub depth: Format,
    /// Samples of a pixel.
    pub samples: u32,
    /// Layers of a swapchain.
    pub layers: u32,
    /// Swapchains.
    pub swapchains: u32,
}

impl Look {
    /// Its properties.
    pub fn properties(self) -> Properties {
        let hdr = Some(Format::R11G11B10Float);
        let plain = Properties { target: None, depth: Format::Depth32, samples: 1, layers: 1, swapchains: 2 };
        match self {
            Self::Forward => plain,
            Self::ToneMapped => Properties { target: hdr, depth: Format::Depth24Stencil8, ..plain },
            Self::Multisampled => Properties { target: Some(Format::Rgba16Float), samples: 4, ..plain },
            Self::Instanced => Properties { layers: 2, swapchains: 1, ..plain },
            Self::DoubleWide => Properties { swapchains: 1, ..plain },
            Self::DeferredContext => Properties { target: hdr, ..plain },
            Self::Copied => Properties { target: Some(Format::Rgba8Srgb), ..plain },
        }
    }
}
