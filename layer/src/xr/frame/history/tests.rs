use super::*;
use glam::{Quat, Vec2, Vec3};
use openxr_sys::Handle;
use parafovea_core::geometry::Fov;
use parafovea_core::reuse::STALE;

const EXTENT: [u32; 2] = [64, 32];
const FRAME_NS: i64 = 11_111_111;
const ALWAYS: fn(u64) -> bool = |_| true;

/// Picture `number` of an application that draws to five images in turn.
fn shown(number: u64) -> ShownEyeBuffer {
    let fov = Fov { left: -0.8, right: 0.8, up: 0.5, down: -0.5 };
    let extent = vk::Extent2D { width: EXTENT[0], height: EXTENT[1] };
    ShownEyeBuffer {
        substitute: 1,
        space: xr::Space::from_raw(7),
        rests: true,
        time: xr::Time::from_nanos(number as i64 * FRAME_NS),
        release: number,
        is_copied: false,
        image_index: (number % 5) as u32,
        array_layer: 0,
        rect: vk::Rect2D { offset: vk::Offset2D { x: 64, y: 0 }, extent },
        view: View {
            orientation: Quat::from_rotation_y(number as f32 * 0.01),
            plane: fov.tangents().plane(EXTENT),
        },
    }
}

fn left_half_is_stale(stale: &mut StaleTiles) {
    stale.set(EXTENT, [16, 16], &[STALE, STALE, 0, 0, STALE, STALE, 0, 0]);
}

fn nothing_is_stale(stale: &mut StaleTiles) {
    stale.clear();
}

/// A whole picture and a stale one.
fn of_two() -> History {
    let mut history = History::default();
    history.show(0, Some((&shown(1), None)), ALWAYS, nothing_is_stale);
    history.complete(0, CompletionSettings::TURNED, None, None);
    assert!(history.region(0, CompletionSettings::TURNED).is_none(), "a whole picture needs nothing");
    history.show(0, Some((&shown(2), None)), ALWAYS, left_half_is_stale);
    history
}

/// Number of earlier pictures for the newest.
fn ages(history: &History) -> usize {
    history.region(0, CompletionSettings::PAPER).unwrap().reuse.ages()
}

#[test]
fn stale_pictures_are_completed_from_earlier_ones() {
    let mut history = of_two();
    history.complete(0, CompletionSettings::PAPER, None, None);
    let region = history.region(0, CompletionSettings::PAPER).unwrap();
    assert_eq!(region.rect, shown(2).rect);
    let offset = [64, 0];
    assert_eq!(region.earlier[0], EarlierImage { app_index: 1, array_layer: 0, offset });
    let whole: Vec<_> = region.lists.full[0].iter().map(|rect| (rect.first(), rect.size())).collect();
    assert_eq!((whole, region.reuse.ages()), (vec![([0, 0], [2, 2])], 1));
    assert!(history.region(1, CompletionSettings::PAPER).is_none(), "the other eye has none");
}

#[test]
fn pictures_are_kept_as_long_as_they_can_be_used() {
    let mut history = of_two();
    for number in 3..30 {
        history.show(0, Some((&shown(number), None)), ALWAYS, left_half_is_stale);
        assert_eq!(ages(&history), (number as usize - 1).min(MAX_AGES));
    }
    history.show(0, Some((&shown(30), None)), |release| release >= 28, left_half_is_stale);
    assert_eq!(ages(&history), 2, "the application draws to the others");
    history.show(0, Some((&shown(31), None)), ALWAYS, left_half_is_stale);
    let region = history.region(0, CompletionSettings::PAPER).unwrap();
    assert_eq!(region.reuse.ages(), 3);
    assert_eq!(region.earlier[..3].iter().map(|image| image.app_index).collect::<Vec<_>>(), [0, 4, 3]);
}

