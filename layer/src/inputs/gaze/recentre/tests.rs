use super::*;
use crate::inputs::gaze::direction;
use parafovea_manifest::status::{StatusFile, ask_recentre};
use std::fs;
use tempfile::TempDir;

const FRAME_NS: i64 = 11_111_111;

/// A session with folders of its own.
struct Session {
    _folder: TempDir,
    environment: Environment,
    _status: StatusFile,
    correcting: Arc<GazeCorrecting>,
    requests: RecentreRequests,
    time_ns: i64,
}

fn requests(environment: &Environment) -> (Arc<GazeCorrecting>, RecentreRequests) {
    let correcting = Arc::<GazeCorrecting>::default();
    let requests = RecentreRequests::new(environment, 7, "Headset".to_owned(), correcting.clone());
    (correcting, requests)
}

impl Session {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let environment = Environment::new(false, |name| {
            ["XDG_RUNTIME_DIR", "XDG_STATE_HOME"].contains(&name).then(|| folder.path().into())
        });
        let status = StatusFile::new(&environment, 7).unwrap().unwrap();
        let (correcting, requests) = requests(&environment);
        Self { _folder: folder, environment, _status: status, correcting, requests, time_ns: 1 << 40 }
    }

    /// Five seconds of a gaze; the corrected one.
    fn look(&mut self, source: Holder, left_up: Option<[f32; 2]>) -> Look {
        let mut corrected = Look::NoTracker;
        for _ in 0..450 {
            self.time_ns += FRAME_NS;
            let look = left_up.map_or(Look::Unseen, |left_up| Look::At {
                direction: direction(left_up),
                sampled_ns: self.time_ns,
            });
            corrected = self.correcting.corrected(source, look, self.time_ns);
        }
        corrected
    }

    fn measure(&mut self, number: u64, source: Holder, left_up: Option<[f32; 2]>) -> Recentre {
        ask_recentre(&self.environment, 7, Some(number)).unwrap();
        let begun = self.requests.poll();
        assert!(begun.is_measuring && begun.number == number, "{begun:?}");
        self.look(source, left_up);
        self.requests.poll()
    }
}

fn angles(look: Look) -> [f32; 2] {
    match look {
        Look::At { direction, .. } => degrees(direction),
        other => panic!("{other:?}"),
    }
}

fn is_near(one: [f32; 2], other: [f32; 2]) -> bool {
    (one[0] - other[0]).hypot(one[1] - other[1]) < 0.01
}

#[test]
fn a_measured_offset_is_removed_in_this_session_and_in_later_ones_of_the_source() {
    let mut session = Session::new();
    let done = session.measure(1, Holder::Eyes, Some([3.0, -1.0]));
    assert_eq!((done.is_measuring, done.failure.as_str()), (false, ""));
    assert_eq!(done.correction.unwrap().offset_deg, [-3.0, 1.0]);
    assert!(is_near(angles(session.look(Holder::Eyes, Some([3.0, -1.0]))), [0.0, 0.0]));
    assert!(is_near(angles(session.look(Holder::Osc, Some([3.0, -1.0]))), [3.0, -1.0]), "another tracker");
    let (correcting, _later) = requests(&session.environment);
    let look = Look::At { direction: direction([3.0, -1.0]), sampled_ns: 1 };
    assert!(is_near(angles(correcting.corrected(Holder::Eyes, look, 1)), [0.0, 0.0]));
    // A second measurement is of the tracker, not of what the first one left.
    let again = session.measure(2, Holder::Eyes, Some([3.5, -1.0]));
    assert_eq!(again.correction.unwrap().offset_deg, [-3.5, 1.0]);
    // Reset, by another process.
    GazeCorrection::remove_all(&session.environment).unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(Holder::Eyes, Some([3.0, -1.0]))), [3.0, -1.0]));
}

#[test]
fn a_failed_measurement_keeps_the_correction_and_says_why() {
    let mut session = Session::new();
    session.measure(1, Holder::Osc, Some([1.0, 0.0]));
    for (number, left_up, reason) in [(2, None, "did not see the eyes"), (3, Some([9.0, 9.0]), "13 degrees")]
    {
        let failed = session.measure(number, Holder::Osc, left_up);
        assert!(failed.failure.contains(reason), "{failed:?}");
        assert_eq!(failed.correction.unwrap().offset_deg, [-1.0, 0.0]);
    }
    ask_recentre(&session.environment, 7, Some(4)).unwrap();
    assert!(session.requests.poll().is_measuring);
    ask_recentre(&session.environment, 7, None).unwrap();
    assert!(!session.requests.poll().is_measuring);
    session.look(Holder::Osc, Some([2.0, 0.0]));
    assert_eq!(session.requests.poll().correction.unwrap().offset_deg, [-1.0, 0.0], "it was withdrawn");
}

#[test]
fn every_measured_offset_can_be_read_again() {
    let mut session = Session::new();
    let done = session.measure(1, Holder::Eyes, Some([-9.99, 0.0]));
    assert_eq!(done.correction.unwrap().offset_deg, [9.99, 0.0]);
}

#[test]
fn a_damaged_file_is_no_correction() {
    let mut session = Session::new();
    session.measure(1, Holder::Eyes, Some([3.0, 0.0]));
    let file = GazeCorrection::file(&session.environment, "Headset").unwrap();
    fs::write(&file, "{").unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(Holder::Eyes, Some([3.0, 0.0]))), [3.0, 0.0]));
    assert!(session.requests.fault.contains("Headset.json: EOF"), "{}", session.requests.fault);
}
