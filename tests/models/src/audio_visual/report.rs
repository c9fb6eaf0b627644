//! The figures as a table for people and as rows.

use super::{
    ABLATION, Constants, Map, Scene, Sound, audio_visual, baseline, by_coefficients, decided_by_model, fixed,
    full, loss, of_equal_cost, score,
};
use parafovea_core::avpm::SensitivityUnit;
use parafovea_core::rate::ShadingRate;
use std::fmt::Write;

/// Loudness, LUFS: the range of paper A's study.
pub const LOUDNESS_LUFS: [f32; 6] = [-35.0, -30.0, -25.0, -20.0, -15.0, -10.0];
/// Pitch, kHz: likewise.
pub const PITCH_KHZ: [f32; 5] = [1.0, 2.0, 3.0, 4.0, 6.0];

/// Peripheral rates of the baseline.
const PERIPHERAL: [(&str, ShadingRate); 2] = [("1/4", ShadingRate::R2X2), ("1/16", ShadingRate::R4X4)];

/// One figure.
#[derive(Clone, Debug)]
pub struct Row {
    /// The scene.
    pub scene: String,
    /// Constants and sound.
    pub case: String,
    /// The metric.
    pub metric: &'static str,
    /// The figure.
    pub value: f64,
    /// The baseline, if there is one.
    pub baseline: Option<f64>,
}

/// All figures of some scenes.
pub fn rows(scenes: &[Scene]) -> Vec<Row> {
    let fixed = PERIPHERAL.map(|(name, rate)| (name, fixed(baseline(rate))));
    scenes.iter().flat_map(|scene| of_scene(scene, &fixed)).collect()
}

fn sounds() -> impl Iterator<Item = Sound> {
    let heard = LOUDNESS_LUFS.into_iter().flat_map(|lufs| PITCH_KHZ.map(|khz| Sound::Heard { lufs, khz }));
    std::iter::once(Sound::Silence).chain(heard)
}

fn name(sound: Sound) -> String {
    match sound {
        Sound::Silence => "silence".to_owned(),
        Sound::Heard { lufs, khz } => format!("{lufs} LUFS, {khz} kHz"),
    }
}

fn of_scene(scene: &Scene, fixed: &[(&str, Map); 2]) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut row = |case: &str, metric, value: f64, baseline: Option<f64>| {
        let (scene, case) = (scene.name.clone(), case.to_owned());
        rows.push(Row { scene, case, metric, value, baseline });
    };
    for (peripheral, map) in fixed {
        row(&format!("FR, {peripheral}"), "mean_rate", map.mean_rate, None);
    }
    for constants in [Constants::Paper, Constants::Castle, Constants::Default] {
        for sound in sounds() {
            let map = audio_visual(scene, constants, sound);
            let case = format!("{constants:?}, {}", name(sound));
            row(&case, "mean_rate", map.mean_rate, Some(fixed[0].1.mean_rate));
            row(&case, "decided_by_model", decided_by_model(&map, constants), None);
            if constants == Constants::Paper {
                row(&case, "score", score(scene, &map, sound).into(), None);
            }
        }
    }
    let usual = Sound::Heard { lufs: -20.0, khz: 3.0 };
    row("all off", "ablation", full().mean_rate, Some(fixed[0].1.mean_rate));
    for (name, coefficients) in ABLATION {
        for constants in [Constants::Paper, Constants::Castle] {
            let map = by_coefficients(scene, constants, usual, coefficients);
            row(&format!("{constants:?}, {name}"), "ablation", map.mean_rate, Some(fixed[0].1.mean_rate));
        }
    }
    let quiet = Sound::Heard { lufs: -30.0, khz: 3.0 };
    for constants in [Constants::Paper, Constants::Castle] {
        let map = audio_visual(scene, constants, quiet);
        for (peripheral, rate) in PERIPHERAL {
            let Some(control) = of_equal_cost(&map, rate) else { continue };
            let [ours, theirs] =
                [&map, &control].map(|map| loss(scene, map, SensitivityUnit::CastleCsf).into());
            row(&format!("{constants:?}, FR' {peripheral}"), "loss", ours, Some(theirs));
        }
    }
    rows
}

const HEAD: &str = "\
Paper A on still pictures: one eye of 2160 x 2160 pixels and 104 degrees looks straight ahead. Mean rate: invocations for each
pixel. FR is the paper's fixed foveation, L1-C1, with a peripheral rate of 1/4 or 1/16. Paper: Tursun's sensitivity, no safety limits.
Castle: castleCSF's, no safety limits. Default: what an application gets. model: share of the tiles that contrast and sound decide, as they are
finer than the safety limits alone would have them.
";

