//! Does what a plan says.

mod conditions;
mod map;

use crate::bits;
use crate::pictures::Pictures;
use crate::plan::{Plan, judging, rendering};
use crate::points::{Point, Sweep};
use crate::progress::Progress;
use crate::results::{Cost, Errors, Fine, HardCase, PointResults, Results, SceneResults, mean};
use parafovea_errors::{Metric, RINGS, Report};
use parafovea_models::hard_cases;
use parafovea_scene::scene::SceneName;
use parafovea_tests::HarnessError;
use parafovea_tests::device::Machine;
use parafovea_tests::measure::{
    Counts, Effort, Subject, Technique, Timing, judge, take_turns, with_pictures,
};
use parafovea_tests::run::Outcome;
use parafovea_tests::scenario::Scenario;

/// Measures all of `plan`; pictures go to `pictures`, and `command` is what was typed.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn measure(plan: &Plan, command: &str, pictures: &mut Pictures) -> Result<(Results, f64), HarnessError> {
    let machine = Machine::of(plan.driver)?;
    eprintln!("{machine}");
    let conditions = conditions::conditions(plan, &machine, command);
    let mut progress = Progress::new(plan.runs(), plan.work());
    let mut scenes = Vec::new();
    for &scene in &plan.scenes {
        scenes.push(measure_scene(plan, scene, &machine, pictures, &mut progress)?);
    }
    let fine = plan.fine.map(|fine| measure_finely(plan, fine, &machine, &mut progress)).transpose()?;
    Ok((Results { conditions, scenes, fine, hard_cases: hard_cases() }, progress.seconds()))
}

/// Somebody in a scene whose eyes jump so many frames after the start.
fn subject(plan: &Plan, scene: SceneName, machine: &Machine, jump: u64) -> Subject {
    Subject::before_a_saccade(scene, plan.tracker, jump).on(machine)
}

fn measure_scene(
    plan: &Plan,
    scene: SceneName,
    machine: &Machine,
    pictures: &mut Pictures,
    progress: &mut Progress,
) -> Result<SceneResults, HarnessError> {
    // In the middle of the frames that are judged, which are the first of those that are timed.
    let jump = plan.judged.run_up + plan.judged.frames / 2;
    let subject = subject(plan, scene, machine, jump);
    let effort = plan.judged;
    let scenario = with_pictures(subject.scenario(effort), effort);
    let middle = effort.run_up + effort.frames / 2;
    let mut reference: Option<Outcome> = None;
    let (mut points, mut timings, mut bits) = (Vec::new(), Vec::new(), Vec::new());
    for point in &plan.points {
        let name = &point.technique.name;
        progress.next(&format!("{}: {name}, pictures", subject.name()));
        let map = map::File::new()?;
        let shown = show(&subject, &point.technique, effort, &scenario, |run| map.asked_for(run.counted()))?;
        progress.add(rendering(effort));
        let counts = Counts::of(&shown, effort)?;
        pictures.keep(scene.as_str(), name, &shown.eye(0, middle)?, map.read(middle)?.as_ref());
        let errors = match &reference {
            None => None,
            Some(reference) => {
                let report = judge(&subject, &scenario, reference, &shown)?;
                progress.add(judging(effort));
                if point.sweep == Sweep::Chroma {
                    bits.extend(bits::measure(name, reference, &shown, &scenario)?);
                }
                Some(errors(&report))
            }
        };
        reference.get_or_insert(shown);
        timings.push(Timing::new(&point.technique, counts));
        points.push(point_results(point, counts, errors));
    }
    drop(reference);
    let costs = costs(plan, &subject, machine, timings, progress)?;
    for ((index, _), cost) in plan.timed_points().zip(costs) {
        points[index].cost = Some(cost);
    }
    Ok(SceneResults { scene: scene.as_str().to_owned(), points, bits })
}

fn show(
    subject: &Subject,
    technique: &Technique,
    effort: Effort,
    scenario: &Scenario,
    set_up: impl FnOnce(parafovea_tests::run::Run) -> parafovea_tests::run::Run,
) -> Result<Outcome, HarnessError> {
    set_up(subject.run_as(technique, effort, scenario)?).finish()?.expect_frames(effort.length())
}

fn point_results(point: &Point, counts: Counts, errors: Option<Errors>) -> PointResults {
    PointResults {
        sweep: point.sweep,
        technique: point.technique.name.clone(),
        fragments: counts.fragments,
        samples: counts.samples,
        cost: None,
        errors,
    }
}

