//! From packets of any senders to one gaze.
//!
//! One sender is used until it sends nothing about the eyes for [`HOLD_NS`]; packets of others are counted meanwhile, but not used. Of a
//! sender's formats the best is used, with the same limit. Contains no clock: every time is passed in.

use super::message::{Axis, EyeMessage, EyeValue, Eyes, Format, OscPacketError, Packet};
use crate::inputs::gaze::direction;
use glam::Vec3;
use std::net::SocketAddr;

/// Time without a message after which another sender, or another format, holds: as long as a gaze is held in a blink
/// (`gaze.hold_ms`).
const HOLD_NS: i64 = 500_000_000;

/// Time for which an eye counts as closed without another message. Senders of changes alone are silent while eyes stay closed, and
/// so is one that has ended. While the eyes are closed a wrong gaze has no visible effect.
const CLOSED_NS: i64 = 1_000_000_000;

/// Openness below which an eye counts as closed: less shows no pupil. Senders fit 0 to the closed eye, and noise stays below this.
const CLOSED: f32 = 0.2;

/// A time tag that is earlier than the one before by less than this, in 2^-32 s, came late; by more, the sender's clock was set.
const LATE: u64 = 1 << 32;

/// Period over which a rate is measured, nanoseconds.
const RATE_NS: i64 = 1_000_000_000;

/// Packets since the listener began, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OscCounts {
    /// All of them.
    pub packets: u64,
    /// Of these: no OSC, or too large.
    pub malformed: u64,
    /// Of these: about the eyes, from another sender than the one that holds.
    pub other_senders: u64,
    /// Of these: older than the one before, by the sender's own time.
    pub late: u64,
    /// Messages about the eyes that are not a gaze: of other arguments, not finite, or out of reach.
    pub implausible: u64,
    /// Intervals of time in which more packets arrived than are read.
    pub floods: u64,
}

/// The gaze at some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OscLook {
    /// Direction of the gaze, a unit vector in the space of the head; `None` while the eyes are closed or not tracked.
    pub direction: Option<Vec3>,
    /// Rises with each new direction; 0: there was none yet.
    pub serial: u64,
    /// Time at which the newest direction came.
    pub received_ns: i64,
    /// Format of the addresses of its messages.
    pub format: Option<Format>,
    /// Directions a second, Hz; 0: not known.
    pub rate_hz: f32,
    /// All packets.
    pub counts: OscCounts,
}

/// Assembles the gaze.
#[derive(Clone, Debug)]
pub struct OscGaze {
    scale_deg: f32,
    sender: Option<Sender>,
    rate: Rate,
    look: OscLook,
}

/// The sender that holds.
#[derive(Clone, Debug)]
struct Sender {
    address: SocketAddr,
    /// Time at which it last sent a message about the eyes.
    received_ns: i64,
    /// The newest time tag.
    sent: Option<u64>,
    format: Option<(Format, i64)>,
    /// State of each eye, by the format that holds.
    eyes: [Eye; 2],
    is_tracked: bool,
    /// Values of [`Sender::eyes`] that came since the last new direction began, as bits.
    fresh: u8,
}

/// The share of a message in a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Taken {
    /// None.
    Aside,
    /// One more part of the direction that is under way.
    Part,
    /// The first part of a new one, or all of it.
    New,
}

#[derive(Clone, Copy, Debug, Default)]
struct Eye {
    direction: Option<Vec3>,
    right: Option<f32>,
    up: Option<f32>,
    /// Until when it is closed, as far as is known.
    closed_until_ns: Option<i64>,
}

impl OscGaze {
    /// For a value of 1 that means so many degrees.
    pub fn new(scale_deg: f32) -> Self {
        Self { scale_deg, sender: None, rate: Rate::default(), look: OscLook::default() }
    }

    /// A value of 1 means so many degrees from the next message on.
    pub fn set_scale(&mut self, scale_deg: f32) {
        self.scale_deg = scale_deg;
    }

    /// The gaze as the newest packet left it.
    pub fn look(&self) -> OscLook {
        self.look
    }

    /// There were more packets than are read.
    pub fn flooded(&mut self) {
        self.look.counts.floods += 1;
    }

    /// Takes a packet of `address` that came at `now_ns`.
    pub fn take(&mut self, address: SocketAddr, packet: Result<Packet, OscPacketError>, now_ns: i64) {
        let counts = &mut self.look.counts;
        counts.packets += 1;
        let Ok(packet) = packet else {
            counts.malformed += 1;
            return;
        };
        counts.implausible += u64::from(packet.implausible);
        if packet.messages.is_empty() {
            return;
        }
        let holds = |sender: &Sender| now_ns.saturating_sub(sender.received_ns) < HOLD_NS;
        let sender = match &mut self.sender {
            Some(sender) if sender.address == address => sender,
            Some(sender) if holds(sender) => {
                counts.other_senders += 1;
                return;
            }
            place => place.insert(Sender::new(address, now_ns)),
        };
        if sender.is_late(packet.sent) {
            counts.late += 1;
            return;
        }
        sender.received_ns = now_ns;
        for message in &packet.messages {
            let taken = sender.take(message, self.scale_deg, now_ns);
            if taken != Taken::Aside {
                self.look.serial += 1;
                self.look.received_ns = now_ns;
            }
            if taken == Taken::New {
                self.rate.count(now_ns);
            }
        }
        self.look.direction = sender.direction(now_ns);
        self.look.format = sender.format.map(|(format, _)| format);
        self.look.rate_hz = self.rate.hz;
    }
}

