//! Sound of a machine without a sound server: ALSA's loop-back card (`snd-aloop`), whose second device captures the sound of its first.

use crate::ring::{Format, Writer};
use crate::shared::Shared;
use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{BufferSize, Data, Device, FromSample, HostId, Sample, SampleFormat, StreamConfig};
use parafovea_core::audio::{MAX_CHANNELS, SAMPLE_RATES_HZ};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;

/// The cards of this machine, from the kernel. ALSA's library is not called unless the wanted card is present: it prints a lot to standard
/// error if it finds none.
const CARDS: &str = "/proc/asound/cards";

/// Reason why there is no sound from a loop-back card.
#[derive(Debug, Error)]
pub enum LoopbackError {
    /// There is none.
    #[error("no ALSA loopback card (snd-aloop)")]
    NoCard,
    /// It cannot be listened to.
    #[error("the ALSA loopback card cannot be captured: {0}")]
    Refused(#[from] cpal::Error),
    /// Its samples are not understood.
    #[error("the ALSA loopback card has an unsupported sample format ({0})")]
    Samples(SampleFormat),
}

/// Records until the capture ends, a better source is available, or the card fails.
///
/// # Errors
/// There is no such card, or it cannot be captured.
pub fn listen(shared: &Shared, is_better: impl Fn() -> bool) -> Result<(), LoopbackError> {
    let cards = std::fs::read_to_string(CARDS).unwrap_or_default();
    let card = loopback_card(&cards).ok_or(LoopbackError::NoCard)?;
    let host = cpal::host_from_id(HostId::Alsa)?;
    let device = host.devices()?.find(|device| is_monitor(device, card)).ok_or(LoopbackError::NoCard)?;
    let config = device.default_input_config()?;
    let format = Format {
        sample_rate_hz: config.sample_rate().clamp(*SAMPLE_RATES_HZ.start(), *SAMPLE_RATES_HZ.end()),
        channels: u32::from(config.channels()).min(MAX_CHANNELS),
    };
    let stream_config = StreamConfig {
        channels: format.channels as u16,
        sample_rate: format.sample_rate_hz,
        buffer_size: BufferSize::Default,
    };
    let sample_format = config.sample_format();
    let write = writer_of(sample_format).ok_or(LoopbackError::Samples(sample_format))?;
    let mut writer = shared.begin(format);
    let has_failed = Arc::new(AtomicBool::new(false));
    let failed = has_failed.clone();
    let stream = device.build_input_stream_raw(
        stream_config,
        sample_format,
        move |data: &Data, _| write(&mut writer, data),
        move |_| failed.store(true, Ordering::Relaxed),
        None,
    )?;
    stream.play()?;
    let Format { sample_rate_hz, channels } = format;
    shared
        .messages
        .say(format!("capturing the ALSA loopback card ({sample_rate_hz} Hz, {channels} channels)"));
    while !(shared.is_stopped() || is_better() || has_failed.load(Ordering::Relaxed)) {
        shared.sleep(Duration::from_millis(250));
    }
    Ok(())
}

/// The name of the first loop-back card in the kernel's list: ` 1 [Loopback       ]: Loopback - Loopback`.
fn loopback_card(cards: &str) -> Option<&str> {
    cards.lines().find_map(|line| {
        let (name, driver) = line.split_once('[')?.1.split_once("]:")?;
        driver.trim_start().starts_with("Loopback ").then(|| name.trim())
    })
}

/// Whether this is the end of the card that captures the sound of the other, unchanged.
fn is_monitor(device: &Device, card: &str) -> bool {
    device.id().is_ok_and(|id| id.id() == format!("hw:CARD={card},DEV=1"))
}

/// The callback's conversion of samples of this kind.
fn writer_of(format: SampleFormat) -> Option<fn(&mut Writer, &Data)> {
    Some(match format {
        SampleFormat::I16 => write::<i16>,
        SampleFormat::I24 => write::<cpal::I24>,
        SampleFormat::I32 => write::<i32>,
        SampleFormat::F32 => write::<f32>,
        SampleFormat::F64 => write::<f64>,
        SampleFormat::U8 => write::<u8>,
        SampleFormat::I8 => write::<i8>,
        SampleFormat::U16 => write::<u16>,
        SampleFormat::U32 => write::<u32>,
        _ => return None,
    })
}

fn write<T: cpal::SizedSample>(writer: &mut Writer, data: &Data)
where
    f32: FromSample<T>,
{
    if let Some(samples) = data.as_slice::<T>() {
        writer.write(samples.iter().map(|sample| f32::from_sample(*sample)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_back_card_is_found_by_its_driver() {
        let cards = " 0 [PCH            ]: HDA-Intel - HDA Intel PCH\n                      HDA Intel PCH at 0xf7f10000\n \
                     2 [Aloop          ]: Loopback - Loopback\n                      Loopback 1\n";
        assert_eq!(loopback_card(cards), Some("Aloop"));
        assert_eq!(
            loopback_card(" 0 [Loopback       ]: USB-Audio - Loopback\n"),
            None,
            "a microphone of that name"
        );
        assert_eq!(loopback_card("--- no soundcards ---\n"), None);
    }
}
