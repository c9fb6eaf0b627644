//! The gaze tracker on synthetic gaze with known truth: the figures of `cargo dev bench models`, asserted.

use glam::{DVec3, Quat, Vec3};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazeSettings, GazeTracker};
use parafovea_core::geometry::Fov;
use parafovea_core::plan::{EyeInput, PlanInput, PlanSettings, Planner, RateSettings};
use parafovea_core::rate::ShadingRate;
use parafovea_models::eyes::{
    DURATION_S, EyePath, HALF_IPD_M, LATENCY_S, Method, Radius, SEEDS, Score, TUNED, TUNING_SEEDS,
    TrackerModel, follow, foveal_radii_deg, nanoseconds, union_area_deg2,
};

/// Rates that the aims hold for, Hz.
const RATES_HZ: [f64; 3] = [120.0, 90.0, 60.0];

fn score(method: Method, rate_hz: f64) -> Score {
    follow(method, TrackerModel { rate_hz, tells_time: true }, &SEEDS, DURATION_S)
}

#[test]
fn the_fixation_point_of_either_eye_is_at_full_rate() {
    let safety = Radius::Inflated(foveal_radii_deg()[0]);
    for rate_hz in RATES_HZ {
        for method in [Method::Tracker, Method::TrackerWithDepth] {
            let hits = score(method, rate_hz).hits(safety);
            assert!(hits > 0.998, "{} at {rate_hz} Hz: {hits}", method.name());
        }
        let without_times = TrackerModel { rate_hz, tells_time: false };
        let hits = follow(Method::Tracker, without_times, &SEEDS, DURATION_S).hits(safety);
        assert!(hits > 0.998, "without times at {rate_hz} Hz: {hits}");
    }
}

#[test]
fn no_distance_is_worse_off_than_the_aim() {
    let safety = Radius::Inflated(foveal_radii_deg()[0]);
    let score = score(Method::Tracker, 60.0);
    for distance in 0..4 {
        let hits = score.hits_at(safety, distance);
        assert!(hits > 0.997, "distance {distance}: {hits}");
    }
}

#[test]
fn the_area_at_full_rate_is_less_than_twice_a_perfect_tracker_s() {
    let [base, perfect_base] = foveal_radii_deg();
    for rate_hz in RATES_HZ {
        for (method, most, most_without_error) in [
            (Method::Tracker, 1.45, if rate_hz < 60.0 { 2.1 } else { 2.0 }),
            (Method::TrackerWithDepth, 1.2, 1.75),
        ] {
            let score = score(method, rate_hz);
            let area = score.area_deg2(Radius::Inflated(base));
            let ratios = [base, perfect_base].map(|base| area / score.perfect_area_deg2(base));
            let what = format!("{} at {rate_hz} Hz: {ratios:?}", method.name());
            assert!(ratios[0] < most && ratios[1] < most_without_error, "{what}");
        }
    }
}

#[test]
fn the_area_is_smaller_than_one_euro_s_and_the_unfiltered_at_the_same_hits() {
    let [base, _] = foveal_radii_deg();
    for rate_hz in RATES_HZ {
        let ours = score(Method::Tracker, rate_hz);
        for other in [Method::OneEuro(TUNED), Method::Unfiltered] {
            let theirs = score(other, rate_hz);
            let what = |case: &str| format!("{case} of {} at {rate_hz} Hz", other.name());
            for hits in [0.99, 0.999] {
                let area = |score: &Score| score.area_deg2(score.radius_for(hits, Radius::Inflated));
                assert!(area(&ours) < area(&theirs), "{}", what("inflated area"));
            }
            let fixed = |score: &Score| score.area_deg2(score.radius_for(0.99, Radius::Fixed));
            assert!(fixed(&ours) < fixed(&theirs), "{}", what("fixed area"));
            let soon = |score: &Score| score.area_deg2(score.radius_from_landing(0.98, Radius::Inflated));
            assert!(soon(&ours) < soon(&theirs), "{}", what("area from landing on"));
            let safety = Radius::Inflated(base);
            assert!(
                ours.area_deg2(safety) < 0.9 * theirs.area_deg2(safety),
                "{}",
                what("safety limits' area")
            );
        }
    }
}

