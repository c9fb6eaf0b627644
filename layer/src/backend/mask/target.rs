//! The mask of one colour target: evidence of its passes, and the map once there is one.

use super::Masks;
use crate::backend::mask::{Eligible, MaskMap, MaskMethod, PipelineFacts};
use crate::backend::{MapForm, MapSize, RateMap, Upload};
use crate::gpu::{AppCommands, Compilation, Later};
use crate::kernels::mask::MaskOutput;
use crate::pass_detection::{How, ImageDescription, ImageKey, Part, PassFacts, Target, Unmasked};
use crate::rate_map::RateImage;
use crate::status::{Topic, decided};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// The mask of passes that draw to one colour target.
pub struct TargetMask {
    masks: Arc<Masks>,
    target: Target,
    /// Size of the target, pixels.
    extent: [u32; 2],
    seen: Mutex<PassEvidence>,
    /// Asked for by the first pass that can have it.
    map: OnceLock<Later<MaskMap>>,
}

/// So many pictures at most are drawn to in turn; after longer, an application has paused.
const MOST_IN_TURN: u64 = 4;

/// Facts about a pass at its end.
#[derive(Debug, Clone, Copy)]
pub struct Ended {
    /// Facts of the commands within.
    pub facts: PassFacts,
    /// The pipelines that draw in it.
    pub pipelines: PipelineFacts,
    /// Whether the bound compute state can be bound again.
    pub restores_compute: bool,
    /// The same of drawing; true where that is not followed.
    pub restores_graphics: bool,
    /// Whether it has depth.
    pub has_depth: bool,
    /// Whether it draws no colour.
    pub is_prepass: bool,
}

/// State of an object that passes need for a mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Wanted {
    /// Not requested.
    #[default]
    No,
    /// Requested, but not available yet.
    Waiting,
    /// Could not be created.
    Failed,
    /// Available.
    Ready,
}

/// Evidence of earlier passes to the target.
#[derive(Debug, Default)]
struct PassEvidence {
    /// Whether a pass was recorded to its end.
    is_recorded: bool,
    /// Facts of the commands within passes.
    facts: PassFacts,
    pipelines: PipelineFacts,
    /// After a pass something was bound for compute that cannot be bound again.
    loses_compute: bool,
    /// The same of drawing, as far as that was followed.
    loses_graphics: bool,
    /// Whether a pass has depth.
    has_depth: bool,
    /// Whether a depth pre-pass was recorded to its end.
    has_prepass: bool,
    /// Reason why the last depth pre-pass had no template, if there was one.
    prepass_refusal: Option<Unmasked>,
    /// Fragment shaders that shall return early: of any kind, and such that keep their coverage.
    returns: [Wanted; 2],
    /// Whether the last submitted pass without depth was the scene, and the last one with depth: of a pair of images one has the scene in
    /// one frame, and its tone-mapped copy in the next.
    is_scene: [bool; 2],
    /// Whether it drew straight into a swapchain.
    is_shown: bool,
    /// Number of that frame, and number of frames since the one before.
    frame: u64,
    frames_since: u64,
    /// Whether depth of a pass is older than that, or outlives it: left-out tiles have no right depth.
    keeps_depth: bool,
    /// The last reason that was logged.
    logged: Option<Result<Option<Unmasked>, Unmasked>>,
}

impl TargetMask {
    /// Begins with nothing seen.
    pub fn new(masks: &Arc<Masks>, target: Target, image: &ImageDescription) -> Self {
        let extent = image.extent.map(|side| side.checked_shr(target.level).unwrap_or(0).max(1));
        Self { masks: Arc::clone(masks), target, extent, seen: Mutex::default(), map: OnceLock::new() }
    }

    /// Number of array layers that are drawn to.
    pub(super) fn layers(&self) -> u32 {
        self.target.layers
    }

    /// Evidence of passes to it, with depth or without, or of depth pre-passes for them, before they are recorded.
    ///
    /// # Errors
    ///
    /// Nothing yet that would make them the scene.
    pub(super) fn evidence(
        &self,
        is_prepass: bool,
        has_depth: bool,
    ) -> Result<(PassFacts, PipelineFacts), Unmasked> {
        let seen = self.seen();
        let is_scene = seen.is_scene[usize::from(has_depth)];
        match *seen {
            PassEvidence { has_prepass: false, .. } if is_prepass => Err(Unmasked::New),
            PassEvidence { is_recorded: true, loses_compute: false, facts, pipelines, .. } if is_scene => {
                Ok((facts, pipelines))
            }
            PassEvidence { loses_compute: true, .. } => Err(Unmasked::ComputeState),
            _ => Err(Unmasked::New),
        }
    }

