//! `cargo dev bench safety`: cost of the safety limits while the eyes move, and loss at the true gaze.

use parafovea_models::safety;

fn main() {
    println!("{}", safety::table(&safety::rows()));
}
