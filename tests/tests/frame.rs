//! The runner of `cargo dev bench frame`, with the least effort: that it works, not how fast anything is.

use parafovea_tests::measure::{Effort, Subject, Technique, rows, time};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

#[test]
fn techniques_take_turns_and_fragments_are_counted() {
    let subject = Subject::new("courtyard", &[], Scenario::new(0));
    let chroma = Technique::layer("chroma", "[chroma]\nmode = \"default\"\n[gaze]\nsource = \"centre\"\n");
    let techniques = [Technique::off(), chroma, Technique::render_scale(0.5)];
    let mut order = Vec::new();
    let effort = Effort { turns: 2, frames: 20, size: 64 };
    let timings = time(&subject, &techniques, effort, |run| order.push(run.to_owned())).unwrap();
    assert_eq!(order.len(), 3 * (1 + 2));
    let turns: Vec<&str> = order[3..].iter().filter_map(|run| run.split(": ").nth(1)).collect();
    let expected = ["off", "chroma", "render scale 0.5"];
    let names: Vec<&str> = turns.iter().filter_map(|turn| turn.split(", ").next()).collect();
    assert_eq!(names[..3], expected);
    assert!(names[3..].iter().rev().eq(&expected), "the second turn is not in reversed order: {names:?}");

    let [off, chroma, half] = &timings[..] else { panic!("not three timings") };
    assert_eq!(off.fragments, chroma.fragments, "chroma changed what the application shades");
    let share = half.fragments as f64 / off.fragments as f64;
    assert!((0.15..0.6).contains(&share), "at half the scale {share} of the fragments are left");
    let rows = rows("courtyard", &timings);
    let layer: Vec<&str> =
        rows.iter().filter(|row| row.metric == "layer_cpu_median").map(|row| row.case.as_str()).collect();
    assert_eq!(layer, ["chroma"], "only there the layer works and the application does the same");
    assert!(rows.iter().all(|row| row.ratio.is_finite()), "{rows:#?}");
}
