//! Common properties of the three runs of a case.

use super::{Case, Finished, Gaze};
use glam::{Quat, Vec3};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::compose::{ComposeParams, compose_image};
use parafovea_tests::compare::max_difference;
use parafovea_tests::picture::Picture;
use parafovea_tests::record::Frame;
use parafovea_tests::scenario::{FovDegrees, View};
use serde_json::Value;
use std::collections::BTreeSet;

/// Code values by which GPU and CPU may round apart.
const TOLERANCE: u8 = 1;

/// The reference: its observations meet the specification, and the runtime gets the drawn images.
pub fn reference(case: &Case, run: &Finished) {
    assert_eq!(run.report.unexpected, Vec::<String>::new(), "{}", run.outcome.output);
    assert_eq!(run.outcome.exit_code, Some(0), "{}", run.outcome.output);
    assert_eq!(run.outcome.findings.vulkan_was_active, case.validated, "validation");
    let frames: Vec<u64> = run.outcome.record.frames.iter().map(|frame| frame.index).collect();
    for drawn in &run.report.pictures {
        let key = (frames[drawn.frame as usize], drawn.layer, drawn.view);
        let Some(picture) = run.pictures.get(&key) else { continue };
        let pixels = drawn.figure.pixels();
        let expected = Picture::from_fn(picture.width, picture.height, |x, y| {
            let at = ((y * drawn.figure.rect.width + x) * 4) as usize;
            pixels[at..at + 4].try_into().unwrap()
        });
        assert_same(&expected, picture, &format!("{drawn:?}"));
    }
}

/// With nothing to do the layer changes nothing, neither for the application nor for the runtime.
pub fn unchanged(case: &Case, reference: &Finished, run: &Finished) {
    same_observations(reference, run);
    same_submissions(reference, run);
    assert_eq!(created(case, reference), created(case, run), "swapchains at the runtime");
    for (key, expected) in &reference.pictures {
        assert_same(expected, &run.pictures[key], &format!("frame, layer, view {key:?}"));
    }
}

/// With pictures analysed in the runtime's images.
pub fn analyzed_in_place(case: &Case, reference: &Finished, run: &Finished) {
    analyzed(case, reference, run);
    assert!(!run.outcome.log.contains("images of the layer"), "{}", run.outcome.log);
}

/// With pictures analysed: the same observations and pictures.
pub fn analyzed(case: &Case, reference: &Finished, run: &Finished) {
    same_observations(reference, run);
    same_submissions(reference, run);
    for (key, expected) in &reference.pictures {
        assert_same(expected, &run.pictures[key], &format!("frame, layer, view {key:?}"));
    }
    let devices = run.outcome.faults().unwrap();
    let submits: u64 = devices.iter().filter_map(|device| device.own.get("vkQueueSubmit")).sum();
    assert_eq!(submits > 0, case.analyzed, "{} submits of the layer\n{}", submits, run.outcome.log);
}

/// With chroma attenuation on: the same observations, and pictures as the CPU computes them from the reference.
pub fn processed(case: &Case, reference: &Finished, run: &Finished) {
    same_observations(reference, run);
    same_submissions(reference, run);
    for (asked, made) in created(case, reference).iter().zip(&created(case, run)) {
        let is_left_alone = asked["format"] == "D32_SFLOAT" || asked["width"] == case.left_alone;
        let substituted = case.substituted && !is_left_alone;
        // A substituted swapchain is written by the layer, which needs usages that the application did not ask for.
        assert_eq!(asked["usage_flags"] != made["usage_flags"], substituted, "{asked} became {made}");
    }
    let mut known = case.gaze == Gaze::Centre;
    let mut eyes = 0;
    for (key @ (index, layer, view), picture) in &run.pictures {
        let frame = run.outcome.record.frames.iter().find(|frame| frame.index == *index).unwrap();
        let what = format!("{}: frame, layer, view {key:?}", case.name);
        let shown = case.shows.get(*index as usize).unwrap_or(index);
        let original = &reference.pictures[&(*shown, *layer, *view)];
        if !case.substituted || frame.layers[*layer as usize]["type"] != "projection" {
            assert_same(original, picture, &what);
            continue;
        }
        eyes += 1;
        known = known || original != picture;
        if known && !is_at_rest(run, frame) {
            assert_ne!(original, picture, "{what}: nothing was attenuated");
        } else if known {
            let eye = &run.scenario.views[*view as usize];
            let params = region(eye, gaze(case, frame, eye), picture);
            assert_attenuated(case, &params, original, picture, &what);
        }
    }
    assert!(known || eyes == 0, "{}: no frame was processed\n{}", case.name, run.outcome.log);
}

