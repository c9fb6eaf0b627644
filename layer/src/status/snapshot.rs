//! Status that changes from frame to frame.

use super::{HistoryTooLarge, SignalQuality};
use crate::config::{AudioSource, DebugView, GazeSource};
use crate::inputs::gaze::auto::ActiveGazeSource;
use crate::inputs::gaze::osc::OscStatus;
use crate::link::{BACKEND_MASK, BACKEND_RATE_ATTACHMENT};
use parafovea_core::gate::{Gate, GateMode};
use parafovea_core::mask::Pattern;
use parafovea_core::rate::ShadingRate;
use parafovea_manifest::status::{self, Status};

/// Upper bound of the number of values of a texel in a rate image.
const TEXELS: usize = 16;

/// Status at the end of a frame: plain numbers, so that taking them allocates nothing.
#[derive(Clone, Copy, Debug)]
pub struct StatusSnapshot {
    /// Frames that ended in the session.
    pub frames: u64,
    /// Frames a second, Hz; 0: not known.
    pub frame_rate_hz: f32,
    /// `BACKEND_*` of the link.
    pub backend: u32,
    /// Passes that had maps in the last frame.
    pub passes_matched: u32,
    /// Whether the application gets the gaze too.
    pub gaze_is_given: bool,
    /// Configured source of the gaze.
    pub gaze_source: GazeSource,
    /// Source of the newest gaze.
    pub active_gaze_source: ActiveGazeSource,
    /// Status of its packets.
    pub osc: OscStatus,
    /// Whether there was one in this frame.
    pub gaze_is_valid: bool,
    /// Age of the last gaze sample, milliseconds.
    pub gaze_age_ms: Option<f32>,
    /// Quality of the gaze signal.
    pub signal: SignalQuality,
    /// Delay of packets by the runtime's eye tracker, milliseconds.
    pub packet_delay_ms: Option<f32>,
    /// Drift of the mean gaze, degrees.
    pub drift_deg: Option<f32>,
    /// Configured source of the sound.
    pub audio_source: AudioSource,
    /// Whether something is known of the last seconds.
    pub is_heard: bool,
    /// Number of tiles of both eyes at each rate, by its texel.
    pub tiles: [u32; TEXELS],
    /// Whether the GPU decides the rates of the tiles, and `tiles` hold where it cannot.
    pub gpu_decides: bool,
    /// Tiles that are rendered in this frame.
    pub tiles_due: u32,
    /// Share of the pixels that is shaded, by the plan.
    pub shaded: f32,
    /// The gate of rates.
    pub rates: GateStatus,
    /// The gate of re-use.
    pub reuse: GateStatus,
    /// Device memory of the session, bytes.
    pub memory: u64,
    /// Device memory of the pictures that re-use keeps, bytes.
    pub reuse_memory: u64,
    /// Reason why it keeps none of a swapchain.
    pub reuse_refused: Option<HistoryTooLarge>,
    /// Whether colour is removed.
    pub attenuates_colour: bool,
    /// The requested debug view.
    pub debug_view: DebugView,
    /// Whether `parafovea status` asks for it, instead of the configuration.
    pub debug_view_is_asked: bool,
    /// Whether it was drawn.
    pub debug_view_is_drawn: bool,
}

impl Default for StatusSnapshot {
    fn default() -> Self {
        Self {
            frames: 0,
            frame_rate_hz: 0.0,
            backend: 0,
            passes_matched: 0,
            gaze_is_given: false,
            gaze_source: GazeSource::Auto,
            active_gaze_source: ActiveGazeSource::Centre,
            osc: OscStatus::default(),
            gaze_is_valid: false,
            gaze_age_ms: None,
            signal: SignalQuality::default(),
            packet_delay_ms: None,
            drift_deg: None,
            audio_source: AudioSource::Off,
            is_heard: false,
            tiles: [0; TEXELS],
            gpu_decides: false,
            tiles_due: 0,
            shaded: 1.0,
            rates: GateStatus::default(),
            reuse: GateStatus::default(),
            memory: 0,
            reuse_memory: 0,
            reuse_refused: None,
            attenuates_colour: false,
            debug_view: DebugView::None,
            debug_view_is_asked: false,
            debug_view_is_drawn: false,
        }
    }
}

