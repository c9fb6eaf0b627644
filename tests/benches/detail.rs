//! `cargo dev bench detail [--size PIXELS] [--styles A,B] [--step DEGREES] [--keep FOLDER]`: loss of detail by coarse
//! shading, where a block has one decision: blades cut out by `discard`, lines filtered by derivatives, histories of temporal anti-aliasing.
//!
//! The eyes rest, and then step to another place, in as long as a saccade takes. Pictures are compared with those without the layer: over the view while the eyes
//! rest, and around the new place from the frame in which the eyes land on, by rule. Masks are the layer's own, on a device without rates. With rate
//! attachments the maps are the layer's on a device with emulated rates, and the styles' shaders show the look of such a map
//! (`parafovea-zoo --look`).

use parafovea_test_layers::{
    SHADING_RATE_GPU_VARIABLE, SHADING_RATE_TEXELS_VARIABLE, ShadingRateLine, ShadingRatePass,
    ShadingRateProfile,
};
use parafovea_tests::detail::{View, finer, shaded};
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HZ: f64 = 90.0;
/// Frames until rates are as coarse as they become, and histories hold nothing finer.
const REST: u64 = 100;
/// The frame of the rest that is judged, before the eyes leave.
const SEEN: u64 = REST - 16;
/// Frames after the step.
const AFTER: u64 = 16;
/// Frames of the table, counted from the step.
const SHOWN: [u64; 6] = [0, 1, 2, 4, 8, 15];
/// Elevation of the gaze before and after the step, degrees.
const HEIGHTS: [f32; 2] = [3.0, -2.0];
/// The new place, degrees around the gaze.
const PLACE_DEG: f32 = 10.0;

fn main() -> ExitCode {
    let done = Request::read(std::env::args().skip(1)).map_err(Into::into);
    match done.and_then(|request| request.measure()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Request {
    size: u32,
    styles: Vec<String>,
    /// Step of the gaze to the left, degrees.
    step: f32,
    /// Folder for the images of the rest; None to discard them.
    keep: Option<PathBuf>,
}

/// The layer's maps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Maps {
    /// Rings around the gaze.
    Rings,
    /// By the contrast of the picture, as on a GPU.
    Contrast,
}

impl Maps {
    fn name(self) -> &'static str {
        match self {
            Self::Rings => "rings",
            Self::Contrast => "contrast",
        }
    }
}

/// A rule over the maps of attachments.
struct Rule {
    name: &'static str,
    /// Arguments of the look.
    look: &'static [&'static str],
    /// Whether maps are finer by one step along each axis.
    is_finer: bool,
    /// The styles that it changes.
    styles: &'static [&'static str],
}

const BOTH: &[&str] = &["foliage", "taa"];

const RULES: [Rule; 7] = [
    Rule { name: "discard obeys", look: &[], is_finer: false, styles: BOTH },
    Rule {
        name: "discard obeys, behind a pre-pass",
        look: &["--look-prepass"],
        is_finer: false,
        styles: &["foliage"],
    },
    Rule { name: "discard at most 2x2", look: &["--look-discarding", "2x2"], is_finer: false, styles: BOTH },
    Rule { name: "discard at 1x1", look: &["--look-discarding", "1x1"], is_finer: false, styles: BOTH },
    Rule {
        name: "discard at 1x1, gradients of pixels",
        look: &["--look-discarding", "1x1", "--look-pixel-filter"],
        is_finer: false,
        styles: &["foliage"],
    },
    Rule {
        name: "discard at 1x1, the history obeys",
        look: &["--look-discarding", "1x1", "--look-history", "4x4"],
        is_finer: false,
        styles: &["taa"],
    },
    Rule {
        name: "discard at 1x1, all finer by one",
        look: &["--look-discarding", "1x1"],
        is_finer: true,
        styles: BOTH,
    },
];

