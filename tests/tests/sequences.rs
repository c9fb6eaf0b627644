//! Random sequences of OpenXR calls have the same results with the layer as without.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// A configuration that makes swapchains virtual, with as many images as the runtime's, and recognises passes.
const EVERYTHING: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n[chroma]\nmode = \"default\"\n";

/// In every test; all of them by `cargo dev sequences`.
const FEW: [u64; 2] = [1_000, 200];

/// Sequences of one process.
const AT_ONCE: u64 = 2_500;

fn lines(arguments: &[&str], is_on: bool) -> Vec<String> {
    let mut scenario = Scenario::new(0).sized(32, 32);
    // Warnings of unknown structures would fill most of the record.
    scenario.output.record = false;
    let run = Run::new(&Application::ours("parafovea-cases", arguments).unwrap(), &scenario);
    let run = if is_on { run.on(EVERYTHING) } else { run };
    let outcome = run.finish().unwrap().expect_end().unwrap_or_else(|error| panic!("{arguments:?}: {error}"));
    assert!(outcome.complaints().is_empty(), "{arguments:?}\n{}", outcome.log);
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

/// Everything is ready for rates and re-use, and nothing is coarser, older or less colourful.
const READY: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"off\"\n[reuse]\nmode = \"on\"\n";

/// Everything on.
const AT_WORK: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n";

/// Random recordings of each process, a frame each.
const FRAMES: u64 = 24;

/// Processes of every test.
const FEW_PROCESSES: u64 = 2;

/// Records frames without a plan: with the layer ready and nothing to do their pictures are the same to the last bit, and with everything
/// on validation finds nothing.
fn compare_recordings(processes: u64) {
    let frames = FRAMES.to_string();
    for number in 0..processes {
        let seed = number.to_string();
        let arguments = ["--style", "random", "--size", "64", "--frames", &frames, "--seed", &seed];
        let application = Application::ours("parafovea-zoo", &arguments).unwrap();
        let saved: Vec<u64> = (0..FRAMES).collect();
        let run = Run::new(&application, &Scenario::new(FRAMES).sized(64, 64).saving(&saved));
        let run = match number % 2 {
            0 => run,
            _ => run.shading_rates(ShadingRateProfile::ALL[number as usize % ShadingRateProfile::ALL.len()]),
        };
        let finish = |run: Run| run.finish().unwrap().expect_frames(FRAMES).unwrap();
        let off = finish(run.clone().validated());
        let (ready, at_work) = (finish(run.clone().on(READY)), finish(run.validated().on(AT_WORK)));
        let mut new = at_work.findings.beyond(&off.findings);
        new.retain(|found| !found.is_of_stand_in());
        assert!(new.is_empty(), "seed {seed}: {new:#?}\n{}", at_work.log);
        // The application's own calls are valid: otherwise the test would show nothing.
        assert!(off.findings.vulkan.iter().all(|found| found.is_of_stand_in()), "{:#?}", off.findings);
        for outcome in [&ready, &at_work] {
            assert!(outcome.complaints().is_empty(), "seed {seed}\n{}", outcome.log);
            let wrong: Vec<_> = outcome.shading_rates().unwrap();
            let wrong: Vec<_> =
                wrong.iter().filter(|line| matches!(line, ShadingRateLine::Finding(_))).collect();
            assert!(wrong.is_empty(), "seed {seed}: {wrong:#?}");
        }
        let pictures = |outcome: &Outcome| -> Vec<_> {
            let both = saved.iter().flat_map(|frame| [(0, *frame), (1, *frame)]);
            both.map(|(view, frame)| outcome.submitted(view, frame).unwrap()).collect()
        };
        let (before, after) = (pictures(&off), pictures(&ready));
        let differs = before.iter().zip(&after).position(|(before, after)| before != after);
        assert_eq!(differs, None, "seed {seed}: view + 2 x frame\n{}", ready.log);
        assert!(before != pictures(&at_work), "seed {seed}: nothing was done");
    }
    println!("{} random recordings in {processes} processes", processes * FRAMES);
}

#[test]
fn random_recordings_show_the_same() {
    compare_recordings(FEW_PROCESSES);
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
    compare_recordings(number("PARAFOVEA_RECORDINGS").unwrap_or(100));
}
