//! A test's request to a layer, in an environment variable.

use std::fmt::Display;

/// The variable's value, read by `parse`; `None` if it is not set.
///
/// # Panics
///
/// It cannot be read: the test is wrong.
pub(crate) fn read<T, E: Display>(variable: &str, parse: impl FnOnce(&str) -> Result<T, E>) -> Option<T> {
    let text = std::env::var(variable).ok()?;
    match parse(&text) {
        Ok(value) => Some(value),
        Err(reason) => panic!("{variable}={text}: {reason}"),
    }
}
