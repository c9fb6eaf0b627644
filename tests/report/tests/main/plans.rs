//! Contents and work of a report.

use parafovea_report::hardware::hardware_points;
use parafovea_report::plan::Plan;
use parafovea_report::points::{Extent, Sweep, points};
use parafovea_tests::run::LayerMode;
use std::collections::HashSet;
use std::path::Path;

#[test]
fn the_quick_one_is_two_scenes_and_six_techniques_of_thirty_frames() {
    let plan = Plan::quick();
    assert_eq!((plan.scenes.len(), plan.timed.frames, plan.timed.size), (2, 30, 512));
    assert_eq!((plan.judged.frames, plan.judged.size, plan.fine), (30, 512, None));
    // Beside the application alone; chroma is not timed.
    assert_eq!(plan.timed_points().count(), 1 + 6);
    assert_eq!(plan.points.len(), 1 + 6 + 1);
    // Three of the techniques whose maps are judged are the layer's.
    assert_eq!(plan.runs(), 2 * (8 + 3 + 7 * 2));
    // The application alone, two render scales and these three, by each further gaze script.
    assert_eq!(Plan { scripts: 3, ..plan.clone() }.runs() - plan.runs(), 2 * 2 * 6);
}

#[test]
fn the_whole_one_is_six_scenes_and_more_of_everything() {
    let (quick, full, all) = (Plan::quick(), Plan::full(), Plan::all());
    assert_eq!((full.scenes.len(), full.timed.frames, full.timed.size), (6, 40, 640));
    assert_eq!(
        (full.judged.frames, full.judged.size),
        (15, full.timed.size),
        "one resolution for time and errors"
    );
    // Beside the application alone.
    assert_eq!(full.points.len(), 1 + 21);
    assert!(quick.work() * 10 < full.work() && full.work() < all.work());
    assert!(quick.points.iter().all(|point| full.points.contains(point)));
    assert!(full.points.iter().all(|point| all.points.contains(point)));
}

#[test]
fn every_sweep_has_four_points_and_the_application_alone_is_first() {
    let all = points(Extent::All);
    assert_eq!(all[0].sweep, Sweep::Off);
    let timed = Sweep::ALL
        .into_iter()
        .filter(|sweep| !matches!(sweep, Sweep::Off | Sweep::Uniform | Sweep::Rings | Sweep::Chroma));
    for sweep in timed {
        let own = all.iter().filter(|point| point.sweep == sweep).count();
        assert!(1 + own >= 4, "{sweep:?} has {own} points");
    }
    assert_eq!(all.iter().filter(|point| point.sweep == Sweep::FixedFoveation).count(), 9 + 3);
    let presets = all.iter().filter(|point| point.sweep == Sweep::Rates);
    for preset in presets {
        let LayerMode::On(config) = &preset.technique.layer else { panic!("{preset:?}") };
        let chosen = preset.technique.name.strip_prefix("preset ").unwrap();
        let config = config.replace("[rates]\ngate = \"on\"\n", "");
        assert_eq!(config, format!("preset = \"{chosen}\"\n"), "a user selects it by one word");
    }
    let names: HashSet<&str> = all.iter().map(|point| point.technique.name.as_str()).collect();
    assert_eq!(names.len(), all.len(), "two points have one name");
    let shaded = hardware_points(Extent::All);
    let mut all_names = names.into_iter().chain(shaded.iter().map(|point| point.name.as_str()));
    assert!(all_names.all(|name| !name.contains(',')), "--techniques has commas between names");
    for technique in all.iter().map(|point| &point.technique).filter(|technique| technique.has_layer()) {
        let LayerMode::On(config) = &technique.layer else { panic!("{technique:?}") };
        parafovea_manifest::config::parse(Path::new(&technique.name), config).unwrap();
    }
}
