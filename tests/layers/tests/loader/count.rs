//! `count` counts as the device does, submit by submit, `samples` counts samples that pass the depth test, and validation reports nothing
//! for either.

use crate::device::SIDE;
use crate::process::{Ended, Process};
use parafovea_test_layers::{
    COUNT_FILE_VARIABLE, Count, Counted, GpuTimes, SAMPLES_FILE_VARIABLE, SampleCount, TIMES_FILE_VARIABLE,
    TestLayer,
};

fn counted(program: &str) -> (Count, Ended) {
    let process = Process::new(program).layer(TestLayer::Count.name()).validated();
    let ended = process.file(COUNT_FILE_VARIABLE, "count.json").run();
    let count = serde_json::from_str(ended.read("count.json").trim()).unwrap();
    (count, ended)
}

/// The device's count for the whole image: all of its pixels once.
fn whole_image() -> u64 {
    let own: u64 = Process::new("triangle_with_own_query").run().result.parse().unwrap();
    assert!(own >= 256 * 256, "{own}");
    own
}

#[test]
fn counts_what_the_device_counts() {
    let (count, ended) = counted("triangle_once");
    let [submit] = count.by_submit[..] else { panic!("not one submit: {count:?}") };
    assert!(submit.process_cpu_ns > 0);
    let expected = Count {
        by_submit: vec![Counted { value: whole_image(), ..submit }],
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
    assert!(count.by_submit.iter().all(|submit| submit.value == whole_image()), "{count:?}");
    assert!(count.by_submit.is_sorted_by_key(|submit| submit.process_cpu_ns) && count.by_submit.len() == 3);
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

fn samples(program: &str) -> (SampleCount, Ended) {
    let process = Process::new(program).layer(TestLayer::Count.name()).layer(TestLayer::Samples.name());
    let ended = process.validated().file(SAMPLES_FILE_VARIABLE, "samples.json").run();
    let count = serde_json::from_str(ended.read("samples.json").trim()).unwrap();
    (count, ended)
}

const PIXELS: u64 = SIDE as u64 * SIDE as u64;

#[test]
fn samples_are_those_that_pass_the_depth_test() {
    for (program, passed, passes) in [
        ("triangle_once", PIXELS, 1),
        ("triangle_thrice_with_chained_features", 3 * PIXELS, 3),
        ("half_a_triangle", 2 * PIXELS / 2, 2),
    ] {
        let (count, ended) = samples(program);
        assert_eq!((count.samples, count.reason, count.passes), (Some(passed), None, passes), "{program}");
        assert_eq!(count.by_submit.iter().map(|submit| submit.value).sum::<u64>(), passed, "{program}");
        assert_eq!(ended.findings, [""; 0]);
    }
}

#[test]
fn an_application_with_its_own_occlusion_queries_keeps_them() {
    let (count, ended) = samples("triangle_with_own_occlusion_query");
    assert_eq!((count.samples, count.passes), (None, 0));
    assert!(count.reason.unwrap().contains("itself"));
    assert_eq!(ended.findings, [""; 0]);
}

/// Without `count` above, no pass is the application's.
#[test]
fn samples_of_passes_that_are_not_the_applications_are_not_counted() {
    let process = Process::new("triangle_once").layer(TestLayer::Samples.name());
    let ended = process.file(SAMPLES_FILE_VARIABLE, "samples.json").run();
    let count: SampleCount = serde_json::from_str(ended.read("samples.json").trim()).unwrap();
    assert_eq!((count.samples, count.reason, count.passes), (Some(0), None, 0));
}

/// Reason for `samples`: a driver may count invocations that its early depth test then rejects, as lavapipe 22.3.6 does; 25.0.7 does not.
/// The blocks are made of whole quads, so there is nothing between.
#[test]
fn invocations_may_have_what_is_hidden_in_them() {
    let half: u64 = Process::new("half_a_triangle_with_own_query").run().result.parse().unwrap();
    assert!([whole_image(), whole_image() / 2].contains(&half), "{half} of {}", whole_image());
}

/// As the last layer of the chain too: there, the next layer is the loader itself.
#[test]
fn each_layer_works_alone() {
    // Planted costs run no command: nothing is drawn.
    for layer in TestLayer::ALL.into_iter().filter(|layer| *layer != TestLayer::Costs) {
        let ended = Process::new("triangle_with_own_query").layer(layer.name()).run();
        assert_eq!(ended.result, whole_image().to_string(), "{}", layer.name());
    }
}

/// Each submit of each command buffer is timed, between the process's CPU times around it.
#[test]
fn times_are_of_each_submit() {
    for (program, submits) in [("triangle_once", 1), ("triangle_thrice_with_chained_features", 3)] {
        let process = Process::new(program).layer(TestLayer::Times.name()).validated();
        let ended = process.file(TIMES_FILE_VARIABLE, "times.json").run();
        let times: GpuTimes = serde_json::from_str(ended.read("times.json").trim()).unwrap();
        assert_eq!((times.buffers.len(), times.reason), (submits, None), "{program}");
        // A triangle over 256 x 256 pixels takes no CPU a microsecond, nor a minute.
        assert!(times.buffers.iter().all(|time| (1_000..60_000_000_000).contains(&time.gpu_ns)));
        assert!(times.buffers.is_sorted_by(|before, after| before.process_cpu_ns < after.process_cpu_ns));
        assert_eq!(ended.findings, [""; 0]);
    }
}