/// Status of a gate.
#[derive(Clone, Copy, Debug)]
pub struct GateStatus {
    mode: GateMode,
    is_kept: bool,
    is_on_trial: bool,
    ratio: Option<[f32; 3]>,
}

impl Default for GateStatus {
    /// Before the first frame: nothing is dropped.
    fn default() -> Self {
        Self { mode: GateMode::default(), is_kept: true, is_on_trial: false, ratio: None }
    }
}

impl GateStatus {
    /// Whether the technique was dropped, by its gate or by the configuration.
    pub fn is_dropped(&self) -> bool {
        self.mode == GateMode::Off || !self.is_kept
    }
}

impl From<&Gate> for GateStatus {
    fn from(gate: &Gate) -> Self {
        let ratio = gate.evidence().ratio();
        let ratio = ratio.map(|(ratio, [low, high])| [ratio, low, high].map(|value| value as f32));
        Self { mode: gate.mode(), is_kept: gate.is_kept(), is_on_trial: gate.wants_costs(), ratio }
    }
}

impl StatusSnapshot {
    /// Whether anything of the layer's work was visible in the last frame.
    pub fn has_effect(&self) -> bool {
        let has_maps = self.passes_matched > 0;
        let is_coarse = self.gpu_decides || self.has_coarse_tiles();
        let has_rates = has_maps && !self.rates.is_dropped() && is_coarse;
        let has_reuse = has_maps && !self.reuse.is_dropped() && self.tiles_due < self.tiles.iter().sum();
        has_rates || has_reuse || self.attenuates_colour
    }

    /// Whether any tile is coarser than 1x1.
    pub fn has_coarse_tiles(&self) -> bool {
        let is_coarse =
            |(texel, count): (usize, &u32)| *count > 0 && texel != usize::from(ShadingRate::R1X1.texel());
        self.tiles.iter().enumerate().any(is_coarse)
    }

    /// Counts the tiles of an eye's map.
    pub fn count(&mut self, texels: &[u8]) {
        for texel in texels {
            if let Some(count) = self.tiles.get_mut(usize::from(*texel)) {
                *count += 1;
            }
        }
    }

    /// Writes it to `status`. Numbers are rounded: they are for people, and reveal no more of the gaze than those need.
    pub fn write_to(&self, status: &mut Status) {
        status.frames = self.frames;
        status.frame_rate_hz = rounded(self.frame_rate_hz, 10.0);
        status.backend = match self.backend {
            BACKEND_RATE_ATTACHMENT => "rate attachment",
            BACKEND_MASK => "mask",
            _ => "none",
        }
        .to_owned();
        status.passes_matched = self.passes_matched;
        status.gaze = self.gaze_status();
        status.sound = status::Sound { source: self.audio_source.name().to_owned(), is_heard: self.is_heard };
        status.rates = self.rates_status();
        status.rates_gate = self.rates.status();
        status.reuse_gate = self.reuse.status();
        let mib = |bytes: u64| rounded(bytes as f32 / (1 << 20) as f32, 10.0);
        status.memory = status::Memory {
            all_mib: mib(self.memory),
            reuse_mib: mib(self.reuse_memory),
            refused: self.reuse_refused.map_or(String::new(), |reason| reason.to_string()),
        };
        status.attenuates_colour = self.attenuates_colour;
        status.debug_view = status::View {
            name: self.debug_view.name().to_owned(),
            is_asked: self.debug_view_is_asked,
            is_drawn: self.debug_view_is_drawn,
        };
    }

