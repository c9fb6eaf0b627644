//! The page: one file, which needs nothing else.

use crate::advice::advice;
use crate::estimates;
use crate::hardware::Look;
use crate::pictures::Pictures;
use crate::plot;
use crate::points::Sweep;
use crate::results::{Bits, Conditions, Errors, Fine, HardCase, Results, SceneResults};
use crate::statistics::Bootstrap;
use crate::summary::{Row, mean_rows, scene_rows};
use crate::table::{cells, equal_loss_rows, equal_loss_titles, hardware_rows, hardware_titles, titles};
use crate::verdict::{Contest, Measure, OURS, RIVALS, Tally, Verdict, contest, tallies, why_not};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use parafovea_models::errors::RING_NAMES;

const STYLE: &str = "\
body{font:15px/1.5 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#1b1f24}\
h1{font-size:1.7em;margin-bottom:.2em}h2{margin-top:2em;border-bottom:1px solid #d0d7de}\
table{border-collapse:collapse;font-size:.88em;margin:1em 0}.wide{overflow-x:auto}\
th,td{border:1px solid #d0d7de;padding:.25em .55em;text-align:right;vertical-align:top}\
th{background:#f3f5f7}th:first-child,td:first-child,.words td,.words th{text-align:left}\
td.wins{background:#d7f2df}td.loses{background:#fbdcd8}td.tie,td.apart{background:#f3f0d9}\
.note{color:#57606a;font-size:.9em}figure{display:inline-block;margin:.4em}figure img{width:256px;height:auto;display:block}\
figcaption{font-size:.8em;color:#57606a}svg{max-width:100%;height:auto}";

/// The page of `results`; `gpus` are committed results of GPUs.
///
/// # Errors
/// A text, where a plot cannot be drawn.
pub fn page(results: &Results, gpus: &[Results], pictures: &Pictures) -> Result<String, String> {
    let gpu_rows: Vec<Row> = gpus.first().map(mean_rows).unwrap_or_default();
    let (contests, by_hardware) = (contests(&results.scenes), contests(&results.hardware));
    let mut scenes = Vec::new();
    for scene in &results.scenes {
        scenes.push(html_of_scene(results, scene, pictures)?);
    }
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "Parafovea: speed against error" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Parafovea: speed against error" }
                p { "Speed and error of each technique, compared with the alternatives that users have." }
                (first_screen(results, gpus, [&contests, &by_hardware]))
                h2 { "All techniques, mean of " (results.scenes.len()) " scenes" }
                (table(results, &mean_rows(results), &gpu_rows))
                (how_to_read(&results.conditions))
                h2 { "Cost against loss" }
                (plots(results, gpus)?)
                h2 { "At equal cost" }
                (equal_cost(&contests))
                @if results.scenes.is_empty() { p { "Nothing was measured." } }
                @if !results.hardware.is_empty() { (hardware(results, &by_hardware)) }
                h2 { "Bits that chroma attenuation saves" }
                (bits(results))
                h2 { "Scene by scene" }
                @for scene in &scenes { (scene) }
                @if let Some(fine) = &results.fine { (finely(fine)) }
                h2 { "Hard cases of the models" }
                (hard_cases(&results.hard_cases))
            }
        }
    };
    Ok(page.into_string())
}

/// All of our techniques together against the alternatives of a user, scene by scene.
pub fn contests(scenes: &[SceneResults]) -> Vec<(&SceneResults, Contest)> {
    let bootstrap = Bootstrap::default();
    let first = scenes.first().into_iter().flat_map(|scene| &scene.points);
    let ours = first.filter(|point| point.sweep == OURS && point.cost.is_some());
    let ours: Vec<&str> = ours.map(|point| point.technique.as_str()).collect();
    let all = scenes
        .iter()
        .flat_map(|scene| ours.iter().flat_map(move |name| RIVALS.map(move |rival| (scene, *name, rival))))
        .flat_map(|(scene, name, rival)| Measure::ALL.map(|measure| (scene, name, rival, measure)));
    let found = |(scene, name, rival, measure)| contest(scene, name, rival, measure, &bootstrap);
    all.filter_map(|of| Some((of.0, found(of)?))).collect()
}

type Contests<'a> = [(&'a SceneResults, Contest)];

