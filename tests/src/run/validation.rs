//! The validation layers below ours: their settings, and their findings.

use crate::HarnessError;
use crate::installation::write;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const OPENXR_LAYER: &str = "XR_APILAYER_LUNARG_core_validation";
const VULKAN_LOG: &str = "vulkan_validation.txt";
const OPENXR_LOG: &str = "openxr_validation.txt";

/// The patch number N of the Vulkan headers (1.3.N, 1.4.N, counted on) of the first validation layer in one of these folders; None
/// where there is none.
pub(super) fn headers(folders: &[PathBuf]) -> Option<u32> {
    let manifest = folders.iter().find_map(|folder| {
        let path = folder.join("vulkan/explicit_layer.d/VkLayer_khronos_validation.json");
        serde_json::from_str::<serde_json::Value>(&std::fs::read_to_string(path).ok()?).ok()
    })?;
    manifest["layer"]["api_version"].as_str()?.rsplit('.').next()?.parse().ok()
}

/// One finding of a validation layer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Message {
    /// The rule, such as `VUID-vkQueueSubmit-pCommandBuffers-00070` or `SYNC-HAZARD-WRITE-AFTER-READ`.
    pub rule: String,
    /// The finding, in the layer's words.
    pub text: String,
}

impl Message {
    /// Whether it is about the layer that stands in for shading rates, which copies each map before its pass, and leaves it in a layout
    /// for everything: a warning.
    pub fn is_of_stand_in(&self) -> bool {
        self.text.contains("vkCmdCopyImageToBuffer: For optimal performance")
    }

    /// Whether it reports a race of two submits to one queue. Up to 1.3.239 at least, validation takes the accesses of a submit that another
    /// queue waited for as that queue's, and compares the first queue's next submit with them. Missing barriers within a queue have other rules.
    fn is_race_with_itself(&self) -> bool {
        let handle = |before: &str| {
            let (_, rest) = self.text.split_once(before)?;
            rest.split([',', '[']).next()
        };
        let queue = handle("Object 0: handle = ");
        self.rule.contains("RACING") && queue.is_some() && queue == handle("queue: VkQueue ")
    }
}

/// The variables that switch both layers on, logging into `folder`.
pub(super) fn environment(folder: &Path) -> Result<Vec<(&'static str, OsString)>, HarnessError> {
    let settings = folder.join("vk_layer_settings.txt");
    write(&settings, &parafovea_test_layers::validation::settings(&folder.join(VULKAN_LOG)))?;
    Ok(vec![
        ("VK_LAYER_SETTINGS_PATH", settings.into_os_string()),
        ("XR_ENABLE_API_LAYERS", OPENXR_LAYER.into()),
        ("XR_CORE_VALIDATION_EXPORT_TYPE", "text".into()),
        ("XR_CORE_VALIDATION_FILE_NAME", folder.join(OPENXR_LOG).into_os_string()),
    ])
}

/// Output of the validation layers during one run.
#[derive(Clone, Default, Debug)]
pub struct Findings {
    /// Of the Vulkan layer.
    pub vulkan: Vec<Message>,
    /// Of the OpenXR layer.
    pub openxr: Vec<Message>,
    /// Whether the Vulkan layer was active: it then reports this itself.
    pub vulkan_was_active: bool,
    /// Whether the OpenXR layer was active: it prints this to standard error.
    pub openxr_was_active: bool,
}

impl Findings {
    /// Reads the files in `folder`, and the application's output; empty without validation.
    pub(super) fn read(folder: &Path, output: &str) -> Self {
        let text = |name| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        let (vulkan, openxr) = (text(VULKAN_LOG), text(OPENXR_LOG));
        Self {
            vulkan_was_active: STARTS.iter().any(|start| vulkan.contains(start)),
            openxr_was_active: output.contains("Core Validation output type"),
            vulkan: vulkan_messages(&vulkan, output.lines().any(is_of_late_hello_xr)),
            openxr: openxr.lines().filter_map(openxr_message).collect(),
        }
    }

