//! Hard cases of `gaze`.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
