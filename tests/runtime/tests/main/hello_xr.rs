//! Khronos' own sample application, unmodified, where it is installed.

use crate::case::{Output, check_validation, environment};
use libtest_mimic::{Failed, Trial};
use parafovea_mock_runtime::record::Layer;
use std::collections::BTreeSet;
use std::process::{Command, Stdio};

/// A trial for each Vulkan extension; ignored, visibly, without hello_xr.
pub fn trials() -> impl Iterator<Item = Trial> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let installed = std::env::split_paths(&path).any(|folder| folder.join("hello_xr").is_file());
    if !installed {
        eprintln!(
            "hello_xr is not installed (Debian: openxr-utils or libopenxr-utils): its tests are ignored"
        );
    }
    let trial = move |graphics: &'static str| {
        Trial::test(format!("hello_xr::{}", graphics.to_lowercase()), move || run(graphics))
            .with_ignored_flag(!installed)
    };
    ["Vulkan", "Vulkan2"].into_iter().map(trial)
}

fn run(graphics: &str) -> Result<(), Failed> {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "[session]\nframes=200\n[output]\nsave=['eye','submitted']\nsave_frames=[0,199]\n";
    // It quits at the end of its input: a pipe that stays open keeps it going until the session exits.
    let mut child = Command::new("hello_xr")
        .args(["-g", graphics])
        .envs(environment(folder.path(), scenario))
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let input = child.stdin.take();
    let status = child.wait().unwrap();
    drop(input);
    assert!(status.success(), "{status}");
    check_validation(folder.path())?;

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
    // The head rests, so that the eyes see what was submitted.
    assert!(output.picture("eye0_199.png").2 == output.picture("submitted_0_0_199.png").2);
    Ok(())
}
