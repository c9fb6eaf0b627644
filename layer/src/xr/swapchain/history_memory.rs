//! Memory of the pictures kept for re-use: images of a virtual swapchain beyond the number of the runtime's, and copies of depth.

use crate::kernels::compose::ImageMemory;
use crate::status::HistoryTooLarge;

/// The history may take this share of the memory that the system still has for the process: one part in so many. Two eyes take it twice, and the rest is
/// the application's.
const SHARE: u64 = 8;

/// Number of images of a virtual swapchain: the `usual` number of the runtime, or `least` for re-use if that is more. Devices that do not
/// report the remaining memory count as having enough.
///
/// # Errors
/// The images beyond `usual` would take too much of the remaining memory.
pub fn images(usual: u32, least: u32, memory: ImageMemory) -> Result<u32, HistoryTooLarge> {
    let needs = u64::from(least.saturating_sub(usual)).saturating_mul(memory.bytes);
    match memory.remaining {
        Some(remaining) if needs > remaining / SHARE => {
            Err(HistoryTooLarge { needs, remaining, share: SHARE })
        }
        _ => Ok(least.max(usual)),
    }
}

/// The reason why `count` copies of depth would take too much memory, if they would. The session's history takes `taken` bytes already, with
/// which the copies of both eyes count together.
pub fn depth_is_refused(count: u32, taken: u64, memory: ImageMemory) -> Option<HistoryTooLarge> {
    const EYES: u64 = 2;
    let needs = u64::from(count).saturating_mul(memory.bytes).saturating_add(taken);
    let remaining = memory.remaining?.saturating_add(taken);
    let share = SHARE / EYES;
    (needs > remaining / share).then_some(HistoryTooLarge { needs, remaining, share })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    #[test]
    fn history_takes_an_eighth_of_the_remaining_memory_at_most() {
        let of = |remaining| images(3, 7, ImageMemory { bytes: 10 * MIB, remaining });
        assert_eq!(of(None), Ok(7));
        assert_eq!(of(Some(320 * MIB)), Ok(7));
        let refused = HistoryTooLarge { needs: 40 * MIB, remaining: 320 * MIB - 1, share: 8 };
        assert_eq!(of(Some(320 * MIB - 1)), Err(refused));
        assert_eq!(of(Some(0)).map_err(|refused| refused.remaining), Err(0));
        let text = refused.to_string();
        assert!(text.contains("40.0 MiB, more than 1/8 of the 320.0 MiB"), "{text}");
    }

    #[test]
    fn depth_and_colour_of_both_eyes_share_their_part() {
        let of = |taken, remaining| {
            depth_is_refused(5, taken * MIB, ImageMemory { bytes: 8 * MIB, remaining: Some(remaining * MIB) })
        };
        assert_eq!(of(0, 160), None);
        let refused = HistoryTooLarge { needs: 40 * MIB, remaining: 159 * MIB, share: 4 };
        assert_eq!(of(0, 159), Some(refused));
        // What colour has taken does not remain any more.
        assert_eq!(of(40, 280), None);
        assert_eq!(of(40, 279).map(|refused| refused.needs), Some(80 * MIB));
        assert_eq!(depth_is_refused(5, 0, ImageMemory { bytes: u64::MAX, remaining: None }), None);
    }

    #[test]
    fn images_that_the_runtime_has_too_are_no_history() {
        let memory = ImageMemory { bytes: 10 * MIB, remaining: Some(0) };
        assert_eq!(images(3, 0, memory), Ok(3));
        assert_eq!(images(8, 7, memory), Ok(8));
    }
}
