//! Packets of Open Sound Control as eye trackers send them, and their sender: for tests of `gaze.source = "osc"`.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Direction of the gaze, degrees to the left and upwards.
pub const LOOK: [f32; 2] = [-18.0, 9.0];

/// Ports of listeners: below the ports that the system picks for senders, from 32768 on.
const PORTS: std::ops::Range<u16> = 20_000..32_000;

/// A port that is free at this moment, another one with each call, and that the system gives to nobody else before the layer listens there.
///
/// # Errors
/// None of [`PORTS`] is free.
pub fn free_address() -> std::io::Result<SocketAddr> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    // Processes that run at the same time begin at different ports.
    let begin = std::process::id().wrapping_mul(64);
    let count = u32::from(PORTS.end - PORTS.start);
    let port = |_| {
        let place = begin.wrapping_add(COUNT.fetch_add(1, Ordering::Relaxed)) % count;
        PORTS.start + place as u16
    };
    first_free(PORTS.map(port))
}

/// The first port of these to which nothing is bound.
fn first_free(ports: impl Iterator<Item = u16>) -> std::io::Result<SocketAddr> {
    let mut error = std::io::ErrorKind::AddrInUse.into();
    for port in ports {
        match UdpSocket::bind(("127.0.0.1", port)) {
            Ok(socket) => return socket.local_addr(),
            Err(refused) => error = refused,
        }
    }
    Err(error)
}

/// A text of OSC 1.0: with a zero at its end, and filled up to whole words.
fn text(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((bytes.len() + 1).next_multiple_of(4), 0);
    bytes
}

/// A message of OSC 1.0 with numbers.
pub fn message(address: &str, numbers: &[f32]) -> Vec<u8> {
    let numbers_text = numbers.iter().flat_map(|number| number.to_be_bytes());
    let tags = format!(",{}", "f".repeat(numbers.len()));
    [text(address), text(&tags)].concat().into_iter().chain(numbers_text).collect()
}

/// A bundle of OSC 1.0, for at once.
pub fn bundle(messages: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = [text("#bundle"), 1u64.to_be_bytes().to_vec()].concat();
    for message in messages {
        bytes.extend((message.len() as u32).to_be_bytes());
        bytes.extend(message);
    }
    bytes
}

/// A format of gaze packets.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name for people.
    pub name: &'static str,
    /// Name of the format in the layer's status.
    pub status: &'static str,
    /// Packets for a gaze, degrees to the left and upwards.
    pub packets: fn([f32; 2]) -> Vec<Vec<u8>>,
}

/// Every format.
pub const FORMATS: [Format; 10] = [
    Format {
        name: "CenterPitchYaw",
        status: "VRChat",
        packets: |[left, up]| native("CenterPitchYaw", &[-up, -left]),
    },
    Format {
        name: "CenterPitchYawDist",
        status: "VRChat",
        packets: |[left, up]| native("CenterPitchYawDist", &[-up, -left, 1.5]),
    },
    Format {
        name: "LeftRightPitchYaw",
        status: "VRChat",
        packets: |[left, up]| native("LeftRightPitchYaw", &[-up, -left, -up, -left]),
    },
    Format { name: "CenterVec", status: "VRChat", packets: |look| native("CenterVec", &vector(look)) },
    Format {
        name: "CenterVecFull",
        status: "VRChat",
        packets: |look| native("CenterVecFull", &vector(look).map(|part| 1.5 * part)),
    },
    Format {
        name: "LeftRightVec",
        status: "VRChat",
        packets: |look| native("LeftRightVec", &[vector(look), vector(look)].concat()),
    },
    Format {
        name: "v2, one by one",
        status: "VRCFaceTracking",
        packets: |look| of_eyes(look, |eye, axis| format!("/avatar/parameters/v2/Eye{eye}{axis}")),
    },
    Format {
        name: "v2 with a prefix, bundled",
        status: "VRCFaceTracking",
        packets: |look| {
            vec![bundle(&of_eyes(look, |eye, axis| format!("/avatar/parameters/FT/v2/Eye{eye}{axis}")))]
        },
    },
    Format {
        name: "v2 of both eyes",
        status: "VRCFaceTracking",
        packets: |look| {
            let axes = shares(look).map(|(axis, share)| (format!("/avatar/parameters/v2/Eye{axis}"), share));
            axes.map(|(address, share)| message(&address, &[share])).to_vec()
        },
    },
    Format {
        name: "Baballonia",
        status: "Baballonia",
        packets: |look| of_eyes(look, |eye, axis| format!("/{eye}Eye{axis}")),
    },
];

