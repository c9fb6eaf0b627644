//! `cargo dev bench models`: the table of hard cases, then what each model costs.

#[path = "models/audio.rs"]
mod audio;
#[path = "models/avpm.rs"]
mod avpm;
#[path = "models/chroma.rs"]
mod chroma;
#[path = "models/geometry.rs"]
mod geometry;
#[path = "models/perception.rs"]
mod perception;
#[path = "models/plan.rs"]
mod plan;
#[path = "models/schedule.rs"]
mod schedule;

use criterion::Criterion;
use parafovea_models::hard_cases;

fn main() {
    for case in hard_cases::table() {
        println!("{case}");
    }
    let mut criterion = Criterion::default().configure_from_args();
    for group in [
        audio::benches,
        avpm::benches,
        chroma::benches,
        geometry::benches,
        perception::benches,
        plan::benches,
        schedule::benches,
    ] {
        group(&mut criterion);
    }
    criterion.final_summary();
}