fn first_screen(results: &Results, gpus: &[Results], [timed, shaded]: [&Contests<'_>; 2]) -> Markup {
    let conditions = &results.conditions;
    html! {
        table.words {
            tr { th { "Your application is ..." } th { "Setting" } th { "Measured" } }
            @for advice in advice(results, gpus) {
                tr { td { (advice.application) } td { (advice.setting) } td { (advice.measured) } }
            }
        }
        (who_wins(shaded, results.hardware.len(), &format!("share of shaded pixels, {}", conditions.look.text())))
        (who_wins(timed, results.scenes.len(), "cost on this device"))
        p.note {
            (conditions.date) ", commit " (conditions.commit) ", " (conditions.device) ", " (conditions.processor) ", "
            (conditions.threads) " threads: " code { (conditions.command) }
        }
        @if conditions.device_is_cpu {
            p.note {
                "This device renders on the CPU. Times are those of the fallback, the mask, on such a device: "
                b { "they do not show the speed on a GPU." } " Errors are the same on every device."
            }
        }
        p.note {
            "Estimates for 2 x 2160 x 2160 pixels, not measurements: from the instructions that Mesa's compilers generate and from data sheets, the least \
             and the greatest of " (estimates::gpus()) " (tests/baselines/drivers.md)."
        }
    }
}

fn who_wins(contests: &Contests<'_>, scenes: usize, cost: &str) -> Markup {
    let tallies = tallies(contests);
    let rivals = RIVALS.into_iter().filter(|rival| tallies.iter().any(|tally| tally.rival == *rival));
    // Each technique has one for each of these.
    let measures =
        Measure::ALL.into_iter().filter(|measure| tallies.iter().any(|tally| tally.measure == *measure));
    let measures: Vec<Measure> = measures.collect();
    let columns: Vec<(Sweep, Measure)> =
        rivals.flat_map(|rival| measures.iter().map(move |measure| (rival, *measure))).collect();
    let mut techniques: Vec<&str> = tallies.iter().map(|tally| tally.technique.as_str()).collect();
    techniques.dedup();
    let found = |technique: &str, (rival, measure)| {
        tallies.iter().find(|tally| {
            (tally.technique.as_str(), tally.rival, tally.measure) == (technique, rival, measure)
        })
    };
    html! {
        @if !techniques.is_empty() {
            p { "Number of scenes, out of " (scenes) ", with a lower loss than the alternative at equal " (cost) ":" }
            table.words {
                tr { th { "ours" } @for (rival, measure) in &columns { th { "than " (rival.title()) ", " (measure.text()) } } }
                @for technique in techniques {
                    tr {
                        td { (technique) }
                        @for column in &columns { td { (found(technique, *column).map_or("-".to_owned(), Tally::text)) } }
                    }
                }
            }
        }
    }
}

fn table(results: &Results, rows: &[Row], gpu: &[Row]) -> Markup {
    html! {
        div.wide {
            table {
                tr { @for title in titles(results) { th { (title) } } }
                @for row in rows {
                    tr { @for cell in cells(results, row, gpu) { td { (cell) } } }
                }
            }
        }
    }
}

fn how_to_read(conditions: &Conditions) -> Markup {
    let [turns, run_up, frames, size] = conditions.timed;
    let [_, judged, side] = conditions.judged;
    html! {
        ul.note {
            li {
                "Times are medians of " (frames) " frames with both eyes at " (size) " x " (size) ", after a run-up of " (run_up)
                ", in " (turns) " turns. In a turn all techniques alternate, one frame each, so that other load on the machine affects all of them; \"x off\" is the ratio of the sums of a turn, as the mean of the middle half of the turns. Work of a process while others have their turn, such as sound capture, is not counted. p99 is the 99th percentile."
            }
            li {
                "Errors are of " (judged) " of these frames at " (side) " x " (side) ", with a saccade of at least 10 degrees in their middle, against the same frames of the application "
                "alone, without those of the saccade itself in contrast loss and detected, at the true gaze; the application gets a gaze that is 58 ms late, half a degree off, and noisy. JND: sustained change of "
                "contrast, in just-noticeable differences of castleCSF, by ring of degrees from the gaze. Contrast loss: sustained and transient change, as the mean of the whole view. Detected: the same, but summed over the view by "
                "probability summation with an exponent of 3.5 (Robson and Graham 1981), so that losses far below the threshold do not count, however many there are."
            }
            li {
                "Flicker is RMS contrast at 8 to 30 Hz. Fragments are as the device counts them, on lavapipe 22.3.6 before the early depth test; samples are those that pass the test. "
                "With FR they include the template and fill of the application."
            }
            @if let Some(version) = &conditions.fvvdp {
                li {
                    "JOD: just-objectionable differences by FovVideoVDP " (version) " (Mantiuk et al. 2021), foveated, of the left eye at its true gaze, on an sRGB display of 100 cd/m², whose pixels "
                    "are as many a degree as those of the eye buffer. 10 is no difference; of two images 1 JOD apart, 75 % of people prefer the better one. Frames of the saccade are not in it. FovVideoVDP filters each place of the image over 250 ms, "
                    "so that after a saccade it still counts the coarse blocks from before."
                }
            }
            li { "rates.gate is \"on\", so that no technique is dropped. By default, a technique that causes a slowdown is dropped." }
        }
    }
}

fn plots(results: &Results, gpus: &[Results]) -> Result<Markup, String> {
    let mut all = vec![(results.conditions.backend.as_str(), results, plot::overview(results)?)];
    for gpu in gpus {
        all.push((gpu.conditions.backend.as_str(), gpu, plot::overview(gpu)?));
    }
    Ok(html! {
        @for (backend, results, svg) in all {
            h3 { "With " (backend) ", on " (results.conditions.device) @if results.conditions.device_is_cpu { " (the fallback)" } }
            (PreEscaped(svg))
        }
        p.note { "Thin lines: one scene each. Thick lines with dots: the mean of the scenes. Further left is faster, further down is better." }
        @if gpus.is_empty() {
            p.note { "With rate attachments on a GPU: none yet (" code { "cargo dev report --system-driver --keep" } " measures it)." }
        }
    })
}

fn equal_cost(contests: &Contests<'_>) -> Markup {
    html! {
        p.note {
            "Contrast loss of each alternative at equal cost, interpolated over the logarithm of the cost between its points, which include the application alone. "
            "Intervals contain 95 % of 1000 bootstrap samples of blocks of 5 frames, the same frames for both; an interval that contains 0 is a tie."
        }
        table {
            tr { @for title in ["scene", "ours", "x off", "loss, JND", "which", "against", "loss of the alternative", "difference", "verdict"] { th { (title) } } }
            @for (scene, contest) in contests {
                tr {
                    td { (scene.scene) }
                    td { (contest.technique) }
                    td { (format!("{:.2}", contest.cost)) }
                    td { (format!("{:.3}", contest.loss)) (other_unit(contest.measure)) }
                    td { (contest.measure.text()) }
                    td { (contest.rival.title()) }
                    td { (format!("{:.3}", contest.rival_loss)) @if !contest.is_reached { " (never as cheap)" } }
                    td { @match contest.difference {
                        Some(interval) => (format!("{:+.3} to {:+.3}", interval.low, interval.high)),
                        None => "-",
                    } }
                    td class=(class(contest.verdict)) { (contest.verdict.text()) }
                }
            }
        }
        @if contests.iter().any(|(_, contest)| contest.verdict != Verdict::Wins) {
            h3 { "Scenes without a win, and the reasons" }
            ul {
                @for (scene, contest) in contests.iter().filter(|(_, contest)| contest.verdict != Verdict::Wins) {
                    li {
                        (scene.scene) ", " (contest.technique) " against " (contest.rival.title()) ", " (contest.measure.text()) " (" (contest.verdict.text()) "): "
                        (why_not(scene, contest)) "."
                    }
                }
            }
        }
    }
}

/// Everybody's map over the same pictures.
fn hardware(results: &Results, contests: &Contests<'_>) -> Markup {
    html! {
        h2 { "Maps " (results.conditions.look.text()) }
        p.note {
            (match results.conditions.look {
                Look::Rates => "One sample for each block of pixels, at its centre,",
                Look::Mask => "Blocks that a mask skips, filled from shaded ones,",
            }) " over the same images of the application alone. FR of the paper rounds each rate to the finer one of four, has no safety margins, and follows the true gaze; "
            "the presets have their margins, and the gaze that the tracker reports. Rings: the presets without contrast. Render scale has its own images. Shaded: samples over pixels. Frames in which the eyes jump are in the last column alone. The mean of " (results.hardware.len()) " scenes."
        }
        table {
            tr { @for title in hardware_titles(results) { th { (title) } } }
            @for row in hardware_rows(results) {
                tr { @for cell in row { td { (cell) } } }
            }
        }
        table {
            tr { @for title in equal_loss_titles() { th { (title) } } }
            @for row in equal_loss_rows(results) {
                tr { @for cell in row { td { (cell) } } }
            }
        }
        (equal_cost(contests))
    }
}

/// The unit behind a loss that is not in that of the column's title.
fn other_unit(measure: Measure) -> &'static str {
    match measure {
        Measure::Mean | Measure::Detected => "",
        Measure::Jod => " JOD",
    }
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Wins => "wins",
        Verdict::Tie => "tie",
        Verdict::Loses => "loses",
        Verdict::Apart => "apart",
    }
}

