//! The gate and the cost of frames.

use super::*;
use parafovea_manifest::config::parse;
use std::path::Path;

/// The gate looks how frames are without rates, and only where there are passes that have them.
#[test]
fn rates_are_left_off_for_a_look() {
    let application = Application::new();
    let looks = |frames: u32| -> Vec<u32> {
        crossings();
        (0..frames).for_each(|_| application.frame());
        let settings = crossings().into_iter().filter_map(|received| match received {
            Crossing::Settings { is_on, .. } => Some(is_on),
            _ => None,
        });
        // Settings are passed again, too, when times are not needed any more.
        let mut settings: Vec<u32> = settings.collect();
        settings.dedup();
        settings
    };
    assert_eq!(looks(100), [0; 0]);
    PASSES.set(2);
    let looks = looks(100);
    assert!(!looks.is_empty(), "{looks:?}");
    assert!(looks.iter().enumerate().all(|(index, is_on)| *is_on == index as u32 % 2), "{looks:?}");
}

/// On a GPU the gate gets times of passes two frames later.
#[test]
fn rates_that_take_a_gpu_longer_are_dropped() {
    for (ns, is_on) in [([5_000_000, 7_000_000], 0), ([5_000_000, 3_000_000], 1)] {
        GPU_NS.set(Some(ns));
        PASSES.set(2);
        let application = Application::new();
        crossings();
        (0..400).for_each(|_| application.frame());
        let settings = crossings().into_iter().filter_map(|received| match received {
            Crossing::Settings { is_on, .. } => Some(is_on),
            _ => None,
        });
        let settings: Vec<u32> = settings.collect();
        assert!(settings.len() > 2, "it never looked: {settings:?}");
        assert_eq!(settings.last(), Some(&is_on), "{ns:?}: {settings:?}");
    }
    GPU_NS.set(None);
}

/// Other rates are on in the next frame, although the gate has dropped the last ones; another offset of the gaze brings none back.
#[test]
fn edited_rates_are_judged_again() {
    GPU_NS.set(Some([5_000_000, 7_000_000]));
    PASSES.set(2);
    let application = Application::new();
    let session = session::find(application.session).unwrap();
    (0..400).for_each(|_| application.frame());
    let plan = &session.active.as_ref().unwrap().plan;
    assert!(!plan.has_rates());
    let edit = |edited: Config| {
        let before = session.instance.config.snapshot();
        session.instance.config.set(edited);
        plan.config_edited(&before, &session.instance.config.snapshot());
        application.frame();
        plan.has_rates()
    };
    let parsed = |text: &str| parse(Path::new("test.toml"), text).unwrap();
    assert!(!edit(parsed("[gaze]\noffset_deg = \"1, 0\"\n[debug]\nview = \"rates\"\n")));
    assert!(edit(parsed("[rates]\nperipheral = \"2x1\"\n")));
    GPU_NS.set(None);
}

/// An application with dynamic resolution holds its GPU time: rates that save time give it more pixels, and rates that cost time fewer.
#[test]
fn rates_that_give_more_pixels_are_kept() {
    for (pixels, is_on) in [([1_000_000, 1_300_000], 1), ([1_000_000, 900_000], 0), ([1_000_000; 2], 0)] {
        GPU_NS.set(Some([5_000_000; 2]));
        EYE_PIXELS.set(pixels);
        PASSES.set(2);
        let application = Application::new();
        crossings();
        (0..3000).for_each(|_| application.frame());
        let settings = crossings().into_iter().filter_map(|received| match received {
            Crossing::Settings { is_on, .. } => Some(is_on),
            _ => None,
        });
        let settings: Vec<u32> = settings.collect();
        assert!(settings.len() > 2, "it never looked: {settings:?}");
        assert_eq!(settings.last(), Some(&is_on), "{pixels:?}: {settings:?}");
    }
    EYE_PIXELS.set([0; 2]);
    GPU_NS.set(None);
}

/// Runs frames; returns the number of queries of the eye tracker in them, and of frame ends that the Vulkan half received.
fn noticed(application: &Application, frames: u32) -> [usize; 2] {
    GAZE_LOCATED.set(0);
    calls();
    (0..frames).for_each(|_| application.frame());
    [GAZE_LOCATED.get(), calls().into_iter().filter(|call| *call == "end_frame").count()]
}

