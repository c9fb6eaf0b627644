//! Frames of many passes, for the time that recognition takes.

use crate::frame_graphs::frame::{Arrangement, DEPTH, Frame, HDR, Image, PACKED, World, eye_of};
use crate::frame_graphs::step::{Step, Truth};
use std::time::Duration;

/// Frames of a run.
const FRAMES: usize = 1000;

/// Number of its first frames: recognition learns from them, and leaves out most of the later ones.
const LEARNED: usize = 750;

/// First frame whose verdicts count: the first ones are on new images.
const SETTLED: usize = 10;

/// Images that a pass reads.
const READS: usize = 12;

/// Median times of recognition.
pub struct Times {
    /// At the end of a frame that it learns from.
    pub learned: Duration,
    /// At the end of a frame that repeats one of the last.
    pub repeated: Duration,
    /// The verdicts on the passes of a frame, before their submits.
    pub verdicts: Duration,
}

/// Times of recognition in frames of `passes` passes before the scene's: cameras, and every third a full-screen pass. Each reads the images
/// of the twelve before it, or unknown images if `is_bindless`.
pub fn per_frame(passes: usize, is_bindless: bool) -> Times {
    let mut world = World::default();
    for _ in 0..FRAMES {
        world.frame([2016, 2240], Arrangement::Separate, 1.0, is_bindless, |frame| draw(frame, passes));
    }
    let median = |spent: &mut [Duration]| {
        spent.sort();
        spent[spent.len() / 2]
    };
    let (learned, repeated) = world.spent.split_at_mut(LEARNED);
    Times {
        learned: median(learned),
        repeated: median(repeated),
        verdicts: median(&mut world.verdicts_took[SETTLED..]),
    }
}

fn draw(frame: &mut Frame<'_>, passes: usize) {
    let mut images: Vec<Image> = Vec::new();
    for number in 0..passes {
        let extent = [512 + 8 * (number as u32 % 64), 512];
        let image = frame.image("camera", number, extent, HDR);
        let depth = frame.image("camera depth", number, extent, DEPTH);
        let step = Step::new("camera", Truth::Texture, &[image]);
        let reads = &images[images.len().saturating_sub(READS)..];
        frame.add(match number % 3 {
            2 => step.full_screen(reads),
            _ => step.clears(depth).meshes(100, reads),
        });
        images.push(image);
    }
    for view in 0..2 {
        let [width, height] = frame.size();
        let color = frame.image("colour", view, [width, height], PACKED);
        let depth = frame.image("depth", view, [width, height], DEPTH);
        let scene = Step::new("scene", Truth::Eye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(250, &images[images.len().saturating_sub(READS)..]));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone mapping", Truth::FullScreen, &[swapchain]).full_screen(&[color]));
    }
}
