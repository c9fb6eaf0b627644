//! The thread that receives packets.

use super::assembly::{OscGaze, OscLook};
use super::budget::Budget;
use super::message::{MOST_BYTES, needs_decoding, read};
use crate::abi::threads::spawn;
use std::io::{self, ErrorKind};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

/// Longest wait for a packet before the thread checks whether it is to end: the packet that wakes it may be lost.
const PATIENCE: Duration = Duration::from_millis(250);

/// Packets that are thrown away unread after a flood: more than a socket's default buffer holds.
const MOST_DROPPED: u32 = 1024;

/// Receives packets until it is dropped.
#[derive(Debug)]
pub struct Listener {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// Address at which the thread is woken.
    wake: SocketAddr,
    begun: Instant,
}

#[derive(Debug)]
struct Shared {
    socket: UdpSocket,
    look: Mutex<OscLook>,
    scale_deg: AtomicU32,
    is_ending: AtomicBool,
}

/// State of the listener.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewestGaze {
    /// The gaze.
    pub look: OscLook,
    /// Time since the newest direction came; `None`: there was none yet.
    pub age: Option<Duration>,
}

impl Listener {
    /// Begins to receive at an address.
    ///
    /// # Errors
    ///
    /// The address is not of this computer, or its port is taken; or there can be no thread.
    pub fn begin(address: SocketAddr, scale_deg: f32) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_read_timeout(Some(PATIENCE))?;
        let wake = reachable(socket.local_addr()?);
        let shared = Arc::new(Shared {
            socket,
            look: Mutex::default(),
            scale_deg: AtomicU32::new(scale_deg.to_bits()),
            is_ending: AtomicBool::new(false),
        });
        let (theirs, begun) = (shared.clone(), Instant::now());
        let thread = spawn("parafovea-osc", move || receive(&theirs, begun))?;
        Ok(Self { shared, thread: Some(thread), wake, begun })
    }

    /// A value of 1 means so many degrees from now on.
    pub fn set_scale(&self, scale_deg: f32) {
        self.shared.scale_deg.store(scale_deg.to_bits(), Ordering::Relaxed);
    }

    /// The state now. `None` in the rare case that the thread is just writing it: waiting for it is never worth a frame.
    pub fn newest(&self) -> Option<NewestGaze> {
        let look = *self.shared.look.try_lock().ok()?;
        let age_ns = |received_ns: i64| nanoseconds(self.begun.elapsed()).saturating_sub(received_ns).max(0);
        let age = (look.serial > 0).then(|| Duration::from_nanos(age_ns(look.received_ns) as u64));
        Some(NewestGaze { look, age })
    }
}

impl Drop for Listener {
    /// Waits until the thread has ended and the port is free.
    fn drop(&mut self) {
        self.shared.is_ending.store(true, Ordering::Relaxed);
        // Where this is lost, the thread looks by itself soon.
        let _ = self.shared.socket.send_to(&[], self.wake);
        if let Some(thread) = self.thread.take() {
            // One that panicked has ended, too.
            let _ = thread.join();
        }
    }
}

/// An address at which a socket that is bound to `address` is reached from this computer.
fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        ip if !ip.is_unspecified() => ip,
        IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
    };
    SocketAddr::new(ip, address.port())
}

fn receive(shared: &Shared, begun: Instant) {
    let mut gaze = OscGaze::new(f32::from_bits(shared.scale_deg.load(Ordering::Relaxed)));
    let mut budget = Budget::default();
    // One byte more, so that a larger packet is known by its length.
    let mut bytes = [0; MOST_BYTES + 1];
    loop {
        let received = shared.socket.recv_from(&mut bytes);
        if shared.is_ending.load(Ordering::Relaxed) {
            return;
        }
        let now_ns = nanoseconds(begun.elapsed());
        let (length, sender) = match received {
            Ok(received) => received,
            Err(error) if is_none_yet(&error) => continue,
            Err(_) => {
                // A network that went away, or an answer to nothing that was sent: never in a hurry.
                sleep(PATIENCE);
                continue;
            }
        };
        gaze.set_scale(f32::from_bits(shared.scale_deg.load(Ordering::Relaxed)));
        let packet = &bytes[..length];
        gaze.take(sender, read(packet), now_ns);
        let wait = budget.spend(needs_decoding(packet), now_ns);
        if wait.is_some() {
            gaze.flooded();
        }
        *shared.look.lock().unwrap_or_else(PoisonError::into_inner) = gaze.look();
        if let Some(wait) = wait {
            sleep(wait);
            // Packets that arrived meanwhile are old, and too many.
            drop_waiting(&shared.socket, &mut bytes);
        }
    }
}

/// Whether an error only means that no packet came.
fn is_none_yet(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

/// Throws unread packets away, up to a limit.
fn drop_waiting(socket: &UdpSocket, bytes: &mut [u8]) {
    if socket.set_nonblocking(true).is_err() {
        return;
    }
    let _ = (0..MOST_DROPPED).try_for_each(|_| socket.recv_from(bytes).map(drop));
    // Else it never waits again: packets would be looked for all the time.
    while socket.set_nonblocking(false).is_err() {
        sleep(PATIENCE);
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests;
