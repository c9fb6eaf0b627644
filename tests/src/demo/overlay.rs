//! A picture with rings of equal eccentricity drawn over it.

use super::EyeView;
use crate::picture::Picture;

/// Between thin rings, in degrees.
const RING_DEG: f32 = 10.0;
const THIN: [u8; 4] = [255, 255, 255, 255];
const PLATEAU: [u8; 4] = [255, 220, 0, 255];

/// `picture` with a thick ring at the plateau's edge, a thin one every ten degrees, and a dot at the gaze.
pub fn eccentricity(picture: &Picture, view: &EyeView, plateau_deg: f32) -> Picture {
    let degrees = |x: u32, y: u32| view.eccentricity_deg(picture, x, y);
    Picture::from_fn(picture.width, picture.height, |x, y| {
        let here = degrees(x, y);
        // How much one pixel is here; a ring's width is counted in pixels.
        let pixel = (degrees(x + 1, y) - here).abs().max((degrees(x, y + 1) - here).abs());
        let to_ring = (here - (here / RING_DEG).round() * RING_DEG).abs();
        if (here - plateau_deg).abs() < 1.5 * pixel || here < 4.0 * pixel {
            PLATEAU
        } else if here > RING_DEG / 2.0 && to_ring < 0.5 * pixel {
            THIN
        } else {
            picture.at(x, y)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Scenario, ScenarioExt};

    #[test]
    fn rings_lie_at_their_eccentricity_and_nowhere_else() {
        let picture = Picture::from_fn(200, 200, |_, _| [9, 9, 9, 255]);
        let view = EyeView::of_scenario(&Scenario::new(1))[0];
        let drawn = eccentricity(&picture, &view, 6.3);
        for (x, y, pixel) in drawn.enumerate() {
            let degrees = view.eccentricity_deg(&picture, x, y);
            match pixel {
                PLATEAU => assert!(degrees < 3.0 || (degrees - 6.3).abs() < 1.5, "{x} {y} {degrees}"),
                THIN => assert!((degrees / 10.0).fract().min(1.0 - (degrees / 10.0).fract()) < 0.1),
                other => assert_eq!(other, [9, 9, 9, 255]),
            }
        }
        assert!(drawn.pixels.contains(&PLATEAU) && drawn.pixels.contains(&THIN));
    }
}
