//! Passes come in another order than they are shown in, or from where no pass is seen.

use super::super::application::*;
use crate::pass_detection::*;

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

/// The scene in a submission of its own, on another queue, and the copy later: the log is the same. A compute effect before it, which
/// writes the copied image, leaves no pass at all.
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
