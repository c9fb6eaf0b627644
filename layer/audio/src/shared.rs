//! State shared by the threads of a capture.

use crate::messages::PendingMessages;
use crate::published::Published;
use crate::ring::{Format, Reader, Writer, ring};
use crate::settings::Settings;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Longest time until a thread notices that it shall end.
const NOTICE: Duration = Duration::from_millis(50);

/// State shared by the threads of a capture.
pub struct Shared {
    /// The sound to capture.
    pub settings: Settings,
    /// The captured sound.
    pub published: Published,
    /// Messages for people.
    pub messages: PendingMessages,
    start: Instant,
    is_stopped: AtomicBool,
    is_muted: AtomicBool,
    /// A stream that began, until it is listened to.
    begun: Mutex<Option<Begun>>,
}

/// A stream that began.
pub struct Begun {
    pub format: Format,
    pub reader: Reader,
}

impl Shared {
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            published: Published::default(),
            messages: PendingMessages::default(),
            start: Instant::now(),
            is_stopped: AtomicBool::new(false),
            is_muted: AtomicBool::new(false),
            begun: Mutex::default(),
        }
    }

    /// Time since the capture began, nanoseconds.
    pub fn now_ns(&self) -> u64 {
        self.start.elapsed().as_nanos() as u64
    }

    /// Ends the threads, soon.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Sleeps, or not so long when the capture ends.
    pub fn sleep(&self, time: Duration) {
        let end = Instant::now() + time;
        while !self.is_stopped() {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return;
            }
            std::thread::sleep(left.min(NOTICE));
        }
    }

    /// Sets whether the sound is muted, regardless of its samples.
    pub fn set_muted(&self, is_muted: bool) {
        self.is_muted.store(is_muted, Ordering::Relaxed);
    }

    pub fn is_muted(&self) -> bool {
        self.is_muted.load(Ordering::Relaxed)
    }

    /// A stream begins, and takes the place of the one before: the end to write its samples to.
    pub fn begin(&self, format: Format) -> Writer {
        let (writer, reader) = ring(format);
        *self.begun.lock().unwrap_or_else(PoisonError::into_inner) = Some(Begun { format, reader });
        writer
    }

    /// The stream that began since this was asked last.
    pub fn take_begun(&self) -> Option<Begun> {
        self.begun.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
