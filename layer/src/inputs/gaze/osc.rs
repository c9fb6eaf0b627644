//! Gaze by Open Sound Control (OSC) 1.0 over UDP, as eye trackers send it to VRChat, VRCFaceTracking and Baballonia's receivers.
//!
//! | Format | Addresses | Values |
//! |---|---|---|
//! | VRChat ([`Format::Native`]) | `/tracking/eye/CenterPitchYaw`, `CenterPitchYawDist`, `LeftRightPitchYaw` | degrees; pitch down and yaw to the right are positive |
//! | | `/tracking/eye/CenterVec`, `CenterVecFull`, `LeftRightVec` | +x right, +y up, +z forward |
//! | | `/tracking/eye/EyesClosedAmount` | 0 open to 1 closed |
//! | VRCFaceTracking ([`Format::Vrcft`]) | `/avatar/parameters/[prefix/]v2/EyeLeftX`, `EyeLeftY`, `EyeRightX`, `EyeRightY`, `EyeX`, `EyeY` | 1 is `gaze.osc_scale_deg` to the right or up |
//! | | `/avatar/parameters/[prefix/]v2/EyeLidLeft`, `EyeLidRight`, `EyeLid` | 0 closed, 0.75 open, 1 wide |
//! | | `/avatar/parameters/[prefix/]EyeTrackingActive` | whether the eyes are tracked |
//! | Baballonia ([`Format::Baballonia`]) | `[prefix]/LeftEyeX`, `LeftEyeY`, `RightEyeX`, `RightEyeY`, `EyesX`, `EyesY` | as VRCFaceTracking |
//! | | `[prefix]/LeftEyeLid`, `RightEyeLid` | 0 closed to 1 open |
//!
//! The first letter of Baballonia's names may be small. Sources: VRChat, "OSC Eye Tracking"; VRCFaceTracking, "Tracking
//! Parameters" (unified expressions, v2); Baballonia, `ParameterSenderService`.
//!
//! Packets are of other processes, and nothing in them is believed: see [`read`] for their form and [`OscGaze`] for their order and
//! senders. [`Listener`] receives them on a thread of its own, for the [`OscSource`] of a session.

mod assembly;
mod budget;
mod listener;
mod message;
mod source;

pub use assembly::{OscCounts, OscGaze, OscLook};
pub use listener::{Listener, NewestGaze};
pub use message::{Axis, EyeMessage, EyeValue, Eyes, Format, MOST_BYTES, OscPacketError, Packet, read};
pub use source::{OscSource, OscStatus};
