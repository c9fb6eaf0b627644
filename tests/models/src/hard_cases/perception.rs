//! Hard cases of `perception`.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