fn bits(results: &Results) -> Markup {
    let rows: Vec<(&str, &Bits)> = results
        .scenes
        .iter()
        .flat_map(|scene| scene.bits.iter().map(|bits| (scene.scene.as_str(), bits)))
        .collect();
    let percent = |share: f64| format!("{:+.1} %", 100.0 * share);
    html! {
        @if rows.is_empty() { p { "Not measured." } } @else {
            p.note {
                "BD-rate: the mean difference in bits at equal PSNR of luma, of the decoded against the encoded image, at four quality settings, for the eye buffers; chroma bits are all bits without those of "
                "luma alone. Chroma attenuation saves no time."
            }
            table {
                tr { @for title in ["scene", "codec", "all bits", "chroma bits"] { th { (title) } } }
                @for (scene, bits) in &rows {
                    tr { td { (scene) } td { (bits.codec) } td { (percent(bits.total)) } td { (percent(bits.chroma)) } }
                }
            }
            @if !rows.iter().any(|(_, bits)| bits.codec.starts_with("H.264")) {
                p.note { "H.264: the system has no ffmpeg with libx264." }
            }
        }
    }
}

fn html_of_scene(results: &Results, scene: &SceneResults, pictures: &Pictures) -> Result<Markup, String> {
    let svg = plot::of_scene(results, scene)?;
    let shown: Vec<(&str, String, Option<String>)> = scene
        .points
        .iter()
        .filter_map(|point| {
            let name = point.technique.as_str();
            let picture = |kind| pictures.data_uri(&scene.scene, name, kind);
            Some((name, picture("seen")?, picture("map")))
        })
        .collect();
    Ok(html! {
        h3 { (scene.scene) }
        (table(results, &scene_rows(scene), &[]))
        (PreEscaped(svg))
        @if !shown.is_empty() {
            details {
                summary { "Pictures: the left eye, in the frame of the saccade, and the map of its pass" }
                @for (name, seen, map) in &shown {
                    figure { img src=(seen) alt=(name); figcaption { (name) } }
                    @if let Some(map) = map {
                        figure { img src=(map) alt={ "map of " (name) }; figcaption { "its map: light 1x1, dark 4x4" } }
                    }
                }
            }
        }
    })
}