/// Whether the gaze was the same in the world in the two frames before. While it moves the layer is ahead of the tracker, where it
/// expects the gaze to land.
fn is_at_rest(run: &Finished, frame: &Frame) -> bool {
    let frames = run.outcome.record.frames.iter();
    let mut recent =
        frames.filter(|other| (frame.index.saturating_sub(2)..frame.index).contains(&other.index));
    let gaze =
        |frame: &Frame| frame.gaze.map(|gaze| Quat::from_array(frame.head.orientation) * Vec3::from(gaze));
    recent.all(|other| match (gaze(other), gaze(frame)) {
        (Some(before), Some(now)) => before.abs_diff_eq(now, 1e-5),
        (before, now) => before == now,
    })
}

fn same_observations(reference: &Finished, run: &Finished) {
    assert_eq!(reference.report, run.report, "{}", run.outcome.log);
    assert_eq!(run.outcome.exit_code, Some(0), "{}", run.outcome.output);
    same_unknown_structures(reference, run);
    let new = run.outcome.findings.beyond(&reference.outcome.findings);
    assert!(new.is_empty(), "validation: {new:#?}");
    let mut known: Vec<_> = errors(reference);
    for error in errors(run) {
        let at = known.iter().position(|other| *other == error);
        known.remove(at.unwrap_or_else(|| panic!("the runtime saw an error of the layer's: {error:?}")));
    }
}

/// Errors that the runtime returned. Swapchains are asked for with more usage first: their errors may come several times.
fn errors(run: &Finished) -> Vec<(String, String)> {
    let errors = &run.outcome.record.errors;
    let mut errors: Vec<_> = errors.iter().map(|error| (error.call.clone(), error.result.clone())).collect();
    errors.dedup_by(|one, other| one.0 == "xrCreateSwapchain" && one == other);
    errors
}

/// The runtime gets the structures that it does not know, and no others, in the order that the application has them in.
fn same_unknown_structures(reference: &Finished, run: &Finished) {
    let of = |run: &Finished, call: &str| -> Vec<String> {
        let warnings = run.outcome.record.warnings.iter();
        warnings.filter(|(name, _)| name == call).map(|(_, message)| message.clone()).collect()
    };
    let calls: BTreeSet<&String> = reference.outcome.record.warnings.iter().map(|(call, _)| call).collect();
    for call in calls {
        let (expected, seen) = (of(reference, call), of(run, call));
        assert!(!call.ends_with("SwapchainImage") || seen.len() <= expected.len(), "{call}: {seen:?}");
        // Images of virtual swapchains are acquired, waited for and released without the runtime.
        if !call.ends_with("SwapchainImage") {
            assert_eq!(expected, seen, "{call}");
        }
    }
}

/// The runtime gets the same layers at the same times.
fn same_submissions(reference: &Finished, run: &Finished) {
    let frames = |run: &Finished| -> Vec<(u64, i64, Value)> {
        let frames = run.outcome.record.frames.iter();
        frames.map(|frame| (frame.index, frame.display_time_ns, layers(run, frame))).collect()
    };
    assert_eq!(frames(reference), frames(run));
}

