//! Description of a style.

use crate::app::{App, Recorder};
use crate::support::Needs;
use crate::truth::PassTruth;
use anyhow::Result;

/// Arrangement of the eye buffers in swapchains.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Arrangement {
    /// A swapchain for each eye.
    Separate,
    /// One swapchain with an array layer for each eye.
    Array,
    /// One swapchain, the eyes beside each other.
    DoubleWide,
}

/// Threads of calls.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Threads {
    /// One does everything.
    One,
    /// One waits for frames (xrWaitFrame), another renders and submits them.
    RenderThread,
}

/// A way to render the scene, with its properties.
pub struct Style {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its description, in a line.
    pub says: &'static str,
    /// Its requirements on the device and the runtime.
    pub needs: Needs,
    /// First Vulkan headers (1.3.N) whose validation knows its features; 0: any.
    pub headers: u32,
    /// Arrangement of the eye buffers in swapchains.
    pub arrangement: Arrangement,
    /// Threads of its calls.
    pub threads: Threads,
    /// Whether the passes that draw the scene write the swapchain's images themselves, one fragment a pixel.
    pub direct: bool,
    /// Whether it can set shading rates itself (`--native-map`): all its passes that draw colour are made by
    /// [`Gpu::pass`](crate::gpu::Gpu::pass), and recorded in the order of their submits.
    pub can_set_rates: bool,
    /// Whether its shaders can show how coarse shading looks (`--look`).
    pub can_show_look: bool,
    /// Reason for which a pixel of the image depends on pixels far from it, such as auto-exposure.
    pub global: Option<&'static str>,
    /// Use of earlier frames' images in its own.
    pub history: History,
    /// Allowed difference of its images from `render-pass`'s: the mean over all pixels and colour channels, in code
    /// values (0 to 255). None: it shows the scene in another way.
    pub likeness: Option<f64>,
    /// Every render pass of a frame in the order of submission, for eyes of this size (width, height) and the frame
    /// of this number, from 0.
    pub passes: fn(size: [u32; 2], frame: u64) -> Vec<PassTruth>,
    /// Makes its resources, and returns the recorder of a frame.
    pub(crate) start: for<'a> fn(&'a App<'a>) -> Result<Recorder<'a>>,
}

/// Use of earlier frames' images, as known from the commands of the application.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    /// None: full-screen passes read images of their own frame.
    None,
    /// Unknown: compute makes the image, and may read any others.
    Unknown,
    /// Its images are blended with images of earlier frames.
    Blended,
}

impl Style {
    /// A plain style, which others are made from: each sets its own fields.
    pub(crate) const PLAIN: Style = Style {
        name: "",
        says: "",
        needs: Needs::NOTHING,
        headers: 0,
        arrangement: Arrangement::Separate,
        threads: Threads::One,
        direct: true,
        can_set_rates: false,
        can_show_look: false,
        global: None,
        history: History::None,
        likeness: Some(0.0),
        passes: |_, _| Vec::new(),
        start: |_| Ok(Box::new(|_| Ok(()))),
    };
}
