//! Whether the system's sound can be heard, where the configuration asks for it.

use super::configuration::in_force;
use super::layers::Layers;
use super::{Finding, Surroundings};
use crate::install::{AUDIO_LIBRARY_NAME, is_audio};
use crate::json::Half;
use crate::options::AudioSource;
use std::fs;
use std::path::PathBuf;

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let Some(config) = in_force(surroundings).1 else { return Vec::new() };
    if config.audio.source == AudioSource::Off {
        return vec![Finding::good("no-sound-wanted", "sound capture is off (audio.source = \"off\")")];
    }
    [library(surroundings, layers), alsa(surroundings)]
        .into_iter()
        .flatten()
        .chain((config.audio.source == AudioSource::System).then(|| server(surroundings)))
        .collect()
}

/// The library that listens lies beside the layer.
fn library(surroundings: &Surroundings, layers: &Layers) -> Option<Finding> {
    let layer = layers.library(surroundings, Half::OpenXr)?.canonicalize().ok()?;
    let path = layer.with_file_name(AUDIO_LIBRARY_NAME);
    let is_there = fs::read(&path).is_ok_and(|bytes| is_audio(&bytes));
    (!is_there).then(|| {
        Finding::problem(
            "no-audio-library",
            format!("{} is missing, or not a Parafovea library", path.display()),
            "Without it, sound cannot be captured.",
        )
        .advise("put it beside libparafovea.so (to build it: cargo build --release -p parafovea-audio), then: parafovea install")
    })
}

fn alsa(surroundings: &Surroundings) -> Option<Finding> {
    // NixOS and Guix have libraries in other folders, which are not searched.
    let is_elsewhere = surroundings.library("libvulkan.so.1").is_none() && surroundings.probed.vulkan.is_ok();
    (!is_elsewhere && surroundings.library("libasound.so.2").is_none()).then(|| {
        Finding::problem(
            "no-alsa",
            "the system has no ALSA library (libasound.so.2)",
            "The capture library needs it, so sound cannot be captured.",
        )
        .advise("install it (Debian 13, Ubuntu 24.04 and later: libasound2t64; earlier: libasound2)")
    })
}

/// The socket of PulseAudio, or of PipeWire in its place.
fn server(surroundings: &Surroundings) -> Finding {
    let named = surroundings.variable("PULSE_SERVER").map(|server| server.to_string_lossy().into_owned());
    let socket = match &named {
        Some(server) => match server.strip_prefix("unix:") {
            Some(path) => PathBuf::from(path),
            None if server.starts_with('/') => PathBuf::from(server),
            None => return Finding::good("sound", format!("sound is captured from {server} (PULSE_SERVER)")),
        },
        None => match surroundings.variable("XDG_RUNTIME_DIR") {
            Some(folder) => PathBuf::from(folder).join("pulse/native"),
            None => PathBuf::from("pulse/native"),
        },
    };
    if fs::metadata(&socket).is_ok() {
        return Finding::good("sound", format!("sound is captured from {}", socket.display()));
    }
    Finding::warning(
        "no-sound-server",
        format!("no PulseAudio or PipeWire server: no socket {}", socket.display()),
        "Without an ALSA loopback card, sound cannot be captured and has no effect.",
    )
    .advise("start it: systemctl --user start pipewire-pulse, or pulseaudio")
}
