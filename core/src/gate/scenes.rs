//! Scenes, and the decision about each.

use super::evidence::Evidence;

/// Time without its set of eye passes after which a scene has ended, nanoseconds: intermittent passes (a grab pass, a refraction, a
/// scope) are absent for less.
pub const SCENE_HOLD_NS: i64 = 10_000_000_000;

/// A short scene ends sooner: once its set was absent for this multiple of the scene's length. At an application's start pass detection
/// finds one pass after the other.
const YOUNG_HOLD: i64 = 4;

/// Most stored decisions; the scene with the oldest one then needs a new trial.
const MOST: usize = 8;

/// A decision, with its evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decision {
    pub(super) is_on: bool,
    pub(super) evidence: Evidence,
}

/// The current scene, and decisions in earlier ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Scenes {
    current: Option<u32>,
    began_ns: i64,
    seen_ns: i64,
    decisions: [Option<(u32, Decision)>; MOST],
    next: usize,
}

impl Scenes {
    /// Takes the set of eye passes of a frame, if there was any, and returns whether a scene begins with it.
    pub(super) fn frame(&mut self, passes: Option<u32>, now_ns: i64) -> bool {
        self.seen_ns = self.seen_ns.min(now_ns);
        self.began_ns = self.began_ns.min(now_ns);
        let Some(passes) = passes else { return false };
        let is_new = match self.current {
            Some(current) if current == passes => false,
            Some(_) => {
                let hold_ns = YOUNG_HOLD.saturating_mul(self.seen_ns.saturating_sub(self.began_ns));
                now_ns.saturating_sub(self.seen_ns) >= hold_ns.min(SCENE_HOLD_NS)
            }
            None => true,
        };
        if is_new {
            (self.current, self.began_ns) = (Some(passes), now_ns);
        }
        if self.current == Some(passes) {
            self.seen_ns = now_ns;
        }
        is_new
    }

    /// Whether the passes belong to the current scene.
    pub(super) fn is_current(&self, passes: Option<u32>) -> bool {
        passes.is_some() && self.current == passes
    }

    /// The earlier decision in the current scene.
    pub(super) fn decision(&self) -> Option<Decision> {
        let known = self.decisions.iter().flatten().find(|known| Some(known.0) == self.current);
        known.map(|known| known.1)
    }

    /// Forgets the decisions in all scenes.
    pub(super) fn forget_decisions(&mut self) {
        self.decisions = [None; MOST];
    }

    /// Stores the decision in the current scene.
    pub(super) fn decide(&mut self, decision: Decision) {
        let Some(current) = self.current else { return };
        let same = self.decisions.iter_mut().flatten().find(|known| known.0 == current);
        if let Some(known) = same {
            known.1 = decision;
            return;
        }
        self.decisions[self.next] = Some((current, decision));
        self.next = (self.next + 1) % MOST;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: i64 = 1_000_000_000;

    #[test]
    fn a_pass_that_comes_and_goes_begins_no_scene() {
        let mut scenes = Scenes::default();
        let begun: Vec<i64> = (0..600)
            .filter(|second| scenes.frame(Some(2 + (second / 5 % 2) as u32), second * SECOND))
            .collect();
        assert_eq!(begun, [0]);
    }

    /// Recognition finds passes within a second: the set that stays is the scene.
    #[test]
    fn sets_of_an_applications_first_frames_do_not_last() {
        let mut scenes = Scenes::default();
        let begun: Vec<i64> = (0..200)
            .filter(|frame| scenes.frame(Some([2, 4, 7][(frame / 5).min(2) as usize]), frame * SECOND / 90))
            .collect();
        assert_eq!(begun.first(), Some(&0));
        assert!(scenes.is_current(Some(7)) && *begun.last().unwrap() < 45, "{begun:?}");
    }

    #[test]
    fn a_set_of_passes_that_stays_away_ends_the_scene_and_its_decision_is_remembered() {
        let mut scenes = Scenes::default();
        assert!(scenes.frame(Some(2), 0) && !scenes.frame(None, 60 * SECOND));
        let decision = Decision { is_on: false, evidence: Evidence::default() };
        scenes.decide(decision);
        let begun = (61..80).find(|second| scenes.frame(Some(7), second * SECOND));
        assert_eq!(begun, Some(61), "nothing was seen of the old one for a minute");
        assert_eq!(scenes.decision(), None);
        assert!(!scenes.frame(Some(7), 79 * SECOND));
        let begun = (80..100).find(|second| scenes.frame(Some(2), second * SECOND));
        assert_eq!((begun, scenes.decision()), (Some(89), Some(decision)));
        for scene in 10..30 {
            scenes.frame(Some(scene), i64::from(scene) * 100 * SECOND);
            scenes.decide(decision);
        }
        assert_eq!(scenes.decisions.iter().flatten().count(), MOST);
    }
}
