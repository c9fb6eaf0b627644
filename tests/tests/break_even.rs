//! The bench `break-even` runs, and more expensive pixels cost more.

use parafovea_tests::break_even::{WITH_RATES, application, points, rows};
use parafovea_tests::measure::Effort;
use parafovea_tests::run::Run;
use parafovea_tests::scenario::{Scenario, ScenarioExt};

#[test]
fn dearer_pixels_cost_more() {
    let effort = Effort { turns: 1, run_up: 2, frames: 18, size: 128 };
    let mut runs = 0;
    let points = points(&[0, 256], effort, WITH_RATES, |_| runs += 1).unwrap();
    assert_eq!(runs, 5, "one of nothing, two of each");
    let [cheap, dear] = &points[..] else { panic!("{points:?}") };
    // 256 rounds of 20 operations and more take a CPU at least 10 times as long as none.
    assert!(dear.ns > 10.0 * cheap.ns.max(1.0), "{} ns and {} ns", cheap.ns, dear.ns);
    let rows = rows(&points);
    let of = |metric: &str| rows.iter().filter(|row| row.metric == metric).count();
    assert_eq!((of("pixel"), of("cpu_median")), (2, 2));
    assert!(rows.iter().filter_map(|row| row.comparison).all(|comparison| comparison.ratio > 0.0));
}

/// A style without masks has no break-even.
#[test]
fn measured_frames_skip_pixels() {
    let effort = Effort { turns: 1, run_up: 0, frames: 60, size: 256 };
    let scenario = Scenario::new(effort.length()).sized(effort.size, effort.size);
    let samples = |config: &str| {
        let run = Run::new(&application(Some(1), effort).unwrap(), &scenario).on(config).counted();
        let outcome = run.finish().unwrap().expect_frames(effort.length()).unwrap();
        outcome.samples_after(effort.length() / 2).unwrap()
    };
    let (off, on) = (samples("enabled = false\n"), samples(WITH_RATES));
    assert!(off > 0 && (on as f64) < 0.9 * off as f64, "{on} of {off}");
}
