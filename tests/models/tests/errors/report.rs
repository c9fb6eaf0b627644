//! Content of reports, and clips without one.

use crate::scene::{SIDE, blurred, clip, held, noisy};
use parafovea_models::errors::{Clip, JudgeError, Metric, RING_NAMES, RINGS, Viewing, judge};

#[test]
fn equal_clips_have_no_errors() {
    let reference = clip(23, 1);
    let report = judge(&reference, &reference, &Viewing::default()).unwrap();
    for row in &report.rows {
        let needs_both_eyes = matches!(row.metric, Metric::InterocularAge | Metric::InterocularDisparity);
        assert_eq!(row.mean, (!needs_both_eyes).then_some(0.0), "{row:?}");
        assert_eq!(row.worst_tile.map(|worst| worst.value), row.mean, "{row:?}");
    }
}

#[test]
fn the_same_clips_give_the_same_report() {
    let reference = clip(23, 1);
    let test = noisy(&held(&blurred(&reference, 1), 2), 0.05);
    let reports = [0, 1].map(|_| judge(&reference, &test, &Viewing::default()).unwrap());
    let [first, second] = reports.each_ref().map(|report| serde_json::to_string(report).unwrap());
    assert_eq!(first, second);
    assert_eq!(reports[0], reports[1]);
}

#[test]
fn a_report_has_a_row_for_each_metric_and_ring_and_prints_its_conditions() {
    let reference = clip(1, 0);
    let viewing = Viewing { white_cd_m2: 150.0, ..Viewing::default() };
    let report = judge(&reference, &noisy(&reference, 0.05), &viewing).unwrap();
    assert_eq!(report.rows.len(), Metric::ALL.len() * RINGS);
    for (at, row) in report.rows.iter().enumerate() {
        assert_eq!((row.metric, row.ring), (Metric::ALL[at / RINGS], RING_NAMES[at % RINGS]));
        assert_eq!(serde_json::to_value(row).unwrap()["metric"], row.metric.name());
        // One frame has no information over time.
        assert_eq!(row.mean.is_none(), at / RINGS >= Metric::Flicker as usize, "{row:?}");
    }
    let text = report.to_string();
    for part in
        ["white 150 cd/m^2", "256 x 256", "-45.0..45.0", "2.23 pixels per degree", "red_green", "PSNR", ">30"]
    {
        assert!(text.contains(part), "{part} is missing:\n{text}");
    }
    let eye = report.eyes[0].as_ref().unwrap();
    assert_eq!((eye.extent, report.eyes[1].is_none()), ([SIDE; 2], true));
    assert!((30.0..90.0).contains(&eye.reference_cd_m2) && eye.reference_cd_m2 != eye.test_cd_m2);
}

#[test]
fn the_mean_of_the_frames_is_that_of_the_rings() {
    let reference = clip(23, 1);
    let report = judge(&reference, &held(&blurred(&reference, 1), 2), &Viewing::default()).unwrap();
    for metric in [Metric::Squared, Metric::Sustained, Metric::Transient, Metric::YellowViolet] {
        let frames = report.by_frame(metric);
        assert_eq!(frames.len(), 23, "{metric:?}");
        let by_frame = frames.iter().map(|mean| mean.unwrap()).sum::<f64>() / 23.0;
        let rings = (0..RINGS).map(|ring| report.row(metric, ring));
        let (sum, pixels) = rings.fold((0.0, 0), |(sum, pixels), row| {
            (sum + row.mean.unwrap_or(0.0) * row.pixels as f64, pixels + row.pixels)
        });
        let by_ring = sum / pixels as f64;
        assert!((by_frame - by_ring).abs() < 1e-9 * by_ring, "{metric:?}: {by_frame}, {by_ring}");
        assert!(frames.iter().any(|mean| *mean != frames[0]), "{metric:?}: all frames are alike");
    }
    assert!(report.by_frame(Metric::Flicker).is_empty());
}

/// The power mean is the mean where all is alike, and above it the more the changes differ; no more than the worst.
#[test]
fn detection_is_greatest_at_the_greatest_change() {
    let reference = clip(5, 1);
    let everywhere = judge(&reference, &blurred(&reference, 1), &Viewing::default()).unwrap();
    for metric in [Metric::Sustained, Metric::Transient] {
        for (detected, mean) in everywhere.detected_by_frame(metric).iter().zip(everywhere.by_frame(metric)) {
            let (detected, mean) = (detected.unwrap(), mean.unwrap());
            assert!(detected > mean && detected < 20.0 * mean, "{metric:?}: {detected}, {mean}");
        }
    }
    let same = judge(&reference, &reference, &Viewing::default()).unwrap();
    assert!(same.detected_by_frame(Metric::Sustained).iter().all(|detected| *detected == Some(0.0)));
}

#[test]
fn clips_that_cannot_be_compared_are_refused() {
    let reference = clip(2, 0);
    let refused = |change: fn(&mut Clip)| {
        let mut test = reference.clone();
        change(&mut test);
        judge(&reference, &test, &Viewing::default()).unwrap_err()
    };
    assert_eq!(refused(|test| drop(test.frames.pop())), JudgeError::Length { reference: 2, test: 1 });
    assert_eq!(refused(|test| test.frames[1].eyes[0] = None), JudgeError::Absent { frame: 1, eye: 0 });
    let mismatch = JudgeError::Mismatch { frame: 1, eye: 0 };
    assert_eq!(refused(|test| test.frames[1].eyes[0].as_mut().unwrap().gaze.x = 0.1), mismatch);
    assert_eq!(refused(|test| test.frames[1].eyes[0].as_mut().unwrap().fov.up = 0.1), mismatch);
    assert_eq!(refused(|test| test.frames[1].time_s = 0.5), mismatch);
    let mut blind = reference.clone();
    blind.frames[0].eyes[0].as_mut().unwrap().gaze = glam::Vec3::ZERO;
    let error = judge(&blind, &blind, &Viewing::default()).unwrap_err();
    assert_eq!(error, JudgeError::View { frame: 0, eye: 0 });
    let mut uneven = reference.clone();
    uneven.frames[1].time_s = 0.5;
    let error = judge(&uneven, &uneven, &Viewing::default()).unwrap_err();
    assert_eq!(error, JudgeError::Time { frame: 1 });
    for viewing in [
        Viewing { white_cd_m2: 0.0, ..Viewing::default() },
        Viewing { contrast: f32::NAN, ..Viewing::default() },
        Viewing { refresh_hz: f32::INFINITY, ..Viewing::default() },
    ] {
        assert!(matches!(judge(&reference, &reference, &viewing), Err(JudgeError::Viewing(_))));
    }
}
