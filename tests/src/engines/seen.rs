//! Outcome of one run of an engine.

use parafovea_manifest::status::{Status, Topic};
use parafovea_test_layers::SampleCount;
use std::collections::BTreeMap;

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// CPU time of a frame in each round, milliseconds: all threads of the application's process.
    pub cpu_ms: Vec<f64>,
    /// Samples of a frame that passed the depth test in the application's render passes; None if not counted.
    pub samples: Option<u64>,
    /// Rules that validation found broken, each with its violation, and their counts.
    pub broken: BTreeMap<String, usize>,
    /// The layer's log.
    pub log: String,
    /// The last of the layer's status; None without the layer.
    pub status: Option<Status>,
    /// The last text of `parafovea status`; empty without the layer.
    pub told: String,
}

impl Seen {
    /// From the engine's output, the layer's log, and the lines of the layer that counts samples.
    ///
    /// # Errors
    /// The engine did not print the cost of its frames.
    pub fn of(output: &str, log: &str, samples: &str, status: Option<Status>) -> Result<Self, String> {
        let numbers = |name: &'static str| {
            // Qt puts `qml: ` ahead of them.
            let lines = output.lines().map(|line| line.strip_prefix("qml: ").unwrap_or(line));
            let lines = lines.filter_map(move |line| line.strip_prefix("engine ")?.strip_prefix(name));
            lines.map(|line| {
                line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>()
            })
        };
        let rounds: Vec<[f64; 3]> = numbers("round:").filter_map(|numbers| numbers.try_into().ok()).collect();
        let [first, ..] = rounds.as_slice() else {
            return Err("it does not say what its frames cost".to_owned());
        };
        let cpu_ms: Vec<f64> = rounds.iter().map(|[frame, ..]| *frame).collect();
        let [frame, from, to] = *first;
        let frames = ((to - from) / frame).round();
        Ok(Self {
            cpu_ms,
            samples: counted(samples, from, to).map(|samples| (samples as f64 / frames) as u64),
            broken: broken(output),
            log: log.to_owned(),
            status,
            told: String::new(),
        })
    }

    /// Violations that are not in `without`. The counts of an engine's own violations differ from run to run.
    pub fn broken_beyond(&self, without: &Self) -> Vec<String> {
        let new = self.broken.iter().filter(|(rule, _)| !without.broken.contains_key(*rule));
        new.map(|(rule, count)| format!("{rule} ({count})")).collect()
    }

    /// Passes that were recognised as the scene, as the log names them.
    pub fn scene_passes(&self) -> Vec<String> {
        let decisions = self.status.iter().flat_map(|status| status.decided(Topic::Scene));
        decisions.map(|decision| decision.line.clone()).collect()
    }

    /// The safety limits in the text of `parafovea status`.
    pub fn limits(&self) -> Vec<String> {
        const NAMED: &str = "safety limit: ";
        self.told
            .lines()
            .flat_map(|line| line.split("; "))
            .filter_map(|part| part.strip_prefix(NAMED))
            .map(str::to_owned)
            .collect()
    }

    /// Reasons for which scene passes were left alone.
    pub fn refusals(&self) -> Vec<String> {
        let decisions = self.status.iter().flat_map(|status| status.decided(Topic::NoMask));
        let mut reasons: Vec<String> = decisions.map(|decision| decision.reason.clone()).collect();
        reasons.dedup();
        reasons
    }
}

/// Samples between two moments of the process's CPU time, milliseconds; None if they could not be counted.
fn counted(text: &str, from_ms: f64, to_ms: f64) -> Option<u64> {
    let counts: Vec<SampleCount> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if counts.is_empty() || counts.iter().any(|count| count.samples.is_none()) {
        return None;
    }
    let within = |ns: u64| (from_ms..to_ms).contains(&(ns as f64 / 1e6));
    let submits = counts.iter().flat_map(|count| &count.by_submit);
    Some(submits.filter(|submit| within(submit.process_cpu_ns)).map(|submit| submit.value).sum())
}

/// The beginning of a line ahead of a rule's text where the rule was reported as often as it will be, with or without other texts.
const LAST_REPORT: &str = "(Warning - This VUID has now been reported";

