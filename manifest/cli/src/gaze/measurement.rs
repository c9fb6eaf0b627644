//! `parafovea gaze recentre` and `parafovea gaze calibrate`.

use crate::status::{complain, read, shown_view, with_folder};
use parafovea_manifest::gaze_correction::{GazeCalibration, GazeCorrection};
use parafovea_manifest::options::DebugView;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{
    CorrectionStatus, Found, GazeMeasurement, Status, ask_measurement, ask_view,
};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Measure the eye tracker's offset, and correct it from then on
///
/// A red dot appears in front of the head, in the headset of a running application. Look at it without moving your head until it disappears,
/// after about five seconds. The offset between gaze and dot is stored for this headset and eye tracker, and corrects the gaze in all
/// applications, in addition to gaze.offset_deg. A stored calibration stays in use; only its offset changes. Ctrl+C ends the measurement
/// without a result.
#[derive(Clone, Debug, clap::Args)]
pub struct Recentre {
    #[command(flatten)]
    options: Options,
}

/// Calibrate the eye tracker with nine dots, and correct it from then on
///
/// A red dot appears at nine places one after the other, in the headset of a running application. Follow it with your eyes, without
/// moving your head, until it disappears, after about 15 seconds. The correction is stored for this headset and eye tracker, and applies in
/// all applications: a constant angle, and scale, rotation and curvature if they lower the error. Ctrl+C ends the measurement without a
/// result.
#[derive(Clone, Debug, clap::Args)]
pub struct Calibrate {
    #[command(flatten)]
    options: Options,
}

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// Running application that shows the dot, by OpenXR application name, executable name or process ID
    #[arg(value_name = "APPLICATION")]
    application: Option<String>,
    /// Remove the stored calibrations and offsets of all headsets instead
    #[arg(long, conflicts_with = "application")]
    reset: bool,
}

/// Time limit of a measurement, with the time for request and answer, and for repeated dots: a slower application hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval at which the status is read meanwhile.
const EVERY: Duration = Duration::from_millis(100);

/// The dots in rows from the top left, by their places in the order of appearance.
const ROWS: [[usize; 3]; 3] = [[8, 1, 2], [7, 0, 3], [6, 5, 4]];

/// Measures and stores the offset, or removes the stored corrections.
pub fn recentre(recentre: &Recentre) -> ExitCode {
    run(GazeMeasurement::Recentre, &recentre.options)
}

/// Measures and stores a calibration, or removes the stored corrections.
pub fn calibrate(calibrate: &Calibrate) -> ExitCode {
    run(GazeMeasurement::Calibrate, &calibrate.options)
}

fn run(kind: GazeMeasurement, options: &Options) -> ExitCode {
    if options.reset {
        return printed(reset(&Environment::of_process(false)));
    }
    with_folder(|environment| printed(measured(environment, kind, options.application.as_deref())))
}

fn printed(outcome: Result<String, String>) -> ExitCode {
    match outcome {
        Ok(text) => {
            crate::print(&format!("{text}\n"));
            ExitCode::SUCCESS
        }
        Err(error) => {
            complain!("parafovea: {error}");
            ExitCode::FAILURE
        }
    }
}

fn reset(environment: &Environment) -> Result<String, String> {
    let removed = GazeCorrection::remove_all(environment)
        .map_err(|error| format!("could not remove the corrections: {error}"))?;
    let lines: Vec<String> = removed.iter().map(|path| format!("removed {}", path.display())).collect();
    Ok(if lines.is_empty() { "No correction was stored.".to_owned() } else { lines.join("\n") })
}

fn measured(
    environment: &Environment,
    kind: GazeMeasurement,
    application: Option<&str>,
) -> Result<String, String> {
    let statuses = read(environment, application);
    complain(&statuses.unreadable);
    let Status { pid, debug_view, .. } = &chosen(statuses.found)?;
    let interrupted = interruption().map_err(|error| format!("signals cannot be handled: {error}"))?;
    let before = debug_view.is_asked.then(|| DebugView::of_name(&debug_view.name)).flatten();
    crate::print(match kind {
        GazeMeasurement::Recentre => {
            "Look at the red dot in the headset until it disappears. Do not move your head.\n"
        }
        GazeMeasurement::Calibrate => {
            "Follow the red dot in the headset with your eyes until it disappears. Do not move your head.\n"
        }
    });
    let outcome = ask(environment, kind, *pid, &interrupted);
    // An application that ended meanwhile took its requests along.
    let _ = ask_measurement(environment, *pid, None);
    let _ = ask_view(environment, *pid, before);
    outcome.map(|status| in_words(kind, &status))
}

