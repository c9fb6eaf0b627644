//! hello_xr, unmodified, under all validation that there is: nothing is found that is not found without us.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};

const FRAMES: u64 = 200;

#[test]
fn with_vulkan_enable() {
    check("Vulkan");
}

#[test]
fn with_vulkan_enable2() {
    check("Vulkan2");
}

/// Rates by contrast, re-use and chroma, and something drawn over all of it: by masks, or by rate attachments where there are.
const EVERYTHING: &str = "[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n[debug]\nview = \"eccentricity\"\n";

fn check(graphics: &str) {
    // Enabled without work, and enabled with the layer's own images and work on them in every frame.
    let chroma = "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\n";
    for (configs, has_rates) in [(&["", chroma, EVERYTHING][..], false), (&[EVERYTHING], true)] {
        let reference = run(graphics, None, has_rates);
        for config in configs {
            let with_us = run(graphics, Some(config), has_rates);
            let mut new = with_us.findings.beyond(&reference.findings);
            new.retain(|found| !found.is_of_stand_in());
            assert!(new.is_empty(), "{new:#?}");
            assert_eq!(with_us.exit_code, reference.exit_code);
            let errors = |outcome: &Outcome| outcome.record.errors.clone();
            assert_eq!(errors(&with_us), errors(&reference));
            if *config == EVERYTHING {
                is_at_work(&with_us, has_rates);
            }
        }
    }
}

/// Requested techniques are on, and rates are right by the checks of the layer that stands in for them.
fn is_at_work(outcome: &Outcome, has_rates: bool) {
    let lines = outcome.shading_rates().unwrap();
    let wrong: Vec<_> = lines.iter().filter(|line| matches!(line, ShadingRateLine::Finding(_))).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let is_coarse = |line: &ShadingRateLine| match line {
        ShadingRateLine::Pass(pass) => {
            pass.map.as_ref().is_some_and(|map| map.histogram.keys().any(|rate| rate != "1x1"))
        }
        ShadingRateLine::Finding(_) => false,
    };
    assert_eq!(lines.iter().any(is_coarse), has_rates, "{}", outcome.log);
    // It asks for Vulkan 1.0, which has all that masks need.
    assert_eq!(outcome.log.contains(": masked"), !has_rates, "{}", outcome.log);
}

fn run(graphics: &str, config: Option<&str>, has_rates: bool) -> Outcome {
    let application = Application::hello_xr(graphics).unwrap();
    let gaze = |t: u32| Gaze {
        t: f64::from(t) / 8.0,
        yaw_deg: [-18.0, 12.0, 3.0, 20.0, -6.0][t as usize % 5],
        pitch_deg: [4.0, -9.0, 14.0, 0.0, -12.0][t as usize % 5],
        tracked: t % 7 != 6,
    };
    let scenario = Scenario { gaze: (0..20).map(gaze).collect(), ..Scenario::new(FRAMES).sized(256, 256) };
    let run = Run::new(&application, &scenario).validated();
    let run = if has_rates { run.shading_rates(ShadingRateProfile::NvkTuring) } else { run };
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let were_active = outcome.findings.vulkan_was_active && outcome.findings.openxr_was_active;
    assert!(were_active, "a validation layer was not there\n{}", outcome.output);
    outcome
}
