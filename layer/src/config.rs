//! The configuration that holds at this moment, and noticing that its file changed.

mod arming;
mod chroma;
mod debug_view;
mod plan;

pub use arming::{Arming, device_armed};
pub use chroma::chroma_settings;
pub use debug_view::debug_view;
pub use parafovea_manifest::config::Config;
pub use parafovea_manifest::options::{
    AudioMode, AudioSource, ChromaMatrix, ChromaMode, DebugView, FilePath, GazeSource, LogLevel, PassRules,
    PeripheralRate, Preset, RatesBackend, RatesGate, RatesMode, ReuseMode, ReusePhase, SilenceRule,
};
pub use parafovea_manifest::paths::Environment;
pub use plan::{
    PlannedDevice, gate_modes, gaze_settings, images_for_reuse, longest_period, plan_settings,
    wants_contrast, wants_maps, wants_reuse,
};

use crate::abi::executable;
use arc_swap::ArcSwap;
use parafovea_manifest::config::{ConfigErrors, Watch};
use parafovea_manifest::status::{AskedView, GazeWatch, Settings};
use std::ops::Deref;
use std::sync::{Arc, Mutex, TryLockError};
use std::time::{Duration, Instant, SystemTime};

/// Edits apply within a second: twice as often is looked.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// One application's configuration, kept current by [`LiveConfig::poll`].
#[derive(Debug)]
pub struct LiveConfig {
    current: ArcSwap<ConfigSnapshot>,
    watched: Mutex<Watched>,
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
    looked: Instant,
}

impl LiveConfig {
    /// Reads the configuration of `application`, the name that it gives to OpenXR. Where the file has an
    /// error, that is logged, and the defaults hold.
    pub fn new(environment: &Environment, application: Option<&str>, now: Instant) -> Self {
        arming::name_application(application);
        let mut watch = Watch::new(environment, application, &executable());
        let (config, source) = watch.poll().map(|read| accept(read, &watch)).unwrap_or_default();
        let config = config.unwrap_or_default();
        crate::log::set_level(config.log.level);
        let pid = std::process::id();
        let watched = Watched {
            watch,
            configured: config,
            asked: AskedView::new(environment, pid),
            gaze: GazeWatch::new(environment, pid),
            view: None,
            out_of_reach: None,
            looked: now,
        };
        let snapshot =
            ConfigSnapshot { config, source: Arc::new(source), is_view_asked: false, is_gaze_watched: false };
        Self { current: ArcSwap::from_pointee(snapshot), watched: Mutex::new(watched) }
    }

    /// The configuration at this moment.
    pub fn snapshot(&self) -> Arc<ConfigSnapshot> {
        self.current.load_full()
    }

    /// Puts a configuration in the place of the file's.
    #[cfg(test)]
    pub fn set(&self, config: Config) {
        self.current.store(Arc::new(ConfigSnapshot { config, ..ConfigSnapshot::default() }));
    }

    /// Puts a snapshot in the place of the last one.
    #[cfg(test)]
    pub fn set_snapshot(&self, snapshot: ConfigSnapshot) {
        self.current.store(Arc::new(snapshot));
    }

    /// Looks for an edit, and for requests of the command `parafovea`, if it is time to; returns whether anything changed. A file with an error changes
    /// nothing but the source.
    pub fn poll(&self, now: Instant) -> bool {
        let mut watched = match self.watched.try_lock() {
            Ok(watched) => watched,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return false,
        };
        if now.saturating_duration_since(watched.looked) < LOOK_EVERY {
            return false;
        }
        watched.looked = now;
        let mut snapshot = ConfigSnapshot::clone(&self.current.load());
        let read = watched.watch.poll().map(|read| accept(read, &watched.watch));
        let is_read = read.is_some();
        let edited = read.and_then(|(config, source)| {
            snapshot.source = Arc::new(source);
            config
        });
        let view = watched.asked.look();
        let is_gaze_watched = watched.gaze.look(SystemTime::now());
        let is_watch_new = is_gaze_watched != snapshot.is_gaze_watched;
        snapshot.is_gaze_watched = is_gaze_watched;
        if let Some(config) = edited {
            crate::log::set_level(config.log.level);
            tracing::info!("configuration changed");
            watched.configured = config;
        } else if view == watched.view {
            // A file with an error.
            if is_read || is_watch_new {
                self.current.store(Arc::new(snapshot));
            }
            return is_read || is_watch_new;
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
        self.current.store(Arc::new(snapshot));
        true
    }
}

/// The configuration that was read, unless it has errors, which are logged; and its source.
fn accept(read: Result<Config, ConfigErrors>, watch: &Watch) -> (Option<Config>, Settings) {
    if let Err(errors) = &read {
        for line in errors.lines() {
            tracing::error!("configuration ignored: {line}");
        }
    }
    let file = watch.file().map(|file| file.display().to_string()).unwrap_or_default();
    let source = Settings { file, has_error: read.is_err() };
    (read.ok(), source)
}

#[cfg(test)]
mod monotony;
#[cfg(test)]
mod tests;
