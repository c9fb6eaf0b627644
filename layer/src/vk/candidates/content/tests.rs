use super::*;
use crate::pass_detection::{Eyes, Orientation};
use ash::vk::Handle;
use parafovea_core::reuse::STALE;

const QUEUE: u64 = 1;
const AREA: [u32; 4] = [0, 0, 100, 50];

fn part(rect: [f32; 4]) -> Part {
    Part { eyes: Eyes::Left, layer: 0, rect, orientation: Orientation::Upright }
}

fn full() -> [Part; 1] {
    [part([0.0, 0.0, 1.0, 1.0])]
}

fn note(content: &mut Content, frame: u64, area: [u32; 4], parts: &[Part]) {
    content.note(vk::Queue::from_raw(QUEUE), frame, area, parts);
}

/// Of a plan in which the first of two tiles is stale.
fn uploaded(content: &mut Content, plan: u64) {
    let mut stale = StaleTiles::default();
    stale.set([100, 50], [64, 64], &[STALE, 0]);
    let (_, parts) = content.whole();
    content.uploaded(plan, &parts, [&stale; 2]);
}

#[test]
fn unknown_passes_cost_one_upload_and_matched_ones_follow_the_plan() {
    let mut content = Content::default();
    note(&mut content, 1, AREA, &[]);
    assert_eq!(content.need(0), Need::Initialise);
    uploaded(&mut content, 0);
    for frame in 2..5 {
        note(&mut content, frame, AREA, &[]);
        assert_eq!(content.need(frame), Need::None, "1x1 does not change with the plan");
    }
    note(&mut content, 5, AREA, &full());
    assert_eq!(content.need(5), Need::Upload);
    assert_eq!(content.whole(), (AREA, full()[..].into()));
    uploaded(&mut content, 5);
    note(&mut content, 5, AREA, &full());
    assert_eq!((content.need(5), content.need(6)), (Need::None, Need::Upload));
    uploaded(&mut content, 6);
    note(&mut content, 6, AREA, &[]);
    note(&mut content, 7, AREA, &[]);
    assert_eq!(content.need(6), Need::Upload, "back to 1x1");
    assert!(content.whole().1.is_empty());
    uploaded(&mut content, 6);
    assert_eq!(content.need(9), Need::None);
}

#[test]
fn two_halves_drawn_by_two_passes_are_one_map() {
    let mut content = Content::default();
    note(&mut content, 1, [0, 0, 50, 50], &full());
    note(&mut content, 1, [50, 0, 50, 50], &full());
    let (area, parts) = content.whole();
    assert_eq!(area, AREA);
    assert_eq!(parts.as_slice(), [part([0.0, 0.0, 0.5, 1.0]), part([0.5, 0.0, 0.5, 1.0])]);
    uploaded(&mut content, 1);
    note(&mut content, 2, [0, 0, 50, 50], &full());
    assert_eq!(content.need(1), Need::None, "the other half of the last frame is kept");
    assert_eq!(content.whole().1.len(), 2);
}

#[test]
fn a_render_area_that_moves_leaves_nothing_behind() {
    let mut content = Content::default();
    for frame in 1..10 {
        let area = [0, 0, 40 + frame as u32, 30];
        note(&mut content, frame, area, &full());
        assert_eq!(content.whole(), (area, full()[..].into()));
        assert_ne!(content.need(0), Need::None);
        uploaded(&mut content, 0);
    }
}

#[test]
fn an_unknown_pass_over_the_scene_sets_1x1() {
    let mut content = Content::default();
    note(&mut content, 1, AREA, &full());
    note(&mut content, 1, [10, 10, 5, 5], &[]);
    assert!(content.whole().1.is_empty());
    let mut beside = Content::default();
    note(&mut beside, 1, AREA, &full());
    note(&mut beside, 1, [100, 0, 5, 5], &[]);
    assert_eq!(beside.whole().1.len(), 1);
}

#[test]
fn many_rectangles_are_too_many() {
    let mut content = Content::default();
    for x in 0..20 {
        note(&mut content, 1, [x * 10, 0, 10, 10], &full());
    }
    assert!(content.whole().1.is_empty());
}

#[test]
fn stale_tiles_are_known_for_shown_eyes() {
    let mut content = Content::default();
    note(&mut content, 1, AREA, &full());
    assert!(!content.has_stale_tiles());
    uploaded(&mut content, 1);
    let [left, right] = content.stale();
    assert!(left.is_stale([0, 0]) && !left.is_stale([1, 0]) && right.is_empty());
    note(&mut content, 2, AREA, &[Part { eyes: Eyes::Finer, ..full()[0] }]);
    note(&mut content, 3, AREA, &[Part { eyes: Eyes::Finer, ..full()[0] }]);
    uploaded(&mut content, 1);
    assert!(content.stale().iter().all(|stale| stale.is_stale([0, 0])));
    note(&mut content, 3, [10, 10, 5, 5], &[]);
    assert_eq!(content.need(1), Need::Upload);
    uploaded(&mut content, 1);
    assert!(!content.has_stale_tiles(), "something else is drawn over it");
}

