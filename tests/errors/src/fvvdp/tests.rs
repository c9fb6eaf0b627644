use super::*;
use crate::clip::{Frame, Picture};
use glam::Vec3;
use parafovea_core::geometry::Fov;
use std::f32::consts::FRAC_PI_4;

fn clip(frames: usize) -> Clip {
    let fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };
    let picture = Picture::from_linear(64, 32, |_, _| [0.5; 3]);
    let eye = Eye { picture, fov, gaze: Vec3::new(0.5, 0.25, -1.0), age: None };
    let frame = |index: usize| Frame { time_s: index as f64 / 90.0, eyes: [Some(eye.clone()), None] };
    Clip { frames: (0..frames).map(frame).collect() }
}

#[test]
fn the_job_has_the_gaze_in_pixels() {
    let job = job(&clip(3), &clip(3), 0, &Viewing::default()).unwrap();
    assert_eq!((job.frames, job.width, job.height), (3, 64, 32));
    for [x, y] in job.gaze_px {
        assert!((x - 48.0).abs() < 1e-3 && (y - 12.0).abs() < 1e-3, "{x} {y}");
    }
    assert!((job.fov_horizontal_deg - 90.0).abs() < 1e-3);
}

#[test]
fn clips_that_cannot_be_compared_are_refused() {
    let viewing = Viewing::default();
    assert!(job(&clip(2), &clip(1), 0, &viewing).is_none());
    assert!(job(&clip(0), &clip(0), 0, &viewing).is_none());
    assert!(job(&clip(1), &clip(1), 1, &viewing).is_none());
    let mut behind = clip(1);
    behind.frames[0].eyes[0].as_mut().unwrap().gaze = Vec3::Z;
    assert!(job(&behind, &clip(1), 0, &viewing).is_none());
}

#[test]
fn failures_say_what_was_tried() {
    let missing = Fvvdp { python: PathBuf::from("/nonexistent/python") };
    let error = missing.jod(&clip(1), &clip(1), 0, &Viewing::default()).unwrap_err();
    assert_eq!(error.to_string(), "running pyfvvdp");
    let failing = Fvvdp { python: PathBuf::from("false") };
    let error = failing.jod(&clip(1), &clip(1), 0, &Viewing::default()).unwrap_err();
    assert!(matches!(&error, FvvdpError::Failed { what, .. } if what == "running pyfvvdp"), "{error}");
}
