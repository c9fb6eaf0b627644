use super::super::message::read;
use super::*;
use crate::inputs::gaze::degrees;
use proptest::prelude::*;
use rosc::{OscBundle, OscMessage, OscPacket, OscType, encoder::encode};
use smallvec::smallvec;

const MS: i64 = 1_000_000;

fn address(number: u16) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], number))
}

fn packet_of(address: &str, values: &[f32]) -> OscPacket {
    let args = values.iter().map(|value| OscType::Float(*value)).collect();
    OscPacket::Message(OscMessage { addr: address.to_owned(), args })
}

fn packet(address: &str, values: &[f32]) -> Result<Packet, OscPacketError> {
    read(&encode(&packet_of(address, values)).unwrap())
}

fn at(time: (u32, u32), right: f32) -> Result<Packet, OscPacketError> {
    let content = vec![packet_of("/tracking/eye/CenterPitchYaw", &[0.0, right])];
    read(&encode(&OscPacket::Bundle(OscBundle { timetag: time.into(), content })).unwrap())
}

fn yaw(right: f32) -> Result<Packet, OscPacketError> {
    packet("/tracking/eye/CenterPitchYaw", &[0.0, right])
}

/// To the right and upwards, degrees, rounded.
fn right_up(gaze: &OscGaze) -> Option<[f32; 2]> {
    let [left, up] = degrees(gaze.look().direction?);
    Some([-left, up].map(|angle| (angle * 100.0).round() / 100.0))
}

#[test]
fn a_direction_of_parts_is_known_once_an_eye_has_both() {
    for prefix in ["/avatar/parameters/FT/v2/Eye", "/"] {
        let name = |eye: &str, axis: &str| match prefix {
            "/" => format!("/{eye}Eye{axis}"),
            _ => format!("{prefix}{eye}{axis}"),
        };
        let mut gaze = OscGaze::new(40.0);
        gaze.take(address(1), packet(&name("Left", "X"), &[0.25]), 0);
        assert_eq!(right_up(&gaze), None, "{prefix}");
        gaze.take(address(1), packet(&name("Left", "Y"), &[-0.5]), 1);
        assert_eq!(right_up(&gaze), Some([10.0, -20.0]), "{prefix}: one eye will do");
        gaze.take(address(1), packet(&name("Right", "Y"), &[-0.5]), 2);
        gaze.take(address(1), packet(&name("Right", "X"), &[0.75]), 3);
        let [right, up] = right_up(&gaze).unwrap();
        assert!((right - 20.0).abs() < 0.5 && (up + 20.0).abs() < 1.0, "{prefix}: the middle of both");
        gaze.set_scale(20.0);
        for (eye, axis) in [("Left", "X"), ("Left", "Y"), ("Right", "X"), ("Right", "Y")] {
            gaze.take(address(1), packet(&name(eye, axis), &[0.5]), 4);
        }
        assert_eq!(right_up(&gaze), Some([10.0, 10.0]), "{prefix}");
    }
}

#[test]
fn sides_that_are_swapped_change_nothing() {
    let mut gaze = OscGaze::new(45.0);
    let mut seen = |values: &[f32]| {
        gaze.take(address(1), packet("/tracking/eye/LeftRightPitchYaw", values), 0);
        gaze.look().direction.unwrap()
    };
    // Baballonia gives the left eye the right one's yaw.
    let (straight, swapped) = (seen(&[-5.0, 12.0, -5.0, 8.0]), seen(&[-5.0, 8.0, -5.0, 12.0]));
    assert!(straight.abs_diff_eq(swapped, 1e-6), "{straight} {swapped}");
}

