//! `parafovea status`.

mod screen;
mod text;
mod view;

pub use text::title;
pub use view::shown_view;

use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{EVERY_S, Found, Gone, Statuses, UnreadableStatus, read_all};
use serde_json::json;
use std::process::ExitCode;
use std::time::{Duration, SystemTime};

/// Options of `parafovea status`.
#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Application to show, by OpenXR application name, executable name or process ID
    #[arg(value_name = "APPLICATION")]
    application: Option<String>,
    /// Show this debug view in the headset until the application ends; "settings" returns to the configured view
    #[arg(long, value_name = "VIEW", value_parser = view::parser())]
    view: Option<String>,
    /// Show the state once, instead of every second
    #[arg(long)]
    once: bool,
    /// Print one JSON object per line, for each application and second
    #[arg(long)]
    json: bool,
}

/// Presentation of the found applications.
pub struct Watched<Text, Json> {
    /// For people.
    pub text: Text,
    /// For scripts: an object on each line.
    pub json: Json,
}

/// Shows the applications with the layer, until it is interrupted or its reader ends.
pub fn status(options: Options) -> ExitCode {
    let application = options.application.as_deref();
    if let Some(view) = &options.view {
        let ask = |environment: &Environment| view::ask(environment, application, view);
        return with_folder(ask);
    }
    with_folder(|environment| {
        let text = |found: &[Found], gone| text::of_all(found, gone, application);
        repeat(environment, application, options.once, options.json, &Watched { text, json: as_json })
    })
}

/// Shows `application`, or all, once or every second.
pub fn watch(
    application: Option<&str>,
    once: bool,
    json: bool,
    shown: Watched<impl Fn(&[Found]) -> String, impl Fn(&[Found]) -> String>,
) -> ExitCode {
    with_folder(|environment| {
        let Watched { text, json: as_json } = &shown;
        let shown = Watched { text: |found: &[Found], _| text(found), json: as_json };
        repeat(environment, application, once, json, &shown)
    })
}

/// Calls `show`, unless applications have no folder for their state.
pub fn with_folder(show: impl FnOnce(&Environment) -> ExitCode) -> ExitCode {
    let environment = Environment::of_process(false);
    if environment.status_folders().is_empty() {
        complain!(
            "parafovea: none of XDG_RUNTIME_DIR, XDG_STATE_HOME and HOME is set, so applications have no folder for their state; run this in your desktop session, which sets them"
        );
        return ExitCode::FAILURE;
    }
    if environment.status_folder().is_none() {
        complain!(
            "parafovea: XDG_RUNTIME_DIR is not set, so only applications in containers such as Steam's are found; your desktop session sets it"
        );
    }
    show(&environment)
}

fn repeat(
    environment: &Environment,
    application: Option<&str>,
    once: bool,
    json: bool,
    shown: &Watched<impl Fn(&[Found], Gone) -> String, impl Fn(&[Found]) -> String>,
) -> ExitCode {
    let mut told = Vec::new();
    loop {
        let Statuses { found, gone, unreadable } = read(environment, application);
        let faults: Vec<String> = unreadable.iter().map(|folder| format!("{folder}\n")).collect();
        let shown = if json { (shown.json)(&found) } else { (shown.text)(&found, gone) };
        let shown = if json || once {
            if told != faults {
                complain(&unreadable);
                told = faults;
            }
            shown
        } else {
            // A screen that is cleared each second would also lose lines on standard error.
            screen::live(faults.concat() + &shown)
        };
        if !crate::can_print(&shown) || once {
            return if once && !unreadable.is_empty() { ExitCode::FAILURE } else { ExitCode::SUCCESS };
        }
        if crate::has_lost_reader(Duration::from_secs(EVERY_S)) {
            return ExitCode::SUCCESS;
        }
    }
}

/// Prints the folders that cannot be read as errors.
pub fn complain(unreadable: &[UnreadableStatus]) {
    for folder in unreadable {
        complain!("parafovea: {folder}");
    }
}

/// Status of `application`, or of all.
pub fn read(environment: &Environment, application: Option<&str>) -> Statuses {
    let mut statuses = read_all(environment, SystemTime::now());
    let is_it = |Found { status, .. }: &Found| {
        application.is_none_or(|name| {
            name == status.application || name == status.executable || name == status.pid.to_string()
        })
    };
    statuses.found.retain(is_it);
    statuses
}

/// Each status with its age, a line of JSON each.
fn as_json(found: &[Found]) -> String {
    let line = |found: &Found| {
        let mut object = json!(found.status);
        object["status_age_ms"] = json!(found.age.as_millis() as u64);
        format!("{object}\n")
    };
    found.iter().map(line).collect()
}
