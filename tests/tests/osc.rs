//! The gaze from OSC packets: a sender of the tests drives unmodified applications on the mock runtime, in each format; and other packets
//! only increase a count.

use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, read_all};
use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::osc::{FORMATS, LOOK, Sender, bundle, message};
use parafovea_tests::run::{Application, Outcome, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant, SystemTime};

/// Frames until filter and safety limits have settled, and more.
pub const FRAMES: u64 = 150;

/// Long enough on a machine that does much else.
const PATIENCE: Duration = Duration::from_secs(120);

/// A port that is free at this moment.
pub fn free_address() -> SocketAddr {
    parafovea_tests::osc::free_address().unwrap()
}

pub fn config(source: &str, address: SocketAddr) -> String {
    format!("[gaze]\nsource = \"{source}\"\nosc_listen = \"{address}\"\n[rates]\ngate = \"on\"\n")
}

fn scene(config: &str) -> Outcome {
    let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
    let scenario = Scenario::new(FRAMES).sized(128, 128);
    let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::NvkTuring).on(config);
    run.finish().unwrap().expect_frames(FRAMES).unwrap()
}

/// The last map.
pub fn last_map(outcome: &Outcome) -> String {
    let lines = outcome.shading_rates().unwrap();
    let mut maps = lines.into_iter().map(|line| match line {
        ShadingRateLine::Pass(pass) => pass.map.unwrap().texels.unwrap(),
        ShadingRateLine::Finding(finding) => panic!("{finding:?}"),
    });
    maps.next_back().unwrap()
}

#[test]
fn each_format_drives_the_rates_of_an_application() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gaze.csv");
    let [left, up] = LOOK;
    std::fs::write(&file, format!("0,{left},{up}\n")).unwrap();
    let played = format!("[gaze]\nsource = \"file\"\nfile = {file:?}\n[rates]\ngate = \"on\"\n");
    let expected = last_map(&scene(&played));
    let nobody = last_map(&scene(&config("osc", free_address())));
    assert!(expected.contains("0a") && expected != nobody, "{expected} {nobody}");
    for format in FORMATS {
        let address = free_address();
        let _sender = Sender::tracker(address, (format.packets)(LOOK)).unwrap();
        let outcome = scene(&config("osc", address));
        assert_eq!(last_map(&outcome), expected, "{}: {}", format.name, outcome.log);
    }
}

#[test]
fn a_correction_moves_the_gaze_of_packets() {
    let rates_of = |lines: &str, [left, up]: [f32; 2]| {
        let address = free_address();
        let packets = vec![message("/tracking/eye/CenterPitchYaw", &[-up, -left])];
        let _sender = Sender::tracker(address, packets).unwrap();
        last_map(&scene(&config("osc", address).replace("[gaze]\n", &format!("[gaze]\n{lines}"))))
    };
    let [left, up] = LOOK;
    let expected = rates_of("", LOOK);
    assert_eq!(rates_of("offset_deg = \"4, -2.5\"\n", [left - 4.0, up + 2.5]), expected);
    assert_ne!(rates_of("", [left - 4.0, up + 2.5]), expected);
}

pub fn start(config: &str, scenario: &Scenario) -> Running {
    let application = Application::hello_xr("Vulkan2").unwrap();
    Run::new(&application, scenario).on(config).start().unwrap()
}

pub fn long() -> Scenario {
    Scenario::new(1_000_000).sized(128, 128)
}

/// A headset whose runtime has no eye tracker.
fn without_tracker() -> Scenario {
    let mut scenario = long();
    scenario.system.eye_gaze = false;
    scenario
}

/// The status, once that is so; panics where it never is.
pub fn told(running: &Running, is_so: impl Fn(&Status) -> bool) -> Status {
    let begin = Instant::now();
    let environment =
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| running.runtime_folder().into()));
    loop {
        let found = read_all(&environment, SystemTime::now()).found;
        match found.as_slice() {
            [found] if is_so(&found.status) => return found.status.clone(),
            other => assert!(begin.elapsed() < PATIENCE, "{other:#?}\n{}", running.log()),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn hello_xr_follows_packets_while_they_arrive() {
    let address = free_address();
    let running = start(&config("auto", address), &without_tracker());
    let none = told(&running, |status| status.frames > 0 && status.gaze.holder == "centre");
    assert!(!none.gaze.is_valid && none.gaze.osc.address == address.to_string(), "{none:#?}");
    for format in FORMATS {
        let sender = Sender::tracker(address, (format.packets)(LOOK)).unwrap();
        let status = told(&running, |status| {
            let gaze = &status.gaze;
            gaze.holder == "osc"
                && gaze.is_valid
                && gaze.osc.format == format.status
                && gaze.rate_hz > Some(0.0)
        });
        assert_eq!((status.gaze.osc.failure.as_str(), status.gaze.osc.malformed), ("", 0), "{}", format.name);
        drop(sender);
        told(&running, |status| status.gaze.holder == "centre" && !status.gaze.is_valid);
    }
}

#[test]
fn floods_and_nonsense_are_counted_and_the_application_goes_on() {
    let address = free_address();
    let running = start(&config("osc", address), &without_tracker());
    let packets = (FORMATS[0].packets)(LOOK);
    let _tracker = Sender::tracker(address, packets).unwrap();
    let before = told(&running, |status| status.gaze.is_valid && status.gaze.holder == "osc");
    let nonsense: Vec<Vec<u8>> = vec![
        b"\xff\xff\xff\xff".to_vec(),
        vec![b'#'; 60_000],
        message("/tracking/eye/CenterPitchYaw", &[f32::NAN, f32::INFINITY]),
        message("/tracking/eye/CenterPitchYaw", &[30.0, 30.0]),
        bundle(&vec![message("/jawOpen", &[1.0]); 20]),
    ];
    // More than 10 000 packets a second.
    let flood = vec![nonsense; 100].concat();
    let flood = Sender::new(address, move || flood.clone(), Duration::from_millis(10)).unwrap();
    let during = told(&running, |status| {
        let osc = &status.gaze.osc;
        [osc.malformed, osc.implausible, osc.other_senders, osc.floods].iter().all(|count| *count > 10)
            && status.frames > before.frames
    });
    drop(flood);
    told(&running, |status| status.frames > during.frames && status.gaze.is_valid);
    assert!(!running.log().contains("panic"), "{}", running.log());
}

#[test]
fn a_port_that_is_taken_is_told_and_costs_no_more() {
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let running = start(&config("osc", address), &without_tracker());
    let status = told(&running, |status| !status.gaze.osc.failure.is_empty() && status.frames > 3);
    assert_eq!((status.gaze.holder.as_str(), status.gaze.is_valid), ("osc", false));
    let log = running.log();
    let line = format!("no gaze from OSC packets: gaze.osc_listen = \"{address}\"");
    assert_eq!(log.matches(&line).count(), 1, "{log}");
    // The previous holder of the port closes it.
    drop(taken);
    told(&running, |status| status.gaze.osc.failure.is_empty() && status.frames > 3);
}

#[test]
fn the_runtime_s_eye_tracker_comes_first_and_opens_no_port() {
    let address = free_address();
    let packets = (FORMATS[0].packets)(LOOK);
    let _sender = Sender::tracker(address, packets).unwrap();
    let config = config("auto", address).replace("[gaze]\n", "[gaze]\nattach_alone_after_s = 1\n");
    let running = start(&config, &long().gazing(5.0, 0.0));
    let status = told(&running, |status| status.gaze.holder == "eyes" && status.gaze.is_valid);
    assert_eq!((status.gaze.osc.address.as_str(), status.gaze.osc.packets), ("", 0));
}
