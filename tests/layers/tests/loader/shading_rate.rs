//! `shading_rate` and validation below it report nothing for a program that uses the extension correctly;
//! `shading_rate` finds each broken rule.

mod broken;

use crate::process::{Ended, Process};
use crate::programs::rates::{BROKEN_VARIABLE, FORM_VARIABLE};
use parafovea_test_layers::{
    SHADING_RATE_FILE_VARIABLE, SHADING_RATE_PROFILE_VARIABLE, ShadingRateFinding, ShadingRateLine,
    ShadingRatePass, ShadingRateProfile, TestLayer,
};

/// The program in a form, with one thing broken, or nothing.
fn program(profile: ShadingRateProfile, form: &str, broken: &str) -> Process {
    let process = Process::new("rates::rates").layer(TestLayer::ShadingRate.name());
    process
        .file(SHADING_RATE_FILE_VARIABLE, "rates.json")
        .env(SHADING_RATE_PROFILE_VARIABLE, profile.name())
        .env(FORM_VARIABLE, form)
        .env(BROKEN_VARIABLE, broken)
}

fn lines(ended: &Ended) -> (Vec<ShadingRateFinding>, Vec<ShadingRatePass>) {
    let (mut findings, mut passes) = (Vec::new(), Vec::new());
    for line in ended.read_if_there("rates.json").lines() {
        match serde_json::from_str(line).unwrap() {
            ShadingRateLine::Finding(finding) => findings.push(finding),
            ShadingRateLine::Pass(pass) => passes.push(pass),
        }
    }
    (findings, passes)
}

/// Every form on every device: no findings, no messages, and the maps equal the program's.
fn is_right(form: &str) {
    for profile in ShadingRateProfile::ALL {
        let ended = program(profile, form, "").validated().run();
        let (findings, passes) = lines(&ended);
        let what = format!("{form} on {}", profile.name());
        assert_eq!(findings, [], "{what}");
        assert_eq!(ended.findings, [""; 0], "{what}");
        assert_eq!(passes.len(), 2, "{what}");
        let texel = profile.texel();
        for (index, pass) in passes.iter().enumerate() {
            let map = pass.map.as_ref().unwrap();
            let layers = if form.contains("multiview") && profile.layered() { 2 } else { 1 };
            assert_eq!(pass.index, index as u64, "{what}");
            assert_eq!(pass.area, [0, 0, 100, 60], "{what}");
            assert_eq!(pass.texel, [texel; 2], "{what}");
            assert_eq!(pass.view_mask, if form.contains("multiview") { 3 } else { 0 }, "{what}");
            assert_eq!(pass.formats, ["R8G8B8A8_UNORM"], "{what}");
            assert_eq!(pass.targets.len(), 1, "{what}");
            assert_ne!(pass.targets[0], pass.image, "{what}");
            assert_eq!((pass.draws, pass.draws_obeying), (1, 1), "{what}");
            assert_eq!(map.extent, [100u32.div_ceil(texel), 60u32.div_ceil(texel), layers], "{what}");
            assert_eq!(map.texels.as_deref(), Some(&*ended.result), "{what}");
            let kinds = if form.contains("compute") { 2 } else { profile.device().rates.len() };
            assert_eq!(map.histogram.len(), kinds, "{what}");
            assert_eq!(map.histogram.values().sum::<u32>(), map.extent.iter().product::<u32>(), "{what}");
        }
    }
}

macro_rules! right {
    ($($name:ident: $form:literal;)*) => {
        $(#[test]
        fn $name() {
            is_right($form);
        })*
    };
}

right! {
    a_render_pass_is_right: "framebuffer";
    an_imageless_framebuffer_is_right: "framebuffer imageless";
    a_render_pass_with_multiview_is_right: "framebuffer multiview";
    a_transition_by_the_render_pass_is_right: "framebuffer transition";
    a_secondary_command_buffer_in_a_render_pass_is_right: "framebuffer secondary";
    two_passes_in_a_command_buffer_are_right: "framebuffer in_one";
    a_map_of_a_dispatch_is_right: "framebuffer multiview compute";
    a_map_that_stays_in_general_is_right: "dynamic compute general in_one";
    dynamic_rendering_is_right: "dynamic";
    dynamic_rendering_with_multiview_is_right: "dynamic multiview";
    a_rate_set_by_a_command_is_right: "dynamic dynamic_state";
    pipeline_libraries_are_right: "dynamic libraries";
    the_second_kind_of_flags_is_right: "dynamic flags2";
    a_secondary_command_buffer_is_right: "dynamic secondary";
    a_pass_that_is_suspended_and_resumed_is_right: "dynamic suspended";
}

/// A command buffer that is recorded once reads another map in each submit.
#[test]
fn each_submit_of_a_command_buffer_has_its_own_map() {
    let ended = program(ShadingRateProfile::NvkTuring, "framebuffer resubmitted", "").validated().run();
    let (findings, passes) = lines(&ended);
    assert_eq!(findings, []);
    assert_eq!(ended.findings, [""; 0]);
    let texels = |index: usize| passes[index].map.as_ref().unwrap().texels.as_deref().unwrap();
    assert_eq!(texels(1), ended.result);
    assert_ne!(texels(0), texels(1));
}

/// At the end of a process, layers below may have ended, so that no map can be waited for.
#[test]
fn the_last_pass_of_a_device_that_is_left_has_no_map() {
    let ended = program(ShadingRateProfile::NvkTuring, "framebuffer left", "").validated().run();
    let (findings, passes) = lines(&ended);
    assert_eq!(findings, []);
    assert_eq!(ended.findings, [""; 0]);
    assert_eq!(passes.len(), 2);
    assert!(passes[1].map.is_none());
}

/// A barrier that is missing around a dispatch, or around the read, shows in validation below, at the layer's copy.
#[test]
fn validation_below_sees_missing_barriers() {
    for (form, broken, hazard) in [
        ("dynamic compute general in_one", "no barrier", "SYNC-HAZARD-READ-AFTER-WRITE"),
        ("framebuffer transition", "no dependency", "SYNC-HAZARD-WRITE-AFTER-WRITE"),
        ("framebuffer in_one", "read not waited for", "SYNC-HAZARD-WRITE-AFTER-READ"),
        ("dynamic in_one", "read not waited for", "SYNC-HAZARD-WRITE-AFTER-READ"),
    ] {
        let ended = program(ShadingRateProfile::NvkTuring, form, broken).validated().run();
        let found = ended.findings.iter().any(|line| line.contains(hazard));
        assert!(found, "{form}, {broken}: {:?}", ended.findings);
    }
}
