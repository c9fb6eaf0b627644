//! The effect of re-use on the images of our scene, against the images without the layer.

use glam::{Vec2, Vec3};
use parafovea_core::geometry::{Fov, eccentricity};
use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
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

/// Nothing moves: re-used tiles equal rendered ones.
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

/// Images of a narrower field of view are made of images of a wider one, and match the reference again once all of them are narrow.
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

/// Content that moved while its tile was not rendered is not visible at its old place.
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

/// With changing content rendered at once, and without.
fn config_of_refresh(refresh: bool) -> String {
    format!("{}refresh = {refresh}\n", config("on"))
}

/// People who walk in the periphery are not visible at their earlier positions.
#[test]
fn moving_content_is_rendered_at_once() {
    let frames = RUN_UP + 14;
    let saved: Vec<u64> = (frames - 6..frames).collect();
    let scenario = Scenario::new(frames).sized(320, 320).saving(&saved);
    let run = Run::new(&application(&["--scene", "crowd"]), &scenario).counted();
    let off = finish(run.clone(), frames);
    let [without, with] =
        [false, true].map(|refresh| finish(run.clone().on(&config_of_refresh(refresh)), frames));
    let samples = [&off, &without, &with].map(|run| run.samples().unwrap());
    let errors = [&without, &with].map(|on| error(&off, on, &saved));
    println!("mean squared error {errors:.3?}, of samples {samples:?}");
    assert!(errors[1] <= 0.6 * errors[0], "{errors:?}\n{}", with.log);
    assert!(samples[1] < samples[2] && samples[2] < samples[0], "{samples:?}");
}

/// Without motion in the scene, tiles are rendered only in their turn, whether the head turns or not.
#[test]
fn content_at_rest_follows_the_schedule() {
    let frames = RUN_UP + 14;
    for speed in [0.0, 60.0] {
        let scenario = turning(Scenario::new(frames).sized(320, 320), speed);
        let run = Run::new(&application(&["--still"]), &scenario).counted();
        let samples = [false, true]
            .map(|refresh| finish(run.clone().on(&config_of_refresh(refresh)), frames).samples().unwrap());
        println!("{samples:?} samples at {speed} degrees a second");
        assert!(
            samples[1] as f64 <= samples[0] as f64 * if speed == 0.0 { 1.0 } else { 1.05 },
            "{samples:?}"
        );
    }
}

/// Nothing lit is left in the second frame after the lights go out.
#[test]
fn a_cut_renders_everything() {
    let cut = RUN_UP + 4;
    let frames = cut + 6;
    let saved: Vec<u64> = (cut..frames).collect();
    let scenario = Scenario::new(frames).sized(256, 224).saving(&saved);
    let out = cut.to_string();
    let run = Run::new(&application(&["--still", "--lights-out", &out]), &scenario);
    let (off, on) = (finish(run.clone(), frames), finish(run.on(&config("on")), frames));
    let errors: Vec<f64> = saved.iter().map(|frame| error(&off, &on, &[*frame])).collect();
    println!("mean squared errors {errors:.2?}");
    assert!(errors[0] > 10.0, "the first frame cannot know: {errors:?}");
    assert!(errors[3..].iter().all(|error| *error < 0.1), "{errors:?}");
}

