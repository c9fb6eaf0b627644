//! `cargo dev bench safety`: what the safety limits cost while the eyes move, and what is lost at the true gaze.

use parafovea_models::safety;

fn main() {
    println!("{}", safety::table(&safety::rows()));
}
