//! Hard cases of `avpm`.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
