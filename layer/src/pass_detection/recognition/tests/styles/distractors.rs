//! Beside the scene there are passes that only look like it.

use super::super::application::*;
use crate::pass_detection::*;
use ash::vk;
use smallvec::smallvec;

/// Shadow map, mirror, cube map, mip chain, a part of a picture that is read back: beside off-screen rendering, where
/// anything with the right looks would do.
#[test]
fn distractors() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let shadow = app.image([256, 256], vk::Format::D32_SFLOAT);
    let variance = app.image(EYE, vk::Format::R32G32_SFLOAT);
    let mirror = app.image([EYE[0], EYE[0] / 2], HDR);
    let small = app.image([EYE[0] / 4, EYE[1] / 4], HDR);
    let large = app.image([EYE[0] * 3, EYE[1] * 3], HDR);
    let cube = app.described(|key| ImageDescription {
        layers: 6,
        is_cube: true,
        ..description(key, [EYE[0], EYE[0]], HDR)
    });
    let cascade = app.described(|key| ImageDescription { layers: 4, ..description(key, EYE, HDR) });
    let scene = app.image(EYE, HDR);
    let identity = app.image(EYE, vk::Format::R32_UINT);
    let spectator = app.image(EYE, HDR);
    app.run(8, |app| {
        let mut pass = whole([256, 256], &[]);
        pass.depth = Some(target(shadow));
        app.pass("shadow", pass);
        app.scene("variance", variance);
        app.scene("mirror", mirror);
        app.scene("small", small);
        app.scene("large", large);
        app.scene("identity", identity);
        for face in 0..6 {
            let mut pass = whole([EYE[0], EYE[0]], &[cube]);
            pass.colors[0].base_layer = face;
            app.pass("cube", pass);
        }
        let mut pass = whole(EYE, &[cascade]);
        pass.colors[0].layers = 4;
        app.pass("cascade", pass);
        for chain in &eyes {
            app.scene("scene", scene);
            let mut mip = whole([EYE[0] / 2, EYE[1] / 2], &[scene]);
            mip.colors[0].level = 1;
            app.pass("mip", mip);
            app.full_screen("tone-map", app.current(chain));
        }
        app.scene("spectator", spectator);
        app.show(&app.both(&eyes));
    });
    app.expect("shadow", &Err(Unmatched::NoColour));
    app.expect("variance", &Err(Unmatched::Format(vk::Format::R32G32_SFLOAT)));
    app.expect("identity", &Err(Unmatched::Format(vk::Format::R32_UINT)));
    app.expect("mirror", &Err(Unmatched::Aspect));
    app.expect("small", &Err(Unmatched::Small));
    app.expect("large", &Err(Unmatched::Large));
    app.expect("cube", &Err(Unmatched::Cube));
    app.expect("cascade", &Err(Unmatched::Layers(4)));
    app.expect("mip", &Err(Unmatched::Level(1)));
    app.expect("spectator", &Err(Unmatched::After));
    app.expect("scene", &looks(Eyes::Finer));
}

/// A reflection of the same size is not the scene if the scene is drawn directly into the swapchain.
#[test]
fn a_reflection_beside_a_scene_drawn_straight() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let reflection = app.image(EYE, LDR);
    app.run(8, |app| {
        app.scene("reflection", reflection);
        for chain in &eyes {
            app.scene("scene", app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("reflection", &Err(Unmatched::DrawnDirectly));
}

/// A user interface in a quad: drawn straight, and copied.
#[test]
fn an_interface_in_a_quad() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (drawn, copied) = (app.chain(EYE, 1), app.chain(EYE, 1));
    let interface = app.image(EYE, LDR);
    app.run(8, |app| {
        app.full_screen("drawn", app.current(&drawn));
        app.full_screen("copied", interface);
        app.copy(interface, app.current(&copied));
        for chain in &eyes {
            let image = app.image(EYE, HDR);
            app.scene("scene", image);
            app.full_screen("tone-map", app.current(chain));
        }
        app.show(&Shown { flat: smallvec![drawn.key, copied.key], ..app.both(&eyes) });
    });
    app.expect("drawn", &Err(Unmatched::Flat));
    app.expect("copied", &Err(Unmatched::Flat));
}

/// Shown both ways it is not the scene, at once, and also in the frames between.
#[test]
fn an_image_in_a_quad_is_dropped_at_once() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(12, |app| {
        app.scene("scene", app.current(&eyes[0]));
        let mut shown = app.both(&eyes);
        if app.frame >= 6 && app.frame.is_multiple_of(2) {
            shown.flat.push(eyes[0].key);
        }
        app.show(&shown);
    });
    for (frame, outcome) in app.outcomes("scene").into_iter().skip(1) {
        let expected = if frame <= 6 { straight(Eyes::Left) } else { Err(Unmatched::Flat) };
        assert_eq!(outcome, expected, "frame {frame}");
    }
}

#[test]
fn an_interface_only_in_every_other_frame() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let quad = app.chain(EYE, 1);
    let image = app.image(EYE, LDR);
    app.run(12, |app| {
        app.scene("scene", image);
        app.copy(image, app.current(&eyes[0]));
        let mut shown = app.both(&eyes);
        if app.frame.is_multiple_of(2) {
            app.full_screen("interface", app.current(&quad));
            shown.flat.push(quad.key);
        }
        app.show(&shown);
    });
    app.expect("scene", &transferred(Eyes::Left));
    app.expect("interface", &Err(Unmatched::Flat));
}

/// The insets of quad views stay at full rate; the views around them are the eyes'.
#[test]
fn quad_views() {
    let mut app = Application::default();
    let (eyes, insets) = (app.eyes(), app.eyes());
    app.run(8, |app| {
        app.scene("scene", app.current(&eyes[0]));
        app.scene("inset", app.current(&insets[0]));
        let mut shown = app.both(&eyes);
        let inset = app.both(&insets).views.into_iter().map(|view| ShownView { eye: None, ..view });
        shown.views.extend(inset);
        app.show(&shown);
    });
    app.expect("scene", &straight(Eyes::Left));
    app.expect("inset", &Err(Unmatched::Inset));
}
