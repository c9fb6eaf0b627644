//! `cargo dev bench models`: the table of hard cases, accuracy of gaze tracking, fragments that sound saves in our scenes, and the cost of
//! each model.

#[path = "models/audio.rs"]
mod audio;
#[path = "models/audio_visual.rs"]
mod audio_visual;
#[path = "models/avpm.rs"]
mod avpm;
#[path = "models/chroma.rs"]
mod chroma;
#[path = "models/gaze.rs"]
mod gaze;
#[path = "models/geometry.rs"]
mod geometry;
#[path = "models/json.rs"]
mod json;
#[path = "models/perception.rs"]
mod perception;
#[path = "models/plan.rs"]
mod plan;
#[path = "models/scene.rs"]
mod scene;
#[path = "models/schedule.rs"]
mod schedule;

use criterion::Criterion;
use parafovea_models::audio_visual as av;
use parafovea_models::{eyes, hard_cases};
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    if std::env::args().any(|argument| argument == json::FLAG) {
        return json::print();
    }
    if std::env::var_os(json::TIMES_ONLY).is_none() {
        print_tables();
    }
    // Short: dozens of functions, each of which is called millions of times in that second.
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    for group in [
        audio::benches,
        avpm::benches,
        chroma::benches,
        gaze::benches,
        geometry::benches,
        perception::benches,
        plan::benches,
        scene::benches,
        schedule::benches,
    ] {
        group(&mut criterion);
    }
    criterion.final_summary();
    ExitCode::SUCCESS
}

fn print_tables() {
    for case in hard_cases::table() {
        println!("{case}");
    }
    // Not in a test: `tests/gaze.rs` asserts the same.
    if std::env::args().any(|argument| argument == "--bench") {
        println!("\n{}", eyes::table(&eyes::rows()));
        println!("\n{}", av::table(&av::rows(&audio_visual::scenes())));
    }
}
