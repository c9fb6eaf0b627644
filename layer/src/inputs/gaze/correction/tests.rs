use super::*;
use crate::inputs::gaze::direction;
use parafovea_manifest::status::{StatusFile, ask_measurement};
use std::fs;
use tempfile::TempDir;

const FRAME_NS: i64 = 11_111_111;

/// A session with folders of its own.
struct Session {
    _folder: TempDir,
    environment: Environment,
    _status: StatusFile,
    correcting: Arc<SessionGazeCorrection>,
    requests: CorrectionRequests,
    time_ns: i64,
}

fn requests(environment: &Environment) -> (Arc<SessionGazeCorrection>, CorrectionRequests) {
    let correcting = Arc::<SessionGazeCorrection>::default();
    let requests = CorrectionRequests::new(environment, 7, "Headset".to_owned(), correcting.clone());
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
    fn look(&mut self, source: ActiveGazeSource, left_up: Option<[f32; 2]>) -> Look {
        let mut corrected = Look::NoTracker;
        for _ in 0..450 {
            self.time_ns += FRAME_NS;
            let look = left_up.map_or(Look::Unseen, |left_up| Look::At {
                direction: direction(left_up),
                sampled_ns: self.time_ns,
                uncertainty_ns: 0,
            });
            corrected = self.correcting.corrected(source, look, self.time_ns);
        }
        corrected
    }

    fn measure(
        &mut self,
        number: u64,
        source: ActiveGazeSource,
        left_up: Option<[f32; 2]>,
    ) -> CorrectionStatus {
        ask_measurement(&self.environment, 7, Some((GazeMeasurement::Recentre, number))).unwrap();
        let begun = self.requests.poll();
        assert!(begun.is_measuring && begun.number == number, "{begun:?}");
        self.look(source, left_up);
        self.requests.poll()
    }
}

impl Session {
    /// A calibration whose eyes look at the dots, as `tracker` sees them.
    fn calibrate(&mut self, number: u64, tracker: impl Fn([f32; 2]) -> [f32; 2]) -> CorrectionStatus {
        ask_measurement(&self.environment, 7, Some((GazeMeasurement::Calibrate, number))).unwrap();
        assert!(self.requests.poll().is_measuring);
        let mut shown = Vec::new();
        for _ in 0..1500 {
            self.time_ns += FRAME_NS;
            let dot = self.correcting.dot_deg();
            if shown.last() != Some(&dot) {
                shown.push(dot);
            }
            let look =
                Look::At { direction: direction(tracker(dot)), sampled_ns: self.time_ns, uncertainty_ns: 0 };
            self.correcting.corrected(ActiveGazeSource::Eyes, look, self.time_ns);
        }
        let done = self.requests.poll();
        assert!(!done.is_measuring && done.dot == 0, "{done:?}");
        assert_eq!(shown[..9], DOTS_DEG);
        assert_eq!(self.correcting.dot_deg(), [0.0; 2], "the dot of the debug view is ahead again");
        done
    }
}

/// A tracker with a wrong scale, turned by 2 degrees and off by 3.
fn distorted([left, up]: [f32; 2]) -> [f32; 2] {
    let (sin, cos) = 2f32.to_radians().sin_cos();
    [1.1 * (cos * left - sin * up) + 3.0, 1.1 * (sin * left + cos * up)]
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
    let done = session.measure(1, ActiveGazeSource::Eyes, Some([3.0, -1.0]));
    assert_eq!((done.is_measuring, done.failure.as_str()), (false, ""));
    assert_eq!(done.correction.unwrap().offset_deg, [-3.0, 1.0]);
    assert!(is_near(angles(session.look(ActiveGazeSource::Eyes, Some([3.0, -1.0]))), [0.0, 0.0]));
    assert!(
        is_near(angles(session.look(ActiveGazeSource::Osc, Some([3.0, -1.0]))), [3.0, -1.0]),
        "another tracker"
    );
    let (correcting, _later) = requests(&session.environment);
    let look = Look::At { direction: direction([3.0, -1.0]), sampled_ns: 1, uncertainty_ns: 0 };
    assert!(is_near(angles(correcting.corrected(ActiveGazeSource::Eyes, look, 1)), [0.0, 0.0]));
    // A second measurement is of the tracker itself, without the first correction.
    let again = session.measure(2, ActiveGazeSource::Eyes, Some([3.5, -1.0]));
    assert_eq!(again.correction.unwrap().offset_deg, [-3.5, 1.0]);
    // Reset, by another process.
    GazeCorrection::remove_all(&session.environment).unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(ActiveGazeSource::Eyes, Some([3.0, -1.0]))), [3.0, -1.0]));
}

