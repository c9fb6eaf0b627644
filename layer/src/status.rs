//! Status of this process during a session, for `parafovea status` (`parafovea_manifest::status`).
//!
//! A thread of ours writes the file. The application's thread hands it plain numbers on request, without an allocation or a wait. The thread
//! also takes requests for measurements of the eye tracker. Of gaze and sound it gets only their sources, whether they are available, and the
//! drift of the mean gaze.

mod applied_rates;
mod decisions;
mod history_too_large;
mod quiet;
mod signal;
mod snapshot;
mod unseen;

pub use decisions::{
    Decision, Topic, all as all_decisions, count as decision_count, decided, decision,
    take_over as take_over_decision,
};
pub use history_too_large::HistoryTooLarge;
pub use quiet::Quiet;
pub use signal::SignalQuality;
pub use snapshot::{GateStatus, StatusSnapshot};
pub use unseen::{Known, why_unseen};

use crate::abi::threads::spawn;
use crate::inputs::gaze::correction::CorrectionRequests;
use applied_rates::AppliedRates;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{EVERY_S, Settings, Status, StatusFile};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// Time between the request to the application's thread and the write of the file: some frames.
const ASKED_BEFORE: Duration = Duration::from_millis(100);

/// Reports one session until it is dropped.
pub struct StatusReporter(Arc<Shared>);

struct Shared {
    /// Gone when the session ends.
    file: Mutex<Option<StatusFile>>,
    snapshot: Mutex<StatusSnapshot>,
    settings: Mutex<Arc<Settings>>,
    /// Reason why the session had no visible effect when recognition had settled.
    unseen: Mutex<Option<Decision>>,
    is_asked: AtomicBool,
    /// Whether the last status could not be written.
    has_failed: AtomicBool,
}

impl StatusReporter {
    /// Begins to report a session; `known` has the parts that do not change. `None` if there is no place for it, which is logged unless none
    /// was chosen.
    pub fn begin(
        environment: &Environment,
        known: Status,
        settings: Arc<Settings>,
        mut corrections: Option<CorrectionRequests>,
    ) -> Option<Self> {
        let file = StatusFile::new(environment, known.pid)
            .inspect_err(|error| tracing::warn!("parafovea status will not show this session: {error}"))
            .ok()??;
        let shared = Arc::new(Shared {
            file: Mutex::new(Some(file)),
            snapshot: Mutex::default(),
            settings: Mutex::new(settings),
            unseen: Mutex::default(),
            is_asked: AtomicBool::new(true),
            has_failed: AtomicBool::new(false),
        });
        let theirs = shared.clone();
        let write = move || {
            let (mut status, mut applied) = (known, AppliedRates::default());
            loop {
                if let Some(corrections) = &mut corrections {
                    status.gaze_correction = corrections.poll();
                }
                if !theirs.write(&mut status) {
                    break;
                }
                if let Some(line) = applied.line(&status) {
                    tracing::info!("{line}");
                }
                // Dots come and go faster than everything else.
                if !status.gaze_correction.is_measuring {
                    sleep(Duration::from_secs(EVERY_S) - ASKED_BEFORE);
                }
                theirs.is_asked.store(true, Ordering::Relaxed);
                sleep(ASKED_BEFORE);
            }
        };
        spawn("parafovea-state", write)
            .inspect_err(|error| {
                tracing::warn!("parafovea status will not show this session: cannot start a thread: {error}")
            })
            .ok()?;
        Some(Self(shared))
    }

    /// Whether the newest is wanted.
    pub fn is_asked(&self) -> bool {
        self.0.is_asked.load(Ordering::Relaxed)
    }

    /// Takes the reason why the session has no visible effect. It is in the status as long as that is so.
    pub fn report_unseen(&self, line: String) {
        let decision = Decision { topic: Topic::Unseen, line };
        *self.0.unseen.lock().unwrap_or_else(PoisonError::into_inner) = Some(decision);
    }

    /// Takes the newest status; in the rare case that the last is being written, it is not taken.
    pub fn report(&self, snapshot: StatusSnapshot, settings: Arc<Settings>) {
        if let Ok(mut last) = self.0.settings.try_lock() {
            *last = settings;
        }
        if let Ok(mut last) = self.0.snapshot.try_lock() {
            *last = snapshot;
            self.0.is_asked.store(false, Ordering::Relaxed);
        }
    }
}

impl Drop for StatusReporter {
    fn drop(&mut self) {
        // The file goes with it: the application may end before the thread looks again.
        let file = self.0.file.lock().unwrap_or_else(PoisonError::into_inner).take();
        drop(file);
    }
}

impl Shared {
    /// Writes the file; false when the session has ended.
    fn write(&self, status: &mut Status) -> bool {
        let snapshot = *self.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        snapshot.write_to(status);
        let unseen = self.unseen.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let unseen = unseen.filter(|_| !snapshot.has_effect());
        status.decisions = decisions::all().iter().chain(&unseen).map(Decision::status).collect();
        status.settings = self.settings.lock().unwrap_or_else(PoisonError::into_inner).as_ref().clone();
        let file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        match &*file {
            Some(file) => {
                // A full disk may have room again.
                match file.write(status) {
                    Ok(()) => self.has_failed.store(false, Ordering::Relaxed),
                    Err(error) if !self.has_failed.swap(true, Ordering::Relaxed) => {
                        tracing::warn!("parafovea status does not show this session for now: {error}");
                    }
                    Err(_) => {}
                }
                true
            }
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::read_all;
    use std::time::SystemTime;

    #[test]
    fn a_session_is_told_of_until_it_ends() {
        let runtime = tempfile::tempdir().unwrap();
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| runtime.path().into()));
        let known = Status { pid: 7, application: "game".to_owned(), ..Status::default() };
        let reporter = StatusReporter::begin(&environment, known, Arc::default(), None).unwrap();
        assert!(reporter.is_asked());
        let settings = Settings { file: "/a.toml".to_owned(), has_error: false };
        reporter
            .report(StatusSnapshot { frames: 5, ..StatusSnapshot::default() }, Arc::new(settings.clone()));
        assert!(!reporter.is_asked());
        let read = || read_all(&environment, SystemTime::now()).found;
        let frames = || read().first().map_or(0, |found| found.status.frames);
        while frames() < 5 {
            sleep(Duration::from_millis(10));
        }
        assert_eq!(read()[0].status.application, "game");
        assert_eq!(read()[0].status.settings, settings);
        let is_unseen =
            || read()[0].status.decided(parafovea_manifest::status::Topic::Unseen).next().is_some();
        reporter.report_unseen("nothing is seen, of a test".to_owned());
        while !is_unseen() {
            sleep(Duration::from_millis(10));
        }
        // Recognition was late.
        let seen = StatusSnapshot { attenuates_colour: true, ..StatusSnapshot::default() };
        reporter.report(seen, Arc::default());
        while is_unseen() {
            sleep(Duration::from_millis(10));
        }
        let is_of_process = |decision: Decision| decision.line == "nothing is seen, of a test";
        assert!(!decisions::all().into_iter().any(is_of_process), "a later session has reasons of its own");
        // A user tidies up.
        std::fs::remove_dir_all(environment.status_folder().unwrap()).unwrap();
        while read().is_empty() {
            sleep(Duration::from_millis(10));
        }
        drop(reporter);
        assert_eq!(read(), []);
    }

    #[test]
    fn without_a_place_nothing_is_status() {
        assert!(
            StatusReporter::begin(&Environment::default(), Status::default(), Arc::default(), None).is_none()
        );
    }
}
