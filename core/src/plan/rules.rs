//! Rules for all tiles of one frame, in both eyes.

use super::lattice::TileLattice;
use super::reasons::{Reason, Reasons};
use super::rings::Rings;
use super::safety::{Area, FrameSafety};
use super::sensitivity::Sensitivity;
use super::settings::{AudioVisual, PlanSettings, RateSettings, UpdateUnit};
use crate::audio::AudioFeatures;
use crate::avpm::{Budget, SensitivityUnit};
use crate::fixed_foveation::FixedFoveation;
use crate::frco::Allocation;
use crate::kernels::decide::DecideParams;
use crate::schedule::refresh::visible_shift_arcmin;
use crate::schedule::{MAX_FACTOR, REGIONS, Regions, Schedule, UpdateConfiguration};
use glam::{Quat, Vec3};

/// Rules for all tiles of one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameRules {
    pub(super) safety: FrameSafety,
    /// Centres of the rings, unit vectors in the common space.
    pub(super) centres: [Vec3; 2],
    /// Limit for rates by eccentricity alone.
    pub(super) fixed: RateLimit,
    /// Limit where contrast is known; `None` if contrast does not count.
    pub(super) by_contrast: Option<RateLimit>,
    /// The update schedule, with all limits applied; `None` if every tile is rendered.
    pub(super) schedule: Option<Schedule>,
}

/// Limits on the age of re-used content.
#[derive(Clone, Copy, Debug)]
pub(super) struct AgeLimits {
    /// Longest period at the measured frame rate, frames.
    pub(super) period_cap: u8,
    /// Displacement of re-used content for each frame of its age, arc minutes, >= 0.
    pub(super) drift_arcmin: f32,
}

impl AgeLimits {
    /// Longest period of each region at which the displacement of near content stays invisible at the region's inner edge, frames.
    fn unseen(&self, regions: &Regions) -> [u8; REGIONS] {
        let [a, b, c, d] = regions.radii_deg;
        [0.0, a, b, c, d].map(|begins_deg| {
            // Infinite where nothing drifts.
            let frames = visible_shift_arcmin(begins_deg) / self.drift_arcmin;
            frames.clamp(0.0, f32::from(MAX_FACTOR) - 1.0) as u8 + 1
        })
    }
}

/// Limit of the coarseness of tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RateLimit {
    pub(super) rings: Rings,
    /// The rings for tiles that have yet to become as coarse.
    coarsening: Rings,
    /// Loss of visible contrast that is allowed, where contrast counts.
    pub(super) budget: Option<f32>,
}

impl RateLimit {
    pub(super) const FULL_RATE: Self = Self { rings: Rings::FULL, coarsening: Rings::FULL, budget: None };
}

impl FrameRules {
    /// `orientations` lead from the views' spaces to the common one.
    pub(super) fn new(
        settings: &PlanSettings,
        safety: FrameSafety,
        audio: Option<&AudioFeatures>,
        limits: AgeLimits,
        orientations: [Quat; 2],
        reasons: &mut Reasons,
    ) -> Self {
        let around_gaze = matches!(safety.area, Area::AroundGaze(_));
        let map = match (&settings.rates, safety.area) {
            (RateSettings::Off, _) | (_, Area::Nowhere) => None,
            (_, Area::AroundLenses) => settings.safety.lost.as_ref(),
            (RateSettings::Fixed(map), Area::AroundGaze(_)) => Some(map),
            (RateSettings::AudioVisual(model), Area::AroundGaze(_)) => Some(&model.fixed),
        };
        let by_contrast = match &settings.rates {
            RateSettings::AudioVisual(model) if around_gaze => {
                contrast_limit(settings, model, &safety, audio, reasons)
            }
            _ => None,
        };
        let fixed =
            map.map_or(RateLimit::FULL_RATE, |map| rate_limit(settings, ring_map(settings, map), &safety));
        let first = by_contrast.unwrap_or(fixed).rings.from_deg()[0];
        let least_deg = settings.safety.least_foveal_deg + safety.vergence_deg;
        reasons.insert_if(least_deg > 0.0 && first == least_deg + safety.inflation_deg, Reason::LeastFovea);
        Self {
            safety,
            centres: match safety.area {
                Area::AroundGaze(gazes) => gazes,
                Area::AroundLenses => {
                    settings.safety.lost.map_or([Vec3::NEG_Z; 2], |lost| lost.lens_centres(orientations))
                }
                Area::Nowhere => [Vec3::NEG_Z; 2],
            },
            fixed,
            by_contrast,
            schedule: if around_gaze { schedule(settings, &safety, limits, reasons) } else { None },
        }
    }

    /// Whether there is a gaze that rates follow.
    pub(super) fn has_gaze(&self) -> bool {
        matches!(self.safety.area, Area::AroundGaze(_))
    }

