//! `drop_barrier` drops exactly the barrier that is named, and validation below it notices.

use crate::process::{Ended, Process};
use parafovea_test_layers::{DROP_BARRIER_VARIABLE, DROP_FILE_VARIABLE, Dropped, TestLayer};

fn without(barrier: &str) -> (u64, Ended) {
    let process = Process::new("two_clears_with_barriers").layer(TestLayer::DropBarrier.name()).validated();
    let ended = process.env(DROP_BARRIER_VARIABLE, barrier).file(DROP_FILE_VARIABLE, "dropped.json").run();
    let dropped: Dropped = serde_json::from_str(ended.read("dropped.json").trim()).unwrap();
    (dropped.dropped, ended)
}

#[test]
fn a_barrier_that_is_not_there_leaves_all() {
    let (dropped, ended) = without("0,7,0x1,0x2000");
    assert_eq!(dropped, 0);
    assert_eq!(ended.findings, [""; 0]);
}

#[test]
fn the_older_call_loses_its_barrier() {
    // UNDEFINED, TRANSFER_DST_OPTIMAL, TOP_OF_PIPE, TRANSFER.
    let (dropped, ended) = without("0,7,0x1,0x1000");
    assert_eq!(dropped, 1);
    assert!(!ended.findings.is_empty(), "{}", ended.output);
}

#[test]
fn the_newer_call_loses_its_barrier() {
    // TRANSFER_DST_OPTIMAL, GENERAL, TRANSFER, TRANSFER.
    let (dropped, ended) = without("7,1,0x1000,0x1000");
    assert_eq!(dropped, 1);
    assert!(ended.findings.iter().any(|line| line.contains("SYNC-HAZARD")), "{:?}", ended.findings);
}
