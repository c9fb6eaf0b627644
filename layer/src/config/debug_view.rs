//! The debug view: drawings over the eye images.

use super::Config;
use parafovea_core::kernels::debug_view::DebugView;
use parafovea_manifest::options::DebugView as Chosen;

/// The configured debug view; `None` without one.
pub fn debug_view(config: &Config) -> Option<DebugView> {
    match config.debug.view {
        _ if !config.enabled => None,
        Chosen::None => None,
        Chosen::Rates => Some(DebugView::Rates),
        Chosen::Eccentricity => Some(DebugView::Eccentricity),
        Chosen::Age => Some(DebugView::Age),
        Chosen::Gaze => Some(DebugView::Gaze),
        Chosen::Ahead => Some(DebugView::Ahead),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_drawn_unless_asked_for() {
        let mut config = Config::default();
        assert_eq!(debug_view(&config), None);
        config.debug.view = Chosen::Gaze;
        assert_eq!(debug_view(&config), Some(DebugView::Gaze));
        config.enabled = false;
        assert_eq!(debug_view(&config), None);
    }
}
