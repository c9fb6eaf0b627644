//! The gaze in the plan.

use super::*;
use crate::status::StatusSnapshot;
use parafovea_manifest::config::parse;
use rosc::{OscMessage, OscPacket, OscType, encoder::encode};
use std::net::UdpSocket;
use std::path::Path;
use std::thread::sleep;
use std::time::Instant;

#[test]
fn a_gaze_that_moves_between_begin_and_locate_is_in_the_plan_before_the_application_draws() {
    let application = Application::new();
    look(-30.0);
    application.settle();
    let left_edge = 16 * 32;
    application.begin();
    let before = plans();
    assert!(before.is_empty(), "the gaze has not moved");
    look(35.0);
    application.locate();
    let after = plans();
    assert_eq!(after.len(), 1);
    assert_eq!(after[0].1[left_edge], ShadingRate::R1X1.texel(), "where the eyes look now");
    look(-30.0);
    application.locate();
    assert_eq!(plans(), [], "once a frame");
}

/// An eye tracker that sends packets, and knows when they have arrived.
struct PacketTracker {
    session: std::sync::Arc<session::Session>,
    config: Config,
    socket: UdpSocket,
}

impl PacketTracker {
    /// Has the session follow packets to a free port of this computer.
    fn follow(application: &Application) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let address = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        // The query for a gaze for applications updates the number of received packets, without a frame.
        let settings = format!("[gaze]\nsource = \"osc\"\noffer = true\nosc_listen = \"{address}\"\n");
        let config = parse(Path::new("test.toml"), &settings).unwrap();
        let session = session::find(application.session).unwrap();
        session.instance.config.set(config);
        socket.connect(address).unwrap();
        Self { session, config, socket }
    }

    /// Sends a gaze that far to the left, degrees, and returns once it has arrived.
    fn look(&self, left_deg: f32) {
        let args = vec![OscType::Float(0.0), OscType::Float(-left_deg)];
        let message = OscMessage { addr: "/tracking/eye/CenterPitchYaw".to_owned(), args };
        let count = || {
            let mut status = StatusSnapshot::default();
            self.session.gaze.has_gaze_for_application(&self.config);
            self.session.gaze.write_status(&mut status);
            status.osc.counts.packets
        };
        let before = count();
        self.socket.send(&encode(&OscPacket::Message(message)).unwrap()).unwrap();
        while count() == before {
            sleep(Duration::from_millis(1));
        }
    }
}

/// From a packet to the rates in no frame: a packet that came before the application locates its views is in the map that it draws with.
#[test]
fn a_packet_that_comes_between_begin_and_locate_is_in_the_plan_before_the_application_draws() {
    let application = Application::new();
    let tracker = PacketTracker::follow(&application);
    // The port is opened.
    application.begin();
    application.end(&[application.view(0), application.view(1)], None);
    for _ in 0..90 {
        tracker.look(-30.0);
        application.frame();
    }
    crossings();
    let left_edge = 16 * 32;
    tracker.look(-30.0);
    application.begin();
    assert_eq!(plans(), [], "the eyes have not moved");
    tracker.look(35.0);
    application.locate();
    let after = plans();
    assert_eq!(after.len(), 1);
    assert_eq!(after[0].1[left_edge], ShadingRate::R1X1.texel(), "where the eyes look now");
}

#[test]
fn gaze_is_located_once_a_frame_with_the_first_views() {
    let application = Application::new();
    look(0.0);
    application.settle();
    GAZE_LOCATED.set(0);
    application.begin();
    assert_eq!(GAZE_LOCATED.get(), 0, "the views are yet to be located");
    application.locate();
    application.locate();
    assert_eq!(GAZE_LOCATED.get(), 1);
    application.end(&[application.view(0), application.view(1)], None);
    assert_eq!(GAZE_LOCATED.get(), 1);
}

