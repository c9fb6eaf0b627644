//! FovVideoVDP, where it is installed.

use crate::scene::{SIDE, blurred, clip, each, held, in_ring, light};
use glam::Vec3;
use parafovea_models::errors::fvvdp::{Fvvdp, VERSION};
use parafovea_models::errors::{Clip, Picture, Viewing};
use parafovea_trial::{Lack, skip};
use std::path::Path;

/// The Python interpreter that `PARAFOVEA_JOD` names.
fn fvvdp() -> Fvvdp {
    let Some(python) = std::env::var_os("PARAFOVEA_JOD") else {
        skip(&Lack::machine("a Python with pyfvvdp, which PARAFOVEA_JOD would name"))
    };
    Fvvdp::of(Path::new(&python)).unwrap()
}

fn looking(clip: &Clip, gaze: Vec3) -> Clip {
    let mut clip = clip.clone();
    for eye in clip.frames.iter_mut().flat_map(|frame| frame.eyes.iter_mut().flatten()) {
        eye.gaze = gaze;
    }
    clip
}

#[test]
fn equal_clips_are_10_jod_and_degraded_ones_less() {
    let fvvdp = fvvdp();
    let reference = clip(12, 1);
    let jod = |test: &Clip| fvvdp.jod(&reference, test, 0, &Viewing::default()).unwrap();
    let equal = jod(&reference);
    assert_eq!((equal.jod, equal.version.as_str()), (10.0, VERSION));
    assert_eq!(equal.differences.by_frame, [0.0; 12]);
    let [less, more] = [1, 4].map(|radius| jod(&blurred(&reference, radius)).jod);
    assert!(more < less && less < 10.0, "blur: {less}, {more}");
    eprintln!("blur: {less} and {more} JOD");
    let [less, more] = [2, 5].map(|period| jod(&held(&reference, period)).jod);
    assert!(more < less && less < 10.0, "dropped frames: {less}, {more}");
    eprintln!("dropped frames: {less} and {more} JOD");
    // The same change costs more where the eye looks.
    let blurred = in_ring(&reference, &blurred(&reference, 3), 1);
    let found = jod(&blurred);
    let of_all = 10.0 - found.differences.lost_jod(0..12).unwrap();
    assert!((of_all - found.jod).abs() < 1e-4, "{of_all} by frames, {} by FovVideoVDP", found.jod);
    let aside = [&reference, &blurred].map(|clip| looking(clip, Vec3::new(0.7, 0.0, -1.0)));
    let aside = fvvdp.jod(&aside[0], &aside[1], 0, &Viewing::default()).unwrap().jod;
    assert!(found.jod < aside && aside < 10.0, "looked at: {}, aside: {aside}", found.jod);
    eprintln!("looked at: {} JOD, aside: {aside} JOD", found.jod);
}

/// One half of the image is blurred, and the gaze is at the middle of that half or of the other one.
#[test]
fn a_blurred_periphery_costs_less_jod_than_a_blurred_fovea() {
    let fvvdp = fvvdp();
    let reference = clip(4, 1);
    let soft = blurred(&reference, 2);
    let half = each(&reference, |frame, sharp| {
        let Some(soft) = &soft.frames[frame].eyes[0] else { return sharp.clone() };
        Picture::from_linear(SIDE, SIDE, |x, y| light(if x < SIDE / 2 { &soft.picture } else { sharp }, x, y))
    });
    let [fovea, periphery] = [-0.5, 0.5].map(|x| {
        let [before, after] = [&reference, &half].map(|clip| looking(clip, Vec3::new(x, 0.0, -1.0)));
        fvvdp.jod(&before, &after, 0, &Viewing::default()).unwrap().jod
    });
    eprintln!("fovea: {fovea} JOD, periphery: {periphery} JOD");
    assert!(fovea + 0.1 < periphery && periphery < 10.0, "fovea: {fovea}, periphery: {periphery}");
}
