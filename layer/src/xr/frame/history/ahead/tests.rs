use super::*;
use crate::xr::frame::history::{History, ShownEyeBuffer};
use ash::vk;
use glam::Vec3;
use openxr_sys::{self as xr, Handle};
use parafovea_core::geometry::Fov;
use parafovea_core::reuse::{STALE, TileLists};

const EXTENT: [u32; 2] = [128, 64];
const FOV: Fov = Fov { left: -0.8, right: 0.8, up: 0.5, down: -0.5 };
/// Number of images that the application draws to in turn.
const IMAGES: u64 = 4;

/// View of frame `number`, of a head that turns by 0.02 radians a frame.
fn view(number: u64) -> planner::View {
    planner::View {
        orientation: Quat::from_rotation_y(number as f32 * 0.02),
        position: Vec3::new(0.1, 1.7, 0.0),
        fov: FOV,
    }
}

fn shown(number: u64, view: planner::View) -> ShownEyeBuffer {
    ShownEyeBuffer {
        substitute: 1,
        space: xr::Space::from_raw(7),
        rests: true,
        time: xr::Time::from_nanos(number as i64 * 11_111_111),
        release: number,
        is_copied: false,
        image_index: (number % IMAGES) as u32,
        array_layer: 0,
        rect: vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent: vk::Extent2D { width: EXTENT[0], height: EXTENT[1] },
        },
        view: View { orientation: view.orientation, plane: view.fov.tangents().plane(EXTENT) },
    }
}

/// Every third tile is fresh, others in each frame.
fn stale(number: u64) -> impl Fn(&mut StaleTiles) {
    move |tiles| {
        let map: Vec<u8> =
            (0..32).map(|tile| if (tile + number).is_multiple_of(3) { 0 } else { STALE }).collect();
        tiles.set(EXTENT, [16, 16], &map);
    }
}

/// A frame's lists, as words: of fresh, full, partial and seam tiles, and of compared tiles.
fn lists(history: &History) -> Vec<Vec<u32>> {
    let region = history.region(0, CompletionSettings::TURNED);
    let changes = history.changes(0, CompletionSettings::TURNED, Quat::IDENTITY);
    let sorted = region.iter().flat_map(|region| {
        let TileLists { fresh, full, partial, seam, .. } = region.lists;
        let of_ages = full.iter().chain(partial).chain(seam.as_flattened());
        std::iter::once(fresh).chain(of_ages).map(|list| list.words().to_vec())
    });
    let compared = changes.iter().flat_map(|changes| (1..9).map(|age| changes.tiles.with_age(age).to_vec()));
    sorted.chain(compared).collect()
}

/// Runs frames with and without tiles sorted ahead, which have to give the same lists; returns for each frame whether the sorted tiles were
/// taken. `expected` and `ended` return the expected and the actual number, view and stale tiles of that number.
fn taken(
    frames: u64,
    expected: impl Fn(u64) -> (u64, planner::View),
    ended: impl Fn(u64) -> (u64, planner::View),
) -> Vec<bool> {
    let (settings, watched) = (CompletionSettings::TURNED, Watched::beyond(2.0, Vec3::NEG_Z));
    let [mut history, mut alone] = [History::default(), History::default()];
    let mut sorted = SortedTiles::default();
    let frame = |number: u64| {
        sorted.update(|sorted| {
            let (pattern, view) = expected(number);
            let expected = Expected { settings, watched: Some(watched), view, stale: &stale(pattern) };
            history.expect(0, sorted, expected);
        });
        let (pattern, view) = ended(number);
        let is_intact = |release: u64| release + IMAGES > number;
        for history in [&mut history, &mut alone] {
            history.show(0, Some((&shown(number, view), None)), is_intact, stale(pattern));
        }
        let was_expected = sorted.eyes[0].settings.is_some();
        history.complete(0, settings, Some(&watched), Some(&mut sorted));
        let is_taken = was_expected && sorted.eyes[0].settings.is_none();
        alone.complete(0, settings, Some(&watched), None);
        assert_eq!(lists(&history), lists(&alone), "frame {number}");
        is_taken
    };
    (1..=frames).map(frame).collect()
}

#[test]
fn a_frame_that_is_as_expected_takes_what_was_worked_out() {
    let as_it_is = |number| (number, view(number));
    let taken = taken(20, as_it_is, as_it_is);
    // The first frame has no picture before it, and the first frame that gives pictures up is not predicted.
    let others: Vec<usize> = (0..20).filter(|frame| !taken[*frame]).collect();
    assert!(others.len() <= 3 && others.iter().all(|frame| *frame < 6), "{others:?}");
}

#[test]
fn a_frame_that_is_another_is_worked_out_anew() {
    let as_it_is = |number| (number, view(number));
    let turned = |number| (number, view(number + 1));
    assert!(taken(12, as_it_is, turned).iter().all(|taken| !taken), "another view");
    let with_others_stale = |number| (number + 1, view(number));
    assert!(taken(12, as_it_is, with_others_stale).iter().all(|taken| !taken), "other tiles");
    let at_times = |number| (number, view(number + number % 2));
    assert!(taken(20, as_it_is, at_times).iter().skip(8).any(|taken| *taken), "every other frame");
}

#[test]
fn tiles_are_taken_once() {
    let (settings, watched) = (CompletionSettings::TURNED, Watched::beyond(2.0, Vec3::NEG_Z));
    let mut history = History::default();
    let mut sorted = SortedTiles::default();
    for number in 1..=8 {
        sorted.update(|sorted| {
            let expected =
                Expected { settings, watched: Some(watched), view: view(number), stale: &stale(number) };
            history.expect(0, sorted, expected);
        });
        history.show(0, Some((&shown(number, view(number)), None)), |_| true, stale(number));
        history.complete(0, settings, Some(&watched), Some(&mut sorted));
    }
    let first = lists(&history);
    history.complete(0, settings, Some(&watched), Some(&mut sorted));
    assert_eq!(lists(&history), first, "sorted anew");
}