#[test]
fn a_target_on_two_queues_is_written_once_more_to_shade_all() {
    let mut content = Content::default();
    note(&mut content, 1, AREA, &full());
    content.uploaded(1, &full(), [&StaleTiles::default(); 2]);
    assert_eq!(content.need(2), Need::Upload);
    content.note(vk::Queue::from_raw(2), 2, AREA, &full());
    assert_eq!(content.need(2), Need::Upload);
    content.uploaded(2, &[], [&StaleTiles::default(); 2]);
    assert_eq!(content.need(3), Need::None);
    let mut content = Content::default();
    note(&mut content, 1, AREA, &full());
    uploaded(&mut content, 1);
    content.note(vk::Queue::from_raw(2), 2, AREA, &full());
    assert_eq!(content.need(1), Need::Upload);
    assert!(content.whole().1.is_empty());
    uploaded(&mut content, 1);
    assert_eq!((content.need(2), content.has_stale_tiles()), (Need::None, false));
}

/// As while a game loads on a queue of its own. A target that changes its queue again and again stays at 1x1 for longer each time.
#[test]
fn a_target_on_one_queue_again_is_shaded_coarsely_again() {
    let mut content = Content::initialised();
    let mut frames = 1..;
    let mut next = |queue: u64| {
        let frame = frames.next().unwrap();
        content.note(vk::Queue::from_raw(queue), frame, AREA, &full());
        let need = content.need(frame);
        uploaded(&mut content, frame);
        (need, content.shows_scene())
    };
    assert_eq!([next(QUEUE), next(QUEUE)], [(Need::Upload, true); 2]);
    for frames in [120, 480] {
        assert_eq!(next(2), (Need::Upload, false), "1x1 now");
        for _ in 0..10 {
            assert_eq!([next(QUEUE), next(2)], [(Need::None, false); 2], "by turns");
        }
        for frame in 1..frames {
            assert_eq!(next(2), (Need::None, false), "frame {frame} of one queue");
        }
        assert_eq!([next(2), next(2)], [(Need::Upload, true); 2], "whichever queue it is");
        assert_eq!(next(QUEUE), (Need::Upload, false));
        let ended = (0..2 * frames).find(|_| next(QUEUE).1);
        assert_eq!(ended, Some(2 * frames - 1));
    }
}

#[test]
fn an_unchanged_map_is_not_uploaded() {
    let mut content = Content::initialised();
    let (some, others): (Texels, Texels) = (Arc::new(vec![STALE, 0]), Arc::new(vec![0, STALE]));
    let (half, area) = ([part([0.0, 0.0, 0.5, 1.0])], [0, 0, 50, 50]);
    assert!(content.resolve(AREA, &full(), &some));
    assert!(!content.resolve(AREA, &full(), &some));
    assert!(!content.resolve(AREA, &full(), &Arc::new(some.to_vec())), "another object");
    assert_eq!(content.texels(), *some);
    assert!(content.resolve(AREA, &full(), &others), "other texels");
    assert!(content.resolve(AREA, &half, &others), "other pictures");
    assert!(content.resolve(area, &half, &others), "another area");
    content.lose();
    assert!(content.resolve(area, &half, &others), "it never got there");
    assert!(!content.is_of_nothing() && content.resolve(area, &[], &some) && content.is_of_nothing());
    content.lose();
    assert!(!content.is_of_nothing());
}

/// As in a device that is out of memory for one submit.
#[test]
fn a_map_whose_upload_failed_is_uploaded_again() {
    let mut content = Content::default();
    note(&mut content, 1, AREA, &[]);
    assert_eq!(content.need(0), Need::Initialise);
    uploaded(&mut content, 0);
    content.upload_failed();
    assert_eq!(content.need(0), Need::Initialise, "it has no content yet");
    uploaded(&mut content, 0);
    assert_eq!(content.need(0), Need::None);
    note(&mut content, 2, AREA, &full());
    uploaded(&mut content, 1);
    note(&mut content, 3, AREA, &[]);
    note(&mut content, 4, AREA, &[]);
    assert_eq!(content.need(1), Need::Upload, "back to 1x1");
    uploaded(&mut content, 1);
    content.upload_failed();
    assert_eq!(content.need(1), Need::Upload, "it is still coarse");
    uploaded(&mut content, 1);
    assert_eq!(content.need(1), Need::None);
}

/// A recording without a fill is given no coarse tiles as long as it is submitted.
#[test]
fn passes_without_a_fill_are_known_by_frame() {
    let mut content = Content::initialised();
    let noted = |content: &mut Content, frame, is_unfilled| {
        note(content, frame, AREA, &full());
        content.note_fill(frame, is_unfilled);
        let found = (content.is_unfilled(), content.need(0));
        uploaded(content, 0);
        found
    };
    assert_eq!(noted(&mut content, 1, false), (false, Need::Upload));
    assert_eq!(noted(&mut content, 2, false), (false, Need::None));
    assert_eq!(noted(&mut content, 3, true), (true, Need::Upload));
    assert_eq!(noted(&mut content, 3, false), (true, Need::None), "the other one of the frame is not");
    assert_eq!(noted(&mut content, 4, true), (true, Need::None));
    assert_eq!(noted(&mut content, 5, false), (false, Need::Upload));
}