/// A frame's layers, without values that may differ between runs: the index of a swapchain's image, and handles, with a swapchain's place
/// in the order of creation in its place.
fn layers(run: &Finished, frame: &Frame) -> Value {
    let handles: Vec<&Value> =
        run.outcome.record.swapchains.iter().map(|created| &created["swapchain"]).collect();
    let mut layers = Value::Array(frame.layers.clone());
    strip(&mut layers, &handles);
    layers
}

fn strip(value: &mut Value, swapchains: &[&Value]) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| strip(item, swapchains)),
        Value::Object(members) => {
            members.retain(|name, _| name != "image" && name != "space");
            if let Some(handle) = members.get_mut("swapchain") {
                *handle = swapchains.iter().position(|other| *other == handle).into();
            }
            members.values_mut().for_each(|member| strip(member, swapchains));
        }
        _ => {}
    }
}

/// The parameters that swapchains were created with, in order, or in one that is the same in each run.
fn created(case: &Case, run: &Finished) -> Vec<Value> {
    let mut swapchains = run.outcome.record.swapchains.clone();
    for swapchain in swapchains.iter_mut().filter_map(Value::as_object_mut) {
        swapchain.retain(|name, _| name != "session" && name != "swapchain");
    }
    if !case.in_order {
        let asked = ["format", "width", "height", "array_size"];
        swapchains.sort_by_key(|swapchain| asked.map(|name| swapchain[name].to_string()));
    }
    swapchains
}

/// The layer's expected effect on the image of an eye, all of which is one region.
fn region(eye: &View, gaze: Vec3, picture: &Picture) -> ComposeParams {
    let extent = [picture.width, picture.height];
    ComposeParams::new([0, 0], extent, fov(eye), gaze, &ChromaSettings::default(), true)
}

fn assert_attenuated(case: &Case, params: &ComposeParams, original: &Picture, picture: &Picture, what: &str) {
    let mut pixels = original.pixels.as_flattened().to_vec();
    compose_image(&mut pixels, picture.width, case.format, params);
    let at = |x: u32, y: u32| ((y * picture.width + x) * 4) as usize;
    let expected =
        Picture::from_fn(picture.width, picture.height, |x, y| pixels[at(x, y)..][..4].try_into().unwrap());
    let difference = max_difference(&expected, picture, |_, _| true);
    assert!(difference <= TOLERANCE, "{what}: differs by {difference} from the CPU reference");
    for (x, y, before) in original.enumerate() {
        let after = picture.at(x, y);
        assert_eq!(before[3], after[3], "{what}: alpha at {x}, {y}");
        if params.pixel(x, y, Vec3::ZERO).is_none() {
            assert_eq!(before, after, "{what}: inside the plateau at {x}, {y}");
        }
    }
    assert_ne!(original, picture, "{what}: nothing was attenuated");
}

fn assert_same(expected: &Picture, picture: &Picture, what: &str) {
    let difference = max_difference(expected, picture, |_, _| true);
    let first = expected.enumerate().find(|(x, y, pixel)| picture.at(*x, *y) != *pixel);
    assert!(
        expected == picture,
        "{what}: differs by up to {difference}, first {first:?} is {:?}",
        first.map(|(x, y, _)| picture.at(x, y)),
    );
}

fn fov(view: &View) -> Fov {
    let FovDegrees { left, right, up, down } = view.fov_deg;
    let [left, right, up, down] = [left, right, up, down].map(f32::to_radians);
    Fov { left, right, up, down }
}

/// The direction of the gaze in a view's space: ahead of the head, or as the scenario has it at that time.
fn gaze(case: &Case, frame: &Frame, view: &View) -> Vec3 {
    let in_head = match case.gaze {
        Gaze::Centre => Vec3::NEG_Z,
        Gaze::Tracker => frame.gaze.unwrap().into(),
    };
    Quat::from_array(view.orientation).inverse() * in_head
}
