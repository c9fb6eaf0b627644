//! Submissions that change over time, or occur only now and then.

use super::super::application::*;
use super::dynamic;
use crate::pass_detection::*;

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
fn a_source_without_copies_is_dropped_after_a_delay() {
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
fn an_intermediate_without_copies_is_dropped_after_a_delay() {
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

/// Images created in each frame appear in a quad: dropped at once as well.
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

/// The picture is resized by the viewport alone, which is not tracked here.
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

/// Alternate-eye rendering: one target, whose picture is the left eye's in even frames and the right eye's in odd ones.
#[test]
fn a_target_that_alternates_between_the_eyes_has_the_finer_rate_of_both() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let image = app.image(EYE, LDR);
    app.run(200, |app| {
        let chain = &eyes[app.frame as usize % 2];
        app.scene("scene", image);
        app.copy(image, app.current(chain));
        app.show(&app.both(&eyes));
    });
    // From the second picture of the first eye on.
    for (frame, outcome) in app.outcomes("scene").iter().filter(|(frame, _)| *frame > 3) {
        assert_eq!(*outcome, transferred(Eyes::Finer), "frame {frame}");
    }
    assert_eq!(app.outcomes("scene").len(), 200);
}
