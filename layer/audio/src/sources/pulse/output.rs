//! The captured output: its monitor.

use crate::ring::Format;
use parafovea_core::audio::SAMPLE_RATES_HZ;
use pulseaudio::protocol::ChannelPosition::{
    FrontCenter, FrontLeft, FrontRight, Lfe, Mono, RearCenter, RearLeft, RearRight, SideLeft, SideRight,
};
use pulseaudio::protocol::stream::{BufferAttr, StreamFlags};
use pulseaudio::protocol::{
    ChannelMap, ChannelPosition, ChannelVolume, Command, Prop, Props, RecordStreamParams, SampleFormat,
    SampleSpec, SinkInfo,
};
use std::fmt;

/// Length of the sound that comes at a time, milliseconds. The output gets to know it too: a smaller one would wake the whole
/// system more often.
const FRAGMENT_MS: u64 = 40;

/// Length of the sound that the server keeps for us when we are late, milliseconds.
const KEPT_MS: u64 = 250;

/// The monitor of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// The server's number for the monitor. Numbers are not given twice.
    monitor: u32,
    monitor_name: String,
    description: String,
    /// Positions of the recorded channels.
    positions: Vec<ChannelPosition>,
    /// The format of its recording: its own, as far as that is understood.
    pub format: Format,
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Format { sample_rate_hz, channels } = self.format;
        let Self { monitor_name, description, .. } = self;
        write!(f, "the output \"{description}\" ({monitor_name}, {sample_rate_hz} Hz, {channels} channels)")
    }
}

impl Output {
    /// The monitor of this output, if it has one.
    pub fn of(info: &SinkInfo) -> Option<Self> {
        let text = |text: &std::ffi::CStr| text.to_string_lossy().into_owned();
        let monitor_name = text(info.monitor_source_name.as_ref()?);
        let (least, greatest) = (*SAMPLE_RATES_HZ.start(), *SAMPLE_RATES_HZ.end());
        let positions = positions(&info.channel_map);
        Some(Self {
            monitor: info.monitor_source_index?,
            monitor_name,
            description: text(info.description.as_ref().unwrap_or(&info.name)),
            format: Format {
                sample_rate_hz: info.sample_spec.sample_rate.clamp(least, greatest),
                channels: positions.len() as u32,
            },
            positions,
        })
    }

    /// The command that records it.
    pub fn record(&self) -> Command {
        let Format { sample_rate_hz, channels } = self.format;
        let bytes = |milliseconds: u64| {
            let frames = u64::from(sample_rate_hz) * milliseconds / 1000;
            (frames * u64::from(channels) * size_of::<f32>() as u64) as u32
        };
        let mut props = Props::new();
        props.set(Prop::ApplicationName, c"Parafovea");
        props.set(Prop::MediaName, c"loudness and pitch");
        // Plasma shows its icon for microphones in use unless a stream is virtual.
        props.set_bytes(c"node.virtual", c"true".to_bytes_with_nul());
        Command::CreateRecordStream(RecordStreamParams {
            sample_spec: SampleSpec {
                format: SampleFormat::Float32Le,
                channels: channels as u8,
                sample_rate: sample_rate_hz,
            },
            channel_map: ChannelMap::new(self.positions.iter().copied()),
            source_index: Some(self.monitor),
            buffer_attr: BufferAttr {
                max_length: bytes(KEPT_MS),
                fragment_size: bytes(FRAGMENT_MS),
                ..BufferAttr::default()
            },
            flags: StreamFlags {
                // Never to a microphone.
                no_move: true,
                adjust_latency: true,
                // The user's settings for recordings must not make it quieter.
                start_muted: Some(false),
                ..StreamFlags::default()
            },
            cvolume: Some(ChannelVolume::norm(channels as u8)),
            props,
            ..RecordStreamParams::default()
        })
    }
}

/// Positions for the recording of an output with these channels: its own, in the order that [`parafovea_core::audio`] states, or left and
/// right for channels without such an order, as of a 2.1 output. The server then mixes them.
fn positions(map: &ChannelMap) -> Vec<ChannelPosition> {
    let own: Vec<_> = map.into_iter().collect();
    // Its position changes nothing.
    if own.len() == 1 {
        return own;
    }
    let rear = order(own.len()).to_vec();
    let side = rear.iter().copied().map(swap_side_and_rear).collect();
    let is_own =
        |order: &Vec<_>| order.len() == own.len() && order.iter().all(|position| own.contains(position));
    [rear, side].into_iter().find(is_own).unwrap_or_else(|| order(2).to_vec())
}

