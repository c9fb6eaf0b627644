//! A short share of `cargo dev soak churn`.

use parafovea_tests::churn::{Backend, churn};
use parafovea_tests::run::complaints;
use std::time::Duration;

/// Sessions go on for so long, and each to its end.
const TIME: Duration = Duration::from_secs(8);

/// If only the device of the application is left, the layer has only its kernels and the resources shared by all sessions.
fn leaves_nothing(backend: Backend) {
    let churn = churn(backend, TIME, 1, None).unwrap();
    assert!(!churn.on.is_empty() && !churn.off.is_empty());
    for rest in &churn.on {
        let has = |kind: &str| rest.own.objects.get(kind).copied().unwrap_or(0);
        // Of rate images, the one that stands in for all.
        assert!(has("image") <= 1 && has("image view") <= 1, "{rest:?}");
        assert_eq!([has("framebuffer"), has("descriptor pool"), has("query pool")], [0; 3], "{rest:?}");
        // Staging memory and tables of kernels.
        assert!(has("buffer") <= 8 && has("memory") <= 12, "{rest:?}");
        assert!(rest.own.memory <= 4 << 20, "{rest:?}");
    }
    assert!(
        churn.on.iter().any(|rest| rest.own.most_memory > rest.own.memory),
        "nothing was done: {:?}",
        churn.on
    );
    assert!(complaints(&churn.log).is_empty(), "{}", churn.log);
}

#[test]
fn nothing_of_masks_is_left() {
    leaves_nothing(Backend::Mask);
}

#[test]
fn nothing_of_rate_attachments_is_left() {
    leaves_nothing(Backend::Attachment);
}
