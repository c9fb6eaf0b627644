//! Commands of the guide can be typed.

#![allow(clippy::unwrap_used)]

use parafovea_manifest::options::OPTIONS;
use std::fs;
use std::process::Command;
use tempfile::TempDir;

const GUIDE: &str = include_str!("../../GUIDE.md");

/// Lines of boxes that begin with `$`, without that.
fn commands() -> Vec<&'static str> {
    let mut is_box = false;
    let lines = GUIDE.lines().filter_map(|line| {
        is_box ^= line.starts_with("```");
        line.strip_prefix("$ ").filter(|_| is_box)
    });
    lines.collect()
}

#[test]
fn each_command_of_the_guide_works() {
    let home = TempDir::new().unwrap();
    let runtime = home.path().join("run");
    fs::create_dir(&runtime).unwrap();
    // Where a build is put together, the library lies beside the command; here is none.
    let library = home.path().join("libparafovea.so");
    let names =
        "parafovea_xrNegotiateLoaderApiLayerInterface parafovea_vkNegotiateLoaderLayerInterfaceVersion";
    fs::write(&library, format!("\u{7f}ELF {names}")).unwrap();
    let commands = commands();
    assert!(commands.len() >= 14, "{commands:?}");
    for command in commands {
        let mut words = command.split(' ');
        assert_eq!(words.next(), Some("parafovea"), "{command}");
        let mut run = Command::new(env!("CARGO_BIN_EXE_parafovea"));
        run.args(words).env_clear().env("PATH", "/usr/bin:/bin").env("HOME", home.path());
        run.env("XDG_RUNTIME_DIR", &runtime);
        if command.starts_with("parafovea install") {
            run.arg("--library").arg(&library);
        }
        let output = run.output().unwrap();
        let (said, complained) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        // With an application that runs, the end-to-end tests do it.
        let complaint = match command {
            "parafovea gaze recentre" | "parafovea gaze calibrate" => {
                Some("no running application has an active OpenXR session")
            }
            _ if command.contains("--view") => Some("no running application has an OpenXR session"),
            _ => None,
        };
        if let Some(complaint) = complaint {
            assert!(complained.contains(complaint), "{command}: {said}{complained}");
            continue;
        }
        assert!(!said.is_empty(), "{command}: {complained}");
        // A machine without a headset has problems, and the doctor is to report them.
        let may_fail = command.starts_with("parafovea doctor");
        assert!(output.status.success() || may_fail, "{command}: {said}{complained}");
        assert_eq!(complained, "", "{command}");
    }
}

#[test]
fn options_and_commands_that_the_guide_names_are_there() {
    let help = Command::new(env!("CARGO_BIN_EXE_parafovea")).arg("--help").output().unwrap().stdout;
    let help = String::from_utf8(help).unwrap();
    let quoted: Vec<&str> = GUIDE.split('`').skip(1).step_by(2).collect();
    assert!(quoted.len() > 20);
    for text in quoted.iter().filter(|text| !text.contains('\n')) {
        if let Some(rest) = text.strip_prefix("parafovea ") {
            let command = rest.split(' ').next().unwrap();
            assert!(help.contains(&format!("\n  {command} ")), "{text} is in no help");
        }
        let is_key =
            |section: &str| OPTIONS.iter().any(|option| option.section == section && !section.is_empty());
        if let Some((section, _)) = text.split_once('.').filter(|(section, _)| is_key(section)) {
            assert!(
                OPTIONS.iter().any(|option| option.key() == **text),
                "{text} is no option, though {section} is a section"
            );
        }
    }
}