/// The other position for a channel of the surround.
fn swap_side_and_rear(position: ChannelPosition) -> ChannelPosition {
    match position {
        RearLeft => SideLeft,
        RearRight => SideRight,
        SideLeft => RearLeft,
        SideRight => RearRight,
        other => other,
    }
}

/// The order of channels that [`parafovea_core::audio`] states; stereo for a number that it does not know.
fn order(channels: usize) -> &'static [ChannelPosition] {
    match channels {
        1 => &[Mono],
        3 => &[FrontLeft, FrontRight, FrontCenter],
        4 => &[FrontLeft, FrontRight, RearLeft, RearRight],
        5 => &[FrontLeft, FrontRight, FrontCenter, RearLeft, RearRight],
        6 => &[FrontLeft, FrontRight, FrontCenter, Lfe, RearLeft, RearRight],
        7 => &[FrontLeft, FrontRight, FrontCenter, Lfe, RearCenter, SideLeft, SideRight],
        8 => &[FrontLeft, FrontRight, FrontCenter, Lfe, RearLeft, RearRight, SideLeft, SideRight],
        _ => &[FrontLeft, FrontRight],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_core::audio::MAX_CHANNELS;

    fn info() -> SinkInfo {
        SinkInfo {
            name: c"out".to_owned(),
            monitor_source_index: Some(3),
            monitor_source_name: Some(c"out.monitor".to_owned()),
            sample_spec: SampleSpec { format: SampleFormat::S16Le, channels: 6, sample_rate: 384_000 },
            channel_map: ChannelMap::new(order(6).iter().copied()),
            cvolume: ChannelVolume::norm(6),
            ..SinkInfo::default()
        }
    }

    #[test]
    fn an_output_is_recorded_as_it_is_as_far_as_it_is_understood() {
        let output = Output::of(&info()).unwrap();
        assert_eq!(output.format, Format { sample_rate_hz: 192_000, channels: 6 });
        let Command::CreateRecordStream(record) = output.record() else { panic!("no stream") };
        assert_eq!((record.source_index, record.sample_spec.channels), (Some(3), 6));
        assert!(record.flags.no_move, "an output that goes away must not lead to a microphone");
        assert_eq!(record.props.get_bytes(c"node.virtual"), Some(&b"true\0"[..]), "no icon of a microphone");
        assert_eq!(record.buffer_attr.fragment_size, 192_000 / 25 * 6 * 4);
        assert_eq!(Output::of(&SinkInfo { monitor_source_index: None, ..info() }), None);
    }

    #[test]
    fn channels_are_recorded_at_their_positions_or_mixed() {
        let surround = [FrontLeft, FrontRight, SideLeft, SideRight, FrontCenter, Lfe];
        let sorted = [FrontLeft, FrontRight, FrontCenter, Lfe, SideLeft, SideRight];
        let six_and_rear = [FrontLeft, FrontRight, FrontCenter, Lfe, RearCenter, RearLeft, RearRight];
        let stereo = [FrontLeft, FrontRight];
        for (map, recorded) in [
            (&surround[..], &sorted[..]),
            (&six_and_rear, &six_and_rear),
            (&[FrontCenter], &[FrontCenter]),
            (&[FrontRight, FrontLeft], &stereo),
            (&[FrontLeft, FrontRight, Lfe], &stereo),
            (&[FrontLeft, FrontRight, FrontCenter, RearCenter], &stereo),
            (&[FrontLeft, FrontLeft, FrontLeft], &stereo),
            (&[ChannelPosition::Aux0; 12], &stereo),
            (&[], &stereo),
        ] {
            let channel_map = ChannelMap::new(map.iter().copied());
            let output = Output::of(&SinkInfo { channel_map, ..info() }).unwrap();
            assert_eq!(output.format.channels as usize, recorded.len(), "{map:?}");
            let Command::CreateRecordStream(record) = output.record() else { panic!("no stream") };
            assert_eq!(record.channel_map.into_iter().collect::<Vec<_>>(), recorded, "{map:?}");
            assert_eq!(usize::from(record.sample_spec.channels), recorded.len());
        }
        for channels in 1..=MAX_CHANNELS as usize {
            let own = order(channels);
            assert_eq!(
                (positions(&ChannelMap::new(own.iter().copied())), own.len()),
                (own.to_vec(), channels)
            );
        }
    }
}
