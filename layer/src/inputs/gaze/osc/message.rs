//! From the bytes of a packet to statements about the eyes.

use crate::inputs::gaze::direction;
use glam::Vec3;
use rosc::{OscMessage, OscPacket, OscType};
use smallvec::SmallVec;

/// Largest packet that is read, bytes. A bundle within a bundle takes 20 bytes and a level of the decoder's stack, so that this also
/// bounds its depth.
pub const MOST_BYTES: usize = 8192;

/// Farthest angle from the centre of the view, degrees: beyond, a direction is none of a gaze.
const FARTHEST_DEG: f32 = 90.0;

/// Greatest value of a deflection: senders exceed 1, the end of their scale, by a little (VRCFaceTracking, "Eye Gaze Parameters").
const GREATEST_DEFLECTION: f32 = 1.5;

/// Format of a message's address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Format {
    /// Baballonia's own addresses.
    Baballonia,
    /// Parameters of VRCFaceTracking, version 2.
    Vrcft,
    /// VRChat's own addresses, which have units: the best where a sender uses several.
    Native,
}

impl Format {
    /// Its name, for status and log.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baballonia => "Baballonia",
            Self::Vrcft => "VRCFaceTracking",
            Self::Native => "VRChat",
        }
    }
}

/// Eye or eyes of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eyes {
    /// The left one.
    Left,
    /// The right one.
    Right,
    /// Both alike.
    Both,
}

impl Eyes {
    /// Whether the left (0) or the right one (1) is among them.
    pub fn include(self, eye: usize) -> bool {
        match self {
            Self::Left => eye == 0,
            Self::Right => eye == 1,
            Self::Both => true,
        }
    }
}

/// Direction in which an eye is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    Right,
    /// Upwards.
    Up,
}

/// A statement about the eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EyeValue {
    /// Gaze directions of the left and the right eye: unit vectors in the space of the head (-z is the centre of the view).
    Directions([Vec3; 2]),
    /// Deflection of eyes, in parts of `gaze.osc_scale_deg`: -1.5..=1.5.
    Deflection {
        /// The eyes.
        eyes: Eyes,
        /// Direction of the deflection.
        axis: Axis,
        /// Size of the deflection.
        share: f32,
    },
    /// Openness of eyes: 0 closed, 1 open; finite, and beyond both ends with some senders.
    Openness {
        /// The eyes.
        eyes: Eyes,
        /// Their openness.
        share: f32,
    },
    /// Whether the sender tracks the eyes.
    Tracked(bool),
}

/// A message about the eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeMessage {
    /// Format of its address.
    pub format: Format,
    /// Its statement.
    pub value: EyeValue,
}

/// A packet, as far as it is about the eyes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packet {
    /// The time tag of the outermost bundle (OSC 1.0, "OSC Time Tags"): NTP time, in 2^-32 s. `None` for a single message and for
    /// "immediately".
    pub sent: Option<u64>,
    /// Its messages about the eyes, in order.
    pub messages: SmallVec<[EyeMessage; 8]>,
    /// Messages about the eyes whose arguments are not a gaze: of another number or type, not finite, or out of reach.
    pub implausible: u32,
}

/// Reason why bytes are not a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OscPacketError {
    /// More than [`MOST_BYTES`].
    #[error("larger than {MOST_BYTES} bytes")]
    Large,
    /// Not OSC.
    #[error("not an OSC packet")]
    Malformed,
}

/// The packet in some bytes, of any origin.
///
/// # Errors
/// See [`OscPacketError`].
pub fn read(bytes: &[u8]) -> Result<Packet, OscPacketError> {
    if bytes.len() > MOST_BYTES {
        return Err(OscPacketError::Large);
    }
    let mut packet = Packet::default();
    if !needs_decoding(bytes) {
        return Ok(packet);
    }
    let (_, decoded) = rosc::decoder::decode_udp(bytes).map_err(|_| OscPacketError::Malformed)?;
    if let OscPacket::Bundle(bundle) = &decoded {
        let sent = u64::from(bundle.timetag.seconds) << 32 | u64::from(bundle.timetag.fractional);
        // 1: immediately. 0 is not a time that a sender would mean.
        packet.sent = (sent > 1).then_some(sent);
    }
    // The depth is bounded by the size; a list of our own spares the stack nevertheless.
    let mut waiting: SmallVec<[&OscPacket; 8]> = SmallVec::new();
    waiting.push(&decoded);
    while let Some(next) = waiting.pop() {
        match next {
            OscPacket::Message(message) => packet.take(message),
            OscPacket::Bundle(bundle) => waiting.extend(bundle.content.iter().rev()),
        }
    }
    Ok(packet)
}

