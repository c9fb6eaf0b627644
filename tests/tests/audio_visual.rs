//! Rates by what the pictures show and what is heard, in running applications.

use parafovea_test_layers::{ShadingRateFinding, ShadingRateLine, ShadingRatePass, ShadingRateProfile};
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Message, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// Until every pass is known, sound is heard, and pictures were analysed.
const FRAMES: u64 = 150;
const LAST: u64 = FRAMES - 1;

/// The test layer copies each map before its pass, and leaves it in a layout for everything.
const COPY_OF_MAP: &str = "vkCmdCopyImageToBuffer: For optimal performance";

/// What was logged where rates are decided on the CPU after all.
const FALLS_BACK: &str = "rates are rings";

/// Tiles of 16 x 16 along the sides of a picture of 256 x 224.
const TILES: [usize; 2] = [16, 14];

fn config(mode: &str, rest: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"{mode}\"\ngate = \"on\"\n{rest}\n"
    )
}

fn scene(frames: u64) -> Run {
    let application = Application::ours("parafovea-scene", &["--still"]).unwrap();
    let scenario = Scenario::new(frames).sized(256, 224).saving(&[frames - 1]);
    Run::new(&application, &scenario)
}

fn finish(run: Run, frames: u64) -> Outcome {
    let outcome = run.validated().finish().unwrap().expect_frames(frames).unwrap();
    assert!(outcome.findings.vulkan_was_active, "validation was not there\n{}", outcome.output);
    outcome
}

/// Nothing that validation did not say without the layer.
fn assert_valid(outcome: &Outcome, reference: &Outcome) {
    let is_copy_of_map = |found: &Message| found.text.contains(COPY_OF_MAP);
    let mut new = outcome.findings.beyond(&reference.findings);
    new.retain(|found| !is_copy_of_map(found));
    assert!(new.is_empty(), "{new:#?}");
}

/// The newest map of a pass that draws a picture; the layer below finds nothing wrong.
fn newest_map(outcome: &Outcome) -> Vec<u8> {
    let (mut findings, mut newest): (Vec<ShadingRateFinding>, Option<ShadingRatePass>) = (Vec::new(), None);
    for line in outcome.shading_rates().unwrap() {
        match line {
            ShadingRateLine::Finding(finding) => findings.push(finding),
            // The runtime draws as UNORM what it saves.
            ShadingRateLine::Pass(pass) if pass.formats != ["R8G8B8A8_SRGB"] || pass.map.is_none() => {}
            ShadingRateLine::Pass(pass) => newest = Some(pass),
        }
    }
    assert_eq!(findings, []);
    let texels = newest.unwrap().map.unwrap().texels.unwrap();
    let digits = |index: usize| u8::from_str_radix(&texels[2 * index..2 * index + 2], 16).unwrap();
    (0..texels.len() / 2).map(digits).collect()
}

/// A tone of 1 kHz at -10 LUFS, of two seconds, in a folder that lives as long as it is kept.
fn tone() -> (tempfile::TempDir, String) {
    const RATE: u32 = 48_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tone.wav");
    let samples: Vec<u8> = (0..2 * RATE)
        .flat_map(|index| {
            let phase = f64::from(index) * 1000.0 / f64::from(RATE) * std::f64::consts::TAU;
            // A sine of full scale in both channels has 0 LUFS.
            let sample = (phase.sin() * 0.316 * 32767.0) as i16;
            [sample.to_le_bytes(), sample.to_le_bytes()].concat()
        })
        .collect();
    let mut wav = Vec::new();
    wav.extend(b"RIFF");
    wav.extend((36 + samples.len() as u32).to_le_bytes());
    wav.extend(b"WAVEfmt ");
    wav.extend(16u32.to_le_bytes());
    wav.extend([1u16, 2].map(u16::to_le_bytes).concat());
    wav.extend([RATE, RATE * 4].map(u32::to_le_bytes).concat());
    wav.extend([4u16, 16].map(u16::to_le_bytes).concat());
    wav.extend(b"data");
    wav.extend((samples.len() as u32).to_le_bytes());
    wav.extend(samples);
    std::fs::write(&path, wav).unwrap();
    let audio = format!("[audio]\nsource = \"file\"\nfile = {path:?}\n");
    (folder, audio)
}

