//! The layer's decision about an application, in one line.

use parafovea_manifest::status::{Status, Topic};
use serde::Serialize;

/// Whether the layer shades coarsely, and why.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Decision {
    /// Whether any pass is shaded coarsely.
    pub engaged: bool,
    /// The reason, for people.
    pub decided: String,
}

impl Decision {
    /// Of the layer's status; None without the layer.
    pub fn of(status: Option<&Status>) -> Self {
        let Some(status) = status else { return Self::left_alone("the layer reported no status") };
        let gate = &status.rates_gate;
        let measured = gate.ratio.map_or(String::new(), |[ratio, low, high]| {
            format!("{ratio:.2} times the cost per frame ({low:.2} to {high:.2}) with coarser shading")
        });
        if !status.inert.is_empty() {
            return Self::left_alone(&status.inert);
        }
        if status.backend == "none" {
            let refused = status.decided(Topic::NoBackend).next_back();
            return Self::left_alone(
                refused.map_or("the device does not support coarser shading", |decision| &decision.line),
            );
        }
        // The figures are of frames with coarser shading and without, as the trial had them.
        if gate.is_on_trial {
            return Self::left_alone("no decision yet: a trial was in progress in the measured frames");
        }
        if !gate.is_kept {
            return Self::left_alone(&format!("trials measured {measured}"));
        }
        if status.passes_matched == 0 {
            let last = |topic| status.decided(topic).next_back();
            let why = match (last(Topic::NoMask).or(last(Topic::Unseen)), last(Topic::Scene)) {
                (Some(refused), _) => &refused.line,
                (None, Some(_)) => "the scene was recognised, but not shaded coarsely in the last frame",
                (None, None) => "no render pass was recognised as the scene",
            };
            return Self::left_alone(why);
        }
        let passes =
            if status.passes_matched == 1 { "1 pass" } else { &format!("{} passes", status.passes_matched) };
        let trials = if measured.is_empty() {
            "trials have no result yet".to_owned()
        } else {
            format!("trials measured {measured}")
        };
        let decided = format!("engaged: {} in {passes}; {trials}", status.backend);
        Self { engaged: true, decided }
    }

    fn left_alone(why: &str) -> Self {
        Self { engaged: false, decided: format!("unchanged: {why}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::{self, Gate};

    fn decision(topic: Topic, reason: &str, line: &str) -> status::Decision {
        status::Decision { topic, reason: reason.to_owned(), line: line.to_owned() }
    }

    fn status(is_kept: bool, ratio: Option<[f32; 3]>, passes_matched: u32) -> Status {
        let rates_gate = Gate { mode: "auto".to_owned(), is_kept, is_on_trial: false, ratio };
        let reason = "no depth attachment";
        let line = format!("scene passes of 512x512: no mask: {reason}");
        let decisions = vec![decision(Topic::NoMask, reason, &line)];
        Status { backend: "mask".to_owned(), rates_gate, passes_matched, decisions, ..Status::default() }
    }

    #[test]
    fn each_reason_is_told() {
        let told = |status: &Status| {
            let Decision { engaged, decided } = Decision::of(Some(status));
            (engaged, decided)
        };
        let pays = told(&status(true, Some([0.7, 0.65, 0.75]), 2));
        assert_eq!(
            pays,
            (
                true,
                "engaged: mask in 2 passes; trials measured 0.70 times the cost per frame (0.65 to 0.75) with coarser shading"
                    .to_owned()
            )
        );
        let (engaged, dear) = told(&status(false, Some([1.3, 1.2, 1.4]), 0));
        assert!(
            !engaged
                && dear.starts_with("unchanged: ")
                && dear.contains("1.30 times the cost per frame (1.20 to 1.40)"),
            "{dear}"
        );
        let mut on_trial = status(true, Some([0.7, 0.65, 0.75]), 2);
        on_trial.rates_gate.is_on_trial = true;
        let (engaged, undecided) = told(&on_trial);
        assert!(!engaged && undecided.contains("no decision yet"), "{undecided}");
        let unclear = told(&status(true, None, 1));
        assert!(unclear.0 && unclear.1.contains("1 pass;"), "{unclear:?}");
        let unmatched = told(&status(true, None, 0));
        assert_eq!(
            unmatched,
            (false, "unchanged: scene passes of 512x512: no mask: no depth attachment".to_owned())
        );
        // A decision in favour of coarse shading is not a reason against it.
        let decisions = vec![
            decision(Topic::Scene, "", "pass 8x8: the scene: left eye: named"),
            decision(Topic::Mask, "", "scene passes of 8x8: masked"),
        ];
        let masked = Status { decisions, ..status(true, None, 0) };
        assert!(told(&masked).1.contains("not shaded coarsely in the last frame"));
        let unrecognised = Status { decisions: Vec::new(), ..status(true, None, 0) };
        assert!(told(&unrecognised).1.contains("no render pass was recognised"));
        let inert = Status { inert: "Direct3D".to_owned(), ..status(true, None, 2) };
        assert_eq!(told(&inert), (false, "unchanged: Direct3D".to_owned()));
        let backend = Status { backend: "none".to_owned(), ..status(true, None, 2) };
        assert!(told(&backend).1.contains("does not support coarser shading"));
        let refusals = ["no rate attachments", "no masks either: Vulkan 1.0"];
        let decisions = refusals.map(|line| decision(Topic::NoBackend, "", line)).into();
        let refused = Status { decisions, ..backend };
        assert_eq!(told(&refused), (false, "unchanged: no masks either: Vulkan 1.0".to_owned()));
        assert!(!Decision::of(None).engaged);
    }
}
