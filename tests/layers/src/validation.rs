//! Settings of the Khronos validation layer for all checks, including those across submits.

use std::path::Path;

/// Its name, as in `VK_INSTANCE_LAYERS`.
pub const VALIDATION_LAYER: &str = "VK_LAYER_KHRONOS_validation";

/// Content of `vk_layer_settings.txt`, in the folder or the file that `VK_LAYER_SETTINGS_PATH` names: log every error, warning and the
/// layer's own start to `log`, and validate synchronization within *and across* submits.
///
/// Validation across submits is a switch of its own, off by default in 1.3.239: without it a hazard between
/// two submits is not reported (`tests/validation.rs` shows both). Later versions renamed the switches;
/// each version ignores the names of the others.
pub fn settings(log: &Path) -> String {
    format!(
        "khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG\n\
         khronos_validation.report_flags = error,warn,perf,info\n\
         khronos_validation.log_filename = {}\n\
         khronos_validation.enable_message_limit = false\n\
         khronos_validation.enables = {SYNCHRONIZATION},{ACROSS_SUBMITS}\n\
         khronos_validation.validate_sync = true\n\
         khronos_validation.syncval_submit_time_validation = true\n",
        log.display()
    )
}

/// Synchronization validation within a command buffer.
pub const SYNCHRONIZATION: &str = "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT";

/// Its extension across submits, in versions up to 1.3.27x.
pub const ACROSS_SUBMITS: &str = "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT";

/// The same two switches as variables, for a program that is started without a settings file; the layer
/// then logs errors to the standard output. On Linux `VK_LAYER_ENABLES` is separated by colons.
pub fn environment() -> [(&'static str, String); 1] {
    [("VK_LAYER_ENABLES", format!("{SYNCHRONIZATION}:{ACROSS_SUBMITS}"))]
}
