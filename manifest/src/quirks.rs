//! Drivers and devices that need another way than the specification promises: one table, used by the layer and printed
//! by `parafovea doctor` and `parafovea status`.
//!
//! `PARAFOVEA_QUIRKS=+name,-name` adds and removes rows in one process, to find a remedy for a report.

mod table;

pub use table::QUIRKS;

/// The variable that adds quirks (`+name` or `name`) and removes them (`-name`), apart by commas.
pub const QUIRKS_VARIABLE: &str = "PARAFOVEA_QUIRKS";

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quirk {
    /// Its name, in kebab-case.
    pub name: &'static str,
    /// The driver's behaviour and the layer's answer, in one line.
    pub doc: &'static str,
    /// `VkDriverId` of the drivers that have it.
    pub driver: u32,
    /// Devices of that driver that have it.
    pub devices: Devices,
    /// The first version of the driver without it (major, minor, patch); `None`: there is none yet.
    pub fixed_in: Option<[u32; 3]>,
    /// The layer's answer.
    pub effect: Effect,
    /// Source of the information.
    pub source: &'static str,
}

/// Devices of one driver, by words of their names, such as `NAVI21`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Devices {
    /// With one of these.
    Named(&'static [&'static str]),
    /// Without any of these.
    Others(&'static [&'static str]),
}

impl Devices {
    fn include(self, name: &str) -> bool {
        let has = |word: &&str| {
            name.split(|at: char| !at.is_ascii_alphanumeric() && at != '_').any(|is| is == *word)
        };
        match self {
            Self::Named(words) => words.iter().any(has),
            Self::Others(words) => !words.iter().any(has),
        }
    }
}

/// The layer's answer to a quirk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Only passes that were recognised as the scene get a rate attachment in dynamic rendering, and only subpasses with depth.
    AttachOnlyMatched,
    /// Rate attachments have one layer, even if the driver reports layered ones: both eyes share the finer rates.
    FirstLayerOnly,
    /// Rates hold up to this many samples a pixel: a power of two.
    MaxSamples(u32),
    /// A warning where vkd3d-proton runs.
    WarnVkd3d,
}

/// A driver and its device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Driver<'a> {
    /// `VkPhysicalDeviceDriverProperties::driverID`; 0 where it is not known.
    pub id: u32,
    /// `VkPhysicalDeviceProperties::deviceName`.
    pub device: &'a str,
    /// `VkPhysicalDeviceProperties::driverVersion`, as Mesa encodes it: major, minor, patch.
    pub version: [u32; 3],
}

impl Quirk {
    /// Whether a driver has it.
    pub fn is_of(&self, driver: &Driver<'_>) -> bool {
        self.driver == driver.id
            && self.devices.include(driver.device)
            && self.fixed_in.is_none_or(|fixed| driver.version < fixed)
    }
}

/// The quirks that hold for a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Quirks {
    /// Rows of the table, in its order.
    pub rows: Vec<&'static Quirk>,
    /// Words of the variable that name no row.
    pub unknown: Vec<String>,
}

