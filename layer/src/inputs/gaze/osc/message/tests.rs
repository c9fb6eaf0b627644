use super::*;
use crate::inputs::gaze::degrees;
use proptest::prelude::*;
use rosc::{OscBundle, OscTime, encoder::encode};

fn message(addr: &str, args: Vec<OscType>) -> OscPacket {
    OscPacket::Message(OscMessage { addr: addr.to_owned(), args })
}

fn floats(addr: &str, values: &[f32]) -> OscPacket {
    message(addr, values.iter().map(|value| OscType::Float(*value)).collect())
}

fn bundle(timetag: (u32, u32), content: Vec<OscPacket>) -> OscPacket {
    OscPacket::Bundle(OscBundle { timetag: timetag.into(), content })
}

fn values(packet: &OscPacket) -> Vec<EyeMessage> {
    read(&encode(packet).unwrap()).unwrap().messages.to_vec()
}

/// To the right and upwards, degrees.
fn right_up(direction: Vec3) -> [f32; 2] {
    let [left, up] = degrees(direction);
    [-left, up]
}

/// The example of VRChat's page: a target 15 degrees up, 20 to the right and half a metre away, with each of its formats.
#[test]
fn each_of_vrchat_s_formats_gives_the_direction_of_its_example() {
    let (up, right) = (15.252f32, 20.128f32);
    let [x, y, z] = [
        up.to_radians().cos() * right.to_radians().sin(),
        up.to_radians().sin(),
        up.to_radians().cos() * right.to_radians().cos(),
    ];
    for (name, arguments) in [
        ("CenterPitchYaw", vec![-up, right]),
        ("CenterPitchYawDist", vec![-up, right, 0.503]),
        ("LeftRightPitchYaw", vec![-up, right, -up, right]),
        ("CenterVec", vec![x, y, z]),
        ("CenterVecFull", vec![0.503 * x, 0.503 * y, 0.503 * z]),
        ("LeftRightVec", vec![x, y, z, x, y, z]),
    ] {
        let read = values(&floats(&format!("/tracking/eye/{name}"), &arguments));
        let [EyeMessage { format: Format::Native, value: EyeValue::Directions(directions) }] = read[..]
        else {
            panic!("{name}: {read:?}");
        };
        for direction in directions {
            let [found_right, found_up] = right_up(direction);
            assert!(
                (found_right - right).abs() < 1e-3 && (found_up - up).abs() < 1e-3,
                "{name}: {direction}"
            );
        }
    }
    let [left, right] = match values(&floats("/tracking/eye/LeftRightPitchYaw", &[-1.0, -2.0, 3.0, 4.0]))[..]
    {
        [EyeMessage { value: EyeValue::Directions(directions), .. }] => directions.map(right_up),
        ref other => panic!("{other:?}"),
    };
    assert!((left[0] + 2.0).abs() < 1e-4 && (left[1] - 1.0).abs() < 1e-4, "{left:?}");
    assert!((right[0] - 4.0).abs() < 1e-4 && (right[1] + 3.0).abs() < 1e-4, "{right:?}");
}

#[test]
fn deflections_and_lids_are_known_with_and_without_prefix() {
    let deflection =
        |format, eyes, axis| EyeMessage { format, value: EyeValue::Deflection { eyes, axis, share: 0.25 } };
    let openness = |format, eyes| EyeMessage { format, value: EyeValue::Openness { eyes, share: 0.25 } };
    use Axis::{Right, Up};
    use Format::{Baballonia, Vrcft};
    for (address, expected) in [
        ("/avatar/parameters/v2/EyeLeftX", deflection(Vrcft, Eyes::Left, Right)),
        ("/avatar/parameters/FT/v2/EyeLeftY", deflection(Vrcft, Eyes::Left, Up)),
        ("/avatar/parameters/a/b/v2/EyeRightX", deflection(Vrcft, Eyes::Right, Right)),
        ("/avatar/parameters/v2/EyeRightY", deflection(Vrcft, Eyes::Right, Up)),
        ("/avatar/parameters/v2/EyeX", deflection(Vrcft, Eyes::Both, Right)),
        ("/avatar/parameters/v2/EyeY", deflection(Vrcft, Eyes::Both, Up)),
        ("/avatar/parameters/v2/EyeLidLeft", openness(Vrcft, Eyes::Left)),
        ("/avatar/parameters/FT/v2/EyeLidRight", openness(Vrcft, Eyes::Right)),
        ("/LeftEyeX", deflection(Baballonia, Eyes::Left, Right)),
        ("/leftEyeY", deflection(Baballonia, Eyes::Left, Up)),
        ("/mine/RightEyeX", deflection(Baballonia, Eyes::Right, Right)),
        ("/avatar/parameters/RightEyeY", deflection(Baballonia, Eyes::Right, Up)),
        ("/EyesY", deflection(Baballonia, Eyes::Both, Up)),
        ("/LeftEyeLid", openness(Baballonia, Eyes::Left)),
        ("/rightEyeLid", openness(Baballonia, Eyes::Right)),
    ] {
        assert_eq!(values(&floats(address, &[0.25])), [expected], "{address}");
    }
    let closed = EyeValue::Openness { eyes: Eyes::Both, share: 0.25 };
    assert_eq!(
        values(&floats("/tracking/eye/EyesClosedAmount", &[0.75])),
        [EyeMessage { format: Format::Native, value: closed }]
    );
    for (argument, is_tracked) in
        [(OscType::Bool(true), true), (OscType::Bool(false), false), (OscType::Int(1), true)]
    {
        let read = values(&message("/avatar/parameters/FT/EyeTrackingActive", vec![argument]));
        assert_eq!(read, [EyeMessage { format: Vrcft, value: EyeValue::Tracked(is_tracked) }]);
    }
}

