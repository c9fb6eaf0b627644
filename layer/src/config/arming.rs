//! The configuration's demands on a new Vulkan device.

use super::{Config, Environment, RatesBackend, wants_maps};
use crate::abi::executable;
use parafovea_manifest::config::Watch;
use parafovea_manifest::options::{ChromaMode, DebugView, FilePath};
use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

/// The Vulkan half's abilities on a device. They are decided at vkCreateDevice: a device gets its extensions
/// there, and passes and pipelines are amended from then on or never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Arming {
    /// Nothing: every call passes through.
    Inert,
    /// Work on finished pictures and following the gaze; passes stay as the application makes them.
    Pictures,
    /// Also passes with masks, on every device.
    Masks,
    /// Also passes with rate attachments, and with masks on a device without them.
    Rates,
}

impl Arming {
    /// The demands of a configuration.
    pub fn of(config: &Config) -> Self {
        let has_pictures = config.chroma.mode != ChromaMode::Off
            || config.debug.view != DebugView::None
            || config.gaze.record != FilePath::NONE;
        match config.rates.backend {
            RatesBackend::Mask if wants_maps(config) => Self::Masks,
            _ if wants_maps(config) => Self::Rates,
            _ if config.enabled && has_pictures => Self::Pictures,
            _ => Self::Inert,
        }
    }

    /// The arming of that number; `None` if there is none.
    pub fn from_number(number: u32) -> Option<Self> {
        [Self::Inert, Self::Pictures, Self::Masks, Self::Rates]
            .into_iter()
            .find(|arming| *arming as u32 == number)
    }

    /// Whether a device that was armed for this has all abilities of `wanted`.
    pub fn covers(self, wanted: Self) -> bool {
        match wanted {
            Self::Inert => true,
            Self::Pictures => self != Self::Inert,
            Self::Masks | Self::Rates => self == wanted,
        }
    }
}

/// All demands of a configuration on a new device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demands {
    /// The abilities.
    pub arming: Arming,
    /// `rates.coarse_stores`.
    pub coarse_stores: bool,
}

impl Demands {
    /// Of a device that stays as the application makes it.
    pub const NOTHING: Self = Self { arming: Arming::Inert, coarse_stores: false };

    /// The demands of this process's configuration at this moment. A file with an error asks for the defaults, or for nothing if it has
    /// `enabled = false`; the OpenXR half logs the error.
    pub fn of_process(environment: &Environment) -> Self {
        let application = application().clone();
        let read = Watch::new(environment, application.as_deref(), &executable()).poll();
        let read = read.unwrap_or_else(|| Ok(Config::default()));
        let config = read.unwrap_or_else(|errors| errors.at_start());
        Self { arming: Arming::of(&config), coarse_stores: config.rates.coarse_stores }
    }
}

impl fmt::Display for Arming {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Inert => "nothing",
            Self::Pictures => "re-use, chroma attenuation or debug views",
            Self::Masks => "masks",
            Self::Rates => "shading rates",
        })
    }
}

/// The name that the application gave to OpenXR last, which may choose its configuration. Vulkan applications give
/// another name, or none.
static APPLICATION: Mutex<Option<String>> = Mutex::new(None);

fn application() -> std::sync::MutexGuard<'static, Option<String>> {
    APPLICATION.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the name that the application gives to OpenXR.
pub(super) fn name_application(name: Option<&str>) {
    *application() = name.map(str::to_owned);
}

/// [`Arming`] of the newest device as a number, or [`NO_DEVICE`].
static NEWEST: AtomicU8 = AtomicU8::new(NO_DEVICE);

const NO_DEVICE: u8 = u8::MAX;

/// Keeps the arming of this process's newest device. The OpenXR half, which may be another copy of this library, learns it when a session begins.
pub fn device_armed(arming: Arming) {
    NEWEST.store(arming as u8, Ordering::Relaxed);
}

/// Demands of an edited configuration that the device was not armed for; `None` without such demands, or without a known device.
pub(super) fn out_of_reach(config: &Config) -> Option<Arming> {
    let newest = NEWEST.load(Ordering::Relaxed);
    let armed = Arming::from_number(newest.into())?;
    let wanted = Arming::of(config);
    (!armed.covers(wanted)).then_some(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Preset, RatesMode, ReuseMode};

    #[test]
    fn a_configuration_without_work_leaves_devices_inert() {
        let mut config = Config::of_preset(Preset::None);
        assert_eq!(Arming::of(&config), Arming::Inert);
        config.chroma.mode = ChromaMode::Default;
        assert_eq!(Arming::of(&config), Arming::Pictures);
        config.reuse.mode = ReuseMode::On;
        assert_eq!(Arming::of(&config), Arming::Rates);
        config.rates.backend = RatesBackend::Mask;
        assert_eq!(Arming::of(&config), Arming::Masks);
        config.rates.backend = RatesBackend::Off;
        assert_eq!(Arming::of(&config), Arming::Pictures);
        config.enabled = false;
        assert_eq!(Arming::of(&config), Arming::Inert);
        let mut viewed = Config::of_preset(Preset::None);
        viewed.debug.view = DebugView::Gaze;
        assert_eq!(Arming::of(&viewed), Arming::Pictures);
        assert_eq!(Arming::of(&Config::default()), Arming::Rates);
        let mut without = Config { enabled: false, ..Config::default() };
        without.rates.mode = RatesMode::Fixed;
        assert_eq!(Arming::of(&without), Arming::Inert);
    }

    /// A game stays turned off if its file has the key of a later version.
    #[test]
    fn a_file_with_an_error_can_turn_devices_off() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("config.toml");
        let environment =
            Environment::new(false, |name| (name == "PARAFOVEA_CONFIG").then(|| file.clone().into()));
        let default = Demands { arming: Arming::of(&Config::default()), coarse_stores: false };
        for (text, demands) in [
            ("enabled = false\nof_a_later_version = 1\n", Demands::NOTHING),
            ("of_a_later_version = 1\n", default),
            ("rates.coarse_stores = true\n", Demands { coarse_stores: true, ..default }),
        ] {
            std::fs::write(&file, text).unwrap();
            assert_eq!(Demands::of_process(&environment), demands, "{text}");
        }
    }

    #[test]
    fn an_arming_survives_the_link() {
        for arming in [Arming::Inert, Arming::Pictures, Arming::Masks, Arming::Rates] {
            assert_eq!(Arming::from_number(arming as u32), Some(arming));
        }
        assert_eq!(Arming::from_number(NO_DEVICE.into()), None);
    }

    #[test]
    fn a_device_covers_what_it_was_armed_for_and_less() {
        use Arming::{Inert, Masks, Pictures, Rates};
        let covered = |armed: Arming| [Inert, Pictures, Masks, Rates].map(|wanted| armed.covers(wanted));
        assert_eq!(covered(Inert), [true, false, false, false]);
        assert_eq!(covered(Pictures), [true, true, false, false]);
        assert_eq!(covered(Masks), [true, true, true, false]);
        assert_eq!(covered(Rates), [true, true, false, true]);
    }
}