impl Quirks {
    /// The quirks of a driver, as `changes` adds and removes them: the value of [`QUIRKS_VARIABLE`], or empty.
    pub fn of(driver: &Driver<'_>, changes: &str) -> Self {
        let mut holds = QUIRKS.map(|quirk| quirk.is_of(driver));
        let mut unknown = Vec::new();
        for word in changes.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            let (name, adds) = match word.strip_prefix('-') {
                Some(name) => (name, false),
                None => (word.strip_prefix('+').unwrap_or(word), true),
            };
            match QUIRKS.iter().position(|quirk| quirk.name == name) {
                Some(index) => holds[index] = adds,
                None => unknown.push(word.to_owned()),
            }
        }
        let rows = QUIRKS.iter().zip(holds).filter_map(|(quirk, holds)| holds.then_some(quirk)).collect();
        Self { rows, unknown }
    }

    /// Whether one of them has this effect.
    pub fn has(&self, effect: Effect) -> bool {
        self.rows.iter().any(|quirk| quirk.effect == effect)
    }

    /// The least number of samples that they allow; `None`: the driver's number.
    pub fn max_samples(&self) -> Option<u32> {
        let of = |quirk: &&Quirk| match quirk.effect {
            Effect::MaxSamples(samples) => Some(samples),
            _ => None,
        };
        self.rows.iter().filter_map(of).min()
    }

    /// The variable's mistake; `None` if every word names a row.
    pub fn complaint(&self) -> Option<String> {
        let allowed = || QUIRKS.map(|quirk| quirk.name).join(", ");
        let unknown = self.unknown.join(", ");
        (!unknown.is_empty()).then(|| {
            format!("{QUIRKS_VARIABLE}: unknown quirk {unknown}; allowed: {}, each with + or -", allowed())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADV: u32 = 3;

    fn names(id: u32, device: &str, version: [u32; 3], changes: &str) -> Vec<&'static str> {
        let quirks = Quirks::of(&Driver { id, device, version }, changes);
        quirks.rows.iter().map(|quirk| quirk.name).collect()
    }

    #[test]
    fn rows_have_names_of_their_own_and_say_where_they_are_from() {
        for (index, quirk) in QUIRKS.iter().enumerate() {
            let is_kebab = |at: char| at.is_ascii_lowercase() || at.is_ascii_digit() || at == '-';
            assert!(quirk.name.chars().all(is_kebab), "{}", quirk.name);
            assert!(QUIRKS[..index].iter().all(|other| other.name != quirk.name), "{}", quirk.name);
            assert!(!quirk.source.is_empty() && !quirk.doc.is_empty());
            if let Effect::MaxSamples(samples) = quirk.effect {
                assert!(samples.is_power_of_two(), "{}", quirk.name);
            }
        }
    }

    #[test]
    fn a_family_is_matched_by_whole_words_of_the_name() {
        let of = |device| names(RADV, device, [25, 0, 7], "");
        let rdna2 = ["attach-only-matched", "first-layer-only", "four-samples", "vkd3d-flicker"];
        assert_eq!(of("AMD Radeon RX 6800 XT (RADV NAVI21)"), rdna2);
        assert_eq!(of("AMD Custom GPU 0405 (RADV VANGOGH)"), rdna2);
        assert_eq!(of("AMD Radeon RX 7900 XTX (RADV NAVI31)"), ["four-samples", "vkd3d-flicker"]);
        assert_eq!(of("AMD Radeon RX 5700 XT (RADV NAVI10)"), [""; 0]);
        assert_eq!(of("AMD RADV SIENNA_CICHLID (ACO)"), rdna2);
        assert_eq!(of("AMD RADV POLARIS10 (LLVM 11.0.0)"), [""; 0]);
        assert_eq!(
            names(6, "Intel(R) Arc(tm) A770 (RADV NAVI21)", [25, 0, 7], ""),
            [""; 0],
            "another driver"
        );
    }

    /// Names from after the table was written, and one that tells nothing.
    #[test]
    fn unknown_devices_count_as_rdna3_or_later() {
        for device in [
            "AMD Radeon RX (RADV GFX1250)",
            "AMD Radeon RX 9070 XT (RADV GFX1201)",
            "AMD Radeon RX (RADV NAVI210)",
            "AMD Radeon",
        ] {
            assert_eq!(names(RADV, device, [25, 0, 7], ""), ["four-samples", "vkd3d-flicker"], "{device}");
            assert_eq!(names(RADV, device, [27, 0, 0], ""), ["vkd3d-flicker"], "{device}");
        }
        assert_eq!(names(4, "Intel(R) Arc(tm) (RADV GFX1250)", [25, 0, 7], ""), [""; 0], "another driver");
    }

    #[test]
    fn quirks_end_with_the_version_that_fixed_them() {
        let of = |version| names(RADV, "AMD Radeon (RADV NAVI31)", version, "");
        assert!(of([26, 1, 9]).contains(&"four-samples"));
        assert!(!of([26, 2, 6]).contains(&"four-samples"));
    }

    #[test]
    fn the_variable_adds_and_removes_and_wrong_names_are_told() {
        let (device, version) = ("AMD Radeon (RADV NAVI21)", [26, 2, 6]);
        assert_eq!(
            names(RADV, device, version, "-attach-only-matched, +four-samples,-vkd3d-flicker"),
            ["first-layer-only", "four-samples"]
        );
        assert_eq!(names(0, "llvmpipe", [0; 3], "attach-only-matched"), ["attach-only-matched"]);
        let quirks =
            Quirks::of(&Driver { id: 0, device: "", version: [0; 3] }, "-none-such,,+first-layer-only");
        assert_eq!(quirks.unknown, ["-none-such"]);
        let complaint = quirks.complaint().unwrap();
        assert!(complaint.contains("-none-such") && complaint.contains("first-layer-only"), "{complaint}");
        assert!(quirks.has(Effect::FirstLayerOnly) && !quirks.has(Effect::AttachOnlyMatched));
        assert_eq!(Quirks::default().complaint(), None);
        assert_eq!((quirks.max_samples(), Quirks::default().max_samples()), (None, None));
    }
}
