//! The status, for people.

use parafovea_manifest::status::{Found, Gate, Memory, Rates, Settings, Sound, Status, effect};
use std::fmt::Write;

/// All applications, or the one named in `asked`; `gone` is the number of crashed or hanging ones.
pub fn of_all(found: &[Found], gone: usize, asked: Option<&str>) -> String {
    let mut text: Vec<String> = found.iter().map(of_one).collect();
    if found.is_empty() {
        let called = asked.map_or(String::new(), |name| format!(" named {name}"));
        text.push(format!(
            "No running application{called} has an OpenXR session with Parafovea.\n\
             To start one: parafovea run -- GAME, or in Steam the launch options PARAFOVEA=1 %command%.\n\
             If a running application is missing here: run parafovea doctor, and read the application's log in ~/.local/state/parafovea (Steam from Flatpak: ~/.var/app/com.valvesoftware.Steam/.local/state/parafovea).\n"
        ));
    }
    if gone > 0 {
        text.push(format!("Not responding: {gone} (number of applications that crashed or hang).\n"));
    }
    text.join("\n")
}

fn of_one(Found { status, log, .. }: &Found) -> String {
    let mut text = format!("{}\n", title(status));
    let mut line = |name: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {name:9} {}", plain(value));
    };
    if !status.inert.is_empty() {
        line("state", &format!("inert: {}", status.inert));
    } else {
        line(
            "state",
            &format!("active, {:.0} frames per second, {} in total", status.frame_rate_hz, status.frames),
        );
        line("backend", &status.backend);
        line("gaze", &format!("{}{}", status.gaze, sparse(status)));
        if let Some(drift) = status.gaze.drift() {
            line("drift", &drift);
        }
        line("sound", &sound(&status.sound));
        line("tiles", &rates(&status.rates));
        // Without a backend there is nothing to judge.
        let gate = |told: &Gate| match status.backend.as_str() {
            "none" if told.mode != "off" => "unavailable: no backend on this device".to_owned(),
            _ => gate(told),
        };
        line("rates", &gate(&status.rates_gate));
        line("re-use", &format!("{}{}", gate(&status.reuse_gate), slow(status)));
        if status.memory.all_mib > 0.0 || !status.memory.refused.is_empty() {
            line("memory", &memory(&status.memory));
        }
        line("chroma", if status.attenuates_colour { "attenuated in the periphery" } else { "unchanged" });
        line("view", &view(status));
        line("passes", &format!("{} with shading rates in the last frame", status.passes_matched));
    }
    line("settings", &settings(&status.settings));
    if let Some(log) = log {
        line("log", &log.display().to_string());
    }
    // At the end, which may not fit on a screen. An inert session has none that count.
    let decisions = status.decisions.iter().filter(|_| status.inert.is_empty());
    for (index, decision) in decisions.enumerate() {
        line(if index == 0 { "decisions" } else { "" }, &decision.line);
    }
    text
}

/// The names of an application and its process, in one line.
pub fn title(status: &Status) -> String {
    plain(&format!("{} (process {}, {})", status.application, status.pid, status.executable))
}

/// As the log has it: names that an application chose may contain line ends and commands for the terminal.
fn plain(text: &str) -> String {
    text.replace(|character: char| character.is_control(), " ")
}

fn settings(settings: &Settings) -> String {
    match (settings.file.as_str(), settings.has_error) {
        ("", _) => "defaults; no configuration file".to_owned(),
        (file, false) => file.to_owned(),
        (file, true) => format!("{file}: has an error and is ignored; the log names the line"),
    }
}

fn memory(memory: &Memory) -> String {
    let Memory { all_mib, reuse_mib, refused } = memory;
    let used = format!("{all_mib:.1} MiB on the device, {reuse_mib:.1} MiB of them for re-use");
    if refused.is_empty() { used } else { format!("{used}; no re-use in a swapchain: {refused}") }
}

fn sound(sound: &Sound) -> String {
    match (sound.source.as_str(), sound.is_heard) {
        ("off", _) => "off".to_owned(),
        (source, true) => format!("{source}: valid"),
        (source, false) => format!("{source}: no valid loudness and pitch"),
    }
}

