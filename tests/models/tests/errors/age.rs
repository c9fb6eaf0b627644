//! Ages that do not agree between both eyes: maps such as re-use of the periphery makes, made by hand.

use crate::scene::clip_of;
use parafovea_core::image::Plane;
use parafovea_models::errors::{Clip, Metric, RINGS, Report, Viewing, judge};

const FRAMES: usize = 8;

/// Both eyes, all grey, with ages of `age(eye, frame, x, y)` on a map of `size` texels.
fn aged(size: [u32; 2], age: impl Fn(usize, usize, u32, u32) -> f32) -> Clip {
    let mut clip = clip_of(FRAMES, [true; 2], |_, _, _, _| [0.5; 3]);
    for (number, frame) in clip.frames.iter_mut().enumerate() {
        for (side, eye) in frame.eyes.iter_mut().enumerate() {
            eye.as_mut().unwrap().age =
                Some(Plane::from_fn(size[0], size[1], |x, y| age(side, number, x, y)));
        }
    }
    clip
}

/// Mean and worst tile of each ring, where there are any.
fn ages(reference: &Clip, test: &Clip) -> Vec<Option<[f64; 2]>> {
    let report: Report = judge(reference, test, &Viewing::default()).unwrap();
    let row = |ring| report.row(Metric::InterocularAge, ring);
    (0..RINGS).map(|ring| Some([row(ring).mean?, row(ring).worst_tile.as_ref()?.value])).collect()
}

/// Content of equal age in both eyes is not a disagreement, however old.
#[test]
fn eyes_that_age_together_agree() {
    let test = aged([16, 16], |_, frame, x, y| ((x + y) as usize + frame) as f32);
    assert_eq!(ages(&test, &test), [Some([0.0; 2]); RINGS]);
}

/// Every fourth frame each, and the eyes two frames apart.
#[test]
fn eyes_that_take_turns_disagree_by_their_distance() {
    let fresh = aged([1, 1], |_, _, _, _| 0.0);
    let test = aged([1, 1], |eye, frame, _, _| ((frame + 2 * eye) % 4) as f32);
    assert_eq!(ages(&fresh, &test), [Some([2.0; 2]); RINGS]);
}

/// Half of every ring lies on each side of the gaze.
#[test]
fn a_half_that_is_old_in_one_eye_counts_half() {
    let fresh = aged([1, 1], |_, _, _, _| 0.0);
    let test = aged([2, 1], |eye, _, x, _| if (eye, x) == (1, 1) { 3.0 } else { 0.0 });
    for ring in ages(&fresh, &test) {
        let [mean, worst] = ring.unwrap();
        assert!((mean - 1.5).abs() < 1e-6, "{mean}");
        assert_eq!(worst, 3.0);
    }
}

/// The reference is taken to be of this very frame: its ages are not asked for.
#[test]
fn only_ages_of_the_test_count_and_both_eyes_need_them() {
    let fresh = aged([1, 1], |_, _, _, _| 0.0);
    let old = aged([1, 1], |eye, _, _, _| 5.0 * eye as f32);
    assert_eq!(ages(&old, &fresh), [Some([0.0; 2]); RINGS]);
    let mut half = old.clone();
    half.frames.iter_mut().for_each(|frame| frame.eyes[0].as_mut().unwrap().age = None);
    assert_eq!(ages(&fresh, &half), [None; RINGS]);
    // Frames without ages count neither way.
    let mut some = old;
    for frame in &mut some.frames[1..] {
        frame.eyes[1].as_mut().unwrap().age = None;
    }
    assert_eq!(ages(&fresh, &some), [Some([5.0; 2]); RINGS]);
}
