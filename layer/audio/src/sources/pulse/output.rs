//! The captured output: its monitor.

use crate::ring::Format;
use parafovea_core::audio::{MAX_CHANNELS, SAMPLE_RATES_HZ};
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
        let channels = u32::from(info.sample_spec.channels);
        Some(Self {
            monitor: info.monitor_source_index?,
            monitor_name,
            description: text(info.description.as_ref().unwrap_or(&info.name)),
            format: Format {
                sample_rate_hz: info.sample_spec.sample_rate.clamp(least, greatest),
                channels: if (1..=MAX_CHANNELS).contains(&channels) { channels } else { 2 },
            },
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
            channel_map: ChannelMap::new(positions(channels).iter().copied()),
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

/// The order of channels that [`parafovea_core::audio`] states.
fn positions(channels: u32) -> &'static [ChannelPosition] {
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

    fn info() -> SinkInfo {
        SinkInfo {
            name: c"out".to_owned(),
            monitor_source_index: Some(3),
            monitor_source_name: Some(c"out.monitor".to_owned()),
            sample_spec: SampleSpec { format: SampleFormat::S16Le, channels: 6, sample_rate: 384_000 },
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
        let wide = SampleSpec { channels: 12, ..info().sample_spec };
        assert_eq!(Output::of(&SinkInfo { sample_spec: wide, ..info() }).unwrap().format.channels, 2);
        assert_eq!(Output::of(&SinkInfo { monitor_source_index: None, ..info() }), None);
    }

    #[test]
    fn every_number_of_channels_has_as_many_places() {
        for channels in 1..=MAX_CHANNELS {
            assert_eq!(positions(channels).len(), channels as usize);
        }
    }
}
