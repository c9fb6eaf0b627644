//! The configuration at this moment, and edits of its file.

mod arming;
mod chroma;
mod debug_view;
mod plan;

pub use arming::{Arming, Demands, device_armed};
pub use chroma::chroma_settings;
pub use debug_view::debug_view;
pub use parafovea_manifest::config::Config;
pub use parafovea_manifest::options::{
    AudioMode, AudioSource, ChromaMatrix, ChromaMode, DebugView, FilePath, GazeSource, LogLevel, PassRules,
    PeripheralRate, Preset, RatesBackend, RatesGate, RatesMode, ReuseMode, ReusePhase, SilenceRule,
};
pub use parafovea_manifest::paths::Environment;
pub use plan::{
    PlannedDevice, changes_costs, gate_modes, gaze_settings, images_for_reuse, longest_period, plan_settings,
    wants_contrast, wants_maps, wants_reuse,
};

use crate::abi::threads::spawn;
use crate::abi::{attempt, executable};
use crate::log::EDIT;
use arc_swap::ArcSwap;
use parafovea_manifest::config::{ConfigErrors, Watch};
use parafovea_manifest::status::{AskedView, GazeWatch, Settings};
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

/// Time between two looks. An edit applies at the second look that finds it, within half a second.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// One application's configuration, kept current by a thread from [`LiveConfig::watch`] on: a look at files takes time on the
/// application's thread, and on a network's file system as long as that wants.
#[derive(Debug)]
pub struct LiveConfig {
    shared: Arc<Shared>,
    is_watched: AtomicBool,
}

#[derive(Debug)]
struct Shared {
    current: ArcSwap<ConfigSnapshot>,
    watched: Mutex<Watched>,
    /// The configuration before the edits that nobody has taken.
    before: Mutex<Option<Arc<ConfigSnapshot>>>,
    is_edited: AtomicBool,
}

/// The configuration at one moment. A frame has one from its xrBeginFrame to the next.
#[derive(Clone, Debug, Default)]
pub struct ConfigSnapshot {
    config: Config,
    /// The file that it was read from.
    pub source: Arc<Settings>,
    /// Whether the debug view is not the file's, but requested by `parafovea status --view`.
    pub is_view_asked: bool,
    /// Whether `parafovea gaze` watches the gaze.
    pub is_gaze_watched: bool,
}

#[cfg(test)]
impl ConfigSnapshot {
    /// A configuration of no file.
    pub fn of_tests(config: Config) -> Self {
        Self { config, source: Arc::default(), is_view_asked: false, is_gaze_watched: false }
    }
}

impl Deref for ConfigSnapshot {
    type Target = Config;

    fn deref(&self) -> &Config {
        &self.config
    }
}

#[derive(Debug)]
struct Watched {
    watch: Watch,
    /// The configuration of the file.
    configured: Config,
    asked: AskedView,
    gaze: GazeWatch,
    /// The requested view at the last look.
    view: Option<DebugView>,
    /// The last request that the device was not armed for.
    out_of_reach: Option<Arming>,
}

impl LiveConfig {
    /// Reads the configuration of `application`, the name that it gives to OpenXR. Where the file has an
    /// error, that is logged, and the defaults hold, turned off if the file has `enabled = false`.
    pub fn new(environment: &Environment, application: Option<&str>) -> Self {
        arming::name_application(application);
        let mut watch = Watch::new(environment, application, &executable());
        let (read, source) = match watch.poll() {
            Some(read) => accept(read, &watch),
            None => (Ok(Config::default()), Settings::default()),
        };
        let config = read.unwrap_or_else(|errors| {
            if errors.turns_off() {
                tracing::info!("enabled = false applies, regardless of these errors");
            }
            errors.at_start()
        });
        crate::log::set_level(config.log.level);
        let pid = std::process::id();
        let watched = Watched {
            watch,
            configured: config,
            asked: AskedView::new(environment, pid),
            gaze: GazeWatch::new(environment, pid),
            view: None,
            out_of_reach: None,
        };
        let snapshot =
            ConfigSnapshot { config, source: Arc::new(source), is_view_asked: false, is_gaze_watched: false };
        let shared = Shared {
            current: ArcSwap::from_pointee(snapshot),
            watched: Mutex::new(watched),
            before: Mutex::default(),
            is_edited: AtomicBool::new(false),
        };
        Self { shared: Arc::new(shared), is_watched: AtomicBool::new(false) }
    }

