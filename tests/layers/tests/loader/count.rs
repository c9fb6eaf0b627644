//! `count` counts what the device itself counts, submit by submit, and validation has nothing to say to it.

use crate::process::{Ended, Process};
use parafovea_test_layers::{COUNT_FILE_VARIABLE, Count, TestLayer};

fn counted(program: &str) -> (Count, Ended) {
    let process = Process::new(program).layer(TestLayer::Count.name()).validated();
    let ended = process.file(COUNT_FILE_VARIABLE, "count.json").run();
    let count = serde_json::from_str(ended.read("count.json").trim()).unwrap();
    (count, ended)
}

/// What the device says for the whole image: all of its pixels once.
fn whole_image() -> u64 {
    let own: u64 = Process::new("triangle_with_own_query").run().result.parse().unwrap();
    assert!(own >= 256 * 256, "{own}");
    own
}

#[test]
fn counts_what_the_device_counts() {
    let (count, ended) = counted("triangle_once");
    let expected = Count {
        fragment_invocations: Some(whole_image()),
        reason: None,
        command_buffers: 1,
        draws: 1,
        queue_submits: 1,
    };
    assert_eq!(count, expected);
    assert_eq!(ended.findings, [""; 0]);
}

#[test]
fn a_buffer_that_is_submitted_again_counts_again() {
    let (count, ended) = counted("triangle_thrice_with_chained_features");
    assert_eq!(count.fragment_invocations, Some(3 * whole_image()));
    assert_eq!((count.command_buffers, count.draws, count.queue_submits), (3, 3, 3));
    assert_eq!(ended.findings, [""; 0]);
}

#[test]
fn an_application_with_its_own_queries_keeps_them() {
    let (count, ended) = counted("triangle_with_own_query");
    assert_eq!(ended.result, whole_image().to_string());
    assert_eq!(count.fragment_invocations, None);
    assert!(count.reason.unwrap().contains("itself"));
    assert_eq!(ended.findings, [""; 0]);
}

/// As the last layer of the chain too: there, the next layer is the loader itself.
#[test]
fn each_layer_works_alone() {
    for layer in TestLayer::ALL {
        let ended = Process::new("triangle_with_own_query").layer(layer.name()).run();
        assert_eq!(ended.result, whole_image().to_string(), "{}", layer.name());
    }
}
