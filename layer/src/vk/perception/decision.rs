//! Decisions on the rates of both eyes' tiles, ahead of a submit that draws the scene.

use super::Perception;
use super::eye::{EyeTiles, Measured};
use super::tools::Tools;
use crate::gpu::AppCommands;
use crate::kernels::decide::DecideVariant;
use crate::vk::frame::Frame;
use crate::vk::pre_submit::Kept;
use ash::vk;
use parafovea_core::kernels::decide::DecideParams;
use smallvec::SmallVec;
use std::any::Any;
use std::sync::Arc;

/// Greatest age of contrast, in plans; a frame has at most two. Older contrast does not describe the application's current pictures.
const LONGEST_PLANS: u64 = 60;

/// A decision on the rates of both eyes that is to be recorded.
pub struct Deciding {
    eyes: SmallVec<[(Arc<EyeTiles>, DecideParams); 2]>,
    of: (u64, u64),
}

/// The decision on the tiles of one eye, whose parameters are written.
pub struct Decision {
    tools: Arc<Tools>,
    tiles: Arc<EyeTiles>,
    variant: DecideVariant,
}

impl Decision {
    /// Key of its commands: serial of its objects, and its variant.
    pub fn key(&self) -> [u64; 2] {
        [self.tiles.decide.serial(), self.variant.index()]
    }

    /// Records it.
    ///
    /// # Safety
    ///
    /// As for [`Perception::decide`]: of the same queue, after the written parameters.
    pub unsafe fn record(&self, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        let commands = unsafe { AppCommands::new(&self.tools.gpu, commands) };
        self.tools.decide.record(&commands, &self.tiles.decide, self.variant);
    }
}

impl Perception {
    /// The decision ahead of a submit to `queue` that draws the scene; `None` if all is as decided last, or where it cannot be
    /// decided there.
    pub fn deciding(&self, frame: &Frame, queue: vk::Queue) -> Option<Deciding> {
        let state = self.state();
        let (_, own_queue) = state.queue?;
        if own_queue != queue {
            drop(state);
            self.log_once("the scene is drawn on a queue other than the session's");
            return None;
        }
        let plan = frame.plan();
        let of = (plan.received(), state.measured);
        if state.decided == Some(of) {
            return None;
        }
        let mut eyes = SmallVec::new();
        for (index, eye) in state.eyes.iter().enumerate() {
            let (Some(eye), Some(decision)) = (eye, plan.decision(index)) else { continue };
            let is_recent =
                |measured: &Measured| plan.received().saturating_sub(measured.received) <= LONGEST_PLANS;
            let measured = eye.measured.filter(is_recent);
            let params =
                decision.params(|judged| Some(judged.measured_in(&measured?.view, decision.orientation)));
            if params.tiles == eye.tiles.view.tiles() {
                eyes.push((Arc::clone(&eye.tiles), params));
            }
        }
        (!eyes.is_empty()).then_some(Deciding { eyes, of })
    }

    /// Records the parameters of a decision, and hands out the decision for each eye, to be recorded after them and ahead of the maps that are
    /// resolved from it.
    ///
    /// # Safety
    ///
    /// The command buffer is being recorded, outside of a render pass, for the queue given to [`Self::deciding`]; objects added to `kept`
    /// live until it has finished.
    pub unsafe fn decide(
        &self,
        frame: &Frame,
        commands: vk::CommandBuffer,
        deciding: &Deciding,
        (words, kept): (&mut Vec<u32>, &mut Kept),
        mut each: impl FnMut(Decision),
    ) {
        let Some(tools) = self.made() else { return };
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        let commands = unsafe { AppCommands::new(&tools.gpu, commands) };
        for (tiles, params) in &deciding.eyes {
            words.clear();
            words.extend_from_slice(frame.plan().stale()[tiles.eye].words());
            let stale: &[u32] = if words.iter().all(|word| *word == 0) { &[] } else { words };
            let written = tools.decide.write(&commands, &tiles.decide, params, stale);
            kept.push(Arc::clone(tiles) as Arc<dyn Any + Send + Sync>);
            match written {
                Ok(variant) => {
                    each(Decision { tools: Arc::clone(&tools), tiles: Arc::clone(tiles), variant })
                }
                Err(error) => error.log("rates stay unchanged"),
            }
        }
        self.state().decided = Some(deciding.of);
    }

    /// The tiles of both eyes whose rates are decided on the GPU, for submits to `queue`; `None` if the plan's own rates hold. An eye
    /// without tiles shares the other's.
    pub(super) fn decided_tiles(
        &self,
        frame: &Frame,
        queue: vk::Queue,
    ) -> Option<[Option<Arc<EyeTiles>>; 2]> {
        let state = self.state();
        if state.queue.map(|(_, queue)| queue) != Some(queue) || state.decided.is_none() {
            return None;
        }
        let plan = frame.plan();
        let of = |index: usize| {
            let tiles = &state.eyes[index].as_ref()?.tiles;
            let decision = plan.decision(index)?;
            (decision.fixed.tiles == tiles.view.tiles()).then(|| Arc::clone(tiles))
        };
        Some([of(0), of(1)])
    }
}
