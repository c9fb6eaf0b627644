//! The gaze is private: unless a recording is asked for by name, nothing that is written, to a file or elsewhere, has it.

use super::{following, scenario};
use parafovea_tests::osc::{Sender, message};
use parafovea_tests::run::{Application, Run};
use parafovea_trial::{Lack, skip};
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// System calls by which something could leave the process.
const CALLS: &str = "trace=write,writev,pwrite64,pwritev,pwritev2,sendto,sendmsg,sendmmsg,socket,socketpair,connect,truncate,ftruncate";

/// Direction of the gaze, degrees; no round numbers, so that their digits are found nowhere else.
const LEFT: f32 = 17.329_41;
const UP: f32 = -6.813_27;

/// Reason why no process can be traced here; None if one can be.
fn cannot_trace() -> Option<Lack> {
    let tried = Command::new("strace").args(["-f", "-o", "/dev/null", "true"]).stdin(Stdio::null()).output();
    match tried {
        Ok(output) if output.status.success() => None,
        Ok(output) => Some(Lack::machine(format_args!(
            "the right to trace: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        ))),
        Err(error) => Some(Lack::setup(format_args!("strace: {error}"))),
    }
}

/// Writes and sends of the application's process and its threads, one call a line.
fn trace(config: Option<&str>, folder: &Path) -> Vec<String> {
    let file = folder.join("trace.txt");
    let strace = ["-f", "-s", "65536", "-xx", "-e", CALLS, "-o", file.to_str().unwrap()];
    let application = Application::ours("parafovea-cases", &["attaches_early"]).unwrap();
    let application = application.under("strace", &strace).unwrap();
    let mut scenario = scenario(1000).quiet();
    scenario.gaze[0].yaw_deg = LEFT;
    scenario.gaze[0].pitch_deg = UP;
    let run = Run::new(&application, &scenario).timeout(Duration::from_secs(120));
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    let outcome = run.finish().unwrap();
    assert_eq!(outcome.exit_code, Some(0), "{}", outcome.output);
    std::fs::read_to_string(&file).unwrap().lines().map(str::to_owned).collect()
}

/// A scenario in which the runtime itself writes nothing.
trait Quiet {
    fn quiet(self) -> Self;
}

impl Quiet for parafovea_tests::scenario::Scenario {
    fn quiet(mut self) -> Self {
        self.output.record = false;
        self
    }
}

/// A byte string that gives the gaze away.
enum Sign {
    /// A number in digits, which begins there: not the end of another one, such as a time.
    Digits(Vec<u8>),
    /// A number as it lies in memory.
    Number(Vec<u8>),
}

impl Sign {
    /// Whether a line of a trace has it. strace prints bytes as `\x2e`.
    fn is_in(&self, line: &str) -> bool {
        let printed = |bytes: &[u8]| bytes.iter().map(|byte| format!("\\x{byte:02x}")).collect::<String>();
        match self {
            Self::Number(bytes) => line.contains(&printed(bytes)),
            Self::Digits(bytes) => line.match_indices(&printed(bytes)).any(|(at, _)| {
                let is_digit = |digit: u8| line[..at].ends_with(&printed(&[digit]));
                !(b'0'..=b'9').any(is_digit)
            }),
        }
    }
}

/// Traces of the gaze: its angles, direction and orientation, in digits and as numbers.
fn signs() -> Vec<Sign> {
    let turned = glam::Quat::from_euler(glam::EulerRot::YXZ, LEFT.to_radians(), UP.to_radians(), 0.0);
    let direction = turned * glam::Vec3::NEG_Z;
    let numbers = [LEFT, UP, LEFT.to_radians(), UP.to_radians()]
        .into_iter()
        .chain(direction.to_array())
        .chain(turned.to_array().into_iter().filter(|part| *part != 0.0));
    let mut signs = Vec::new();
    for number in numbers {
        // Without the last digits, which depend on how it was computed, and on how many are printed.
        signs.push(Sign::Digits(format!("{:.3}", number.abs()).into_bytes()));
        signs.push(Sign::Number(number.to_le_bytes()[1..].to_vec()));
        signs.push(Sign::Number(f64::from(number).to_le_bytes()[4..].to_vec()));
    }
    signs
}

/// The lines that have one of the signs.
fn betraying<'a>(trace: &'a [String], signs: &[Sign]) -> Vec<&'a String> {
    trace.iter().filter(|line| signs.iter().any(|sign| sign.is_in(line))).collect()
}

fn sockets(trace: &[String]) -> usize {
    trace.iter().filter(|line| line.contains("socket(") || line.contains("connect(")).count()
}

#[test]
fn digits_of_a_time_are_no_sign_and_those_of_an_angle_are() {
    let sign = Sign::Digits(b"0.059".to_vec());
    assert!(!sign.is_in(r#"write(3, "\x34\x35\x30\x2e\x30\x35\x39\x20", 8) = 8"#), "450.059");
    assert!(sign.is_in(r#"write(3, "\x34\x2c\x30\x2e\x30\x35\x39", 7) = 7"#), "4,0.059");
    assert!(sign.is_in(r#"write(3, "\x30\x2e\x30\x35\x39", 5) = 5"#));
}

#[test]
fn no_write_has_the_gaze_in_it_and_nothing_is_sent() {
    if let Some(reason) = cannot_trace() {
        skip(&reason);
    }
    let folder = tempfile::tempdir().unwrap();
    let reference = trace(None, folder.path());
    let followed = trace(Some(&format!("{}[log]\nlevel = \"debug\"\n", following(""))), folder.path());
    assert!(followed.len() > 3, "{followed:#?}");
    assert_eq!(betraying(&followed, &signs()), Vec::<&String>::new());
    assert_eq!(sockets(&followed), sockets(&reference));

    // A gaze from packets is received, and never sent on or written: one socket, and no connection.
    let address = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let sender =
        Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-UP, -LEFT])]).unwrap();
    let lines = format!("osc_listen = \"{address}\"");
    let config = following(&lines).replace("\"eyes\"", "\"osc\"");
    let received = trace(Some(&format!("{config}[log]\nlevel = \"debug\"\n")), folder.path());
    drop(sender);
    assert_eq!(betraying(&received, &signs()), Vec::<&String>::new());
    assert_eq!(sockets(&received), sockets(&reference) + 1);
    let sent = |line: &&String| line.contains("sendto(") && !line.contains(", \"\", 0,");
    assert_eq!(received.iter().filter(sent).count(), reference.iter().filter(sent).count());

    // The same search finds a recording that was asked for.
    let file: PathBuf = folder.path().join("gaze.csv");
    let recorded = trace(Some(&following(&format!("record = {file:?}"))), folder.path());
    assert!(!betraying(&recorded, &signs()).is_empty());
    assert!(std::fs::read_to_string(&file).unwrap().contains("17.32"));
}
