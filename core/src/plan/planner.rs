//! The planner: from the input of a frame to its plan.

use super::changes::Changes;
use super::contrast::VisibleContrast;
use super::eye::EyeMemory;
use super::frame::FramePlan;
use super::input::{EyeInput, PlanInput};
use super::reasons::{Reason, Reasons};
use super::rules::{AgeLimits, FrameRules, RateLimit};
use super::safety::SafetyState;
use super::sensitivity::Sensitivity;
use super::settings::{PlanSettings, RateSettings, UpdateUnit};
use crate::chroma::Focus;
use crate::gaze::GazePhase;
use crate::geometry::{View, rotation, unit_direction};
use crate::kernels::decide::decide;
use crate::perception::ContrastMap;
use crate::schedule::cap::PeriodCap;
use crate::schedule::{CellAges, REGIONS};
use glam::{Quat, Vec3};

/// Plans one frame after the other. Allocates when a view changes its shape or the settings change, and not otherwise.
#[derive(Clone, Debug)]
pub struct Planner {
    settings: PlanSettings,
    /// Present where contrast is judged.
    sensitivity: Option<Sensitivity>,
    safety: SafetyState,
    /// Orientation of the head in the newest frame.
    last_head: Option<Quat>,
    cap: PeriodCap,
    /// Displacement of re-used content for each frame of its age, arc minutes.
    drift_arcmin: f32,
    /// Present where the schedule can leave something out.
    ages: Option<CellAges>,
    changes: Changes,
    eyes: [EyeMemory; 2],
    plan: FramePlan,
}

impl Planner {
    /// A planner that has seen no frame: its first plan has full rate everywhere, unless nothing limits coarsening.
    pub fn new(settings: PlanSettings) -> Self {
        let mut planner = Self {
            settings,
            sensitivity: None,
            safety: SafetyState::default(),
            last_head: None,
            cap: PeriodCap::default(),
            drift_arcmin: 0.0,
            ages: None,
            changes: Changes::default(),
            eyes: Default::default(),
            plan: FramePlan::default(),
        };
        planner.set_settings(settings);
        planner
    }

    /// Its settings, with usable numbers in place of unusable safety limits.
    pub fn settings(&self) -> &PlanSettings {
        &self.settings
    }

    /// Sets the displacement of re-used content for each frame of its age, after correction of the head's rotation: arc minutes, by the
    /// head's translation and the distance of near content. Holds until the next call; 0 at first. NaN counts as infinite, and then
    /// nothing is re-used.
    pub fn set_drift(&mut self, arcmin: f32) {
        self.drift_arcmin = if arcmin.is_nan() { f32::INFINITY } else { arcmin.abs() };
    }

    /// Plans with `settings` from now on. Tiles keep their state, so that an edit does not show as a jump.
    pub fn set_settings(&mut self, settings: PlanSettings) {
        self.settings = PlanSettings { safety: settings.safety.usable(), ..settings };
        let wanted = match settings.rates {
            RateSettings::AudioVisual(model) if !settings.contrast_on_gpu => Some(model.budget.unit),
            RateSettings::AudioVisual(_) | RateSettings::Off | RateSettings::Fixed(_) => None,
        };
        if self.sensitivity.as_ref().map(Sensitivity::unit) != wanted {
            self.sensitivity = wanted.map(Sensitivity::new);
        }
        match settings.schedule {
            None => self.ages = None,
            Some(_) => _ = self.ages.get_or_insert_with(CellAges::new),
        }
    }

    /// Takes differences of some tiles of an image from re-used content, as measured by the kernel `change`
    /// ([`crate::kernels::change::ChangeParams::change`]): visibly changing content is rendered in each of the next frames, and all content
    /// in the next one if most of it changed.
    ///
    /// `view` is that of the picture in the world, as [`PlanInput::head`] leads to it; its image is one of tiles in place of
    /// pixels. Tiles are given as column, and row in the upper 16 bits.
    pub fn content_changed(&mut self, view: &View, tiles: impl ExactSizeIterator<Item = (u32, f32)>) {
        if self.settings.schedule.is_some_and(|updates| updates.unit == UpdateUnit::Directions) {
            let all =
                self.plan.eyes.iter().map(|eye| (eye.rates.width() * eye.rates.height()) as usize).max();
            self.changes.seen(view, all.unwrap_or_default(), tiles);
        }
    }