#[test]
fn a_failed_measurement_keeps_the_correction_and_says_why() {
    let mut session = Session::new();
    session.measure(1, ActiveGazeSource::Osc, Some([1.0, 0.0]));
    for (number, left_up, reason) in [(2, None, "did not see the eyes"), (3, Some([9.0, 9.0]), "13 degrees")]
    {
        let failed = session.measure(number, ActiveGazeSource::Osc, left_up);
        assert!(failed.failure.contains(reason), "{failed:?}");
        assert_eq!(failed.correction.unwrap().offset_deg, [-1.0, 0.0]);
    }
    ask_measurement(&session.environment, 7, Some((GazeMeasurement::Recentre, 4))).unwrap();
    assert!(session.requests.poll().is_measuring);
    ask_measurement(&session.environment, 7, None).unwrap();
    assert!(!session.requests.poll().is_measuring);
    session.look(ActiveGazeSource::Osc, Some([2.0, 0.0]));
    assert_eq!(session.requests.poll().correction.unwrap().offset_deg, [-1.0, 0.0], "it was withdrawn");
}

#[test]
fn every_measured_offset_can_be_read_again() {
    let mut session = Session::new();
    let done = session.measure(1, ActiveGazeSource::Eyes, Some([-9.99, 0.0]));
    assert_eq!(done.correction.unwrap().offset_deg, [9.99, 0.0]);
}

#[test]
fn a_damaged_file_is_no_correction() {
    let mut session = Session::new();
    session.measure(1, ActiveGazeSource::Eyes, Some([3.0, 0.0]));
    let file = GazeCorrection::file(&session.environment, "Headset").unwrap();
    fs::write(&file, "{").unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(ActiveGazeSource::Eyes, Some([3.0, 0.0]))), [3.0, 0.0]));
    assert!(session.requests.fault.contains("Headset.json: EOF"), "{}", session.requests.fault);
}

#[test]
fn a_calibration_removes_a_distortion_and_an_offset_is_measured_after_it() {
    let mut session = Session::new();
    session.measure(1, ActiveGazeSource::Eyes, Some([3.0, -1.0]));
    let done = session.calibrate(2, distorted);
    assert_eq!(done.failure, "");
    let correction = done.correction.unwrap();
    let calibration = correction.calibration.clone().unwrap();
    assert_eq!(correction.offset_deg, [0.0; 2], "a calibration replaces the offset");
    assert!(calibration.error_before_deg > 1.0 && calibration.error_deg < 0.1, "{calibration:?}");
    let residual = |session: &mut Session, eyes: [f32; 2], slip: f32| {
        let [left, up] = distorted(eyes);
        let [seen_left, seen_up] = angles(session.look(ActiveGazeSource::Eyes, Some([left + slip, up])));
        (seen_left - eyes[0]).hypot(seen_up - eyes[1])
    };
    for eyes in [[0.0, 0.0], [8.0, -5.0], [-11.0, 8.0]] {
        assert!(residual(&mut session, eyes, 0.0) < 0.1);
    }
    assert!(
        is_near(angles(session.look(ActiveGazeSource::Osc, Some([3.0, -1.0]))), [3.0, -1.0]),
        "another tracker"
    );
    // The headset slips.
    let [left, up] = distorted([0.0; 2]);
    let recentred = session.measure(3, ActiveGazeSource::Eyes, Some([left + 1.5, up])).correction.unwrap();
    assert_eq!(recentred.calibration, Some(calibration), "the calibration stays");
    for eyes in [[0.0, 0.0], [8.0, -5.0], [-9.0, 8.0]] {
        assert!(residual(&mut session, eyes, 1.5) < 0.1);
    }
    // A later session has both.
    let (correcting, _later) = requests(&session.environment);
    let look = Look::At { direction: direction([left + 1.5, up]), sampled_ns: 1, uncertainty_ns: 0 };
    assert!(is_near(angles(correcting.corrected(ActiveGazeSource::Eyes, look, 1)), [0.0, 0.0]));
    // A reset removes both.
    GazeCorrection::remove_all(&session.environment).unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(ActiveGazeSource::Eyes, Some([3.0, -1.0]))), [3.0, -1.0]));
}

