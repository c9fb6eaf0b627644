//! Random sequences of OpenXR calls return with the layer what they return without.

use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// What makes swapchains virtual, with as many images as the runtime's, and has passes recognised.
const EVERYTHING: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n[chroma]\nmode = \"default\"\n";

/// In every test; all of them by `cargo dev sequences`.
const FEW: [u64; 2] = [1_000, 200];

/// Sequences of one process.
const AT_ONCE: u64 = 2_500;

fn lines(arguments: &[&str], is_on: bool) -> Vec<String> {
    let mut scenario = Scenario::new(0).sized(32, 32);
    // Warnings of unknown structures would be most of what is written.
    scenario.output.record = false;
    let run = Run::new(&Application::ours("parafovea-cases", arguments).unwrap(), &scenario);
    let run = if is_on { run.on(EVERYTHING) } else { run };
    let outcome = run.finish().unwrap().expect_end().unwrap_or_else(|error| panic!("{arguments:?}: {error}"));
    for told in ["internal error", "WARN", "ERROR"] {
        assert!(!outcome.log.contains(told), "{arguments:?}\n{}", outcome.log);
    }
    outcome.output.lines().map(str::to_owned).collect()
}

/// Runs sequences with the layer and without, and compares them.
fn compare(count: u64, manner: &[&str]) {
    let mut calls = 0;
    for first in (0..count).step_by(AT_ONCE as usize) {
        let (first, count) = (first.to_string(), AT_ONCE.min(count - first).to_string());
        let arguments = [&["--sequences", &count, "--first", &first], manner].concat();
        let [off, on] = std::thread::scope(|scope| {
            [false, true]
                .map(|is_on| {
                    scope.spawn({
                        let arguments = &arguments;
                        move || lines(arguments, is_on)
                    })
                })
                .map(|run| run.join().unwrap())
        });
        assert_eq!(off.len(), on.len(), "{arguments:?}");
        if let Some((off, _)) = off.iter().zip(&on).find(|(off, on)| off != on) {
            let number = off.trim_start_matches("sequence ").split(':').next().unwrap();
            let one = [&["--sequences", "1", "--first", number], manner].concat();
            let [off, on] = [false, true].map(|is_on| lines(&one, is_on));
            let same = off.iter().zip(&on).take_while(|(off, on)| off == on).count();
            let around = same.saturating_sub(12)..;
            panic!(
                "sequence {number}: without the layer {:#?}\nwith it {:#?}",
                &off[around.start..(same + 1).min(off.len())],
                &on[same..(same + 1).min(on.len())]
            );
        }
        let number = |line: &String| line.split(' ').nth(2)?.parse::<u64>().ok();
        calls += off.iter().filter_map(number).sum::<u64>();
    }
    println!("{count} sequences {manner:?}, {calls} calls");
    assert!(calls > 10 * count, "hardly anything was called");
}

#[test]
fn legal_sequences_return_the_same() {
    compare(FEW[0], &[]);
}

#[test]
fn hostile_sequences_return_the_same() {
    compare(FEW[1], &["--hostile"]);
}

#[test]
#[ignore = "many minutes: cargo dev sequences"]
fn all_sequences_return_the_same() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse().ok());
    compare(number("PARAFOVEA_SEQUENCES").unwrap_or(100_000), &[]);
    compare(number("PARAFOVEA_HOSTILE").unwrap_or(1_000), &["--hostile"]);
}
