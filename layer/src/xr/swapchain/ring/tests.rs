use super::*;
use proptest::prelude::*;
use std::collections::VecDeque;

#[test]
fn acquires_as_many_as_there_are_and_no_more() {
    let mut ring = Ring::new(3);
    assert_eq!((ring.given_out(), ring.acquire(), ring.given_out()), (0, Ok(0), 1));
    assert_eq!([ring.acquire(), ring.acquire()], [Ok(1), Ok(2)]);
    assert_eq!((ring.acquire(), ring.given_out()), (Err(CallOrderInvalid), 3));
}

#[test]
fn a_ring_shrinks_before_its_first_image_is_acquired() {
    let mut ring = Ring::new(6);
    assert_eq!([ring.shrink(6), ring.shrink(0), ring.shrink(4)], [false, false, true]);
    assert_eq!([0, 1, 2, 3].map(|_| ring.acquire().unwrap()), [0, 1, 2, 3]);
    assert_eq!(ring.acquire(), Err(CallOrderInvalid));
    assert!(!ring.shrink(3) && ring.count() == 4);
}

#[test]
fn wait_and_release_need_what_comes_before() {
    let mut ring = Ring::new(2);
    assert_eq!(ring.wait(), Err(CallOrderInvalid));
    assert_eq!(ring.release(), Err(CallOrderInvalid));
    ring.acquire().unwrap();
    ring.acquire().unwrap();
    assert_eq!(ring.release(), Err(CallOrderInvalid), "not waited for");
    ring.wait().unwrap();
    assert_eq!(ring.wait(), Err(CallOrderInvalid), "the one before is not released");
    ring.release().unwrap();
    ring.wait().unwrap();
}

#[test]
fn of_two_releases_before_a_frame_the_last_counts() {
    let mut ring = Ring::new(3);
    assert_eq!(ring.newest(), None);
    for _ in 0..2 {
        ring.acquire().unwrap();
        ring.wait().unwrap();
        ring.release().unwrap();
    }
    let newest = ring.newest().unwrap();
    assert_eq!((newest.index, newest.fresh, newest.intact), (1, true, true));
    ring.mark_shown(newest.release);
    assert!(!ring.newest().unwrap().fresh, "submitted again without a release");
}

#[test]
fn a_single_image_is_lost_once_the_application_may_draw_to_it_again() {
    let mut ring = Ring::new(1);
    ring.acquire().unwrap();
    ring.wait().unwrap();
    ring.release().unwrap();
    ring.acquire().unwrap();
    assert!(ring.newest().unwrap().intact);
    ring.wait().unwrap();
    assert!(!ring.newest().unwrap().intact);
}

/// The specification's wording, image by image.
struct Model {
    acquired: VecDeque<u32>,
    waited: Option<u32>,
    free: VecDeque<u32>,
    newest: Option<u32>,
}

proptest! {
    #[test]
    fn behaves_as_queues_of_images_would(count in 1_u32..5, calls in prop::collection::vec(0..3, 0..200)) {
        let mut ring = Ring::new(count);
        let mut model =
            Model { acquired: VecDeque::new(), waited: None, free: (0..count).collect(), newest: None };
        for call in calls {
            match call {
                0 => {
                    let expected = model.free.pop_front().ok_or(CallOrderInvalid);
                    model.acquired.extend(expected.ok());
                    prop_assert_eq!(ring.acquire(), expected);
                }
                1 => {
                    let allowed = model.waited.is_none() && !model.acquired.is_empty();
                    if allowed {
                        model.waited = model.acquired.pop_front();
                    }
                    prop_assert_eq!(ring.wait().is_ok(), allowed);
                }
                _ => {
                    let released = model.waited.take();
                    model.free.extend(released);
                    model.newest = released.or(model.newest);
                    prop_assert_eq!(ring.release().is_ok(), released.is_some());
                }
            }
            prop_assert_eq!(ring.newest().map(|newest| newest.index), model.newest);
            let overwritten = model.waited.is_some() && model.waited == model.newest;
            prop_assert_eq!(ring.newest().is_some_and(|newest| !newest.intact), overwritten);
        }
    }
}
