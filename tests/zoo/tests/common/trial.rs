//! Trials that are ignored where no device can run their style, and the driver of each style.

use libtest_mimic::{Completion, Failed, Trial};
use parafovea_tests::drivers::Folder;
use parafovea_tests::installation::Driver;
use parafovea_tests::run::Outcome;
use parafovea_trial::{Lack, skip};
use parafovea_zoo::{SKIPPED, Style};
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// A trial that may [`skip`], within `cargo test` too.
pub fn trial(name: impl Into<String>, check: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    Trial::ignorable_test(name, || match catch_unwind(AssertUnwindSafe(check)) {
        Ok(result) => result.map(|()| Completion::Completed),
        Err(payload) => match payload.downcast::<Lack>() {
            Ok(lack) => Ok(Completion::ignored_with(lack)),
            Err(payload) => resume_unwind(payload),
        },
    })
}

/// Skips the running test if the device could not run the style.
pub fn skip_unless_run(outcome: &Outcome) {
    if let Some(lacking) = outcome.output.lines().find_map(|line| line.strip_prefix(SKIPPED)) {
        skip(&Lack::machine(format_args!("a device with {lacking}")));
    }
}

/// The driver for a style: an unpacked lavapipe where the style needs a newer one than the installed, and there is one.
pub fn driver(style: &Style) -> Driver {
    // By the version of Mesa that has them: 26 in sid, which `cargo dev drivers` unpacks, and 25 in the backports of bookworm.
    let newer: [(Folder, &[&CStr]); 2] = [
        (Folder::Sid, &[c"VK_EXT_descriptor_heap"]),
        (Folder::Release, &[c"VK_EXT_descriptor_buffer", c"VK_KHR_maintenance5", c"VK_EXT_shader_object"]),
    ];
    let needs = |names: &[&CStr]| style.needs.extensions.iter().any(|name| names.contains(name));
    let folder = newer.into_iter().find(|(_, names)| needs(names)).map(|(folder, _)| folder);
    folder.filter(|folder| folder.path().is_ok()).map_or(Driver::default(), Driver::UnpackedLavapipe)
}
