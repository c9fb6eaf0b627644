//! Comparison of losses at equal cost, with the reasons if the layer loses more.

use crate::points::Sweep;
use crate::results::{Errors, PointResults, SceneResults};
use crate::statistics::{AtCost, Bootstrap, CostAndLoss, Interval, loss_at};

/// All techniques enabled, with the default preset.
pub const EVERYTHING: &str = "everything balanced";

/// The layer's techniques in the comparison: the presets, which a user selects by one word.
pub const OURS: Sweep = Sweep::Rates;

/// Alternatives of users without us, and our own rings, which a preset has to beat to measure contrast.
pub const RIVALS: [Sweep; 6] = [
    Sweep::FixedFoveation,
    Sweep::FilledFoveation,
    Sweep::RenderScale,
    Sweep::OpenXrToolkit,
    Sweep::Uniform,
    Sweep::Rings,
];

/// Method of pooling the changes of an image into one figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The mean over the view: changes far below the threshold count too, if there are many of them.
    Mean,
    /// Detection, by probability summation over the view.
    Detected,
    /// JOD that foveated FovVideoVDP takes off, where it was asked for.
    Jod,
}

impl Measure {
    /// All.
    pub const ALL: [Self; 3] = [Self::Mean, Self::Detected, Self::Jod];

    /// In a few words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Mean => "mean of the view",
            Self::Detected => "as detected",
            Self::Jod => "by JOD",
        }
    }

    /// The loss of a point in the frames in which the eyes do not jump, 0 for the application alone; `None` if it was not measured.
    pub fn of_point(self, point: &PointResults) -> Option<f64> {
        let Some(errors) = &point.errors else { return Some(0.0) };
        let frames: Vec<usize> =
            (0..errors.loss.len()).filter(|frame| !errors.is_in_flight(*frame)).collect();
        self.of(errors, &frames)
    }

    /// The loss in these frames; none where one of them was not measured.
    fn of(self, errors: &Errors, frames: &[usize]) -> Option<f64> {
        let mean = |values: &[f64]| {
            let sum = frames.iter().map(|&frame| values.get(frame)).sum::<Option<f64>>()?;
            Some(sum / frames.len() as f64)
        };
        match self {
            Self::Mean => mean(&errors.loss),
            Self::Detected => mean(&errors.detected),
            Self::Jod => errors.fvvdp.as_ref()?.lost_jod(frames.iter().copied()),
        }
    }
}

/// Outcome of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Ours loses less contrast at equal cost.
    Wins,
    /// The interval has 0 in it.
    Tie,
    /// Ours loses more.
    Loses,
    /// The other gets no cheaper than ours and loses less where it is cheapest: there is no equal cost.
    Apart,
}

impl Verdict {
    /// In a word or two.
    pub fn text(self) -> &'static str {
        match self {
            Self::Wins => "wins",
            Self::Tie => "tie",
            Self::Loses => "loses",
            Self::Apart => "no equal cost",
        }
    }
}

/// One technique of ours against a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Contest {
    /// Ours.
    pub technique: String,
    /// The others.
    pub rival: Sweep,
    /// The measure.
    pub measure: Measure,
    /// Our cost, in costs of the application alone.
    pub cost: f64,
    /// Our loss, JND, or JOD by that measure.
    pub loss: f64,
    /// The sweep's loss at that cost, or, if it is never as cheap, at its cheapest.
    pub rival_loss: f64,
    /// Whether the sweep is as cheap somewhere.
    pub is_reached: bool,
    /// Ours less theirs, likewise.
    pub difference: Option<Interval>,
    /// The outcome.
    pub verdict: Verdict,
}

/// Compares a technique with a sweep of the same scene, in the frames in which the eyes do not jump. None where either was not measured.
pub fn contest(
    scene: &SceneResults,
    technique: &str,
    rival: Sweep,
    measure: Measure,
    bootstrap: &Bootstrap,
) -> Option<Contest> {
    let ours = scene.point(technique)?;
    let sweep = scene.sweep(rival);
    if sweep.len() < 2 {
        return None;
    }
    let frames = sweep.iter().chain([&ours]).map(|point| frames(point)).min()?;
    let flight = sweep.iter().chain([&ours]).find_map(|point| point.errors.as_ref());
    let is_seen = |frame: &usize| !flight.is_some_and(|errors| errors.is_in_flight(*frame));
    let every: Vec<usize> = (0..frames).filter(is_seen).collect();
    let off = scene.off()?;
    let bootstrap = Bootstrap { clip: scene.frames_of_script, ..*bootstrap };
    let (own, at_cost) = found(measure, off, ours, &sweep, &every)?;
    let (rival_loss, is_reached) = match at_cost {
        AtCost::Loss(loss) => (loss, true),
        AtCost::OutOfReach { cheapest } => (cheapest, false),
    };
    let difference = bootstrap.interval(frames, |drawn| {
        let drawn: Vec<usize> = drawn.iter().copied().filter(is_seen).collect();
        let (own, at_cost) = found(measure, off, ours, &sweep, &drawn)?;
        match at_cost {
            AtCost::Loss(loss) => Some(own.loss - loss),
            // Cheaper than the other ever is: that it loses less too is a win, that it loses more decides nothing.
            AtCost::OutOfReach { cheapest } => (own.loss < cheapest).then_some(own.loss - cheapest),
        }
    });
    let verdict = match difference {
        None => Verdict::Apart,
        Some(interval) if interval.high < 0.0 => Verdict::Wins,
        Some(interval) if interval.low > 0.0 => Verdict::Loses,
        Some(_) => Verdict::Tie,
    };
    Some(Contest {
        technique: technique.to_owned(),
        rival,
        measure,
        cost: own.cost,
        loss: own.loss,
        rival_loss,
        is_reached,
        difference,
        verdict,
    })
}

