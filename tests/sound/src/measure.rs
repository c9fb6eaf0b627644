//! Cost of sound capture: CPU time of its threads, memory of its process, time from playing to features.

use crate::player::{BUFFER_MS, Player, SHORT_BUFFER_MS};
use crate::server::Server;
use crate::signals::{Kind, sound};
use crate::stage::{OUT, SAMPLE_RATE_HZ, Stage};
use anyhow::{Context, Result, ensure};
use parafovea_audio::ring::{Format, ring};
use parafovea_audio::{Capture, Settings, Source};
use std::time::{Duration, Instant};

/// Interval between reads of a capture.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Threads of a capture, by the names that the system knows (15 characters).
const THREADS: [&str; 2] = ["parafovea-sound", "parafovea-meter"];

/// Time of a callback for 10 ms of stereo at 48 kHz, microseconds of its thread's CPU time, each of `count` times.
///
/// # Errors
/// The system does not report CPU time.
pub fn callback_us(count: usize) -> Result<Vec<f64>> {
    let (mut writer, mut reader) = ring(Format { sample_rate_hz: SAMPLE_RATE_HZ, channels: 2 });
    let bytes: Vec<u8> = sound(Kind::Pink, -20.0, SAMPLE_RATE_HZ, 1.0)[..960]
        .iter()
        .flat_map(|sample| sample.to_le_bytes())
        .collect();
    let mut spent = Vec::with_capacity(count);
    for _ in 0..count {
        let before = own_cpu_ns()?;
        writer.write_f32_le(std::hint::black_box(&bytes), std::hint::black_box(1.0));
        spent.push((own_cpu_ns()? - before) as f64 / 1000.0);
        reader.read(|samples| _ = std::hint::black_box(samples));
    }
    Ok(spent)
}

/// Cost of one capture of a playing server.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// CPU time of its threads, share of one core.
    pub core_share: f64,
    /// Memory of this process at the first look, after a tenth of the time, bytes.
    pub resident_first: u64,
    /// The most memory at later looks, bytes.
    pub resident_most: u64,
    /// Sets of features that were heard.
    pub sets: u64,
    /// The longest time from one set to the next.
    pub longest_wait: Duration,
    /// Duration of the measurement.
    pub time: Duration,
}

/// Listens to a server that plays speech for so long.
///
/// # Errors
/// The server does not start, or no sound is captured.
pub fn capture_cost(time: Duration) -> Result<Cost> {
    let server = Server::start(&[OUT])?;
    let player = Player::new(&server.socket(), SAMPLE_RATE_HZ, BUFFER_MS)?;
    player.play(sound(Kind::Speech, -23.0, SAMPLE_RATE_HZ, 4.0), true);
    // SAFETY: nothing else in this process reads or writes the environment meanwhile.
    unsafe { std::env::set_var("PULSE_SERVER", server.socket()) };
    let capture = Capture::start(Settings { source: Source::System, ..Settings::default() })?;
    let start = Instant::now();
    let first_look = time / 10;
    while capture.newest().is_none_or(|newest| newest.features.silent) {
        ensure!(start.elapsed() < Duration::from_secs(60), "no sound is captured: {:?}", capture.next_line());
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut cost = Cost {
        core_share: 0.0,
        resident_first: 0,
        resident_most: 0,
        sets: 0,
        longest_wait: Duration::ZERO,
        time,
    };
    let start = Instant::now();
    let spent = threads_cpu_ns()?;
    let sets = capture.newest().map_or(0, |newest| newest.serial);
    let (mut newest, mut since) = (sets, start);
    while start.elapsed() < time {
        std::thread::sleep(LOOK_EVERY);
        let current = capture.newest().map_or(0, |set| set.serial);
        cost.longest_wait = cost.longest_wait.max(since.elapsed());
        if current != newest {
            (newest, since) = (current, Instant::now());
        }
        let resident = resident_bytes()?;
        if cost.resident_first == 0 {
            if start.elapsed() >= first_look {
                cost.resident_first = resident;
            }
        } else {
            cost.resident_most = cost.resident_most.max(resident);
        }
    }
    cost.core_share = (threads_cpu_ns()? - spent) as f64 / start.elapsed().as_nanos() as f64;
    cost.time = start.elapsed();
    cost.sets = newest - sets;
    Ok(cost)
}

/// Seconds from when a sound goes to the server to when plans of hello_xr take it, each of `count` times.
///
/// # Errors
/// A program is not installed, or no sound is captured.
pub fn latencies_s(count: usize) -> Result<Vec<f64>> {
    let mut stage = Stage::new("")?;
    stage.player = Player::new(&stage.server.socket(), SAMPLE_RATE_HZ, SHORT_BUFFER_MS)?;
    let tone = sound(Kind::Tone, -15.0, SAMPLE_RATE_HZ, 1.0);
    let mut latencies = Vec::with_capacity(count);
    for number in 0..count {
        // Each at another moment of the 100 ms in which features come.
        std::thread::sleep(Duration::from_millis(37 * number as u64 % 100));
        stage.player.play(tone.clone(), true);
        while stage.player.began().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let began = stage.player.began().context("not played")?;
        let line = stage.wait("sound", |line| line.silent == Some(false), Some(began))?;
        latencies.push(line.seconds_after(began));
        stage.player.pause();
        stage.wait("silence", |line| line.silent == Some(true), Some(line.time()))?;
    }
    stage.finish()?;
    Ok(latencies)
}

/// The value below which this share of values is.
///
/// # Panics
/// Without any values.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// CPU time of this thread, nanoseconds.
fn own_cpu_ns() -> Result<u64> {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the structure is valid to write to.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut now) };
    ensure!(result == 0, "no CPU time");
    Ok(now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64)
}

/// CPU time of all captures' threads in this process, nanoseconds.
fn threads_cpu_ns() -> Result<u64> {
    let mut spent = 0;
    for thread in std::fs::read_dir("/proc/self/task")? {
        let folder = thread?.path();
        let name = std::fs::read_to_string(folder.join("comm"))?;
        if THREADS.contains(&name.trim_end()) {
            let times = std::fs::read_to_string(folder.join("schedstat"))?;
            spent += times.split(' ').next().context("no times")?.parse::<u64>()?;
        }
    }
    Ok(spent)
}

/// Memory of this process that is in RAM, bytes.
fn resident_bytes() -> Result<u64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).context("no VmRSS")?;
    Ok(line.trim().trim_end_matches(" kB").parse::<u64>()? * 1024)
}
