//! Executes a plan.

mod conditions;
mod hardware;
mod map;

use crate::bits;
use crate::pictures::Pictures;
use crate::plan::{Plan, judging, rendering};
use crate::points::{Point, Sweep};
use crate::results::{Cost, Errors, Fine, HardCase, PointResults, Results, SceneResults, mean};
use parafovea_models::errors::fvvdp::Differences;
use parafovea_models::errors::{Metric, RINGS, Report};
use parafovea_models::hard_cases;
use parafovea_scene::scene::SceneName;
use parafovea_tests::HarnessError;
use parafovea_tests::device::Machine;
use parafovea_tests::measure::{
    Counts, Effort, JudgedRun, Subject, Technique, Timing, jod, judge, judge_runs, take_turns, with_pictures,
};
use parafovea_tests::progress::Progress;
use parafovea_tests::run::Outcome;
use parafovea_tests::scenario::Scenario;
use std::panic::resume_unwind;
use std::thread::{self, available_parallelism};

/// Measures all of `plan`; images go to `pictures`, and `command` is the typed command.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn measure(plan: &Plan, command: &str, pictures: &mut Pictures) -> Result<(Results, f64), HarnessError> {
    let machine = Machine::of(plan.driver)?;
    eprintln!("{machine}");
    let conditions = conditions::conditions(plan, &machine, command);
    let mut progress = Progress::new(plan.work());
    let (mut scenes, mut hardware) = (Vec::new(), Vec::new());
    for &scene in &plan.scenes {
        let (timed, shaded) = measure_scene(plan, scene, &machine, pictures, &mut progress)?;
        scenes.push(timed);
        hardware.extend(shaded);
    }
    let fine = plan.fine.map(|fine| measure_finely(plan, fine, &machine, &mut progress)).transpose()?;
    Ok((Results { conditions, scenes, hardware, fine, hard_cases: hard_cases() }, progress.seconds()))
}

/// A user in a scene, with a saccade at frame `jump`.
fn subject(plan: &Plan, scene: SceneName, machine: &Machine, jump: u64) -> Subject {
    Subject::before_a_saccade(scene, plan.tracker, jump).on(machine)
}

fn measure_scene(
    plan: &Plan,
    scene: SceneName,
    machine: &Machine,
    pictures: &mut Pictures,
    progress: &mut Progress,
) -> Result<(SceneResults, Option<SceneResults>), HarnessError> {
    // In the middle of the judged frames, which are the first of the timed frames.
    let jump = plan.judged.run_up + plan.judged.frames / 2;
    let subject = subject(plan, scene, machine, jump);
    let effort = plan.judged;
    let scenario = with_pictures(subject.scenario(effort), effort);
    let middle = effort.run_up + effort.frames / 2;
    let mut reference: Option<Outcome> = None;
    let (mut points, mut timings, mut bits) = (Vec::new(), Vec::new(), Vec::new());
    for together in plan.points.chunks(available_parallelism().map_or(1, usize::from)) {
        let mut shown = Vec::new();
        for point in together {
            let name = &point.technique.name;
            progress.next(&format!("{}: {name}, pictures", subject.name()));
            let map = map::File::new()?;
            let outcome =
                show(&subject, &point.technique, effort, &scenario, |run| map.asked_for(run.counted()))?;
            progress.add(rendering(effort));
            pictures.keep(scene.as_str(), name, &outcome.eye(0, middle)?, map.read(middle)?.as_ref());
            if reference.is_none() {
                let counts = Counts::of(&outcome, effort)?;
                timings.push(Timing::new(&point.technique, counts));
                points.push(point_results(point, counts, None));
                reference = Some(outcome);
            } else {
                shown.push((point, Counts::of(&outcome, effort)?, outcome));
            }
        }
        let Some(reference) = &reference else { continue };
        let judged = at_once(&shown, |(point, _, shown)| {
            let run = |outcome| JudgedRun { subject: &subject, scenario: &scenario, outcome };
            let errors = judged(plan, effort, run(reference), run(shown))?;
            let is_chroma = point.sweep == Sweep::Chroma;
            let name = &point.technique.name;
            let bits = is_chroma.then(|| bits::measure(name, reference, shown, &scenario)).transpose()?;
            Ok((errors, bits))
        })?;
        for ((point, counts, _), (errors, bits_of)) in shown.iter().zip(judged) {
            progress.add(plan.judging());
            timings.push(Timing::new(&point.technique, *counts));
            points.push(point_results(point, *counts, Some(errors)));
            bits.extend(bits_of.into_iter().flatten());
        }
    }
    let hardware = match &reference {
        Some(reference) if !plan.hardware.is_empty() => {
            progress.next(&format!("{}: maps {}", subject.name(), plan.look.text()));
            let mut found = hardware::measure(plan, (&subject, &scenario, effort), reference, &points)?;
            progress.add(plan.hardware.len() as u64 * plan.judging());
            for script in 1..plan.scripts {
                let subject = Subject::glancing(scene, plan.tracker, script, jump).on(machine);
                progress.next(&format!("{}: maps {}, gaze {script}", subject.name(), plan.look.text()));
                hardware::join(&mut found, glances(plan, &subject)?);
                progress.add(plan.work_of_script());
            }
            Some(found)
        }
        _ => None,
    };
    drop(reference);
    let costs = costs(plan, &subject, machine, timings, progress)?;
    for ((index, _), cost) in plan.timed_points().zip(costs) {
        points[index].cost = Some(cost);
    }
    let scene = scene.as_str().to_owned();
    Ok((SceneResults { scene, points, bits, frames_of_script: 0 }, hardware))
}