fn rates(rates: &Rates) -> String {
    if rates.tiles.is_empty() {
        return "not planned: no frame was rendered yet, or every technique is off or dropped".to_owned();
    }
    let percent = rates.shaded * 100.0;
    let shaded = if rates.decided_on_gpu {
        format!("by contrast, on the GPU (share unknown); rings would shade {percent:.0} % of the pixels")
    } else {
        let share = |(rate, share): &(String, f32)| match rate.as_str() {
            "skipped" => format!("4x4 blocks skipped {:.0} %", share * 100.0),
            rate => format!("{rate} {:.0} %", share * 100.0),
        };
        let tiles: Vec<String> = rates.tiles.iter().map(share).collect();
        format!("{percent:.0} % of the pixels shaded; tiles: {}", tiles.join(", "))
    };
    if rates.rendered < 1.0 {
        return format!("{shaded}; {:.0} % of the tiles rendered per frame", rates.rendered * 100.0);
    }
    shaded
}

fn view(status: &Status) -> String {
    let view = &status.debug_view;
    let whose = if view.is_asked { ", requested by parafovea status --view" } else { "" };
    match (view.name.as_str(), view.is_drawn) {
        ("none" | "", _) => format!("none{whose}"),
        (name, true) => format!("\"{name}\" is visible in the headset{whose}"),
        (name, false) => format!("\"{name}\" is not visible{whose}: {}", why_not_drawn(status)),
    }
}

/// Reason why a requested view is not visible, as far as the status knows.
pub fn why_not_drawn(status: &Status) -> &'static str {
    match status.debug_view.name.as_str() {
        "gaze" if !status.gaze.is_valid => "no gaze",
        "rates" if status.backend == "none" => "no backend on this device",
        "rates" if status.rates_gate.mode == "off" || !status.rates_gate.is_kept => {
            "rates are off, or were dropped"
        }
        "age" if status.reuse_gate.mode == "off" || !status.reuse_gate.is_kept => {
            "re-use is off, or was dropped"
        }
        _ => "its swapchains are of an unsupported kind, or the game renders no frames",
    }
}

/// The rate from which on regions can be left out of a frame and still be rendered 30 times a second, Hz
/// (`parafovea_core::schedule::MIN_UPDATE_HZ`): twice that.
const LEAST_RATE_HZ: f32 = 60.0;

/// Names the safety limit of the update rate, where it keeps re-use from doing anything.
fn slow(status: &Status) -> &'static str {
    let is_on = status.reuse_gate.mode != "off" && status.reuse_gate.is_kept;
    let is_slow = status.frame_rate_hz > 0.0 && status.frame_rate_hz < LEAST_RATE_HZ;
    match is_on && is_slow && status.rates.rendered >= 1.0 {
        true => "; safety limit: below 60 frames per second, every region is rendered in every frame",
        false => "",
    }
}

/// The rate from which on samples of the gaze, one a frame, are not interruptions of each other, Hz: 1 s / 150 ms
/// (`parafovea_core::gaze`).
const LEAST_GAZE_RATE_HZ: f32 = 6.7;

/// Names the safety limit that keeps a tracker's gaze from being relied on.
fn sparse(status: &Status) -> &'static str {
    let is_tracked = !matches!(status.gaze.holder.as_str(), "" | "centre");
    let is_slow = status.frame_rate_hz > 0.0 && status.frame_rate_hz < LEAST_GAZE_RATE_HZ;
    match is_tracked && is_slow {
        true => {
            "; safety limit: below 7 frames per second, the gaze is too uncertain to shade coarsely around it"
        }
        false => "",
    }
}