/// Whether a packet may be about the eyes, by its first bytes: a message with another address, as most are of a sender of whole
/// faces, is not. One that is too large is not decoded either.
pub fn needs_decoding(bytes: &[u8]) -> bool {
    let address = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    let is_about_eyes = || std::str::from_utf8(address).is_ok_and(|address| Subject::of(address).is_some());
    bytes.len() <= MOST_BYTES && (!bytes.starts_with(b"/") || is_about_eyes())
}

impl Packet {
    fn take(&mut self, message: &OscMessage) {
        let Some(subject) = Subject::of(&message.addr) else { return };
        match subject.read(&message.args) {
            Some(message) => self.messages.push(message),
            None => self.implausible += 1,
        }
    }
}

/// The subject of an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    CenterPitchYaw,
    LeftRightPitchYaw,
    CenterVec,
    LeftRightVec,
    EyesClosedAmount,
    Deflection(Format, Eyes, Axis),
    Openness(Format, Eyes),
    Tracked,
}

impl Subject {
    /// `None` if it is not about the eyes.
    fn of(address: &str) -> Option<Self> {
        if let Some(name) = address.strip_prefix("/tracking/eye/") {
            return match name {
                "CenterPitchYaw" | "CenterPitchYawDist" => Some(Self::CenterPitchYaw),
                "LeftRightPitchYaw" => Some(Self::LeftRightPitchYaw),
                "CenterVec" | "CenterVecFull" => Some(Self::CenterVec),
                "LeftRightVec" => Some(Self::LeftRightVec),
                "EyesClosedAmount" => Some(Self::EyesClosedAmount),
                _ => None,
            };
        }
        let (path, name) = address.rsplit_once('/')?;
        if let Some(parameters) = path.strip_prefix("/avatar/parameters") {
            if name == "EyeTrackingActive" {
                return Some(Self::Tracked);
            }
            if parameters == "/v2" || parameters.ends_with("/v2") {
                return Self::of_vrcft(name);
            }
        }
        Self::of_baballonia(name)
    }

    fn of_vrcft(name: &str) -> Option<Self> {
        let deflection = |eyes, axis| Some(Self::Deflection(Format::Vrcft, eyes, axis));
        match name {
            "EyeLeftX" => deflection(Eyes::Left, Axis::Right),
            "EyeLeftY" => deflection(Eyes::Left, Axis::Up),
            "EyeRightX" => deflection(Eyes::Right, Axis::Right),
            "EyeRightY" => deflection(Eyes::Right, Axis::Up),
            "EyeX" => deflection(Eyes::Both, Axis::Right),
            "EyeY" => deflection(Eyes::Both, Axis::Up),
            "EyeLidLeft" => Some(Self::Openness(Format::Vrcft, Eyes::Left)),
            "EyeLidRight" => Some(Self::Openness(Format::Vrcft, Eyes::Right)),
            "EyeLid" => Some(Self::Openness(Format::Vrcft, Eyes::Both)),
            _ => None,
        }
    }

