//! The capabilities of a device, as the planner takes them.

use crate::link::{BACKEND_MASK, BACKEND_NONE, CapabilitiesRecord};
use parafovea_core::rate::ShadingRate;
use smallvec::SmallVec;

/// Coarser rates than 1x1, and the size of a tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capabilities {
    rates: SmallVec<[ShadingRate; 16]>,
    texel: [u32; 2],
    is_cpu: bool,
    has_mask: bool,
}

impl Capabilities {
    /// The rates besides 1x1; empty if nothing can be made coarser.
    pub fn rates(&self) -> &[ShadingRate] {
        &self.rates
    }

    /// Size of a tile, pixels.
    pub fn texel(&self) -> [u32; 2] {
        self.texel
    }

    /// Whether the device is a CPU.
    pub fn is_cpu(&self) -> bool {
        self.is_cpu
    }

    /// Whether the rates come from a mask.
    pub fn has_mask(&self) -> bool {
        self.has_mask
    }
}

impl From<&CapabilitiesRecord> for Capabilities {
    /// Invalid rates, and rates larger than 4 pixels, are left out.
    fn from(record: &CapabilitiesRecord) -> Self {
        let count = if record.backend == BACKEND_NONE { 0 } else { record.rate_count as usize };
        let rates = record.rates.iter().take(count).filter_map(|texel| ShadingRate::from_texel(*texel));
        Self {
            rates: rates.filter(|rate| *rate != ShadingRate::R1X1).collect(),
            texel: record.texel,
            is_cpu: record.is_cpu == 1,
            has_mask: record.backend == BACKEND_MASK,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::BACKEND_RATE_ATTACHMENT;

    #[test]
    fn has_the_coarser_rates_of_the_record() {
        let mut record = CapabilitiesRecord {
            backend: BACKEND_MASK,
            texel: [8, 16],
            rate_count: 4,
            rates: [0; 16],
            is_cpu: 0,
        };
        let (coarse, fine) = (ShadingRate::R2X2.texel(), ShadingRate::R1X1.texel());
        record.rates[..5].copy_from_slice(&[coarse, fine, 0xff, coarse, ShadingRate::R4X4.texel()]);
        let capabilities = Capabilities::from(&record);
        assert_eq!(
            capabilities.rates(),
            [ShadingRate::R2X2, ShadingRate::R2X2],
            "as many as it says, and no nonsense"
        );
        assert_eq!((capabilities.texel(), capabilities.is_cpu()), ([8, 16], false));
        assert!(capabilities.has_mask());
        let attachment = CapabilitiesRecord { backend: BACKEND_RATE_ATTACHMENT, ..record };
        assert!(!Capabilities::from(&attachment).has_mask());
        assert!(Capabilities::from(&CapabilitiesRecord { is_cpu: 1, ..record }).is_cpu());
        assert!(
            Capabilities::from(&CapabilitiesRecord { rate_count: u32::MAX, ..record }).rates().len() == 3
        );
        assert_eq!(Capabilities::from(&CapabilitiesRecord { backend: BACKEND_NONE, ..record }).rates(), []);
    }
}
