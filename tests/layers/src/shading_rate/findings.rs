//! Violations of the specification, written once each.

use super::lines::{SHADING_RATE_FILE_VARIABLE, ShadingRateFinding, ShadingRateLine};
use crate::report;
use ash::vk;
use std::collections::HashSet;

/// The findings of a device.
#[derive(Default)]
pub(super) struct Findings {
    written: HashSet<(String, String, String)>,
}

impl Findings {
    /// Writes a finding unless `holds`.
    pub fn require(
        &mut self,
        holds: bool,
        kind: &str,
        rule: &str,
        object: impl vk::Handle,
        message: impl FnOnce() -> String,
    ) {
        if holds {
            return;
        }
        let (object, message) = (name(object), message());
        if self.written.insert((rule.to_owned(), object.clone(), message.clone())) {
            let finding =
                ShadingRateFinding { kind: kind.to_owned(), rule: rule.to_owned(), message, object };
            report::append(SHADING_RATE_FILE_VARIABLE, &ShadingRateLine::Finding(finding));
        }
    }
}

/// A handle's kind and number.
pub(super) fn name<H: vk::Handle>(handle: H) -> String {
    format!("{:?} {:#x}", H::TYPE, handle.as_raw())
}