    /// The uniform of one view, in whose space `centres` are.
    pub(super) fn params(
        &self,
        settings: &PlanSettings,
        centres: [Vec3; 2],
        limit: &RateLimit,
        lattice: &TileLattice,
    ) -> DecideParams {
        let model = match &settings.rates {
            RateSettings::AudioVisual(model) if limit.budget.is_some() => Some(model),
            _ => None,
        };
        let plane = lattice.plane();
        let available = &settings.device.available;
        let budget = limit.budget.unwrap_or(0.0);
        let coarsening_budget = budget * settings.safety.hysteresis_budget;
        let holding_budget = budget * settings.safety.holding_budget;
        let least_budget = budget.min(coarsening_budget).min(holding_budget);
        DecideParams {
            gaze_left: centres[0].into(),
            inflation_deg: self.safety.inflation_deg,
            gaze_right: centres[1].into(),
            coarsening: self.safety.coarsening,
            ring_chords: limit.rings.chords(),
            coarsening_chords: limit.coarsening.chords(),
            levels: available.levels().map(u32::from),
            texels: available.texels().map(u32::from),
            budget,
            coarsening_budget,
            sensitivity: match model.map(|model| model.budget.unit) {
                None => 0,
                Some(SensitivityUnit::CastleCsf) => 1,
                Some(SensitivityUnit::Tursun) => 2,
            },
            full_rate_period: 0,
            plane_origin: plane.origin.into(),
            plane_step: plane.step.into(),
            extent: lattice.extent(),
            overhang: lattice.overhang(),
            texel: lattice.texel(),
            tiles: lattice.tiles(),
            full_rate_phase: 0,
            is_turned: 0,
            has_stale: 0,
            holding_budget,
            measured_column: [0.0; 3],
            elapsed_ms: self.safety.elapsed_ms,
            measured_row: [0.0; 3],
            flat_contrast: model.map_or(-1.0, |model| {
                least_budget / (model.allocation.greatest_factor() * Sensitivity::greatest(model.budget.unit))
            }),
            measured_depth: [0.0; 3],
            is_marginal: model.is_some_and(|model| model.allocation == Allocation::EqualMarginalLoss).into(),
            axis_tile: [0; 2],
            unused: [0; 2],
        }
    }
}

fn ring_map(settings: &PlanSettings, map: &FixedFoveation) -> Rings {
    Rings::new(map, &settings.device.available)
}

fn rate_limit(settings: &PlanSettings, rings: Rings, safety: &FrameSafety) -> RateLimit {
    let least_deg = settings.safety.least_foveal_deg + safety.vergence_deg;
    let rings = rings.widened(least_deg, safety.inflation_deg);
    RateLimit { rings, coarsening: rings.widened(0.0, safety.hysteresis_deg), budget: None }
}

/// Limit by contrast; `None` if silence asks for fixed foveation.
fn contrast_limit(
    settings: &PlanSettings,
    model: &AudioVisual,
    safety: &FrameSafety,
    audio: Option<&AudioFeatures>,
    reasons: &mut Reasons,
) -> Option<RateLimit> {
    reasons.insert_if(audio.is_none(), Reason::NothingMeasured);
    // No sound capture counts as silence: the ablation of the paper without both features of sound.
    let audio = audio.unwrap_or(&AudioFeatures::SILENT);
    reasons.insert_if(audio.silent, Reason::Silence);
    let Budget::Alpha(budget) = model.budget.budget(audio.gamma_ld, audio.gamma_fq_kilomel, audio.silent)
    else {
        reasons.insert(Reason::Silence);
        return None;
    };
    let rings = model.cap.as_ref().map_or(Rings::OPEN, |cap| ring_map(settings, cap));
    reasons.insert_if(rings.from_deg()[0] > 0.0, Reason::FixedCap);
    Some(RateLimit { budget: Some(model.budget_with(budget)), ..rate_limit(settings, rings, safety) })
}

/// The schedule of this frame; `None` if it would leave nothing out.
fn schedule(
    settings: &PlanSettings,
    safety: &FrameSafety,
    limits: AgeLimits,
    reasons: &mut Reasons,
) -> Option<Schedule> {
    let updates = settings.schedule.as_ref()?;
    let asked = updates.schedule.configuration;
    let followed = if safety.pursuit && updates.faster_in_pursuit { asked.faster() } else { asked };
    reasons.insert_if(followed != asked, Reason::Pursuit);
    let capped = if updates.uncapped { followed } else { followed.capped(limits.period_cap) };
    reasons.insert_if(capped != followed, Reason::LeastFrequency);
    let configuration = match updates.unit {
        UpdateUnit::Directions => capped.limited(limits.unseen(&updates.schedule.regions)),
        // Without reprojection every turn of the head displaces tiles, too.
        UpdateUnit::Tiles => capped,
    };
    reasons.insert_if(configuration != capped, Reason::HeadMoves);
    (configuration != UpdateConfiguration::F11111).then(|| Schedule {
        regions: updates.schedule.regions.enlarged(safety.inflation_deg),
        configuration,
        ..updates.schedule
    })
}
