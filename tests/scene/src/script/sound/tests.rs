use super::super::Script;
use super::*;

/// The file, read back by its own header, has the stated loudness within 0.1 LU, and is stereo and long enough.
#[test]
fn every_sound_is_as_loud_as_stated() {
    for scene in SceneName::ALL {
        let sound = Script::new(scene).sound;
        assert!((-35.0..=-12.0).contains(&sound.loudness_lufs), "{sound:?}");
        let bytes = sound.wav().unwrap();
        let mut reader = hound::WavReader::new(Cursor::new(&bytes)).unwrap();
        let spec = reader.spec();
        assert_eq!((spec.channels, spec.sample_rate, spec.bits_per_sample), (2, RATE_HZ, 16));
        let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
        assert!(samples.len() as f64 / 2.0 / f64::from(RATE_HZ) >= 10.0, "{sound:?} is too short");
        let mut meter = EbuR128::new(2, RATE_HZ, Mode::I).unwrap();
        meter.add_frames_i16(&samples).unwrap();
        let found = meter.loudness_global().unwrap();
        assert!((found - sound.loudness_lufs).abs() < 0.1, "{sound:?} has {found:.3} LUFS");
        assert!(samples.chunks_exact(2).any(|frame| frame[0] != frame[1]), "{sound:?} is no stereo");
    }
}

#[test]
fn sounds_are_the_same_each_time_and_differ_from_scene_to_scene() {
    let samples = |scene| Script::new(scene).sound.samples().unwrap();
    assert_eq!(samples(SceneName::Library), samples(SceneName::Library));
    assert_ne!(samples(SceneName::Library), samples(SceneName::Street));
}

#[test]
fn sounds_that_would_clip_are_refused() {
    let sound = Sound { scene: SceneName::Library, loudness_lufs: 0.0 };
    assert!(sound.samples().unwrap_err().to_string().contains("clips"));
}
