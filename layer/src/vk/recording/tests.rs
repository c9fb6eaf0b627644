use super::*;
use crate::backend::mask::{Directions, DynamicStencil, EarlyReturnSupport};
use crate::pass_detection::{ImageKey, PassFacts, Target, Transfer, TransferKind};

fn target(image: u64) -> Target {
    Target { image: ImageKey(image), level: 0, base_layer: 0, layers: 1 }
}

fn pass(image: u64) -> Pass {
    Pass {
        colors: SmallVec::from_slice(&[target(image)]),
        resolves: SmallVec::new(),
        depth: None,
        area: [0, 0, 8, 8],
        region: [0, 0, 8, 8],
        view_mask: 0,
        facts: PassFacts::default(),
        unmasked: None,
        draws: None,
    }
}

fn transfer(from: u64, to: u64) -> Event {
    let rect = [0, 0, 8, 8];
    let (from, to) = (target(from), target(to));
    Event::Transfer(Transfer { kind: TransferKind::Copy, from, from_rect: rect, to, to_rect: rect })
}

/// The facts of the passes, in their order.
fn facts(recorded: &Recorded) -> Vec<PassFacts> {
    let passes = recorded.events.iter().filter_map(|event| match event {
        Event::Pass(pass) => Some(pass.facts),
        Event::Transfer(_) => None,
    });
    passes.collect()
}

const NOTHING: Within =
    Within { is_queried: false, clears_depth: false, writes_stencil: false, pipelines: None };
const QUERIED: Within = Within { is_queried: true, ..NOTHING };
const CLEARED: Within = Within { clears_depth: true, ..NOTHING };

const LESS: PipelineFacts = PipelineFacts {
    have_side_effects: false,
    write_stencil: false,
    dynamic_stencil: DynamicStencil { test: false, op: false },
    are_unknown: false,
    directions: Directions { less: true, greater: false },
    returns: EarlyReturnSupport { any: false, keeping_coverage: false },
};
const GREATER: PipelineFacts =
    PipelineFacts { directions: Directions { less: false, greater: true }, ..LESS };

/// Pipelines that draw in a pass: those bound in it, or, without any, the pipeline bound before.
#[test]
fn a_pipeline_stays_bound_from_one_pass_to_the_next() {
    let mut recorded = Recorded::default();
    recorded.use_pipeline(LESS);
    recorded.begin(Some(pass(1)), None, None);
    assert_eq!(recorded.pipelines(), LESS);
    recorded.end();
    recorded.begin(Some(pass(2)), None, None);
    recorded.use_pipeline(GREATER);
    assert_eq!(recorded.pipelines(), GREATER);
    recorded.end();
    recorded.begin(Some(pass(3)), None, None);
    assert_eq!(recorded.pipelines(), GREATER);
    recorded.clear();
    assert_eq!(recorded.pipelines(), PipelineFacts::default());
}

#[test]
fn facts_belong_to_their_pass_alone() {
    let mut recorded = Recorded::default();
    recorded.add(CLEARED);
    recorded.begin(Some(pass(1)), None, None);
    recorded.end();
    recorded.begin(Some(pass(2)), None, None);
    recorded.add(CLEARED);
    recorded.add(QUERIED);
    recorded.end();
    recorded.add(QUERIED);
    recorded.begin(Some(pass(3)), None, None);
    recorded.end();
    let expected = PassFacts { clears_depth_later: true, is_queried: true, ..PassFacts::default() };
    assert_eq!(facts(&recorded), [PassFacts::default(), expected, PassFacts::default()]);
}

#[test]
fn a_query_that_goes_on_covers_the_passes_within() {
    let mut recorded = Recorded { queries: 1, ..Recorded::default() };
    recorded.begin(Some(pass(1)), None, None);
    recorded.end();
    recorded.queries = 0;
    recorded.begin(Some(pass(2)), None, None);
    recorded.end();
    assert_eq!(facts(&recorded).iter().map(|facts| facts.is_queried).collect::<Vec<_>>(), [true, false]);
}

#[test]
fn secondaries_bring_their_events_in_order_and_what_they_do_within_a_pass() {
    let mut within = Recorded::default();
    within.add(CLEARED);
    let mut own = Recorded::default();
    own.begin(Some(pass(5)), None, None);
    own.end();
    own.events.push(transfer(5, 6));

    let mut primary = Recorded::default();
    primary.begin(Some(pass(1)), None, None);
    primary.execute(&within);
    primary.end();
    primary.is_conditional = true;
    primary.execute(&own);
    primary.execute(&own);
    let events: Vec<_> = primary
        .events
        .iter()
        .map(|event| match event {
            Event::Pass(pass) => {
                (pass.colors[0].image.0, pass.facts.clears_depth_later, pass.facts.is_queried)
            }
            Event::Transfer(transfer) => (transfer.to.image.0, false, false),
        })
        .collect();
    assert_eq!(
        events,
        [(1, true, false), (5, false, true), (6, false, false), (5, false, true), (6, false, false)]
    );
    assert!(!facts(&own)[0].is_queried, "the secondary itself is as it was");
}

#[test]
fn recording_again_forgets_and_keeps_the_memory() {
    let mut recorded = Recorded::default();
    for _ in 0..50 {
        recorded.begin(Some(pass(1)), None, None);
        recorded.end();
    }
    recorded.queries = 2;
    let memory = recorded.events.as_ptr();
    recorded.clear();
    assert!(recorded.events.is_empty() && !recorded.is_queried());
    for _ in 0..50 {
        recorded.begin(Some(pass(1)), None, None);
        recorded.end();
    }
    assert_eq!(recorded.events.as_ptr(), memory);
}

#[test]
fn negative_offsets_are_cut() {
    let rect =
        |x, y| vk::Rect2D { offset: vk::Offset2D { x, y }, extent: vk::Extent2D { width: 10, height: 20 } };
    assert_eq!((area(rect(3, 4)), area(rect(-3, -4))), ([3, 4, 10, 20], [0, 0, 10, 20]));
}
