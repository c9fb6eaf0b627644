//! Khronos' own sample application, unmodified, where it is installed.

use crate::case::{LIMIT, Output, check_validation_beyond, environment};
use libtest_mimic::{Completion, Failed, Trial};
use parafovea_mock_runtime::record::Layer;
use parafovea_trial::{Lack, watch_with_open_input};
use std::collections::BTreeSet;
use std::process::Command;

/// A trial for each Vulkan extension; ignored without hello_xr.
pub fn trials() -> impl Iterator<Item = Trial> {
    ["Vulkan", "Vulkan2"].into_iter().map(|graphics| {
        Trial::ignorable_test(format!("hello_xr::{}", graphics.to_lowercase()), move || run(graphics))
    })
}

fn run(graphics: &str) -> Result<Completion, Failed> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    if !std::env::split_paths(&path).any(|folder| folder.join("hello_xr").is_file()) {
        return Ok(Completion::ignored_with(Lack::setup("hello_xr")));
    }
    let folder = tempfile::tempdir().unwrap();
    let scenario = "[session]\nframes=200\n[output]\nsave=['eye','submitted']\nsave_frames=[0,199]\n";
    let mut command = Command::new("hello_xr");
    command.args(["-g", graphics]).envs(environment(folder.path(), scenario));
    let ended = watch_with_open_input(&mut command, LIMIT)?;
    assert!(ended.status.is_some_and(|status| status.success()), "{ended:?}");
    // It waits a second for its command buffer, and records into it all the same: drivers that compile on a busy machine take longer.
    let is_late = ended.output.contains("Expecting state CmdBufferState");
    check_validation_beyond(folder.path(), is_late.then_some("-commandBuffer-recording"))?;

    let output = Output::read(folder.path());
    assert_eq!(output.errors(), Vec::<&parafovea_mock_runtime::record::Error>::new());
    let frames = output.frames();
    assert_eq!(frames.len(), 200);
    for frame in &frames {
        let [Layer::Projection { views, .. }] = frame.layers.as_slice() else { panic!("{frame:?}") };
        let rects: Vec<_> = views.iter().map(|view| view.image.rect).collect();
        assert_eq!(rects, [[0, 0, 1024, 1024]; 2]);
    }
    for name in ["eye0_0.png", "eye1_199.png", "submitted_0_0_199.png"] {
        let (_, _, pixels) = output.picture(name);
        let colours: BTreeSet<_> = pixels.chunks_exact(4).collect();
        assert!(colours.len() >= 5, "{name} shows a background and cubes, not {} colours", colours.len());
    }
    // The head rests, so that the eyes see the submitted images.
    assert!(output.picture("eye0_199.png").2 == output.picture("submitted_0_0_199.png").2);
    Ok(Completion::Completed)
}
