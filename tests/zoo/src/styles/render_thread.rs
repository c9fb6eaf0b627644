//! One thread waits for frames, another renders and submits them.

use super::render_pass;
use crate::gpu::Kind;
use crate::style::{Style, Threads};
use crate::truth::PassTruth;
use crate::xr::COLOR;

pub const STYLE: Style = Style {
    name: "render-thread",
    says: "xrWaitFrame on a thread of its own, apart from the one that renders",
    threads: Threads::RenderThread,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start: |app| render_pass::start(app, Kind::RenderPass, |_| {}),
    ..Style::PLAIN
};
