//! The event streams of the styles of rendering that applications have, by their use of the scene's picture.

mod changing;
mod copied;
mod direct;
mod distractors;
mod feedback;
mod off_screen;
mod profile;
mod provenance;
mod render_thread;
mod resized;
mod upscaled;

use super::application::*;
use crate::pass_detection::*;
use smallvec::smallvec;

/// Layers of an array swapchain, one for each eye.
pub fn array_shown(app: &Application, chain: &Chain) -> Shown {
    let image = Some(app.current(chain));
    let view = |eye, layer| ShownView { layer, image, ..view_of(chain, eye) };
    Shown { views: smallvec![view(Eye::Left, 0), view(Eye::Right, 1)], ..Shown::default() }
}

pub const BOTH_LAYERS: [(Eyes, u32, [f32; 4]); 2] = [(Eyes::Left, 0, WHOLE), (Eyes::Right, 1, WHOLE)];

pub const WIDE: [u32; 2] = [2 * EYE[0], EYE[1]];
pub const HALVES: [(Eyes, u32, [f32; 4]); 2] = [(Eyes::Left, 0, LEFT_HALF), (Eyes::Right, 0, RIGHT_HALF)];

pub fn wide_shown(app: &Application, chain: &Chain) -> Shown {
    let image = Some(app.current(chain));
    let view = |eye, x| ShownView { rect: [x, 0, EYE[0], EYE[1]], image, ..view_of(chain, eye) };
    Shown { views: smallvec![view(Eye::Left, 0), view(Eye::Right, EYE[0])], ..Shown::default() }
}

/// Sizes of a frame with dynamic resolution, rounded to multiples of 8.
pub fn dynamic(frame: u64) -> [u32; 2] {
    let step = [0, 3, 1, 4, 2, 5][frame as usize % 6];
    [EYE[0] - 8 * step, EYE[1] - 8 * step]
}

/// The handle of a swapchain is often an address, which the next one gets.
#[test]
fn a_swapchain_with_the_handle_of_a_gone_one_is_new() {
    let mut application = Application::default();
    let eyes = application.eyes();
    application.run(10, |application| {
        for chain in &eyes {
            let image = application.current(chain);
            application.scene("eye", image);
        }
        let shown = application.both(&eyes);
        application.show(&shown);
    });
    assert!(matches!(application.outcomes("eye").last(), Some((10, Ok(_)))));
    let key = eyes[0].key;
    application.recognition.forget_swapchain(key);
    let panel = application
        .described(|image| ImageDescription { swapchain: Some(key), ..description(image, EYE, LDR) });
    application.scene("panel", panel);
    assert_eq!(application.outcomes("panel"), [(10, Err(Unmatched::NotShown))]);
}
