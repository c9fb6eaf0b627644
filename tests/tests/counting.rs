//! The counting layer sits above ours: it counts what the application shades, and nothing of what we draw.

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
}
