//! Every degradation costs more the stronger it is, in the metrics that are meant for it.

use crate::scene::{blurred, clip, clip_of, delayed, desaturated, held, in_ring, noisy, random};
use parafovea_errors::{Clip, Metric, RINGS, Report, Viewing, judge};

fn judged(reference: &Clip, test: &Clip) -> Report {
    judge(reference, test, &Viewing::default()).unwrap()
}

fn means(report: &Report, metric: Metric) -> [f64; RINGS] {
    std::array::from_fn(|ring| report.row(metric, ring).mean.unwrap())
}

/// Mean and worst tile rise from one report to the next in all rings, from 0 on.
fn assert_rising(what: &str, reports: &[Report], metrics: &[Metric]) {
    for &metric in metrics {
        for ring in 0..RINGS {
            let figures = |report: &Report| {
                let row = report.row(metric, ring);
                (row.mean.unwrap(), row.worst_tile.unwrap().value)
            };
            let mut last = (0.0, 0.0);
            for report in reports {
                let next = figures(report);
                assert!(
                    next.0 > last.0 && next.1 > last.1,
                    "{what}, {metric:?}, ring {ring}: {last:?} {next:?}"
                );
                last = next;
            }
        }
    }
}

const SEEN: [Metric; 3] = [Metric::Squared, Metric::Flip, Metric::Sustained];

#[test]
fn blur() {
    let reference = clip(6, 1.0);
    let reports = [1, 2, 4].map(|radius| judged(&reference, &blurred(&reference, radius)));
    assert_rising("blur", &reports, &SEEN);
    assert_rising("blur", &reports, &[Metric::RedGreen, Metric::YellowViolet]);
}

#[test]
fn noise() {
    let reference = clip(24, 0.0);
    let reports = [0.02, 0.05, 0.12].map(|amplitude| judged(&reference, &noisy(&reference, amplitude)));
    assert_rising("noise", &reports, &SEEN);
    assert_rising("noise", &reports, &[Metric::Transient, Metric::Flicker, Metric::AreaFlicker]);
}

#[test]
fn desaturation() {
    let reference = clip(23, 0.0);
    let reports = [0.2, 0.5, 1.0].map(|share| judged(&reference, &desaturated(&reference, share)));
    let colour = [Metric::Squared, Metric::Flip, Metric::RedGreen, Metric::YellowViolet];
    assert_rising("desaturation", &reports, &colour);
    // Luminance stays, up to the rounding to codes: far below what is seen, and nothing flickers.
    for report in &reports {
        assert!(means(report, Metric::Sustained).iter().all(|&jnd| jnd < 0.3), "{report}");
        assert!(means(report, Metric::Flicker).iter().all(|&contrast| contrast < 1e-6), "{report}");
    }
}

#[test]
fn dropped_frames() {
    let reference = clip(45, 1.0);
    let reports = [2, 3, 5].map(|period| judged(&reference, &held(&reference, period)));
    let over_time = [Metric::Squared, Metric::Flip, Metric::Transient, Metric::Sustained];
    assert_rising("dropped frames", &reports, &over_time);
    // Holding every second frame blinks at 45 Hz, beyond the band; every third at 30 Hz, every fifth at 18 Hz.
    assert_rising("dropped frames", &reports[1..], &[Metric::Flicker, Metric::AreaFlicker]);
    let blinks = reports.each_ref().map(|report| means(report, Metric::Flicker));
    assert!((0..RINGS).all(|ring| blinks[0][ring] < 0.5 * blinks[1][ring]), "{blinks:?}");
}

#[test]
fn delay() {
    let reference = clip(24, 1.0);
    let reports = [1, 2, 4].map(|frames| judged(&reference, &delayed(&reference, frames)));
    assert_rising("delay", &reports, &SEEN);
    let still = clip(3, 0.0);
    assert_eq!(judged(&still, &delayed(&still, 2)), judged(&still, &still));
}

/// Rings without change read exactly 0, or beyond the metric's support.
#[test]
fn only_the_ring_concerned() {
    let reference = clip(23, 1.0);
    let worse = noisy(&desaturated(&reference, 0.8), 0.1);
    for changed in 0..RINGS {
        let report = judged(&reference, &in_ring(&reference, &worse, changed));
        for metric in [Metric::Squared, Metric::Flicker] {
            for (ring, mean) in means(&report, metric).into_iter().enumerate() {
                let worst = report.row(metric, ring).worst_tile.unwrap().value;
                assert!((mean > 0.0 && worst > 0.0) == (ring == changed), "{metric:?} {ring}: {mean}");
                assert!(ring == changed || (mean, worst) == (0.0, 0.0), "{metric:?} {ring}: {mean} {worst}");
            }
        }
        // Edges of the rings are at 4.5, 11, 23, 47 and 74 pixels from the gaze. With a support of 30 pixels along each
        // axis, 42 diagonally, nothing of the innermost ring shows in the outermost, and nothing of that in the first
        // three.
        let blind = match changed {
            0 => RINGS - 1..RINGS,
            last if last == RINGS - 1 => 0..3,
            _ => 0..0,
        };
        let filtered =
            [Metric::Flip, Metric::Sustained, Metric::Transient, Metric::RedGreen, Metric::YellowViolet];
        for metric in filtered.into_iter().chain([Metric::AreaFlicker]) {
            let means = means(&report, metric);
            assert!(means[changed] > 0.0, "{metric:?}");
            for ring in blind.clone() {
                let worst = report.row(metric, ring).worst_tile.unwrap().value;
                assert_eq!((means[ring], worst), (0.0, 0.0), "{metric:?} from {changed} in {ring}");
            }
        }
    }
}

/// Both eyes see the same plane; the right one may be displaced by pixels.
fn stereo(displaced: f32) -> Clip {
    clip_of(3, [true, true], |eye, frame, x, y| {
        let x = x - eye as f32 * displaced - frame as f32;
        let wave = |size: f32, seed: i32| (x / size + y / (3.0 * size) + 6.0 * random(seed, 0, 1)).sin();
        [0.4 + 0.1 * wave(2.5, 1) + 0.1 * wave(4.0, 2) + 0.1 * wave(7.0, 3); 3]
    })
}

#[test]
fn displacement_of_one_eye() {
    let reference = stereo(0.0);
    let reports = [0.5, 1.0, 2.5].map(|by| judged(&reference, &stereo(by)));
    assert_rising("disparity", &reports, &[Metric::InterocularDisparity]);
    // 90 degrees over 256 pixels: 2.23 pixels a degree in the middle.
    let arc_minutes = reports[1].row(Metric::InterocularDisparity, 0).mean.unwrap();
    assert!((arc_minutes / (60.0 / 2.234) - 1.0).abs() < 0.05, "{arc_minutes}");
    // A delay of both eyes displaces both alike.
    let late = judged(&reference, &delayed(&reference, 1));
    assert!(
        means(&late, Metric::InterocularDisparity).iter().all(|&arc_minutes| arc_minutes < 1.0),
        "{late}"
    );
}
