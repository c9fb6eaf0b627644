//! Frames whose structure is remembered have the roles that they would have if it were not.

use super::{Remembered, Role};
use crate::pass_detection::recognition::tests::application::*;
use crate::pass_detection::recognition::tests::random::{any_event, any_images, any_shown};
use crate::pass_detection::*;
use proptest::prelude::*;

fn roles(recognition: &Recognition, events: &[Event]) -> Vec<Role> {
    (0..events.len()).map(|index| recognition.provenance.role(index)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Three kinds of frames in any order, some of them shown in another way than before.
    #[test]
    fn remembered_frames_are_as_if_they_were_not(
        images in any_images(),
        kinds in prop::collection::vec(prop::collection::vec(any_event(), 0..8), 3),
        order in prop::collection::vec((0..3usize, 0..2usize), 1..24),
        shown in prop::collection::vec(any_shown(), 2),
    ) {
        let describe = |image: ImageKey| images.get(image.0 as usize).copied();
        let [mut with, mut without] = [Recognition::default(), Recognition::default()];
        for (kind, is_shown) in order {
            let (events, shown) = (&kinds[kind], &shown[is_shown]);
            without.provenance.remembered = Remembered::default();
            with.frame(events, describe, shown);
            without.frame(events, describe, shown);
            prop_assert_eq!(roles(&with, events), roles(&without, events));
            for (index, event) in events.iter().enumerate() {
                let Event::Pass(pass) = event else { continue };
                let [with, without] = [&with, &without].map(|one| one.of(pass, &events[..index], describe));
                prop_assert_eq!(with, without);
            }
        }
    }
}

/// Draws a camera of many draws for each eye, which a tone-mapping pass reads.
fn frame(application: &mut Application, eyes: &[Chain; 2], scenes: [ImageKey; 2], has_mirror: bool) {
    let draws = |quads, meshes, read: &[ImageKey]| {
        let mut read_by_quads = Reads::default();
        read.iter().for_each(|image| read_by_quads.push(*image));
        Some(Draws { quads, meshes, vertices: 3 + 500 * meshes, read_by_quads, ..Draws::default() })
    };
    if has_mirror {
        let mirror = application.image(EYE, HDR);
        let mut pass = whole(EYE, &[mirror]);
        application.add_depth(&mut pass);
        pass.draws = draws(0, 40, &[]);
        application.pass("mirror", pass);
    }
    for (chain, scene) in eyes.iter().zip(scenes) {
        let mut pass = whole(EYE, &[scene]);
        application.add_depth(&mut pass);
        // As much as is in sight.
        pass.draws = draws(0, 100 + application.frame as u32 % 7, &[]);
        application.pass("scene", pass);
        let mut pass = whole(EYE, &[application.current(chain)]);
        pass.draws = draws(1, 0, &[scene]);
        application.pass("tone mapping", pass);
    }
    let shown = application.both(eyes);
    application.show(&shown);
}

/// Swapchain images take turns, depth images are recreated, as many draws as are in sight, and a mirror every third frame: from the eighth
/// frame on no frame is walked through.
#[test]
fn steady_frames_are_not_walked_through() {
    let mut application = Application::default();
    let eyes = application.eyes();
    let scenes = [application.image(EYE, HDR), application.image(EYE, HDR)];
    let mut walked = Vec::new();
    application.run(40, |application| {
        frame(application, &eyes, scenes, application.frame.is_multiple_of(3));
        if application.recognition.provenance.steps > 0 {
            walked.push(application.frame);
        }
    });
    assert!(!walked.is_empty() && walked.iter().all(|frame| *frame < 8), "{walked:?}");
    application.expect("scene", &looks(Eyes::Finer));
    application.expect("tone mapping", &Err(Unmatched::FullScreen));
}

/// Many cameras that read images which no event of the frame writes: each read is sought among all events.
#[test]
fn a_frame_with_too_many_steps_may_read_earlier_frames() {
    let feedback = |cameras: usize| {
        let mut application = Application::default();
        let eyes = application.eyes();
        let scenes = [application.image(EYE, HDR), application.image(EYE, HDR)];
        let [target, written_never] = [(); 2].map(|()| application.image([64, 64], HDR));
        application.run(6, |application| {
            for _ in 0..cameras {
                let mut pass = whole([64, 64], &[target]);
                application.add_depth(&mut pass);
                let mut read_by_meshes = Reads::default();
                read_by_meshes.push(written_never);
                pass.draws = Some(Draws { meshes: 50, vertices: 5000, read_by_meshes, ..Draws::default() });
                application.pass("camera", pass);
            }
            frame(application, &eyes, scenes, false);
        });
        application.recognition.feedback()
    };
    assert_eq!(feedback(10), Feedback::None);
    assert_eq!(feedback(2100), Feedback::Unknown);
}
