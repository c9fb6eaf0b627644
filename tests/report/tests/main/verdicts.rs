//! Comparison of losses at equal cost.

use crate::made_up::{results, scene};
use parafovea_report::page::contests;
use parafovea_report::points::Sweep;
use parafovea_report::statistics::Bootstrap;
use parafovea_report::verdict::{EVERYTHING, Measure, Verdict, contest, tallies, why_not};

fn verdict(everything: (f64, f64), rival: Sweep) -> Verdict {
    let scene = scene("cockpit", everything, 0.2);
    contest(&scene, EVERYTHING, rival, Measure::Mean, &Bootstrap::default()).unwrap().verdict
}

#[test]
fn a_smaller_loss_at_equal_cost_wins() {
    // FR loses halfway from 0.5 to 1.5 at the geometric mean of 0.6 and 0.4, which is 0.49.
    assert_eq!(verdict((0.49, 0.5), Sweep::FixedFoveation), Verdict::Wins);
    assert_eq!(verdict((0.49, 1.0), Sweep::FixedFoveation), Verdict::Tie);
    assert_eq!(verdict((0.49, 1.8), Sweep::FixedFoveation), Verdict::Loses);
    assert_eq!(verdict((0.5, 1.0), Sweep::RenderScale), Verdict::Wins);
}

#[test]
fn a_slowdown_loses_to_the_application_alone() {
    assert_eq!(verdict((1.2, 0.1), Sweep::FixedFoveation), Verdict::Loses);
    assert_eq!(verdict((1.2, 0.1), Sweep::RenderScale), Verdict::Loses);
}

#[test]
fn a_cost_below_the_rivals_range_wins_only_with_a_smaller_loss() {
    assert_eq!(verdict((0.2, 1.0), Sweep::FixedFoveation), Verdict::Wins);
    assert_eq!(verdict((0.2, 3.0), Sweep::FixedFoveation), Verdict::Apart);
}

/// Much that is not seen outweighs little that is in one measure, and not in the other.
#[test]
fn the_measures_are_told_apart() {
    let mut scene = scene("cockpit", (0.49, 1.8), 0.2);
    for point in scene.points.iter_mut().filter(|point| point.technique == EVERYTHING) {
        point.errors.as_mut().unwrap().detected.iter_mut().for_each(|detected| *detected = 0.1);
    }
    let verdict = |measure| {
        contest(&scene, EVERYTHING, Sweep::FixedFoveation, measure, &Bootstrap::default()).unwrap().verdict
    };
    assert_eq!([Measure::Mean, Measure::Detected].map(verdict), [Verdict::Loses, Verdict::Wins]);
}

/// The difference is of the same frames: it is surer than cost and loss themselves.
#[test]
fn the_interval_holds_the_difference() {
    let scene = scene("cockpit", (0.49, 0.5), 0.2);
    let contest =
        contest(&scene, EVERYTHING, Sweep::FixedFoveation, Measure::Mean, &Bootstrap::default()).unwrap();
    let interval = contest.difference.unwrap();
    let difference = contest.loss - contest.rival_loss;
    assert!(interval.low <= difference && difference <= interval.high, "{interval:?}, {difference}");
    assert!(interval.high - interval.low < 0.3, "{interval:?}");
    assert!((contest.rival_loss - 1.0).abs() < 0.05, "{contest:?}");
}

#[test]
fn scenes_are_counted_and_what_is_not_won_is_explained() {
    let mut results = results();
    for point in results.scenes.iter_mut().flat_map(|scene| &mut scene.points) {
        // The technique whose cost and loss differ by scene becomes the one that a user selects.
        point.sweep = match point.sweep {
            Sweep::Everything => Sweep::Rates,
            Sweep::Rates => Sweep::Everything,
            other => other,
        };
    }
    let contests = contests(&results.scenes);
    assert_eq!(contests.len(), 8, "two scenes against two rivals, by both measures");
    let tallies = tallies(&contests);
    assert_eq!(tallies.len(), 4, "two rivals, by both measures");
    assert!(tallies.iter().all(|tally| tally.text() == "wins 1, loses 1"), "{tallies:?}");
    let lost = contests.iter().find(|(scene, _)| scene.scene == "foliage").unwrap();
    let why = why_not(lost.0, &lost.1);
    assert!(why.contains("1.30 times as much as the application alone"), "{why}");
    assert!(why.contains("rates alone cost 0.55"), "{why}");
}