#[test]
fn unrelated_pictures_begin_a_new_history() {
    let later = |ns: i64| xr::Time::from_nanos(2 * FRAME_NS + ns);
    let next = shown(3);
    for (what, picture) in [
        ("another swapchain", ShownEyeBuffer { substitute: 2, ..next }),
        ("a pause", ShownEyeBuffer { time: later(LONGEST_GAP_NS + 1), ..next }),
        ("time that runs back", ShownEyeBuffer { time: later(-1), ..next }),
    ] {
        let mut history = of_two();
        history.show(0, Some((&picture, None)), ALWAYS, left_half_is_stale);
        assert_eq!(ages(&history), 0, "{what}");
    }
    let mut history = of_two();
    history.show(0, None, ALWAYS, left_half_is_stale);
    assert!(!history.has_pictures(0), "a frame without a picture");
    history.show(0, Some((&next, None)), ALWAYS, left_half_is_stale);
    assert_eq!(ages(&history), 0);
    let mut history = of_two();
    history.show(
        0,
        Some((&ShownEyeBuffer { time: later(LONGEST_GAP_NS), ..next }, None)),
        ALWAYS,
        left_half_is_stale,
    );
    assert_eq!(ages(&history), 2, "a few frames were left out");
}

#[test]
fn rendered_tiles_are_compared() {
    let mut history = History::default();
    let still = |number: u64| ShownEyeBuffer { view: shown(1).view, ..shown(number) };
    history.show(0, Some((&still(1), None)), ALWAYS, nothing_is_stale);
    history.show(0, Some((&still(2), None)), ALWAYS, left_half_is_stale);
    history.show(0, Some((&still(3), None)), ALWAYS, left_half_is_stale);
    let everything = Watched::beyond(2.0, Vec3::NEG_Z);
    history.complete(0, CompletionSettings::TURNED, Some(&everything), None);
    let orientation = Quat::from_rotation_y(0.5);
    let region = history.changes(0, CompletionSettings::TURNED, orientation).unwrap();
    assert_eq!((region.offset, region.view.orientation), ([64, 0], orientation));
    assert_eq!((region.tiles.count(), region.tiles.with_age(2).len()), (4, 4));
    assert!(region.tiles.with_age(2).iter().all(|word| word & 0xffff >= 2), "the right half");
    // The middle of the picture is that of its four by two tiles.
    let middle = region.view.plane.direction(Vec2::new(2.0, 1.0));
    assert!(middle.truncate().length() < 1e-5, "{middle}");
    history.complete(0, CompletionSettings::TURNED, Some(&Watched::beyond(0.0, Vec3::X)), None);
    assert!(
        history.changes(0, CompletionSettings::TURNED, orientation).is_none(),
        "nothing of the left half"
    );
    history.complete(0, CompletionSettings::PAPER, Some(&everything), None);
    assert!(
        history.changes(0, CompletionSettings::PAPER, orientation).is_none(),
        "never in the paper's mode"
    );
    history.complete(0, CompletionSettings::TURNED, None, None);
    assert!(history.changes(0, CompletionSettings::TURNED, orientation).is_none());
}

/// Resolution and field of view may change: every picture has its own.
#[test]
fn another_rectangle_goes_on() {
    let mut history = of_two();
    let extent = vk::Extent2D { width: 48, height: 24 };
    let smaller = ShownEyeBuffer { rect: vk::Rect2D { extent, ..shown(3).rect }, ..shown(3) };
    history.show(0, Some((&smaller, None)), ALWAYS, left_half_is_stale);
    let region = history.region(0, CompletionSettings::TURNED).unwrap();
    assert_eq!((region.reuse.ages(), region.rect.extent), (2, extent));
}

#[test]
fn the_same_picture_again_is_no_other() {
    let mut history = of_two();
    let again = ShownEyeBuffer { time: shown(5).time, ..shown(2) };
    history.show(0, Some((&again, None)), ALWAYS, |_| panic!("it is known"));
    assert_eq!(ages(&history), 1);
    let next =
        ShownEyeBuffer { time: xr::Time::from_nanos(again.time.as_nanos() + LONGEST_GAP_NS), ..shown(3) };
    history.show(0, Some((&next, None)), ALWAYS, left_half_is_stale);
    assert_eq!(ages(&history), 2, "shown without a gap");
}

