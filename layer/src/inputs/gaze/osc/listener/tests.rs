use super::*;
use rosc::{OscMessage, OscPacket, OscType, encoder::encode};

/// Longer than any of these takes on a machine that does much else.
const LIMIT: Duration = Duration::from_secs(60);

/// A listener at a port that the system chose.
fn begun() -> (Listener, SocketAddr) {
    let listener = Listener::begin(SocketAddr::from(([127, 0, 0, 1], 0)), 45.0).unwrap();
    let address = listener.wake;
    (listener, address)
}

fn sender() -> UdpSocket {
    UdpSocket::bind("127.0.0.1:0").unwrap()
}

fn yaw(right: f32) -> Vec<u8> {
    let args = vec![OscType::Float(0.0), OscType::Float(right)];
    encode(&OscPacket::Message(OscMessage { addr: "/tracking/eye/CenterPitchYaw".to_owned(), args })).unwrap()
}

/// Once `is_so`; panics where it never is.
fn heard(listener: &Listener, mut send: impl FnMut(), is_so: impl Fn(&NewestGaze) -> bool) -> NewestGaze {
    let begin = Instant::now();
    loop {
        send();
        match listener.newest() {
            Some(heard) if is_so(&heard) => return heard,
            other => assert!(begin.elapsed() < LIMIT, "{other:?}"),
        }
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_gaze_that_is_sent_is_heard_and_other_bytes_are_counted() {
    let (listener, address) = begun();
    assert_eq!(heard(&listener, || (), |_| true).age, None);
    let socket = sender();
    socket.send_to(b"\0nonsense", address).unwrap();
    socket.send_to(&[b'/'; 20_000], address).unwrap();
    socket.send_to(&yaw(f32::NAN), address).unwrap();
    socket.send_to(&yaw(90.0), address).unwrap();
    let heard = heard(&listener, || (), |heard| heard.look.direction.is_some());
    assert!(heard.look.direction.unwrap().x > 0.999 && heard.age.is_some(), "{heard:?}");
    let counts = heard.look.counts;
    assert_eq!((counts.packets, counts.malformed, counts.implausible), (4, 2, 1), "{counts:?}");
}

#[test]
fn a_port_is_taken_while_it_listens_and_free_afterwards() {
    let (listener, address) = begun();
    assert_eq!(Listener::begin(address, 45.0).unwrap_err().kind(), ErrorKind::AddrInUse);
    drop(listener);
    drop(Listener::begin(address, 45.0).unwrap());
}

#[test]
fn after_a_flood_a_gaze_is_heard_as_before() {
    let (listener, address) = begun();
    let flood = sender();
    let junk = encode(&OscPacket::Message(OscMessage { addr: "/jawOpen".to_owned(), args: vec![] })).unwrap();
    let during = heard(
        &listener,
        || (0..500).for_each(|_| drop(flood.send_to(&junk, address))),
        |heard| heard.look.counts.floods > 2,
    );
    assert_eq!(during.look.direction, None);
    let socket = sender();
    heard(&listener, || drop(socket.send_to(&yaw(5.0), address)), |heard| heard.look.direction.is_some());
    // It ends, too.
    drop(listener);
}

#[test]
fn an_address_for_all_networks_is_reached_at_the_loopback() {
    for (bound, reached) in [
        ("0.0.0.0:9", "127.0.0.1:9"),
        ("[::]:9", "[::1]:9"),
        ("127.0.0.1:9", "127.0.0.1:9"),
        ("192.0.2.1:9", "192.0.2.1:9"),
    ] {
        assert_eq!(reachable(bound.parse().unwrap()), reached.parse().unwrap());
    }
}
