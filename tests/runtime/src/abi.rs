//! The C surface: what pointers of the application may be used for, and which function has which name.

pub(crate) mod pointers;
pub(crate) mod structures;
pub(crate) mod text;
