//! `cargo dev bench rails`: what the safety rails cost while the eyes move, and what is lost at the true gaze.

use parafovea_models::rails;

fn main() {
    println!("{}", rails::table(&rails::rows()));
}