/// Half octaves that a texel of a map removes.
fn octaves(texel: u8) -> u32 {
    u32::from(texel >> 2) + u32::from(texel & 3)
}

/// Standard deviation of luma within each tile of a picture, row by row.
fn contrasts(picture: &Picture) -> Vec<f64> {
    let luma = |x: usize, y: usize| {
        let [r, g, b, _] = picture.at(x as u32, y as u32);
        0.2 * f64::from(r) + 0.7 * f64::from(g) + 0.1 * f64::from(b)
    };
    let of_tile = |index: usize| {
        let [x, y] = [index % TILES[0] * 16, index / TILES[0] * 16];
        let pixels: Vec<f64> = (0..256).map(|pixel| luma(x + pixel % 16, y + pixel / 16)).collect();
        let mean = pixels.iter().sum::<f64>() / 256.0;
        (pixels.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 256.0).sqrt()
    };
    (0..TILES[0] * TILES[1]).map(of_tile).collect()
}

/// In silence rings hold: what the GPU decides and lays is then what the CPU does, to the last bit, on both backends.
#[test]
fn rings_from_the_gpu_are_those_of_the_cpu() {
    const FRAMES: u64 = 14;
    let reference = finish(scene(FRAMES), FRAMES);
    for profile in ShadingRateProfile::ALL {
        let maps = ["fixed", "audio-visual"].map(|mode| {
            let run = scene(FRAMES).shading_rates(profile).on(&config(mode, ""));
            let outcome = finish(run, FRAMES);
            assert!(!outcome.log.contains(FALLS_BACK), "{}", outcome.log);
            assert_valid(&outcome, &reference);
            newest_map(&outcome)
        });
        assert!(maps[0].iter().any(|texel| *texel != 0), "{}: nothing is coarse", profile.name());
        assert_eq!(maps[0], maps[1], "{}", profile.name());
    }
    let pictures = ["fixed", "audio-visual"].map(|mode| {
        let outcome = finish(scene(FRAMES).on(&config(mode, "backend = \"mask\"")), FRAMES);
        assert!(!outcome.log.contains(FALLS_BACK), "{}", outcome.log);
        assert!(outcome.log.contains("has a mask"), "{}", outcome.log);
        assert_valid(&outcome, &reference);
        [0, 1].map(|view| outcome.submitted(view, FRAMES - 1).unwrap())
    });
    assert!(pictures[0] == pictures[1], "another mask");
    assert!(pictures[0][0] != reference.submitted(0, FRAMES - 1).unwrap(), "nothing is skipped");
}

/// With sound that hides what is just seen, what is flat is coarse, and what is not is not.
#[test]
fn maps_follow_the_picture() {
    let (_folder, audio) = tone();
    let application = Application::ours("parafovea-scene", &["--still"]).unwrap();
    let scenario = Scenario::new(FRAMES).sized(256, 224).saving(&[LAST]).in_real_time();
    let run = Run::new(&application, &scenario).with_ears().unwrap();
    let outcome = finish(
        run.clone().shading_rates(ShadingRateProfile::Layered16).on(&config("audio-visual", &audio)),
        FRAMES,
    );
    assert!(!outcome.log.contains(FALLS_BACK), "{}", outcome.log);
    let map = newest_map(&outcome);
    assert_eq!(map.len(), TILES[0] * TILES[1]);
    // The passes of the right eye come last.
    let contrasts = contrasts(&outcome.submitted(1, LAST).unwrap());
    // Outside of the rings within which all is fine.
    let is_outer = |index: usize| {
        let [x, y] = [index % TILES[0], index / TILES[0]];
        x < 3 || x + 3 >= TILES[0] || y < 3 || y + 3 >= TILES[1]
    };
    let mut outer: Vec<(f64, u32)> = (0..map.len())
        .filter(|index| is_outer(*index))
        .map(|index| (contrasts[index], octaves(map[index])))
        .collect();
    outer.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |tiles: &[(f64, u32)]| {
        tiles.iter().map(|(_, octaves)| f64::from(*octaves)).sum::<f64>() / tiles.len() as f64
    };
    let third = outer.len() / 3;
    let (flat, detailed) = (mean(&outer[..third]), mean(&outer[2 * third..]));
    println!("half octaves: {flat:.2} where it is flat, {detailed:.2} where it is not");
    assert!(flat > detailed + 0.5, "{flat} {detailed}\n{map:?}");
}
