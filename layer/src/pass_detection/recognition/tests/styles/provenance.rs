//! Provenance of the picture, with and without known descriptors.

use super::super::application::*;
use crate::pass_detection::*;
use ash::vk;

/// Draws of a full-screen pass that reads these images.
pub(super) fn full_screen(images: &[ImageKey]) -> Draws {
    Draws { quads: 1, vertices: 3, read_by_quads: reads(images), ..Draws::default() }
}

/// Draws of a scene that samples these images.
pub(super) fn scene(textures: &[ImageKey]) -> Draws {
    Draws { meshes: 200, vertices: 100_000, read_by_meshes: reads(textures), ..Draws::default() }
}

fn reads(images: &[ImageKey]) -> Reads {
    Reads { images: images.into(), may_read_more: false }
}

/// The same draws if descriptors are not followed.
pub(super) fn unknown(draws: Draws) -> Draws {
    let anything = Reads { may_read_more: true, ..Reads::default() };
    Draws { read_by_quads: anything.clone(), read_by_meshes: anything, ..draws }
}

impl Application {
    pub(super) fn drawn(&mut self, name: &'static str, colors: &[ImageKey], has_depth: bool, draws: Draws) {
        let mut pass = whole(self.extent(colors[0]), colors);
        if has_depth {
            self.add_depth(&mut pass);
        }
        pass.draws = Some(draws);
        self.pass(name, pass);
    }

    /// Over the image so far, without depth.
    pub(super) fn drawn_over(&mut self, name: &'static str, color: ImageKey, draws: Draws) {
        let mut pass = whole(self.extent(color), &[color]);
        pass.facts.loads_color = true;
        pass.draws = Some(draws);
        self.pass(name, pass);
    }

    /// With depth that it clears, which later passes go on with.
    pub(super) fn drawn_with_depth(&mut self, name: &'static str, color: ImageKey, draws: Draws) -> Target {
        let mut pass = whole(self.extent(color), &[color]);
        self.add_depth(&mut pass);
        pass.draws = Some(draws);
        let depth = pass.depth.unwrap();
        self.pass(name, pass);
        depth
    }

    /// With that depth, which it loads.
    pub(super) fn drawn_on(&mut self, name: &'static str, color: ImageKey, depth: Target, draws: Draws) {
        let mut pass = whole(self.extent(color), &[color]);
        pass.depth = Some(depth);
        pass.draws = Some(draws);
        self.pass(name, pass);
    }
}

/// A target that the scene samples is a texture, regardless of its looks, and so are targets that only feed it.
#[test]
fn a_mirror_as_large_as_the_eye() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [color, bright, mirror] = [HDR, HDR, LDR].map(|format| app.image(EYE, format));
    app.run(8, |app| {
        app.drawn("mirror", &[bright], true, scene(&[]));
        app.drawn("tone-mapped mirror", &[mirror], false, full_screen(&[bright]));
        for chain in &eyes {
            app.drawn("scene", &[color], true, scene(&[mirror]));
            app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[color]));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
    app.expect("mirror", &Err(Unmatched::Texture));
    app.expect("tone-mapped mirror", &Err(Unmatched::After));
    app.expect("tone-map", &Err(Unmatched::FullScreen));
}

/// Without descriptors the scene is known only where nothing else may be it.
#[test]
fn ambiguity_without_descriptors() {
    for has_mirror in [false, true] {
        let mut app = Application::default();
        let eyes = app.eyes();
        let [color, mirror] = [app.image(EYE, HDR), app.image(EYE, HDR)];
        app.run(8, |app| {
            if has_mirror {
                app.drawn("mirror", &[mirror], true, unknown(scene(&[])));
            }
            for chain in &eyes {
                app.drawn("scene", &[color], true, unknown(scene(&[])));
                app.drawn("tone-map", &[app.current(chain)], false, unknown(full_screen(&[])));
            }
            app.show(&app.both(&eyes));
        });
        app.expect("scene", &if has_mirror { Err(Unmatched::Ambiguous) } else { looks(Eyes::Finer) });
    }
}

