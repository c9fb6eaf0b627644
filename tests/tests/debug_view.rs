//! `debug.view` over the images of applications, and applications without it.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::artifacts::program;
use parafovea_tests::compare::max_difference;
use parafovea_tests::demo::EyeView;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run, Running};
use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};
use std::process::Command;
use std::time::{Duration, Instant};

const FRAMES: u64 = 24;
const LAST: u64 = FRAMES - 1;
/// Allowed distance of the middle of both eyes' fixation from the ray.
const BETWEEN_EYES_DEG: f32 = 0.15;
const NONE: &str = "preset = \"none\"\n";
/// Nothing is done, and a live edit may change that: a device without work for the layer is inert until the next start.
const ARMED: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"off\"\n";
const COLOURED: &str =
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

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
fn a_dot_straight_ahead_is_there_wherever_the_eyes_look() {
    let off = run(&scene(), NONE);
    let on = run(&scene(), &with_view(NONE, "ahead"));
    assert_valid(&on, &off);
    let views = EyeView::of_scenario(&scenario().gazing(0.0, 0.0));
    for ((view, off), on) in views.iter().zip(pictures(&off)).zip(pictures(&on)) {
        let outside = |x, y| view.eccentricity_deg(&off, x, y) > 1.3 + 0.05;
        assert_eq!(max_difference(&off, &on, outside), 0);
        let red = on.enumerate().filter(|(x, y, pixel)| !outside(*x, *y) && pixel[0] > 200).count();
        assert!(red > 5, "{red} pixels of a dot");
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
        // Bright pixels stay brighter than dark ones.
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

/// If the GPU decides, the view draws the GPU's own map, tile by tile.
#[test]
fn rates_that_the_gpu_decided_are_drawn() {
    const TILES: [u32; 2] = [16, 14];
    let scenario = Scenario::new(FRAMES).sized(256, 224).saving(&[LAST]);
    let run = Run::new(&scene(), &scenario).shading_rates(ShadingRateProfile::NvkTuring);
    let finish = |run: Run| run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let off = finish(run.clone());
    let config = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n";
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

/// An image that is submitted again without being drawn again has the dot at the current gaze.
#[test]
fn overlays_follow_the_gaze_on_resubmitted_images() {
    const SHOWN: u64 = 8;
    let mut scenario = Scenario::new(1000).sized(192, 160).saving(&(0..SHOWN).collect::<Vec<_>>());
    let gaze = |t, yaw_deg| Gaze { t, yaw_deg, pitch_deg: 0.0, tracked: true };
    scenario.gaze = vec![gaze(0.0, -15.0), gaze(0.04, -15.0), gaze(0.05, 15.0)];
    let application = Application::ours("parafovea-cases", &["own_actions_and_resubmission"]).unwrap();
    let run = |config: &str| Run::new(&application, &scenario).on(config).validated().finish().unwrap();
    let (off, on) = (run(NONE), run(&with_view(NONE, "gaze")));
    assert_valid(&on, &off);
    // The column of the middle of the pixels that differ.
    let dot = |frame| {
        let [off, on] = [&off, &on].map(|outcome| outcome.submitted(0, frame).unwrap());
        let drawn: Vec<u32> =
            off.enumerate().filter(|(x, y, pixel)| on.at(*x, *y) != *pixel).map(|(x, ..)| x).collect();
        let middle = drawn.iter().sum::<u32>() as f32 / drawn.len().max(1) as f32;
        assert!(drawn.iter().all(|x| (*x as f32 - middle).abs() < 10.0), "one dot: {drawn:?}");
        (!drawn.is_empty()).then_some(middle)
    };
    let dots: Vec<f32> = (0..SHOWN).filter_map(dot).collect();
    // To the left by 30 degrees, a third of the picture.
    assert!(dots.len() > 4 && dots[0] - dots[dots.len() - 1] > 40.0, "{dots:?}\n{}", on.log);
}

/// The views that the guide asks for, one after the other.
fn of_guide() -> Vec<&'static str> {
    let guide = include_str!("../../manifest/GUIDE.md");
    guide.lines().filter_map(|line| line.strip_prefix("$ parafovea status --view ")).collect()
}

/// The view of `parafovea status --view` is drawn until the request ends, both in images of ours and in the runtime's, and the
/// configuration stays unchanged.
#[test]
fn parafovea_status_shows_it_in_an_application_that_runs_and_takes_it_away() {
    const EVERY: u64 = 30;
    let saved: Vec<u64> = (1..200).map(|index| index * EVERY).collect();
    let scenario = Scenario::new(100_000).sized(96, 96).gazing(-10.0, 0.0).in_real_time().saving(&saved);
    for config in [ARMED, COLOURED] {
        let running = Run::new(&hello_xr(), &scenario).on(config).validated().start().unwrap();
        let newest = || saved.iter().rev().find(|frame| running.has_submitted(1, **frame)).copied();
        let wait_for = |frame| wait_until(&running, || newest() >= Some(frame));
        let ask = |view: &str| {
            let mut command = Command::new(program("parafovea").unwrap());
            command.args(["status", "--view", view, "HelloXR"]);
            let output = command.env("XDG_RUNTIME_DIR", running.runtime_folder()).output().unwrap();
            let said = [output.stdout, output.stderr].concat();
            (output.status.success(), String::from_utf8(said).unwrap())
        };
        let [shown, taken_away] = of_guide()[..] else { panic!("other commands in the guide") };
        // Colour is gone by then.
        wait_for(3 * EVERY);
        let before = newest().unwrap();
        let (is_drawn, said) = ask(shown);
        assert!(
            is_drawn && said.contains("\"eccentricity\" is visible in the headset"),
            "{said}\n{}",
            running.log()
        );
        // A picture that was begun before is saved after.
        let with = newest().unwrap() + 2 * EVERY;
        wait_for(with);
        let (is_gone, said) = ask(taken_away);
        assert!(is_gone && said.contains("no overlay"), "{said}\n{}", running.log());
        let after = newest().unwrap() + 2 * EVERY;
        wait_for(after);
        let written = std::fs::read_to_string(running.config_file()).unwrap();
        let outcome = running.quit().unwrap();
        assert_eq!(written, config);
        assert!(
            outcome.log.contains("debug.view = \"eccentricity\", requested by parafovea status"),
            "{}",
            outcome.log
        );
        let picture = |frame| outcome.submitted(0, frame).unwrap();
        let (before, with, after) = (picture(before), picture(with), picture(after));
        let same = before.enumerate().filter(|(x, y, pixel)| with.at(*x, *y) == *pixel).count();
        assert!(
            same < (before.width * before.height / 20) as usize,
            "{same} pixels without a tint\n{}",
            outcome.log
        );
        assert_eq!(max_difference(&before, &after, |_, _| true), 0, "it is gone again");
        assert_eq!(outcome.log.contains("images of the layer"), config == COLOURED, "{}", outcome.log);
        let reference = Run::new(&hello_xr(), &Scenario::new(10).sized(96, 96)).validated().finish().unwrap();
        assert_valid(&outcome, &reference);
    }
}

/// A request for a view that cannot be visible gets the reason.
#[test]
fn parafovea_status_says_why_a_view_is_not_drawn() {
    let running = Run::new(&hello_xr(), &Scenario::new(100_000).sized(96, 96)).on(COLOURED).start().unwrap();
    wait_until(&running, || running.log().contains("session active"));
    let ask = |arguments: &[&str]| {
        let mut command = Command::new(program("parafovea").unwrap());
        command.arg("status").args(arguments).env("XDG_RUNTIME_DIR", running.runtime_folder());
        let output = command.output().unwrap();
        (output.status.success(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
    };
    wait_until(&running, || ask(&["--once", "--json", "hello_xr"]).1.contains("HelloXR"));
    let (is_drawn, said) = ask(&["--view", "rates"]);
    assert!(!is_drawn && said.contains("\"rates\" is not visible: no backend on this device"), "{said}");
    let (is_drawn, said) = ask(&["--view", "gaze", "another game"]);
    assert!(!is_drawn && said.contains("no running application named another game"), "{said}");
}

fn wait_until(running: &Running, mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < Duration::from_secs(120), "{}", running.log());
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn an_edit_shows_it_in_images_of_the_runtime() {
    let saved: Vec<u64> = (1..1000).map(|index| index * 30).collect();
    let scenario = Scenario::new(100_000).sized(96, 96).gazing(14.0, -6.0).in_real_time().saving(&saved);
    let running = Run::new(&hello_xr(), &scenario).on(ARMED).start().unwrap();
    let newest = || saved.iter().rev().find(|frame| running.has_submitted(1, **frame)).copied();
    wait_until(&running, || newest() >= Some(30));
    std::fs::write(running.config_file(), with_view(ARMED, "gaze")).unwrap();
    wait_until(&running, || running.log().contains("configuration changed"));
    // A picture that was begun before is saved after.
    let with = newest().unwrap() + 60;
    wait_until(&running, || newest() >= Some(with));
    let outcome = running.quit().unwrap();
    let [before, with] = [30, with].map(|frame| outcome.submitted(0, frame).unwrap());
    let view = &EyeView::of_scenario(&scenario)[0];
    let outside = |x, y| view.eccentricity_deg(&before, x, y) > 1.3 + BETWEEN_EYES_DEG;
    assert!(!outcome.log.contains("images of the layer"), "{}", outcome.log);
    assert_eq!(max_difference(&before, &with, outside), 0, "{}", outcome.log);
    assert!(max_difference(&before, &with, |x, y| !outside(x, y)) > 50, "{}", outcome.log);
}
