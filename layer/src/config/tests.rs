use super::*;
use std::ffi::OsString;
use std::path::Path;

fn live(file: &Path, now: Instant) -> LiveConfig {
    let environment = Environment::new(false, |name| {
        (name == "PARAFOVEA_CONFIG").then(|| OsString::from(file.as_os_str()))
    });
    LiveConfig::new(&environment, Some("app"), now)
}

#[test]
fn an_edit_applies_after_half_a_second_and_an_error_keeps_what_held() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    let start = Instant::now();
    std::fs::write(&file, "[gaze]\nhold_ms = 100\n").unwrap();
    let config = live(&file, start);
    assert_eq!(config.get().gaze.hold_ms, 100);

    std::fs::write(&file, "[gaze]\nhold_ms = 2000\n").unwrap();
    config.poll(start + LOOK_EVERY);
    assert_eq!(config.get().gaze.hold_ms, 100, "out of range: not taken");

    std::fs::write(&file, "[gaze]\nhold_ms = 20\n").unwrap();
    config.poll(start + LOOK_EVERY + Duration::from_millis(1));
    assert_eq!(config.get().gaze.hold_ms, 100, "too early to look again");
    config.poll(start + LOOK_EVERY * 2);
    assert_eq!(config.get().gaze.hold_ms, 20);
}

#[test]
fn without_a_readable_file_the_defaults_hold() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(live(&folder.path().join("none.toml"), Instant::now()).get(), Config::default());
}