/// The figures as text.
pub fn table(rows: &[Row]) -> String {
    let mut out = HEAD.to_owned();
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    for scene in scenes {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
        // Writing to a string does not fail.
        let _ = write_scene(&mut out, scene, &of_scene);
    }
    let _ = write_verdicts(&mut out, rows);
    out
}

fn value(rows: &[&Row], case: &str, metric: &str) -> f64 {
    rows.iter().find(|row| row.case == case && row.metric == metric).map_or(f64::NAN, |row| row.value)
}

fn write_scene(out: &mut String, scene: &str, rows: &[&Row]) -> std::fmt::Result {
    let fixed = PERIPHERAL.map(|(name, _)| value(rows, &format!("FR, {name}"), "mean_rate"));
    writeln!(out, "\n{scene}: mean rate of FR {:.3} (1/4) and {:.3} (1/16)", fixed[0], fixed[1])?;
    for constants in [Constants::Paper, Constants::Castle, Constants::Default] {
        let silent = format!("{constants:?}, silence");
        writeln!(
            out,
            "  {:<8} silence {:.3}    kHz: {}   model at 3 kHz",
            format!("{constants:?}"),
            value(rows, &silent, "mean_rate"),
            PITCH_KHZ.map(|khz| format!("{khz:>6}")).concat()
        )?;
        for lufs in LOUDNESS_LUFS {
            let case = |khz| format!("{constants:?}, {}", name(Sound::Heard { lufs, khz }));
            let rates = PITCH_KHZ.map(|khz| format!(" {:.3}", value(rows, &case(khz), "mean_rate"))).concat();
            let model = value(rows, &case(3.0), "decided_by_model");
            writeln!(out, "  {lufs:>22} LUFS       {rates}   {model:.3}")?;
        }
    }
    for row in rows.iter().filter(|row| row.metric == "ablation") {
        let times = fixed.map(|fixed| fixed / row.value);
        writeln!(
            out,
            "  {:<26} {:.2} (1/4) and {:.2} (1/16) times as few fragments as FR",
            row.case, times[0], times[1]
        )?;
    }
    for row in rows.iter().filter(|row| row.metric == "loss") {
        let theirs = row.baseline.unwrap_or(f64::NAN);
        writeln!(
            out,
            "  {:<26} loss {:.4}, that of as many fragments in rings {theirs:.4}",
            row.case, row.value
        )?;
    }
    Ok(())
}

/// The paper's claims, each with the number of scenes in which it holds.
fn write_verdicts(out: &mut String, rows: &[Row]) -> std::fmt::Result {
    writeln!(out)?;
    let least =
        rows.iter().filter(|row| row.metric == "score").map(|row| row.value).fold(f64::INFINITY, f64::min);
    writeln!(out, "Least score that paper A's Eq. 14 predicts, Paper: {least:.4} (E_0 is 3.63).")?;
    for constants in [Constants::Paper, Constants::Castle, Constants::Default] {
        for (name, _) in PERIPHERAL {
            let case = format!("{constants:?}, -20 LUFS, 3 kHz");
            let fixed = |scene: &str| {
                let case = format!("FR, {name}");
                rows.iter()
                    .find(|row| row.scene == scene && row.case == case)
                    .map_or(f64::NAN, |row| row.value)
            };
            let of_case = rows.iter().filter(|row| row.case == case && row.metric == "mean_rate");
            let ratios: Vec<(&str, f64)> =
                of_case.map(|row| (row.scene.as_str(), fixed(&row.scene) / row.value)).collect();
            let reached = ratios.iter().filter(|(_, ratio)| *ratio >= 1.3).count();
            let listed: Vec<String> =
                ratios.iter().map(|(scene, ratio)| format!("{scene} {ratio:.2}")).collect();
            let of = ratios.len();
            writeln!(
                out,
                "{case}: {reached} of {of} scenes need at most 1/1.3 of FR's fragments, {name}: {}",
                listed.join(", ")
            )?;
        }
    }
    for constants in [Constants::Paper, Constants::Castle] {
        for (name, _) in PERIPHERAL {
            let case = format!("{constants:?}, FR' {name}");
            let of_case: Vec<&Row> =
                rows.iter().filter(|row| row.case == case && row.metric == "loss").collect();
            let less =
                of_case.iter().filter(|row| row.baseline.is_some_and(|theirs| row.value < theirs)).count();
            let of = of_case.len();
            writeln!(
                out,
                "{case}, -30 LUFS, 3 kHz: castleCSF's loss is less than that of as many fragments in rings in {less} of {of} scenes."
            )?;
        }
    }
    Ok(())
}
