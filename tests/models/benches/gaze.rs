//! `cargo dev bench gaze`: errors of the gaze at display time.

use parafovea_models::prediction;

fn main() {
    print!("{}", prediction::table(&prediction::rows()));
}
