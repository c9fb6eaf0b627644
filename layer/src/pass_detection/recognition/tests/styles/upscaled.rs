//! The scene has far fewer pixels than the picture, beside effects and textures that have as few.

use super::super::application::*;
use super::provenance::{full_screen, scene, unknown};
use crate::pass_detection::*;
use ash::vk;

/// A third of the sides, as upscalers render in their fastest mode.
const THIRD: [u32; 2] = [EYE[0] / 3, EYE[1] / 3];

fn part(size: [u32; 2], divisor: u32) -> [u32; 2] {
    size.map(|side| side / divisor)
}

/// Particles at half of the scene's sides with a copy of its depth, and a bloom chain, composed at its size; then upscaled.
#[test]
fn a_third_upscaled_by_a_pass() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [color, composed] = [(); 2].map(|()| app.image(THIRD, HDR));
    let [particles, bloom] = [(); 2].map(|()| app.image(part(THIRD, 2), HDR));
    let blur = app.image(part(THIRD, 4), HDR);
    let depth = app.image(part(THIRD, 2), vk::Format::D32_SFLOAT);
    app.run(8, |app| {
        for chain in &eyes {
            app.drawn("scene", &[color], true, scene(&[]));
            app.drawn_on("particles", particles, target(depth), scene(&[]));
            app.drawn("bloom", &[bloom], false, full_screen(&[color]));
            app.drawn("blur", &[blur], false, full_screen(&[bloom]));
            app.drawn("compose", &[composed], false, full_screen(&[color, particles, bloom, blur]));
            app.drawn("upscale", &[app.current(chain)], false, full_screen(&[composed]));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
    app.expect("upscale", &Err(Unmatched::FullScreen));
    for name in ["particles", "bloom", "blur", "compose"] {
        app.expect(name, &Err(Unmatched::Small));
    }
}

/// The images of the upscaler are written by compute, and tone mapping also reads the scene's bloom.
#[test]
fn a_third_upscaled_by_compute() {
    for reads_bloom in [false, true] {
        let mut app = Application::default();
        let eyes = app.eyes();
        let [color, mirror] = [(); 2].map(|()| app.image(THIRD, HDR));
        let bloom = app.image(part(THIRD, 2), HDR);
        let upscaled = [(); 2].map(|()| app.image(EYE, HDR));
        app.run(12, |app| {
            app.drawn("mirror", &[mirror], true, scene(&[]));
            for (chain, upscaled) in eyes.iter().zip(upscaled) {
                app.drawn("scene", &[color], true, scene(&[mirror]));
                app.drawn("bloom", &[bloom], false, full_screen(&[color]));
                let read = if reads_bloom { &[upscaled, bloom][..] } else { &[upscaled] };
                app.drawn("tone-map", &[app.current(chain)], false, full_screen(read));
            }
            app.show(&app.both(&eyes));
        });
        app.expect("scene", &looks(Eyes::Finer));
        app.expect("mirror", &Err(Unmatched::Small));
        app.expect("bloom", &Err(Unmatched::Small));
    }
}

/// Another camera may be the scene as well, or the reads are not known, which may include any camera.
#[test]
fn a_third_in_doubt() {
    for (has_spectator, is_unknown) in [(true, false), (false, true)] {
        let mut app = Application::default();
        let eyes = app.eyes();
        let color = app.image(THIRD, HDR);
        let spectator = app.image(EYE, HDR);
        let upscaled = app.image(EYE, HDR);
        app.run(12, |app| {
            let known = |draws| if is_unknown { unknown(draws) } else { draws };
            if has_spectator {
                app.drawn("spectator", &[spectator], true, scene(&[]));
            }
            for chain in &eyes {
                app.drawn("scene", &[color], true, known(scene(&[])));
                app.drawn("tone-map", &[app.current(chain)], false, known(full_screen(&[upscaled])));
            }
            app.show(&app.both(&eyes));
        });
        app.expect("scene", &Err(Unmatched::Small));
    }
}

/// Lighting of a third of the sides from the G-buffer, particles at a third, and a page of as many pixels over the picture.
#[test]
fn effects_at_a_third() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [albedo, normals, lit] = [LDR, HDR, HDR].map(|format| app.image(EYE, format));
    let [bounced, particles, page] = [(); 3].map(|()| app.image(THIRD, HDR));
    let depth = app.image(THIRD, vk::Format::D32_SFLOAT);
    app.run(8, |app| {
        app.drawn("page", &[page], true, scene(&[]));
        for chain in &eyes {
            app.drawn("geometry", &[albedo, normals], true, scene(&[]));
            app.drawn("bounced light", &[bounced], false, full_screen(&[albedo, normals]));
            app.drawn("light", &[lit], false, full_screen(&[albedo, normals, bounced]));
            app.drawn_on("particles", particles, target(depth), scene(&[]));
            let current = app.current(chain);
            app.drawn("tone-map", &[current], false, full_screen(&[lit, particles]));
            let mut over = whole(EYE, &[current]);
            over.facts.loads_color = true;
            over.draws = Some(full_screen(&[page]));
            app.pass("show page", over);
        }
        app.show(&app.both(&eyes));
    });
    app.expect("geometry", &looks(Eyes::Finer));
    app.expect("light", &looks(Eyes::Finer));
    for name in ["bounced light", "particles", "page"] {
        app.expect(name, &Err(Unmatched::Small));
    }
}

/// Half of the sides, rounded down to a multiple of 8.
#[test]
fn half_of_the_sides_rounded_down() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let color = app.image([96, 120], HDR);
    app.run(8, |app| {
        for chain in &eyes {
            app.drawn("scene", &[color], true, unknown(scene(&[])));
            app.drawn("tone-map", &[app.current(chain)], false, unknown(full_screen(&[])));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
}

/// Compute that writes the images of the swapchains.
#[test]
fn tone_mapped_into_the_swapchain_by_compute() {
    let new = || {
        let mut app = Application::default();
        let eyes = app.eyes();
        let images = [app.image(EYE, HDR), app.image(EYE, HDR), app.image([1024, 1024], HDR)];
        (app, eyes, images)
    };
    let draw = |app: &mut Application, [left, right, shadow]: [ImageKey; 3]| {
        app.drawn("shadow", &[shadow], true, scene(&[]));
        for image in [left, right] {
            app.drawn("scene", &[image], true, scene(&[shadow]));
        }
    };
    let (mut app, eyes, images) = new();
    app.run(200, |app| {
        draw(app, images);
        app.show(&app.both(&eyes));
    });
    let last = |app: &Application, name| app.outcomes(name).last().unwrap().1.clone();
    assert_eq!(last(&app, "scene"), looks(Eyes::Finer));
    assert!(app.outcomes("shadow").iter().all(|(_, outcome)| outcome.is_err()));
    assert_eq!(app.recognition.feedback(), Feedback::Unknown);

    // A preview in a window, as large as the eyes, while the last images are shown again.
    let (mut app, eyes, images) = new();
    let still = app.both(&eyes);
    app.run(200, |app| {
        draw(app, images);
        app.show(&still);
    });
    assert!(app.outcomes("scene").iter().all(|(_, outcome)| outcome.is_err()));

    // One camera for two eyes may be anything.
    let (mut app, eyes, [image, ..]) = new();
    app.run(200, |app| {
        app.drawn("mirror", &[image], true, scene(&[]));
        app.show(&app.both(&eyes));
    });
    assert!(app.outcomes("mirror").iter().all(|(_, outcome)| outcome.is_err()));
}
