//! For tests, in builds with debug assertions alone: panics in every hook of one name.
//!
//! `PARAFOVEA_PANIC` is the name that the hook gives [`super::guard`], with `:after` where the layer below is to have answered
//! before. `reached` plants none: the log then names each hook once, as it is reached.

use std::sync::{LazyLock, Mutex, PoisonError};

const VARIABLE: &str = "PARAFOVEA_PANIC";

enum Planted {
    Reached(Mutex<Vec<&'static str>>),
    Before(String),
    After(String),
}

static PLANTED: LazyLock<Option<Planted>> = LazyLock::new(|| {
    let value = std::env::var(VARIABLE).ok()?;
    Some(match value.strip_suffix(":after") {
        _ if value == "reached" => Planted::Reached(Mutex::default()),
        Some(call) => Planted::After(call.to_owned()),
        None => Planted::Before(value),
    })
});

/// A hook begins.
pub fn before(call: &'static str) {
    match &*PLANTED {
        None | Some(Planted::After(_)) => {}
        Some(Planted::Before(planted)) => assert_ne!(planted, call, "planted before the call below"),
        Some(Planted::Reached(reached)) => {
            let mut reached = reached.lock().unwrap_or_else(PoisonError::into_inner);
            if !reached.contains(&call) {
                reached.push(call);
                drop(reached);
                tracing::info!("reached {call}");
            }
        }
    }
}

/// The layer below answered.
pub fn after(call: &'static str) {
    if let Some(Planted::After(planted)) = &*PLANTED {
        assert_ne!(planted, call, "planted after the call below");
    }
}
