//! The scene is drawn off-screen, and a pass or a resolve makes the eye buffers of it.

use super::super::application::*;
use super::{BOTH_LAYERS, HALVES, WIDE, array_shown, wide_shown};
use crate::pass_detection::*;
use ash::vk;

#[test]
fn off_screen_then_tone_mapped() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let images = [app.image(EYE, HDR), app.image(EYE, HDR)];
    app.run(8, |app| {
        for (image, chain) in images.into_iter().zip(&eyes) {
            app.scene("scene", image);
            app.full_screen("tone-map", app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    // Nothing proves which image became which eye.
    app.expect("scene", &looks(Eyes::Finer));
}

#[test]
fn off_screen_multiview_then_tone_mapped() {
    let mut app = Application::default();
    let chain = app.chain(EYE, 2);
    let image = app.described(|key| ImageDescription { layers: 2, ..description(key, EYE, HDR) });
    app.run(8, |app| {
        let mut pass = multiview(whole(EYE, &[image]));
        app.add_depth(&mut pass);
        app.pass("scene", pass);
        app.pass("tone-map", multiview(whole(EYE, &[app.current(&chain)])));
        app.show(&array_shown(app, &chain));
    });
    app.expect("scene", &matched(How::Shape, Orientation::Unknown, &BOTH_LAYERS));
    app.expect("tone-map", &matched(How::Swapchain, Orientation::Upright, &BOTH_LAYERS));
}

#[test]
fn off_screen_beside_each_other_then_tone_mapped() {
    let mut app = Application::default();
    let chain = app.chain(WIDE, 1);
    let image = app.image(WIDE, HDR);
    app.run(8, |app| {
        app.scene("scene", image);
        app.full_screen("tone-map", app.current(&chain));
        app.show(&wide_shown(app, &chain));
    });
    app.expect("scene", &matched(How::Shape, Orientation::Unknown, &HALVES));
}

#[test]
fn multisampled_and_resolved_at_the_end() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let images =
        [(); 2].map(|()| app.described(|key| ImageDescription { samples: 4, ..description(key, EYE, LDR) }));
    app.run(8, |app| {
        for ((image, chain), name) in images.into_iter().zip(&eyes).zip(["left", "right"]) {
            let mut pass = whole(EYE, &[image]);
            pass.resolves.push(target(app.current(chain)));
            app.add_depth(&mut pass);
            app.pass(name, pass);
        }
        app.show(&app.both(&eyes));
    });
    app.expect("left", &straight(Eyes::Left));
    app.expect("right", &straight(Eyes::Right));
}

#[test]
fn multisampled_and_resolved_afterwards() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.described(|key| ImageDescription { samples: 4, ..description(key, EYE, LDR) });
    app.run(8, |app| {
        app.scene("scene", image);
        let to = app.current(&eyes[1]);
        app.transfer(TransferKind::Resolve, (image, rect_of(EYE)), (to, rect_of(EYE)));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Right));
}

/// One image for both eyes, one after the other.
#[test]
fn one_image_serves_both_eyes() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    app.run(8, |app| {
        for chain in &eyes {
            app.scene("scene", image);
            app.copy(image, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    // Of the last copy first; where both cover a pixel, the finer holds.
    let both = [(Eyes::Right, 0, WHOLE), (Eyes::Left, 0, WHOLE)];
    app.expect("scene", &matched(How::Transferred, Orientation::Upright, &both));
}

/// G-buffer and lighting as two subpasses, in one framebuffer, multiview.
#[test]
fn subpasses() {
    let mut app = Application::default();
    let chain = app.chain(EYE, 2);
    let albedo = app.described(|key| ImageDescription { layers: 2, ..description(key, EYE, LDR) });
    app.run(8, |app| {
        let mut pass = multiview(whole(EYE, &[albedo, app.current(&chain)]));
        app.add_depth(&mut pass);
        app.pass("scene", pass);
        app.show(&array_shown(app, &chain));
    });
    app.expect("scene", &matched(How::Swapchain, Orientation::Upright, &BOTH_LAYERS));
}

#[test]
fn depth_pre_pass() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let depths = [(); 2].map(|()| app.image(EYE, vk::Format::D32_SFLOAT));
    app.run(8, |app| {
        for (depth, chain) in depths.into_iter().zip(&eyes) {
            let mut first = whole(EYE, &[]);
            first.depth = Some(target(depth));
            first.facts.clears_depth = true;
            let scene = app.recognition.depth_of(&first).map(|scene| scene.parts[0].eyes);
            let eye = if chain.key == eyes[0].key { Eyes::Left } else { Eyes::Right };
            assert_eq!(scene, (app.frame > 1).then_some(eye));
            app.pass("pre-pass", first);
            let mut pass = whole(EYE, &[app.current(chain)]);
            pass.depth = Some(target(depth));
            app.pass("scene", pass);
        }
        app.show(&app.both(&eyes));
    });
    app.expect("pre-pass", &Err(Unmatched::NoColour));
    assert!(app.outcomes("scene").iter().all(|(frame, outcome)| outcome.is_ok() == (*frame > 1)));
}

#[test]
fn deferred() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let buffers = [LDR, HDR, vk::Format::R16G16_SFLOAT].map(|format| app.image(EYE, format));
    app.run(8, |app| {
        for (chain, name) in eyes.iter().zip(["left light", "right light"]) {
            let mut pass = whole(EYE, &buffers);
            app.add_depth(&mut pass);
            app.pass("geometry", pass);
            app.full_screen(name, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("geometry", &looks(Eyes::Finer));
    app.expect("left light", &straight(Eyes::Left));
    app.expect("right light", &straight(Eyes::Right));
}
