//! Pictures that are late: the runtime has no free image in time.

use parafovea_mock_runtime::record::{Layer, ProjectionView};
use parafovea_tests::record::Frame;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Head, Scenario, ScenarioExt};

const FRAMES: u64 = 12;
/// The first wait of the layer is without a limit, and has number 0.
const LATE: usize = 6;
const CHROMA: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n";

fn run(config: Option<&str>) -> Outcome {
    let mut scenario = Scenario::new(FRAMES).sized(128, 96);
    scenario.swapchain.wait_timeouts = vec![LATE as u64];
    let head = |t: f64, yaw_deg: f32| Head { t, yaw_deg, ..Head::default() };
    scenario.head = vec![head(0.0, 0.0), head(1.0, 100.0)];
    let application = Application::ours("parafovea-scene", &["--depth-layer"]).unwrap();
    let run = Run::new(&application, &scenario);
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    run.finish().unwrap().expect_frames(FRAMES).unwrap()
}

fn views(frame: &Frame) -> Vec<ProjectionView> {
    match serde_json::from_value(frame.layers[0].clone()).unwrap() {
        Layer::Projection { views, .. } => views,
        other => panic!("{other:?}"),
    }
}

/// Else the runtime turns the old picture by the head's turn to the new pose, and the world jumps.
#[test]
fn an_earlier_picture_is_shown_with_its_own_pose_and_without_the_new_depth() {
    let (off, on) = (run(None), run(Some(CHROMA)));
    assert_eq!(on.record.errors, [], "{}", on.log);
    for (index, (without, with)) in off.record.frames.iter().zip(&on.record.frames).enumerate() {
        let is_late = index == LATE;
        let expected = views(if is_late { &off.record.frames[index - 1] } else { without });
        let before = (index > 0).then(|| views(&on.record.frames[index - 1]));
        for (eye, (expected, seen)) in expected.iter().zip(views(with)).enumerate() {
            let name = format!("eye {eye} of frame {index}");
            let turn = |a: f32, b: f32| (a - b).abs();
            let (a, b) = (expected.pose.orientation, seen.pose.orientation);
            assert!(a.iter().zip(b).all(|(a, b)| turn(*a, b) < 1e-6), "{name}: {b:?} instead of {a:?}");
            assert_eq!((seen.fov, seen.pose.position), (expected.fov, expected.pose.position), "{name}");
            assert_eq!(seen.depth.is_some(), !is_late, "{name}");
            let is_same_picture = before.as_ref().is_some_and(|before| before[eye].image == seen.image);
            assert_eq!(is_same_picture, is_late, "{name}");
        }
    }
}
