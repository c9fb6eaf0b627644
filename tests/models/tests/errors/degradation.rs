//! Every degradation costs more the stronger it is, in the metrics that are meant for it.

use crate::scene::{blurred, clip, clip_of, delayed, desaturated, held, in_ring, noisy, random};
use glam::Vec3;
use parafovea_core::perception::csf::{Stimulus, VisualField, castle};
use parafovea_models::errors::{Clip, Metric, RINGS, Report, Viewing, judge};
use std::f32::consts::{PI, TAU};

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
    let reference = clip(6, 1);
    let reports = [1, 2, 4].map(|radius| judged(&reference, &blurred(&reference, radius)));
    assert_rising("blur", &reports, &SEEN);
    assert_rising("blur", &reports, &[Metric::RedGreen, Metric::YellowViolet]);
}

#[test]
fn noise() {
    let reference = clip(23, 0);
    let reports = [0.02, 0.05, 0.12].map(|amplitude| judged(&reference, &noisy(&reference, amplitude)));
    assert_rising("noise", &reports, &SEEN);
    assert_rising("noise", &reports, &[Metric::Transient, Metric::Flicker, Metric::AreaFlicker]);
}

/// Noise of uniform strength is less visible the farther it is from the gaze.
#[test]
fn eccentricity() {
    let reference = clip_of(6, [true, false], |_, _, _, _| [0.3; 3]);
    let report = judged(&reference, &noisy(&reference, 0.1));
    for metric in [Metric::Sustained, Metric::Transient] {
        let means = means(&report, metric);
        assert!(means.is_sorted_by(|near, far| near > far), "{metric:?}: {means:?}");
    }
}

/// Light that changes along one mechanism of colour only: the red, green and blue that castleCSF's matrices (`lms2006_2xyz`, `get_lms2acc`)
/// give for constant responses of both others, computed apart from this package.
#[test]
fn each_colour_mechanism_sees_its_own() {
    for (direction, seen, unseen) in [
        ([0.6766, -0.2177, 0.0106], Metric::RedGreen, Metric::YellowViolet),
        ([-0.0191, 0.0199, -0.1133], Metric::YellowViolet, Metric::RedGreen),
    ] {
        let strength = 0.15 / direction.map(f32::abs).into_iter().fold(0.0, f32::max);
        let colour = |strength: f32| {
            clip_of(1, [true, false], move |_, _, x, _| {
                direction.map(|channel| 0.3 + strength * channel * (x / 8.0).sin())
            })
        };
        let report = judged(&colour(0.0), &colour(strength));
        for ring in 0..3 {
            let mean = |metric| report.row(metric, ring).mean.unwrap();
            assert!(mean(seen) > 5.0 * mean(unseen), "{seen:?} {}, {unseen:?} {}", mean(seen), mean(unseen));
        }
    }
}

#[test]
fn desaturation() {
    let reference = clip(23, 0);
    let reports = [0.2, 0.5, 1.0].map(|share| judged(&reference, &desaturated(&reference, share)));
    let colour = [Metric::Squared, Metric::Flip, Metric::RedGreen, Metric::YellowViolet];
    assert_rising("desaturation", &reports, &colour);
    // Luminance stays, up to the rounding to codes: far below the visible threshold, and nothing flickers.
    for report in &reports {
        assert!(means(report, Metric::Sustained).iter().all(|&jnd| jnd < 0.3), "{report}");
        assert!(means(report, Metric::Flicker).iter().all(|&contrast| contrast < 1e-6), "{report}");
    }
}

#[test]
fn dropped_frames() {
    let reference = clip(27, 1);
    let reports = [2, 3, 5].map(|period| judged(&reference, &held(&reference, period)));
    let over_time = [Metric::Squared, Metric::Flip, Metric::Transient];
    assert_rising("dropped frames", &reports, &over_time);
    // Holding every second frame blinks at 45 Hz, beyond the band; every third at 30 Hz, every fifth at 18 Hz.
    assert_rising("dropped frames", &reports[1..], &[Metric::Flicker, Metric::AreaFlicker]);
    let blinks = reports.each_ref().map(|report| means(report, Metric::Flicker));
    assert!((0..RINGS).all(|ring| blinks[0][ring] < 0.5 * blinks[1][ring]), "{blinks:?}");
}

#[test]
fn delay() {
    let reference = clip(8, 1);
    let reports = [1, 2, 4].map(|frames| judged(&reference, &delayed(&reference, frames)));
    assert_rising("delay", &reports, &SEEN);
    let still = clip(3, 0);
    assert_eq!(judged(&still, &delayed(&still, 2)), judged(&still, &still));
}

