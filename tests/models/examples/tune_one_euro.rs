//! Parameters of the One Euro filter with which the region at full rate is smallest at 99 % hits, for trackers of 60 to 120 Hz:
//! the baseline of `cargo dev bench models`. The seeds differ from the reported ones. The cut-off of the speed begins at the 1
//! Hz of the filter's authors: with a slower one, speed does not show a saccade, and the region is not inflated.

use parafovea_models::eyes::{Method, Radius, TUNING_SEEDS, TrackerModel, follow};

const DURATION_S: f64 = 60.0;

fn main() {
    let mut found = Vec::new();
    for least_hz in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
        for beta in [0.005, 0.02, 0.05, 0.2, 0.5, 1.0, 2.0] {
            for speed_hz in [1.0, 3.0, 10.0, 30.0] {
                let parameters = [least_hz, beta, speed_hz];
                let area = |rate_hz: f64| {
                    let model = TrackerModel { rate_hz, tells_time: true };
                    let score = follow(Method::OneEuro(parameters), model, &TUNING_SEEDS, DURATION_S);
                    score.area_deg2(score.radius_for(0.99, Radius::Inflated))
                };
                found.push(([120.0, 90.0, 60.0].map(area).iter().sum::<f64>() / 3.0, parameters));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (area, [least_hz, beta, speed_hz]) in &found[..8] {
        println!("{area:.1} deg^2 with {least_hz} Hz, beta {beta}, speed {speed_hz} Hz");
    }
}
