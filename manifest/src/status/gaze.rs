//! The gaze of an application, in words.

use super::Gaze;
use std::fmt;

/// The delay of packets for prediction before it is measured, milliseconds.
pub const ASSUMED_DELAY_MS: u32 = 50;

/// Source, rate and age in one line.
impl fmt::Display for Gaze {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source = match (self.source.as_str(), self.holder.as_str()) {
            ("centre", _) => return f.write_str("fixed around the axis of each lens"),
            ("auto", "centre") => {
                f.write_str("no eye tracker: fixed around the axis of each lens")?;
                return f.write_str(&self.packets());
            }
            ("eyes", _) | (_, "eyes") => "eye tracker".to_owned(),
            ("osc", _) | (_, "osc") => match self.osc.format.as_str() {
                "" => "OSC".to_owned(),
                format => format!("OSC ({format})"),
            },
            (other, _) => other.to_owned(),
        };
        let rate = self.rate_hz.map_or(String::new(), |rate| format!(", {rate:.0} Hz"));
        let state = match (self.is_valid, self.age_ms) {
            (true, Some(age)) => format!("valid{rate}, {age:.0} ms old at display time"),
            (true, None) => format!("valid{rate}"),
            (false, Some(age)) => format!("lost for {:.1} s", age / 1000.0),
            (false, None) => "none".to_owned(),
        };
        let given = if self.is_given { ", given to the application" } else { "" };
        let delay =
            self.packet_delay_ms.map_or(String::new(), |delay| format!("; delay of packets {delay:.0} ms"));
        write!(f, "{source}: {state}{given}{}{delay}", self.packets())
    }
}

impl Gaze {
    /// The drift in words, with the command that corrects it; `None` without a drift.
    pub fn drift(&self) -> Option<String> {
        let drift = self.drift_deg?;
        Some(format!(
            "the mean gaze has drifted by {drift:.1} degrees since the first five minutes; if the headset slipped: parafovea gaze recentre"
        ))
    }

    /// The delay of packets in words; `None` if it is not known.
    pub fn packet_delay(&self) -> Option<String> {
        let delay = self.packet_delay_ms?;
        Some(format!(
            "{delay:.0} ms from an eye movement to the first displayed frame with the new gaze, measured with the runtime's eye tracker; {ASSUMED_DELAY_MS} ms were assumed before"
        ))
    }

    /// Reason why there are no packets; empty if there are, or if the application asks for none.
    fn packets(&self) -> String {
        match (self.osc.failure.as_str(), self.osc.address.as_str()) {
            ("", address) if !address.is_empty() && self.osc.packets == 0 => {
                format!("; no OSC packets at {address}")
            }
            ("", _) => String::new(),
            (failure, address) => format!("; no OSC packets: {address}: {failure}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::status::{Gaze, Osc};

    #[test]
    fn a_drift_is_told_with_the_command_against_it() {
        assert_eq!(Gaze::default().drift(), None);
        let drift = Gaze { drift_deg: Some(2.14), ..Gaze::default() }.drift().unwrap();
        assert!(
            drift.contains("drifted by 2.1 degrees") && drift.ends_with("parafovea gaze recentre"),
            "{drift}"
        );
    }

    #[test]
    fn the_source_in_use_is_named_and_why_packets_are_missing() {
        let gaze = |source: &str, holder: &str, osc| Gaze {
            source: source.to_owned(),
            holder: holder.to_owned(),
            osc,
            ..Gaze::default()
        };
        let at = |failure: &str, packets| Osc {
            address: "127.0.0.1:9020".to_owned(),
            failure: failure.to_owned(),
            packets,
            ..Osc::default()
        };
        let vrchat = Osc { format: "VRChat".to_owned(), ..at("", 9) };
        let fresh =
            Gaze { is_valid: true, age_ms: Some(58.0), rate_hz: Some(120.0), ..gaze("auto", "osc", vrchat) };
        let given = Gaze { is_given: true, ..fresh.clone() };
        let compared = Gaze { packet_delay_ms: Some(63.0), ..fresh.clone() };
        for (gaze, line) in [
            (compared, "OSC (VRChat): valid, 120 Hz, 58 ms old at display time; delay of packets 63 ms"),
            (given, "OSC (VRChat): valid, 120 Hz, 58 ms old at display time, given to the application"),
            (fresh, "OSC (VRChat): valid, 120 Hz, 58 ms old at display time"),
            (gaze("auto", "eyes", Osc::default()), "eye tracker: none"),
            (gaze("file", "file", Osc::default()), "file: none"),
            (gaze("centre", "centre", Osc::default()), "fixed around the axis of each lens"),
            (gaze("osc", "osc", at("", 0)), "OSC: none; no OSC packets at 127.0.0.1:9020"),
            (
                gaze("auto", "centre", at("address in use", 0)),
                "no eye tracker: fixed around the axis of each lens; no OSC packets: 127.0.0.1:9020: address in use",
            ),
        ] {
            assert_eq!(gaze.to_string(), line);
        }
    }
}
