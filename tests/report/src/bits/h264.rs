//! H.264, by the system's ffmpeg with libx264: a clip of one eye at a fixed quantiser.

use super::planes::{Planes, Sampling, squared_error};
use super::{Encoded, Size};
use parafovea_tests::artifacts::system_program;
use parafovea_tests::picture::Picture;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Quantisers from fine to small, as in the standard's own comparisons.
pub const QUANTISERS: [u8; 4] = [22, 27, 32, 37];

/// Whether the system has it.
pub fn is_there() -> bool {
    let encoders =
        ffmpeg(&["-encoders"]).and_then(|mut command| command.output().map_err(|error| error.to_string()));
    encoders.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(" libx264 "))
}

fn ffmpeg(arguments: &[&str]) -> Result<Command, String> {
    let mut command = Command::new(system_program("ffmpeg").map_err(|error| error.to_string())?);
    command.args(["-hide_banner", "-loglevel", "error", "-y"]).args(arguments).stdin(Stdio::null());
    Ok(command)
}

/// Encodes a clip, and compares luma with the original's.
pub fn encode(clip: &[Picture], sampling: Sampling, quantiser: u8) -> Result<Encoded, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let planes: Vec<Planes> = clip.iter().map(Planes::of).collect();
    let [all, grey] = [true, false].map(|colour| stream(&planes, sampling, colour, quantiser, folder.path()));
    let (all, grey) = (all?, grey?);
    let decoded = decode(&all, sampling, folder.path())?;
    let Some(first) = planes.first() else { return Err("H.264: no pictures".to_owned()) };
    let (luma, frame) = (first.pixels.len(), first.raw(sampling, false).len());
    if decoded.len() != frame * planes.len() {
        return Err(format!("H.264: {} bytes were decoded, not {}", decoded.len(), frame * planes.len()));
    }
    let frames = decoded.chunks_exact(frame).zip(&planes);
    let errors = frames.map(|(frame, right)| squared_error(frame[..luma].iter().copied(), right.luma()));
    Ok(Encoded {
        size: Size { total: 8 * all.len() as u64, luma: 8 * grey.len() as u64 },
        squared_error: errors.sum(),
        pixels: (luma * planes.len()) as u64,
    })
}

fn pixel_format(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Half => "yuv420p",
        Sampling::Full => "yuv444p",
    }
}

fn stream(
    planes: &[Planes],
    sampling: Sampling,
    colour: bool,
    quantiser: u8,
    folder: &Path,
) -> Result<Vec<u8>, String> {
    let Some(first) = planes.first() else { return Err("H.264: no pictures".to_owned()) };
    let path = folder.join("clip.h264");
    let (size, quantiser) = (format!("{}x{}", first.width, first.height), quantiser.to_string());
    let input = ["-f", "rawvideo", "-pix_fmt", pixel_format(sampling), "-s", &size, "-r", "90", "-i", "-"];
    let output = ["-c:v", "libx264", "-qp", &quantiser, "-f", "h264"];
    let mut command = ffmpeg(&[&input[..], &output[..]].concat())?;
    command.arg(&path).stdin(Stdio::piped());
    let failed = |error: std::io::Error| format!("H.264: {error}");
    let mut child = command.spawn().map_err(failed)?;
    // It is taken, so that ffmpeg sees its end.
    if let Some(mut pipe) = child.stdin.take() {
        for planes in planes {
            pipe.write_all(&planes.raw(sampling, colour)).map_err(failed)?;
        }
    }
    let status = child.wait().map_err(failed)?;
    if !status.success() {
        return Err(format!("H.264: ffmpeg ended with {status}"));
    }
    std::fs::read(&path).map_err(failed)
}

fn decode(stream: &[u8], sampling: Sampling, folder: &Path) -> Result<Vec<u8>, String> {
    let [from, to] = ["stream.h264", "decoded.yuv"].map(|name| folder.join(name));
    let failed = |error: std::io::Error| format!("H.264: {error}");
    std::fs::write(&from, stream).map_err(failed)?;
    let mut command = ffmpeg(&["-f", "h264", "-i"])?;
    command.arg(&from).args(["-f", "rawvideo", "-pix_fmt", pixel_format(sampling)]).arg(&to);
    let status = command.status().map_err(failed)?;
    if !status.success() {
        return Err(format!("H.264: ffmpeg ended with {status} while it decoded"));
    }
    std::fs::read(&to).map_err(failed)
}