/// Rules in brackets, such as `[ VUID-vkCmdDraw-None-09600 ]`, with the line below, in which handles and counts differ in every run.
fn broken(output: &str) -> BTreeMap<String, usize> {
    let mut rules = BTreeMap::new();
    let is_part = |character: char| character.is_ascii_alphanumeric() || "-_".contains(character);
    let mut lines = output.lines();
    while let Some(line) = lines.next() {
        if !line.starts_with("Validation ") {
            continue;
        }
        let words = line.split(|character| !is_part(character));
        let mut named = words.filter(|word| word.starts_with("VUID-") || word.starts_with("SYNC-HAZARD"));
        let rule = named.next().unwrap_or(line);
        let text = lines.find(|line| !line.starts_with(LAST_REPORT)).unwrap_or_default().split_whitespace();
        let text = text.filter(|word| !word.contains(|character: char| character.is_ascii_digit()));
        *rules.entry(format!("{rule}: {}", text.collect::<Vec<_>>().join(" "))).or_default() += 1;
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::Decision;

    const OUTPUT: &str = "Godot\nengine round: 50.00 1000 1100\nqml: engine round: 60.00 1100 1220\n";

    #[test]
    fn rounds_and_samples_of_the_first_are_read() {
        let samples = r#"{"samples":900,"reason":null,"passes":9,"by_submit":[{"process_cpu_ns":900000000,"value":500},{"process_cpu_ns":1050000000,"value":300},{"process_cpu_ns":1150000000,"value":100}]}"#;
        let seen = Seen::of(OUTPUT, "", samples, None).unwrap();
        assert_eq!((seen.cpu_ms, seen.samples), (vec![50.0, 60.0], Some(150)));
        assert_eq!(Seen::of(OUTPUT, "", "", None).unwrap().samples, None);
        let failed = samples.replace("900,\"reason\":null", "null,\"reason\":\"a\"");
        assert_eq!(Seen::of(OUTPUT, "", &failed, None).unwrap().samples, None);
        assert!(Seen::of("engine failed: no OpenXR\n", "", "", None).is_err());
    }

    #[test]
    fn rules_that_are_broken_in_other_ways_are_new() {
        let layout = "Validation Error: [ VUID-vkCmdDraw-None-09600 ] | MessageID = 0x1\nexpects VkImage 0x8e to be in A\n";
        let hazard =
            "Validation Error: [ SYNC-HAZARD-WRITE-AFTER-WRITE ] | MessageID = 0x2\nhazard of a draw 17\n";
        let seen = |more: &str| Seen::of(&format!("{OUTPUT}{more}"), "", "", None).unwrap();
        let without = seen(hazard);
        let again = hazard.replace("17", "18").repeat(2);
        assert_eq!(seen(&again).broken_beyond(&without), Vec::<String>::new());
        let last = hazard.replace("hazard", &format!("{LAST_REPORT} 10 times, which is the limit).\nhazard"));
        assert_eq!(seen(&last).broken_beyond(&without), Vec::<String>::new());
        let other = hazard.replace("draw", "copy");
        let new = seen(&format!("{hazard}{other}{layout}{layout}")).broken_beyond(&without);
        assert_eq!(
            new,
            [
                "SYNC-HAZARD-WRITE-AFTER-WRITE: hazard of a copy (1)",
                "VUID-vkCmdDraw-None-09600: expects VkImage to be in A (2)"
            ]
        );
    }

    #[test]
    fn scene_passes_and_refusals_are_decisions_of_their_topics() {
        let decision = |topic, reason: &str, line: &str| Decision {
            topic,
            reason: reason.to_owned(),
            line: line.to_owned(),
        };
        let refused = "no depth attachment";
        let decisions = vec![
            decision(Topic::OtherPass, "", "pass 64x64 D16_UNORM: not the scene: no colour"),
            decision(Topic::Scene, "", "pass 320x240 A"),
            decision(Topic::NoMask, refused, "scene passes of 320x240: no mask"),
            decision(Topic::NoMask, refused, "scene passes of 160x120: no mask"),
        ];
        let status = Status { decisions, ..Status::default() };
        let seen = Seen::of(OUTPUT, "", "", Some(status)).unwrap();
        assert_eq!(seen.scene_passes(), ["pass 320x240 A"]);
        assert_eq!(seen.refusals(), [refused]);
        let told = "  gaze      file: valid; safety limit: below 7 a\n  re-use    on; safety limit: below 60 b\n  rates     on\n";
        let told = Seen { told: told.to_owned(), ..seen };
        assert_eq!(told.limits(), ["below 7 a", "below 60 b"]);
        let without = Seen::of(OUTPUT, "", "", None).unwrap();
        assert!(without.limits().is_empty());
        assert!(without.scene_passes().is_empty() && without.refusals().is_empty());
    }
}