/// The costs of the timed points.
fn costs(
    plan: &Plan,
    subject: &Subject,
    machine: &Machine,
    timings: Vec<Timing>,
    progress: &mut Progress,
) -> Result<Vec<Cost>, HarnessError> {
    let techniques: Vec<Technique> = plan.timed_points().map(|(_, point)| point.technique.clone()).collect();
    let mut timed: Vec<Timing> = timings
        .into_iter()
        .zip(&plan.points)
        .filter(|(_, point)| point.is_timed)
        .map(|(timing, _)| timing)
        .collect();
    let on_gpu = machine.has_gpu_times();
    take_turns(subject, &techniques, plan.timed, on_gpu, &mut timed, |run| {
        progress.next(run);
        progress.add(rendering(plan.timed));
    })?;
    let samples = |timing: &Timing| if on_gpu { timing.gpu_ms.clone() } else { timing.cpu_ms.clone() };
    let Some(off) = timed.first().map(samples) else { return Ok(Vec::new()) };
    let cost = |timing| {
        let own = samples(timing);
        let ratio = own.ratio_to(&off);
        Cost {
            median_ms: own.median(),
            p99_ms: own.quantile(0.99),
            ratio: ratio.value,
            spread: ratio.spread,
            frames_ms: own.least().collect(),
        }
    };
    Ok(timed.iter().map(cost).collect())
}

/// Errors of one scene at the finest resolution, while the eyes rest.
fn measure_finely(
    plan: &Plan,
    (scene, effort): (SceneName, Effort),
    machine: &Machine,
    progress: &mut Progress,
) -> Result<Fine, HarnessError> {
    let subject = subject(plan, scene, machine, effort.length());
    let scenario = with_pictures(subject.scenario(effort), effort);
    let mut reference: Option<Outcome> = None;
    let mut points = Vec::new();
    let mut pixels_per_degree = 0.0;
    for point in &plan.points {
        progress.next(&format!(
            "{}: {}, pictures at {} pixels",
            subject.name(),
            point.technique.name,
            effort.size
        ));
        let shown = show(&subject, &point.technique, effort, &scenario, |run| run)?;
        progress.add(rendering(effort));
        if let Some(reference) = &reference {
            let report = judge(&subject, &scenario, reference, &shown)?;
            progress.add(judging(effort));
            pixels_per_degree = report.eyes[0].as_ref().map_or(0.0, |eye| eye.pixels_per_degree);
            points.push((point.technique.name.clone(), errors(&report)));
        }
        reference.get_or_insert(shown);
    }
    let judged = [effort.run_up, effort.frames, u64::from(effort.size)];
    Ok(Fine { scene: scene.as_str().to_owned(), pixels_per_degree, judged, points })
}

fn errors(report: &Report) -> Errors {
    let rings = |metric| std::array::from_fn(|ring| report.row(metric, ring).mean);
    let frames = |metric| report.by_frame(metric).iter().map(|mean| mean.unwrap_or(0.0));
    let whole = |metric| mean(report.by_frame(metric).iter().copied().flatten());
    // Rings of a root mean square are put together by their power.
    let power = (0..RINGS).filter_map(|ring| {
        let row = report.row(Metric::Flicker, ring);
        Some((row.mean?.powi(2) * row.pixels as f64, row.pixels))
    });
    let (power, pixels) = power.fold((0.0, 0), |(sum, all), (power, pixels)| (sum + power, all + pixels));
    let chroma = [Metric::RedGreen, Metric::YellowViolet].map(|metric| whole(metric).unwrap_or(0.0));
    Errors {
        loss: frames(Metric::Sustained)
            .zip(frames(Metric::Transient))
            .map(|(stays, goes)| stays + goes)
            .collect(),
        sustained: rings(Metric::Sustained),
        transient: rings(Metric::Transient),
        flicker: (pixels > 0).then(|| (power / pixels as f64).sqrt()),
        chroma: Some(chroma[0].max(chroma[1])),
        flip: whole(Metric::Flip),
    }
}

fn hard_cases() -> Vec<HardCase> {
    let cases = hard_cases::table().into_iter();
    cases
        .map(|case| HardCase {
            model: case.model.to_owned(),
            case: case.case,
            expected: case.expected,
            got: case.got,
            error: case.error,
            passed: case.passed,
        })
        .collect()
}