#[test]
fn frames_go_by_unnoticed_while_every_technique_is_dropped() {
    GPU_NS.set(Some([5_000_000, 7_000_000]));
    PASSES.set(2);
    let application = Application::new();
    let session = session::find(application.session).unwrap();
    look(0.0);
    assert_eq!(noticed(&application, 400)[1], 400, "trials");
    session.actions.application_synchronises();
    assert_eq!(noticed(&application, 90), [90; 2], "passes are followed");
    let hz = || {
        let mut snapshot = StatusSnapshot::default();
        let active = session.active.as_ref().unwrap();
        active.plan.planner().write_status(&Config::default(), &mut snapshot);
        snapshot.frame_rate_hz
    };
    let before = hz();
    UNTRACKED_FRAMES.set(30);
    assert_eq!(noticed(&application, 1), [1; 2]);
    assert_eq!(noticed(&application, 29), [0; 2]);
    assert_eq!(noticed(&application, 1), [1; 2]);
    assert!((hz() - before).abs() < 0.1, "{} of {before} Hz", hz());
    assert_eq!(noticed(&application, 300)[1], 10);

    // A watched gaze is read in each frame.
    session.active.as_ref().unwrap().plan.sleep.wake();
    let mut watched = ConfigSnapshot::of_tests(Config::default());
    watched.is_gaze_watched = true;
    session.instance.config.set_snapshot(watched);
    assert_eq!(noticed(&application, 90), [90; 2]);
    UNTRACKED_FRAMES.set(0);
    GPU_NS.set(None);
}

/// Depth is copied for pictures that are kept, while the gate has re-use on.
#[test]
fn depth_is_needed_only_while_tiles_are_reused() {
    for (gate, is_needed) in [(RatesGate::On, true), (RatesGate::Auto, true), (RatesGate::Off, false)] {
        let application = Application::new();
        let session = session::find(application.session).unwrap();
        let mut edited = Config::default();
        edited.reuse.mode = ReuseMode::On;
        edited.rates.gate = gate;
        session.instance.config.set(edited);
        let plan = &session.active.as_ref().unwrap().plan;
        application.frame();
        assert!(!plan.needs_depth(), "no picture is kept");
        plan.keep_pictures(true);
        assert_eq!(plan.needs_depth(), is_needed, "{gate:?}");
        application.frame();
        assert!(!plan.needs_depth(), "the frame ends without pictures");
    }
}

#[test]
fn no_frame_goes_by_unnoticed_while_rates_are_on() {
    UNTRACKED_FRAMES.set(30);
    GPU_NS.set(Some([5_000_000, 3_000_000]));
    PASSES.set(2);
    let application = Application::new();
    look(0.0);
    assert_eq!(noticed(&application, 400)[1], 400);
    UNTRACKED_FRAMES.set(0);
    GPU_NS.set(None);
}

#[test]
fn a_report_has_the_stale_tiles_of_each_eye() {
    let device = VulkanDevice::of_table(vulkan_half::table(), vulkan_half::record());
    let mut report = FrameReport::default();
    let mut report_with = |rows: &[u32]| {
        STALE_WORDS.set(rows.to_vec());
        calls();
        let nothing = ShownRecord {
            views: ptr::null(),
            view_count: 0,
            flat: ptr::null(),
            flat_count: 0,
            depth: ptr::null(),
            depth_count: 0,
            skipped_frames: 0,
        };
        // SAFETY: a submission of no layers.
        unsafe { device.end_frame(&nothing, &mut report) };
        let [left, right] = &report.stale;
        assert!(left.is_empty(), "none of the left eye");
        assert_eq!(right.words(), rows);
        (right.tiles()[1], calls())
    };
    assert_eq!(report_with(&[]).1, ["end_frame"]);
    assert_eq!(report_with(&[0, 1 << 31, 5]), (3, vec!["end_frame", "stale"]), "it needs more room");
    assert_eq!(report_with(&[2]), (1, vec!["end_frame"]));
    assert_eq!(report_with(&[7, 1, 5]), (3, vec!["end_frame"]), "it has room");
}
