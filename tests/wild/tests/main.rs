//! The wild zoo is recognised, and no texture of any graph becomes coarser.

use parafovea_wild::random::RandomGraph;
use parafovea_wild::{GRAPHS, Score, run};

/// Random graphs of a test: `cargo dev bench recognition` has 10,000.
const RANDOM: u64 = 500;

/// Seeds of graphs that had a texture coarsened while a single frame decided where a picture comes from that may be read from anything.
const ONCE_WRONG: [u64; 13] = [3389, 3958, 4223, 4441, 4732, 5265, 5288, 5912, 6781, 7058, 8091, 8485, 9606];

#[test]
fn eyes_of_the_wild_zoo_are_found_and_nothing_else() {
    let mut all = Score::default();
    for graph in GRAPHS {
        let score = run(graph);
        assert_eq!(score.wrong, 0, "{}: {:?}", graph.name, score.wrong_names);
        all += &score;
    }
    assert!(all.recall() >= 0.95, "recall {}: {:#?}", all.recall(), all.missed_names);
}

#[test]
fn no_texture_of_a_random_graph_becomes_coarser() {
    for seed in (0..RANDOM).chain(ONCE_WRONG) {
        let graph = RandomGraph::new(seed);
        let score = graph.run();
        assert_eq!(score.wrong, 0, "seed {seed}: {:?} of {graph:#?}", score.wrong_names);
    }
}
