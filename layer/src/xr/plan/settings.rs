//! Settings that follow from the configuration and the gates, and their delivery to the Vulkan half.

use super::SessionPlan;
use crate::config::{Config, PassRules, RatesBackend, changes_costs};
use crate::link::{
    BACKEND_ANY, BACKEND_MASK, BACKEND_NONE, BACKEND_RATE_ATTACHMENT, FrameStart, SettingsRecord,
};
use crate::xr::session::Active;
use parafovea_core::gate::Techniques;
use std::ptr;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

impl SessionPlan {
    /// The configuration was edited: the gates judge techniques again whose costs may be others.
    pub fn config_edited(&self, before: &Config, now: &Config) {
        if changes_costs(before, now) {
            self.benefit().forget_decisions();
        }
    }

    /// Sends the Vulkan half the settings of the configuration and of the gates if they are new.
    pub fn notify_settings(&self, active: &Active, config: &Config) {
        let (techniques, wants_costs) = {
            let mut benefit = self.benefit();
            benefit.set_mode(self.gate_modes(config));
            (benefit.is_on(), benefit.wants_costs())
        };
        let is_running = self.is_running.load(Ordering::Relaxed);
        let techniques = if self.has_failed() || !is_running { Techniques::default() } else { techniques };
        let wanted = VulkanSettings::new(config, techniques, wants_costs && is_running);
        self.planner().set_techniques(wanted.techniques, wants_costs);
        let is_changed = {
            let mut sent_settings = self.sent_settings.lock().unwrap_or_else(PoisonError::into_inner);
            sent_settings.replace(wanted) != Some(wanted)
        };
        if is_changed {
            let passes = wanted.passes.to_string();
            let record = SettingsRecord {
                is_on: u32::from(wanted.is_on()),
                backend: wanted.backend,
                times_frames: u32::from(wanted.times_frames),
                passes: passes.as_ptr(),
                passes_len: passes.len() as u32,
            };
            // SAFETY: the record points to `passes`.
            unsafe {
                active.device.begin_frame(&FrameStart {
                    settings: &record,
                    plan: ptr::null(),
                    awaited: ptr::null(),
                })
            };
        }
    }
}

/// Settings of the Vulkan half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VulkanSettings {
    /// The techniques that the gates allow.
    pub techniques: Techniques<bool>,
    /// Whether frames are timed for the gates.
    pub times_frames: bool,
    backend: u32,
    passes: PassRules,
}

impl VulkanSettings {
    fn new(config: &Config, techniques: Techniques<bool>, times_frames: bool) -> Self {
        let backend = match config.rates.backend {
            RatesBackend::Auto => BACKEND_ANY,
            RatesBackend::Attachment => BACKEND_RATE_ATTACHMENT,
            RatesBackend::Mask => BACKEND_MASK,
            RatesBackend::Off => BACKEND_NONE,
        };
        Self { techniques, times_frames, backend, passes: config.rates.passes }
    }

    /// Whether passes that are recognised get maps.
    fn is_on(&self) -> bool {
        self.techniques.rates || self.techniques.reuse
    }
}