/// A pool gives the mirror's image to the eyes: their order distinguishes them.
#[test]
fn a_mirror_in_the_image_of_the_eyes() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [color, mirror] = [app.image(EYE, HDR), app.image(EYE, LDR)];
    app.run(20, |app| {
        app.drawn("mirror", &[color], true, scene(&[]));
        app.drawn("tone-mapped mirror", &[mirror], false, full_screen(&[color]));
        for chain in &eyes {
            app.drawn("scene", &[color], true, scene(&[mirror]));
            app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[color]));
        }
        app.show(&app.both(&eyes));
    });
    assert!(app.outcomes("mirror").iter().all(|(_, outcome)| outcome.is_err()));
    let settled = app.outcomes("scene").into_iter().filter(|(frame, _)| *frame >= 10);
    settled.for_each(|(frame, outcome)| assert_eq!(outcome, looks(Eyes::Finer), "frame {frame}"));
}

/// Lighting from a G-buffer shades: it keeps the rates of the scene. Tone mapping does not.
#[test]
fn full_screen_lighting() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [albedo, normals, lit] = [LDR, HDR, HDR].map(|format| app.image(EYE, format));
    app.run(8, |app| {
        for chain in &eyes {
            app.drawn("geometry", &[albedo, normals], true, scene(&[]));
            app.drawn("light", &[lit], false, full_screen(&[albedo, normals]));
            app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[lit]));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("geometry", &looks(Eyes::Finer));
    app.expect("light", &looks(Eyes::Finer));
    app.expect("tone-map", &Err(Unmatched::FullScreen));
}

/// An interface without depth, that tone mapping lays over the picture, is as large as the swapchain, where the scene is smaller.
#[test]
fn a_visor_over_a_smaller_scene() {
    let mut app = Application::default();
    let eyes = app.eyes();
    let [color, visor] = [app.image([160, 192], HDR), app.image(EYE, vk::Format::R8G8B8A8_UNORM)];
    app.run(8, |app| {
        app.drawn("visor", &[visor], false, scene(&[]));
        for chain in &eyes {
            app.drawn("scene", &[color], true, scene(&[]));
            app.drawn("tone-map", &[app.current(chain)], false, full_screen(&[color, visor]));
        }
        app.show(&app.both(&eyes));
    });
    app.expect("scene", &looks(Eyes::Finer));
    app.expect("visor", &Err(Unmatched::After));
}

/// Panels of frosted glass, and drops on a visor: drawn over the picture without depth, and made of the scene.
#[test]
fn an_interface_over_the_picture_that_samples_the_scene() {
    for is_last in [false, true] {
        let mut app = Application::default();
        let eyes = app.eyes();
        let [color, blurred, mapped] = [HDR, HDR, LDR].map(|format| app.image(EYE, format));
        app.run(8, |app| {
            for chain in &eyes {
                app.drawn("scene", &[color], true, scene(&[]));
                app.drawn("blur", &[blurred], false, full_screen(&[color]));
                let target = if is_last { app.current(chain) } else { mapped };
                app.drawn("tone-map", &[target], false, full_screen(&[color]));
                app.drawn_over("panels", target, scene(&[blurred]));
                if !is_last {
                    app.drawn("upscale", &[app.current(chain)], false, full_screen(&[mapped]));
                }
            }
            app.show(&app.both(&eyes));
        });
        app.expect("scene", &looks(Eyes::Finer));
        if !is_last {
            app.expect("panels", &Err(Unmatched::After));
        }
    }
}

/// An API layer draws the application's swapchains into its own, and shows only these. An interface in a swapchain that nothing shows, drawn all
/// the same, is no eye.
#[test]
fn swapchains_that_an_api_layer_shows_in_its_own() {
    for copies in [false, true] {
        let mut app = Application::default();
        let [own, interface] = [app.eyes(), app.eyes()];
        let eyes = app.eyes();
        app.run(12, |app| {
            for ((drawn, panel), shown) in own.iter().zip(&interface).zip(&eyes) {
                let (from, to) = (app.current(drawn), app.current(shown));
                app.drawn("panel", &[app.current(panel)], true, scene(&[]));
                app.drawn("scene", &[from], true, scene(&[]));
                match copies {
                    true => app.copy(from, to),
                    false => app.drawn("layer", &[to], false, full_screen(&[from])),
                }
            }
            app.show(&app.both(&eyes));
        });
        let outcomes = app.outcomes("scene");
        let last = outcomes.last().unwrap().1.as_ref().unwrap();
        assert_eq!(last.how, if copies { How::Transferred } else { How::Shape });
        assert!(app.outcomes("panel").iter().all(|(_, outcome)| outcome.is_err()));
    }
}
