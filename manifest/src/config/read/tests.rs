use super::super::{Config, load};
use super::*;
use proptest::prelude::*;
use std::fs;
use std::os::unix::net::UnixListener;
use std::process::Command;
use tempfile::TempDir;

/// The one line that loading the file gives, without the folder that it is in.
fn line(folder: &TempDir, name: &str) -> String {
    let message = load(&folder.path().join(name)).unwrap_err().to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    message.strip_prefix(&format!("{}/", folder.path().display())).unwrap().to_owned()
}

#[test]
fn a_file_that_is_none_is_told_in_one_line_and_nothing_hangs() {
    let folder = TempDir::new().unwrap();
    let path = |name| folder.path().join(name);
    assert_eq!(line(&folder, "missing"), "missing: cannot be read: No such file or directory (os error 2)");
    fs::create_dir(path("folder")).unwrap();
    assert_eq!(line(&folder, "folder"), "folder: is not a regular file");
    assert!(Command::new("mkfifo").arg(path("fifo")).status().unwrap().success());
    assert_eq!(line(&folder, "fifo"), "fifo: is not a regular file");
    let _listener = UnixListener::bind(path("socket")).unwrap();
    assert!(line(&folder, "socket").starts_with("socket: cannot be read: "));
    assert_eq!(load(Path::new("/dev/zero")).unwrap_err().to_string(), "/dev/zero: is not a regular file");
}

#[test]
fn a_file_that_may_not_be_read_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("secret.toml");
    fs::write(&path, "enabled = false").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(&path).is_ok() {
        // Root reads it all the same, and then so do we.
        assert!(!load(&path).unwrap().enabled);
    } else {
        assert_eq!(
            line(&folder, "secret.toml"),
            "secret.toml: cannot be read: Permission denied (os error 13)"
        );
    }
}

#[test]
fn a_large_file_is_not_read() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("large.toml");
    fs::write(&path, vec![b'#'; 10 << 20]).unwrap();
    assert_eq!(line(&folder, "large.toml"), "large.toml: is larger than the limit of 1048576 bytes");
    fs::write(&path, vec![b'#'; MAX_BYTES as usize + 1]).unwrap();
    assert_eq!(line(&folder, "large.toml"), "large.toml: is larger than the limit of 1048576 bytes");
    fs::write(&path, vec![b'#'; MAX_BYTES as usize]).unwrap();
    assert_eq!(load(&path).unwrap(), Config::default());
}

#[test]
fn invalid_utf_8_is_reported_with_its_line() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("latin1.toml"), b"# ok\n# \xe9\n").unwrap();
    assert_eq!(line(&folder, "latin1.toml"), "latin1.toml: line 2: not UTF-8 text");
}

/// The off switch works whatever else is wrong, as with errors of TOML.
#[test]
fn a_file_that_is_not_utf_8_can_turn_the_layer_off() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("latin1.toml");
    for (bytes, is_off) in [
        (&b"# f\xfcr dieses Spiel\nenabled = false\n"[..], true),
        (b"enabled = false # f\xfcr dieses Spiel\n", true),
        (b"# enabled = false f\xfcr dieses Spiel\n", false),
        (b"[log]\nenabled = false\n# \xfc\n", false),
    ] {
        fs::write(&path, bytes).unwrap();
        let errors = load(&path).unwrap_err();
        assert_eq!(errors.turns_off(), is_off, "{}", bytes.escape_ascii());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_bytes_give_a_configuration_or_lines_that_name_the_file(bytes in any::<Vec<u8>>()) {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("any.toml");
        fs::write(&path, bytes).unwrap();
        if let Err(errors) = load(&path) {
            for line in errors.lines() {
                prop_assert!(line.contains("/any.toml: line "), "{line}");
                prop_assert!(!line.contains(char::is_control), "{line}");
            }
        }
    }
}
