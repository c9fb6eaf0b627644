//! What `debug.view` draws over the pictures of applications, and where it does not.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::compare::max_difference;
use parafovea_tests::demo::EyeView;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 24;
const LAST: u64 = FRAMES - 1;
/// How far the middle of what both eyes look at may be from the ray.
const BETWEEN_EYES_DEG: f32 = 0.15;
const NONE: &str = "preset = \"none\"\n";

fn scenario() -> Scenario {
    Scenario::new(FRAMES).sized(320, 288).gazing(14.0, -6.0).saving(&[LAST])
}

fn hello_xr() -> Application {
    Application::hello_xr("Vulkan2").unwrap()
}

fn scene() -> Application {
    Application::ours("parafovea-scene", &["--still"]).unwrap()
}

fn run(application: &Application, config: &str) -> Outcome {
    let run = Run::new(application, &scenario()).on(config).validated();
    run.finish().unwrap().expect_frames(FRAMES).unwrap()
}

fn with_view(config: &str, view: &str) -> String {
    format!("{config}[debug]\nview = \"{view}\"\n")
}

/// Of both eyes.
fn pictures(outcome: &Outcome) -> [Picture; 2] {
    [0, 1].map(|view| outcome.submitted(view, LAST).unwrap())
}

fn assert_valid(outcome: &Outcome, reference: &Outcome) {
    let new = outcome.findings.beyond(&reference.findings);
    assert!(new.is_empty(), "{new:#?}");
}

#[test]
fn the_dot_is_where_the_eyes_look_and_nowhere_else() {
    for application in [hello_xr(), scene()] {
        let off = run(&application, NONE);
        let on = run(&application, &with_view(NONE, "gaze"));
        assert_valid(&on, &off);
        let views = EyeView::of_scenario(&scenario());
        for ((view, off), on) in views.iter().zip(pictures(&off)).zip(pictures(&on)) {
            // The line around the dot ends at 1.3 degrees.
            let outside = |x, y| view.eccentricity_deg(&off, x, y) > 1.3 + BETWEEN_EYES_DEG;
            assert_eq!(max_difference(&off, &on, outside), 0, "{}", application.name());
            let red = on.enumerate().filter(|(x, y, pixel)| !outside(*x, *y) && pixel[0] > 200).count();
            assert!(red > 5, "{red} pixels of a dot");
        }
    }
}

#[test]
fn angles_are_drawn_over_all_of_the_scene_and_leave_it_visible() {
    let off = run(&scene(), NONE);
    let on = run(&scene(), &with_view(NONE, "eccentricity"));
    assert_valid(&on, &off);
    let views = EyeView::of_scenario(&scenario());
    for ((view, off), on) in views.iter().zip(pictures(&off)).zip(pictures(&on)) {
        let (mut lines, mut same) = (0, 0);
        for (x, y, pixel) in off.enumerate() {
            let angle = view.eccentricity_deg(&off, x, y);
            let is_line =
                angle > 5.0 && (angle - (angle / 10.0).round() * 10.0).abs() < 0.2 - BETWEEN_EYES_DEG;
            if is_line {
                lines += 1;
                assert!(on.at(x, y)[..3].iter().all(|value| *value > 200), "{angle} degrees at {x}, {y}");
            }
            same += u32::from(on.at(x, y) == pixel);
        }
        assert!(lines > 100, "{lines}");
        assert!(same < off.width * off.height / 50, "{same} pixels without a tint");
        // What is bright stays brighter than what is dark.
        let is_line = |x, y| {
            let angle = view.eccentricity_deg(&off, x, y);
            (angle - (angle / 10.0).round() * 10.0).abs() < 0.2 + BETWEEN_EYES_DEG
        };
        let plain: Vec<_> = off.enumerate().filter(|(x, y, _)| !is_line(*x, *y)).collect();
        let mut pairs = 0;
        for ((x, y, bright), (u, v, dark)) in plain.iter().zip(&plain[7..]) {
            if bright[..3].iter().zip(dark).all(|(bright, dark)| *bright > dark.saturating_add(60)) {
                pairs += 1;
                assert!(on.at(*x, *y)[2] > on.at(*u, *v)[2], "{x}, {y} and {u}, {v}");
            }
        }
        assert!(pairs > 10, "{pairs}");
    }
}

