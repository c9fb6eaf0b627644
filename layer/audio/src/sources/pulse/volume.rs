//! The output's volume: silence, and the part of it that the monitor does not contain.

use pulseaudio::protocol::{ServerInfo, SinkFlags, SinkInfo, Volume};
use std::ffi::CStr;

/// The property of PipeWire's outputs whose monitor contains the volume.
const MONITOR_HAS_VOLUME: &CStr = c"monitor.channel-volumes";

/// Whether this output is muted, or the volume of each channel is zero.
pub fn is_muted(info: &SinkInfo) -> bool {
    let volumes = info.cvolume.channels();
    info.muted || (!volumes.is_empty() && volumes.iter().all(|volume| *volume == Volume::MUTED))
}

/// Whether the server is PipeWire: its name is `PulseAudio (on PipeWire 1.4.2)`.
pub fn is_pipewire(info: &ServerInfo) -> bool {
    info.server_name.as_ref().is_some_and(|name| name.to_string_lossy().contains("on PipeWire"))
}

/// Factor for samples of this output's monitor that makes them as loud as the output, 0..=1. The loudest channel decides.
///
/// PulseAudio's monitors contain the volume unless the hardware applies it. PipeWire's do not, whoever applies it, unless a property of the
/// output demands it.
pub fn gain(info: &SinkInfo, is_pipewire: bool) -> f32 {
    let is_contained = if is_pipewire {
        info.props.get_bytes(MONITOR_HAS_VOLUME).is_some_and(is_true)
    } else {
        !info.flags.contains(SinkFlags::HW_VOLUME_CTRL)
    };
    if is_contained {
        return 1.0;
    }
    let volumes = info.cvolume.channels().iter().map(Volume::to_linear);
    volumes.reduce(f32::max).unwrap_or(1.0).min(1.0)
}

/// Whether a property is set, as PipeWire reads it.
fn is_true(value: &[u8]) -> bool {
    matches!(value.strip_suffix(b"\0").unwrap_or(value), b"true" | b"1")
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulseaudio::protocol::{ChannelVolume, Props};

    /// Volumes of two channels, percent.
    fn volumes(percent: [u32; 2]) -> ChannelVolume {
        let mut volumes = ChannelVolume::empty();
        let raw = |percent: u32| (Volume::NORM.as_u32() * percent).div_ceil(100);
        percent.iter().for_each(|percent| volumes.push(Volume::from_u32_clamped(raw(*percent))));
        volumes
    }

    #[test]
    fn muted_and_without_volume_are_silence() {
        for (muted, percent, expected) in [
            (false, [100, 100], false),
            (true, [100, 100], true),
            (false, [0, 100], false),
            (false, [0, 1], false),
            (false, [0, 0], true),
        ] {
            let info = SinkInfo { muted, cvolume: volumes(percent), ..SinkInfo::default() };
            assert_eq!(is_muted(&info), expected, "{muted} {percent:?}");
        }
    }

    #[test]
    fn a_volume_that_the_monitor_lacks_counts_once() {
        let [software, hardware] = [SinkFlags::DECIBEL_VOLUME, SinkFlags::HW_VOLUME_CTRL];
        for (is_pipewire, flags, property, percent, expected) in [
            (false, software, None, [10, 10], 1.0),
            (false, hardware, None, [10, 10], 0.001),
            (false, hardware, None, [10, 50], 0.125),
            (false, hardware, None, [0, 0], 0.0),
            (false, hardware, None, [150, 150], 1.0),
            (false, hardware, Some("true"), [10, 10], 0.001),
            (true, software, None, [50, 50], 0.125),
            (true, software, Some("false"), [10, 10], 0.001),
            (true, software, Some("true"), [10, 10], 1.0),
            (true, software, Some("1"), [10, 10], 1.0),
            (true, hardware, None, [10, 10], 0.001),
            (true, hardware, Some("true"), [10, 10], 1.0),
        ] {
            let mut props = Props::new();
            if let Some(value) = property {
                props.set_bytes(MONITOR_HAS_VOLUME, format!("{value}\0"));
            }
            let info = SinkInfo { flags, props, cvolume: volumes(percent), ..SinkInfo::default() };
            let found = gain(&info, is_pipewire);
            assert!(
                (found - expected).abs() < 1e-5,
                "{is_pipewire} {flags:?} {property:?} {percent:?}: {found}"
            );
        }
        let unknown = SinkInfo { flags: hardware, cvolume: ChannelVolume::empty(), ..SinkInfo::default() };
        assert_eq!(gain(&unknown, false), 1.0);
    }

    #[test]
    fn pipewire_is_known_by_its_name() {
        for (name, expected) in
            [(Some(c"PulseAudio (on PipeWire 0.3.65)"), true), (Some(c"pulseaudio"), false), (None, false)]
        {
            let info = ServerInfo { server_name: name.map(Into::into), ..ServerInfo::default() };
            assert_eq!(is_pipewire(&info), expected, "{name:?}");
        }
    }
}