    fn gaze_status(&self) -> status::Gaze {
        let SignalQuality { rate_hz, valid, noise_deg, blinks, saccades } = self.signal;
        let of_packets = self.active_gaze_source == ActiveGazeSource::Osc && self.osc.rate_hz > 0.0;
        status::Gaze {
            source: self.gaze_source.name().to_owned(),
            holder: self.active_gaze_source.name().to_owned(),
            is_given: self.gaze_is_given,
            is_valid: self.gaze_is_valid,
            age_ms: self.gaze_age_ms.map(f32::round),
            // Frames see at most one sample each; the packet rate is the rate of samples.
            rate_hz: if of_packets { Some(self.osc.rate_hz) } else { rate_hz }.map(f32::round),
            valid: valid.map(|share| rounded(share, 100.0)),
            noise_deg: noise_deg.map(|noise| rounded(noise, 100.0)),
            blinks,
            saccades,
            packet_delay_ms: self.packet_delay_ms.map(f32::round),
            drift_deg: self.drift_deg.map(|drift| rounded(drift, 10.0)),
            osc: self.osc_status(),
        }
    }

    fn osc_status(&self) -> status::Osc {
        let OscStatus { address, failure, format, counts, .. } = self.osc;
        status::Osc {
            address: address.map(|address| address.to_string()).unwrap_or_default(),
            failure: failure.map(|kind| kind.to_string()).unwrap_or_default(),
            format: format.map(|format| format.name().to_owned()).unwrap_or_default(),
            packets: counts.packets,
            malformed: counts.malformed,
            implausible: counts.implausible,
            other_senders: counts.other_senders,
            late: counts.late,
            floods: counts.floods,
        }
    }

    /// The rates of the passes of the last frame: where none had any, everything was shaded; a mask knows shaded and skipped blocks alone, so many of a
    /// tile as its rate's pattern has ([`Pattern`]).
    fn rates_status(&self) -> status::Rates {
        let all: u32 = self.tiles.iter().sum();
        if all == 0 {
            return status::Rates { shaded: 1.0, rendered: 1.0, ..status::Rates::default() };
        }
        let rendered = rounded(self.tiles_due as f32 / all as f32, 100.0);
        if self.passes_matched == 0 {
            let tiles = vec![("1x1".to_owned(), 1.0)];
            return status::Rates { tiles, shaded: 1.0, rendered, ..status::Rates::default() };
        }
        let mut rates: Vec<(ShadingRate, f32)> = (0..)
            .zip(self.tiles)
            .filter(|(_, count)| *count > 0)
            .filter_map(|(texel, count)| Some((ShadingRate::from_texel(texel)?, count as f32 / all as f32)))
            .collect();
        rates.sort_by(|(one, _), (other, _)| one.fraction().total_cmp(&other.fraction()));
        let tiles = match self.backend {
            BACKEND_MASK => {
                let known: f32 = rates.iter().map(|(_, share)| share).sum();
                let skips =
                    |(rate, share): &(ShadingRate, f32)| (1.0 - Pattern::of(*rate).fraction()) * share;
                let skipped: f32 = rates.iter().map(skips).sum();
                let blocks = [(SKIPPED.to_owned(), skipped), ("1x1".to_owned(), known - skipped)];
                blocks.into_iter().filter(|(_, share)| *share > 0.0).collect::<Vec<_>>()
            }
            _ => rates
                .into_iter()
                .map(|(rate, share)| (format!("{}x{}", rate.width(), rate.height()), share))
                .collect(),
        };
        status::Rates {
            tiles: tiles.into_iter().map(|(rate, share)| (rate, rounded(share, 100.0))).collect(),
            shaded: rounded(self.shaded, 100.0),
            decided_on_gpu: self.gpu_decides,
            rendered,
        }
    }
}

/// The name of the 4x4 blocks that a mask leaves out, and fills from shaded ones.
const SKIPPED: &str = "skipped";

