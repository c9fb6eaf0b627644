//! Edits of the configuration that ask for more than the running session can give.

use crate::config::{Config, chroma_settings, longest_period, wants_reuse};
use crate::xr::session::Session;
use crate::xr::swapchain;

/// Logs the parts of an edited configuration that only new swapchains or a restart of the application can give.
pub fn report(session: &Session, before: &Config) {
    if session.active.is_none() {
        return;
    }
    let now = session.instance.config.snapshot();
    let is_new = |wants: fn(&Config) -> bool| wants(&now) && !wants(before);
    let attenuates = |config: &Config| chroma_settings(config).is_some();
    let needs = match () {
        () if is_new(wants_reuse) => !swapchain::keep_for(session.handle, longest_period(&now)),
        () if is_new(attenuates) => swapchain::are_all_real(session.handle),
        () => false,
    };
    if needs {
        tracing::warn!(
            "the configuration now enables re-use or chroma attenuation, which takes effect in swapchains that the application \
             creates from now on: mostly after a restart"
        );
    }
    let follows = |config: &Config| session.actions.is_tracker_left_out(config);
    if follows(&now) && !follows(before) {
        tracing::warn!(
            "the configuration now follows the runtime's eye tracker, which takes effect after a restart of the application"
        );
    }
}