/// The maps and the render scales, while the eyes look elsewhere.
fn glances(plan: &Plan, subject: &Subject) -> Result<SceneResults, HarnessError> {
    let effort = plan.judged;
    let scenario = with_pictures(subject.scenario(effort), effort);
    let reference = show(subject, &Technique::off(), effort, &scenario, |run| run)?;
    let scales = plan.points.iter().filter(|point| point.sweep == Sweep::RenderScale);
    let scaled = scales.map(|point| {
        let shown = show(subject, &point.technique, effort, &scenario, |run| run.counted())?;
        let run = |outcome| JudgedRun { subject, scenario: &scenario, outcome };
        let errors = judged(plan, effort, run(&reference), run(&shown))?;
        Ok(point_results(point, Counts::of(&shown, effort)?, Some(errors)))
    });
    let scaled = scaled.collect::<Result<Vec<_>, HarnessError>>()?;
    hardware::measure(plan, (subject, &scenario, effort), &reference, &scaled)
}

/// The eye whose pictures are judged by JOD: the other's are much the same, and each takes twice as long as all other judgements together.
const EYE_OF_JOD: usize = 0;

/// Computes the errors of the images of `test`.
fn judged(
    plan: &Plan,
    effort: Effort,
    reference: JudgedRun,
    test: JudgedRun,
) -> Result<Errors, HarnessError> {
    let report = judge_runs(reference, test)?;
    let jod = plan.fvvdp.as_ref().map(|fvvdp| jod(fvvdp, reference, test, EYE_OF_JOD)).transpose()?;
    let fvvdp = jod.map(|jod| jod.differences);
    Ok(errors(&report, &flights(test.subject, effort), fvvdp))
}

/// Whether the eyes are in a saccade, for each judged frame.
fn flights(subject: &Subject, effort: Effort) -> Vec<bool> {
    (effort.run_up..effort.length()).map(|frame| subject.is_in_flight(frame)).collect()
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
    if plan.timed_points().next().is_none() {
        return Ok(Vec::new());
    }
    let techniques: Vec<Technique> = plan.timed_points().map(|(_, point)| point.technique.clone()).collect();
    let mut timed: Vec<Timing> = timings
        .into_iter()
        .zip(&plan.points)
        .filter(|(_, point)| point.is_timed)
        .map(|(timing, _)| timing)
        .collect();
    let on_gpu = machine.has_gpu_times();
    let work: u64 = techniques.iter().map(|technique| rendering(plan.timed.of(technique))).sum();
    take_turns(subject, &techniques, plan.timed, on_gpu, &mut timed, |run| {
        progress.next(run);
        progress.add(work / techniques.len() as u64);
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
            frames_ms: own.by_frame().collect(),
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
    for together in plan.fine_points().chunks(available_parallelism().map_or(1, usize::from)) {
        let mut others = Vec::new();
        for Point { technique, .. } in together {
            let Effort { size, .. } = effort;
            progress.next(&format!("{}: {}, pictures at {size} pixels", subject.name(), technique.name));
            let shown = show(&subject, technique, effort, &scenario, |run| run)?;
            progress.add(rendering(effort));
            match &reference {
                None => reference = Some(shown),
                Some(_) => others.push((&technique.name, shown)),
            }
        }
        let Some(reference) = &reference else { continue };
        let reports = at_once(&others, |(_, shown)| judge(&subject, &scenario, reference, shown))?;
        for ((name, _), report) in others.iter().zip(reports) {
            progress.add(judging(effort));
            pixels_per_degree = report.eyes[0].as_ref().map_or(0.0, |eye| eye.pixels_per_degree);
            points.push(((*name).clone(), errors(&report, &flights(&subject, effort), None)));
        }
    }
    let judged = [effort.run_up, effort.frames, u64::from(effort.size)];
    Ok(Fine { scene: scene.as_str().to_owned(), pixels_per_degree, judged, points })
}

/// Does the same with each, each on a thread.
fn at_once<T: Sync, R: Send>(
    each: &[T],
    what: impl Fn(&T) -> Result<R, HarnessError> + Sync,
) -> Result<Vec<R>, HarnessError> {
    thread::scope(|scope| {
        let started: Vec<_> = each.iter().map(|one| scope.spawn(|| what(one))).collect();
        started.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

fn errors(report: &Report, in_flight: &[bool], fvvdp: Option<Differences>) -> Errors {
    let rings = |metric| std::array::from_fn(|ring| report.row(metric, ring).mean);
    let whole = |metric| mean(report.by_frame(metric).iter().copied().flatten());
    // Rings of a root mean square are put together by their power.
    let power = (0..RINGS).filter_map(|ring| {
        let row = report.row(Metric::Flicker, ring);
        Some((row.mean?.powi(2) * row.pixels as f64, row.pixels))
    });
    let (power, pixels) = power.fold((0.0, 0), |(sum, all), (power, pixels)| (sum + power, all + pixels));
    let chroma = [Metric::RedGreen, Metric::YellowViolet].map(|metric| whole(metric).unwrap_or(0.0));
    Errors {
        loss: report.loss_by_frame(),
        detected: report.detected_loss_by_frame(),
        in_flight: in_flight.to_vec(),
        sustained: rings(Metric::Sustained),
        transient: rings(Metric::Transient),
        flicker: (pixels > 0).then(|| (power / pixels as f64).sqrt()),
        chroma: Some(chroma[0].max(chroma[1])),
        flip: whole(Metric::Flip),
        fvvdp,
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
