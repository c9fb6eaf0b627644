//! The event streams of the styles of rendering that applications have.

use super::application::*;
use crate::scene::*;
use ash::vk;
use smallvec::smallvec;

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

fn array_shown(app: &Application, chain: &Chain) -> Shown {
    let image = Some(app.current(chain));
    let view = |eye, layer| ShownView { layer, image, ..view_of(chain, eye) };
    Shown { views: smallvec![view(Eye::Left, 0), view(Eye::Right, 1)], ..Shown::default() }
}

const BOTH_LAYERS: [(Eyes, u32, [f32; 4]); 2] = [(Eyes::Left, 0, WHOLE), (Eyes::Right, 1, WHOLE)];

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

const WIDE: [u32; 2] = [2 * EYE[0], EYE[1]];
const HALVES: [(Eyes, u32, [f32; 4]); 2] = [(Eyes::Left, 0, LEFT_HALF), (Eyes::Right, 0, RIGHT_HALF)];

fn wide_shown(app: &Application, chain: &Chain) -> Shown {
    let image = Some(app.current(chain));
    let view = |eye, x| ShownView { rect: [x, 0, EYE[0], EYE[1]], image, ..view_of(chain, eye) };
    Shown { views: smallvec![view(Eye::Left, 0), view(Eye::Right, EYE[0])], ..Shown::default() }
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

/// Direct3D by Proton: off-screen, copied.
#[test]
fn copied() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let images = [app.image(EYE, LDR), app.image(EYE, LDR)];
    app.run(8, |app| {
        for ((image, chain), name) in images.into_iter().zip(&eyes).zip(["left", "right"]) {
            app.scene(name, image);
            app.copy(image, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("left", &transferred(Eyes::Left));
    app.expect("right", &transferred(Eyes::Right));
}

#[test]
fn copied_from_both_eyes_beside_each_other() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(WIDE, LDR);
    app.run(8, |app| {
        app.scene("scene", image);
        for (chain, x) in eyes.iter().zip([0, EYE[0] as i32]) {
            let to = rect_of(EYE);
            app.blit((image, [x, 0, to[2], to[3]]), (app.current(chain), to));
        }
        app.show(&app.both(&eyes));
    });
    let halves = [(Eyes::Right, 0, RIGHT_HALF), (Eyes::Left, 0, LEFT_HALF)];
    app.expect("scene", &matched(How::Transferred, Orientation::Upright, &halves));
}

#[test]
fn upscaled_by_a_blit_through_another_image() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (small, middle) = (app.image([134, 161], LDR), app.image([134, 161], LDR));
    app.run(8, |app| {
        app.scene("scene", small);
        app.copy(small, middle);
        app.blit((middle, rect_of([134, 161])), (app.current(&eyes[0]), rect_of(EYE)));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Left));
}

#[test]
fn upscaled_by_a_pass() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let small = app.image([134, 161], HDR);
    app.run(8, |app| {
        for chain in &eyes {
            app.scene("scene", small);
            app.full_screen("upscale", app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
}

/// What fills a corner of the picture only says nothing of where the picture comes from.
#[test]
fn a_display_copied_into_a_corner() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let size = [EYE[0] / 4, EYE[1] / 4];
    let (image, display) = (app.image(EYE, LDR), app.image(size, LDR));
    app.run(8, |app| {
        app.scene("scene", image);
        app.scene("display", display);
        app.copy(image, app.current(&eyes[0]));
        app.copy(display, app.current(&eyes[0]));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Left));
    app.expect("display", &Err(Unmatched::Small));
}

#[test]
fn flipped_by_a_blit() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    let [width, height] = EYE.map(|side| side as i32);
    app.run(8, |app| {
        app.scene("scene", image);
        app.blit((image, [0, height, width, -height]), (app.current(&eyes[0]), rect_of(EYE)));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &one(How::Transferred, Orientation::UpsideDown, Eyes::Left));
}

#[test]
fn a_field_of_view_upside_down() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(8, |app| {
        app.scene("scene", app.current(&eyes[0]));
        let mut shown = app.both(&eyes);
        shown.views.iter_mut().for_each(|view| view.is_upside_down = true);
        app.show(&shown);
    });
    app.expect("scene", &one(How::Swapchain, Orientation::UpsideDown, Eyes::Left));
}

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

/// Where the scene is drawn straight into the swapchain, a reflection of the same size is none.
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
fn what_turns_up_in_a_quad_is_given_up_at_once() {
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

/// Sizes of a frame with dynamic resolution, rounded to multiples of 8.
fn dynamic(frame: u64) -> [u32; 2] {
    let step = [0, 3, 1, 4, 2, 5][frame as usize % 6];
    [EYE[0] - 8 * step, EYE[1] - 8 * step]
}

/// Whether it is known which image was shown, or not.
#[test]
fn dynamic_resolution_in_the_swapchain() {
    for knows_image in [true, false] {
        let mut app = Application::default();
        let eyes = app.eyes();
        app.run(20, |app| {
            let [width, height] = dynamic(app.frame);
            for (chain, name) in eyes.iter().zip(["left", "right"]) {
                let mut pass = whole(EYE, &[app.current(chain)]);
                pass.area = [0, 0, width, height];
                app.pass(name, pass);
            }
            let mut shown = app.both(&eyes);
            for view in &mut shown.views {
                view.rect = [0, 0, width, height];
                view.image = view.image.filter(|_| knows_image);
            }
            app.show(&shown);
        });
        app.expect("left", &straight(Eyes::Left));
        app.expect("right", &straight(Eyes::Right));
    }
}

/// Resized by the viewport alone, where a pass before it may be too: nobody knows which part of it is the picture.
#[test]
fn tone_mapped_into_a_part_of_the_render_area() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, HDR);
    app.run(20, |app| {
        app.scene("scene", image);
        app.full_screen("tone-map", app.current(&eyes[0]));
        let mut shown = app.both(&eyes);
        shown.views.truncate(1);
        shown.views[0].rect = [0, 0, 150, 180];
        app.show(&shown);
    });
    app.expect("scene", &Err(Unmatched::Viewport));
    let part = (Eyes::Left, 0, [0.0, 0.0, 0.75, 0.75]);
    app.expect("tone-map", &matched(How::Swapchain, Orientation::Upright, &[part]));
}

#[test]
fn dynamic_resolution_upscaled_by_a_blit() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    app.run(20, |app| {
        let [width, height] = dynamic(app.frame);
        let mut pass = whole(EYE, &[image]);
        pass.area = [0, 0, width, height];
        app.pass("scene", pass);
        app.blit((image, rect_of([width, height])), (app.current(&eyes[0]), rect_of(EYE)));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Left));
}

/// Through another image, for both eyes in turn.
#[test]
fn dynamic_resolution_of_one_image_for_both_eyes() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (image, middle) = (app.image(EYE, LDR), app.image(EYE, LDR));
    app.run(20, |app| {
        let [width, height] = dynamic(app.frame);
        for chain in &eyes {
            let mut pass = whole(EYE, &[image]);
            pass.area = [0, 0, width, height];
            app.pass("scene", pass);
            app.blit((image, rect_of([width, height])), (middle, rect_of(EYE)));
            app.copy(middle, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    let both = [(Eyes::Right, 0, WHOLE), (Eyes::Left, 0, WHOLE)];
    app.expect("scene", &matched(How::Transferred, Orientation::Upright, &both));
}

#[test]
fn dynamic_resolution_with_a_new_image_each_frame() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(20, |app| {
        let size = dynamic(app.frame);
        let image = app.image(size, HDR);
        for (chain, name) in eyes.iter().zip(["left", "right"]) {
            let copied = app.image(size, LDR);
            app.scene(name, copied);
            app.blit((copied, rect_of(size)), (app.current(chain), rect_of(EYE)));
        }
        app.scene("looks", image);
        app.full_screen("tone-map", app.current(&eyes[0]));
        app.show(&app.both(&eyes));
    });
    app.expect("looks", &looks(Eyes::Finer));
    for name in ["left", "right"] {
        for (frame, outcome) in app.outcomes(name).into_iter().skip(3) {
            let found = outcome.unwrap_or_else(|why| panic!("frame {frame}: {why}"));
            assert!(found.parts.iter().all(|part| part.rect == WHOLE), "frame {frame}: {found:?}");
        }
    }
}

/// Two passes of one shape: which is which is known by their order.
#[test]
fn new_images_each_frame() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(8, |app| {
        for (chain, name) in eyes.iter().zip(["left", "right"]) {
            let image = app.image(EYE, LDR);
            app.scene(name, image);
            app.copy(image, app.current(chain));
        }
        let mirror = app.image(EYE, LDR);
        app.scene("spectator", mirror);
        app.show(&app.both(&eyes));
    });
    app.expect("left", &transferred(Eyes::Left));
    app.expect("right", &transferred(Eyes::Right));
    assert!(app.outcomes("spectator").iter().all(|(_, outcome)| outcome.is_err()));
}

/// Smaller than its looks would allow.
#[test]
fn new_images_each_frame_upscaled_from_little() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let size = [EYE[0] * 2 / 5, EYE[1] * 2 / 5];
    app.run(8, |app| {
        let image = app.image(size, LDR);
        app.scene("scene", image);
        app.blit((image, rect_of(size)), (app.current(&eyes[0]), rect_of(EYE)));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Left));
}

/// The same command buffers for each image of the ring, recorded once: as passes they are no different.
#[test]
fn a_ring_of_images_of_its_own() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let ring = [(); 5].map(|()| app.image(EYE, LDR));
    app.run(12, |app| {
        let image = ring[app.frame as usize % ring.len()];
        app.scene("scene", image);
        app.copy(image, app.current(&eyes[1]));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &transferred(Eyes::Right));
}

/// The render thread is apart from the XR thread: passes of the next frame come before this one's xrEndFrame, and the
/// copies of it after it.
#[test]
fn a_render_thread_apart() {
    for is_new in [false, true] {
        let mut app = Application::default();
        let eyes = app.eyes();
        let mut pending = None;
        let kept = [app.image(EYE, LDR), app.image(EYE, LDR)];
        app.run(12, |app| {
            let before = std::mem::take(&mut pending);
            let mut shown = Shown::default();
            if let Some((images, targets, was)) = before {
                let images: [ImageKey; 2] = images;
                let targets: [ImageKey; 2] = targets;
                app.copy(images[0], targets[0]);
                app.copy(images[1], targets[1]);
                shown = was;
            }
            let images = if is_new { [app.image(EYE, LDR), app.image(EYE, LDR)] } else { kept };
            let targets = [app.current(&eyes[0]), app.current(&eyes[1])];
            app.scene("left", images[0]);
            app.scene("right", images[1]);
            pending = Some((images, targets, app.both(&eyes)));
            app.show(&shown);
        });
        app.expect("left", &transferred(Eyes::Left));
        app.expect("right", &transferred(Eyes::Right));
    }
}

/// The same with a tone-mapping pass, which then comes before the pass that it reads.
#[test]
fn a_render_thread_apart_with_tone_mapping() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, HDR);
    app.run(12, |app| {
        app.full_screen("tone-map", app.current(&eyes[0]));
        let shown = app.both(&eyes);
        app.scene("scene", image);
        app.show(&shown);
    });
    app.expect("scene", &looks(Eyes::Finer));
}

