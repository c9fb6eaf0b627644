//! The share of pixels that the update schedule renders, as the device counts them, against the table of paper B ("Evaluating Foveated
//! Frame Rate Reduction in Virtual Reality for Head-Mounted Displays").

use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{FovDegrees, Scenario, ScenarioExt};

/// The display that the paper's table fits best: this large, and 110.5 degrees high.
const SIZE: [u32; 2] = [1440, 1600];

/// From this frame on every swapchain image is drawn to with a mask.
const FROM: u64 = 20;

/// Samples that an application of one fragment a pixel shades in so many frames.
fn shaded(config: &str, frames: u64) -> u64 {
    let [width, height] = SIZE;
    let (size, count) = (format!("{width}x{height}"), frames.to_string());
    let arguments =
        ["shade", "--style", "dynamic-rendering", "--iterations", "0", "--size", &size, "--frames", &count];
    let application = Application::ours("parafovea-overhead", &arguments).unwrap();
    let up = 55.25f32;
    let right = (up.to_radians().tan() * width as f32 / height as f32).atan().to_degrees();
    let mut scenario = Scenario::new(frames).sized(width, height);
    for view in &mut scenario.views {
        view.fov_deg = FovDegrees { left: -right, right, up, down: -up };
    }
    let outcome = Run::new(&application, &scenario).counted().on(config).finish().unwrap();
    outcome.expect_frames(frames).unwrap().samples().unwrap()
}

/// So many pixels, percent of a frame's.
fn percent(pixels: u64) -> f64 {
    100.0 * pixels as f64 / f64::from(2 * SIZE[0] * SIZE[1])
}

/// The share of the pixels that is shaded in a frame, percent, over so many frames.
fn share(config: &str, frames: u64) -> f64 {
    percent(shaded(config, FROM + frames) - shaded(config, FROM)) / frames as f64
}

/// Compares configurations with the paper's shares: each with that share, percent, and the frames after which it repeats. By tiles of 16
/// pixels instead of by pixels it is up to half a point more (`cargo test -p parafovea-core tiles_cost -- --nocapture`).
fn shade_what_the_table_says(table: &[(&str, f64, u64)]) {
    for &(periods, paper, frames) in table {
        let config = format!(
            "preset = \"paper\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[reuse]\nmode = \"paper\"\n\
             periods = \"{periods}\"\n"
        );
        let share = share(&config, frames);
        println!("{periods}: {share:.2} % shaded, {paper} % in the paper");
        assert!((share - paper).abs() < 1.0, "{periods}: {share} % for {paper} %");
    }
}

#[test]
fn the_paper_s_configurations_of_up_to_two_frames_shade_what_its_table_says() {
    shade_what_the_table_says(&[
        ("11111", 100.0, 1),
        ("11112", 57.6, 2),
        ("11122", 52.2, 2),
        ("12222", 50.2, 2),
    ]);
}

#[test]
fn the_paper_s_configurations_of_up_to_three_frames_shade_what_its_table_says() {
    shade_what_the_table_says(&[("11223", 36.4, 6), ("11233", 34.6, 6), ("12233", 34.4, 6)]);
}

/// The paper's 60 frames are a multiple of all of them.
#[test]
fn the_paper_s_configurations_of_up_to_five_frames_shade_what_its_table_says() {
    shade_what_the_table_says(&[("12234", 27.3, 12), ("12334", 26.7, 12), ("12345", 21.5, 60)]);
}

/// Patches that take turns cost more than the paper's regions, because a tile is rendered when any direction in it is; in return
/// no frame renders everything.
#[test]
fn the_worst_frame_of_patches_that_take_turns_is_like_the_others() {
    let config = "preset = \"balanced\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[reuse]\n\
                  mode = \"on\"\nperiods = \"11223\"\nbelow_30_hz = true\n";
    // Their pattern repeats after six frames.
    let sums: Vec<u64> = (FROM..=FROM + 6).map(|frames| shaded(config, frames)).collect();
    let shares: Vec<f64> = sums.windows(2).map(|pair| percent(pair[1] - pair[0])).collect();
    let mean = shares.iter().sum::<f64>() / 6.0;
    let worst = shares.iter().copied().fold(0.0, f64::max);
    println!("11223 staggered: {mean:.2} % shaded, {worst:.2} % in the worst of {shares:.2?}");
    assert!((36.4..50.0).contains(&mean) && worst <= 1.2 * mean, "{mean} {shares:?}");
}
