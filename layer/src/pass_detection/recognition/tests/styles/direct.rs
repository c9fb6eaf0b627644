//! The scene is drawn straight into swapchains.

use super::super::application::*;
use super::{BOTH_LAYERS, HALVES, WIDE, array_shown, wide_shown};
use crate::pass_detection::*;

#[test]
fn straight_into_a_swapchain_for_each_eye() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(8, |app| {
        for (name, chain) in ["left", "right"].into_iter().zip(&eyes) {
            app.scene(name, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("left", &straight(Eyes::Left));
    app.expect("right", &straight(Eyes::Right));
    // One frame is enough, on every image of the ring.
    assert!(app.seen.iter().all(|(frame, _, outcome)| outcome.is_ok() == (*frame > 1)));
}

#[test]
fn several_passes_to_one_target() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(8, |app| {
        for (chain, names) in eyes.iter().zip([["left", "left interface"], ["right", "right interface"]]) {
            app.scene(names[0], app.current(chain));
            app.full_screen(names[1], app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    for name in ["left", "left interface"] {
        app.expect(name, &straight(Eyes::Left));
    }
    for name in ["right", "right interface"] {
        app.expect(name, &straight(Eyes::Right));
    }
}

#[test]
fn multiview_into_an_array() {
    let mut app = Application::default();
    let chain = app.chain(EYE, 2);
    app.run(8, |app| {
        app.pass("scene", multiview(whole(EYE, &[app.current(&chain)])));
        app.show(&array_shown(app, &chain));
    });
    app.expect("scene", &matched(How::Swapchain, Orientation::Upright, &BOTH_LAYERS));
}

#[test]
fn a_pass_for_each_layer_of_an_array() {
    let mut app = Application::default();
    let chain = app.chain(EYE, 2);
    app.run(8, |app| {
        for (layer, name) in (0..).zip(["left", "right"]) {
            let mut pass = whole(EYE, &[app.current(&chain)]);
            pass.colors[0].base_layer = layer;
            app.pass(name, pass);
        }
        app.show(&array_shown(app, &chain));
    });
    app.expect("left", &straight(Eyes::Left));
    app.expect("right", &straight(Eyes::Right));
}

#[test]
fn both_eyes_in_one_pass_beside_each_other() {
    let mut app = Application::default();
    let chain = app.chain(WIDE, 1);
    app.run(8, |app| {
        app.scene("scene", app.current(&chain));
        app.show(&wide_shown(app, &chain));
    });
    app.expect("scene", &matched(How::Swapchain, Orientation::Upright, &HALVES));
}

/// Each pass draws one half: the other half's picture is none of it.
#[test]
fn a_pass_for_each_half() {
    let mut app = Application::default();
    let chain = app.chain(WIDE, 1);
    app.run(8, |app| {
        for (x, name) in [(0, "left"), (EYE[0], "right")] {
            let mut pass = whole(WIDE, &[app.current(&chain)]);
            pass.area = [x, 0, EYE[0], EYE[1]];
            app.pass(name, pass);
        }
        app.show(&wide_shown(app, &chain));
    });
    app.expect("left", &straight(Eyes::Left));
    app.expect("right", &straight(Eyes::Right));
}