/// Other swapchains in mid-run start without history: nothing old is shown, and re-use goes on with the new ones.
#[test]
fn swapchains_may_change() {
    let changed = RUN_UP + 4;
    let frames = changed + 24;
    let saved: Vec<u64> = (changed - 2..changed + 8).chain(frames - 4..frames).collect();
    let at = changed.to_string();
    for arguments in [
        &["--change-to", "double-wide"][..],
        &["--swapchain", "array", "--change-to", "separate"],
        &["--change-size", "192x160"],
    ] {
        let arguments = [&["--change-at", &at], arguments].concat();
        let scenario = turning(Scenario::new(frames).sized(256, 224).saving(&saved), 30.0);
        let run = Run::new(&application(&arguments), &scenario).counted();
        let (off, on) = (finish(run.clone(), frames), finish(run.on(&config("on")), frames));
        let share = on.samples().unwrap() as f64 / off.samples().unwrap() as f64;
        assert!(share < 0.9, "{share} of the samples with {arguments:?}\n{}", on.log);
        for (view, &frame) in (0..2).flat_map(|view| saved.iter().map(move |frame| (view, frame))) {
            let (off, on) = (off.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
            if frame == changed {
                assert!(off == on, "view {view} of the first frame with {arguments:?}");
            }
            let psnr_db = psnr_db(&off, &on, |_, _| true);
            assert!(psnr_db >= 30.0, "{psnr_db} dB in view {view} of frame {frame} with {arguments:?}");
        }
    }
}

/// A session after the first one starts without history, on the same device, and re-uses too.
#[test]
fn sessions_may_follow_each_other() {
    let frames = RUN_UP + 10;
    let all = 2 * frames;
    let saved: Vec<u64> = (frames..frames + 8).chain(all - 4..all).collect();
    let scenario = turning(Scenario::new(frames).sized(256, 224).saving(&saved), 30.0);
    let run = Run::new(&application(&["--sessions", "2"]), &scenario).counted();
    let (off, on) = (finish(run.clone(), all), finish(run.on(&config("on")), all));
    let share = on.samples().unwrap() as f64 / off.samples().unwrap() as f64;
    assert!(share < 0.9, "{share} of the samples\n{}", on.log);
    for (view, &frame) in (0..2).flat_map(|view| saved.iter().map(move |frame| (view, frame))) {
        let (off, on) = (off.submitted(view, frame).unwrap(), on.submitted(view, frame).unwrap());
        if frame < frames + 2 {
            assert!(off == on, "view {view} of frame {frame}");
        }
        let psnr_db = psnr_db(&off, &on, |_, _| true);
        assert!(psnr_db >= 30.0, "{psnr_db} dB in view {view} of frame {frame}");
    }
}

/// A head that moves to the right.
fn moving(scenario: Scenario, metres_per_s: f32) -> Scenario {
    let head = |t: f64| Head {
        t,
        position: [metres_per_s * (t - RUN_UP as f64 / HZ) as f32, 0.0, 0.0],
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    };
    Scenario { head: vec![head(0.0), head(2.0)], ..scenario }
}

/// The share of tiles that are rendered, after the run-up, by the maps of the passes.
fn rendered(outcome: &Outcome, frames: u64) -> f64 {
    let passes = outcome.shading_rates().unwrap().into_iter().filter_map(|line| match line {
        ShadingRateLine::Pass(pass) => pass.map,
        ShadingRateLine::Finding(finding) => panic!("{finding:?}"),
    });
    let maps: Vec<_> = passes.collect();
    let known = &maps[maps.len() * RUN_UP as usize / frames as usize..];
    let count = |is_counted: fn(&str) -> bool| -> f64 {
        let rates = known.iter().flat_map(|map| &map.histogram);
        rates.filter(|(rate, _)| is_counted(rate)).map(|(_, count)| f64::from(*count)).sum()
    };
    count(|rate| rate == "1x1") / count(|_| true)
}

/// Near content is found at its place as the head moves, if the application submits depth: as much is re-used as at rest.
#[test]
fn near_content_is_followed_by_its_depth() {
    const CONFIG: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\nbackend = \"attachment\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";
    let frames = RUN_UP + 12;
    let saved: Vec<u64> = (RUN_UP + 3..frames).collect();
    let run = |arguments: &[&str], metres_per_s: f32, saved: &[u64]| {
        let mut scenario = moving(Scenario::new(frames).sized(320, 320).saving(saved), metres_per_s);
        scenario.clock.refresh_hz = HZ;
        Run::new(&application(arguments), &scenario).shading_rates(ShadingRateProfile::NvkTuring)
    };
    for arrangement in ["separate", "array", "double-wide"] {
        let arguments = ["--still", "--depth-layer", "--swapchain", arrangement];
        let off = finish(run(&arguments, 0.8, &saved), frames);
        let followed = finish(run(&arguments, 0.8, &saved).on(CONFIG), frames);
        let error = error(&off, &followed, &saved);
        println!("mean squared error {error:.2} with {arrangement} swapchains");
        assert!(followed.log.contains("used for reprojection of head movement"), "{}", followed.log);
        assert!(error <= 20.0, "{error} with {arrangement} swapchains");
    }
    // Without pictures, which are saved in passes of their own.
    let (with, without) = (["--still", "--depth-layer"], ["--still"]);
    let shares = [(&with[..], 0.0), (&with, 0.8), (&without, 0.8)]
        .map(|(arguments, speed)| rendered(&finish(run(arguments, speed, &[]).on(CONFIG), frames), frames));
    println!("rendered {shares:.3?}");
    assert!(shares[0] < 0.7 && shares[1] <= 1.05 * shares[0] && shares[2] > 1.3 * shares[1], "{shares:?}");
}

/// Tone mapping reads the scene by a set that an update template wrote: it is known to read nothing of earlier frames.
#[test]
fn passes_with_sets_from_update_templates_allow_it() {
    let frames = RUN_UP + 12;
    let arguments = ["--style", "offscreen-tonemap", "--size", "320", "--frames", &frames.to_string()];
    let tone_mapped = Application::ours("parafovea-zoo", &arguments).unwrap();
    let run = Run::new(&tone_mapped, &Scenario::new(frames).sized(320, 320));
    let outcome = finish(run.on(&config("on")).counted(), frames);
    assert!(!outcome.log.contains("may read images of earlier frames"), "{}", outcome.log);
    assert!(outcome.log.contains("scene passes of 320x320: masked"), "{}", outcome.log);
}
