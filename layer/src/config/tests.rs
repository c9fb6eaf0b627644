use super::*;
use parafovea_manifest::status::{Settings, StatusFile, ask_view};
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
    assert_eq!(config.snapshot().gaze.hold_ms, 100);

    std::fs::write(&file, "[gaze]\nhold_ms = 2000\n").unwrap();
    config.poll(start + LOOK_EVERY);
    assert_eq!(config.snapshot().gaze.hold_ms, 100, "out of range: not taken");
    let source = |has_error| Settings { file: file.display().to_string(), has_error };
    assert_eq!(*config.snapshot().source, source(true));

    std::fs::write(&file, "[gaze]\nhold_ms = 20\n").unwrap();
    config.poll(start + LOOK_EVERY + Duration::from_millis(1));
    assert_eq!(config.snapshot().gaze.hold_ms, 100, "too early to look again");
    config.poll(start + LOOK_EVERY * 2);
    assert_eq!(config.snapshot().gaze.hold_ms, 20);
    assert_eq!(*config.snapshot().source, source(false));
}

#[test]
fn without_a_readable_file_the_defaults_hold() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(live(&folder.path().join("none.toml"), Instant::now()).snapshot().config, Config::default());
}

#[test]
fn a_view_that_is_asked_for_stands_in_for_the_files_until_it_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    let environment = Environment::new(false, |name| match name {
        "PARAFOVEA_CONFIG" => Some(file.clone().into()),
        "XDG_RUNTIME_DIR" => Some(folder.path().into()),
        _ => None,
    });
    std::fs::write(&file, "[debug]\nview = \"age\"\n[gaze]\nhold_ms = 100\n").unwrap();
    let mut now = Instant::now();
    let config = LiveConfig::new(&environment, Some("app"), now);
    let pid = std::process::id();
    let _session = StatusFile::new(&environment, pid).unwrap().unwrap();
    let mut holds = |view: DebugView, is_asked: bool, hold_ms: u32| {
        now += LOOK_EVERY;
        config.poll(now);
        let found = config.snapshot();
        assert_eq!((found.debug.view, found.is_view_asked, found.gaze.hold_ms), (view, is_asked, hold_ms));
    };
    holds(DebugView::Age, false, 100);
    ask_view(&environment, pid, Some(DebugView::Gaze)).unwrap();
    holds(DebugView::Gaze, true, 100);
    std::fs::write(&file, "[debug]\nview = \"rates\"\n[gaze]\nhold_ms = 20\n").unwrap();
    holds(DebugView::Gaze, true, 20);
    ask_view(&environment, pid, Some(DebugView::None)).unwrap();
    holds(DebugView::None, true, 20);
    ask_view(&environment, pid, None).unwrap();
    holds(DebugView::Rates, false, 20);
}