    /// Findings that `baseline` has not got, compared by rule: texts name handles, which differ in every run.
    pub fn beyond(&self, baseline: &Findings) -> Vec<&Message> {
        let count =
            |messages: &[Message], rule: &str| messages.iter().filter(|other| other.rule == rule).count();
        let is_new = |own: &[Message], old: &[Message], message: &Message| {
            count(own, &message.rule) > count(old, &message.rule)
        };
        let vulkan = self.vulkan.iter().filter(|message| is_new(&self.vulkan, &baseline.vulkan, message));
        vulkan
            .chain(self.openxr.iter().filter(|message| is_new(&self.openxr, &baseline.openxr, message)))
            .collect()
    }
}

/// Whether hello_xr prints this line only because a device is behind: it waits a second for its command buffer, and records into it all
/// the same. Drivers that compile on a busy machine take longer.
pub fn is_of_late_hello_xr(line: &str) -> bool {
    ["CmdBuffer fence timed out", "Expecting state CmdBufferState"].iter().any(|text| line.contains(text))
}

/// End of the rules that a late hello_xr breaks by itself.
const BROKEN_LATE: &str = "-commandBuffer-recording";

/// Words of the Vulkan layer's first message: up to headers 1.3.2xx, and later.
const STARTS: [&str; 2] = ["Khronos Validation Layer Active", "CURRENT-VALIDATION-ENABLED"];

/// `..Validation Error: [ RULE ] Object 0: .. | MessageID = .. | text`, in later versions with the text in the next line;
/// information is not a finding, and neither are mistakes of an application that `is_late`.
fn vulkan_messages(log: &str, is_late: bool) -> Vec<Message> {
    let severities = ["Validation Error: [ ", "Validation Warning: [ ", "Validation Performance Warning: [ "];
    let mut lines = log.lines().peekable();
    let mut messages = Vec::new();
    while let Some(line) = lines.next() {
        let rest = severities.iter().find_map(|severity| line.split_once(severity));
        let Some((rule, text)) = rest.and_then(|(_, rest)| rest.split_once(" ]")) else { continue };
        let is_head = text.rsplit_once("MessageID = ").is_some_and(|(_, id)| !id.contains('|'));
        let text = lines.peek().filter(|_| is_head).map_or(text, |next| next);
        messages.push(Message { rule: rule.to_owned(), text: text.to_owned() });
    }
    // Settings name the switches of several versions, and newer ones say so.
    messages.retain(|message| message.rule != "VALIDATION-SETTINGS" && !message.is_race_with_itself());
    messages.retain(|message| !is_late || !message.rule.ends_with(BROKEN_LATE));
    messages
}

