//! A program that plays all the time, silence by default.

use crate::signals::CHANNELS;
use anyhow::{Context as _, Result};
use pulseaudio::protocol::stream::{BufferAttr, StreamFlags};
use pulseaudio::protocol::{ChannelMap, PlaybackStreamParams, SampleFormat, SampleSpec};
use pulseaudio::{AsPlaybackSource, Client, PlaybackStream};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::{Duration, Instant, SystemTime};

/// Length of the server's buffer ahead of playback, milliseconds: enough to avoid gaps on a busy machine.
pub const BUFFER_MS: u32 = 150;

/// The same if the delay of sound matters.
pub const SHORT_BUFFER_MS: u32 = 20;

/// Length of the authentication cookie, which the server ignores as it admits everybody.
const COOKIE_BYTES: usize = 256;

/// The longest that the server may take to answer.
const PATIENCE: Duration = Duration::from_secs(20);

/// Plays to the default output until it is dropped.
pub struct Player {
    playing: Arc<Mutex<Playing>>,
    _client: Client,
    _stream: PlaybackStream,
}

#[derive(Default)]
struct Playing {
    samples: Vec<f32>,
    position: usize,
    is_repeated: bool,
    /// Time at which the first sample went to the server.
    began: Option<SystemTime>,
}

impl Player {
    /// Begins to play silence to the server with this socket, of which it gets so much ahead.
    ///
    /// # Errors
    /// The server refuses, or does not answer.
    pub fn new(socket: &Path, sample_rate_hz: u32, buffer_ms: u32) -> Result<Self> {
        let socket = UnixStream::connect(socket)?;
        // For the greeting; afterwards the client waits for nothing.
        socket.set_read_timeout(Some(PATIENCE))?;
        let client = Client::new_unix(c"player", socket, Some([0; COOKIE_BYTES]))?;
        let playing = Arc::new(Mutex::new(Playing::default()));
        let theirs = playing.clone();
        let source =
            move |bytes: &mut [u8]| theirs.lock().unwrap_or_else(PoisonError::into_inner).fill(bytes);
        let length = sample_rate_hz * buffer_ms / 1000 * CHANNELS * size_of::<f32>() as u32;
        let params = PlaybackStreamParams {
            sample_spec: SampleSpec {
                format: SampleFormat::Float32Le,
                channels: CHANNELS as u8,
                sample_rate: sample_rate_hz,
            },
            channel_map: ChannelMap::stereo(),
            buffer_attr: BufferAttr { target_length: length, ..BufferAttr::default() },
            flags: StreamFlags { adjust_latency: true, ..StreamFlags::default() },
            ..PlaybackStreamParams::default()
        };
        let stream = client.create_playback_stream(params, source.as_playback_source());
        let stream = block_on(stream, PATIENCE)
            .context("the server cannot create a stream; does it have an output?")??;
        Ok(Self { playing, _client: client, _stream: stream })
    }

    /// Plays samples once, or over and over; from now on.
    pub fn play(&self, samples: Vec<f32>, is_repeated: bool) {
        *self.playing() = Playing { samples, position: 0, is_repeated, began: None };
    }

    /// Plays silence.
    pub fn pause(&self) {
        *self.playing() = Playing::default();
    }

    /// Time at which the first sample went to the server: it plays at most the length of the buffer later.
    pub fn began(&self) -> Option<SystemTime> {
        self.playing().began
    }

    fn playing(&self) -> std::sync::MutexGuard<'_, Playing> {
        self.playing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Playing {
    fn fill(&mut self, bytes: &mut [u8]) -> usize {
        if !self.samples.is_empty() {
            self.began.get_or_insert_with(SystemTime::now);
        }
        for bytes in bytes.chunks_exact_mut(size_of::<f32>()) {
            if self.is_repeated && self.position == self.samples.len() {
                self.position = 0;
            }
            let sample = self.samples.get(self.position).copied();
            self.position += usize::from(sample.is_some());
            bytes.copy_from_slice(&sample.unwrap_or(0.0).to_le_bytes());
        }
        bytes.len()
    }
}

/// Wakes a thread that waits for a future.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Output of a future; `None` if it takes longer than that.
fn block_on<T>(future: impl Future<Output = T>, patience: Duration) -> Option<T> {
    let (mut future, start) = (pin!(future), Instant::now());
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    loop {
        if let Poll::Ready(value) = future.as_mut().poll(&mut Context::from_waker(&waker)) {
            return Some(value);
        }
        let left = patience.checked_sub(start.elapsed()).filter(|left| !left.is_zero())?;
        std::thread::park_timeout(left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::{pending, ready};

    #[test]
    fn a_future_is_not_waited_for_longer_than_that() {
        assert_eq!(block_on(ready(7), Duration::ZERO), Some(7));
        assert_eq!(block_on(pending::<()>(), Duration::from_millis(20)), None);
    }
}