/// The runtime's picture is complete, and the application's image is not: it must not be written raw over the former.
#[test]
fn a_picture_that_returns_after_a_pause_keeps_its_stale_tiles() {
    let after_a_gap = xr::Time::from_nanos(2 * FRAME_NS + LONGEST_GAP_NS + 1);
    for (without_layer, time) in [(true, shown(4).time), (false, after_a_gap), (true, after_a_gap)] {
        let mut history = of_two();
        if without_layer {
            history.show(0, None, ALWAYS, |_| panic!("there is no picture"));
        }
        let again = ShownEyeBuffer { time, ..shown(2) };
        assert!(!history.show(0, Some((&again, None)), ALWAYS, |_| panic!("it is known")));
        history.complete(0, CompletionSettings::TURNED, None, None);
        assert_eq!(ages(&history), 0, "stale, and earlier pictures are gone");
        let next =
            ShownEyeBuffer { time: xr::Time::from_nanos(again.time.as_nanos() + FRAME_NS), ..shown(3) };
        assert!(history.show(0, Some((&next, None)), ALWAYS, left_half_is_stale));
        assert_eq!(ages(&history), 1, "it goes on");
    }
    let mut history = of_two();
    history.show(0, None, ALWAYS, |_| panic!("there is no picture"));
    let other = ShownEyeBuffer { substitute: 2, ..shown(2) };
    history.show(0, Some((&other, None)), ALWAYS, nothing_is_stale);
    assert!(history.region(0, CompletionSettings::PAPER).is_none(), "a release of another swapchain");
}

/// No pass draws while an application is paused, and its last picture is copied to each release.
#[test]
fn a_copy_has_the_stale_tiles_of_the_picture_before() {
    let mut history = of_two();
    let copy = ShownEyeBuffer { is_copied: true, ..shown(3) };
    history.show(0, Some((&copy, None)), ALWAYS, |_| panic!("nothing was drawn"));
    history.complete(0, CompletionSettings::PAPER, None, None);
    let region = history.region(0, CompletionSettings::PAPER).unwrap();
    assert_eq!(region.lists.full[1].len(), 1, "from the whole picture, two before");
    let mut history = History::default();
    history.show(0, Some((&copy, None)), ALWAYS, left_half_is_stale);
    assert_eq!(ages(&history), 0, "the picture before is unknown");
}

/// An application recentres by another reference space: this frame has stale tiles, and the head has hardly turned.
#[test]
fn a_picture_in_another_space_is_completed_without_a_turn_and_the_next_begins_anew() {
    let mut history = of_two();
    let moved = |number| ShownEyeBuffer { space: xr::Space::from_raw(8), ..shown(number) };
    let show = |history: &mut History, picture: &ShownEyeBuffer| {
        let goes_on = history.show(0, Some((picture, None)), ALWAYS, left_half_is_stale);
        history.complete(0, CompletionSettings::TURNED, None, None);
        let region = history.region(0, CompletionSettings::TURNED).unwrap();
        (goes_on, region.reuse.ages(), region.border)
    };
    let (goes_on, ages, border) = show(&mut history, &shown(3));
    assert!(goes_on && ages == 2 && border > 0.0, "{ages} {border}");
    assert_eq!(show(&mut history, &moved(4)), (false, 3, 0.0), "in the other space");
    let (goes_on, ages, border) = show(&mut history, &moved(5));
    assert!(goes_on && ages == 1 && border > 0.0, "the first of that space is left: {ages} {border}");
}

/// Two pairs of swapchains in turn: the stale tiles of a picture would be in no other.
#[test]
fn pictures_of_swapchains_in_turn_do_not_go_on() {
    let mut history = History::default();
    for number in 1..6 {
        let picture = ShownEyeBuffer { substitute: number % 2, ..shown(number) };
        assert!(!history.show(0, Some((&picture, None)), ALWAYS, nothing_is_stale));
        assert!(history.is_of(0, number % 2) && !history.is_of(0, 2));
    }
    let picture = ShownEyeBuffer { substitute: 1, ..shown(6) };
    assert!(history.show(0, Some((&picture, None)), ALWAYS, nothing_is_stale));
}
