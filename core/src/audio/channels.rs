//! Positions of channels, and their weights (BS.1770-4, Table 4).

use ebur128::Channel;
use ebur128::Channel::{
    Center, Left, LeftSurround, Mm090, Mm135, Mp090, Mp135, Mp180, Right, RightSurround, Unused,
};

/// Positions of `channels` interleaved channels in the order of WAVE_FORMAT_EXTENSIBLE; `None` for 0 and above 8.
pub(super) fn positions(channels: u32) -> Option<&'static [Channel]> {
    Some(match channels {
        1 => &[Left],
        2 => &[Left, Right],
        3 => &[Left, Right, Center],
        4 => &[Left, Right, LeftSurround, RightSurround],
        5 => &[Left, Right, Center, LeftSurround, RightSurround],
        6 => &[Left, Right, Center, Unused, LeftSurround, RightSurround],
        7 => &[Left, Right, Center, Unused, Mp180, Mp090, Mm090],
        8 => &[Left, Right, Center, Unused, Mp135, Mm135, Mp090, Mm090],
        _ => return None,
    })
}

/// Weight of the energy of a position: 0 for LFE, 1.41 at 60 to 120 degrees, else 1.
pub(super) fn weight(position: Channel) -> f32 {
    match position {
        Unused => 0.0,
        LeftSurround | RightSurround | Mp090 | Mm090 => 1.41,
        _ => 1.0,
    }
}
