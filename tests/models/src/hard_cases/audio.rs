//! Hard cases of `audio`.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