#[test]
fn a_measurement_of_another_source_keeps_the_calibration() {
    let mut session = Session::new();
    let calibrated = session.calibrate(1, distorted).correction.unwrap();
    let other = session.measure(2, ActiveGazeSource::Osc, Some([2.0, 0.0])).correction.unwrap();
    assert_eq!((other.source.as_str(), &other.others[..]), ("osc", std::slice::from_ref(&calibrated)));
    assert!(is_near(angles(session.look(ActiveGazeSource::Osc, Some([2.0, 0.0]))), [0.0, 0.0]));
    let eyes = angles(session.look(ActiveGazeSource::Eyes, Some(distorted([8.0, -5.0]))));
    assert!((eyes[0] - 8.0).hypot(eyes[1] + 5.0) < 0.1, "{eyes:?}");
    let [left, up] = distorted([0.0; 2]);
    let recentred = session.measure(3, ActiveGazeSource::Eyes, Some([left + 1.5, up])).correction.unwrap();
    assert_eq!(recentred.calibration, calibrated.calibration);
    assert_eq!(recentred.others[0].offset_deg, [-2.0, 0.0]);
}

#[test]
fn a_calibration_that_is_no_better_than_before_changes_nothing() {
    let mut session = Session::new();
    let first = session.calibrate(1, distorted).correction;
    let again = session.calibrate(2, distorted);
    assert!(again.failure.starts_with("a new correction would be off by"), "{}", again.failure);
    assert_eq!(again.correction, first);
}

#[test]
fn an_implausible_calibration_is_ignored_with_its_fault() {
    let mut session = Session::new();
    session.calibrate(1, distorted);
    let file = GazeCorrection::file(&session.environment, "Headset").unwrap();
    let mut damaged = GazeCorrection::read(&file).unwrap().unwrap();
    damaged.calibration.as_mut().unwrap().coefficients_deg[0][5] = 900.0;
    damaged.write(&file).unwrap();
    assert_eq!(session.requests.poll().correction, None);
    assert!(is_near(angles(session.look(ActiveGazeSource::Eyes, Some([3.0, 0.0]))), [3.0, 0.0]));
    assert!(
        session.requests.fault.contains("Headset.json: calibration: coefficients_deg: expected"),
        "{}",
        session.requests.fault
    );
}

#[test]
fn a_slip_is_a_drift_until_the_eye_tracker_is_recentred() {
    let mut session = Session::new();
    let fixate = |session: &mut Session, seconds: i64, slip: f32| {
        for _ in 0..seconds * 90 {
            session.time_ns += FRAME_NS;
            // A new point every third of a second.
            let fixation = session.time_ns / (1_000_000_000 / 3);
            let [left, up] = [fixation % 7 - 3, fixation % 5 - 2].map(|step| step as f32 * 3.0);
            let look = Look::At {
                direction: direction([left + slip, up]),
                sampled_ns: session.time_ns,
                uncertainty_ns: 0,
            };
            let look = session.correcting.corrected(ActiveGazeSource::Eyes, look, session.time_ns);
            session.correcting.note_phase(ActiveGazeSource::Eyes, look, GazePhase::Fixation, session.time_ns);
        }
    };
    fixate(&mut session, 600, 0.0);
    assert_eq!(session.correcting.drift_deg(), None);
    fixate(&mut session, 120, 3.0);
    let drift = session.correcting.drift_deg().unwrap();
    assert!((drift - 3.0).abs() < 0.2, "{drift}");
    session.measure(1, ActiveGazeSource::Eyes, Some([3.0, 0.0]));
    assert_eq!(session.correcting.drift_deg(), None);
    fixate(&mut session, 600, 3.0);
    assert_eq!(session.correcting.drift_deg(), None);
}