fn finely(fine: &Fine) -> Markup {
    let [run_up, frames, size] = fine.judged;
    let cells = |errors: &Errors| -> Vec<String> {
        let rings = errors
            .sustained
            .into_iter()
            .map(|value| value.map_or("-".to_owned(), |value| format!("{value:.2}")));
        let loss = errors.loss.iter().sum::<f64>() / errors.loss.len().max(1) as f64;
        rings.chain([format!("{loss:.3}")]).collect()
    };
    html! {
        h2 { "At " (format!("{:.1}", fine.pixels_per_degree)) " pixels per degree" }
        p.note {
            (fine.scene) ", " (frames) " frames at " (size) " x " (size) " after " (run_up) ", while the eyes rest: errors only, in sustained JND, by ring."
        }
        table {
            tr { th { "technique" } @for ring in RING_NAMES { th { (ring) "°" } } th { "contrast loss" } }
            @for (technique, errors) in &fine.points {
                tr { td { (technique) } @for cell in cells(errors) { td { (cell) } } }
            }
        }
    }
}

fn hard_cases(cases: &[HardCase]) -> Markup {
    let wrong = cases.iter().filter(|case| !case.passed).count();
    html! {
        p { (cases.len()) " cases, " (wrong) " wrong. The last column is the difference between single and double precision." }
        div.wide {
            table.words {
                tr { @for title in ["model", "case", "expected", "got", "f32 error"] { th { (title) } } }
                @for case in cases {
                    tr {
                        td { (case.model) } td { (case.case) } td { (case.expected) }
                        td class=(if case.passed { "" } else { "loses" }) { (case.got) }
                        td { (case.error.map_or("-".to_owned(), |error| format!("{error:.1e}"))) }
                    }
                }
            }
        }
    }
}
