//! Variables for tests alone: builds for users must not know them, because they reveal gaze and sound, or break calls.

/// Names that only builds with debug assertions know.
pub const TEST_NAMES: [&str; 3] = ["PARAFOVEA_PASSES_FILE", "PARAFOVEA_FEATURES_FILE", "PARAFOVEA_PANIC"];

/// The names of [`TEST_NAMES`] that occur in a program or library.
pub fn test_names(binary: &[u8]) -> Vec<&'static str> {
    let contains = |name: &str| binary.windows(name.len()).any(|window| window == name.as_bytes());
    TEST_NAMES.into_iter().filter(|name| contains(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::test_names;

    #[test]
    fn a_name_is_found_anywhere() {
        assert_eq!(test_names(b"\x7fELF...PARAFOVEA_FEATURES_FILE"), ["PARAFOVEA_FEATURES_FILE"]);
        assert_eq!(test_names(b"PARAFOVEA_CONFIG PARAFOVEA_HEARD"), [""; 0]);
    }
}
