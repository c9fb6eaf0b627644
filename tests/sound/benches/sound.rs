//! `cargo dev bench sound [--json]`: cost and latency of sound capture.

use anyhow::Result;
use parafovea_sound::measure::{callback_us, capture_cost, latencies_s, percentile};
use std::time::Duration;

fn main() -> Result<()> {
    // `cargo bench` adds `--bench`.
    let json = std::env::args().any(|argument| argument == "--json");
    let print = |case: &str, metric: &str, value: f64, unit: &str| {
        if json {
            let line = serde_json::json!({
                "bench": "sound", "app": "hello_xr", "case": case, "metric": metric, "value": value, "unit": unit,
            });
            println!("{line}");
        } else {
            println!("{case:<34} {metric:<22} {value:>9.3} {unit}");
        }
    };
    let callback = callback_us(100_000)?;
    for (metric, share) in [("median", 0.5), ("99th percentile", 0.99), ("99.9th percentile", 0.999)] {
        print("callback, 10 ms of stereo", metric, percentile(&callback, share), "us of thread CPU");
    }
    let cost = capture_cost(Duration::from_secs(20))?;
    print("capture, stereo at 48 kHz", "CPU", 100.0 * cost.core_share, "% of a core");
    let latencies = latencies_s(30)?;
    for (metric, share) in [("least", 0.0), ("median", 0.5), ("greatest", 1.0)] {
        print("from playing to the plan", metric, 1000.0 * percentile(&latencies, share), "ms");
    }
    Ok(())
}
