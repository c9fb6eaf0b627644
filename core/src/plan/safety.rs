//! Safety limits that depend on the frame alone: wider rings, slower coarsening, techniques that are off.

use super::reasons::{Reason, Reasons};
use super::rings::STEPS_PER_OCTAVE;
use super::settings::SafetySettings;
use crate::gaze::{GazePhase, GazeState, foveal_inflation_deg};
use crate::geometry::{eccentricity, unit_direction};
use crate::rate::ShadingRate;
use glam::Vec3;

/// Longest time that one frame accounts for, nanoseconds: after a pause tiles do not become coarse at once.
const LONGEST_FRAME_NS: i64 = 100_000_000;

/// Safety limits of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrameSafety {
    /// Area that may be coarse.
    pub(super) area: Area,
    /// Enlargement of every radius, degrees, 0..=180.
    pub(super) inflation_deg: f32,
    /// Enlargement of the least fovea where the vergence of the eyes is assumed, degrees, 0..=180.
    pub(super) vergence_deg: f32,
    /// Distance outside of its ring from which on a tile may become coarser, degrees.
    pub(super) hysteresis_deg: f32,
    /// Most that a tile may become coarser, in [`STEPS_PER_OCTAVE`].
    pub(super) coarsening: u32,
    /// Time since the frame before, milliseconds, 0..=100.
    pub(super) elapsed_ms: u32,
    /// Whether the eyes follow something.
    pub(super) pursuit: bool,
}

/// Area that may be coarse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Area {
    /// The periphery around the gaze: unit vectors in the common space, left and right.
    AroundGaze([Vec3; 2]),
    /// The periphery around the axes of the lenses, for an unknown gaze.
    AroundLenses,
    /// Nothing.
    Nowhere,
}

/// State of the safety limits from frame to frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SafetyState {
    last_ns: Option<i64>,
    /// Part of a step that is left over.
    carry: f32,
}

impl SafetyState {
    /// Computes the safety limits of the frame with display time `time_ns`. `by_contrast`, if contrast may decide: rotation of the head since
    /// the previous frame, in tiles. That share of each tile shows new content and adds to the permitted coarsening. All numbers of
    /// `settings` are usable ([`SafetySettings::usable`]).
    pub(super) fn frame(
        &mut self,
        settings: &SafetySettings,
        by_contrast: Option<f32>,
        time_ns: i64,
        gaze: &GazeState,
        reasons: &mut Reasons,
    ) -> FrameSafety {
        let trust = if gaze.trust.is_nan() { 0.0 } else { gaze.trust.clamp(0.0, 1.0) };
        let area = area(gaze, trust);
        let lost = area == Area::AroundLenses;
        reasons.insert_if(area == Area::Nowhere, Reason::GazeInvalid);
        reasons.insert_if(lost, Reason::GazeLost);
        reasons.insert_if(trust < 1.0 && matches!(area, Area::AroundGaze(_)), Reason::GazeFading);
        let inflation_deg = if lost { 0.0 } else { inflation_deg(settings, gaze, trust) };
        let seconds = self.elapsed_s(time_ns, reasons);
        let speed = match by_contrast {
            _ if gaze.is_suppressed => settings.suppressed_octaves_per_s,
            Some(_) => settings.contrast_octaves_per_s,
            None => settings.coarsening_octaves_per_s,
        };
        FrameSafety {
            area,
            inflation_deg,
            vergence_deg: vergence_deg(gaze, area, settings.least_foveal_deg + inflation_deg),
            hysteresis_deg: hysteresis_deg(settings, gaze),
            elapsed_ms: (seconds * 1e3) as u32,
            coarsening: self.coarsening(
                speed,
                seconds,
                by_contrast.unwrap_or(0.0),
                lost || may_coarsen(gaze, by_contrast.is_some(), reasons),
            ),
            pursuit: gaze.phase == GazePhase::Pursuit,
        }
    }