fn native(name: &str, numbers: &[f32]) -> Vec<Vec<u8>> {
    vec![message(&format!("/tracking/eye/{name}"), numbers)]
}

/// VRChat's vectors: +z is forward.
fn vector([left, up]: [f32; 2]) -> [f32; 3] {
    let turn = glam::Quat::from_euler(glam::EulerRot::YXZ, left.to_radians(), up.to_radians(), 0.0);
    let glam::Vec3 { x, y, z } = turn * glam::Vec3::NEG_Z;
    [x, y, -z]
}

/// Parts of the default of `gaze.osc_scale_deg`, with the names of their axes.
fn shares([left, up]: [f32; 2]) -> [(&'static str, f32); 2] {
    [("X", -left / 45.0), ("Y", up / 45.0)]
}

fn of_eyes(look: [f32; 2], address: fn(&str, &str) -> String) -> Vec<Vec<u8>> {
    let of_eye = |eye| shares(look).map(|(axis, share)| message(&address(eye, axis), &[share]));
    ["Left", "Right"].map(of_eye).concat()
}

/// Sends packets again and again, from one port, until it is dropped.
pub struct Sender {
    is_ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Sender {
    /// Sends packets with a pause after each turn.
    ///
    /// # Errors
    /// The system gives no port to send from.
    pub fn new(
        to: SocketAddr,
        mut packets: impl FnMut() -> Vec<Vec<u8>> + Send + 'static,
        pause: Duration,
    ) -> std::io::Result<Self> {
        let is_ending = Arc::new(AtomicBool::new(false));
        let theirs = is_ending.clone();
        let socket = UdpSocket::bind("127.0.0.1:0")?;
        let thread = std::thread::spawn(move || {
            while !theirs.load(Ordering::Relaxed) {
                for packet in packets() {
                    // Before the listener is there, it is refused.
                    let _ = socket.send_to(&packet, to);
                }
                std::thread::sleep(pause);
            }
        });
        Ok(Self { is_ending, thread: Some(thread) })
    }

    /// As fast as an eye tracker, and more, as frames of simulated time are fast.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn tracker(to: SocketAddr, packets: Vec<Vec<u8>>) -> std::io::Result<Self> {
        Self::new(to, move || packets.clone(), Duration::from_millis(1))
    }

    /// An eye tracker of 100 Hz whose eyes move.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn moving(to: SocketAddr, packet: impl FnMut() -> Vec<u8> + Send + 'static) -> std::io::Result<Self> {
        let mut packet = packet;
        Self::new(to, move || vec![packet()], Duration::from_millis(10))
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        self.is_ending.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // It has no reason to panic; one that did has ended, too.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_listener_has_a_port_that_a_sender_may_get() {
        let addresses: Vec<SocketAddr> = (0..100).map(|_| free_address().unwrap()).collect();
        assert!(addresses.iter().all(|address| PORTS.contains(&address.port())), "{addresses:?}");
        let distinct: std::collections::BTreeSet<_> = addresses.iter().collect();
        assert_eq!(distinct.len(), addresses.len(), "{addresses:?}");
    }

    #[test]
    fn a_taken_port_is_passed_over() {
        let [taken, free] = [free_address().unwrap(), free_address().unwrap()];
        let _listener = UdpSocket::bind(taken).unwrap();
        assert_eq!(first_free([taken.port(), free.port()].into_iter()).unwrap(), free);
        assert!(first_free(std::iter::once(taken.port())).is_err());
    }
}