#[test]
fn closed_eyes_have_no_gaze_until_they_open_or_nothing_is_said_for_long() {
    let mut gaze = OscGaze::new(45.0);
    gaze.take(address(1), packet("/tracking/eye/LeftRightPitchYaw", &[0.0, 10.0, 0.0, 20.0]), 0);
    assert_eq!(right_up(&gaze), Some([15.0, 0.0]));
    gaze.take(address(1), packet("/avatar/parameters/v2/EyeLidLeft", &[0.1]), MS);
    assert_eq!(right_up(&gaze), Some([20.0, 0.0]), "the open one");
    gaze.take(address(1), packet("/tracking/eye/EyesClosedAmount", &[0.9]), 2 * MS);
    assert_eq!(right_up(&gaze), None);
    gaze.take(address(1), yaw(5.0), 3 * MS);
    assert_eq!(right_up(&gaze), None, "it is where the closed eyes cannot look");
    gaze.take(address(1), packet("/tracking/eye/EyesClosedAmount", &[0.2]), 4 * MS);
    assert_eq!(right_up(&gaze), Some([5.0, 0.0]));
    gaze.take(address(1), packet("/tracking/eye/EyesClosedAmount", &[1.0]), 5 * MS);
    gaze.take(address(1), yaw(6.0), 5 * MS + CLOSED_NS - 1);
    assert_eq!(right_up(&gaze), None);
    gaze.take(address(1), yaw(7.0), 5 * MS + CLOSED_NS);
    assert_eq!(right_up(&gaze), Some([7.0, 0.0]), "nobody says that they are still closed");
    let tracked = |is: f32| packet("/avatar/parameters/EyeTrackingActive", &[is]);
    gaze.take(address(1), tracked(0.0), 1010 * MS);
    gaze.take(address(1), yaw(8.0), 1020 * MS);
    assert_eq!(right_up(&gaze), None);
    gaze.take(address(1), tracked(1.0), 1030 * MS);
    assert_eq!(right_up(&gaze), Some([8.0, 0.0]));
}

#[test]
fn of_two_senders_the_first_holds_until_it_is_silent() {
    let mut gaze = OscGaze::new(45.0);
    for turn in 0..10 {
        gaze.take(address(1), yaw(5.0), turn * 10 * MS);
        gaze.take(address(2), yaw(-25.0), turn * 10 * MS + 1);
        assert_eq!(right_up(&gaze), Some([5.0, 0.0]));
    }
    assert_eq!(gaze.look().counts.other_senders, 10);
    // Words about something else keep nothing.
    gaze.take(address(1), packet("/jawOpen", &[1.0]), 400 * MS);
    gaze.take(address(2), yaw(-25.0), 90 * MS + HOLD_NS - 1);
    assert_eq!(right_up(&gaze), Some([5.0, 0.0]));
    gaze.take(address(2), yaw(-25.0), 90 * MS + HOLD_NS);
    assert_eq!(right_up(&gaze), Some([-25.0, 0.0]));
    gaze.take(address(1), yaw(5.0), 91 * MS + HOLD_NS);
    assert_eq!(right_up(&gaze), Some([-25.0, 0.0]));
}

#[test]
fn of_two_formats_of_a_sender_the_one_with_units_holds() {
    let mut gaze = OscGaze::new(45.0);
    let own = |gaze: &mut OscGaze, now_ns| {
        gaze.take(address(1), packet("/LeftEyeX", &[1.0]), now_ns);
        gaze.take(address(1), packet("/LeftEyeY", &[0.0]), now_ns);
    };
    own(&mut gaze, 0);
    assert_eq!((right_up(&gaze), gaze.look().format), (Some([45.0, 0.0]), Some(Format::Baballonia)));
    gaze.take(address(1), yaw(5.0), 1);
    own(&mut gaze, 2);
    assert_eq!((right_up(&gaze), gaze.look().format), (Some([5.0, 0.0]), Some(Format::Native)));
    own(&mut gaze, 1 + HOLD_NS);
    assert_eq!(right_up(&gaze), Some([45.0, 0.0]), "it came back to the one that is left");
}

#[test]
fn a_packet_that_is_late_is_left_out_and_a_clock_that_was_set_is_not() {
    let mut gaze = OscGaze::new(45.0);
    gaze.take(address(1), at((100, 5), 1.0), 0);
    gaze.take(address(1), at((100, 4), 2.0), 1);
    assert_eq!((right_up(&gaze), gaze.look().counts.late), (Some([1.0, 0.0]), 1));
    gaze.take(address(1), at((100, 5), 3.0), 2);
    assert_eq!(right_up(&gaze), Some([3.0, 0.0]), "the same time");
    gaze.take(address(1), at((7, 0), 4.0), 3);
    assert_eq!((right_up(&gaze), gaze.look().counts.late), (Some([4.0, 0.0]), 1));
    gaze.take(address(1), yaw(5.0), 4);
    assert_eq!(right_up(&gaze), Some([5.0, 0.0]), "one without a time");
}