    /// A pass to it was recorded.
    pub fn recorded(&self, ended: Ended) {
        let Ended { facts, pipelines, restores_compute, restores_graphics, has_depth, is_prepass } = ended;
        let mut seen = self.seen();
        seen.loses_compute |= !restores_compute;
        seen.loses_graphics |= !restores_graphics;
        seen.has_depth |= has_depth;
        seen.has_prepass |= is_prepass;
        seen.is_recorded |= !is_prepass;
        seen.facts.is_queried |= facts.is_queried;
        seen.facts.clears_depth_later |= facts.clears_depth_later;
        seen.pipelines.see(pipelines);
    }

    /// Whether after a pass something was bound for drawing that cannot be bound again.
    pub(super) fn loses_graphics(&self) -> bool {
        self.seen().loses_graphics
    }

    /// Notes whether a depth pre-pass has a template.
    pub(super) fn note_prepass(&self, outcome: Result<(), Unmasked>) {
        self.seen().prepass_refusal = outcome.err();
    }

    /// Reason why the last depth pre-pass had no template; None if it had, or there was none.
    pub(super) fn prepass_refusal(&self) -> Option<Unmasked> {
        self.seen().prepass_refusal
    }

    /// Notes that depth of its passes is older than those, or outlives them; whether that was known.
    pub(super) fn note_depth(&self) -> bool {
        std::mem::replace(&mut self.seen().keeps_depth, true)
    }

    /// Whether its picture is drawn to every few frames, and not shown itself: others are, in between.
    pub(super) fn is_history(&self) -> bool {
        let seen = self.seen();
        !seen.is_shown && (2..=MOST_IN_TURN).contains(&seen.frames_since)
    }

    /// Whether there is a fragment shader that returns early. Where there is none yet, one is made of a pipeline that is bound.
    ///
    /// # Errors
    ///
    /// There is none yet, or it cannot be made, which leaves the pass alone for the reason `instead`.
    pub(super) fn returns_early(&self, keeps_coverage: bool, instead: Unmasked) -> Result<(), Unmasked> {
        let wanted = &mut self.seen().returns[usize::from(keeps_coverage)];
        match wanted {
            Wanted::Ready => Ok(()),
            Wanted::Failed => Err(instead),
            Wanted::No | Wanted::Waiting => {
                *wanted = Wanted::Waiting;
                Err(Unmasked::New)
            }
        }
    }

    /// Whether no fragment shader that was tried returns early with its coverage kept.
    pub(super) fn fails_to_return(&self) -> bool {
        self.seen().returns[usize::from(true)] == Wanted::Failed
    }

    /// Whether a fragment shader that returns early is waited for, with its coverage kept or not.
    pub fn waits_for_return(&self, keeps_coverage: bool) -> bool {
        let wanted = self.seen().returns[usize::from(keeps_coverage)];
        matches!(wanted, Wanted::Waiting | Wanted::Failed)
    }

    /// Notes that such a shader is ready, or cannot be made.
    pub fn prepared_return(&self, keeps_coverage: bool, is_there: bool) {
        let wanted = if is_there { Wanted::Ready } else { Wanted::Failed };
        self.seen().returns[usize::from(keeps_coverage)] = wanted;
    }

    /// The map of passes whose fragment shaders return early, `instead` of having a template for that reason: it is that of passes
    /// with one, if the target has such.
    ///
    /// # Errors
    ///
    /// As for [`Self::map`]; or something bound for drawing could not be bound again.
    pub(super) fn map_to_return(&self, instead: Unmasked) -> Result<Arc<MaskMap>, Unmasked> {
        let (loses_graphics, has_depth) = {
            let seen = self.seen();
            (seen.loses_graphics, seen.has_depth)
        };
        if loses_graphics {
            return Err(Unmasked::GraphicsState);
        }
        match self.made() {
            Some(map) => Ok(Arc::clone(map)),
            // One for passes with depth comes, or none.
            None if has_depth && instead == Unmasked::NoDepth => Err(instead),
            None => self.map(MaskMethod::RETURN),
        }
    }

