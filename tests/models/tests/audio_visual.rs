//! Paper A's claims about its maps, on an artificial image; our scenes are in `cargo dev bench models`.

#![allow(clippy::unwrap_used)]

use parafovea_core::image::Plane;
use parafovea_models::audio_visual::{LOUDNESS_LUFS, PITCH_KHZ, Row, SIDE, Scene, rows, table};

/// Waves of every octave whose contrast rises from left to right, and noise that rises from top to bottom.
fn picture() -> Plane {
    Plane::from_fn(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32, y as f32);
        let octave = |i: i32| {
            let (sin, cos) = (i as f32 * 2.4).sin_cos();
            ((u * cos + v * sin) * 2.5 * 0.5f32.powi(i)).sin()
        };
        let waves: f32 = (0..6).map(octave).sum::<f32>() * u / SIDE as f32;
        let hash = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77)).wrapping_mul(0xc2b2_ae35);
        let noise = ((hash >> 16) as f32 / 65_536.0 - 0.5) * v / SIDE as f32;
        (40.0 + 6.0 * waves + 10.0 * noise).max(0.0)
    })
}

#[test]
fn maps_behave_as_the_paper_says() {
    let rows = rows(&[Scene::new("made up", &picture())]);
    let row = |case: &str, metric: &str| -> &Row {
        rows.iter().find(|row| row.case == case && row.metric == metric).unwrap()
    };
    for constants in ["Paper", "Castle", "Default"] {
        let rate =
            |lufs: f32, khz: f32| row(&format!("{constants}, {lufs} LUFS, {khz} kHz"), "mean_rate").value;
        for lufs in LOUDNESS_LUFS.windows(2) {
            for khz in PITCH_KHZ.windows(2) {
                assert!(
                    rate(lufs[1], khz[0]) <= rate(lufs[0], khz[0]),
                    "{constants}: louder, fewer fragments"
                );
                assert!(
                    rate(lufs[0], khz[1]) >= rate(lufs[0], khz[0]),
                    "{constants}: higher, more fragments"
                );
            }
        }
        assert!(rate(-10.0, 1.0) < rate(-35.0, 6.0) * 0.95, "{constants}: sound counts");
    }
    assert!(rows.iter().filter(|row| row.metric == "score").all(|row| row.value >= 3.63 - 1e-4));
    for constants in ["Paper", "Castle"] {
        let steps = ["visual only", "and frequency", "and loudness", "all"];
        let rates = steps.map(|step| row(&format!("{constants}, {step}"), "ablation").value);
        assert!(rates.is_sorted_by(|a, b| a > b), "{constants}: {rates:?}");
        let all_off = row("all off", "ablation").value;
        assert!(all_off == 1.0 && rates[0] <= all_off, "{constants}: {rates:?}");
    }
    // Of the loss that it is decided by; of Tursun's rates nothing follows for castleCSF's loss.
    let control = row("Castle, FR' 1/16", "loss");
    assert!(control.value < control.baseline.unwrap(), "{control:?}");
    let text = table(&rows);
    assert!(text.contains("made up: mean rate of FR 0.3") && !text.contains("NaN"), "{text}");
}
