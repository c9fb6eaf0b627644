//! Settings of a planner.

use super::rings::AvailableRates;
use crate::avpm::BudgetSettings;
use crate::chroma::ChromaSettings;
use crate::fixed_foveation::FixedFoveation;
use crate::frco::Allocation;
use crate::schedule::Schedule;

/// Settings of a planner, on one device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanSettings {
    /// Selection of shading rates.
    pub rates: RateSettings,
    /// Update schedule of the periphery; `None`: it is rendered in every frame.
    pub schedule: Option<UpdateSettings>,
    /// Chroma attenuation; `None`: full colour.
    pub chroma: Option<ChromaSettings>,
    /// Safety limits.
    pub safety: SafetySettings,
    /// Rates and tile size of the device.
    pub device: DeviceRates,
    /// Whether contrast is known to the GPU alone. Then [`super::EyePlan::by_contrast`] is the input of the kernel `decide`, and the plan's
    /// own rates are the fallback without that kernel: fixed foveation.
    pub contrast_on_gpu: bool,
}

impl Default for PlanSettings {
    /// Nothing is coarser, older or less coloured than the application drew it.
    fn default() -> Self {
        Self {
            rates: RateSettings::Off,
            schedule: None,
            chroma: None,
            safety: SafetySettings::default(),
            device: DeviceRates::default(),
            contrast_on_gpu: false,
        }
    }
}

/// Selection of shading rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RateSettings {
    /// 1x1 everywhere.
    #[default]
    Off,
    /// By eccentricity alone.
    Fixed(FixedFoveation),
    /// By eccentricity, contrast and sound (paper A).
    AudioVisual(AudioVisual),
}

/// Paper A's map of rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AudioVisual {
    /// The budget of visible contrast by sound, with the unit of its contrast sensitivity function.
    pub budget: BudgetSettings,
    /// Allocation of the budget to tiles.
    pub allocation: Allocation,
    /// The map in silence, if [`BudgetSettings`] asks for it, and if sound or contrast is not known.
    pub fixed: FixedFoveation,
    /// Coarsest rates for contrast and sound, as rings; `None`, as in the paper, for no limit.
    pub cap: Option<FixedFoveation>,
    /// Greatest loss of visible contrast of a tile that any sound leads to, >= 0 or infinite, in the units of the sensitivity function in
    /// use: with castleCSF 1 is a just-noticeable loss. NaN counts as 0. See [`Self::budget_with`].
    pub greatest_loss: f32,
}

impl AudioVisual {
    /// To the letter of the paper.
    pub const PAPER: Self = Self {
        budget: BudgetSettings::PAPER,
        allocation: Allocation::PerTile,
        fixed: FixedFoveation::L1_C1,
        cap: None,
        greatest_loss: f32::INFINITY,
    };

    /// The budget of a frame whose sound pays for a loss of `alpha` (paper A Eq. 17; 0 in silence), as [`Self::allocation`] spends it.
    ///
    /// For each tile: `alpha`, and at most [`Self::greatest_loss`]. At equal marginal loss: [`Self::greatest_loss`] with the loudest sound
    /// ([`BudgetSettings::greatest`]), and by as much less as a frame with less of a sound has to lose less for the same score (Eq. 14).
    pub fn budget_with(&self, alpha: f32) -> f32 {
        let budget = match self.allocation {
            Allocation::PerTile if self.greatest_loss >= alpha => return alpha,
            Allocation::PerTile => self.greatest_loss,
            Allocation::EqualMarginalLoss => self.greatest_loss - (self.budget.greatest() - alpha).max(0.0),
        };
        if budget.is_nan() { 0.0 } else { budget.clamp(0.0, f32::MAX) }
    }
}

impl Default for AudioVisual {
    /// Any rate outside of the fovea whose savings are worth its loss. On the stills of `cargo dev bench budget`, without sound (6.2 in place
    /// of 8), it shades 0.70 of the samples of paper A's baseline with 0.73 of its loss.
    fn default() -> Self {
        Self {
            budget: BudgetSettings::default(),
            allocation: Allocation::EqualMarginalLoss,
            fixed: FixedFoveation::L1_C1,
            cap: Some(FixedFoveation::ANYWHERE),
            greatest_loss: 8.0,
        }
    }
}

/// Settings of the updates of the periphery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateSettings {
    /// Regions, their periods, and their phase.
    pub schedule: Schedule,
    /// Whether every region is one step faster while the eyes follow something: paper B's participants noticed more
    /// then than while they fixated.
    pub faster_in_pursuit: bool,
    /// Unit of the schedule.
    pub unit: UpdateUnit,
    /// Whether regions may be rendered less often than [`crate::schedule::cap::MIN_UPDATE_HZ`] asks for.
    pub uncapped: bool,
}

/// Unit of an update schedule, which has one age.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpdateUnit {
    /// Directions that are fixed in the world: earlier images are reprojected, and both eyes see a direction at one age.
    #[default]
    Directions,
    /// Tiles of the view, each by its point nearest to the gaze, as pixels in paper B: earlier images are not reprojected. [`crate::schedule::Phase::Staggered`] counts as [`crate::schedule::Phase::Aligned`].
    Tiles,
}

