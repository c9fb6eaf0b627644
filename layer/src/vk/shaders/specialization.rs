//! The specialisation constants that a pipeline sets.

use crate::abi::copies::slice;
use ash::vk;
use smallvec::SmallVec;

/// Values by number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Specialization(SmallVec<[(u32, Option<u32>); 8]>);

impl Specialization {
    /// Of numbers and values.
    #[cfg(test)]
    pub fn of(values: &[(u32, u32)]) -> Self {
        Self(values.iter().map(|&(number, value)| (number, Some(value))).collect())
    }

    /// Of a stage.
    ///
    /// # Safety
    ///
    /// The pointer is null, or points to a valid structure.
    pub unsafe fn read(info: *const vk::SpecializationInfo<'_>) -> Self {
        // SAFETY: null or valid, as `# Safety` demands.
        let Some(info) = (unsafe { info.as_ref() }) else { return Self::default() };
        // SAFETY: a valid structure has so many entries and bytes.
        let (entries, data) = unsafe {
            let entries = slice(info.p_map_entries, info.map_entry_count);
            (entries, slice(info.p_data.cast::<u8>(), u32::try_from(info.data_size).unwrap_or(0)))
        };
        let value = |entry: &vk::SpecializationMapEntry| {
            let from = entry.offset as usize;
            let bytes = data.get(from..from.checked_add(entry.size)?)?;
            Some(u32::from_ne_bytes(bytes.try_into().ok()?))
        };
        Self(entries.iter().map(|entry| (entry.constant_id, value(entry))).collect())
    }

    /// The value of a constant of 32 bits of that number; `None` if it is set to something else.
    pub fn value(&self, number: u32, default: u32) -> Option<u32> {
        self.0.iter().find(|(known, _)| *known == number).map_or(Some(default), |(_, value)| *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_four_bytes_are_read() {
        let data: Vec<u8> = [7u32, 9].iter().flat_map(|word| word.to_ne_bytes()).collect();
        let entry = |constant_id, offset, size| vk::SpecializationMapEntry { constant_id, offset, size };
        let entries = [entry(1, 0, 4), entry(2, 4, 4), entry(3, 0, 8), entry(4, 6, 4), entry(5, 0, 1)];
        let info = vk::SpecializationInfo::default().map_entries(&entries).data(&data);
        // SAFETY: a valid structure, but for an entry beyond its data.
        let read = unsafe { Specialization::read(&info) };
        let values: Vec<_> = (1..=6).map(|number| read.value(number, 100)).collect();
        assert_eq!(values, [Some(7), Some(9), None, None, None, Some(100)]);
        // SAFETY: null.
        assert_eq!(unsafe { Specialization::read(std::ptr::null()) }, Specialization::default());
    }
}