/// `[VALID_ERROR | RULE | function]: text`.
fn openxr_message(line: &str) -> Option<Message> {
    let rest =
        ["[VALID_ERROR | ", "[VALID_WARNING | "].iter().find_map(|severity| line.strip_prefix(severity))?;
    let (rule, text) = rest.split_once(" | ")?;
    Some(Message { rule: rule.to_owned(), text: text.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const VULKAN: &str = "UNASSIGNED-status(INFO / SPEC): msgNum: 1 - Validation Information: [ UNASSIGNED-status ] \
        Object 0: x; | MessageID = 0x1 | Khronos Validation Layer Active:\n\
        SYNC-HAZARD-WRITE-AFTER-WRITE(ERROR / SPEC): msgNum: 1 - Validation Error: [ SYNC-HAZARD-WRITE-AFTER-WRITE ] \
        Object 0: handle = 0x1 | MessageID = 0x1 | vkQueueSubmit(): hazard\n    Objects: 1\n";

    #[test]
    fn findings_are_errors_and_warnings_only() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(VULKAN_LOG), VULKAN).unwrap();
        let openxr = "[VALID_INFO | a | b]: c\n[VALID_ERROR | VUID-xrEndFrame-x | xrEndFrame]: wrong\n";
        std::fs::write(folder.path().join(OPENXR_LOG), openxr).unwrap();
        let findings = Findings::read(folder.path(), "Core Validation output type: text, first time = true");
        assert!(findings.vulkan_was_active && findings.openxr_was_active);
        assert_eq!(findings.vulkan.len(), 1);
        assert_eq!(findings.vulkan[0].rule, "SYNC-HAZARD-WRITE-AFTER-WRITE");
        assert_eq!(findings.openxr[0].rule, "VUID-xrEndFrame-x");
        assert_eq!(findings.beyond(&Findings::default()).len(), 2);
        assert!(findings.beyond(&findings).is_empty());
    }

    #[test]
    fn newer_validation_has_the_text_in_the_next_line() {
        let folder = tempfile::tempdir().unwrap();
        let log = "Validation Information: [ CURRENT-VALIDATION-ENABLED ] | MessageID = 0xfd7b2292\n\
            vkCreateInstance(): Current Validation Enabled:\n\n\
            Validation Error: [ VUID-vkCmdDraw-None-1 ] | MessageID = 0x1\nvkCmdDraw(): no pipeline.\nObjects: 1\n";
        std::fs::write(folder.path().join(VULKAN_LOG), log).unwrap();
        let findings = Findings::read(folder.path(), "");
        assert!(findings.vulkan_was_active);
        let message = Message {
            rule: "VUID-vkCmdDraw-None-1".to_owned(),
            text: "vkCmdDraw(): no pipeline.".to_owned(),
        };
        assert_eq!(findings.vulkan, [message]);
    }

    #[test]
    fn hello_xr_on_a_device_that_is_behind_breaks_rules_by_itself() {
        let folder = tempfile::tempdir().unwrap();
        let message = |rule| format!("Validation Error: [ {rule} ] Object 0: x; | MessageID = 0x1 | wrong\n");
        let rules = ["VUID-vkCmdDraw-commandBuffer-recording", "VUID-vkCmdDraw-None-1"];
        std::fs::write(folder.path().join(VULKAN_LOG), rules.map(message).concat()).unwrap();
        let found = |output| {
            let findings = Findings::read(folder.path(), output);
            findings.vulkan.into_iter().map(|message| message.rule).collect::<Vec<_>>()
        };
        let late =
            "[16:05:25.000][Error  ] Expecting state CmdBufferState::Initialized from Begin, in Executing";
        assert_eq!(found(late), rules[1..]);
        assert_eq!(found("[16:05:25.000][Info   ] Press any key to shutdown..."), rules);
    }

    #[test]
    fn a_queue_does_not_race_with_itself() {
        let message = |prior: &str| Message {
            rule: "SYNC-HAZARD-WRITE-RACING-WRITE".to_owned(),
            text: format!(
                " Object 0: handle = 0x1a, type = VK_OBJECT_TYPE_QUEUE; | Hazard (queue: VkQueue {prior}[], submit: 1)"
            ),
        };
        assert!(message("0x1a").is_race_with_itself());
        assert!(!message("0x2b").is_race_with_itself());
    }

    #[test]
    fn headers_are_counted_on_from_one_minor_version_to_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let folders = [folder.path().to_owned()];
        assert_eq!(headers(&folders), None);
        for (version, patch) in [("1.3.239", 239), ("1.4.363", 363)] {
            let path = folder.path().join("vulkan/explicit_layer.d/VkLayer_khronos_validation.json");
            write(&path, &format!("{{\"layer\":{{\"api_version\":\"{version}\"}}}}")).unwrap();
            assert_eq!(headers(&folders), Some(patch));
        }
    }

    #[test]
    fn more_of_the_same_rule_is_beyond_the_baseline() {
        let message = |text: &str| Message { rule: "R".to_owned(), text: text.to_owned() };
        let one = Findings { vulkan: vec![message("a")], ..Findings::default() };
        let two = Findings { vulkan: vec![message("b"), message("c")], ..Findings::default() };
        assert_eq!(two.beyond(&one).len(), 2);
        assert!(one.beyond(&two).is_empty());
    }
}