/// Masks, by the coarsest that they may be.
const MASKS: [(&str, &str); 3] =
    [("mask, as now", "auto"), ("mask, at least a quarter", "2x2"), ("mask, a sixteenth", "4x4")];

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self {
            size: 768,
            styles: BOTH.iter().map(|&style| style.to_owned()).collect(),
            step: 34.0,
            keep: None,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--size" => {
                    let size = value();
                    request.size =
                        size.parse().map_err(|_| format!("--size needs a whole number, not `{size}`"))?;
                }
                "--step" => {
                    let step = value();
                    request.step = step.parse().map_err(|_| format!("--step needs degrees, not `{step}`"))?;
                }
                "--styles" => request.styles = value().split(',').map(str::to_owned).collect(),
                "--keep" => request.keep = Some(value().into()),
                other => {
                    return Err(format!(
                        "unknown argument `{other}`; allowed: --size, --styles, --step, --keep"
                    ));
                }
            }
        }
        Ok(request)
    }

    fn measure(&self) -> Result<(), Box<dyn Error>> {
        let frames: Vec<String> = SHOWN.iter().map(u64::to_string).collect();
        let frames = frames.join(", ");
        println!(
            "| style | maps | rule | shaded | view: JND, 99 % | new place, JND in frames {frames} | RMS, code values, in frames {frames} |"
        );
        println!("|---|---|---|---|---|---|---|");
        for style in &self.styles {
            self.measure_style(style)?;
        }
        Ok(())
    }

    fn measure_style(&self, style: &str) -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let off = self.finish(self.run(style, &[])?)?;
        self.keep_picture(&format!("{style}-off"), &off)?;
        for (name, peripheral) in MASKS {
            let config = config(folder.path(), self.gazes(), Maps::Rings, peripheral)?;
            let on = self.finish(self.run(style, &[])?.layer(LayerMode::On(config)))?;
            self.tell([style, "rings", name], None, [&off, &on])?;
        }
        for maps in [Maps::Rings, Maps::Contrast] {
            let file = folder.path().join("maps.jsonl");
            let run = self.run(style, &[])?.shading_rates(ShadingRateProfile::NvkTuring);
            let run = run.layer(LayerMode::On(config(folder.path(), self.gazes(), maps, "auto")?));
            let run = run.env(SHADING_RATE_TEXELS_VARIABLE, "1");
            let run = if maps == Maps::Contrast { run.env(SHADING_RATE_GPU_VARIABLE, "1") } else { run };
            let attached = passes(&self.finish(run)?)?;
            for rule in RULES.iter().filter(|rule| rule.styles.contains(&style)) {
                let (text, share) = by_rule(&attached, style, rule.is_finer)?;
                std::fs::write(&file, text)?;
                let path = file.to_string_lossy();
                let arguments = [&["--look", &path][..], rule.look].concat();
                let on = self.finish(self.run(style, &arguments)?)?;
                self.tell([style, maps.name(), rule.name], Some(share), [&off, &on])?;
            }
        }
        Ok(())
    }

    fn run(&self, style: &str, look: &[&str]) -> Result<Run, Box<dyn Error>> {
        let frames = REST + AFTER;
        let (size, count) = (self.size.to_string(), frames.to_string());
        let arguments = [&["--style", style, "--size", &size, "--frames", &count][..], look].concat();
        let saved: Vec<u64> = [SEEN].into_iter().chain(REST..frames).collect();
        let mut scenario = Scenario::new(frames).sized(self.size, self.size).saving(&saved);
        scenario.clock.refresh_hz = HZ;
        Ok(Run::new(&Application::ours("parafovea-zoo", &arguments)?, &scenario).layer(LayerMode::Off))
    }

    /// Gaze directions before and after the step: degrees to the left and upwards.
    fn gazes(&self) -> [[f32; 2]; 2] {
        [[-0.5 * self.step, HEIGHTS[0]], [0.5 * self.step, HEIGHTS[1]]]
    }

    fn finish(&self, run: Run) -> Result<Outcome, Box<dyn Error>> {
        Ok(run.finish()?.expect_frames(REST + AFTER)?)
    }

    fn tell(
        &self,
        [style, maps, rule]: [&str; 3],
        shaded: Option<f64>,
        [off, on]: [&Outcome; 2],
    ) -> Result<(), Box<dyn Error>> {
        let compared = |frame: u64, gaze: [f32; 2]| -> Result<View, Box<dyn Error>> {
            Ok(View::compare(&off.submitted(0, frame)?, &on.submitted(0, frame)?, gaze)?)
        };
        let [rest, new] = self.gazes();
        let (mut seen, mut squared) = (String::new(), String::new());
        for (index, frame) in SHOWN.into_iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            let place = compared(REST + frame, new)?.within(PLACE_DEG);
            write!(seen, "{comma}{:.2}", place.mean_jnd())?;
            write!(squared, "{comma}{:.1}", place.root_mean_square())?;
        }
        let rest = compared(SEEN, rest)?;
        let (mean, most) = (rest.mean_jnd(), rest.greatest_jnd(0.01));
        let shaded = shaded.map_or("-".to_owned(), |share| format!("{share:.2}"));
        println!("| {style} | {maps} | {rule} | {shaded} | {mean:.2}, {most:.1} | {seen} | {squared} |");
        self.keep_picture(&format!("{style}-{maps}-{}", rule.replace([' ', ','], "-")), on)
    }

    /// Saves the judged picture of the rest if `--keep` names a folder.
    fn keep_picture(&self, name: &str, outcome: &Outcome) -> Result<(), Box<dyn Error>> {
        let Some(folder) = &self.keep else { return Ok(()) };
        std::fs::create_dir_all(folder)?;
        Ok(outcome.submitted(0, SEEN)?.save(&folder.join(format!("{name}.png")))?)
    }
}