#[test]
fn the_rate_is_that_of_directions_whatever_their_parts() {
    for names in
        [&["/tracking/eye/CenterPitchYaw"][..], &["/LeftEyeX", "/LeftEyeY", "/RightEyeX", "/RightEyeY"]]
    {
        let mut gaze = OscGaze::new(45.0);
        for turn in 0..300 {
            for name in names {
                let values = vec![0.1; if names.len() == 1 { 2 } else { 1 }];
                gaze.take(address(1), packet(name, &values), turn * 1_000 * MS / 120);
            }
            gaze.take(address(1), packet("/LeftEyeLid", &[0.9]), turn * 1_000 * MS / 120);
        }
        let rate = gaze.look().rate_hz;
        assert!((rate - 120.0).abs() < 1.5, "{names:?}: {rate}");
    }
}

#[test]
fn lids_alone_are_no_direction() {
    let mut gaze = OscGaze::new(45.0);
    gaze.take(address(1), packet("/LeftEyeLid", &[0.9]), 5);
    assert_eq!((gaze.look().serial, gaze.look().direction), (0, None));
    gaze.take(address(1), yaw(5.0), 10);
    gaze.take(address(1), packet("/LeftEyeLid", &[0.9]), 15);
    assert_eq!((gaze.look().serial, gaze.look().received_ns), (1, 10));
}

fn message() -> impl Strategy<Value = EyeMessage> {
    let eyes = prop::sample::select(vec![Eyes::Left, Eyes::Right, Eyes::Both]);
    let value = prop_oneof![
        (-90.0f32..90.0, -90.0f32..90.0)
            .prop_map(|(left, up)| EyeValue::Directions([direction([left, up]), direction([up, left])])),
        (eyes.clone(), any::<bool>(), -1.5f32..=1.5).prop_map(|(eyes, is_up, share)| {
            EyeValue::Deflection { eyes, axis: if is_up { Axis::Up } else { Axis::Right }, share }
        }),
        (eyes, prop::num::f32::NORMAL).prop_map(|(eyes, share)| EyeValue::Openness { eyes, share }),
        any::<bool>().prop_map(EyeValue::Tracked),
    ];
    let format = prop::sample::select(vec![Format::Native, Format::Vrcft, Format::Baballonia]);
    (format, value).prop_map(|(format, value)| EyeMessage { format, value })
}

proptest! {
    /// Any messages of any senders, in any order and at any times, give a direction or none, and every packet is counted.
    #[test]
    fn any_words_of_any_senders_give_a_direction_or_none(
        packets in prop::collection::vec(
            (0u16..3, prop::collection::vec(message(), 0..4), prop::option::of(any::<u64>()), any::<i64>(), 0u8..8),
            0..40,
        ),
        scale_deg in 10.0f32..=60.0,
    ) {
        let mut gaze = OscGaze::new(scale_deg);
        let count = packets.len() as u64;
        for (sender, messages, sent, now_ns, kind) in packets {
            let packet = match kind {
                0 => Err(OscPacketError::Malformed),
                _ => Ok(Packet { sent, messages: messages.into(), implausible: 0 }),
            };
            gaze.take(address(sender), packet, now_ns);
            let look = gaze.look();
            prop_assert!(look.direction.is_none_or(|direction| (direction.length() - 1.0).abs() < 1e-3));
            prop_assert!(look.rate_hz.is_finite() && look.rate_hz >= 0.0);
        }
        let counts = gaze.look().counts;
        prop_assert_eq!(counts.packets, count);
        prop_assert!(counts.malformed + counts.other_senders + counts.late <= count);
    }
}

#[test]
fn a_direction_opposite_to_the_other_eye_s_is_none() {
    let mut gaze = OscGaze::new(45.0);
    let opposite = EyeValue::Directions([Vec3::X, Vec3::NEG_X]);
    let message = EyeMessage { format: Format::Native, value: opposite };
    gaze.take(address(1), Ok(Packet { messages: smallvec![message], ..Packet::default() }), 0);
    assert_eq!(gaze.look().direction, None);
}
