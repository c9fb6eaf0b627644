//! Settings that people choose by name.
//!
//! | | fixed foveation | shades | updates | colour |
//! |---|---|---|---|---|
//! | quality | 14.34 to 27.08 degrees, 2x2 | .325 | 11223 | full |
//! | balanced | 14.34 to 27.08 degrees, 4x4 | .148 | 11223 | full |
//! | performance | 14.34 to 18.39 degrees, 4x4 | .107 | 11233 | full |
//! | streaming | as balanced | | | attenuated |
//! | fixed | 30 to 40 degrees, 2x2 | .466 | 11223 | full |
//! | paper | 14.34 to 27.08 degrees, 4x4 | .162 | 11223, aligned | attenuated, as published |
//!
//! "Shades" is the mean rate that a PICO 4 (2160 x 2160 at 105 degrees, tiles of 16 x 16, gaze ahead) has with the
//! preset's rates. The safety rails of the plan come on top: they widen the radii by tracker error, motion and latency.

use crate::avpm::BudgetSettings;
use crate::chroma::{self, ChromaSettings};
use crate::fixed_foveation::FixedFoveation;
use crate::rate::{PAPER_RATES, ShadingRate, VULKAN_RATES};
use crate::schedule::{Phase, Regions, UpdateConfiguration};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A named set of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Preset {
    /// Differences that few notice: the radii of the state of the art with a periphery four times as fine. Updates are as for
    /// [`Self::Balanced`]: completed from earlier pictures as the head has turned, these lose less than rates do for the same time.
    Quality,
    /// The state of the art that paper A measures itself against, and the update configuration that paper B calls
    /// feasible.
    #[default]
    Balanced,
    /// Noticed at times: the cheapest radii of paper A's pilot study whose scores some sound kept up, see
    /// [`Preset::settings`].
    Performance,
    /// [`Self::Balanced`] for pictures that are sent over a network: less colour saves bits.
    Streaming,
    /// For headsets without an eye tracker: coarse only beyond the range of eye movements without the head, as
    /// [`RailSettings::lost`](crate::plan::RailSettings::lost).
    Fixed,
    /// Papers A, B and C to the letter, to compare with their results: their rates, their sensitivity function, all regions
    /// in step, no concession to pursuit, and their curves of colour.
    Paper,
}

/// Settings of a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetSettings {
    /// Rates by eccentricity, also where neither contrast nor sound is known.
    pub fixed_foveation: FixedFoveation,
    /// Rates to choose from, coarsest first, as far as the device has them.
    pub rates: &'static [ShadingRate],
    /// How often each region is rendered while the eyes rest.
    pub update: UpdateConfiguration,
    /// Whether the eyes following something makes that one step faster ([`UpdateConfiguration::faster`]): paper B's
    /// participants then noticed 11223 and 11233 more often than not.
    pub faster_in_pursuit: bool,
    /// Where the regions end.
    pub regions: Regions,
    /// Which frames render which directions.
    pub phase: Phase,
    /// How colour falls off; not at all without.
    pub chroma: Option<ChromaSettings>,
    /// How sound becomes a budget, where sound is listened to.
    pub budget: BudgetSettings,
    /// [`AudioVisual::greatest_loss`](crate::plan::AudioVisual::greatest_loss), where it is not the usual one.
    pub greatest_loss: Option<f32>,
}

impl Preset {
    /// All, in the order in which they are offered.
    pub const ALL: [Self; 6] =
        [Self::Quality, Self::Balanced, Self::Performance, Self::Streaming, Self::Fixed, Self::Paper];

    /// Its name in configurations, lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quality => "quality",
            Self::Balanced => "balanced",
            Self::Performance => "performance",
            Self::Streaming => "streaming",
            Self::Fixed => "fixed",
            Self::Paper => "paper",
        }
    }

    /// Its settings.
    ///
    /// The radii are pairs of paper A's pilot study, the only ones with scores behind them. L1-C1 is its baseline. From
    /// there Table 1 lists for how many combinations of loudness and frequency another pair scored no worse: L1-C2 16,
    /// L2-C1 11, L1-C3 8 (scores up to 4.14), L2-C2 6 (up to 3.24), L3-C1 5, and none for the other three. Of these L1-C3
    /// shades least, and it keeps the widest fovea, which forgives the tracker most.
    ///
    /// All seven rates of Vulkan follow the radii more closely than the paper's four, and never shade more.
    pub fn settings(self) -> PresetSettings {
        let balanced = PresetSettings {
            fixed_foveation: FixedFoveation::L1_C1,
            rates: &VULKAN_RATES,
            update: UpdateConfiguration::F11223,
            faster_in_pursuit: true,
            regions: Regions::default(),
            phase: Phase::Staggered,
            chroma: None,
            budget: BudgetSettings::default(),
            greatest_loss: None,
        };
        match self {
            Self::Quality => PresetSettings {
                fixed_foveation: FixedFoveation::L1_C1.with_peripheral(ShadingRate::R2X2),
                greatest_loss: Some(4.0),
                ..balanced
            },
            Self::Balanced => balanced,
            Self::Performance => PresetSettings {
                fixed_foveation: FixedFoveation::L1_C3,
                update: UpdateConfiguration::F11233,
                greatest_loss: Some(12.0),
                ..balanced
            },
            Self::Streaming => PresetSettings { chroma: Some(ChromaSettings::default()), ..balanced },
            Self::Fixed => PresetSettings { fixed_foveation: FixedFoveation::WITHOUT_TRACKER, ..balanced },
            Self::Paper => PresetSettings {
                chroma: Some(ChromaSettings { mode: chroma::Mode::Paper, ..ChromaSettings::default() }),
                rates: &PAPER_RATES,
                faster_in_pursuit: false,
                phase: Phase::Aligned,
                budget: BudgetSettings::PAPER,
                ..balanced
            },
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no preset has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0:?} is not a preset; allowed: quality, balanced, performance, streaming, fixed and paper")]
pub struct UnknownPreset(pub String);

impl FromStr for Preset {
    type Err = UnknownPreset;

    /// A name as [`Self::name`] gives it.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|preset| preset.name() == text)
            .ok_or_else(|| UnknownPreset(text.to_owned()))
    }
}

#[cfg(test)]
mod tests;