/// The one application with an active session.
fn chosen(found: Vec<Found>) -> Result<Status, String> {
    let mut active: Vec<Status> =
        found.into_iter().map(|found| found.status).filter(|status| status.inert.is_empty()).collect();
    let names: Vec<String> =
        active.iter().map(|status| format!("{} (process {})", status.application, status.pid)).collect();
    match (active.pop(), names.as_slice()) {
        (Some(one), [_]) => Ok(one),
        (Some(_), _) => {
            Err(format!("several applications are running; name one of them: {}", names.join(", ")))
        }
        (None, _) => Err(
            "no running application has an active OpenXR session; to list all applications: parafovea status"
                .to_owned(),
        ),
    }
}

/// Whether the command was interrupted or its terminal closed, from now on. The second interruption ends it at once, as ever.
fn interruption() -> io::Result<Arc<AtomicBool>> {
    let interrupted = Arc::<AtomicBool>::default();
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_default(signal, Arc::clone(&interrupted))?;
        flag::register(signal, Arc::clone(&interrupted))?;
    }
    Ok(interrupted)
}

/// Shows the dot, and has the gaze measured.
fn ask(
    environment: &Environment,
    kind: GazeMeasurement,
    pid: u32,
    interrupted: &AtomicBool,
) -> Result<CorrectionStatus, String> {
    let refused = |error: io::Error| format!("could not send the request: {error}");
    ask_view(environment, pid, Some(DebugView::Ahead)).map_err(refused)?;
    let status = status_of(environment, pid)?;
    shown_view(environment, &status, Some(DebugView::Ahead))?;
    // Frames with a dot have a gaze to look for.
    let gaze = status_of(environment, pid)?.gaze;
    if matches!(gaze.holder.as_str(), "centre" | "file") {
        return Err(format!(
            "no eye tracker to correct (gaze: {gaze}); to check the source of the gaze: parafovea doctor"
        ));
    }
    let number = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| time.as_nanos() as u64);
    ask_measurement(environment, pid, Some((kind, number))).map_err(refused)?;
    let begin = Instant::now();
    let mut dot = 0;
    while begin.elapsed() < PATIENCE {
        let status = status_of(environment, pid)?.gaze_correction;
        if status.number == number && !status.is_measuring {
            return match status.failure.as_str() {
                "" => Ok(status),
                failure => Err(format!("the correction is unchanged: {failure}")),
            };
        }
        if kind == GazeMeasurement::Calibrate && status.number == number && status.dot > dot {
            dot = status.dot;
            crate::print(&format!("dot {dot} of 9\n"));
        }
        if interrupted.load(Ordering::Relaxed) {
            return Err("interrupted: the correction is unchanged".to_owned());
        }
        sleep(EVERY);
    }
    Err("no response: the application hangs, shows no frames, or uses another version of Parafovea"
        .to_owned())
}

fn status_of(environment: &Environment, pid: u32) -> Result<Status, String> {
    let found = read(environment, Some(&pid.to_string())).found;
    found.into_iter().next().map(|found| found.status).ok_or_else(|| "the application ended".to_owned())
}

fn in_words(kind: GazeMeasurement, status: &CorrectionStatus) -> String {
    let Some(correction) = &status.correction else {
        return "The correction was removed meanwhile.".to_owned();
    };
    let name = kind.name();
    let outcome = match (kind, &correction.calibration) {
        (GazeMeasurement::Calibrate, Some(calibration)) => residuals(calibration),
        _ => format!("The gaze is now corrected by {}.\n", of_offset(correction)),
    };
    format!(
        "{outcome}Stored for {} in {}\nTo undo: parafovea gaze {name} --reset",
        correction.headset, status.file
    )
}

/// The residual of each dot, where it was.
fn residuals(calibration: &GazeCalibration) -> String {
    let mut text = format!(
        "The gaze is now {}.\nAccuracy and precision at the dots, in degrees:\n",
        of_calibration(calibration)
    );
    for row in ROWS {
        let dots = row.map(|dot| {
            let [accuracy, precision] = calibration.dots_deg[dot];
            format!("{accuracy:5.2} {precision:4.2}")
        });
        text.push_str(&format!("  {}\n", dots.join("   ")));
    }
    text
}