#[test]
fn messages_about_something_else_are_no_gaze() {
    for address in [
        "/avatar/parameters/v2/JawOpen",
        "/avatar/parameters/EyeLeftX",
        "/avatar/parameters/v2/EyeLeftX1",
        "/tracking/eye/centerpitchyaw",
        "/tracking/eye/",
        "/LeftEyeXX",
        "/cheekPuffLeft",
        "/",
    ] {
        let packet = read(&encode(&floats(address, &[0.5])).unwrap()).unwrap();
        assert_eq!(packet, Packet::default(), "{address}");
    }
}

#[test]
fn a_message_about_something_else_is_not_decoded() {
    // The first message's arguments are truncated, which is not checked.
    for (bytes, is_decoded) in [
        (&b"/jawOpen\0\0\0\0,ff\0"[..], false),
        (b"/LeftEyeX\0\0\0,f\0\0", true),
        (b"/\xff", false),
        (b"#bundle\0", true),
        (b"", true),
        (&[b'#'; MOST_BYTES + 1], false),
    ] {
        assert_eq!(needs_decoding(bytes), is_decoded, "{bytes:?}");
    }
    assert_eq!(read(b"/jawOpen\0\0\0\0,ff\0"), Ok(Packet::default()));
}

#[test]
fn arguments_that_are_no_gaze_are_counted() {
    for (address, values) in [
        ("/tracking/eye/CenterPitchYaw", &[f32::NAN, 0.0][..]),
        ("/tracking/eye/CenterPitchYaw", &[0.0, 90.5]),
        ("/tracking/eye/CenterPitchYaw", &[0.0]),
        ("/tracking/eye/LeftRightPitchYaw", &[0.0, 0.0, 0.0]),
        ("/tracking/eye/LeftRightPitchYaw", &[0.0, 0.0, 0.0, 1e30]),
        ("/tracking/eye/CenterVec", &[0.0, 0.0, 0.0]),
        ("/tracking/eye/CenterVec", &[0.0, 0.0, -1.0]),
        ("/tracking/eye/CenterVec", &[0.0, f32::INFINITY, 1.0]),
        ("/avatar/parameters/v2/EyeLeftX", &[1.6]),
        ("/LeftEyeX", &[f32::NEG_INFINITY]),
        ("/LeftEyeLid", &[]),
    ] {
        let packet = read(&encode(&floats(address, values)).unwrap()).unwrap();
        assert_eq!((packet.messages.len(), packet.implausible), (0, 1), "{address} {values:?}");
    }
    let text = message("/LeftEyeX", vec![OscType::String("0.5".to_owned())]);
    assert_eq!(read(&encode(&text).unwrap()).unwrap().implausible, 1);
}

#[test]
fn a_bundle_has_its_messages_in_order_and_its_time() {
    let [x, y] = ["/LeftEyeX", "/LeftEyeY"].map(|address| floats(address, &[0.5]));
    let inner = bundle((9, 9), vec![y.clone(), floats("/jawOpen", &[1.0])]);
    let packet = read(&encode(&bundle((7, 8), vec![x.clone(), inner, x.clone()])).unwrap()).unwrap();
    assert_eq!(packet.sent, Some(7 << 32 | 8));
    assert_eq!(packet.messages.to_vec(), [values(&x), values(&y), values(&x)].concat());
    let immediately = read(&encode(&bundle((0, 1), vec![x])).unwrap()).unwrap();
    assert_eq!(immediately.sent, None);
}

