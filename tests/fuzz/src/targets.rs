//! Readers of foreign data, and their invariants.

use parafovea::abi::pnext::{Header, MAX_LENGTH, Structure, chain};
use parafovea::inputs::gaze::osc::{OscGaze, read};
use parafovea::inputs::gaze::script::GazeScript;
use parafovea::vk::FragmentShaders;
use parafovea_audio::wav::Wav;
use parafovea_manifest::config;
use parafovea_manifest::json::Half;
use parafovea_mock_runtime::scenario::Scenario;
use std::borrow::Cow;
use std::io::Cursor;
use std::net::SocketAddr;
use std::path::Path;
use std::ptr::null;

/// Something that reads.
#[derive(Debug)]
pub struct Target {
    /// Its name, and that of its corpus.
    pub name: &'static str,
    /// Reads an input; panics where something does not hold.
    pub execute: fn(&[u8]),
}

/// All of them.
pub const TARGETS: [Target; 8] = [
    Target { name: "config", execute: config },
    Target { name: "gaze", execute: gaze },
    Target { name: "manifest", execute: manifest },
    Target { name: "osc", execute: osc },
    Target { name: "pnext", execute: pnext },
    Target { name: "scenario", execute: scenario },
    Target { name: "spirv", execute: spirv },
    Target { name: "wav", execute: wav },
];

fn text(input: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(input)
}

/// A configuration, or lines that each name the file.
fn config(input: &[u8]) {
    if let Err(errors) = config::parse(Path::new("/some/config.toml"), &text(input)) {
        let told = errors.to_string();
        assert!(
            !told.is_empty() && told.lines().all(|line| line.starts_with("/some/config.toml: ")),
            "{told}"
        );
        assert!(told.lines().count() <= 11, "{told}");
    }
}

/// A gaze is a direction at any time.
fn gaze(input: &[u8]) {
    if let Ok(script) = text(input).parse::<GazeScript>() {
        for seconds in [f64::NEG_INFINITY, -1.0, 0.0, 0.1, 2.5, 1e9, f64::INFINITY, f64::NAN] {
            let Some(direction) = script.at(seconds) else { continue };
            assert!((direction.length() - 1.0).abs() < 1e-3, "{direction} at {seconds}");
        }
    }
}

/// At most one half takes a manifest for its own.
fn manifest(input: &[u8]) {
    let text = text(input);
    let taken = [Half::OpenXr, Half::Vulkan].map(|half| half.is_manifest(&text));
    assert!(taken != [true; 2] || text.matches("name").count() >= 2, "{taken:?}");
}

/// Packets from two senders give a direction or none, and each is counted. Lines of an input are packets; the first byte of each
/// gives its sender and the time since the packet before.
fn osc(input: &[u8]) {
    let (mut gaze, mut now_ns) = (OscGaze::new(45.0), 0i64);
    // No text has this byte.
    let packets = input.split(|byte| *byte == 0xf8);
    for (number, packet) in (1..).zip(packets) {
        let (first, bytes) = packet.split_first().unwrap_or((&0, &[]));
        now_ns += i64::from(*first) * 5_000_000 - 100_000_000;
        let sender = SocketAddr::from(([127, 0, 0, 1], 9000 + u16::from(first & 1)));
        gaze.take(sender, read(bytes), now_ns);
        let look = gaze.look();
        assert_eq!(look.counts.packets, number);
        assert!(look.rate_hz.is_finite() && look.rate_hz >= 0.0, "{look:?}");
        if let Some(direction) = look.direction {
            assert!((direction.length() - 1.0).abs() < 1e-3, "{direction}");
        }
    }
}

struct Sought;

// SAFETY: `find` is only used to locate this structure; its contents are never read.
unsafe impl Structure for Sought {
    fn number() -> i32 {
        7
    }
}

/// A chain of structures, each byte pair a type and the next structure's index, ends; and the sought structure is found if it is present.
fn pnext(input: &[u8]) {
    let count = (input.len() / 2).min(MAX_LENGTH * 2);
    let mut nodes: Vec<Header> = input
        .chunks_exact(2)
        .take(count)
        .map(|pair| Header { ty: i32::from(pair[0] % 16), next: null() })
        .collect();
    let first = nodes.as_mut_ptr();
    let next = |at: usize| (usize::from(input[2 * at + 1]) + at) % (count + 1);
    for at in 0..count {
        if next(at) < count {
            // SAFETY: both are within the nodes, which stay where they are.
            unsafe { (*first.add(at)).next = first.add(next(at)) };
        }
    }
    let begin = if count == 0 { null() } else { first.cast_const() };
    let mut expected = Vec::new();
    let mut at = 0;
    while at < count && expected.len() < MAX_LENGTH {
        expected.push(i32::from(input[2 * at] % 16));
        at = next(at);
    }
    // SAFETY: the nodes are alive, and unchanged from here on.
    unsafe {
        let seen: Vec<i32> = chain(begin.cast()).map(|node| node.ty).collect();
        assert_eq!(seen, expected);
        let found = chain(begin.cast()).find::<Sought>().is_some();
        assert_eq!(found, expected.contains(&Sought::number()));
    }
}

/// A scenario that is taken is one that can be written and read again.
fn scenario(input: &[u8]) {
    match Scenario::parse(&text(input)) {
        Err(reason) => assert!(!reason.is_empty()),
        Ok(scenario) => {
            let written = toml::to_string(&scenario).unwrap_or_else(|error| panic!("{error}"));
            let again = Scenario::parse(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
            assert_eq!(again, scenario);
        }
    }
}

/// Shaders are read, never changed: invalid modules are distinguished from valid ones, and the same each time.
fn spirv(input: &[u8]) {
    let words: Vec<u32> =
        input.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
    assert_eq!(FragmentShaders::read(&words), FragmentShaders::read(&words));
}

/// Checks that a portion has no more samples than requested, for any header.
fn wav(input: &[u8]) {
    let Ok(mut wav) = Wav::new(Cursor::new(input)) else { return };
    let channels = wav.format().channels as usize;
    let mut piece = Vec::new();
    for frames in [1, 960, 7] {
        let Ok(read) = wav.read(frames, &mut piece) else { return };
        assert!(1 <= read && read <= frames, "{read} of {frames} frames");
        assert!(piece.len() <= read as usize * channels, "{} samples in {read} frames", piece.len());
    }
}
