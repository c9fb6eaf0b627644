//! Whether the system's sound can be heard, where the configuration asks for it.

use super::configuration::in_force;
use super::layers::Layers;
use super::{Finding, Surroundings};
use crate::install::{AUDIO_LIBRARY_NAME, is_audio};
use crate::json::Half;
use crate::options::AudioSource;
use crate::sound_server::{NoSocket, socket};
use std::ffi::OsStr;
use std::fs;
use std::os::unix::net::UnixStream;

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

/// The sound capture library lies beside the layer.
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

/// A connection to PulseAudio, or to PipeWire in its place, as the capture makes it.
fn server(surroundings: &Surroundings) -> Finding {
    let means = "Without an ALSA loopback card, sound cannot be captured and has no effect.";
    let socket = match socket(|name| surroundings.set(name).map(OsStr::to_owned)) {
        Ok(socket) => socket,
        Err(error) => {
            let advice = match error {
                NoSocket::Remote => "unset PULSE_SERVER, or name a socket of this computer: unix:/PATH",
                NoSocket::NoFolder => "log in to a desktop session, or set XDG_RUNTIME_DIR to its folder",
            };
            return Finding::warning("no-sound-server", error.to_string(), means).advise(advice);
        }
    };
    match UnixStream::connect(&socket) {
        Ok(_) => Finding::good("sound", format!("sound is captured from {}", socket.display())),
        Err(error) => Finding::warning(
            "no-sound-server",
            format!("no PulseAudio or PipeWire server at {}: {error}", socket.display()),
            means,
        )
        .advise("start it: systemctl --user start pipewire-pulse, or pulseaudio"),
    }
}