/// The scene in a submission of its own, on another queue, and the copy later: the log is the same. An effect before it in
/// compute, which writes what is copied, leaves no pass at all.
#[test]
fn tone_mapped_by_a_compute_shader() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (scene, mapped) = (app.image(EYE, HDR), app.image(EYE, LDR));
    app.run(8, |app| {
        app.scene("scene", scene);
        app.copy(mapped, app.current(&eyes[0]));
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
}

#[test]
fn frames_that_show_nothing_change_nothing() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    app.run(400, |app| {
        app.scene("scene", image);
        let is_shown = app.frame < 4 || app.frame > 390;
        if is_shown {
            app.copy(image, app.current(&eyes[0]));
        }
        app.show(&if is_shown { app.both(&eyes) } else { Shown::default() });
    });
    app.expect("scene", &transferred(Eyes::Left));
}

#[test]
fn what_is_no_longer_copied_is_given_up_some_time_later() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    app.run(200, |app| {
        app.scene("image", image);
        if app.frame < 10 {
            app.copy(image, app.current(&eyes[0]));
        }
        app.scene("scene", app.current(&eyes[1]));
        app.show(&app.both(&eyes));
    });
    let outcomes = app.outcomes("image");
    assert_eq!(outcomes[20].1, transferred(Eyes::Left));
    assert!(outcomes[100].1.is_err());
}

