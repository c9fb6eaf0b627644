//! The counting layer sits above ours: it counts fragments of the application, and none of our draws.

use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

#[test]
fn chroma_attenuation_adds_no_fragments_of_the_application() {
    const FRAMES: u64 = 12;
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    let scenario = Scenario::new(FRAMES).sized(128, 128).saving(&[FRAMES - 1]);
    let finish = |run: Run| run.counted().finish().unwrap().expect_frames(FRAMES).unwrap();
    let off = finish(Run::new(&application, &scenario));
    let on =
        finish(Run::new(&application, &scenario).on("preset = \"none\"\n[chroma]\nmode = \"default\"\n"));

    let last = FRAMES - 1;
    assert!(off.submitted(0, last).unwrap() != on.submitted(0, last).unwrap(), "nothing was processed");
    assert!(off.fragments().unwrap() >= FRAMES * 2 * 128 * 128, "{}", off.fragments().unwrap());
    assert_eq!(off.fragments().unwrap(), on.fragments().unwrap());
    assert_eq!(off.samples().unwrap(), on.samples().unwrap());
}

/// The scene draws front to back, so few of its fragments pass the depth test and are then hidden. With its own template, each pixel is
/// either shaded or filled, by a pass of the scene's too: fragments that the template hides are not among the samples.
#[test]
fn fragments_behind_a_depth_template_are_not_among_the_samples() {
    let samples = |frames: u64, arguments: &[&str]| {
        let application = Application::ours("parafovea-scene", arguments).unwrap();
        let run = Run::new(&application, &Scenario::new(frames).sized(128, 128)).counted();
        run.finish().unwrap().expect_frames(frames).unwrap().samples().unwrap()
    };
    let pixels = 6 * 2 * 128 * 128;
    for arguments in [&[][..], &["--foveation", "0,0,1/16"]] {
        // The template itself is drawn once, in the first frame.
        let of_six_frames = samples(12, arguments) - samples(6, arguments);
        assert!((pixels..pixels * 11 / 10).contains(&of_six_frames), "{of_six_frames}, {arguments:?}");
    }
}