    fn elapsed_s(&mut self, time_ns: i64, reasons: &mut Reasons) -> f32 {
        let last = self.last_ns.replace(time_ns);
        let elapsed_ns = last.map_or(0, |last| time_ns.saturating_sub(last));
        reasons.insert_if(last.is_some() && elapsed_ns <= 0, Reason::ClockStopped);
        elapsed_ns.clamp(0, LONGEST_FRAME_NS) as f32 * 1e-9
    }

    /// Computes the permitted coarsening, in [`STEPS_PER_OCTAVE`], at `speed` octaves a second, with a share `new` of new content in a tile.
    fn coarsening(&mut self, speed: f32, seconds: f32, new: f32, allowed: bool) -> u32 {
        if speed == f32::INFINITY {
            return u32::from(u8::MAX);
        }
        let moves = allowed && speed > 0.0;
        if !moves {
            self.carry = 0.0;
            return 0;
        }
        let octaves = speed * seconds + new.min(1.0) * ShadingRate::R4X4.octaves();
        let steps = (octaves * f32::from(STEPS_PER_OCTAVE) + self.carry).min(255.0);
        self.carry = steps.fract();
        steps as u32
    }
}

fn area(gaze: &GazeState, trust: f32) -> Area {
    if gaze.phase == GazePhase::Lost && trust == 0.0 {
        return Area::AroundLenses;
    }
    // An eye without a direction is taken to look where the other one does.
    match gaze.directions.map(unit_direction) {
        [Some(left), Some(right)] => Area::AroundGaze([left, right]),
        [Some(one), None] | [None, Some(one)] => Area::AroundGaze([one; 2]),
        [None, None] => Area::Nowhere,
    }
}

/// Tracker error, the turn of the eyes within the latency, and, as trust falls to 0, everything.
fn inflation_deg(settings: &SafetySettings, gaze: &GazeState, trust: f32) -> f32 {
    let base = settings.least_foveal_deg;
    let radius = foveal_inflation_deg(base, settings.tracker_error_deg, gaze.motion_deg(settings.latency_s));
    (radius - base + (1.0 - trust) * 180.0).clamp(0.0, 180.0)
}

/// Enlargement of a fovea of `fovea_deg` around the directions of both eyes, so that it reaches as far from the ray between them: with an
/// assumed vergence, both eyes may look along that ray, and two circles are narrower between their centres (spherical law of cosines).
fn vergence_deg(gaze: &GazeState, area: Area, fovea_deg: f32) -> f32 {
    let (Some(_), Area::AroundGaze([left, right])) = (gaze.ray, area) else { return 0.0 };
    let half_apart = eccentricity(left, right) / 2.0;
    let reach_deg = (fovea_deg.to_radians().cos() * half_apart.cos()).acos().to_degrees();
    if fovea_deg < 90.0 { (reach_deg - fovea_deg).clamp(0.0, 180.0) } else { 0.0 }
}

/// Tiles become coarser on the way to a landing at twice the distance of its error.
fn hysteresis_deg(settings: &SafetySettings, gaze: &GazeState) -> f32 {
    let error_deg = gaze.prediction_error_deg.filter(|_| gaze.is_suppressed).unwrap_or(0.0);
    settings.hysteresis_deg + if error_deg.is_nan() { 180.0 } else { error_deg.max(0.0) }
}

/// Whether tiles may become coarser. By contrast they may in a blink too: while the head turns, another part of the world enters each tile,
/// and tiles that only became finer would shade twice as much at its end.
fn may_coarsen(gaze: &GazeState, by_contrast: bool, reasons: &mut Reasons) -> bool {
    reasons.insert_if(gaze.phase == GazePhase::Blink, Reason::GazeHeld);
    reasons.insert_if(gaze.is_suppressed, Reason::Suppressed);
    reasons.insert_if(gaze.phase == GazePhase::Saccade && !gaze.is_suppressed, Reason::Saccade);
    reasons.insert_if(gaze.phase == GazePhase::PostSaccade && !gaze.is_suppressed, Reason::AfterSaccade);
    gaze.may_coarsen() || (by_contrast && gaze.phase == GazePhase::Blink)
}