fn gate(gate: &Gate) -> String {
    let saved = match gate.ratio {
        Some(ratio) => format!(": {}", effect(ratio)),
        None if gate.mode == "auto" => ": not measured yet".to_owned(),
        None => String::new(),
    };
    let saved = if gate.is_on_trial { format!("{saved}; trial in progress") } else { saved };
    match (gate.mode.as_str(), gate.is_kept) {
        ("off", _) => "off".to_owned(),
        ("auto", true) => format!("on{saved}"),
        ("auto", false) => format!("dropped{saved}"),
        (_, _) => format!("on, because of rates.gate{saved}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::Decision;
    use parafovea_manifest::status::{Gaze, View};
    use std::time::Duration;

    fn shown(status: Status) -> String {
        of_all(&[Found { status, age: Duration::ZERO, log: Some("/s/game.log".into()) }], 0, None)
    }

    fn active() -> Status {
        Status {
            pid: 7,
            executable: "game.exe".to_owned(),
            application: "Game".to_owned(),
            frames: 900,
            frame_rate_hz: 89.96,
            backend: "mask".to_owned(),
            passes_matched: 2,
            decisions: ["no rates", "pass 64x64: the scene"]
                .map(|line| Decision { line: line.to_owned(), ..Decision::default() })
                .to_vec(),
            gaze: Gaze {
                source: "eyes".to_owned(),
                is_valid: true,
                age_ms: Some(11.6),
                rate_hz: Some(90.0),
                drift_deg: Some(2.5),
                ..Gaze::default()
            },
            sound: Sound { source: "off".to_owned(), is_heard: false },
            rates: Rates {
                tiles: vec![("4x4".to_owned(), 0.25), ("1x1".to_owned(), 0.75)],
                shaded: 0.77,
                decided_on_gpu: false,
                rendered: 1.0,
            },
            rates_gate: Gate {
                mode: "auto".to_owned(),
                is_kept: true,
                is_on_trial: false,
                ratio: Some([0.65, 0.6, 0.7]),
            },
            reuse_gate: Gate { mode: "off".to_owned(), ..Gate::default() },
            memory: Memory { all_mib: 81.25, reuse_mib: 40.0, refused: String::new() },
            ..Status::default()
        }
    }

    #[test]
    fn an_active_application_has_everything_in_it() {
        let text = shown(active());
        for line in [
            "Game (process 7, game.exe)",
            "  state     active, 90 frames per second, 900 in total",
            "  gaze      eye tracker: valid, 90 Hz, 12 ms old at display time",
            "  drift     the mean gaze has drifted by 2.5 degrees since the first five minutes; if the headset slipped: parafovea gaze recentre",
            "  tiles     77 % of the pixels shaded; tiles: 4x4 25 %, 1x1 75 %",
            "  rates     on: a saving of 35 % (30 to 40 %)",
            "  re-use    off",
            "  memory    81.2 MiB on the device, 40.0 MiB of them for re-use",
            "  decisions no rates",
            "            pass 64x64: the scene",
            "  settings  defaults; no configuration file",
            "  log       /s/game.log",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\nin\n{text}");
        }
        // On a small screen, all else is more important.
        assert!(text.ends_with("  decisions no rates\n            pass 64x64: the scene\n"), "{text}");
    }

    #[test]
    fn names_cannot_move_the_cursor() {
        let decisions = vec![Decision { line: "a\npass".to_owned(), ..Decision::default() }];
        let names = ("Game\n\u{1b}[2J".to_owned(), "game\u{9b}.exe".to_owned());
        let text = shown(Status { application: names.0, executable: names.1, decisions, ..active() });
        assert!(text.starts_with("Game  [2J (process 7, game .exe)\n"), "{text:?}");
        assert!(text.ends_with("  decisions a pass\n"), "{text:?}");
    }

    #[test]
    fn masks_say_how_many_blocks_are_skipped() {
        let active = active();
        let tiles = vec![("skipped".to_owned(), 0.4), ("1x1".to_owned(), 0.6)];
        let rates = Rates { tiles, shaded: 0.6, ..active.rates.clone() };
        let text = shown(Status { rates, ..active });
        let line = "  tiles     60 % of the pixels shaded; tiles: 4x4 blocks skipped 40 %, 1x1 60 %";
        assert!(text.lines().any(|found| found == line), "{text}");
    }

    #[test]
    fn a_frame_rate_below_the_safety_limit_is_said_to_stop_re_use() {
        let of = |frame_rate_hz, mode: &str, rendered| {
            let active = active();
            let rates = Rates { rendered, ..active.rates.clone() };
            let reuse_gate = Gate { mode: mode.to_owned(), is_kept: true, ..Gate::default() };
            shown(Status { frame_rate_hz, rates, reuse_gate, ..active })
        };
        let line = "safety limit: below 60 frames per second, every region is rendered in every frame";
        for hz in [2.0, 10.0, 30.0, 59.0] {
            assert!(of(hz, "on", 1.0).contains(line), "{hz}");
        }
        for other in [of(0.0, "on", 1.0), of(90.0, "on", 1.0), of(30.0, "off", 1.0), of(30.0, "on", 0.5)] {
            assert!(!other.contains(line), "{other}");
        }
    }

    #[test]
    fn a_frame_rate_below_the_safety_limit_is_said_to_stop_a_tracker() {
        let of = |frame_rate_hz, holder: &str| {
            let active = active();
            let gaze = Gaze { holder: holder.to_owned(), ..active.gaze.clone() };
            shown(Status { frame_rate_hz, gaze, ..active })
        };
        let line = "safety limit: below 7 frames per second, the gaze is too uncertain";
        for (hz, holder) in [(2.0, "eyes"), (6.0, "osc")] {
            assert!(of(hz, holder).contains(line), "{hz}");
        }
        for other in [of(0.0, "eyes"), of(7.0, "eyes"), of(2.0, "centre"), of(2.0, "")] {
            assert!(!other.contains(line), "{other}");
        }
    }

    #[test]
    fn figures_that_only_the_gpu_knows_are_marked() {
        let active = active();
        let rates = Rates { decided_on_gpu: true, ..active.rates.clone() };
        let text = shown(Status { rates, ..active });
        let line =
            "  tiles     by contrast, on the GPU (share unknown); rings would shade 77 % of the pixels";
        assert!(text.lines().any(|found| found == line), "{text}");
    }

    #[test]
    fn a_view_that_is_not_to_be_seen_says_why() {
        let view = |name: &str, is_asked, is_drawn| View { name: name.to_owned(), is_asked, is_drawn };
        for (debug_view, line) in [
            (view("none", false, false), "view      none"),
            (
                view("gaze", true, true),
                "view      \"gaze\" is visible in the headset, requested by parafovea status --view",
            ),
            (view("age", false, false), "view      \"age\" is not visible: re-use is off, or was dropped"),
        ] {
            let text = shown(Status { debug_view, ..active() });
            assert!(text.lines().any(|found| found.trim_start() == line), "{line}\nin\n{text}");
        }
        let blind = Status { gaze: Gaze::default(), debug_view: view("gaze", true, false), ..active() };
        assert!(shown(blind).contains("requested by parafovea status --view: no gaze"));
    }

    #[test]
    fn dropped_techniques_and_inert_layers_have_a_reason() {
        let tried = Gate { mode: "auto".to_owned(), is_kept: true, is_on_trial: true, ratio: None };
        let text = shown(Status { rates_gate: tried, ..active() });
        assert!(text.contains("on: not measured yet; trial in progress"), "{text}");
        let dropped = Gate {
            mode: "auto".to_owned(),
            is_kept: false,
            is_on_trial: false,
            ratio: Some([1.2, 1.1, 1.3]),
        };
        let text = shown(Status { rates_gate: dropped, ..active() });
        assert!(text.contains("  rates     dropped: a slowdown of 20 % (10 to 30 %)"), "{text}");
        let settings = Settings { file: "/c.toml".to_owned(), has_error: true };
        let refused = shown(Status { settings: settings.clone(), ..active() });
        assert!(refused.contains("  settings  /c.toml: has an error"), "{refused}");
        let named = shown(Status { settings: Settings { has_error: false, ..settings }, ..active() });
        assert!(named.lines().any(|line| line == "  settings  /c.toml"), "{named}");
        let inert = shown(Status { inert: "its graphics API is not Vulkan".to_owned(), ..active() });
        assert!(
            inert.contains("inert: its graphics API is not Vulkan") && !inert.contains("backend"),
            "{inert}"
        );
        let without = shown(Status { backend: "none".to_owned(), ..active() });
        assert!(without.contains("rates     unavailable: no backend on this device"), "{without}");
        assert!(without.contains("re-use    off"), "{without}");
        let none = of_all(&[], 1, None);
        assert!(none.starts_with("No running application") && none.contains("Not responding: 1"), "{none}");
    }
}
