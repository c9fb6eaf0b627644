//! The sound server: the doctor looks for it as the capture does, and connects.

use super::*;

/// The finding about the server with these variables too; `{}` in a value is the machine's folder.
fn found(machine: &mut Machine, variables: &[(&'static str, &str)]) -> (Severity, String) {
    let root = machine.folder.path().display().to_string();
    let count = machine.variables.len();
    variables.iter().for_each(|(name, value)| machine.set(name, &value.replace("{}", &root)));
    let findings = examine(&machine.surroundings());
    machine.variables.truncate(count);
    let finding = findings.iter().find(|finding| ["sound", "no-sound-server"].contains(&finding.id)).unwrap();
    (finding.severity, finding.found.replace(&root, ""))
}

#[test]
fn the_server_is_looked_for_where_the_capture_finds_it() {
    let mut machine = Machine::new();
    fs::create_dir(machine.path("other")).unwrap();
    let _other = UnixListener::bind(machine.path("other/native")).unwrap();
    drop(UnixListener::bind(machine.path("ended")).unwrap());
    machine.put("file", "");
    let (own, other) = ("/run/pulse/native", "/other/native");
    for (variables, live) in [
        (&[][..], Some(own)),
        (&[("PULSE_SERVER", "")], Some(own)),
        (&[("PULSE_RUNTIME_PATH", "{}/other")], Some(other)),
        (&[("XDG_RUNTIME_DIR", ""), ("PULSE_RUNTIME_PATH", "{}/other")], Some(other)),
        (&[("PULSE_SERVER", "unix:{}/other/native")], Some(other)),
        (&[("PULSE_SERVER", "{}/other/native")], Some(other)),
        (&[("PULSE_SERVER", "unix:{}/other/native tcp:b")], Some(other)),
        (&[("PULSE_SERVER", "tcp:host {id}unix:{}/other/native /d")], Some(other)),
        (&[("PULSE_SERVER", "{id}unix:/nowhere")], None),
        (&[("PULSE_SERVER", "unix:{}/ended")], None),
        (&[("PULSE_SERVER", "unix:{}/file")], None),
        (&[("PULSE_SERVER", "tcp:127.0.0.1")], None),
        (&[("PULSE_RUNTIME_PATH", "{}/nowhere")], None),
        (&[("XDG_RUNTIME_DIR", "")], None),
    ] {
        let (severity, text) = found(&mut machine, variables);
        match live {
            Some(socket) => {
                assert_eq!(text, format!("sound is captured from {socket}"), "{variables:?}");
                assert_eq!(severity, Severity::Good, "{variables:?}");
            }
            None => assert_eq!(severity, Severity::Warning, "{variables:?}: {text}"),
        }
    }
}

#[test]
fn a_missing_server_is_told_from_a_remote_one() {
    let mut machine = Machine::new();
    let (_, text) = found(&mut machine, &[("PULSE_SERVER", "tcp:host")]);
    assert_eq!(text, "PULSE_SERVER names no local socket");
    machine.sound = None;
    let (_, text) = found(&mut machine, &[]);
    let begin = "no PulseAudio or PipeWire server at /run/pulse/native: ";
    assert!(text.starts_with(begin) && text.contains("refused"), "{text}");
}