impl Sender {
    fn new(address: SocketAddr, now_ns: i64) -> Self {
        Self {
            address,
            received_ns: now_ns,
            sent: None,
            format: None,
            eyes: [Eye::default(); 2],
            is_tracked: true,
            fresh: 0,
        }
    }

    /// Whether a packet was sent before the newest that is known.
    fn is_late(&mut self, sent: Option<u64>) -> bool {
        let Some(sent) = sent else { return false };
        let is_late = self.sent.is_some_and(|newest| newest > sent && newest - sent < LATE);
        if !is_late {
            self.sent = Some(sent);
        }
        is_late
    }

    /// Takes a message.
    fn take(&mut self, message: &EyeMessage, scale_deg: f32, now_ns: i64) -> Taken {
        let eyes = |eyes: Eyes| [0, 1].into_iter().filter(move |eye| eyes.include(*eye));
        match message.value {
            EyeValue::Tracked(is_tracked) => {
                self.is_tracked = is_tracked;
                Taken::Aside
            }
            // Eyes are as open in each format.
            EyeValue::Openness { eyes: of, share } => {
                let until = (share < CLOSED).then(|| now_ns.saturating_add(CLOSED_NS));
                eyes(of).for_each(|eye| self.eyes[eye].closed_until_ns = until);
                Taken::Aside
            }
            EyeValue::Directions(directions) => {
                if !self.holds(message.format, now_ns) {
                    return Taken::Aside;
                }
                for (eye, direction) in self.eyes.iter_mut().zip(directions) {
                    eye.direction = Some(direction);
                }
                self.taken(0b1111)
            }
            EyeValue::Deflection { eyes: of, axis, share } => {
                if !self.holds(message.format, now_ns) {
                    return Taken::Aside;
                }
                let mut parts = 0;
                for eye in eyes(of) {
                    let place = &mut self.eyes[eye];
                    match axis {
                        Axis::Right => place.right = Some(share),
                        Axis::Up => place.up = Some(share),
                    }
                    if let (Some(right), Some(up)) = (place.right, place.up) {
                        place.direction = Some(direction([-right * scale_deg, up * scale_deg]));
                    }
                    parts |= 1 << (2 * eye + usize::from(axis == Axis::Up));
                }
                self.taken(parts)
            }
        }
    }

    /// Whether messages of this format are used: it is the best that the sender used lately.
    fn holds(&mut self, format: Format, now_ns: i64) -> bool {
        match &mut self.format {
            Some((held, received_ns)) if *held == format => {
                *received_ns = now_ns;
                true
            }
            Some((held, received_ns)) if format < *held && now_ns.saturating_sub(*received_ns) < HOLD_NS => {
                false
            }
            place => {
                *place = Some((format, now_ns));
                for eye in &mut self.eyes {
                    *eye = Eye { closed_until_ns: eye.closed_until_ns, ..Eye::default() };
                }
                self.fresh = 0;
                true
            }
        }
    }

    /// Parts of a direction came: of a new one, where they come for the second time.
    fn taken(&mut self, parts: u8) -> Taken {
        let is_new = self.fresh == 0 || self.fresh & parts != 0;
        self.fresh = if is_new { parts } else { self.fresh | parts };
        if is_new { Taken::New } else { Taken::Part }
    }

    /// Direction of the gaze: in the middle between both eyes, if both are open. Senders swap the eyes' sides at times, which changes
    /// nothing then.
    fn direction(&self, now_ns: i64) -> Option<Vec3> {
        let open = |eye: &Eye| {
            let is_closed = eye.closed_until_ns.is_some_and(|until_ns| now_ns < until_ns);
            eye.direction.filter(|_| !is_closed)
        };
        let [left, right] = self.eyes.each_ref().map(open);
        let sum = left.unwrap_or_default() + right.unwrap_or_default();
        self.is_tracked.then_some(sum)?.try_normalize()
    }
}

/// Frequency of an event.
#[derive(Clone, Copy, Debug, Default)]
struct Rate {
    /// Time at which the count began, and the count.
    begun: Option<(i64, u32)>,
    hz: f32,
}

impl Rate {
    fn count(&mut self, now_ns: i64) {
        let Some((begun_ns, count)) = &mut self.begun else {
            self.begun = Some((now_ns, 0));
            return;
        };
        *count += 1;
        let passed_ns = now_ns.saturating_sub(*begun_ns);
        if !(0..RATE_NS).contains(&passed_ns) {
            // After a pause of a second or more it is not the sender's rate.
            let is_whole = (RATE_NS..2 * RATE_NS).contains(&passed_ns);
            self.hz = if is_whole { (f64::from(*count) * 1e9 / passed_ns as f64) as f32 } else { 0.0 };
            self.begun = Some((now_ns, 0));
        }
    }
}

#[cfg(test)]
mod tests;
