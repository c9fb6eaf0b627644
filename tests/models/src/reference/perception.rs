//! References of `perception`.

pub mod contrast;
pub mod csf;
