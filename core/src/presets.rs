//! Settings that people choose by name.
