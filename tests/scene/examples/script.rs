//! Writes a scene's script: the sound as a WAV file, head and gaze as keyframes of the mock runtime's scenario.
//!
//! `cargo run -p parafovea-scene --example script -- --scene street --tracker good --wav street.wav --toml street.toml`

use std::fmt::Write;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Parser;
use parafovea_scene::scene::{FRAMES_PER_SECOND, SceneName};
use parafovea_scene::script::{Script, tracker::Tracker};

#[derive(Parser)]
struct Options {
    #[arg(long, value_enum, default_value_t)]
    scene: SceneName,
    /// Eye tracker that reports the gaze: ideal, good or poor.
    #[arg(long, default_value = "good")]
    tracker: String,
    /// Write the sound to this file.
    #[arg(long)]
    wav: Option<PathBuf>,
    /// Write the keyframes to this file.
    #[arg(long)]
    toml: Option<PathBuf>,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let script = Script::new(options.scene);
    let tracker = Tracker::named(&options.tracker).context("the tracker is ideal, good or poor")?;
    if let Some(path) = &options.wav {
        let file = File::create(path).with_context(|| format!("creating {}", path.display()))?;
        script.sound.write_wav(BufWriter::new(file))?;
    }
    if let Some(path) = &options.toml {
        let mut text = String::new();
        for key in script.head.keyframes(FRAMES_PER_SECOND) {
            let ([x, y, z], yaw, pitch, roll) = (key.position, key.yaw_deg, key.pitch_deg, key.roll_deg);
            writeln!(text, "[[head]]\nt = {:?}\nposition = [{x:?}, {y:?}, {z:?}]", key.t)?;
            writeln!(text, "yaw_deg = {yaw:?}\npitch_deg = {pitch:?}\nroll_deg = {roll:?}")?;
        }
        for key in tracker.keyframes(&script.gaze) {
            writeln!(text, "[[gaze]]\nt = {:?}\nyaw_deg = {:?}", key.t, key.yaw_deg)?;
            writeln!(text, "pitch_deg = {:?}\ntracked = {}", key.pitch_deg, key.tracked)?;
        }
        std::fs::write(path, text).with_context(|| format!("writing {}", path.display()))?;
    }
    println!("{}: {} saccades", options.scene.as_str(), script.gaze.saccades().len());
    for saccade in script.gaze.saccades() {
        println!(
            "{:7.3} s: {:5.1} degrees in {:3.0} ms",
            saccade.start_s,
            saccade.amplitude_deg,
            saccade.duration_s * 1e3
        );
    }
    println!("{:?} LUFS; {} blinks", script.sound.loudness_lufs, script.gaze.blinks().len());
    Ok(())
}
