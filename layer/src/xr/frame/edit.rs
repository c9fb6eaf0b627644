//! Edits of the configuration that ask for more than the running session can give.

use crate::xr::session::Session;
use crate::xr::swapchain;

/// Logs the parts of an edited configuration that only new swapchains or a restart of the application can give.
pub fn report(session: &Session) {
    let config = session.instance.config.snapshot();
    if session.active.is_none() {
        return;
    }
    if session.may_have_work(&config) && swapchain::are_all_real(session.handle) {
        tracing::warn!(
            "the configuration now enables re-use, chroma attenuation or a debug view, which takes effect in swapchains that the \
             application creates from now on: mostly after a restart"
        );
    }
    if session.actions.is_tracker_left_out(&config) {
        tracing::warn!(
            "the configuration now follows the runtime's eye tracker, which takes effect after a restart of the application"
        );
    }
}