/// With nothing to plan, the eye tracker is asked only for `parafovea gaze` and for a recording.
#[test]
fn a_gaze_without_a_plan_is_followed_if_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gaze.csv");
    let record = format!("[gaze]\nrecord = {file:?}\n");
    for (settings, is_watched, located) in [("", false, 0), ("", true, 90), (record.as_str(), false, 90)] {
        let application = Application::new();
        look(0.0);
        let session = session::find(application.session).unwrap();
        let text = format!("{settings}[rates]\nmode = \"off\"\n");
        let mut snapshot = ConfigSnapshot::of_tests(parse(Path::new("test.toml"), &text).unwrap());
        snapshot.is_gaze_watched = is_watched;
        session.instance.config.set_snapshot(snapshot);
        application.settle();
        GAZE_LOCATED.set(0);
        (0..90).for_each(|_| application.frame());
        assert_eq!(GAZE_LOCATED.get(), located, "{text}");
    }
    // A thread creates and writes it.
    let recorded = || std::fs::read_to_string(&file).map_or(0, |text| text.lines().count());
    let begun = Instant::now();
    while recorded() <= 90 && begun.elapsed() < Duration::from_secs(20) {
        sleep(Duration::from_millis(5));
    }
    assert!(recorded() > 90, "{}", recorded());
}

/// Number of plans that some calls make: each looks once for the gaze.
fn plans_of(act: &dyn Fn()) -> usize {
    GAZE_LOCATED.set(0);
    act();
    GAZE_LOCATED.get()
}

#[test]
fn an_application_that_locates_its_views_elsewhere_is_planned_at_begin() {
    let application = Application::new();
    look(0.0);
    application.settle();
    let views = [application.view(0), application.view(1)];
    // The first frame without its views is planned as it ends, those after it as they begin.
    assert_eq!(plans_of(&|| application.begin()), 0);
    assert_eq!(plans_of(&|| application.end(&views, None)), 1);
    for _ in 0..3 {
        assert_eq!(plans_of(&|| application.begin()), 1);
        // A thread that prepares the next frame.
        let time = DISPLAY_TIME.get();
        DISPLAY_TIME.set(time + FRAME_NS);
        assert_eq!(plans_of(&|| application.locate()), 0);
        DISPLAY_TIME.set(time);
        assert_eq!(plans_of(&|| application.end(&views, None)), 0);
    }
    // And back: one frame is planned as it begins, and the next with its views.
    assert_eq!(plans_of(&|| application.begin()), 1);
    assert_eq!(plans_of(&|| application.locate()), 0);
    application.end(&views, None);
    assert_eq!(plans_of(&|| application.begin()), 0);
    assert_eq!(plans_of(&|| application.locate()), 1);
}

/// The lead of a thread ahead of the render thread changes: the views of a frame are located after it began, or before. A frame that is planned
/// as it ends is drawn with the map of the frame before.
#[test]
fn views_located_ahead_plan_their_frame_at_begin() {
    let application = Application::new();
    look(0.0);
    application.settle();
    let views = [application.view(0), application.view(1)];
    let end = || application.end(&views, None);
    for _ in 0..3 {
        application.begin();
        assert_eq!(plans_of(&|| application.locate()), 1, "located after it began");
        assert_eq!(plans_of(&|| application.begin_ahead(end)), 1, "located ahead");
        assert_eq!(plans_of(&end), 0);
        assert_eq!(plans_of(&|| application.begin()), 1, "not known yet to be located");
        assert_eq!(plans_of(&|| application.locate()), 0);
        end();
    }
}

/// Views located twice for each frame: the second call has the newer gaze.
#[test]
fn views_located_ahead_and_again_plan_with_the_second_call() {
    let application = Application::new();
    look(0.0);
    application.settle();
    let views = [application.view(0), application.view(1)];
    application.begin();
    application.locate();
    for frame in 0..4 {
        GAZE_LOCATED.set(0);
        application.begin_ahead(|| application.end(&views, None));
        assert_eq!(GAZE_LOCATED.get(), usize::from(frame == 0), "frame {frame}, at begin");
        application.locate();
        assert_eq!(GAZE_LOCATED.get(), 1, "frame {frame}");
    }
}

