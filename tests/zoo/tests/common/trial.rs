//! Trials that are ignored where no device can run their style, and the driver of each style.

use libtest_mimic::{Completion, Failed, Trial};
use parafovea_tests::drivers::Folder;
use parafovea_tests::installation::Driver;
use parafovea_tests::run::Outcome;
use parafovea_trial::{Lack, skip};
use parafovea_zoo::{SKIPPED, Style};
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

/// The driver for a style: the newest lavapipe where the style needs that, and `cargo dev drivers` has unpacked it.
pub fn driver(style: &Style) -> Driver {
    // Since Mesa 26.
    let needs_newest = style.needs.extensions.contains(&c"VK_EXT_descriptor_heap");
    match needs_newest && Folder::Sid.path().is_ok() {
        true => Driver::NewestLavapipe,
        false => Driver::default(),
    }
}