/// Number of frames with both cost and loss of a point.
fn frames(point: &PointResults) -> usize {
    let timed = point.cost.as_ref().map_or(0, |cost| cost.frames_ms.len());
    point.errors.as_ref().map_or(timed, |errors| timed.min(errors.loss.len()))
}

/// Our loss in these frames, and the sweep's at equal cost.
fn found(
    measure: Measure,
    off: &PointResults,
    ours: &PointResults,
    sweep: &[&PointResults],
    drawn: &[usize],
) -> Option<(CostAndLoss, AtCost)> {
    let own = in_frames(measure, off, ours, drawn)?;
    let points: Option<Vec<_>> = sweep.iter().map(|point| in_frames(measure, off, point, drawn)).collect();
    Some((own, loss_at(&points?, own.cost)?))
}

/// Cost, in costs of the application alone, and loss of a point in these frames.
fn in_frames(
    measure: Measure,
    off: &PointResults,
    point: &PointResults,
    drawn: &[usize],
) -> Option<CostAndLoss> {
    let sum = |values: &[f64]| drawn.iter().map(|&frame| values.get(frame)).sum::<Option<f64>>();
    let cost = sum(&point.cost.as_ref()?.frames_ms)? / sum(&off.cost.as_ref()?.frames_ms)?;
    let loss = match &point.errors {
        Some(errors) => measure.of(errors, drawn)?,
        None => 0.0,
    };
    Some(CostAndLoss { cost, loss })
}

/// Reasons for a contest that was not won, in sentences, from cost and loss of each part of ours alone in that scene.
pub fn why_not(scene: &SceneResults, contest: &Contest) -> String {
    let mut reasons = Vec::new();
    if contest.cost >= 1.0 {
        reasons
            .push(format!("it costs {:.2} times as much as the application alone, a slowdown", contest.cost));
    }
    for sweep in [Sweep::Rates, Sweep::Reuse] {
        let alone = scene.points.iter().filter(|point| point.sweep == sweep);
        let dear =
            alone.filter_map(|point| Some((point, point.cost.as_ref()?))).find(|(_, cost)| cost.ratio >= 1.0);
        if let Some((point, cost)) = dear {
            reasons.push(format!("{} alone costs {:.2} times as much", point.technique, cost.ratio));
        }
    }
    let rates = scene.point("preset balanced").and_then(PointResults::cost_and_loss);
    if let Some(rates) = rates.filter(|rates| rates.cost < contest.cost && contest.measure == Measure::Mean) {
        reasons.push(format!(
            "rates alone cost {:.2} and lose {:.2} JND, so that the other techniques add {:.2} to the cost",
            rates.cost,
            rates.loss,
            contest.cost - rates.cost
        ));
    }
    if let Some(errors) = scene.point(&contest.technique).and_then(|point| point.errors.as_ref()) {
        let sum = |rings: &[Option<f64>]| rings.iter().flatten().sum::<f64>();
        let (stays, comes_and_goes) = (sum(&errors.sustained), sum(&errors.transient));
        if comes_and_goes > stays {
            reasons.push(
                "most of its loss is transient: the eyes move ahead of the map, or re-used tiles alternate"
                    .to_owned(),
            );
        }
    }
    if reasons.is_empty() {
        reasons.push("its map is coarser at the same cost".to_owned());
    }
    reasons.join("; ")
}

/// Outcomes of one of the layer's techniques against one rival, over the scenes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tally {
    /// Ours.
    pub technique: String,
    /// The other.
    pub rival: Sweep,
    /// The measure.
    pub measure: Measure,
    /// Number of scenes in which ours loses less contrast at equal cost.
    pub wins: usize,
    /// Number of scenes in which the interval includes 0.
    pub ties: usize,
    /// Number of scenes in which ours loses more.
    pub loses: usize,
    /// Number of scenes without an equal cost.
    pub apart: usize,
}

impl Tally {
    /// In a few words.
    pub fn text(&self) -> String {
        let Self { wins, ties, loses, apart, .. } = self;
        let rest = [(ties, "ties"), (loses, "loses"), (apart, "no equal cost")];
        let rest = rest.into_iter().filter(|(count, _)| **count > 0);
        rest.fold(format!("wins {wins}"), |text, (count, what)| format!("{text}, {what} {count}"))
    }
}

/// The contests of each technique against each rival by each measure, in the order of the contests.
pub fn tallies(contests: &[(&SceneResults, Contest)]) -> Vec<Tally> {
    let mut tallies: Vec<Tally> = Vec::new();
    for (_, contest) in contests {
        let Contest { technique, rival, measure, .. } = contest;
        let is_same =
            |tally: &Tally| (&tally.technique, tally.rival, tally.measure) == (technique, *rival, *measure);
        let index = tallies.iter().position(is_same).unwrap_or_else(|| {
            let none = Tally {
                technique: technique.clone(),
                rival: *rival,
                measure: *measure,
                wins: 0,
                ties: 0,
                loses: 0,
                apart: 0,
            };
            tallies.push(none);
            tallies.len() - 1
        });
        let tally = &mut tallies[index];
        let count = match contest.verdict {
            Verdict::Wins => &mut tally.wins,
            Verdict::Tie => &mut tally.ties,
            Verdict::Loses => &mut tally.loses,
            Verdict::Apart => &mut tally.apart,
        };
        *count += 1;
    }
    tallies
}