    fn of_baballonia(name: &str) -> Option<Self> {
        let deflection = |eyes, axis| Some(Self::Deflection(Format::Baballonia, eyes, axis));
        match name {
            "LeftEyeX" | "leftEyeX" => deflection(Eyes::Left, Axis::Right),
            "LeftEyeY" | "leftEyeY" => deflection(Eyes::Left, Axis::Up),
            "RightEyeX" | "rightEyeX" => deflection(Eyes::Right, Axis::Right),
            "RightEyeY" | "rightEyeY" => deflection(Eyes::Right, Axis::Up),
            "EyesX" | "eyesX" => deflection(Eyes::Both, Axis::Right),
            "EyesY" | "eyesY" => deflection(Eyes::Both, Axis::Up),
            "LeftEyeLid" | "leftEyeLid" => Some(Self::Openness(Format::Baballonia, Eyes::Left)),
            "RightEyeLid" | "rightEyeLid" => Some(Self::Openness(Format::Baballonia, Eyes::Right)),
            _ => None,
        }
    }

    /// The statement of these arguments; `None` if they make none.
    fn read(self, arguments: &[OscType]) -> Option<EyeMessage> {
        let (format, value) = match self {
            Self::CenterPitchYaw => {
                // A distance behind them is not used.
                let [pitch, yaw] = numbers(arguments.get(..2)?)?;
                (Format::Native, EyeValue::Directions([turned(pitch, yaw)?; 2]))
            }
            Self::LeftRightPitchYaw => {
                let [left_pitch, left_yaw, right_pitch, right_yaw] = numbers(arguments)?;
                let directions = [turned(left_pitch, left_yaw)?, turned(right_pitch, right_yaw)?];
                (Format::Native, EyeValue::Directions(directions))
            }
            Self::CenterVec => {
                let [x, y, z] = numbers(arguments)?;
                (Format::Native, EyeValue::Directions([unity([x, y, z])?; 2]))
            }
            Self::LeftRightVec => {
                let [left_x, left_y, left_z, x, y, z] = numbers(arguments)?;
                (Format::Native, EyeValue::Directions([unity([left_x, left_y, left_z])?, unity([x, y, z])?]))
            }
            Self::EyesClosedAmount => {
                let [closed] = numbers(arguments)?;
                (Format::Native, EyeValue::Openness { eyes: Eyes::Both, share: 1.0 - closed })
            }
            Self::Deflection(format, eyes, axis) => {
                let [share] = numbers(arguments)?;
                let is_near = share.abs() <= GREATEST_DEFLECTION;
                (format, is_near.then_some(EyeValue::Deflection { eyes, axis, share })?)
            }
            Self::Openness(format, eyes) => {
                let [share] = numbers(arguments)?;
                (format, EyeValue::Openness { eyes, share })
            }
            Self::Tracked => (Format::Vrcft, EyeValue::Tracked(flag(arguments)?)),
        };
        Some(EyeMessage { format, value })
    }
}

/// So many finite numbers, and nothing else.
fn numbers<const COUNT: usize>(arguments: &[OscType]) -> Option<[f32; COUNT]> {
    let arguments: &[OscType; COUNT] = arguments.try_into().ok()?;
    let mut numbers = [0.0; COUNT];
    for (number, argument) in numbers.iter_mut().zip(arguments) {
        *number = match argument {
            OscType::Float(value) => *value,
            OscType::Double(value) => *value as f32,
            OscType::Int(value) => *value as f32,
            OscType::Long(value) => *value as f32,
            _ => return None,
        };
    }
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}

fn flag(arguments: &[OscType]) -> Option<bool> {
    match arguments {
        [OscType::Bool(flag)] => Some(*flag),
        other => numbers(other).map(|[number]| number != 0.0),
    }
}

/// The direction of a pitch downwards and a yaw to the right, degrees.
fn turned(pitch: f32, yaw: f32) -> Option<Vec3> {
    let is_near = pitch.abs() <= FARTHEST_DEG && yaw.abs() <= FARTHEST_DEG;
    is_near.then(|| direction([-yaw, -pitch]))
}

/// The direction of a vector with +z forward, of any length.
fn unity([x, y, z]: [f32; 3]) -> Option<Vec3> {
    let largest = x.abs().max(y.abs()).max(z.abs());
    if z <= 0.0 || largest < f32::MIN_POSITIVE {
        return None;
    }
    // The squares of its parts may be out of the range of numbers.
    (Vec3::new(x, y, -z) / largest).try_normalize()
}

#[cfg(test)]
mod tests;
