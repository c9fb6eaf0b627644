//! Programs with the layer as the only layer above Mesa's real drivers: any layer below ours hides how the loader ends a
//! chain of calls.

use parafovea_tests::drivers::ShimDevice;
use parafovea_tests::installation::Driver;
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::time::Duration;

const FRAMES: u64 = 8;

#[test]
fn render_pass_on_navi31() {
    let arguments = ["--style", "render-pass", "--size", "64", "--frames", "8"];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let run = Run::new(&application, &Scenario::new(FRAMES).sized(64, 64));
    let run = run.driver(Driver::Shim(ShimDevice::Navi31)).on("").timeout(Duration::from_secs(30));
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    assert!(outcome.log.contains("rate attachments: Offer"), "{}", outcome.log);
}
