//! The quality of the gaze signal.

/// Quality of the gaze signal: numbers from which no direction follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignalQuality {
    /// Samples a second that frames had; at most one a frame. `None`: not known yet.
    pub rate_hz: Option<f32>,
    /// Share of the frames with a gaze, 0..=1.
    pub valid: Option<f32>,
    /// Noise in fixations, degrees: root mean square of the angles from sample to sample (RMS-S2S; Holmqvist, Nyström and Mulvey 2012, on
    /// the quality of eye trackers' data).
    pub noise_deg: Option<f32>,
    /// Blinks since the session began.
    pub blinks: u32,
    /// Saccades since the session began.
    pub saccades: u32,
}
