//! Pictures of earlier frames, where passes read them and where they do not.

use super::super::application::*;
use super::provenance::{full_screen, scene, unknown};
use crate::pass_detection::recognition::HOLD;
use crate::pass_detection::*;

/// Frames until it is known, and none of the frames before counts any longer.
const FRAMES: u64 = 8;

/// Number of repeated frames until findings of the first ones have lapsed; recognition leaves out most of them.
const LONG: u64 = 3000;

/// Runs frames of both eyes, and returns the finding after the last, which is the same after a long time.
fn of_frames(draw: impl Fn(&mut Application, usize, ImageKey)) -> Feedback {
    let [finding, lasting] = [FRAMES, LONG].map(|frames| {
        let mut app = Application::with_kept_depth();
        run(&mut app, frames, &draw);
        app.recognition.feedback()
    });
    assert_eq!(finding, lasting, "after {LONG} frames");
    finding
}

/// `draw` draws an eye, from 0, into its image of the swapchain.
fn run(app: &mut Application, frames: u64, draw: impl Fn(&mut Application, usize, ImageKey)) {
    let eyes = app.eyes();
    app.run(frames, |app| {
        for (eye, chain) in eyes.iter().enumerate() {
            draw(app, eye, app.current(chain));
        }
        app.show(&app.both(&eyes));
    });
}

/// An image of that number, the same in every frame.
fn kept(app: &mut Application, number: u64, extent: [u32; 2]) -> ImageKey {
    app.kept(1_000_000 + number, extent, HDR)
}

/// Blends the scene into one of two images by turns, while it reads the other.
fn accumulate(app: &mut Application, eye: usize, shown: ImageKey) {
    let color = kept(app, 0, EYE);
    let parity = app.frame % 2;
    let [new, old] = [parity, 1 - parity].map(|index| kept(app, 1 + 2 * eye as u64 + index, EYE));
    app.drawn("scene", &[color], true, scene(&[]));
    app.drawn("accumulate", &[new], false, full_screen(&[color, old]));
    app.drawn("tone-map", &[shown], false, full_screen(&[new]));
}

#[test]
fn histories_by_turns_and_copied_ones() {
    assert_eq!(of_frames(accumulate), Feedback::Read);
    let copied = of_frames(|app, eye, shown| {
        let own = 2 * eye as u64;
        let [color, blended, history] = [0, 1 + own, 2 + own].map(|number| kept(app, number, EYE));
        app.drawn("scene", &[color], true, scene(&[]));
        app.drawn("accumulate", &[blended], false, full_screen(&[color, history]));
        app.drawn("tone-map", &[shown], false, full_screen(&[blended]));
        app.copy(blended, history);
    });
    assert_eq!(copied, Feedback::Read);
}

/// As reflections in screen space do.
#[test]
fn a_scene_that_samples_its_last_picture() {
    let by_turns = of_frames(|app, eye, shown| {
        let parity = app.frame % 2;
        let [new, old] = [parity, 1 - parity].map(|index| kept(app, 2 * eye as u64 + index, EYE));
        app.drawn("scene", &[new], true, scene(&[old]));
        app.drawn("tone-map", &[shown], false, full_screen(&[new]));
    });
    let copied = of_frames(|app, eye, shown| {
        let [color, last] = [0, 1 + eye as u64].map(|number| kept(app, number, EYE));
        app.drawn("scene", &[color], true, scene(&[last]));
        app.copy(color, last);
        app.drawn("tone-map", &[shown], false, full_screen(&[color]));
    });
    let straight = of_frames(|app, eye, shown| {
        let last = kept(app, eye as u64, EYE);
        app.drawn("scene", &[shown], true, scene(&[last]));
        app.copy(shown, last);
    });
    assert_eq!([by_turns, copied, straight], [Feedback::Read; 3]);
}

/// Refraction: of a picture that goes straight into the swapchain it would read left-out parts, of others it reads this frame's.
#[test]
fn a_grabbed_picture() {
    let straight = of_frames(|app, _, shown| {
        let grabbed = kept(app, 0, EYE);
        let depth = app.drawn_with_depth("scene", shown, scene(&[]));
        app.copy(shown, grabbed);
        app.drawn_on("water", shown, depth, scene(&[grabbed]));
    });
    let off_screen = of_frames(|app, _, shown| {
        let [color, grabbed] = [0, 1].map(|number| kept(app, number, EYE));
        let depth = app.drawn_with_depth("scene", color, scene(&[]));
        app.copy(color, grabbed);
        app.drawn_on("water", color, depth, scene(&[grabbed]));
        app.drawn("tone-map", &[shown], false, full_screen(&[color]));
    });
    assert_eq!([straight, off_screen], [Feedback::Read, Feedback::None]);
}

