//! Sizes change from frame to frame, and so do images.

use super::super::application::*;
use super::dynamic;
use crate::pass_detection::*;

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

/// Resized by the viewport alone, as a pass before it may be too: the part of that with the picture is not known.
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
        for (chain, name) in eyes.iter().zip(["left", "right"]) {
            let copied = app.image(size, LDR);
            app.scene(name, copied);
            app.blit((copied, rect_of(size)), (app.current(chain), rect_of(EYE)));
        }
        app.show(&app.both(&eyes));
    });
    for name in ["left", "right"] {
        for (frame, outcome) in app.outcomes(name).into_iter().skip(3) {
            let found = outcome.unwrap_or_else(|why| panic!("frame {frame}: {why}"));
            assert!(found.parts.iter().all(|part| part.rect == WHOLE), "frame {frame}: {found:?}");
        }
    }
}

#[test]
fn dynamic_resolution_with_a_new_image_each_frame_that_is_tone_mapped() {
    let mut app = Application::default();
    let eyes = app.eyes();
    app.run(20, |app| {
        let image = app.image(dynamic(app.frame), HDR);
        app.scene("scene", image);
        for chain in &eyes {
            app.full_screen("tone-map", app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
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

/// The same command buffers for each image of the ring, recorded once: as passes they do not differ.
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