    /// The plan that was made last; before the first, one of views without pixels.
    pub fn newest(&self) -> &FramePlan {
        &self.plan
    }

    /// Turn of the head since the frame before, in tiles at the centre of the left picture; 0 in the first frame.
    pub(super) fn turned_tiles(&mut self, input: &PlanInput, head: Quat) -> f32 {
        let before = self.last_head.replace(head).unwrap_or(head);
        let EyeInput { extent: [width, _], fov, .. } = input.eyes[0];
        let tangents = fov.tangents();
        let across = tangents.right - tangents.left;
        let tile = across * self.settings.device.texel[0] as f32 / width as f32;
        // Exact at small angles, where an arc cosine is not: a head at rest does not turn.
        let turn = 2.0 * (before.inverse() * head).xyz().length().min(1.0).asin();
        let tiles = turn / tile;
        if tile > 0.0 && tiles.is_finite() { tiles } else { 0.0 }
    }

    /// Plans a frame.
    pub fn plan(&mut self, input: &PlanInput) -> &FramePlan {
        let mut reasons = Reasons::default();
        let head = rotation(input.head).unwrap_or(Quat::IDENTITY);
        let turned_tiles = self.turned_tiles(input, head);
        let by_contrast = matches!(self.settings.rates, RateSettings::AudioVisual(_)).then_some(turned_tiles);
        let safety =
            self.safety.frame(&self.settings.safety, by_contrast, input.time_ns, &input.gaze, &mut reasons);
        let period_cap = self.cap.update(input.frame_rate_hz);
        let limits = AgeLimits { period_cap, drift_arcmin: self.drift_arcmin };
        let orientations = input.eyes.each_ref().map(|eye| eye.orientation);
        let rules =
            FrameRules::new(&self.settings, safety, input.audio.as_ref(), limits, orientations, &mut reasons);
        if let (Some(ages), Some(schedule)) = (&mut self.ages, &rules.schedule) {
            let gazes = rules.centres.map(|centre| head * centre);
            ages.advance(schedule, input.frame, gazes);
            let refreshed = self.changes.refresh(input.frame, gazes, ages);
            reasons.insert_if(refreshed, Reason::ContentChanges);
        }
        for (index, eye) in input.eyes.iter().enumerate() {
            self.plan_eye(index, input.frame, head, eye, &rules, &mut reasons);
            self.attenuate(index, input, head, &rules);
        }
        let (radii_deg, periods) = rules.schedule.map_or(([f32::INFINITY; 4], [1; REGIONS]), |schedule| {
            (schedule.regions.radii_deg, schedule.configuration.factors())
        });
        self.plan.frame = input.frame;
        self.plan.available = self.settings.device.available;
        self.plan.inflation_deg = rules.safety.inflation_deg;
        self.plan.regions_deg = radii_deg;
        self.plan.periods = periods;
        self.plan.budget = rules.by_contrast.and_then(|limit| limit.budget);
        self.plan.chroma = self.settings.chroma;
        self.plan.reasons = reasons;
        &self.plan
    }

