//! What makes a style.

use crate::app::{App, Recorder};
use crate::support::Needs;
use crate::truth::PassTruth;
use anyhow::Result;

/// How the eyes' pictures lie in swapchains.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Arrangement {
    /// A swapchain for each eye.
    Separate,
    /// One swapchain with an array layer for each eye.
    Array,
    /// One swapchain, the eyes beside each other.
    DoubleWide,
}

/// Which threads call what.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Threads {
    /// One does everything.
    One,
    /// One waits for frames (xrWaitFrame), another renders and submits them.
    RenderThread,
}

/// A way to render the scene, and what is known about it.
pub struct Style {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in a line.
    pub says: &'static str,
    /// What it needs of the device and the runtime.
    pub needs: Needs,
    /// From which Vulkan headers (1.3.N) on validation knows what it does; 0: from any.
    pub headers: u32,
    /// Where the eyes' pictures are.
    pub arrangement: Arrangement,
    /// Which threads call what.
    pub threads: Threads,
    /// Whether the passes that draw the scene write the swapchain's images themselves, one fragment a pixel.
    pub direct: bool,
    /// Whether it can set shading rates itself (`--native-map`): all its passes that draw colour are made by
    /// [`Gpu::pass`](crate::gpu::Gpu::pass), and recorded in the order of their submits.
    pub can_set_rates: bool,
    /// What makes a pixel of the picture depend on pixels far from it, such as auto-exposure.
    pub global: Option<&'static str>,
    /// How far its pictures may be from those of `render-pass`: the mean difference over all pixels and colour
    /// channels, in code values (0 to 255). None: it shows the scene in another way.
    pub likeness: Option<f64>,
    /// Every render pass of a frame in the order of submission, for eyes of this size (width, height) and the frame
    /// of this number, from 0.
    pub passes: fn(size: [u32; 2], frame: u64) -> Vec<PassTruth>,
    /// Makes what it needs, and gives what records a frame.
    pub(crate) start: for<'a> fn(&'a App<'a>) -> Result<Recorder<'a>>,
}

impl Style {
    /// A plain one, which others are made from: what each has to say is in the fields.
    pub(crate) const PLAIN: Style = Style {
        name: "",
        says: "",
        needs: Needs::NOTHING,
        headers: 0,
        arrangement: Arrangement::Separate,
        threads: Threads::One,
        direct: true,
        can_set_rates: false,
        global: None,
        likeness: Some(0.0),
        passes: |_, _| Vec::new(),
        start: |_| Ok(Box::new(|_| Ok(()))),
    };
}
