//! For tests, in builds with debug assertions alone: panics in every hook of one name.
//!
//! `PARAFOVEA_PANIC` is the name that the hook gives [`super::guard`], with `:after` where the layer below is to have answered
//! before. `reached` injects no fault: the log names each hook at its first call.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{LazyLock, Mutex, PoisonError};

const VARIABLE: &str = "PARAFOVEA_PANIC";

enum Injected {
    Reached(Mutex<Vec<&'static str>>),
    Before(String),
    After(String),
}

static INJECTED: LazyLock<Option<Injected>> = LazyLock::new(|| {
    let value = std::env::var(VARIABLE).ok()?;
    Some(match value.strip_suffix(":after") {
        _ if value == "reached" => Injected::Reached(Mutex::default()),
        Some(call) => Injected::After(call.to_owned()),
        None => Injected::Before(value),
    })
});

/// Known absence of the variable: one load per hook, so that debug builds are about as fast as release builds.
static UNSET: AtomicBool = AtomicBool::new(false);

/// A hook begins.
#[inline]
pub fn before(call: &'static str) {
    if !UNSET.load(Ordering::Relaxed) {
        inject_before(call);
    }
}

/// The layer below answered.
#[inline]
pub fn after(call: &'static str) {
    if !UNSET.load(Ordering::Relaxed) {
        inject_after(call);
    }
}

#[cold]
fn inject_before(call: &'static str) {
    UNSET.store(INJECTED.is_none(), Ordering::Relaxed);
    match &*INJECTED {
        None | Some(Injected::After(_)) => {}
        Some(Injected::Before(injected)) => assert_ne!(injected, call, "planted before the call below"),
        Some(Injected::Reached(reached)) => {
            let mut reached = reached.lock().unwrap_or_else(PoisonError::into_inner);
            if !reached.contains(&call) {
                reached.push(call);
                drop(reached);
                tracing::info!("reached {call}");
            }
        }
    }
}

#[cold]
fn inject_after(call: &'static str) {
    if let Some(Injected::After(injected)) = &*INJECTED {
        assert_ne!(injected, call, "planted after the call below");
    }
}