#[test]
fn pictures_of_one_frame() {
    let straight = of_frames(|app, _, shown| app.drawn("scene", &[shown], true, scene(&[])));
    let tone_mapped = of_frames(|app, _, shown| {
        let color = kept(app, 0, EYE);
        app.drawn("scene", &[color], true, scene(&[]));
        app.drawn("tone-map", &[shown], false, full_screen(&[color]));
    });
    // Materials without end, straight into the swapchain.
    let bindless = of_frames(|app, _, shown| app.drawn("scene", &[shown], true, unknown(scene(&[]))));
    assert_eq!([straight, tone_mapped, bindless], [Feedback::None; 3]);
}

/// Exposure is one number of a picture; a mirror's history belongs to no eye.
#[test]
fn histories_of_other_things() {
    let exposed = of_frames(|app, eye, shown| {
        let color = kept(app, 0, EYE);
        let parity = app.frame % 2;
        let [new, old] = [parity, 1 - parity].map(|index| kept(app, 1 + 2 * eye as u64 + index, [1, 1]));
        app.drawn("scene", &[color], true, scene(&[]));
        app.drawn("exposure", &[new], false, full_screen(&[color, old]));
        app.drawn("tone-map", &[shown], false, full_screen(&[color, new]));
    });
    let mirrored = of_frames(|app, _, shown| {
        let [color, mirror] = [0, 1].map(|number| kept(app, number, EYE));
        let parity = app.frame % 2;
        let [new, old] = [parity, 1 - parity].map(|index| kept(app, 2 + index, EYE));
        app.drawn("mirror", &[mirror], true, scene(&[]));
        app.drawn("accumulate", &[new], false, full_screen(&[mirror, old]));
        app.drawn("scene", &[color], true, scene(&[new]));
        app.drawn("tone-map", &[shown], false, full_screen(&[color]));
    });
    assert_eq!([exposed, mirrored], [Feedback::None; 2]);
}

/// The thread that renders is a frame ahead: the picture that a pass reads was drawn before the last xrEndFrame.
#[test]
fn a_picture_that_was_drawn_ahead() {
    for frames in [FRAMES, LONG] {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let color = kept(app, 0, EYE);
            for chain in &eyes {
                app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[color]));
            }
            let shown = app.both(&eyes);
            app.drawn("scene", &[color], true, scene(&[]));
            app.show(&shown);
        });
        assert_eq!(app.recognition.feedback(), Feedback::Ahead);
        app.expect("scene", &looks(Eyes::Finer));
    }
}

/// The same in three images by turns: after frames that were left out, the last picture in an image is not the one that was drawn last.
#[test]
fn pictures_by_turns_that_were_drawn_ahead() {
    // Findings of the first frames have lapsed, in which nothing was drawn before.
    let findings = [FRAMES + HOLD, LONG].map(|frames| {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let [last, new] = [2, 3].map(|ahead| (app.frame + ahead) % 3);
            let last = kept(app, last, EYE);
            for chain in &eyes {
                app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[last]));
            }
            let shown = app.both(&eyes);
            let new = kept(app, new, EYE);
            app.drawn("scene", &[new], true, scene(&[]));
            app.show(&shown);
        });
        app.recognition.feedback()
    });
    assert_eq!(findings, [Feedback::Unknown; 2]);
}

/// The same by copies.
#[test]
fn a_picture_that_was_drawn_ahead_and_is_copied() {
    for frames in [FRAMES, LONG] {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let colors = [0, 1].map(|eye| kept(app, eye, EYE));
            for (chain, color) in eyes.iter().zip(colors) {
                app.copy(color, app.current(chain));
                app.drawn("scene", &[color], true, scene(&[]));
            }
            app.show(&app.both(&eyes));
        });
        assert_eq!(app.recognition.feedback(), Feedback::Ahead);
    }
}

/// The thread that renders straight into the swapchain is a frame ahead.
#[test]
fn a_picture_that_was_drawn_ahead_into_the_swapchain() {
    for frames in [FRAMES, LONG] {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let next = eyes.map(|chain| chain.images[(app.frame as usize + 1) % 3]);
            for image in next {
                app.drawn("scene", &[image], true, scene(&[]));
            }
            app.show(&app.both(&eyes));
        });
        assert_eq!(app.recognition.feedback(), Feedback::Ahead);
    }
}

/// Every second frame draws, and the frame after it shows the picture.
#[test]
fn a_picture_that_is_drawn_in_one_frame_and_shown_in_the_next() {
    for frames in [2 * FRAMES, LONG] {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let at = |frame: u64| eyes.map(|chain| chain.images[(frame / 2) as usize % 3]);
            if app.frame.is_multiple_of(2) {
                for image in at(app.frame) {
                    app.drawn("scene", &[image], true, scene(&[]));
                }
            }
            let mut shown = app.both(&eyes);
            for (view, image) in shown.views.iter_mut().zip(at(app.frame - 1)) {
                view.image = Some(image);
            }
            app.show(&shown);
        });
        assert_eq!(app.recognition.feedback(), Feedback::Ahead);
    }
}

