//! The hour of `cargo dev soak sound`, shortened.

use parafovea_sound::measure::capture_cost;
use std::time::Duration;

#[test]
fn listening_takes_no_more_and_more_memory() {
    let cost = capture_cost(Duration::from_secs(10)).unwrap();
    println!("{cost:?}");
    assert!(cost.resident_most <= cost.resident_first + (1 << 20), "{cost:?}");
    assert!(cost.sets >= 80, "{cost:?}");
}