/// The layer with its gate open. The eyes rest, and land at the new place after as long as a saccade takes.
fn config(
    folder: &Path,
    [rest, new]: [[f32; 2]; 2],
    maps: Maps,
    peripheral: &str,
) -> std::io::Result<String> {
    // Just before the first frame at the new place. A saccade takes 21 ms, and 2.2 ms a degree (Bahill et al. 1975, from memory).
    let landed_s = (REST as f64 - 0.5) / HZ;
    let flight_s = 0.021 + 0.0022 * f64::from((new[0] - rest[0]).hypot(new[1] - rest[1]));
    let gaze = format!(
        "0,{},{}\n{},{},{}\n{},{},{}\n",
        rest[0],
        rest[1],
        landed_s - flight_s,
        rest[0],
        rest[1],
        landed_s,
        new[0],
        new[1]
    );
    let file = folder.join("gaze.txt");
    std::fs::write(&file, gaze)?;
    let mode = match maps {
        Maps::Rings => "fixed",
        Maps::Contrast => "auto",
    };
    Ok(format!(
        "[gaze]\nsource = \"file\"\nfile = {file:?}\n[rates]\nmode = \"{mode}\"\nperipheral = \"{peripheral}\"\ngate = \"on\"\n\
         [chroma]\nmode = \"off\"\n"
    ))
}

/// The passes with rate attachments, in the order of their submits.
fn passes(outcome: &Outcome) -> Result<Vec<ShadingRatePass>, Box<dyn Error>> {
    let lines = outcome.shading_rates()?.into_iter().map(|line| match line {
        ShadingRateLine::Pass(pass) => Ok(pass),
        ShadingRateLine::Finding(finding) => Err(format!("{finding:?}").into()),
    });
    lines.collect()
}

/// A file with the maps of passes by a rule, and the mean share of the pixels that coarse maps of frames before the step shade. Each pass of
/// the style draws colour, so that all of them have maps.
fn by_rule(passes: &[ShadingRatePass], style: &str, is_finer: bool) -> Result<(String, f64), Box<dyn Error>> {
    let style = parafovea_zoo::style(style).ok_or("no such style")?;
    let in_frame = (style.passes)([1; 2], 0).len() as u64;
    let (mut out, mut shares) = (String::new(), Vec::new());
    for pass in passes {
        let (frame, index) = (pass.index / in_frame, pass.index % in_frame);
        let map = pass.map.as_ref().ok_or("a map that was not read in time")?;
        let attached = map.texels.as_ref().ok_or("a map without texels")?;
        let rates = if is_finer { finer(attached) } else { attached.clone() };
        if (SEEN - 8..=SEEN).contains(&frame) && rates.contains(|digit| digit != '0') {
            shares.push(shaded(&rates));
        }
        let map = serde_json::json!({"texel": pass.texel, "tiles": map.extent, "rates": rates});
        writeln!(out, "{}", serde_json::json!({"frame": frame, "index": index, "map": map}))?;
    }
    if shares.is_empty() {
        return Err("no pass is coarse".into());
    }
    Ok((out, shares.iter().sum::<f64>() / shares.len() as f64))
}
