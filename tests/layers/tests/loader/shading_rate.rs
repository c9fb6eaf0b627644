//! `shading_rate` has nothing to say to a program that uses the extension rightly, nor has validation below it,
//! and it finds each thing that is broken, by its rule.

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

/// Every form on every device: no findings, no messages, and the maps are those that the program wrote.
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
            assert_eq!((pass.draws, pass.draws_obeying), (1, 1), "{what}");
            assert_eq!(map.extent, [100u32.div_ceil(texel), 60u32.div_ceil(texel), layers], "{what}");
            assert_eq!(map.texels.as_deref(), Some(&*ended.result), "{what}");
            let kinds = if profile == ShadingRateProfile::Rdna { 4 } else { 7 };
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
    dynamic_rendering_is_right: "dynamic";
    dynamic_rendering_with_multiview_is_right: "dynamic multiview";
    a_rate_set_by_a_command_is_right: "dynamic dynamic_state";
    pipeline_libraries_are_right: "dynamic libraries";
    the_second_kind_of_flags_is_right: "dynamic flags2";
    a_secondary_command_buffer_is_right: "dynamic secondary";
}