/// The same at the end of a chain, whose middle no pass draws.
#[test]
fn what_is_no_longer_copied_on_is_given_up_some_time_later() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (image, middle) = (app.image(EYE, LDR), app.image(EYE, LDR));
    app.run(200, |app| {
        app.scene("image", image);
        app.copy(image, middle);
        if app.frame < 10 {
            app.copy(middle, app.current(&eyes[0]));
        }
        app.scene("scene", app.current(&eyes[1]));
        app.show(&app.both(&eyes));
    });
    let outcomes = app.outcomes("image");
    assert_eq!(outcomes[20].1, transferred(Eyes::Left));
    assert!(outcomes[180].1.is_err());
}

/// Images made anew in each frame turn up in a quad: given up at once as well.
#[test]
fn new_images_that_turn_up_in_a_quad() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let quad = app.chain(EYE, 1);
    app.run(20, |app| {
        let image = app.image(EYE, LDR);
        app.scene("scene", image);
        app.copy(image, app.current(&eyes[0]));
        let mut shown = app.both(&eyes);
        if app.frame >= 10 {
            app.copy(image, app.current(&quad));
            shown.flat.push(quad.key);
        }
        app.show(&shown);
    });
    for (frame, outcome) in app.outcomes("scene").into_iter().skip(1) {
        let expected = if frame <= 10 { transferred(Eyes::Left) } else { Err(Unmatched::Flat) };
        assert_eq!(outcome, expected, "frame {frame}");
    }
}