    /// The map, for passes that need this one.
    ///
    /// # Errors
    ///
    /// It is for others, or cannot be made.
    pub(super) fn map(&self, eligible: Eligible) -> Result<Arc<MaskMap>, Unmasked> {
        let map = match self.map.get() {
            Some(map) => map,
            None => {
                let new = self.ask(eligible)?;
                self.map.get_or_init(|| new)
            }
        };
        match map.get() {
            Some(map) if map.serves(eligible) => Ok(Arc::clone(map)),
            Some(_) => Err(Unmasked::Changes),
            None if map.has_failed() => Err(Unmasked::Failed),
            None => Err(Unmasked::New),
        }
    }

    /// Has the map made on the compiler's thread: the template may have a pipeline of its own.
    fn ask(&self, eligible: Eligible) -> Result<Later<MaskMap>, Unmasked> {
        let gpu = Arc::clone(self.masks.gpu().ok_or(Unmasked::Failed)?);
        let kernels = self.masks.kernels(&gpu).ok_or(Unmasked::New)?;
        let (extent, layers) = (self.extent, self.target.layers);
        let make = move |_: &Arc<Compilation>| MaskMap::new(&gpu, &kernels, eligible, extent, layers);
        Ok(self.masks.compiler().ask("no mask for a render pass", make))
    }

    /// Logs how a pass of the scene was recorded, if that changed.
    pub(super) fn log_outcome(&self, outcome: Result<Option<Unmasked>, Unmasked>) {
        if matches!(outcome, Err(Unmasked::Off | Unmasked::New | Unmasked::Undrawn)) {
            return;
        }
        let before = self.seen().logged.replace(outcome);
        if before != Some(outcome) {
            let [width, height] = self.extent;
            match outcome {
                Ok(None) => decided(Topic::Mask, &format_args!("scene passes of {width}x{height}: masked")),
                Ok(Some(instead)) => decided(
                    Topic::Mask,
                    &format_args!(
                        "scene passes of {width}x{height}: masked in their fragment shaders: {instead}"
                    ),
                ),
                Err(reason) => decided(
                    Topic::NoMask(reason.to_string()),
                    &format_args!("scene passes of {width}x{height}: no mask: {reason}"),
                ),
            }
        }
    }

    /// Drops the fills of an image that is about to be destroyed.
    pub fn forget_image(&self, image: ImageKey) {
        if let Some(map) = self.made() {
            map.forget_image(image);
        }
    }

    fn seen(&self) -> MutexGuard<'_, PassEvidence> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn made(&self) -> Option<&Arc<MaskMap>> {
        self.map.get().and_then(Later::get)
    }
}

impl RateMap for TargetMask {
    fn size(&self) -> MapSize {
        let texel = super::TEXEL;
        let tiles = std::array::from_fn(|axis| self.extent[axis].div_ceil(texel[axis]));
        MapSize { texel, tiles, layers: self.target.layers }
    }

    /// 0 before there is a map: then nothing reads it.
    fn staging_len(&self) -> usize {
        self.made().map_or(0, |map| map.staging_len())
    }

    fn has_content(&self) -> bool {
        true
    }

    fn submitted(&self, scene: Option<How>, has_depth: bool, frame: u64) {
        let mut seen = self.seen();
        if frame != seen.frame {
            seen.frames_since = frame.saturating_sub(seen.frame);
            seen.frame = frame;
        }
        seen.is_scene[usize::from(has_depth)] = scene.is_some();
        seen.is_shown = scene == Some(How::Swapchain);
    }

    /// Images of a swapchain have no reader before they are composed; images on the way there are read beyond their own pixels (filters,
    /// bloom), and filled; so is depth that is needed.
    fn skips_stale_tiles(&self) -> bool {
        let seen = self.seen();
        seen.is_shown && !seen.keeps_depth
    }

    fn form(&self) -> Option<MapForm> {
        self.made().map(|map| MapForm::Mask(Arc::clone(map) as Arc<dyn MaskOutput>))
    }

    fn stage(&self, parts: &[Part], image: &RateImage, texels: &[u8], staging: &mut [u8]) {
        if let Some(map) = self.made() {
            map.stage(parts, image, texels, staging);
        }
    }

    unsafe fn record_upload(&self, upload: Upload) {
        // Of a map that was made only now nothing is staged.
        let map = self.made().filter(|map| map.staging_len() == upload.len);
        if let (Some(map), Some(gpu)) = (map, self.masks.gpu()) {
            // SAFETY: the command buffer is recording, as [`RateMap`] demands; the recorded commands name objects of `self`, which
            // the caller keeps until they have finished.
            let commands = unsafe { AppCommands::new(gpu, upload.commands) };
            map.upload(&commands, upload.staging, upload.offset);
        }
    }
}
