//! The smallest report that is measured: that all parts meet, not how fast anything is.

use parafovea_report::measure;
use parafovea_report::pictures::Pictures;
use parafovea_report::plan::Plan;
use parafovea_report::points::{Extent, Sweep, points};
use parafovea_scene::scene::SceneName;
use parafovea_tests::measure::Effort;

#[test]
fn a_scene_is_measured_from_runs_to_results() {
    let wanted = ["off", "render scale 0.5", "preset balanced", "chroma"];
    let points =
        points(Extent::All).into_iter().filter(|point| wanted.contains(&point.technique.name.as_str()));
    let timed = Effort { turns: 2, run_up: 60, frames: 4, size: 64 };
    let plan = Plan {
        scenes: vec![SceneName::Courtyard],
        points: points.collect(),
        timed,
        judged: Effort { turns: 1, ..timed },
        ..Plan::quick()
    };
    let folder = tempfile::tempdir().unwrap();
    let mut pictures = Pictures::new(folder.path()).unwrap();
    let (results, _) = measure(&plan, "cargo dev report", &mut pictures).unwrap();

    let [scene] = &results.scenes[..] else { panic!("not one scene") };
    let point = |name: &str| scene.point(name).unwrap();
    for name in ["off", "render scale 0.5", "preset balanced"] {
        assert_eq!(point(name).cost.as_ref().unwrap().frames_ms.len(), 4, "{name}");
    }
    assert!(point("off").errors.is_none() && point("chroma").cost.is_none());
    let half = point("render scale 0.5");
    let fewer = half.fragments as f64 / point("off").fragments as f64;
    assert!((0.15..0.6).contains(&fewer), "at half the scale {fewer} of the fragments are left");
    assert!(half.loss() > 0.0, "half the pixels lose nothing");
    let chroma = point("chroma").errors.as_ref().unwrap();
    assert!(chroma.chroma.unwrap() > 0.0, "no colour was lost");
    let jpeg: Vec<&str> = scene.bits.iter().map(|bits| bits.codec.as_str()).collect();
    assert_eq!(jpeg[..2], ["JPEG 4:2:0", "JPEG 4:4:4"]);
    assert!(scene.bits.iter().all(|bits| bits.chroma < 0.0), "{:?}", scene.bits);
    assert!(pictures.data_uri("courtyard", "off", "seen").is_some());
    assert!(pictures.data_uri("courtyard", "preset balanced", "map").is_some(), "rates have no map");
    let [shaded] = &results.hardware[..] else { panic!("not one scene by the look of hardware rates") };
    let share = |name: &str| shaded.point(name).unwrap().cost.as_ref().unwrap().ratio;
    assert!(share("FR L3-C3 of the paper") < share("FR L1-C1 of the paper") && share("off") == 1.0);
    assert!(share("preset balanced") < 1.0 && share("render scale 0.5") == 0.25);
    let lost = |name: &str| shaded.point(name).unwrap().loss();
    assert!(lost("FR L3-C3 of the paper") > lost("FR L1-C1 of the paper") && lost("preset balanced") > 0.0);
    assert!(!results.hard_cases.is_empty() && scene.sweep(Sweep::Rates).len() == 2);
}
