//! `cargo dev bench recognition [--json]`: precision and recall of recognition on frame graphs of engines, and on 10,000 random ones.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use parafovea_tests::frame_graphs::crowd::{self, Times};
use parafovea_tests::frame_graphs::random::RandomGraph;
use parafovea_tests::frame_graphs::{GRAPHS, Score, run};
use std::process::ExitCode;

/// Random graphs.
const RANDOM: u64 = 10_000;

fn main() -> ExitCode {
    let is_json = std::env::args().any(|argument| argument == "--json");
    let mut all = Score::default();
    if !is_json {
        println!(
            "| graph | eye | precision | recall | full-screen passes at 1x1 | microseconds a frame | wrong | missed |"
        );
        println!("|---|---|---|---|---|---|---|---|");
    }
    for graph in GRAPHS {
        let score = run(graph);
        let [width, height] = graph.eye;
        tell(is_json, graph.name, &format!("{width}x{height}"), &score);
        all += &score;
    }
    tell(
        is_json,
        "all",
        "",
        &Score { wrong_names: Default::default(), missed_names: Default::default(), ..all },
    );
    let same: fn(RandomGraph) -> RandomGraph = |graph| graph;
    for (case, change) in [("random", same), ("random, a third of the sides", RandomGraph::third)] {
        let mut random = Score::default();
        for seed in 0..RANDOM {
            let score = change(RandomGraph::new(seed)).run();
            if score.wrong > 0 {
                eprintln!("random graph {seed}: taken for an eye: {:?}", score.wrong_names);
            }
            random += &score;
        }
        tell(is_json, case, "", &random);
    }
    for passes in [20, 100, 300, 1000] {
        for (is_bindless, reads) in [(false, "known reads"), (true, "unknown reads")] {
            let Times { learned, repeated, verdicts } = crowd::per_frame(passes, is_bindless);
            for (kind, spent) in
                [("first frames", learned), ("repeated frames", repeated), ("verdicts", verdicts)]
            {
                let us = spent.as_secs_f64() * 1e6;
                match is_json {
                    true => println!(
                        "{{\"bench\":\"recognition\",\"app\":\"crowd\",\"case\":\"{passes} passes, {reads}, {kind}\",\"metric\":\"per_frame\",\"value\":{us:.1},\"unit\":\"us\"}}"
                    ),
                    false => println!("{passes} passes, {reads}, {kind}: {us:.1} microseconds a frame"),
                }
            }
        }
    }
    ExitCode::SUCCESS
}

fn tell(is_json: bool, case: &str, eye: &str, score: &Score) {
    let metrics = [
        ("precision", score.precision()),
        ("recall", score.recall()),
        ("full_screen_kept", score.full_screen_kept()),
    ];
    if is_json {
        for (metric, value) in metrics {
            println!(
                "{{\"bench\":\"recognition\",\"app\":\"frame-graphs\",\"case\":\"{case}\",\"metric\":\"{metric}\",\"value\":{value:.4},\"unit\":\"1\"}}"
            );
        }
        return;
    }
    let us = score.per_frame.as_secs_f64() * 1e6;
    let [precision, recall, kept] = metrics.map(|(_, value)| value);
    let wrong: Vec<&str> = score.wrong_names.iter().copied().collect();
    let missed: Vec<&str> = score.missed_names.iter().map(String::as_str).collect();
    println!(
        "| {case} | {eye} | {precision:.3} | {recall:.3} | {kept:.3} | {us:.1} | {} | {} |",
        wrong.join(", "),
        missed.join("; ")
    );
}
