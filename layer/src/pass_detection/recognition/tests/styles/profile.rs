//! Rules of the application's profile, and the list of passes.

use super::super::application::*;
use super::{BOTH_LAYERS, HALVES, array_shown};
use crate::pass_detection::*;
use ash::vk;

#[test]
fn the_profile_decides() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (image, shadow) = (app.image([64, 64], HDR), app.image([64, 64], vk::Format::D32_SFLOAT));
    app.recognition
        .set_rules("exclude 200x240; right R16G16B16A16_SFLOAT #2 upright; left #1".parse().unwrap());
    app.run(8, |app| {
        app.scene("other", image);
        app.scene("included", image);
        app.scene("excluded", app.current(&eyes[0]));
        let mut pass = whole([64, 64], &[]);
        pass.depth = Some(target(shadow));
        app.pass("shadow", pass);
        app.show(&app.both(&eyes));
    });
    app.expect("excluded", &Err(Unmatched::Excluded));
    app.expect("included", &one(How::Profile, Orientation::Upright, Eyes::Right));
    app.expect("other", &one(How::Profile, Orientation::Unknown, Eyes::Left));
    app.expect("shadow", &Err(Unmatched::NoColour));
}

#[test]
fn the_profile_knows_arrangements() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let wide = app.image([64, 48], HDR);
    let array = app.described(|key| ImageDescription { layers: 2, ..description(key, [48, 64], HDR) });
    app.recognition.set_rules("double-wide 64x48 flipped; array 48x64 upright".parse().unwrap());
    app.run(8, |app| {
        app.scene("wide", wide);
        app.pass("array", multiview(whole([48, 64], &[array])));
        app.show(&app.both(&eyes));
    });
    app.expect("wide", &matched(How::Profile, Orientation::UpsideDown, &HALVES));
    app.expect("array", &matched(How::Profile, Orientation::Upright, &BOTH_LAYERS));
}

#[test]
fn every_kind_of_pass_is_listed_once() {
    let mut app = Application::default();
    let chain = app.chain(EYE, 2);
    let (shadow, image) = (app.image([256, 256], vk::Format::D32_SFLOAT), app.image([64, 48], HDR));
    let mut lines = Vec::new();
    app.run(20, |app| {
        let mut pass = whole([256, 256], &[]);
        pass.depth = Some(target(shadow));
        app.pass("shadow", pass);
        app.full_screen("mirror", image);
        app.pass("scene", multiview(whole(EYE, &[app.current(&chain)])));
        app.show(&array_shown(app, &chain));
        app.recognition.log_new_verdicts(|_, line| lines.push((app.frame, line.to_string())));
    });
    let expected = [
        "pass 256x256 D32_SFLOAT: not the scene: no colour: a shadow map or a depth pre-pass",
        "pass 64x48 R16G16B16A16_SFLOAT: not the scene: its aspect ratio differs from that of the eye buffer",
        "pass 200x240 R8G8B8A8_SRGB, 2 layers: the scene: left eye and right eye: draws into the swapchain",
    ];
    assert_eq!(lines, expected.map(|line| (SETTLED, line.to_owned())));
}
