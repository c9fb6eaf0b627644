//! Both eyes in one pass: a swapchain with two layers, and multiview.

use crate::app::{App, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec, passes};
use crate::scene::MULTIVIEW;
use crate::style::{Arrangement, Style};
use crate::support::{Feature, Needs};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "multiview",
    says: "one multiview pass into an array swapchain",
    needs: NEEDS,
    arrangement: Arrangement::Array,
    can_set_rates: true,
    passes: |size, _| vec![PassTruth::new(size, COLOR, Eyes::Both, "scene").layers(2)],
    start,
    ..Style::PLAIN
};

/// Multiview.
pub const NEEDS: Needs = Needs { features: &[Feature::Multiview], ..Needs::NOTHING };

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size).layers(2))?;
    let passes = passes(app.gpu, Kind::RenderPass, &app.color[0], |color| {
        PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)).multiview()
    })?;
    let pipelines = app.scene.pipelines(app.gpu, &passes[0].target, &MULTIVIEW)?;
    Ok(Box::new(move |frame| {
        app.show(frame, &passes[frame.color[0]], &pipelines, 0);
        Ok(())
    }))
}
