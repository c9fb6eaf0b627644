use super::*;
use crate::errors::clip::{Frame, Picture};
use glam::Vec3;
use parafovea_core::geometry::Fov;
use std::f32::consts::FRAC_PI_4;

/// `fake_python.sh` by another name. It is linked to, not copied: Linux starts no program that is open for writing.
fn python(name: &str) -> (tempfile::TempDir, PathBuf) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/src/errors/fvvdp/fake_python.sh");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::os::unix::fs::symlink(script, &path).unwrap();
    (folder, path)
}

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
        assert!((x - 47.5).abs() < 1e-3 && (y - 11.5).abs() < 1e-3, "{x} {y}");
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
fn missing_python_modules_are_reported_first() {
    let reason = |path: &Path| match Fvvdp::of(path).unwrap_err() {
        FvvdpError::Python { python, reason } if python == path => reason,
        other => panic!("{other}"),
    };
    let (_folder, path) = python("without-pyfvvdp");
    assert_eq!(reason(&path), "cannot import pyfvvdp: ModuleNotFoundError: No module named 'pyfvvdp'");
    let (_folder, path) = python("of-another-version");
    assert_eq!(reason(&path), "pyfvvdp 1.2.2 is needed, and this is `1.1.3`");
    let reason = reason(Path::new("/nonexistent/python"));
    assert!(reason.starts_with("cannot be started: No such file"), "{reason}");
}

#[test]
fn a_program_is_given_both_clips_and_its_answer_is_read() {
    let (_folder, path) = python("python3");
    let fvvdp = Fvvdp::of(&path).unwrap();
    let jod = |test: &Clip| fvvdp.jod(&clip(2), test, 0, &Viewing::default()).unwrap();
    assert_eq!((jod(&clip(2)).jod, jod(&clip(2)).differences.by_frame), (10.0, vec![0.0; 2]));
    let mut brighter = clip(2);
    brighter.frames[1].eyes[0].as_mut().unwrap().picture = Picture::from_linear(64, 32, |_, _| [0.6; 3]);
    let found = jod(&brighter);
    assert_eq!(found.differences, Differences { by_frame: vec![1.0, 0.25], exponent: 0.5 });
    let of_all = 10.0 - found.differences.lost_jod(0..2).unwrap();
    assert!((found.jod - of_all).abs() < 1e-5, "{} and {of_all}", found.jod);
}

#[test]
fn some_frames_have_a_jod_of_their_own() {
    let differences = Differences { by_frame: vec![1.0, 9.0, 4.0], exponent: 0.5 };
    assert_eq!(differences.lost_jod([1]), Some(3.0));
    // A frame that was drawn twice counts twice.
    assert_eq!(differences.lost_jod([0, 1, 1, 1, 1, 1, 1, 1]), Some(8f64.sqrt()));
    assert_eq!((differences.lost_jod([]), differences.lost_jod([0, 3])), (None, None));
}

#[test]
fn failures_say_what_was_tried() {
    let missing = Fvvdp { python: PathBuf::from("/nonexistent/python") };
    let error = missing.jod(&clip(1), &clip(1), 0, &Viewing::default()).unwrap_err();
    assert_eq!(error.to_string(), "running pyfvvdp");
    for (name, words) in [
        ("failing", "running pyfvvdp: RuntimeError: no memory"),
        ("talkative", "reading what pyfvvdp found: expected value"),
    ] {
        let (_folder, path) = python(name);
        let error = Fvvdp::of(&path).unwrap().jod(&clip(1), &clip(1), 0, &Viewing::default()).unwrap_err();
        assert!(error.to_string().starts_with(words), "{error}");
    }
}
