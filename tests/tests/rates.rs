//! Rate attachments, on devices that look as if they had them: the applications' objects and commands are valid for the extension, and as
//! long as every rate is 1x1 images are the same as without the layer.

use parafovea_test_layers::{
    SHADING_RATE_GPU_VARIABLE, ShadingRateFinding, ShadingRateLine, ShadingRatePass, ShadingRateProfile,
};
use parafovea_tests::run::{Application, Message, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 12;
const LAST: u64 = FRAMES - 1;
const COPY_OF_MAP: &str = "vkCmdCopyImageToBuffer: For optimal performance";
/// Rates are asked for, and dropped by the gate: the device is armed, and all is at 1x1.
const DROPPED: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"off\"\n";

fn finish(run: Run) -> Outcome {
    let outcome = run.validated().finish().unwrap().expect_frames(FRAMES).unwrap();
    assert!(outcome.findings.vulkan_was_active, "validation was not there\n{}", outcome.output);
    outcome
}

fn lines(outcome: &Outcome) -> (Vec<ShadingRateFinding>, Vec<ShadingRatePass>) {
    let (mut findings, mut passes) = (Vec::new(), Vec::new());
    for line in outcome.shading_rates().unwrap() {
        match line {
            ShadingRateLine::Finding(finding) => findings.push(finding),
            ShadingRateLine::Pass(pass) => passes.push(pass),
        }
    }
    (findings, passes)
}

/// The pass has a map that is 1x1 all over, as large as it must be, and its draws obey it.
fn check_pass(pass: &ShadingRatePass, profile: ShadingRateProfile) {
    let map = pass.map.as_ref().unwrap();
    assert_eq!(pass.texel, [profile.texel(); 2], "{pass:#?}");
    assert_eq!(map.histogram.keys().collect::<Vec<_>>(), ["1x1"], "{pass:#?}");
    assert_eq!(pass.draws_obeying, pass.draws, "{pass:#?}");
}

fn check(application: &Application) {
    let run = Run::new(application, &Scenario::new(FRAMES).sized(128, 128).saving(&[LAST]));
    let reference = finish(run.clone());
    for profile in ShadingRateProfile::ALL {
        let over = finish(run.clone().shading_rates(profile).on(DROPPED));
        assert!(over.log.contains("rate attachments: RateCapabilities"), "{}", over.log);
        // The test layer copies each map before its pass, and leaves it in a layout for everything.
        let is_copy_of_map = |found: &Message| found.text.contains(COPY_OF_MAP);
        let mut new = over.findings.beyond(&reference.findings);
        new.retain(|found| !is_copy_of_map(found));
        assert!(new.is_empty(), "{}: {new:#?}", profile.name());
        let (findings, passes) = lines(&over);
        assert_eq!(findings, [], "{}", profile.name());
        // Every frame draws both eyes, together or apart.
        assert!(passes.len() as u64 >= FRAMES, "{}: {} passes", profile.name(), passes.len());
        assert!(passes.iter().map(|pass| pass.draws).sum::<u32>() > 0, "{}", profile.name());
        for pass in &passes {
            check_pass(pass, profile);
        }
        for view in 0..2 {
            let picture = |outcome: &Outcome| outcome.submitted(view, LAST).unwrap();
            assert!(picture(&over) == picture(&reference), "{}: view {view} differs", profile.name());
        }
    }
}

#[test]
fn hello_xr_with_vulkan_enable() {
    check(&Application::hello_xr("Vulkan").unwrap());
}

#[test]
fn hello_xr_with_vulkan_enable2() {
    check(&Application::hello_xr("Vulkan2").unwrap());
}

#[test]
fn our_scene() {
    check(&Application::ours("parafovea-scene", &[]).unwrap());
}

/// On a device that claims to be a GPU, the gate measures by timestamps around command buffers, of several queues too: fewer passes are
/// coarse than with rates that are always on, because the gate's first trial turns them off. Without any timestamps it would leave them on.
#[test]
fn the_gate_hears_what_passes_take_on_a_gpu() {
    // Half a second in which rates become coarse, 32 that count, and some of the trial.
    const FRAMES: u64 = 120;
    for style in ["render-pass", "dynamic-rendering", "multiview", "secondaries", "async-compute"] {
        let frames = FRAMES.to_string();
        let arguments = ["--style", style, "--size", "64", "--frames", &frames];
        let application = Application::ours("parafovea-zoo", &arguments).unwrap();
        let run = Run::new(&application, &Scenario::new(FRAMES).sized(64, 64)).validated();
        let run = run.shading_rates(ShadingRateProfile::NvkTuring).env(SHADING_RATE_GPU_VARIABLE, "1");
        let coarse = |gate: &str| {
            let config = format!("[gaze]\nsource = \"centre\"\n[rates]\ngate = \"{gate}\"\n");
            let outcome = run.clone().on(&config).finish().unwrap().expect_frames(FRAMES).unwrap();
            let found = outcome.findings.vulkan.iter();
            let found: Vec<_> = found.filter(|found| !found.text.contains(COPY_OF_MAP)).collect();
            assert!(found.is_empty(), "{style}: {found:#?}");
            let (findings, passes) = lines(&outcome);
            assert_eq!(findings, [], "{style}");
            let is_coarse = |pass: &&ShadingRatePass| {
                pass.map.as_ref().is_some_and(|map| map.histogram.keys().any(|rate| rate != "1x1"))
            };
            passes.iter().filter(is_coarse).count()
        };
        let [always, judged] = ["on", "auto"].map(coarse);
        // Eight frames of the trial or more, of 120.
        assert!(judged > 0 && judged + always / 20 < always, "{style}: {judged} instead of {always}");
    }
}
