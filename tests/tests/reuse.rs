//! What re-use does to the pictures of our scene, against those without the layer.

use glam::{Vec2, Vec3};
use parafovea_core::geometry::{Fov, eccentricity};
use parafovea_tests::compare::{max_difference, psnr_db};
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Head, Scenario, ScenarioExt, Zoom};

/// Frames until passes are known and every swapchain image has had its turn.
const RUN_UP: u64 = 20;
const HZ: f64 = 90.0;
/// Frames until everything was rendered once.
const PERIOD: u64 = 3;

fn config(mode: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"{mode}\"\n"
    )
}

fn application(arguments: &[&str]) -> Application {
    Application::ours("parafovea-scene", arguments).unwrap()
}

/// A head that turns to the left.
fn turning(scenario: Scenario, degrees_per_s: f32) -> Scenario {
    let head = |t: f64| Head {
        t,
        position: [0.0; 3],
        yaw_deg: degrees_per_s * (t - RUN_UP as f64 / HZ) as f32,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    };
    Scenario { head: vec![head(0.0), head(2.0)], ..scenario }
}

fn finish(run: Run, frames: u64) -> Outcome {
    run.finish().unwrap().expect_frames(frames).unwrap()
}

/// Nothing moves: what is re-used is what would be rendered.
#[test]
fn a_still_scene_stays_as_it_is() {
    let frames = RUN_UP + 8;
    let saved: Vec<u64> = (RUN_UP..frames).collect();
    let scenario = Scenario::new(frames).sized(256, 224).saving(&saved);
    let run = Run::new(&application(&["--still"]), &scenario).counted();
    let (off, on) = (finish(run.clone(), frames), finish(run.clone().on(&config("on")), frames));
    let share = on.samples().unwrap() as f64 / off.samples().unwrap() as f64;
    // The run-up renders everything.
    assert!(share < 0.85, "{share} of the samples\n{}", on.log);
    for (view, &frame) in (0..2).flat_map(|view| saved.iter().map(move |frame| (view, frame))) {
        let (off, on) = (off.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
        let difference = max_difference(&off, &on, |_, _| true);
        assert!(difference <= 1, "{difference} in view {view} of frame {frame}");
    }
}

/// Mean squared error of the pixels that are farther than 10 degrees from the middle, over the last frames of the run.
fn error(off: &Outcome, on: &Outcome, saved: &[u64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (view, &frame) in (0..2).flat_map(|view| saved.iter().map(move |frame| (view, frame))) {
        let (off, on) = (off.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
        for (x, y, pixel) in off.enumerate().filter(|(x, y, _)| is_outside(&off, *x, *y)) {
            for (off, on) in pixel.into_iter().zip(on.at(x, y)).take(3) {
                sum += f64::from(off.abs_diff(on)).powi(2);
                count += 1.0;
            }
        }
    }
    sum / count
}

fn is_outside(picture: &Picture, x: u32, y: u32) -> bool {
    let edge = std::f32::consts::FRAC_PI_4;
    let fov = Fov { left: -edge, right: edge, up: edge, down: -edge };
    let plane = fov.tangents().plane([picture.width, picture.height]);
    eccentricity(plane.direction(Vec2::new(x as f32, y as f32) + 0.5), Vec3::NEG_Z).to_degrees() > 10.0
}

/// Of a turning head re-projection leaves a quarter of the error at most.
#[test]
fn a_turning_head_sees_the_world_stand_still() {
    let frames = RUN_UP + 9;
    let saved: Vec<u64> = (RUN_UP..frames).collect();
    let scenario = turning(Scenario::new(frames).sized(512, 512).saving(&saved), 100.0);
    let run = Run::new(&application(&["--still"]), &scenario);
    let off = finish(run.clone(), frames);
    let [paper, turned] =
        ["paper", "on"].map(|mode| error(&off, &finish(run.clone().on(&config(mode)), frames), &saved));
    println!("mean squared error {paper:.1} without re-projection, {turned:.1} with it");
    assert!(turned <= paper / 4.0, "{turned} of {paper}");
}

/// Pictures of a narrower field of view are made of those of a wider one, and are the very same once all of them are narrow.
#[test]
fn a_field_of_view_may_change() {
    let changed = RUN_UP + 3;
    let frames = changed + 8;
    let saved: Vec<u64> = (RUN_UP..frames).collect();
    let mut scenario = Scenario::new(frames).sized(256, 224).saving(&saved);
    scenario.clock.refresh_hz = HZ;
    // The first frame's time is 0, and each has its own: half a frame before it is before no other.
    scenario.zoom = vec![Zoom { t: (changed as f64 - 0.5) / HZ, scale: 0.8 }];
    let run = Run::new(&application(&["--still"]), &scenario).counted();
    let (off, on) = (finish(run.clone(), frames), finish(run.on(&config("on")), frames));
    assert!(on.samples().unwrap() < off.samples().unwrap());
    for (view, &frame) in (0..2).flat_map(|view| saved.iter().map(move |frame| (view, frame))) {
        let (off, on) = (off.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
        let is_changing = (changed..changed + PERIOD).contains(&frame);
        let bound_db = if is_changing { 30.0 } else { 48.0 };
        let psnr_db = psnr_db(&off, &on, |_, _| true);
        assert!(psnr_db >= bound_db, "{psnr_db} dB in view {view} of frame {frame}");
    }
}

/// What moved while nothing was rendered is not seen where it was before.
#[test]
fn a_pause_leaves_nothing_old() {
    let frames = RUN_UP + 40;
    let pause: Vec<u64> = (RUN_UP..RUN_UP + 30).collect();
    let resumed = RUN_UP + 30;
    let mut scenario = turning(Scenario::new(frames).sized(256, 224).saving(&[resumed]), 60.0);
    scenario.session.should_render_off = pause;
    let run = Run::new(&application(&[]), &scenario);
    let (off, on) = (finish(run.clone(), frames), finish(run.on(&config("on")), frames));
    for view in 0..2 {
        let (off, on) = (off.submitted(view, resumed).unwrap(), on.submitted(view, resumed).unwrap());
        assert!(off == on, "view {view}");
    }
}
