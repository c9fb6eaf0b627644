//! Made-up results.

use parafovea_models::errors::RINGS;
use parafovea_models::errors::fvvdp::Differences;
use parafovea_report::hardware::Look;
use parafovea_report::points::Sweep;
use parafovea_report::results::{
    Bits, Conditions, Cost, Errors, HardCase, PointResults, Results, SceneResults,
};
use parafovea_report::statistics::RatePoint;

/// Frames that both cost and loss are known of.
pub const FRAMES: usize = 30;

pub fn conditions() -> Conditions {
    Conditions {
        device: "a device & its <driver>".to_owned(),
        device_is_cpu: true,
        backend: "mask".to_owned(),
        processor: "a processor".to_owned(),
        threads: 2,
        commit: "0123456789".to_owned(),
        date: "2000-01-01".to_owned(),
        command: "cargo dev report --quick".to_owned(),
        timed: [2, 120, 30, 512],
        judged: [120, 30, 512],
        look: Look::Rates,
        fvvdp: None,
    }
}

/// A technique that costs `ratio` and loses `loss`, each frame a little differently: by `varied` of it in frames that
/// follow one another.
pub fn point(sweep: Sweep, technique: &str, ratio: f64, loss: f64, varied: f64) -> PointResults {
    // Ours varies in other frames than the rest.
    let step = if sweep == Sweep::Everything { 11 } else { 7 };
    let wave = |frame: usize| 1.0 + varied * ((frame * step % FRAMES) as f64 / FRAMES as f64 - 0.5);
    let frames_ms = (0..FRAMES).map(|frame| 40.0 * ratio * wave(frame)).collect();
    let errors = (sweep != Sweep::Off).then(|| Errors {
        loss: (0..FRAMES).map(|frame| loss * wave(FRAMES - frame)).collect(),
        detected: (0..FRAMES).map(|frame| 2.0 * loss * wave(FRAMES - frame)).collect(),
        sustained: [Some(loss); RINGS],
        transient: [Some(0.5 * loss); RINGS],
        flicker: Some(0.01),
        chroma: Some(0.2),
        flip: None,
        in_flight: Vec::new(),
        fvvdp: None,
    });
    let cost = Cost { median_ms: 40.0 * ratio, p99_ms: 50.0 * ratio, ratio, spread: 0.01, frames_ms };
    PointResults {
        sweep,
        technique: technique.to_owned(),
        fragments: (1000.0 * ratio) as u64,
        samples: Some((800.0 * ratio) as u64),
        cost: Some(cost),
        errors,
    }
}

/// A scene in which everything on costs and loses so much.
pub fn scene(name: &str, everything: (f64, f64), varied: f64) -> SceneResults {
    let (cost, loss) = everything;
    let rate = |bits: f64, psnr_db| RatePoint { bits, psnr_db };
    let mut chroma = point(Sweep::Chroma, "chroma", 1.0, 0.0, 0.0);
    chroma.cost = None;
    SceneResults {
        scene: name.to_owned(),
        points: vec![
            point(Sweep::Off, "off", 1.0, 0.0, varied),
            point(Sweep::RenderScale, "render scale 0.7", 0.5, 2.0, varied),
            point(Sweep::RenderScale, "render scale 0.5", 0.25, 4.0, varied),
            point(Sweep::FixedFoveation, "FR L1-C1", 0.6, 0.5, varied),
            point(Sweep::FixedFoveation, "FR L3-C3", 0.4, 1.5, varied),
            point(Sweep::Rates, "preset balanced", 0.55, 0.4, varied),
            point(Sweep::Everything, "everything balanced", cost, loss, varied),
            chroma,
        ],
        bits: vec![Bits {
            technique: "chroma".to_owned(),
            codec: "JPEG 4:2:0".to_owned(),
            total: -0.08,
            chroma: -0.4,
            curves: [vec![rate(1000.0, 30.0)], vec![rate(900.0, 30.0)]],
        }],
        frames_of_script: 0,
    }
}

pub fn results() -> Results {
    let case = HardCase {
        model: "loudness".to_owned(),
        case: "digital silence & <less>".to_owned(),
        expected: "-inf".to_owned(),
        got: "-inf".to_owned(),
        error: Some(1e-7),
        passed: true,
    };
    Results {
        conditions: conditions(),
        scenes: vec![scene("cockpit", (0.5, 0.3), 0.2), scene("foliage", (1.3, 0.3), 0.2)],
        hardware: Vec::new(),
        fine: None,
        hard_cases: vec![case],
    }
}

/// The same, where FovVideoVDP takes off as many JOD as contrast is lost in JND.
pub fn results_with_jod() -> Results {
    let mut results = results();
    results.conditions.fvvdp = Some("1.2.2".to_owned());
    for errors in
        results.scenes.iter_mut().flat_map(|scene| &mut scene.points).filter_map(|p| p.errors.as_mut())
    {
        let by_frame = errors.loss.iter().map(|loss| loss * loss).collect();
        errors.fvvdp = Some(Differences { by_frame, exponent: 0.5 });
    }
    results
}
