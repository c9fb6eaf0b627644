//! `parafovea gaze recentre`.

use crate::status::{read, shown_view, with_folder};
use parafovea_manifest::gaze_correction::GazeCorrection;
use parafovea_manifest::options::DebugView;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Found, Recentre, Status, ask_recentre, ask_view};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Measure the eye tracker's offset, and correct it from then on
///
/// A red dot appears in front of the head, in the headset of a running application. Look at it without moving your head until it disappears,
/// about five seconds. The offset between gaze and dot is stored for this headset and eye tracker, and corrects the gaze in all
/// applications, in addition to gaze.offset_deg. If the command is interrupted, parafovea status --view settings removes the dot.
#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Running application whose headset shows the dot: OpenXR application name, executable name or process ID
    #[arg(value_name = "APPLICATION")]
    application: Option<String>,
    /// Remove the stored corrections of all headsets instead
    #[arg(long, conflicts_with = "application")]
    reset: bool,
}

/// How long a measurement may take, with the time for request and answer: an application that is slower hangs.
const PATIENCE: Duration = Duration::from_secs(30);

/// How often the status is looked at meanwhile.
const EVERY: Duration = Duration::from_millis(100);

/// Measures and stores the offset, or removes the stored corrections.
pub fn recentre(options: &Options) -> ExitCode {
    if options.reset {
        return told(reset(&Environment::of_process(false)));
    }
    with_folder(|environment| told(measured(environment, options.application.as_deref())))
}

fn told(outcome: Result<String, String>) -> ExitCode {
    match outcome {
        Ok(text) => {
            crate::print(&format!("{text}\n"));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("parafovea: {error}");
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

fn measured(environment: &Environment, application: Option<&str>) -> Result<String, String> {
    let found = read(environment, application).map_err(|error| error.to_string())?.0;
    let Status { pid, debug_view, .. } = &chosen(found)?;
    let before = debug_view.is_asked.then(|| DebugView::of_name(&debug_view.name)).flatten();
    crate::print("Look at the red dot in the headset until it disappears.\n");
    let outcome = ask(environment, *pid);
    // An application that ended meanwhile took its requests along.
    let _ = ask_recentre(environment, *pid, None);
    let _ = ask_view(environment, *pid, before);
    outcome.map(|recentre| in_words(&recentre))
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
            Err(format!("several applications are running: {}; name one of them", names.join(", ")))
        }
        (None, _) => Err(
            "no running application with an active OpenXR session was found; to list all: parafovea status"
                .to_owned(),
        ),
    }
}

/// Shows the dot, and has the gaze measured.
fn ask(environment: &Environment, pid: u32) -> Result<Recentre, String> {
    let refused = |error: std::io::Error| format!("could not send the request: {error}");
    ask_view(environment, pid, Some(DebugView::Ahead)).map_err(refused)?;
    let status = status_of(environment, pid)?;
    shown_view(environment, &status, Some(DebugView::Ahead))?;
    // Frames with a dot have a gaze to look for.
    let gaze = status_of(environment, pid)?.gaze;
    if matches!(gaze.holder.as_str(), "centre" | "file") {
        return Err(format!("no eye tracker to correct; the gaze is: {gaze}"));
    }
    let number = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| time.as_nanos() as u64);
    ask_recentre(environment, pid, Some(number)).map_err(refused)?;
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        let recentre = status_of(environment, pid)?.recentre;
        if recentre.number == number && !recentre.is_measuring {
            return match recentre.failure.as_str() {
                "" => Ok(recentre),
                failure => Err(format!("the correction is unchanged: {failure}")),
            };
        }
        sleep(EVERY);
    }
    Err("no response: the application hangs, shows no frames, or uses another version of Parafovea"
        .to_owned())
}

fn status_of(environment: &Environment, pid: u32) -> Result<Status, String> {
    let found = read(environment, Some(&pid.to_string())).map_err(|error| error.to_string())?.0;
    found.into_iter().next().map(|found| found.status).ok_or_else(|| "the application ended".to_owned())
}

fn in_words(recentre: &Recentre) -> String {
    let Some(correction) = &recentre.correction else {
        return "The correction was removed meanwhile.".to_owned();
    };
    format!(
        "The gaze is now corrected by {}.\nStored for {} in {}\nTo undo: parafovea gaze recentre --reset",
        of_correction(correction),
        correction.headset,
        recentre.file
    )
}

/// A correction in words.
pub fn of_correction(correction: &GazeCorrection) -> String {
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
        let text = in_words(&Recentre { correction: Some(correction), file, ..Recentre::default() });
        for part in [
            "corrected by 3.0 degrees to the right and 1.2 degrees upwards, measured with a spread of 0.20 degrees",
            "for Headset in /s/Headset.json",
            "recentre --reset",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
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
