use super::*;
use parafovea_manifest::status::{Settings, StatusFile, ask_view};
use std::ffi::OsString;
use std::path::Path;
use std::time::Instant;

fn live(file: &Path) -> LiveConfig {
    let environment = Environment::new(false, |name| {
        (name == "PARAFOVEA_CONFIG").then(|| OsString::from(file.as_os_str()))
    });
    LiveConfig::new(&environment, Some("app"))
}

/// Looks twice: an edit counts from the second look on.
fn look(config: &LiveConfig) {
    for _ in 0..2 {
        config.shared.look(SystemTime::now());
    }
}

#[test]
fn an_edit_applies_after_two_looks_and_an_error_keeps_the_configuration() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    std::fs::write(&file, "[gaze]\nhold_ms = 100\n").unwrap();
    let config = live(&file);
    assert_eq!(config.snapshot().gaze.hold_ms, 100);

    std::fs::write(&file, "[gaze]\nhold_ms = 2000\n").unwrap();
    look(&config);
    assert_eq!(config.snapshot().gaze.hold_ms, 100, "out of range: not taken");
    let source = |has_error| Settings { file: file.display().to_string(), has_error };
    assert_eq!(*config.snapshot().source, source(true));

    std::fs::write(&file, "[gaze]\nhold_ms = 20\n").unwrap();
    look(&config);
    assert_eq!(config.snapshot().gaze.hold_ms, 20);
    assert_eq!(*config.snapshot().source, source(false));
    // A frame takes both edits at once.
    assert_eq!(config.take_edits().unwrap().gaze.hold_ms, 100);
    assert!(config.take_edits().is_none());
    look(&config);
    assert!(config.take_edits().is_none(), "nothing new");
}

#[test]
fn without_a_readable_file_the_defaults_hold() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(live(&folder.path().join("none.toml")).snapshot().config, Config::default());
}

#[test]
fn a_file_with_an_error_at_the_start_can_turn_the_layer_off() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    std::fs::write(&file, "enabled = false\nof_a_later_version = 1\n").unwrap();
    let config = live(&file);
    assert_eq!(config.snapshot().config, Config { enabled: false, ..Config::default() });
    assert!(config.snapshot().source.has_error);
    std::fs::write(&file, "of_a_later_version = 1\n").unwrap();
    assert_eq!(live(&file).snapshot().config, Config::default());
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
    let config = LiveConfig::new(&environment, Some("app"));
    let pid = std::process::id();
    let _session = StatusFile::new(&environment, pid).unwrap().unwrap();
    let holds = |view: DebugView, is_asked: bool, hold_ms: u32| {
        look(&config);
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

/// Edits are taken without any call but that for the frame's configuration.
#[test]
fn a_thread_looks_for_edits_until_the_instance_ends() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    let config = live(&file);
    config.watch();
    config.watch();
    std::fs::write(&file, "[gaze]\nhold_ms = 20\n").unwrap();
    let begun = Instant::now();
    while config.take_edits().is_none() {
        assert!(begun.elapsed() < Duration::from_secs(20));
        sleep(Duration::from_millis(10));
    }
    assert_eq!(config.snapshot().gaze.hold_ms, 20);
    let shared = Arc::downgrade(&config.shared);
    drop(config);
    while shared.strong_count() > 0 {
        assert!(begun.elapsed() < Duration::from_secs(40));
        sleep(Duration::from_millis(10));
    }
}
