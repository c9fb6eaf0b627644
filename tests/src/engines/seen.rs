//! What came of one run of an engine.

use parafovea_manifest::status::Status;
use parafovea_test_layers::SampleCount;
use std::collections::BTreeMap;

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Width and height of an eye's picture, pixels.
    pub eye: [u32; 2],
    /// CPU time of a frame in each round, milliseconds: all threads of the application's process.
    pub cpu_ms: Vec<f64>,
    /// Samples of a frame that passed the depth test in the application's render passes; None if not counted.
    pub samples: Option<u64>,
    /// Rules that validation found broken, and how often.
    pub broken: BTreeMap<String, usize>,
    /// The layer's log.
    pub log: String,
    /// The last of the layer's status; None without the layer.
    pub status: Option<Status>,
}

impl Seen {
    /// Of what the engine printed, the layer logged, and the layer that counts samples wrote.
    ///
    /// # Errors
    /// The engine did not say what its frames cost.
    pub fn of(output: &str, log: &str, samples: &str, status: Option<Status>) -> Result<Self, String> {
        let numbers = |name: &'static str| {
            let lines =
                output.lines().filter_map(move |line| line.strip_prefix("engine ")?.strip_prefix(name));
            lines.map(|line| {
                line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>()
            })
        };
        let eye = numbers("eye:").next().unwrap_or_default();
        let rounds: Vec<[f64; 3]> = numbers("round:").filter_map(|numbers| numbers.try_into().ok()).collect();
        let (&[width, height], [first, ..]) = (eye.as_slice(), rounds.as_slice()) else {
            return Err("it does not say what its frames cost".to_owned());
        };
        let cpu_ms: Vec<f64> = rounds.iter().map(|[frame, ..]| *frame).collect();
        let [frame, from, to] = *first;
        let frames = ((to - from) / frame).round();
        Ok(Self {
            eye: [width as u32, height as u32],
            cpu_ms,
            samples: counted(samples, from, to).map(|samples| (samples as f64 / frames) as u64),
            broken: broken(output),
            log: log.to_owned(),
            status,
        })
    }

    /// Rules that are broken more often than in `without`.
    pub fn broken_beyond(&self, without: &Self) -> Vec<String> {
        let is_more =
            |(rule, count): &(&String, &usize)| without.broken.get(*rule).is_none_or(|before| before < count);
        self.broken.iter().filter(is_more).map(|(rule, count)| format!("{rule} ({count})")).collect()
    }

    /// Lines of the log about passes that were recognised as the scene, without their time.
    pub fn scene_passes(&self) -> Vec<String> {
        let lines = self.log.lines().filter_map(|line| Some(line.split_once(" INFO  pass ")?.1));
        lines.filter(|line| line.contains(": the scene: ")).map(str::to_owned).collect()
    }

    /// Reasons for which scene passes were left alone.
    pub fn refusals(&self) -> Vec<String> {
        let lines = self.log.lines().filter_map(|line| line.split_once("left alone by the mask backend: "));
        let mut reasons: Vec<String> = lines.map(|(_, reason)| reason.to_owned()).collect();
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

/// Rules in brackets, such as `[ VUID-vkCmdDraw-None-09600 ]`.
fn broken(output: &str) -> BTreeMap<String, usize> {
    let mut rules = BTreeMap::new();
    let is_part = |character: char| character.is_ascii_alphanumeric() || "-_".contains(character);
    for line in output.lines().filter(|line| line.starts_with("Validation ")) {
        let words = line.split(|character| !is_part(character));
        let mut named = words.filter(|word| word.starts_with("VUID-") || word.starts_with("SYNC-HAZARD"));
        let rule = named.next().unwrap_or(line).to_owned();
        *rules.entry(rule).or_default() += 1;
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str =
        "Godot\nengine eye: 640 480\nengine round: 50.00 1000 1100\nengine round: 60.00 1100 1220\n";

    #[test]
    fn rounds_and_samples_of_the_first_are_read() {
        let samples = r#"{"samples":900,"reason":null,"passes":9,"by_submit":[{"process_cpu_ns":900000000,"value":500},{"process_cpu_ns":1050000000,"value":300},{"process_cpu_ns":1150000000,"value":100}]}"#;
        let seen = Seen::of(OUTPUT, "", samples, None).unwrap();
        assert_eq!((seen.eye, seen.cpu_ms, seen.samples), ([640, 480], vec![50.0, 60.0], Some(150)));
        assert_eq!(Seen::of(OUTPUT, "", "", None).unwrap().samples, None);
        let failed = samples.replace("900,\"reason\":null", "null,\"reason\":\"a\"");
        assert_eq!(Seen::of(OUTPUT, "", &failed, None).unwrap().samples, None);
        assert!(Seen::of("engine failed: no OpenXR\n", "", "", None).is_err());
    }

    #[test]
    fn broken_rules_are_compared_by_how_often_they_are() {
        let line = "Validation Error: [ VUID-vkCmdDraw-None-09600 ] | MessageID = 0x1\n";
        let hazard = "Validation Error: [ SYNC-HAZARD-WRITE-AFTER-WRITE ] | MessageID = 0x2\n";
        let seen = |more: &str| Seen::of(&format!("{OUTPUT}{more}"), "", "", None).unwrap();
        let without = seen(hazard);
        assert_eq!(seen(hazard).broken_beyond(&without), Vec::<String>::new());
        assert_eq!(
            seen(&format!("{hazard}{line}{line}")).broken_beyond(&without),
            ["VUID-vkCmdDraw-None-09600 (2)"]
        );
        assert_eq!(seen(&hazard.repeat(2)).broken_beyond(&without), ["SYNC-HAZARD-WRITE-AFTER-WRITE (2)"]);
    }

    #[test]
    fn scene_passes_and_refusals_are_found_in_the_log() {
        let log = "T 1 INFO  pass 64x64 D16_UNORM: not the scene: no colour\nT 1 INFO  pass 320x240 A, 2 layers: the scene: left eye: draws\n\
            T 1 INFO  scene passes of 320x240: left alone by the mask backend: no depth attachment\n";
        let seen = Seen::of(OUTPUT, log, "", None).unwrap();
        assert_eq!(seen.scene_passes(), ["320x240 A, 2 layers: the scene: left eye: draws"]);
        assert_eq!(seen.refusals(), ["no depth attachment"]);
    }
}