/// A calibration in words.
fn of_calibration(calibration: &GazeCalibration) -> String {
    let (accuracy, precision) = calibration.accuracy_and_precision_deg();
    format!(
        "calibrated: expected error {:.2} degrees ({:.2} before), accuracy {accuracy:.2}, precision {precision:.2}",
        calibration.error_deg, calibration.error_before_deg
    )
}

/// A correction in words.
pub fn of_correction(correction: &GazeCorrection) -> String {
    match &correction.calibration {
        None => format!("by {}", of_offset(correction)),
        Some(calibration) if correction.offset_deg == [0.0; 2] => of_calibration(calibration),
        Some(calibration) => {
            format!("{}; recentred by {}", of_calibration(calibration), of_offset(correction))
        }
    }
}

/// An offset in words.
fn of_offset(correction: &GazeCorrection) -> String {
    let [left, up] = correction.offset_deg;
    let sideways = if left < 0.0 { "to the right" } else { "to the left" };
    let vertical = if up < 0.0 { "downwards" } else { "upwards" };
    format!(
        "{:.1} degrees {sideways} and {:.1} degrees {vertical}, measured with a spread of {:.2} degrees",
        left.abs(),
        up.abs(),
        correction.spread_deg
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_is_told_with_its_file_and_how_to_undo_it() {
        let correction = GazeCorrection::new("Headset", "eyes", [-3.0, 1.25], 0.2);
        let file = "/s/Headset.json".to_owned();
        let status = CorrectionStatus { correction: Some(correction), file, ..CorrectionStatus::default() };
        let text = in_words(GazeMeasurement::Recentre, &status);
        for part in [
            "corrected by 3.0 degrees to the right and 1.2 degrees upwards, measured with a spread of 0.20 degrees",
            "for Headset in /s/Headset.json",
            "recentre --reset",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
    }

    #[test]
    fn a_calibration_is_told_with_the_residual_at_each_dot() {
        let mut dots_deg = [[0.25, 0.125]; 9];
        dots_deg[8] = [0.75, 0.5];
        let calibration = GazeCalibration {
            coefficients_deg: [[0.0; 6]; 2],
            area_deg: [[-12.0, -9.0], [12.0, 9.0]],
            error_deg: 0.4,
            error_before_deg: 3.25,
            dots_deg,
        };
        let calibrated =
            GazeCorrection::new("Headset", "eyes", [0.0; 2], 0.2).with_calibration(Some(calibration.clone()));
        let file = "/s/Headset.json".to_owned();
        let status =
            CorrectionStatus { correction: Some(calibrated.clone()), file, ..CorrectionStatus::default() };
        let text = in_words(GazeMeasurement::Calibrate, &status);
        for part in [
            "calibrated: expected error 0.40 degrees (3.25 before), accuracy 0.31, precision 0.21",
            "\n   0.75 0.50    0.25 0.13    0.25 0.13\n",
            "calibrate --reset",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
        let recentred =
            GazeCorrection::new("Headset", "eyes", [1.0, 0.0], 0.2).with_calibration(Some(calibration));
        assert!(of_correction(&recentred).contains("precision 0.21; recentred by 1.0 degrees to the left"));
        assert!(!of_correction(&calibrated).contains("recentred"));
    }

    #[test]
    fn one_active_application_is_chosen_and_several_are_named() {
        let found = |pid, inert: &str| Found {
            status: Status {
                application: "Game".to_owned(),
                pid,
                inert: inert.to_owned(),
                ..Status::default()
            },
            age: Duration::ZERO,
            log: None,
        };
        assert_eq!(chosen(vec![found(3, "not Vulkan"), found(4, "")]).unwrap().pid, 4);
        assert!(chosen(vec![found(3, "not Vulkan")]).unwrap_err().starts_with("no running application"));
        let several = chosen(vec![found(3, ""), found(4, "")]).unwrap_err();
        assert!(several.contains("Game (process 3), Game (process 4)"), "{several}");
    }

    #[test]
    fn a_reset_names_the_removed_files() {
        let state = tempfile::tempdir().unwrap();
        let environment =
            Environment::new(false, |name| (name == "XDG_STATE_HOME").then(|| state.path().into()));
        assert_eq!(reset(&environment).unwrap(), "No correction was stored.");
        let path = GazeCorrection::file(&environment, "Headset").unwrap();
        GazeCorrection::new("Headset", "osc", [1.0, 0.0], 0.1).write(&path).unwrap();
        assert_eq!(reset(&environment).unwrap(), format!("removed {}", path.display()));
        assert!(!path.exists());
    }
}
