//! Missing-barrier mutation tests: each barrier of ours, left out, is found by validation, or changes the image. Otherwise no finding
//! of validation would mean anything.

use parafovea::gpu::barrier::{
    ALL, APP_COMPARED_TO_RENDERED, APP_RENDERED_TO_COMPARED, APP_RENDERED_TO_SAMPLED,
    DEPTH_COPIED_TO_WRITTEN, DEPTH_WRITTEN_TO_COPIED, ImageBarrier, KEPT_DEPTH_COPIED_TO_READ,
    KEPT_DEPTH_READ_TO_COPIED, RUNTIME_DRAWN_TO_BLENDED,
};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::error::HarnessError;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Head, Scenario, ScenarioExt};

const CHROMA: &str =
    "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";
const REUSE: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";
const FOLLOW: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\nbackend = \"attachment\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";
/// In the first frames the gaze is not known yet, and images are only copied.
const FRAMES: u64 = 20;
const SAVED: [u64; 2] = [1, 18];

/// An application that runs through the layer.
#[derive(Clone, Copy, PartialEq)]
enum Work {
    /// Pictures from which colour is removed.
    Chroma,
    /// Pictures that are completed from earlier ones.
    Reuse,
    /// Images that are completed by depth from images of other poses.
    Follow,
}

impl Work {
    /// The work that a barrier is for.
    fn of(barrier: &ImageBarrier) -> Self {
        let is_one_of = |all: &[ImageBarrier]| all.iter().any(|other| other.name == barrier.name);
        if is_one_of(&[APP_RENDERED_TO_SAMPLED, APP_RENDERED_TO_COMPARED, APP_COMPARED_TO_RENDERED]) {
            Self::Reuse
        } else if is_one_of(&[DEPTH_WRITTEN_TO_COPIED, KEPT_DEPTH_READ_TO_COPIED, KEPT_DEPTH_COPIED_TO_READ])
        {
            Self::Follow
        } else {
            Self::Chroma
        }
    }

    fn run(self, change: impl FnOnce(Run) -> Run) -> Outcome {
        let (application, config) = match self {
            Self::Chroma => (Application::hello_xr("Vulkan2"), CHROMA),
            Self::Reuse => (zoo("render-pass"), REUSE),
            Self::Follow => (zoo("submitted-depth"), FOLLOW),
        };
        // Without a turn, tiles are copied from earlier pictures; with a turn, they are sampled.
        let head = |t: f64| Head {
            t,
            position: [if self == Self::Follow { 0.8 * t as f32 } else { 0.0 }, 1.6, 0.0],
            yaw_deg: 60.0 * t as f32,
            pitch_deg: 0.0,
            roll_deg: 0.0,
        };
        let scenario = Scenario::new(FRAMES).sized(128, 128).gazing(-25.0, 0.0).saving(&SAVED);
        let scenario = match self {
            Self::Chroma => scenario,
            Self::Reuse | Self::Follow => Scenario { head: vec![head(0.0), head(2.0)], ..scenario },
        };
        let run = Run::new(&application.unwrap(), &scenario).on(config).validated();
        let run = if self == Self::Follow { run.shading_rates(ShadingRateProfile::NvkTuring) } else { run };
        change(run).finish().unwrap().expect_frames(FRAMES).unwrap()
    }
}

fn zoo(style: &str) -> Result<Application, HarnessError> {
    Application::ours("parafovea-zoo", &["--style", style, "--size", "128", "--frames", "20"])
}

/// As the layer that drops barriers identifies one.
fn pattern(barrier: &ImageBarrier) -> String {
    let layouts = (barrier.old_layout.as_raw(), barrier.new_layout.as_raw());
    let stages = (barrier.src_stage.as_raw(), barrier.dst_stage.as_raw());
    format!("{},{},{},{}", layouts.0, layouts.1, stages.0, stages.1)
}

fn is_noticed(reference: &Outcome, outcome: &Outcome) -> bool {
    let differs = |frame| outcome.submitted(0, frame).unwrap() != reference.submitted(0, frame).unwrap();
    !outcome.findings.beyond(&reference.findings).is_empty() || SAVED.into_iter().any(differs)
}

#[test]
fn a_missing_barrier_is_noticed() {
    for work in [Work::Chroma, Work::Reuse, Work::Follow] {
        let reference = work.run(|run| run);
        // Most applications order draws over images themselves, and clear depth first: the layer's own mutation tests have an
        // application that does neither.
        let left_out = [RUNTIME_DRAWN_TO_BLENDED, DEPTH_COPIED_TO_WRITTEN];
        let recorded = ALL.iter().filter(|barrier| !left_out.contains(barrier));
        for barrier in recorded.filter(|barrier| Work::of(barrier) == work) {
            let outcome = work.run(|run| run.without_barrier(&pattern(barrier)));
            assert!(is_noticed(&reference, &outcome), "{} is not missed, or does not occur", barrier.name);
        }
    }
}

#[test]
fn the_layer_that_drops_barriers_does_nothing_else() {
    let reference = Work::Chroma.run(|run| run);
    // Layouts that no barrier has.
    let outcome = Work::Chroma.run(|run| run.without_barrier("0,0,1,1"));
    assert!(!is_noticed(&reference, &outcome));
}