/// Of each degradation in one ring: it costs more the stronger it is, and other rings read exactly 0, or do so beyond
/// the metric's support.
#[test]
fn only_the_ring_concerned() {
    // Flicker needs 23 frames; metrics of each frame do not.
    let (short, long) = (clip(4, 1), clip(23, 1));
    let blur = [1, 3].map(|radius| blurred(&short, radius));
    let over_time = [Metric::Transient, Metric::Flicker];
    let degradations: [(&str, &Clip, [Clip; 2], &[Metric]); RINGS] = [
        ("blur", &short, blur.clone(), &SEEN),
        ("dropped frames", &long, [2, 5].map(|period| held(&long, period)), &over_time),
        ("delay", &short, [1, 3].map(|frames| delayed(&short, frames)), &SEEN),
        ("desaturation", &short, [0.3, 0.9].map(|share| desaturated(&short, share)), &[Metric::RedGreen]),
        ("blur", &short, blur, &SEEN),
        ("noise", &long, [0.03, 0.1].map(|amplitude| noisy(&long, amplitude)), &over_time),
    ];
    for (changed, (what, reference, strengths, metrics)) in degradations.into_iter().enumerate() {
        let reports = strengths.map(|worse| judged(reference, &in_ring(reference, &worse, changed)));
        for &metric in metrics {
            let [less, more] = reports.each_ref().map(|report| means(report, metric)[changed]);
            assert!(0.0 < less && less < more, "{what} in ring {changed}, {metric:?}: {less} {more}");
        }
        reports.iter().for_each(|report| assert_blind_elsewhere(report, changed));
    }
}

fn assert_blind_elsewhere(report: &Report, changed: usize) {
    let nothing = |metric: Metric, ring: usize| {
        // Short clips have no figure of flicker.
        if report.row(metric, changed).mean.is_some() {
            let row = report.row(metric, ring);
            assert_eq!(row.mean, Some(0.0), "{metric:?} from ring {changed} in {ring}");
            let worst = row.worst_tile.map(|worst| worst.value);
            assert_eq!(worst, Some(0.0), "{metric:?} from ring {changed} in {ring}");
        }
    };
    for ring in (0..RINGS).filter(|&ring| ring != changed) {
        nothing(Metric::Squared, ring);
        nothing(Metric::Flicker, ring);
    }
    // Edges of the rings are at 4.5, 11, 23, 47 and 74 pixels from the gaze. With a support of 30 pixels along each
    // axis, 42 diagonally, nothing of the two innermost rings shows in the outermost, and nothing of that in the first
    // three.
    let beyond = match changed {
        0 | 1 => RINGS - 1..RINGS,
        last if last == RINGS - 1 => 0..3,
        _ => 0..0,
    };
    for ring in beyond {
        for metric in &Metric::ALL[..8] {
            nothing(*metric, ring);
        }
    }
}

/// A change goes to the ring that it is in at that moment.
#[test]
fn the_gaze_moves() {
    let mut reference = clip(2, 0);
    let mut test = in_ring(&reference, &blurred(&reference, 2), 0);
    for clip in [&mut reference, &mut test] {
        clip.frames[1].eyes[0].as_mut().unwrap().gaze = Vec3::new(1.0, 0.0, -1.0);
    }
    let report = judged(&reference, &test);
    let means = means(&report, Metric::Squared);
    assert!(means[0] > 0.0 && means[5] > 0.0 && means[1..5] == [0.0; 4], "{means:?}");
}

/// A field of `contrast` that flickers as a whole is seen as castleCSF has it at that frequency.
#[test]
fn flicker_is_seen_by_its_frequency() {
    let hz = [4.0_f32, 9.0, 22.5];
    let seen = hz.map(|hz| {
        let flicker = |contrast: f32| {
            clip_of(30, [true, false], move |_, frame, x, _| {
                let wave = (TAU * hz * frame as f32 / 90.0).sin() * (TAU * 0.140_495 * x).sin();
                [0.3 * (1.0 + contrast * wave); 3]
            })
        };
        let report = judged(&flicker(0.0), &flicker(0.2));
        report.row(Metric::Transient, 1).mean.unwrap()
    });
    // The peak of the second band at 2.3 pixels per degree, 3.5 degrees from the gaze, 30 cd/m^2.
    let response = |hz: f32| {
        let stimulus = Stimulus {
            frequency_cpd: 0.140_495 * 2.23,
            temporal_hz: hz,
            eccentricity_deg: 3.5,
            luminance_cd_m2: 30.1,
            area_deg2: 32.0,
        };
        castle::transient(&stimulus, VisualField::Worst)
    };
    for (hz, seen) in hz.into_iter().zip(seen) {
        // Mean of |sin| over the picture and over time.
        let expected = 0.2 * response(hz) * (2.0 / PI).powi(2);
        assert!((seen / f64::from(expected) - 1.0).abs() < 0.2, "{hz} Hz: {seen} JND, not {expected}");
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