    /// Rates and updates of one eye.
    fn plan_eye(
        &mut self,
        index: usize,
        frame: u64,
        head: Quat,
        eye: &EyeInput,
        rules: &FrameRules,
        reasons: &mut Reasons,
    ) {
        let memory = &mut self.eyes[index];
        let out = &mut self.plan.eyes[index];
        let orientation = memory.set_view(eye, self.settings.device.texel, out);
        reasons.insert_if(orientation.is_none() && !eye.extent.contains(&0), Reason::ViewMalformed);
        reasons.insert_if(eye.refresh, Reason::Refresh);

        let to_view = orientation.unwrap_or(Quat::IDENTITY).inverse();
        out.centres = rules.centres.map(|centre| to_view * centre);
        memory.updates.begin(frame, orientation.map(|orientation| head * orientation));
        out.gaze = if rules.has_gaze() { out.centres[index] } else { Vec3::ZERO };
        if matches!(self.settings.rates, RateSettings::Off) && self.settings.schedule.is_none() {
            return memory.plan_at_full_rate(rules, &self.settings, out);
        }
        memory.is_full = false;
        match (&self.settings.schedule, &self.ages, &rules.schedule) {
            (Some(updates), Some(ages), Some(schedule)) if !eye.refresh && orientation.is_some() => {
                match updates.unit {
                    UpdateUnit::Directions => memory.updates.update_directions(&memory.lattice, ages, index),
                    UpdateUnit::Tiles => {
                        memory.updates.update_tiles(&mut memory.lattice, schedule, index, out.centres);
                    }
                }
            }
            _ => memory.updates.update_all(),
        }

        let on_gpu = self.settings.contrast_on_gpu;
        let contrast = contrast(eye, memory.lattice.tiles(), self.sensitivity.as_ref()).filter(|_| !on_gpu);
        reasons
            .insert_if(rules.by_contrast.is_some() && contrast.is_none() && !on_gpu, Reason::NothingMeasured);
        let limit = rules.by_contrast.filter(|_| on_gpu && orientation.is_some());
        out.by_contrast =
            limit.map(|limit| rules.params(&self.settings, out.centres, &limit, &memory.lattice));
        let limit = match (orientation, rules.by_contrast, contrast) {
            (None, ..) => RateLimit::FULL_RATE,
            (Some(_), Some(limit), Some(_)) => limit,
            (Some(_), ..) => rules.fixed,
        };
        out.rings = limit.rings;
        let params = rules.params(&self.settings, out.centres, &limit, &memory.lattice);
        out.decision = params;
        let contrast = contrast.filter(|_| limit.budget.is_some());
        decide(&params, &mut memory.lattice, memory.updates.due(), contrast, &mut memory.tiles, out);
    }

    /// Chroma of one eye. Colour follows the gaze in the world, so that the limit on its change holds for the content.
    fn attenuate(&mut self, index: usize, input: &PlanInput, head: Quat, rules: &FrameRules) {
        let filter = &mut self.eyes[index].filter;
        let out = &mut self.plan.eyes[index];
        let Some(settings) = &self.settings.chroma else {
            filter.show_full_color(input.time_ns);
            out.focus = None;
            return;
        };
        let orientation = rotation(input.eyes[index].orientation);
        // While trust ramps down, colour is back already.
        let known = rules.has_gaze() && input.gaze.phase != GazePhase::Lost && orientation.is_some();
        // Around the ray if the distance is unknown: it is off by 4.5 degrees at 0.4 m, and the plateau of full colour
        // is wider than that.
        let direction = input.gaze.ray.and_then(unit_direction).unwrap_or(rules.centres[index]);
        let gaze = known.then(|| head * direction);
        let to_view = (head * orientation.unwrap_or(Quat::IDENTITY)).inverse();
        out.focus = filter
            .update(gaze, input.time_ns, settings)
            .map(|focus| Focus { direction: to_view * focus.direction, ..focus });
    }
}

/// The contrast of a view, where it counts and has been measured for these tiles.
fn contrast<'a>(
    eye: &EyeInput<'a>,
    tiles: [u32; 2],
    sensitivity: Option<&'a Sensitivity>,
) -> Option<VisibleContrast<'a>> {
    let map: &ContrastMap = eye.contrast.filter(|map| [map.tiles.width(), map.tiles.height()] == tiles)?;
    sensitivity.map(|sensitivity| VisibleContrast { map, sensitivity })
}
