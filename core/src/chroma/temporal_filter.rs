//! Chroma attenuation over time: colour comes back at once where the gaze arrives, and fades slowly where the gaze left.
//!
//! No gain may fall by more than [`ChromaSettings::max_change_per_s`] in a second. Instead of a history per pixel one
//! cap of directions is kept, which always holds the gaze; eccentricity counts from its edge. The cap grows at once to
//! include the gaze, and contracts towards it so slowly that no direction leaves it faster than the curves'
//! steepest descent allows.

use super::{ChromaSettings, Curves, Mode};
use crate::geometry::{Cap, unit_direction};
use crate::range::within;
use glam::Vec3;

/// Area of full colour, and strength of the attenuation elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// Centre of the gaze region, of unit length, in the space of the gaze.
    pub direction: Vec3,
    /// Radius of the gaze region, radians, 0..=pi: eccentricity counts from there on.
    pub radius: f32,
    /// Part of the attenuation that is applied, 0..=1.
    pub strength: f32,
}

impl Focus {
    /// Follows a gaze (of unit length) without delay.
    pub fn at(gaze: Vec3) -> Self {
        Self { direction: gaze, radius: 0.0, strength: 1.0 }
    }
}

/// State of the last frame. Pure: time comes from the caller.
///
/// The limit holds for directions in the space in which the gaze is given; best one in which the scene rests, so that
/// it holds for the content.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChromaTemporalFilter {
    last: Option<LastFrame>,
}

#[derive(Clone, Copy, Debug)]
struct LastFrame {
    time_ns: i64,
    /// `None` for full colour everywhere.
    attenuated: Option<(Focus, ChromaSettings)>,
}

impl ChromaTemporalFilter {
    /// The focus at `time_ns` with that gaze, a direction of any length. `None` without a usable gaze (zero, not
    /// finite): colour is full everywhere at once, and is attenuated by degrees when the gaze is back.
    ///
    /// The first frame has nothing before it that could change, so it is attenuated in full. A change of the settings
    /// counts as switching on. A clock that stands still or goes back lets nothing fall. In paper mode nothing is
    /// limited.
    pub fn update(&mut self, gaze: Option<Vec3>, time_ns: i64, settings: &ChromaSettings) -> Option<Focus> {
        let Some(gaze) = gaze.and_then(unit_direction) else {
            self.show_full_color(time_ns);
            return None;
        };
        let focus = match self.last {
            Some(last) if settings.mode == Mode::Default => follow(&last, gaze, time_ns, settings),
            _ => Focus::at(gaze),
        };
        self.last = Some(LastFrame { time_ns, attenuated: Some((focus, *settings)) });
        Some(focus)
    }

    /// A frame was shown at `time_ns` with full colour everywhere: without a gaze, or because attenuation is off.
    pub fn show_full_color(&mut self, time_ns: i64) {
        self.last = Some(LastFrame { time_ns, attenuated: None });
    }
}

/// The next focus after `last`, with no gain falling by more than the time since then allows.
fn follow(last: &LastFrame, gaze: Vec3, time_ns: i64, settings: &ChromaSettings) -> Focus {
    let limit = within(settings.max_change_per_s, [0.1, 100.0], ChromaSettings::default().max_change_per_s);
    let elapsed_s = time_ns.saturating_sub(last.time_ns).max(0) as f32 * 1e-9;
    let allowed = limit * elapsed_s;
    let Some((focus, _)) = last.attenuated.filter(|(_, before)| before == settings) else {
        return Focus { strength: allowed.min(1.0), ..Focus::at(gaze) };
    };
    let spanned = Cap { centre: focus.direction, radius: focus.radius }.including(gaze);
    // Strength and cap both let gains fall, so only one of them moves in a frame.
    let (cap, strength) = if focus.strength < 1.0 {
        (spanned, (focus.strength + allowed).min(1.0))
    } else {
        (spanned.contracted_to(gaze, allowed / Curves::new(settings).steepest()), 1.0)
    };
    Focus { direction: cap.centre, radius: cap.radius, strength }
}

#[cfg(test)]
mod tests;
