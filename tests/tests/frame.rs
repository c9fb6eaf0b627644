//! The runner of `cargo dev bench frame`, with the least effort: correctness, not speed.

use glam::Vec3;
use parafovea_models::errors::{Metric, Report};
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::Script;
use parafovea_scene::script::tracker::Tracker;
use parafovea_tests::measure::{Effort, RUN_UP, Subject, Technique, errors, rows, side_by_side, time};
use parafovea_tests::run::Outcome;

#[test]
fn techniques_take_turns_and_fragments_are_counted() {
    let subject = Subject::around_a_saccade(SceneName::Courtyard, Tracker::IDEAL);
    let chroma = Technique::layer("chroma", "preset = \"none\"\n[chroma]\nmode = \"default\"\n");
    let techniques = [Technique::off(), chroma, Technique::render_scale(0.5)];
    let mut order = Vec::new();
    let effort = Effort { turns: 2, run_up: 2, frames: 18, size: 64 };
    let timings = time(&subject, &techniques, effort, true, |run| order.push(run.to_owned())).unwrap();
    assert_eq!(order.len(), 3 * (1 + 2), "counted, and timed twice");
    let turns: Vec<&str> = order[3..].iter().filter_map(|run| run.split(": ").nth(1)).collect();
    let expected = ["off", "chroma", "render scale 0.5"];
    let names: Vec<&str> = turns.iter().filter_map(|turn| turn.split(", ").next()).collect();
    assert_eq!([&names[..3], &names[3..]], [&expected[..]; 2]);

    let [off, chroma, half] = &timings[..] else { panic!("not three timings") };
    assert_eq!(off.fragments, chroma.fragments, "chroma changed what the application shades");
    let share = half.fragments as f64 / off.fragments as f64;
    assert!((0.15..0.6).contains(&share), "at half the scale {share} of the fragments are left");
    let rows = rows("courtyard", &timings);
    let layer: Vec<&str> =
        rows.iter().filter(|row| row.metric == "layer_cpu_median").map(|row| row.case.as_str()).collect();
    assert_eq!(layer, ["chroma"], "only there the layer works and the application does the same");
    // lavapipe has timestamps too: of the same frames as CPU time, of which it is the most.
    for timing in &timings {
        assert_eq!(timing.gpu_ms.len(), timing.cpu_ms.len(), "{}", timing.technique);
        assert!(timing.gpu_ms.median() > 0.0, "{}: nothing took time", timing.technique);
    }
    assert_eq!(rows.iter().filter(|row| row.metric == "gpu_ms").count(), 3);
    assert!(rows.iter().all(|row| row.comparison.is_none_or(|with| with.ratio.is_finite())), "{rows:#?}");
}

/// Side by side, each has its own frames, the same as alone: a subject with a run-up begins sooner, and all show the same time of the
/// script in the frames that count.
#[test]
fn frames_side_by_side_are_those_of_runs_alone() {
    let subject = Subject::around_a_saccade(SceneName::Street, Tracker::IDEAL);
    let chroma = Technique::layer("chroma", "preset = \"none\"\n[chroma]\nmode = \"default\"\n");
    let techniques = [Technique::off(), chroma];
    let effort = Effort { turns: 1, run_up: 7, frames: 5, size: 64 };
    let outcomes = side_by_side(&subject, &techniques, effort, false, |_| ()).unwrap();
    let lengths = [0, 1].map(|index| outcomes[index].record.frames.len());
    assert_eq!(lengths, [4 + 5, 7 + 5]);
    let gazes = |outcome: &Outcome| -> Vec<Vec3> {
        outcome.record.frames.iter().rev().take(5).map(|frame| Vec3::from(frame.gaze.unwrap())).collect()
    };
    let alone = subject.run(&techniques[0], effort).unwrap().finish().unwrap();
    for outcome in &outcomes {
        let (here, there) = (gazes(outcome), gazes(&alone));
        let is_near = |(here, there): (&Vec3, &Vec3)| here.distance(*there) < 1e-4;
        assert!(here.iter().zip(&there).all(is_near), "{here:?}, {there:?}");
    }
}

/// Chroma, with nothing that hides the effect of a late gaze.
const IMPATIENT_CHROMA: &str = "preset = \"none\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

fn judged(subject: &Subject, frames: u64) -> Report {
    let techniques = [Technique::off(), Technique::layer("chroma", IMPATIENT_CHROMA)];
    let effort = Effort { turns: 1, run_up: RUN_UP, frames, size: 128 };
    errors(subject, &techniques, effort, |_| ()).unwrap().remove(0)
}

/// Squared error within 2 degrees of where the eyes truly look: of all metrics the one that sees nothing beside it.
fn loss_at_the_gaze(report: &Report) -> f64 {
    report.row(Metric::Squared, 0).mean.unwrap()
}

#[test]
fn a_late_gaze_costs_in_saccades_and_not_in_fixations() {
    let scene = SceneName::Courtyard;
    let late = Tracker { delay_ms: 100.0, ..Tracker::IDEAL };
    let saccades = Script::new(scene).gaze.saccades();
    let first_large = saccades.iter().find(|saccade| saccade.amplitude_deg >= 12.0).unwrap();
    // A second without a saccade, nor one in the time that the gaze is late by before it.
    let rest = saccades.windows(2).find(|pair| pair[1].start_s - pair[0].start_s > 0.75).unwrap();
    let frame = |time_s: f64| (time_s * 90.0) as u64 - RUN_UP;
    let loss =
        |tracker, start_s| loss_at_the_gaze(&judged(&Subject::new(scene, tracker, frame(start_s)), 20));

    let jump = first_large.start_s - 0.05;
    let (in_time, too_late) = (loss(Tracker::IDEAL, jump), loss(late, jump));
    // In flight colour is kept where the gaze is expected to land, which is not quite its current direction.
    assert!(20.0 * in_time < too_late, "saccade: error {in_time} in time, {too_late} too late");
    let still = rest[0].start_s + rest[0].duration_s + 0.3;
    let (in_time, too_late) = (loss(Tracker::IDEAL, still), loss(late, still));
    assert!(in_time == 0.0 && too_late == 0.0, "fixation: error {in_time} in time, {too_late} too late");
}

#[test]
fn the_same_run_twice_has_the_same_errors() {
    let subject = Subject::around_a_saccade(SceneName::Street, Tracker::GOOD);
    assert_eq!(judged(&subject, 5), judged(&subject, 5));
}
