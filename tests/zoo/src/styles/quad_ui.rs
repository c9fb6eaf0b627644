//! A quad layer with a board of text, beside the scene.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec, passes};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::truth::{Eyes, PassTruth};
use crate::xr::{COLOR, board_size};
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "quad-ui",
    says: "a quad layer with a user interface beside the scene",
    needs: Needs { openxr: OpenXr { quad: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    can_set_rates: true,
    passes: |size, _| {
        let mut passes = vec![PassTruth::new(board_size(size), COLOR, Eyes::None, "quad layer")];
        passes.extend(PassTruth::each_eye(size, COLOR, "scene"));
        passes
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let boards = passes(gpu, Kind::RenderPass, &app.quad, |color| PassSpec::color(color.overwritten()))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let board = PipelineSpec::new(shader!("post", "bare_vs"), shader!("fragments", "board_fs"), Depth::NONE);
    let board = gpu.pipeline(&board, app.scene.layout, &boards[0].target)?;
    Ok(Box::new(move |frame| {
        app.show_screen(frame, &boards[frame.quad], board, app.scene.set, &Draw::default());
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
