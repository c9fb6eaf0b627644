//! Hard cases of `chroma`.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