impl From<Schedule> for UpdateSettings {
    /// Updates by direction, with both safety limits.
    fn from(schedule: Schedule) -> Self {
        Self { schedule, faster_in_pursuit: true, unit: UpdateUnit::Directions, uncapped: false }
    }
}

/// Safety limits of a plan, independent of the other settings. NaN counts as the default, a negative value as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetySettings {
    /// Least radius of the area at full rate, before anything widens it, degrees.
    pub least_foveal_deg: f32,
    /// Possible error of the eye tracker, degrees. Widens every radius.
    pub tracker_error_deg: f32,
    /// Time from the eye to the image, seconds: every radius is widened by the movement of the eyes in it.
    pub latency_s: f32,
    /// Distance outside of its ring from which on a tile may become coarser, degrees.
    pub hysteresis_deg: f32,
    /// The part of the budget of paper A Eq. 17 that a tile has to stay below to become coarser, 0..=1.
    pub hysteresis_budget: f32,
    /// Times the budget that a tile may lose for [`STEADY_MS`](crate::kernels::decide::STEADY_MS) after its rate has changed, 1..=16: noise
    /// that lasts for a frame does not take a change back at once.
    pub holding_budget: f32,
    /// Fastest that a tile becomes coarser, octaves a second ([`octaves`](crate::rate::ShadingRate::octaves)); infinite: at once, in blinks
    /// and with a gaze that was just found again too.
    pub coarsening_octaves_per_s: f32,
    /// The same where contrast decides, which noise in the pictures changes too; the two octaves of 4x4 more for each tile by which the
    /// head has turned.
    pub contrast_octaves_per_s: f32,
    /// The same while changes go unnoticed ([`GazeState::is_suppressed`](crate::gaze::GazeState::is_suppressed)), with or without contrast:
    /// then a tile that the eyes have left may reach its coarsest permitted rate in the next frame.
    pub suppressed_octaves_per_s: f32,
    /// Rates around the lens axes once the gaze is lost; `None`: 1x1 everywhere.
    pub lost: Option<FixedFoveation>,
}

impl SafetySettings {
    /// Only the limits of a finite plan, to reproduce the papers.
    pub const PAPER: Self = Self {
        least_foveal_deg: 0.0,
        tracker_error_deg: 0.0,
        latency_s: 0.0,
        hysteresis_deg: 0.0,
        hysteresis_budget: 1.0,
        holding_budget: 1.0,
        coarsening_octaves_per_s: f32::INFINITY,
        contrast_octaves_per_s: f32::INFINITY,
        suppressed_octaves_per_s: f32::INFINITY,
        lost: None,
    };
}

impl SafetySettings {
    /// These settings with usable numbers: the default's for NaN, 0 for negative ones.
    pub(super) fn usable(&self) -> Self {
        let usual = Self::default();
        let or = |value: f32, usual: f32| if value.is_nan() { usual } else { value.max(0.0) };
        Self {
            least_foveal_deg: or(self.least_foveal_deg, usual.least_foveal_deg).min(180.0),
            tracker_error_deg: or(self.tracker_error_deg, usual.tracker_error_deg),
            latency_s: or(self.latency_s, usual.latency_s),
            hysteresis_deg: or(self.hysteresis_deg, usual.hysteresis_deg),
            hysteresis_budget: or(self.hysteresis_budget, usual.hysteresis_budget).min(1.0),
            holding_budget: or(self.holding_budget, usual.holding_budget).clamp(1.0, 16.0),
            coarsening_octaves_per_s: or(self.coarsening_octaves_per_s, usual.coarsening_octaves_per_s),
            contrast_octaves_per_s: or(self.contrast_octaves_per_s, usual.contrast_octaves_per_s),
            suppressed_octaves_per_s: or(self.suppressed_octaves_per_s, usual.suppressed_octaves_per_s),
            lost: self.lost,
        }
    }
}

impl Default for SafetySettings {
    /// A fovea of 5 degrees; 1.1 degrees of error (vendor of the Vive Pro Eye, as paper B takes it); 60 ms from eye to
    /// image, within the 50 to 70 that Albert et al. 2017 found tolerable. One octave takes an
    /// eighth of a second, so that no tile becomes coarser twice within a tenth, and a quarter where contrast decides; no time while
    /// changes go unnoticed. Once the gaze is lost, 2x2 from 40 degrees on, farther than eyes turn without the head.
    fn default() -> Self {
        Self {
            least_foveal_deg: 5.0,
            tracker_error_deg: 1.1,
            latency_s: 0.06,
            hysteresis_deg: 0.5,
            hysteresis_budget: 0.9,
            holding_budget: 1.35,
            coarsening_octaves_per_s: 8.0,
            contrast_octaves_per_s: 4.0,
            suppressed_octaves_per_s: f32::INFINITY,
            lost: Some(FixedFoveation::WITHOUT_TRACKER),
        }
    }
}

/// Rates and tile size of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceRates {
    /// Rates.
    pub available: AvailableRates,
    /// Size of a tile, pixels; each side within [`super::TEXEL_SIDES`], or it counts as the nearest that is.
    pub texel: [u32; 2],
}

impl Default for DeviceRates {
    /// Paper A's device: tiles of 16 x 16.
    fn default() -> Self {
        Self { available: AvailableRates::default(), texel: [16, 16] }
    }
}
