//! References of `perception`.

pub mod csf;
