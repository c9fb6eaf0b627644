//! The layer's effect on the images of hello_xr and of our scene, pixel by pixel.

use glam::Vec3;
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::color::linear_to_srgb;
use parafovea_core::kernels::compose::{ComposeParams, PixelFormat, compose_image};
use parafovea_tests::compare::{luminance, max_difference};
use parafovea_tests::demo::EyeView;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const OFF: &str = "preset = \"none\"\n";
/// The device is armed, and every rate is 1x1.
const ARMED: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"off\"\n";
const CHROMA: &str =
    "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

struct Subject {
    application: Application,
    frames: u64,
    /// The last is late enough for the gaze to be known.
    saved: [u64; 2],
}

fn hello_xr() -> Subject {
    Subject { application: Application::hello_xr("Vulkan2").unwrap(), frames: 60, saved: [0, 55] }
}

fn scene() -> Subject {
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    Subject { application, frames: 12, saved: [0, 10] }
}

impl Subject {
    /// Eyes whose views differ, and look aside.
    fn scenario(&self) -> Scenario {
        let mut scenario = Scenario::new(self.frames).sized(320, 288).gazing(14.0, -6.0).saving(&self.saved);
        (scenario.views[0].fov_deg.left, scenario.views[1].fov_deg.right) = (-54.0, 54.0);
        scenario
    }

    fn run(&self, config: Option<&str>) -> Outcome {
        let run = Run::new(&self.application, &self.scenario());
        let run = match config {
            Some(config) => run.on(config),
            None => run,
        };
        run.finish().unwrap().expect_frames(self.frames).unwrap()
    }

    fn pictures(&self, outcome: &Outcome) -> Vec<Picture> {
        let saved = self.saved.iter().flat_map(|frame| [(0, *frame), (1, *frame)]);
        saved.map(|(view, frame)| outcome.submitted(view, frame).unwrap()).collect()
    }
}

#[test]
fn hello_xr_with_every_technique_off() {
    with_every_technique_off(&hello_xr());
}

#[test]
fn the_scene_with_every_technique_off() {
    with_every_technique_off(&scene());
}

/// Nothing is substituted, and no bit changes.
fn with_every_technique_off(subject: &Subject) {
    let reference = subject.run(None);
    for config in [OFF, ARMED] {
        let off = subject.run(Some(config));
        if config == OFF {
            assert_eq!(reference.record.created(), off.record.created(), "swapchains");
        }
        for (expected, picture) in subject.pictures(&reference).iter().zip(subject.pictures(&off)) {
            assert_eq!(max_difference(expected, &picture, |_, _| true), 0, "{config}");
        }
    }
}

#[test]
fn hello_xr_with_chroma_attenuation() {
    with_chroma_attenuation(&hello_xr());
}

#[test]
fn the_scene_with_chroma_attenuation() {
    with_chroma_attenuation(&scene());
}

fn with_chroma_attenuation(subject: &Subject) {
    let (reference, on) = (subject.run(None), subject.run(Some(CHROMA)));
    let views = EyeView::of_scenario(&subject.scenario());
    for (view, eye) in views.iter().enumerate() {
        let frame = subject.saved[1];
        let (before, after) = (reference.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
        assert_ne!(before, after, "nothing was attenuated\n{}", on.log);
        plateau_and_alpha_are_the_same(eye, &before, &after);
        luminance_is_the_same(&before, &after);
        equals_the_cpu_twin(eye, &before, &after);
    }
}

fn plateau_and_alpha_are_the_same(eye: &EyeView, before: &Picture, after: &Picture) {
    let plateau = ChromaSettings::default().plateau_deg;
    let mut inside = 0;
    for (x, y, pixel) in before.enumerate() {
        assert_eq!(pixel[3], after.at(x, y)[3], "alpha at {x}, {y}");
        // A pixel on the very edge may be rounded to either side.
        if eye.eccentricity_deg(before, x, y) < plateau - 1e-3 {
            inside += 1;
            assert_eq!(pixel, after.at(x, y), "inside the plateau at {x}, {y}");
        }
    }
    assert!(inside > 500, "the plateau has {inside} pixels only");
}

/// Within one code value once it is encoded as sRGB.
fn luminance_is_the_same(before: &Picture, after: &Picture) {
    let code = |pixel| linear_to_srgb(luminance(pixel) as f32) * 255.0;
    for (x, y, pixel) in before.enumerate() {
        let difference = (code(pixel) - code(after.at(x, y))).abs();
        assert!(
            difference <= 1.0,
            "luminance differs by {difference} at {x}, {y}: {pixel:?} {:?}",
            after.at(x, y)
        );
    }
}

fn equals_the_cpu_twin(eye: &EyeView, before: &Picture, after: &Picture) {
    let extent = [before.width, before.height];
    let params = ComposeParams::new([0, 0], extent, eye.fov, eye.gaze, &ChromaSettings::default(), true);
    let mut twin = before.clone();
    compose_image(twin.pixels.as_flattened_mut(), before.width, PixelFormat::Rgba8Srgb, &params);
    assert!(params.pixel(0, 0, Vec3::ONE).is_some(), "the corner is attenuated");
    assert!(max_difference(&twin, after, |_, _| true) <= 1);
}
