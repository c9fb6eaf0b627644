//! The C surface: access to the application's pointers, and the names of functions.

pub(crate) mod pointers;
pub(crate) mod structures;
pub(crate) mod text;
