//! Reasons why a plan is more careful than its settings.

use std::fmt;

/// One reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Reason {
    /// The gaze is not a direction: full rate everywhere.
    GazeInvalid,
    /// The gaze is held over a blink: no tile becomes coarser, except by contrast.
    GazeHeld,
    /// The gaze was lost a moment ago: the rings widen until everything has full rate.
    GazeFading,
    /// The gaze is lost: wide fixed rates around the lens axes, no re-use, full colour.
    GazeLost,
    /// The eyes are in a saccade, or have just landed, and changes go unnoticed: coarser at once outside of the place of landing.
    Suppressed,
    /// The eyes may be in a saccade, or it may be over by now: nothing becomes coarser.
    Saccade,
    /// The gaze has just been found again, or is in doubt: nothing becomes coarser.
    AfterSaccade,
    /// The eyes follow something: regions are updated more often.
    Pursuit,
    /// The settings ask for a smaller area of full rate than is safe.
    LeastFovea,
    /// Contrast permits coarser rates than fixed foveation would; these are not used.
    FixedCap,
    /// No sound: the settings for silence apply.
    Silence,
    /// Sound or contrast is not known: fixed foveation instead.
    NothingMeasured,
    /// The periphery is updated more often than the settings ask for, for the sake of the least frequency.
    LeastFrequency,
    /// Regions are updated more often, because the head's translation moves near content visibly.
    HeadMoves,
    /// Changing content in the periphery is rendered in each frame.
    ContentChanges,
    /// All tiles are rendered, because that was asked for.
    Refresh,
    /// The clock did not advance: nothing becomes coarser.
    ClockStopped,
    /// A view has no usable field of view or orientation: full rate there.
    ViewMalformed,
}

impl Reason {
    /// All of them.
    pub const ALL: [Self; 18] = [
        Self::GazeInvalid,
        Self::GazeHeld,
        Self::GazeFading,
        Self::GazeLost,
        Self::Suppressed,
        Self::Saccade,
        Self::AfterSaccade,
        Self::Pursuit,
        Self::LeastFovea,
        Self::FixedCap,
        Self::Silence,
        Self::NothingMeasured,
        Self::LeastFrequency,
        Self::HeadMoves,
        Self::ContentChanges,
        Self::Refresh,
        Self::ClockStopped,
        Self::ViewMalformed,
    ];
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::GazeInvalid => "gaze is not a direction: full rate",
            Self::GazeHeld => "blink: gaze held",
            Self::GazeFading => "gaze lost: ramping to uniform full rate",
            Self::GazeLost => "gaze lost: wide fixed rates, no re-use, full colour",
            Self::Suppressed => "saccade: coarsening at once outside of the landing",
            Self::Saccade => "saccade in doubt: no coarsening",
            Self::AfterSaccade => "gaze just found again: no coarsening",
            Self::Pursuit => "pursuit: updated one step faster",
            Self::LeastFovea => "area of full rate kept at its least radius",
            Self::FixedCap => "rates capped at fixed foveation",
            Self::Silence => "silence",
            Self::NothingMeasured => "sound and contrast unknown: fixed foveation",
            Self::LeastFrequency => "periphery kept at its least frequency",
            Self::HeadMoves => "head movement: regions updated early",
            Self::ContentChanges => "changing content: rendered in every frame",
            Self::Refresh => "refresh requested: every tile rendered",
            Self::ClockStopped => "the clock does not advance: no coarsening",
            Self::ViewMalformed => "view without a usable field of view: full rate",
        })
    }
}

/// A set of reasons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reasons(u32);

impl Reasons {
    /// Adds one.
    pub fn insert(&mut self, reason: Reason) {
        self.0 |= 1 << reason as u32;
    }

    /// Adds one where `holds`.
    pub fn insert_if(&mut self, holds: bool, reason: Reason) {
        if holds {
            self.insert(reason);
        }
    }

    /// Whether a reason is in the set.
    pub fn contains(self, reason: Reason) -> bool {
        self.0 & (1 << reason as u32) != 0
    }

    /// Reasons in the set.
    pub fn iter(self) -> impl Iterator<Item = Reason> {
        Reason::ALL.into_iter().filter(move |reason| self.contains(*reason))
    }
}