#[test]
fn a_tracker_that_has_stopped_is_noticed_when_the_head_turns() {
    let application = Application::new();
    look(8.0);
    application.settle();
    for step in 0..100 {
        HEAD.set(Quat::from_rotation_y(step as f32 * 0.01));
        application.frame();
    }
    let plans = plans();
    let (_, last) = plans.last().expect("wide rates instead");
    let coarsest = last.iter().max().copied();
    assert!(coarsest < Some(ShadingRate::R4X4.texel()), "{coarsest:?}");
}

/// Width and height of the region at full rate, tiles, for a gaze at yaw 0, after frames with these views.
fn full(application: &Application, views: &[xr::CompositionLayerProjectionView]) -> [usize; 2] {
    let frames = |count: u32, yaw_deg: f32| {
        look(yaw_deg);
        for _ in 0..count {
            application.begin();
            application.locate();
            application.end(views, None);
        }
    };
    frames(90, 0.0);
    // A different gaze, so that the map at the end is passed to the Vulkan half.
    frames(20, -20.0);
    frames(90, 0.0);
    let map = plans().pop().unwrap().1;
    let is_full = |at: &usize| map[*at] == ShadingRate::R1X1.texel();
    let row = (16 * 32..17 * 32).filter(is_full).count();
    let column = (0..32).map(|row| row * 32 + 16).filter(is_full).count();
    [row, column]
}

#[test]
fn the_fovea_reaches_to_where_either_eye_looks_at_something_near() {
    let application = Application::new();
    let plain = [application.view(0), application.view(1)];
    let [row, column] = full(&application, &plain);
    assert!(row > column + 2, "4.5 degrees to either side: {row} {column}");
}

#[test]
fn depth_says_that_nothing_is_near() {
    let width = |near_z, far_z| {
        let application = Application::new();
        let depth = xr::CompositionLayerDepthInfoKHR {
            ty: xr::CompositionLayerDepthInfoKHR::TYPE,
            next: ptr::null(),
            sub_image: application.view(0).sub_image,
            min_depth: 0.0,
            max_depth: 1.0,
            near_z,
            far_z,
        };
        let mut views = [application.view(0), application.view(1)];
        views.iter_mut().for_each(|view| view.next = ptr::from_ref(&depth).cast());
        let [row, column] = full(&application, &views);
        row - column
    };
    let near = width(0.1, 100.0);
    assert!(width(3.0, f32::INFINITY) < near && width(50.0, 3.0) < near, "{near}");
    assert_eq!(width(f32::NAN, 100.0), near);
    assert_eq!(width(0.0, 100.0), near);
}

#[test]
fn the_time_of_a_sample_reaches_the_model() {
    // A gaze that follows something evenly is led on to the time when the frame is shown, if its own time is known.
    let map = |age_ns: Option<i64>| {
        let application = Application::new();
        SAMPLE_AGE_NS.set(age_ns);
        for step in 0..120 {
            look(-15.0 + 0.25 * step as f32);
            application.frame();
        }
        plans().pop().unwrap().1
    };
    let (known, old) = (map(Some(0)), map(Some(100_000_000)));
    assert_ne!(known, old, "a sample of 100 ms ago leads on further");
    assert_ne!(map(None), old, "50 ms are taken where it is not known");
}

#[test]
fn a_gaze_that_cannot_be_is_no_gaze() {
    let application = Application::new();
    look(0.0);
    application.settle();
    look(180.0);
    (0..80).for_each(|_| application.frame());
    let (_, map) = plans().pop().expect("wide rates instead");
    assert!(map.iter().all(|rate| *rate < ShadingRate::R4X4.texel()));
}
