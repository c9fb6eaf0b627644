//! Hard cases of `perception`.

mod contrast;
mod csf;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    [csf::cases(), contrast::cases()].concat()
}
