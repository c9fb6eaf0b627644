//! FovVideoVDP, where somebody wants it.

use crate::scene::{blurred, clip, held, in_ring};
use glam::Vec3;
use parafovea_errors::fvvdp::Fvvdp;
use parafovea_errors::{Clip, Viewing};
use std::path::Path;

/// `PARAFOVEA_FVVDP` names the folder of the environment; without it one is made anew.
#[test]
#[ignore = "downloads and installs 6 GB under a non-commercial licence; PARAFOVEA_FVVDP=folder keeps it"]
fn equal_clips_are_10_jod_and_degraded_ones_less() {
    let temporary = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("PARAFOVEA_FVVDP");
    let folder = kept.as_deref().map_or(temporary.path(), Path::new);
    let fvvdp = Fvvdp::install(folder).unwrap();
    let reference = clip(12, 1);
    let jod = |test: &Clip| fvvdp.jod(&reference, test, 0, &Viewing::default()).unwrap();
    let equal = jod(&reference);
    assert_eq!((equal.jod, equal.version.as_str()), (10.0, "1.2.2"));
    let [less, more] = [1, 4].map(|radius| jod(&blurred(&reference, radius)).jod);
    assert!(more < less && less < 10.0, "blur: {less}, {more}");
    eprintln!("blur: {less} and {more} JOD");
    let [less, more] = [2, 5].map(|period| jod(&held(&reference, period)).jod);
    assert!(more < less && less < 10.0, "dropped frames: {less}, {more}");
    eprintln!("dropped frames: {less} and {more} JOD");
    // The same change costs more where the eye looks.
    let blurred = in_ring(&reference, &blurred(&reference, 3), 1);
    let looked_at = jod(&blurred).jod;
    let aside = [&reference, &blurred].map(|clip| {
        let mut clip = clip.clone();
        for eye in clip.frames.iter_mut().flat_map(|frame| frame.eyes.iter_mut().flatten()) {
            eye.gaze = Vec3::new(0.7, 0.0, -1.0);
        }
        clip
    });
    let aside = fvvdp.jod(&aside[0], &aside[1], 0, &Viewing::default()).unwrap().jod;
    assert!(looked_at < aside && aside < 10.0, "looked at: {looked_at}, aside: {aside}");
    eprintln!("looked at: {looked_at} JOD, aside: {aside} JOD");
}