/// A loading screen, drawn without depth and nothing before it, does not make a scene of the spectator's picture.
#[test]
fn a_spectator_while_nothing_else_is_drawn() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let (image, spectator) = (app.image(EYE, HDR), app.image(EYE, HDR));
    app.run(60, |app| {
        if app.frame < 10 || app.frame > 40 {
            app.scene("scene", image);
        }
        app.full_screen("tone-map", app.current(&eyes[0]));
        app.scene("spectator", spectator);
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
    app.expect("spectator", &Err(Unmatched::After));
}

#[test]
fn two_sessions_on_one_device() {
    let mut app = Application::default();
    let (first, second) = (app.eyes(), app.eyes());
    app.run(12, |app| {
        app.scene("first", app.current(&first[0]));
        app.show(&app.both(&first));
        app.scene("second", app.current(&second[1]));
        app.show(&app.both(&second));
    });
    app.expect("first", &straight(Eyes::Left));
    app.expect("second", &straight(Eyes::Right));
}

/// The picture is resized by the viewport alone, which nobody sees here.
#[test]
fn a_picture_that_changes_within_its_render_area() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(20, |app| {
        app.scene("scene", app.current(&eyes[0]));
        let [width, height] = dynamic(app.frame);
        let mut shown = app.both(&eyes);
        shown.views.iter_mut().for_each(|view| view.rect = [0, 0, width, height]);
        app.show(&shown);
    });
    app.expect("scene", &Err(Unmatched::Unsteady));
}

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
        app.recognition.news(|line| lines.push((app.frame, line.to_string())));
    });
    let expected = [
        "pass 256x256 D32_SFLOAT: not the scene: no colour: a shadow map or a depth pre-pass",
        "pass 64x48 R16G16B16A16_SFLOAT: not the scene: another aspect than the eye's picture",
        "pass 200x240 R8G8B8A8_SRGB, 2 layers: the scene: left eye and right eye: draws into the swapchain",
    ];
    assert_eq!(lines, expected.map(|line| (SETTLED, line.to_owned())));
}