impl GateStatus {
    fn status(&self) -> status::Gate {
        let mode = match self.mode {
            GateMode::Auto => "auto",
            GateMode::On => "on",
            GateMode::Off => "off",
        };
        let ratio = self.ratio.map(|ratio| ratio.map(|value| rounded(value, 100.0)));
        status::Gate { mode: mode.to_owned(), is_kept: self.is_kept, is_on_trial: self.is_on_trial, ratio }
    }
}

/// To whole parts of 1, of which there are so many.
fn rounded(value: f32, parts: f32) -> f32 {
    (value * parts).round() / parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_dropped_before_the_first_frame() {
        let mut status = Status::default();
        StatusSnapshot::default().write_to(&mut status);
        assert!(status.frames == 0 && status.rates_gate.is_kept && status.reuse_gate.is_kept, "{status:?}");
    }

    #[test]
    fn rates_are_told_as_passes_obeyed_them() {
        let told = |backend, passes_matched| {
            let mut snapshot = StatusSnapshot {
                tiles_due: 3,
                shaded: 0.4,
                backend,
                passes_matched,
                ..StatusSnapshot::default()
            };
            let [fine, coarse] = [ShadingRate::R1X1, ShadingRate::R2X2].map(ShadingRate::texel);
            snapshot.count(&[coarse, fine, coarse, coarse, 0xff]);
            let mut status = Status::default();
            snapshot.write_to(&mut status);
            (status.backend, status.rates)
        };
        let named = |tiles: &[(&str, f32)]| -> Vec<(String, f32)> {
            tiles.iter().map(|(name, share)| ((*name).to_owned(), *share)).collect()
        };
        // The coarsest first.
        let (backend, rates) = told(BACKEND_RATE_ATTACHMENT, 2);
        assert_eq!(
            (backend.as_str(), rates.tiles),
            ("rate attachment", named(&[("2x2", 0.75), ("1x1", 0.25)]))
        );
        assert_eq!((rates.shaded, rates.rendered), (0.4, 0.75));
        // A quarter of the blocks of a tile with 2x2 is shaded.
        let (backend, rates) = told(BACKEND_MASK, 2);
        assert_eq!((backend.as_str(), rates.tiles), ("mask", named(&[("skipped", 0.56), ("1x1", 0.44)])));
        for backend in [BACKEND_RATE_ATTACHMENT, BACKEND_MASK] {
            let (_, rates) = told(backend, 0);
            assert_eq!((rates.tiles, rates.shaded), (named(&[("1x1", 1.0)]), 1.0), "left alone");
        }
    }

    #[test]
    fn only_coarse_rates_skipped_tiles_and_faded_colour_are_an_effect() {
        let mut snapshot = StatusSnapshot { passes_matched: 2, tiles_due: 1, ..StatusSnapshot::default() };
        snapshot.count(&[ShadingRate::R1X1.texel()]);
        assert!(!snapshot.has_effect());
        assert!(StatusSnapshot { attenuates_colour: true, ..snapshot }.has_effect());
        assert!(StatusSnapshot { gpu_decides: true, ..snapshot }.has_effect());
        assert!(StatusSnapshot { tiles_due: 0, ..snapshot }.has_effect());
        snapshot.count(&[ShadingRate::R2X2.texel()]);
        assert!(snapshot.has_effect());
        assert!(!StatusSnapshot { passes_matched: 0, ..snapshot }.has_effect(), "the maps reach no pass");
        let dropped = GateStatus { mode: GateMode::Off, ..GateStatus::default() };
        assert!(!StatusSnapshot { rates: dropped, reuse: dropped, ..snapshot }.has_effect());
    }

    #[test]
    fn without_maps_nothing_is_status() {
        let mut status = Status::default();
        StatusSnapshot::default().write_to(&mut status);
        assert_eq!(status.rates, status::Rates { shaded: 1.0, rendered: 1.0, ..status::Rates::default() });
    }
}