/// At half of the frame rate, with a copy for each frame.
#[test]
fn a_picture_that_is_copied_twice() {
    for frames in [2 * FRAMES, LONG] {
        let mut app = Application::with_kept_depth();
        let eyes = app.eyes();
        app.run(frames, |app| {
            let colors = [0, 1].map(|eye| kept(app, eye, EYE));
            for (chain, color) in eyes.iter().zip(colors) {
                if !app.frame.is_multiple_of(2) {
                    app.drawn("scene", &[color], true, scene(&[]));
                }
                app.copy(color, app.current(chain));
            }
            app.show(&app.both(&eyes));
        });
        assert_eq!(app.recognition.feedback(), Feedback::Ahead);
    }
}

/// The picture of a frame is known with it, or is shown again.
#[test]
fn pictures_by_turns_and_shown_again() {
    let by_turns = |is_copied: bool| {
        let mut app = Application::default();
        let eyes = app.eyes();
        let at = |eye: usize, frame: u64| eyes[eye].images[((frame + eye as u64) / 2) as usize % 3];
        app.run(2 * FRAMES, |app| {
            let eye = (app.frame % 2) as usize;
            let image = at(eye, app.frame);
            if is_copied {
                let color = kept(app, eye as u64, EYE);
                app.drawn("scene", &[color], true, scene(&[]));
                app.copy(color, image);
            } else {
                app.drawn("scene", &[image], true, scene(&[]));
            }
            let mut shown = app.both(&eyes);
            for (eye, view) in shown.views.iter_mut().enumerate() {
                let drawn_at = app.frame - u64::from(eye as u64 != app.frame % 2);
                view.image = Some(at(eye, drawn_at));
            }
            app.show(&shown);
        });
        app.recognition.feedback()
    };
    assert_eq!([false, true].map(by_turns), [Feedback::None; 2]);
    let at_half_rate = |is_missed: bool| {
        let mut app = Application::default();
        let eyes = app.eyes();
        app.run(2 * FRAMES, |app| {
            let current = eyes.map(|chain| chain.images[(app.frame / 2) as usize % 3]);
            let is_drawn = app.frame.is_multiple_of(2);
            if is_missed && app.frame == FRAMES + 2 {
                // Nothing is known of the frame that draws this image again.
                app.recognition.miss();
                return;
            }
            if is_drawn {
                for image in current {
                    app.drawn("scene", &[image], true, scene(&[]));
                }
            }
            let mut shown = app.both(&eyes);
            for (view, image) in shown.views.iter_mut().zip(current) {
                view.image = Some(image);
            }
            app.show(&shown);
        });
        app.recognition.feedback()
    };
    assert_eq!([false, true].map(at_half_rate), [Feedback::None; 2]);
}

/// A picture of the last frame, small beside that of this frame.
#[test]
fn an_earlier_picture_in_a_corner() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let corner = [0, 0, EYE[0] as i32 / 8, EYE[1] as i32 / 8];
    app.run(FRAMES, |app| {
        let parity = app.frame % 2;
        for (eye, chain) in (0..).zip(&eyes) {
            let [new, old] = [parity, 1 - parity].map(|index| kept(app, 2 * eye + index, EYE));
            app.drawn("scene", &[new], true, scene(&[]));
            app.copy(new, app.current(chain));
            app.blit((old, rect_of(EYE)), (app.current(chain), corner));
        }
        app.show(&app.both(&eyes));
    });
    assert_eq!(app.recognition.feedback(), Feedback::None);
}

#[test]
fn whatever_may_be_read_is_unknown() {
    let unfollowed = of_frames(|app, _, shown| {
        let color = kept(app, 0, EYE);
        app.drawn("scene", &[color], true, unknown(scene(&[])));
        app.drawn("tone-map", &[shown], false, unknown(full_screen(&[])));
    });
    let computed = of_frames(|app, _, shown| {
        let [color, upscaled] = [0, 1].map(|number| kept(app, number, EYE));
        app.drawn("scene", &[color], true, scene(&[]));
        app.copy(upscaled, shown);
    });
    assert_eq!([unfollowed, computed], [Feedback::Unknown; 2]);
}

/// Two seconds at most, after an application turned its filter off.
#[test]
fn a_filter_that_is_turned_off() {
    let mut app = Application::default();
    run(&mut app, FRAMES, accumulate);
    let plain = |app: &mut Application, _: usize, shown: ImageKey| {
        let color = kept(app, 0, EYE);
        app.drawn("scene", &[color], true, scene(&[]));
        app.drawn("tone-map", &[shown], false, full_screen(&[color]));
    };
    run(&mut app, 60, plain);
    assert_eq!(app.recognition.feedback(), Feedback::Read);
    run(&mut app, 120, plain);
    assert_eq!(app.recognition.feedback(), Feedback::None);
}
