//! `parafovea status --view`.

use super::{complain, read};
use clap::builder::PossibleValuesParser;
use parafovea_manifest::options::DebugView;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{FRESH_S, Found, Status, Statuses, ask_view};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Name for the configured view.
const SETTINGS: &str = "settings";

/// Time limit for applications to follow. They report every second; one that has not reported for so long hangs.
const PATIENCE: Duration = Duration::from_secs(FRESH_S);

/// Interval at which the status is read meanwhile.
const EVERY: Duration = Duration::from_millis(100);

/// The names that can be asked for.
pub fn parser() -> PossibleValuesParser {
    PossibleValuesParser::new(DebugView::ALL.iter().map(|view| view.name()).chain([SETTINGS]))
}

/// Requests the view from the applications, and prints the outcome for each.
pub fn ask(environment: &Environment, application: Option<&str>, name: &str) -> ExitCode {
    let view = DebugView::of_name(name);
    let Statuses { found, unreadable, .. } = read(environment, application);
    complain(&unreadable);
    if found.is_empty() {
        let which = application.map_or("no running application".to_owned(), |name| {
            format!("no running application named {name}")
        });
        complain!(
            "parafovea: {which} has an OpenXR session with Parafovea; to list all applications: parafovea status"
        );
        return ExitCode::FAILURE;
    }
    let mut all_follow = true;
    for Found { status, .. } in found {
        let line = match ask_view(environment, status.pid, view) {
            Ok(()) => shown_view(environment, &status, view),
            Err(error) => Err(format!("could not send the request: {error}")),
        };
        all_follow &= line.is_ok();
        let (Ok(line) | Err(line)) = line;
        crate::print(&format!("{}: {line}\n", super::text::title(&status)));
    }
    if all_follow { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The outcome of a request, once known: the visible view, or why there is none.
pub fn shown_view(
    environment: &Environment,
    asked: &Status,
    view: Option<DebugView>,
) -> Result<String, String> {
    if !asked.inert.is_empty() {
        return Err(format!("no overlay, because the session is inert: {}", asked.inert));
    }
    let begin = Instant::now();
    loop {
        let found = read(environment, Some(&asked.pid.to_string())).found;
        let Some(Found { status, .. }) = found.into_iter().next() else {
            return Err("the application ended".to_owned());
        };
        let shown = &status.debug_view;
        let follows = match view {
            Some(view) => shown.is_asked && shown.name == view.name(),
            None => !shown.is_asked,
        };
        match (follows, shown.name.as_str(), shown.is_drawn) {
            (true, "none", _) => return Ok("no overlay".to_owned()),
            (true, name, true) => return Ok(format!("\"{name}\" is visible in the headset")),
            _ if begin.elapsed() < PATIENCE => sleep(EVERY),
            (true, name, false) => {
                return Err(format!(
                    "\"{name}\" is not visible: {}. For details, see the log; parafovea status prints its path",
                    super::text::why_not_drawn(&status)
                ));
            }
            (false, ..) => {
                return Err(
                    "no response: the application hangs, shows no frames, or uses another version of Parafovea"
                        .to_owned(),
                );
            }
        }
    }
}