#[test]
fn the_deepest_bundle_and_the_deepest_array_are_read() {
    let mut bytes = Vec::new();
    let header =
        [&b"#bundle\0"[..], &OscTime::from((0, 1)).seconds.to_be_bytes(), &1u32.to_be_bytes()].concat();
    let levels = MOST_BYTES / 20;
    for level in 0..levels {
        bytes.extend_from_slice(&header);
        let inside = (levels - level - 1) * 20;
        bytes.extend_from_slice(&(inside as u32).to_be_bytes());
    }
    assert!(bytes.len() <= MOST_BYTES && bytes.len() > MOST_BYTES - 20);
    // The innermost is cut off; that the decoder comes back at all is the point, on a stack as small as a thread's.
    let read_it = move |bytes: Vec<u8>| std::thread::spawn(move || read(&bytes).is_ok()).join().unwrap();
    let _ = read_it(bytes);
    let half = MOST_BYTES / 2 - 16;
    let tags = format!("/LeftEyeX\0\0\0,{}{}\0", "[".repeat(half), "]".repeat(half));
    let mut bytes = tags.into_bytes();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    assert!(read_it(bytes), "an array is OSC, if no gaze");
}

#[test]
fn a_packet_that_is_too_large_is_not_decoded() {
    let mut bytes = encode(&floats("/LeftEyeX", &[0.5])).unwrap();
    bytes.resize(MOST_BYTES + 1, 0);
    assert_eq!(read(&bytes), Err(OscPacketError::Large));
    assert_eq!(read(b""), Err(OscPacketError::Malformed));
    assert_eq!(read(b"/LeftEyeX"), Err(OscPacketError::Malformed));
    assert_eq!(read(b"\xff\xfe"), Err(OscPacketError::Malformed));
}

/// Statements have finite values within their bounds.
fn assert_sound(packet: &Packet) {
    for message in &packet.messages {
        match message.value {
            EyeValue::Directions(directions) => {
                assert!(
                    directions
                        .iter()
                        .all(|direction| (direction.length() - 1.0).abs() < 1e-3 && direction.z < 1e-6),
                    "{directions:?}"
                );
            }
            EyeValue::Deflection { share, .. } => assert!(share.abs() <= GREATEST_DEFLECTION),
            EyeValue::Openness { share, .. } => assert!(share.is_finite()),
            EyeValue::Tracked(_) => {}
        }
    }
}

/// Addresses about the eyes, and one that is not.
fn address() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "/tracking/eye/CenterPitchYaw",
        "/tracking/eye/CenterPitchYawDist",
        "/tracking/eye/LeftRightPitchYaw",
        "/tracking/eye/CenterVec",
        "/tracking/eye/CenterVecFull",
        "/tracking/eye/LeftRightVec",
        "/tracking/eye/EyesClosedAmount",
        "/avatar/parameters/FT/v2/EyeLeftX",
        "/avatar/parameters/v2/EyeLidLeft",
        "/avatar/parameters/EyeTrackingActive",
        "/LeftEyeX",
        "/jawOpen",
    ])
}

proptest! {
    #[test]
    fn any_bytes_are_a_packet_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Ok(packet) = read(&bytes) {
            assert_sound(&packet);
        }
    }

    #[test]
    fn any_numbers_at_any_address_give_sound_statements(
        messages in prop::collection::vec((address(), prop::collection::vec(prop::num::f32::ANY, 0..7)), 0..6),
        in_bundle: bool,
    ) {
        let about_eyes = messages.iter().filter(|(address, _)| *address != "/jawOpen").count();
        let packets: Vec<OscPacket> = messages.iter().map(|(address, values)| floats(address, values)).collect();
        if in_bundle {
            let packet = read(&encode(&bundle((5, 0), packets)).unwrap()).unwrap();
            assert_sound(&packet);
            prop_assert_eq!(packet.messages.len() + packet.implausible as usize, about_eyes);
        } else {
            packets.iter().for_each(|packet| assert_sound(&read(&encode(packet).unwrap()).unwrap()));
        }
    }

    /// Degrees of a sender are the direction of these degrees.
    #[test]
    fn degrees_survive(pitch in -60.0f32..60.0, yaw in -60.0f32..60.0) {
        let read = values(&floats("/tracking/eye/CenterPitchYaw", &[pitch, yaw]));
        let EyeValue::Directions([direction, _]) = read[0].value else { panic!("{read:?}") };
        let [right, up] = right_up(direction);
        prop_assert!((right - yaw).abs() < 1e-3 && (up + pitch).abs() < 1e-3, "{right} {up}");
    }
}