/// Whether any pixel of each tile of 16 x 16 differs.
fn drawn_tiles(off: &Picture, on: &Picture) -> Vec<bool> {
    let columns = off.width.div_ceil(16);
    let mut drawn = vec![false; (columns * off.height.div_ceil(16)) as usize];
    for (x, y, pixel) in off.enumerate() {
        drawn[(y / 16 * columns + x / 16) as usize] |= on.at(x, y) != pixel;
    }
    drawn
}

const MASKS: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\nbackend = \"mask\"\ngate = \"on\"\n";

#[test]
fn rates_have_colours_outside_of_the_fovea() {
    let off = run(&scene(), MASKS);
    let on = run(&scene(), &with_view(MASKS, "rates"));
    assert_valid(&on, &off);
    let straight = Scenario { ..scenario() }.gazing(0.0, 0.0);
    let views = EyeView::of_scenario(&straight);
    for ((view, off), on) in views.iter().zip(pictures(&off)).zip(pictures(&on)) {
        // rates.foveal_deg, to the corner of a tile; and the coarsest.
        let angle = |x, y| view.eccentricity_deg(&off, x, y);
        assert_eq!(max_difference(&off, &on, |x, y| angle(x, y) < 14.0), 0);
        let far: Vec<_> = off.enumerate().filter(|(x, y, _)| angle(*x, *y) > 33.0).collect();
        let changed = far.iter().filter(|(x, y, pixel)| on.at(*x, *y) != *pixel).count();
        assert!(changed > 1000 && changed * 50 > far.len() * 49, "{changed} of {}", far.len());
    }
}

#[test]
fn ages_are_of_tiles_that_were_not_rendered() {
    let reuse =
        format!("{MASKS}[reuse]\nmode = \"on\"\nperiods = \"11223\"\n").replace("\"fixed\"", "\"off\"");
    let off = run(&scene(), &reuse);
    let on = run(&scene(), &with_view(&reuse, "age"));
    assert_valid(&on, &off);
    for (off, on) in pictures(&off).iter().zip(&pictures(&on)) {
        let drawn = drawn_tiles(off, on);
        let share = drawn.iter().filter(|tile| **tile).count() as f64 / drawn.len() as f64;
        // Regions of period 1 are always new; of the others a half to two thirds are old.
        assert!((0.2..0.8).contains(&share), "{share} of the tiles are old");
        let middle = drawn[drawn.len() / 2 + 10];
        assert!(!middle, "the middle is old");
    }
}

/// Where the GPU decides, it is its own map that is drawn, tile by tile.
#[test]
fn rates_that_the_gpu_decided_are_drawn() {
    const TILES: [u32; 2] = [16, 14];
    let scenario = Scenario::new(FRAMES).sized(256, 224).saving(&[LAST]);
    let run = Run::new(&scene(), &scenario).shading_rates(ShadingRateProfile::Layered16);
    let finish = |run: Run| run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let off = finish(run.clone());
    let config = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"strict\"\ngate = \"on\"\n";
    let on = finish(run.on(&with_view(config, "rates")));
    let mut passes = on.shading_rates().unwrap().into_iter().filter_map(|line| match line {
        ShadingRateLine::Pass(pass) if pass.formats == ["R8G8B8A8_SRGB"] => pass.map,
        _ => None,
    });
    // The passes of the right eye come last.
    let texels = passes.next_back().unwrap().texels.unwrap();
    let map: Vec<bool> = (0..texels.len() / 2).map(|tile| &texels[2 * tile..2 * tile + 2] != "00").collect();
    assert_eq!(map.len(), (TILES[0] * TILES[1]) as usize);
    let drawn = drawn_tiles(&off.submitted(1, LAST).unwrap(), &on.submitted(1, LAST).unwrap());
    assert!(map.contains(&true) && map.contains(&false), "{}", on.log);
    assert_eq!(drawn, map, "{}", on.log);
}

#[test]
fn an_edit_shows_it_where_images_are_ours_and_the_log_says_so_where_not() {
    let running = Run::new(&scene(), &Scenario::new(100_000).sized(128, 128)).on(NONE).start().unwrap();
    let begin = std::time::Instant::now();
    let wait_for = |is_so: &dyn Fn() -> bool| {
        while !is_so() {
            assert!(begin.elapsed().as_secs() < 120, "{}", running.log());
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    };
    wait_for(&|| running.log().contains("session active"));
    std::thread::sleep(std::time::Duration::from_millis(500));
    std::fs::write(running.config_file(), with_view(NONE, "rates")).unwrap();
    wait_for(&|| running.log().contains("debug.view is not drawn"));
}
