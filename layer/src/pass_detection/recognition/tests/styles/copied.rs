//! The scene is drawn off-screen and copied or blitted, or it lies upside-down.

use super::super::application::*;
use super::WIDE;
use crate::pass_detection::*;

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

/// A copy that fills a corner of the picture only does not reveal the origin of the picture.
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