/// Through the planner and its tiles: the tile of each eye's view that its gaze falls on is at 1x1.
#[test]
fn the_tile_that_either_eye_looks_at_is_1x1_in_the_plan() {
    const SIDE: u32 = 512;
    let canted = [0.08f32, -0.08].map(Quat::from_rotation_y);
    let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
    let model = TrackerModel { rate_hz: 120.0, tells_time: true };
    let (seed, seconds) = (SEEDS[0], 30.0);
    let path = EyePath::new(seed, seconds);
    let reports = model.reports(&path, seed, seconds);
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let map = FixedFoveation { foveal_deg: 0.0, ..FixedFoveation::L1_C1 };
    let mut planner =
        Planner::new(PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() });
    let eyes_m = [-HALF_IPD_M, HALF_IPD_M].map(|x| Vec3::X * x as f32);
    let (mut next, mut looked, mut missed, mut coarse) = (0, 0, 0, 0.0);
    for frame in 0..(seconds * 90.0) as u64 {
        let shown = frame as f64 / 90.0;
        while let Some(report) = reports.get(next).filter(|report| report.known_s <= shown) {
            tracker.push_at(&report.sample, nanoseconds(shown));
            next += 1;
        }
        let eye = |index: usize| EyeInput {
            offset: [0, 0],
            extent: [SIDE; 2],
            fov,
            orientation: canted[index],
            contrast: None,
            refresh: false,
        };
        let plan = planner.plan(&PlanInput {
            time_ns: nanoseconds(shown),
            frame,
            frame_rate_hz: 90.0,
            eyes: [eye(0), eye(1)],
            head: Quat::IDENTITY,
            gaze: tracker.state(nanoseconds(shown)).with_vergence(eyes_m, None),
            audio: None,
        });
        if shown < 1.0 || !path.counts(shown, LATENCY_S + 1.0 / 120.0 + 1.0 / 90.0) {
            continue;
        }
        for (index, truth) in path.eyes_at(shown).into_iter().enumerate() {
            let view: DVec3 = canted[index].as_dquat().inverse() * truth;
            let tangent = 0.8f64.tan();
            let pixel =
                [view.x, -view.y].map(|along| (along / -view.z / tangent + 1.0) * 0.5 * f64::from(SIDE));
            let [x, y] = plan.eyes[index].tile_of(pixel.map(|pixel| pixel as u32));
            looked += 1;
            missed += u32::from(plan.eyes[index].rate(x, y) != ShadingRate::R1X1);
            coarse += f64::from(1.0 - plan.eyes[index].statistics().mean_rate);
        }
    }
    assert!(looked > 2000 && f64::from(missed) < 0.005 * f64::from(looked), "{missed} of {looked}");
    assert!(coarse / f64::from(looked) > 0.5, "most of the view is coarse: {}", coarse / f64::from(looked));
}

/// The path has the properties that the measure relies on.
#[test]
fn the_synthetic_gaze_is_that_of_eyes() {
    for seed in SEEDS {
        assert!(!TUNING_SEEDS.contains(&seed));
        let path = EyePath::new(seed, DURATION_S);
        let (mut saccades, mut pursuits, mut peak_of_15) = (0, 0, Vec::new());
        for (number, look) in path.looks().iter().enumerate().skip(1) {
            let amplitude = path.amplitude_deg(number);
            assert!((0.35..=30.1).contains(&amplitude), "{amplitude}");
            saccades += 1;
            pursuits += u32::from(look.is_pursuit());
            let (leaves, lands) = (path.looks()[number - 1].end_s, look.start_s);
            let step = 1e-3;
            let speed = |t: f64| path.at(t).0.angle_between(path.at(t + step).0).to_degrees() / step;
            let steps = ((lands - leaves) / step) as u32;
            let peak = (0..steps).map(|index| speed(leaves + f64::from(index) * step)).fold(0.0, f64::max);
            assert!(peak < 720.0, "{peak} degrees a second in {amplitude} degrees");
            if (13.0..17.0).contains(&amplitude) {
                peak_of_15.push(peak);
            }
            let during = 0.5 * (look.start_s + look.end_s);
            assert!(speed(during) < 31.0, "{} degrees a second while looking", speed(during));
        }
        assert!(saccades > 150 && pursuits > 30, "{saccades} saccades, {pursuits} pursuits");
        let mean = peak_of_15.iter().sum::<f64>() / peak_of_15.len() as f64;
        assert!((430.0..560.0).contains(&mean), "{mean} degrees a second at 15 degrees");
    }
}

#[test]
fn one_region_of_both_eyes_is_what_geometry_says() {
    // Far apart: two caps, each of 2 pi (1 - cos r).
    let square = (180.0 / std::f64::consts::PI).powi(2);
    let cap = std::f64::consts::TAU * (1.0 - 5f64.to_radians().cos()) * square;
    assert!((union_area_deg2(5.0, 11.0) / (2.0 * cap) - 1.0).abs() < 1e-12);
    assert!((union_area_deg2(5.0, 0.0) / cap - 1.0).abs() < 1e-12);
}

/// The table of `cargo dev bench gaze`, at four of its lines: the eye movements equal the committed table's; errors are below the
/// earlier tracker's where a sample shows a saccade, and nowhere above.
#[test]
fn the_gaze_at_display_time_is_nearer_to_the_eyes_than_before() {
    use parafovea_models::prediction::{Frames, Predictor, SEEDS, before, measure};
    for (rate_hz, delay_ms) in [(20.0, 30.0), (60.0, 50.0), (120.0, 10.0), (240.0, 80.0)] {
        let before = before(rate_hz, delay_ms).expect("a line of tests/baselines/gaze.md");
        let newest = measure(Predictor::NewestSample, rate_hz, delay_ms, &SEEDS).mean_deg(Frames::Saccades);
        assert!(
            (newest - before.newest_sample_deg).abs() < 0.001,
            "other eye movements: {newest}, {before:?}"
        );
        let now = measure(Predictor::Tracker, rate_hz, delay_ms, &SEEDS);
        let ratios: Vec<f64> = Frames::ALL
            .iter()
            .zip(before.tracker_deg)
            .map(|(frames, before)| now.mean_deg(*frames) / before)
            .collect();
        let most = [0.95, 0.75, 1.0, 1.005];
        assert!(
            ratios.iter().zip(most).all(|(ratio, most)| *ratio <= most),
            "{rate_hz} Hz, {delay_ms} ms: {ratios:?}"
        );
    }
}
