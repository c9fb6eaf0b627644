//! The eyes of frame graphs are recognised, and no texture of any graph becomes coarser.

use parafovea::pass_detection::Feedback;
use parafovea_tests::frame_graphs::random::RandomGraph;
use parafovea_tests::frame_graphs::{GRAPHS, Score, feedback, run};

/// Random graphs of a test: `cargo dev bench recognition` has 10,000.
const RANDOM: u64 = 500;

/// Seeds of graphs that had a texture coarsened while a single frame decided where a picture comes from that may be read from anything.
const ONCE_WRONG: [u64; 13] = [3389, 3958, 4223, 4441, 4732, 5265, 5288, 5912, 6781, 7058, 8091, 8485, 9606];

#[test]
fn eyes_of_engines_are_found_and_nothing_else() {
    let mut known = Score::default();
    for graph in GRAPHS {
        let score = run(graph);
        assert_eq!(score.wrong, 0, "{}: {:?}", graph.name, score.wrong_names);
        assert_eq!(score.coarse_full_screen, 0, "{}: tone mapping or filters", graph.name);
        // Without descriptors, a mirror like an eye makes the scene ambiguous.
        if !graph.is_bindless {
            known += &score;
        }
    }
    assert!(known.recall() >= 0.95, "recall {}: {:#?}", known.recall(), known.missed_names);
}

/// Graphs with a temporal filter in passes whose reads are known, or with draws that are bound to a copy of the frame before.
const FILTERED: [&str; 4] =
    ["unreal-deferred", "unreal-deferred-dynamic", "unreal-deferred-third", "urp-copied"];

/// Graphs with an unknown reader of the scene: compute, or descriptors that are not followed.
const UNKNOWN: [&str; 23] = [
    "native-dome-bindless",
    "native-visibility-compute",
    "unreal-temporal-plain",
    "vkd3d-deferred-thin",
    "native-hands-bindless",
    "native-cockpit-bindless",
    "native-interface-bindless",
    "unity-effects-heaps",
    "unreal-temporal-compute",
    "unreal-temporal-compute-third",
    "unreal-temporal-copied",
    "dxvk-forward-heaps",
    "dxvk-deferred-heaps",
    "dxvk-pooled-heaps",
    "hdrp",
    "hdrp-square-dynamic",
    "unreal-deferred-compute",
    "unreal-5-vkd3d",
    "unreal-5-vkd3d-compute",
    "id-tech-7",
    "vkd3d-forward",
    "vkd3d-forward-mirror",
    "vkd3d-deferred",
];

#[test]
fn temporal_filters_of_engines_are_found_and_nothing_else() {
    let mut wrong = Vec::new();
    for graph in GRAPHS {
        let expected = match graph.name {
            name if FILTERED.contains(&name) => Feedback::Read,
            name if UNKNOWN.contains(&name) => Feedback::Unknown,
            _ => Feedback::None,
        };
        let found = feedback(graph);
        if found != expected {
            wrong.push(format!("{}: {found:?}, not {expected:?}", graph.name));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn no_texture_of_a_random_graph_becomes_coarser() {
    for seed in (0..RANDOM).chain(ONCE_WRONG) {
        for graph in [RandomGraph::new(seed), RandomGraph::new(seed).third()] {
            let score = graph.run();
            assert_eq!(score.wrong, 0, "seed {seed}: {:?} of {graph:#?}", score.wrong_names);
        }
    }
}
