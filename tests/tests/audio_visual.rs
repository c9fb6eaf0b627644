//! Rates by the contrast of images and by sound, in running applications.

use parafovea_core::rate::ShadingRate;
use parafovea_test_layers::{ShadingRateFinding, ShadingRateLine, ShadingRatePass, ShadingRateProfile};
use parafovea_tests::compare::psnr_db;
use parafovea_tests::measure::Player;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Message, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::time::Duration;

/// Until every pass is known and rates have settled, frames.
pub const SETTLED: u64 = 70;

/// Most frames, 100 ms of real time each, that pass until sound is captured.
pub const MOST_WAITED: u64 = 200;

/// 100 ms of the runtime's time, frames.
const LEAST_BETWEEN: usize = 9;

/// The test layer copies each map before its pass, and leaves it in a layout for everything.
const COPY_OF_MAP: &str = "vkCmdCopyImageToBuffer: For optimal performance";

/// Log line of rates that are decided on the CPU.
const FALLS_BACK: &str = "rings instead of rates by contrast";

/// Tiles of 16 x 16 along the sides of a picture of 256 x 224.
const TILES: [usize; 2] = [16, 14];

fn config(mode: &str, rest: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"{mode}\"\nsilence = \"fixed\"\ngate = \"on\"\n{rest}\n"
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

/// Asserts that validation reports nothing new against the run without the layer.
fn assert_valid(outcome: &Outcome, reference: &Outcome) {
    let is_copy_of_map = |found: &Message| found.text.contains(COPY_OF_MAP);
    let mut new = outcome.findings.beyond(&reference.findings);
    new.retain(|found| !is_copy_of_map(found));
    assert!(new.is_empty(), "{new:#?}");
}

/// The newest map of a pass that draws a picture; the layer below finds nothing wrong.
fn newest_map(outcome: &Outcome) -> Vec<u8> {
    maps(outcome).pop().unwrap()
}

/// The maps of all passes that draw a picture, an eye after the other; the layer below finds nothing wrong.
fn maps(outcome: &Outcome) -> Vec<Vec<u8>> {
    let (mut findings, mut maps): (Vec<ShadingRateFinding>, Vec<Vec<u8>>) = (Vec::new(), Vec::new());
    for line in outcome.shading_rates().unwrap() {
        match line {
            ShadingRateLine::Finding(finding) => findings.push(finding),
            // The runtime draws its saved pictures as UNORM.
            ShadingRateLine::Pass(pass) if pass.formats != ["R8G8B8A8_SRGB"] || pass.map.is_none() => {}
            ShadingRateLine::Pass(ShadingRatePass { map, .. }) => {
                let texels = map.unwrap().texels.unwrap();
                let digits =
                    |index: usize| u8::from_str_radix(&texels[2 * index..2 * index + 2], 16).unwrap();
                maps.push((0..texels.len() / 2).map(digits).collect());
            }
        }
    }
    assert_eq!(findings, []);
    maps
}

/// A tone of 1 kHz at -10 LUFS, and seconds of silence after it, over and over, in a folder that lives as long as it is kept.
fn tone(seconds: u32, silent: u32) -> (tempfile::TempDir, String) {
    tone_at(-10.0, seconds, silent)
}

/// The same at another loudness, LUFS.
pub fn tone_at(lufs: f64, seconds: u32, silent: u32) -> (tempfile::TempDir, String) {
    const RATE: u32 = 48_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tone.wav");
    let samples: Vec<u8> = (0..(seconds + silent) * RATE)
        .flat_map(|index| {
            if index >= seconds * RATE {
                return vec![0; 4];
            }
            let phase = f64::from(index) * 1000.0 / f64::from(RATE) * std::f64::consts::TAU;
            // A sine of full scale in both channels has 0 LUFS.
            let sample = (phase.sin() * 10f64.powf(lufs / 20.0) * 32767.0) as i16;
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

/// Without sound and movement the layer submits nothing, as with fixed rates: no analysis, and no decision.
#[test]
fn in_silence_nothing_is_recomputed() {
    const MORE: u64 = 20;
    let own_submits = |mode: &str, frames: u64| {
        let run = scene(frames).shading_rates(ShadingRateProfile::NvkTuring).faulted(None);
        let outcome = run.on(&config(mode, "")).finish().unwrap().expect_frames(frames).unwrap();
        let reports = outcome.faults().unwrap();
        let of = |name: &str| reports.iter().filter_map(|report| report.own.get(name)).sum::<u64>();
        of("vkQueueSubmit") + of("vkQueueSubmit2")
    };
    let in_settled_frames = |mode| own_submits(mode, SETTLED + MORE) - own_submits(mode, SETTLED);
    let [fixed, silent] = ["fixed", "audio-visual"].map(in_settled_frames);
    assert_eq!([fixed, silent], [0, 0]);
}

/// An application that hears, each of whose frames comes when it is let.
pub struct Listening {
    player: Player,
    heard: std::path::PathBuf,
    frames: u64,
    _folder: tempfile::TempDir,
}

impl Listening {
    pub fn start(arguments: &[&str], frames: u64, config: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let heard = folder.path().join("heard");
        let application = Application::ours("parafovea-scene", arguments).unwrap();
        let scenario = Scenario::new(frames).sized(256, 224).saving(&[frames - 1]);
        let configured = |run: Run| {
            let run =
                run.with_audio_library().unwrap().validated().shading_rates(ShadingRateProfile::NvkTuring);
            run.on(config).env("PARAFOVEA_FEATURES_FILE", &heard).timeout(Duration::from_secs(900))
        };
        let player = Player::alone(&application, scenario, configured).unwrap();
        Self { player, heard, frames: 0, _folder: folder }
    }

    pub fn play(&mut self, frames: u64) {
        (0..frames).for_each(|_| self.player.play());
        self.frames += frames;
    }

    /// Whether plans take a sound into account.
    fn is_heard(&self) -> bool {
        let lines = std::fs::read_to_string(&self.heard).unwrap_or_default();
        lines.lines().last().is_some_and(|line| line.contains("\"silent\":false"))
    }

    /// Frames until sound is captured, or no longer captured.
    pub fn play_until_heard(&mut self, is_heard: bool) {
        for _ in 0..MOST_WAITED {
            self.play(1);
            if self.is_heard() == is_heard {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        let lines = std::fs::read_to_string(&self.heard).unwrap_or_default();
        panic!("heard is not {is_heard} after {MOST_WAITED} frames:\n{lines}");
    }

    /// All maps of the right eye, by frame; of the first frames there are none.
    pub fn finish(self, frames: u64) -> (Outcome, Vec<Vec<u8>>) {
        let outcome = self.player.finish().unwrap().expect_frames(frames).unwrap();
        assert!(!outcome.log.contains(FALLS_BACK), "{}", outcome.log);
        // The passes of the right eye come last.
        let mut maps: Vec<Vec<u8>> = maps(&outcome).into_iter().rev().step_by(2).collect();
        maps.resize(frames as usize, Vec::new());
        maps.reverse();
        (outcome, maps)
    }
}

/// No tile becomes coarser within 100 ms of its last change; nor, where nothing but noise changes, finer.
fn assert_steady(maps: &[Vec<u8>], constant: bool) {
    let octaves = |texel: u8| ShadingRate::from_texel(texel).unwrap().octaves();
    let maps: Vec<&Vec<u8>> = maps.iter().filter(|map| !map.is_empty()).collect();
    for tile in 0..TILES[0] * TILES[1] {
        let mut last = None;
        for (frame, pair) in maps.windows(2).enumerate() {
            let [before, now] = [pair[0][tile], pair[1][tile]];
            if before == now {
                continue;
            }
            let passed = last.replace(frame).map_or(usize::MAX, |last: usize| frame - last);
            let counts = constant || octaves(now) > octaves(before);
            assert!(
                !counts || passed >= LEAST_BETWEEN,
                "tile {tile} from {before} to {now}, {passed} frames after its last change, {frame} frames after the first map"
            );
        }
    }
}

/// The map of rings that holds in silence.
fn rings() -> Vec<u8> {
    let run = scene(SETTLED).shading_rates(ShadingRateProfile::NvkTuring).on(&config("fixed", ""));
    newest_map(&finish(run, SETTLED))
}

/// Sound that starts and stops coarsens and refines tiles, none of them twice within 100 ms. After it the rings hold.
#[test]
fn sound_comes_and_goes() {
    let (_folder, audio) = tone(8, 60);
    let config_with = |window_s: f32| config("audio-visual", &format!("{audio}window_s = {window_s}\n"));
    let frames = 3 * MOST_WAITED + 3 * SETTLED;
    let mut listening = Listening::start(&["--still"], frames, &config_with(1.0));
    listening.play_until_heard(true);
    listening.play(SETTLED);
    listening.play_until_heard(false);
    listening.play(SETTLED);
    assert!(!listening.is_heard());
    let silent = listening.frames;
    // With other settings the file starts again.
    std::fs::write(listening.player.config_file(), config_with(1.1)).unwrap();
    listening.play_until_heard(true);
    listening.play(5);
    assert!(listening.is_heard());
    let again = listening.frames;
    listening.play(SETTLED);
    let (outcome, maps) = listening.finish(frames);
    let at = |frame: u64| &maps[frame as usize - 1];
    let rings = rings();
    // Between the rings of coarsening and of refinement a tile keeps the rate that sound gave it.
    let others = at(silent).iter().zip(&rings).filter(|(tile, ring)| tile != ring).count();
    assert!(others * 50 <= rings.len(), "{others} tiles are not at their rings in silence\n{}", outcome.log);
    assert!(at(again) != &rings, "sound changes nothing in frame {again}");
    assert_steady(&maps, false);
}

/// While one sound lasts, rates settle. All lights go out, and they settle again.
#[test]
fn a_scene_cut_is_followed_without_oscillation() {
    let (_folder, audio) = tone(2, 0);
    let cut = MOST_WAITED + 2 * SETTLED;
    let frames = cut + 2 * SETTLED;
    let arguments = ["--still", "--lights-out", &cut.to_string()];
    let mut listening = Listening::start(&arguments, frames, &config("audio-visual", &audio));
    listening.play_until_heard(true);
    let steady = (listening.frames + 2) as usize;
    let (outcome, maps) = listening.finish(frames);
    let cut = cut as usize;
    assert_steady(&maps[steady..cut], true);
    assert_steady(&maps, false);
    // Each tile as coarse as it was at its coarsest lately: in each frame others are on their way back from a look at full rate.
    let settled = |end: usize| -> Vec<u32> {
        let lately = &maps[end - SETTLED as usize / 2..end];
        let coarsest = |tile: usize| lately.iter().map(|map| octaves(map[tile])).max();
        (0..maps[end - 1].len()).filter_map(coarsest).collect()
    };
    let window = SETTLED as usize / 2;
    let [before, lit, dark] = [cut - window, cut, frames as usize].map(settled);
    let changed = |other: &[u32]| lit.iter().zip(other).filter(|(lit, other)| lit != other).count();
    let [by_time, by_cut] = [changed(&before), changed(&dark)];
    println!("of {} tiles {by_time} get other rates with time, {by_cut} in the dark", lit.len());
    assert!(lit.iter().sum::<u32>() > 0 && by_cut > 2 * by_time, "{by_time} {by_cut}\n{}", outcome.log);
}

/// In silence rings hold: maps of the GPU then equal the CPU's, to the last bit, on both backends.
#[test]
fn rings_from_the_gpu_are_those_of_the_cpu() {
    const FRAMES: u64 = SETTLED;
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
    let picture_of = |mode: &str, rest: &str| {
        let rest = format!("backend = \"mask\"\n{rest}");
        let outcome = finish(scene(FRAMES).with_audio_library().unwrap().on(&config(mode, &rest)), FRAMES);
        assert!(!outcome.log.contains(FALLS_BACK), "{}", outcome.log);
        assert!(outcome.log.contains(": masked"), "{}", outcome.log);
        assert_valid(&outcome, &reference);
        [0, 1].map(|view| outcome.submitted(view, FRAMES - 1).unwrap())
    };
    let fixed = picture_of("fixed", "");
    assert!(fixed == picture_of("audio-visual", ""), "another mask");
    // There is no server of sound in a test.
    assert!(
        fixed == picture_of("audio-visual", "[audio]\nsource = \"system\""),
        "another mask without a server"
    );
    assert!(fixed[0] != reference.submitted(0, FRAMES - 1).unwrap(), "nothing is skipped");
    // The search for changes does not wait, so that the re-used tiles differ from run to run, and more on a busy machine: another
    // map would differ in each run.
    let least_psnr_db = || {
        let [fixed, silent] =
            ["fixed", "audio-visual"].map(|mode| picture_of(mode, "[reuse]\nmode = \"on\""));
        let of_views = fixed.iter().zip(&silent).map(|(fixed, silent)| psnr_db(fixed, silent, |_, _| true));
        of_views.fold(f64::INFINITY, f64::min)
    };
    assert!((0..3).any(|_| least_psnr_db() >= 30.0), "less than 30 dB with re-use, three times");
}

/// At a small loss flat tiles are coarse and others are not.
#[test]
fn maps_follow_the_picture() {
    let (_folder, audio) = tone(2, 0);
    let frames = MOST_WAITED + SETTLED;
    let settings = format!("greatest_loss = 2.5\n{audio}");
    let mut listening = Listening::start(&["--still"], frames, &config("audio-visual", &settings));
    listening.play_until_heard(true);
    let (outcome, maps) = listening.finish(frames);
    let map = maps.last().unwrap();
    assert_eq!(map.len(), TILES[0] * TILES[1]);
    let contrasts = contrasts(&outcome.submitted(1, frames - 1).unwrap());
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