    /// The configuration at this moment.
    pub fn snapshot(&self) -> Arc<ConfigSnapshot> {
        self.shared.current.load_full()
    }

    /// Puts a configuration in the place of the file's.
    #[cfg(test)]
    pub fn set(&self, config: Config) {
        self.shared.current.store(Arc::new(ConfigSnapshot { config, ..ConfigSnapshot::default() }));
    }

    /// Puts a snapshot in the place of the last one.
    #[cfg(test)]
    pub fn set_snapshot(&self, snapshot: ConfigSnapshot) {
        self.shared.current.store(Arc::new(snapshot));
    }

    /// Begins to look for edits, the first time.
    pub fn watch(&self) {
        if self.is_watched.load(Ordering::Relaxed) || self.is_watched.swap(true, Ordering::Relaxed) {
            return;
        }
        let shared = Arc::downgrade(&self.shared);
        let watch = move || loop {
            sleep(LOOK_EVERY);
            let Some(shared) = shared.upgrade() else { break };
            attempt("edits of the configuration", || shared.look(SystemTime::now()));
        };
        if let Err(error) = spawn("parafovea-config", watch) {
            tracing::warn!(
                "edits of the configuration take effect after a restart: cannot start a thread: {error}"
            );
        }
    }

    /// Takes the edits since the last call: the configuration before them, `None` without any. The present one is [`Self::snapshot`].
    pub fn take_edits(&self) -> Option<Arc<ConfigSnapshot>> {
        if !self.shared.is_edited.load(Ordering::Acquire)
            || !self.shared.is_edited.swap(false, Ordering::AcqRel)
        {
            return None;
        }
        self.shared.before().take()
    }
}

impl Shared {
    fn before(&self) -> MutexGuard<'_, Option<Arc<ConfigSnapshot>>> {
        self.before.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a configuration in the place of the present one.
    fn store(&self, snapshot: ConfigSnapshot) {
        let last = self.current.swap(Arc::new(snapshot));
        self.before().get_or_insert(last);
        self.is_edited.store(true, Ordering::Release);
    }

    /// Looks for an edit, and for requests of the command `parafovea`. A file with an error changes nothing but the source.
    fn look(&self, now: SystemTime) {
        let mut watched = self.watched.lock().unwrap_or_else(PoisonError::into_inner);
        let watched = &mut *watched;
        let mut snapshot = ConfigSnapshot::clone(&self.current.load());
        let read = watched.watch.poll().map(|read| accept(read, &watched.watch));
        let is_read = read.is_some();
        let edited = read.and_then(|(config, source)| {
            snapshot.source = Arc::new(source);
            config.ok()
        });
        let view = watched.asked.look();
        let is_gaze_watched = watched.gaze.look(now);
        let is_watch_new = is_gaze_watched != snapshot.is_gaze_watched;
        snapshot.is_gaze_watched = is_gaze_watched;
        if let Some(config) = edited {
            crate::log::set_level(config.log.level);
            tracing::info!(target: EDIT, "configuration changed");
            watched.configured = config;
        } else if view == watched.view {
            // A file with an error.
            if is_read || is_watch_new {
                self.store(snapshot);
            }
            return;
        }
        if view != watched.view {
            match view {
                Some(view) => {
                    tracing::info!("debug.view = \"{}\", requested by parafovea status", view.name())
                }
                None => tracing::info!("debug.view is back to the configured view"),
            }
            watched.view = view;
        }
        snapshot.config = watched.configured;
        snapshot.config.debug.view = view.unwrap_or(watched.configured.debug.view);
        snapshot.is_view_asked = view.is_some();
        let out_of_reach = arming::out_of_reach(&snapshot);
        if out_of_reach != watched.out_of_reach {
            watched.out_of_reach = out_of_reach;
            if let Some(wanted) = out_of_reach {
                tracing::warn!(
                    "the configuration now enables {wanted}, which takes effect after a restart of the application"
                );
            }
        }
        self.store(snapshot);
    }
}

/// The configuration that was read, whose errors are logged, and its source.
fn accept(read: Result<Config, ConfigErrors>, watch: &Watch) -> (Result<Config, ConfigErrors>, Settings) {
    if let Err(errors) = &read {
        for line in errors.lines() {
            tracing::error!("configuration ignored: {line}");
        }
    }
    let file = watch.file().map(|file| file.display().to_string()).unwrap_or_default();
    let source = Settings { file, has_error: read.is_err() };
    (read, source)
}

#[cfg(test)]
mod monotony;
#[cfg(test)]
mod tests;
